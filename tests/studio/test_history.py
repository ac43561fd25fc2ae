"""States on disk: undo that outlives the process, and what happens when the disk says no."""

import os
import signal
import sqlite3
import subprocess
import sys

import pytest

from cutis.errors import CutisError
from cutis.studio.history import LONGEST, History
from cutis.studio.state import Put, State, Tune, empty


@pytest.fixture
def path(tmp_path):
    return tmp_path / "history.sqlite"


def tuned(state: State, by: float) -> State:
    edit = {"do": "multiply", "map": "melanin", "by": by}
    return state.after(Tune(op="tune", id=state.ids[0], map="melanin", edit=edit))


def test_it_begins_with_one_empty_layer(path):
    history = History(path)
    assert [layer.name for layer in history.now()[1].look.layers] == ["Skin"]
    assert history.ends() == (False, False)
    history.close()


def test_everything_is_undone_and_done_again_after_reopening(path):
    history, states = History(path), []
    states.append(history.now()[1])
    for by in (1.5, 2, 3):
        states.append(tuned(states[-1], by))
        history.push(states[-1], f"melanin x{by}")
    history.close()
    history = History(path)
    assert history.now()[1] == states[3]
    assert [history.step(-1)[1] for _ in range(4)] == [states[2], states[1], states[0], states[0]]
    assert history.ends() == (False, True)
    assert history.step(1)[1] == states[1]
    done = [f"melanin x{by}" for by in (1.5, 2, 3)]
    assert [what for _, what in history.list()] == ["Opened", *done]
    history.close()
    assert History(path).now()[1] == states[1]


def test_what_was_undone_goes_when_something_else_is_done(path):
    history = History(path)
    first = history.now()[1]
    history.push(tuned(first, 2), "a")
    history.step(-1)
    history.push(first.after(Put(op="set", id=first.ids[0], field="amount", value=0.5)), "b")
    assert [what for _, what in history.list()] == ["Opened", "b"]
    assert history.ends() == (True, False)


def test_ids_of_layers_stay(path):
    history = History(path)
    before = history.now()[1]
    history.push(tuned(before, 2), "a")
    history.close()
    assert History(path).now()[1].ids == before.ids


def test_old_states_go(path, monkeypatch):
    monkeypatch.setattr("cutis.studio.history.LONGEST", 5)
    history = History(path)
    state = history.now()[1]
    for by in range(1, 10):
        state = tuned(state, 1 + by)
        history.push(state, str(by))
    assert [what for _, what in history.list()] == ["5", "6", "7", "8", "9"]
    assert LONGEST >= 500


CHILD = """
import sys
from cutis.studio.history import History
from cutis.studio.state import Tune
history = History(sys.argv[1])
state = history.now()[1]
for by in range(1, 1000):
    edit = {"do": "multiply", "map": "melanin", "by": by}
    state = state.after(Tune(op="tune", id=state.ids[0], map="melanin", edit=edit))
    history.push(state, str(by))
    print(by, flush=True)
"""


def test_a_killed_process_loses_nothing_that_it_had_said_was_kept(path):
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, str(path)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    said = [int(child.stdout.readline()) for _ in range(12)][-1]
    os.kill(child.pid, signal.SIGKILL)
    rest = [int(line) for line in child.stdout.read().split("\n") if line]
    child.wait()
    child.stdout.close()
    history = History(path)
    kept = history.now()[1].look.layers[0].edits[0].by
    assert kept >= max([said, *rest])
    assert kept <= max([said, *rest]) + 1
    assert history.step(-1)[1].look.layers[0].edits[0].by == kept - 1


def test_a_full_disk_is_one_line_and_the_state_stays(path):
    history = History(path)
    before = history.now()
    pages = history._base.execute("pragma page_count").fetchone()[0]
    history._base.execute(f"pragma max_page_count = {pages}")
    state = before[1].after(Put(op="set", id=before[1].ids[0], field="note", value="long " * 1900))
    said = ""
    for number in range(40):
        state, before = tuned(state, 1 + number), history.now()
        try:
            history.push(state, "big")
        except CutisError as error:
            said = str(error)
            break
    assert "not kept" in said
    assert "make room" in said
    assert history.now() == before


def test_what_is_no_history_is_refused_and_kept(path):
    path.write_bytes(b"not a database at all" * 100)
    with pytest.raises(CutisError, match="move it away"):
        History(path)
    assert path.read_bytes().startswith(b"not a database")


def test_layers_are_kept_once(path):
    history = History(path)
    state = history.now()[1].after(
        Put(op="set", id=history.now()[1].ids[0], field="note", value="x" * 9000)
    )
    state = state.after(_add())
    for by in range(20):
        edit = {"do": "multiply", "map": "blood", "by": by}
        state = state.after(Tune(op="tune", id=state.ids[1], map="blood", edit=edit))
        history.push(state, "")
    history.close()
    with sqlite3.connect(path) as base:
        (size,) = base.execute("select sum(length(document)) from layers").fetchone()
    assert size < 3 * 9000
    assert empty().ids != empty().ids


def _add():
    from cutis.studio.state import Add

    return Add(op="add", layers=({"name": "second"},))
