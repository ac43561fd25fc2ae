"""All states that a face was in, on disk: undo survives whatever ends the page or the server.

One SQLite file, whose transactions are whole or not there. Layers are kept once, under a digest of
their document, so that a state costs what is new in it.
"""

import hashlib
import json
import sqlite3
import threading
from pathlib import Path

from cutis.errors import CutisError
from cutis.studio.state import Document, State, empty, with_ids

LONGEST = 1000
"""States that are kept."""
SCHEMA = """
create table if not exists layers (digest text primary key, document text not null);
create table if not exists states (
    number integer primary key autoincrement, look text not null, layers text not null,
    what text not null
);
create table if not exists place (one integer primary key check (one = 1), number integer not null);
"""


class History:
    """The states of one face, and which of them is the one now."""

    def __init__(self, path: Path) -> None:
        """Opens or makes the file; CutisError where it is none of ours."""
        self.path, self._lock = path, threading.Lock()
        try:
            self._base = sqlite3.connect(path, timeout=5, check_same_thread=False)
            self._base.executescript(f"pragma journal_mode = wal; {SCHEMA}")
            self._base.commit()
            with self._lock:
                if self._number() is None:
                    self._push(empty(), "Opened")
        except sqlite3.Error as error:
            raise CutisError(
                f"{path}: the history cannot be opened ({error}); move it away to begin a new one"
            ) from error

    def now(self) -> tuple[int, State]:
        """The number of the state now, and the state."""
        with self._lock:
            number = self._number()
            assert number is not None
            return number, self._state(number)

    def push(self, state: State, what: str) -> int:
        """One more state, in place of those that were undone; its number. On disk on return.

        Raises CutisError where the disk does not take it: the state before stays.
        """
        with self._lock:
            try:
                return self._push(state, what)
            except sqlite3.Error as error:
                self._base.rollback()
                raise CutisError(
                    f"the change is not kept: {self.path.name} cannot be written ({error}); make "
                    "room on the disk and do it again"
                ) from error

    def step(self, by: int) -> tuple[int, State]:
        """The state before (-1) or after (1) that of now, which it becomes; that of now at ends."""
        order = "number < ? order by number desc" if by < 0 else "number > ? order by number"
        with self._lock:
            number = self._number() or 0
            found = self._base.execute(
                f"select number from states where {order} limit 1", (number,)
            ).fetchone()
            return self._go(number if found is None else found[0])

    def go(self, number: int) -> tuple[int, State]:
        """A state of the list becomes that of now; CutisError where it is gone."""
        with self._lock:
            return self._go(number)

    def list(self) -> list[tuple[int, str]]:
        """Numbers of all states, in order, with what led to them."""
        with self._lock:
            return self._base.execute("select number, what from states order by number").fetchall()

    def ends(self) -> tuple[bool, bool]:
        """Whether there is something to undo, and to redo."""
        with self._lock:
            number = self._number()
            low, high = self._base.execute("select min(number), max(number) from states").fetchone()
            return number > low, number < high

    def close(self) -> None:
        """Lets go of the file."""
        with self._lock:
            self._base.close()

    # under the lock ---------------------------------------------------------------------------

    def _number(self) -> int | None:
        found = self._base.execute("select number from place").fetchone()
        return None if found is None else int(found[0])

    def _push(self, state: State, what: str) -> int:
        look: Document = state.look.as_json()
        layers: list[list[str]] = []
        with self._base as base:
            number = self._number()
            if number is not None:
                base.execute("delete from states where number > ?", (number,))
            for id, layer in zip(state.ids, look.pop("layers", ()), strict=True):
                document = json.dumps(layer, sort_keys=True)
                key = hashlib.sha256(document.encode()).hexdigest()
                base.execute("insert or ignore into layers values (?, ?)", (key, document))
                layers.append([id, key])
            added = base.execute(
                "insert into states (look, layers, what) values (?, ?, ?)",
                (json.dumps(look), json.dumps(layers), what),
            ).lastrowid
            assert added is not None
            base.execute("insert or replace into place values (1, ?)", (added,))
            base.execute(
                "delete from states where number <= (select number from states "
                f"order by number desc limit 1 offset {LONGEST})"
            )
        return added

    def _go(self, number: int) -> tuple[int, State]:
        state = self._state(number)
        try:
            with self._base as base:
                base.execute("update place set number = ?", (number,))
        except sqlite3.Error as error:
            raise CutisError(f"{self.path.name} cannot be written ({error}); make room") from error
        return number, state

    def _state(self, number: int) -> State:
        found = self._base.execute(
            "select look, layers from states where number = ?", (number,)
        ).fetchone()
        if found is None:
            raise CutisError("that step is not in the history any more")
        look, layers = json.loads(found[0]), json.loads(found[1])
        documents = []
        for _, key in layers:
            (text,) = self._base.execute(
                "select document from layers where digest = ?", (key,)
            ).fetchone()
            documents.append(json.loads(text))
        return with_ids({**look, "layers": documents}, tuple(id for id, _ in layers))
