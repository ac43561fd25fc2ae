"""What pages ask over the socket, checked as it arrives.

Every message is JSON with `t`, its kind. Files are named by the number that the server gave them;
no message holds a path.
"""

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from cutis.errors import CutisError
from cutis.studio.state import AnyOp

LARGEST = 4 << 20
"""Bytes of a message: a long stroke has some thousand points."""
Show = Annotated[
    str, Field(pattern=r"^(edited|original|(map|sigma|confidence|mask):[a-z0-9]{1,20})$")
]
Number = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Label = Annotated[str, Field(max_length=200)]


class Message(BaseModel):
    """One message of a page; `n` comes back with the answer."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    n: Annotated[int, Field(ge=0, le=2**53)] = 0


class Open(Message):
    """Show a file of the list."""

    t: Literal["open"]
    file: Annotated[int, Field(ge=0, le=100_000)]


class View(Message):
    """Draw a part of the face; the newest one is drawn, others are dropped.

    `show` are the pictures that are wanted; `coarser` levels are smaller, for the time of a drag.
    `preview` is something not yet done to the state, drawn as if it were.
    """

    t: Literal["view"]
    left: Number
    top: Number
    right: Number
    bottom: Number
    scale: Annotated[float, Field(gt=0, le=1000)]
    show: Annotated[tuple[Show, ...], Field(min_length=1, max_length=4)] = ("edited",)
    coarser: Annotated[int, Field(ge=0, le=4)] = 0
    preview: AnyOp | None = None
    light: Annotated[str, Field(max_length=40)] | None = None


class Do(Message):
    """Do something to the state; `what` is how the history calls it."""

    t: Literal["do"]
    op: AnyOp
    what: Label = ""


class Step(Message):
    """Undo (-1) or do again (1)."""

    t: Literal["step"]
    by: Literal[-1, 1]


class Go(Message):
    """To a state of the history."""

    t: Literal["go"]
    number: int


class Read(Message):
    """What is at a texel."""

    t: Literal["read"]
    x: Annotated[int, Field(ge=0, le=1 << 20)]
    y: Annotated[int, Field(ge=0, le=1 << 20)]
    light: Annotated[str, Field(max_length=40)] | None = None


class Tracks(Message):
    """The tracks of the sliders of a layer: what each does, by map."""

    t: Literal["tracks"]
    id: Annotated[str, Field(max_length=8)]
    does: Annotated[dict[str, str], Field(max_length=8)]


class Save(Message):
    """Write an output under a label."""

    t: Literal["save"]
    kind: Literal["albedo", "look"]
    label: Label


class Ask(Message):
    """The history, the list of files, the presets with their pictures."""

    t: Literal["ask"]
    what: Literal["history", "files", "presets"]


AnyMessage = Annotated[
    Open | View | Do | Step | Go | Read | Tracks | Save | Ask, Field(discriminator="t")
]
_ADAPTER: TypeAdapter[Any] = TypeAdapter(AnyMessage)


def understood(text: str | bytes) -> Any:
    """The message in a text; CutisError for anything that is none."""
    if len(text) > LARGEST:
        raise CutisError(f"a message may have {LARGEST} bytes")
    try:
        return _ADAPTER.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(one) for one in first["loc"])
        raise CutisError(f"the page sent what is no message ({where}: {first['msg']})") from error
    except RecursionError as error:
        raise CutisError("the page sent what is no message") from error


def packed(head: dict[str, Any], body: bytes) -> bytes:
    """A binary answer: length of the head (4 bytes, little end first), the head as JSON, a body."""
    text = json.dumps(head).encode()
    return len(text).to_bytes(4, "little") + text + body
