"""Looks that come with cutis: those that the paper shows, with its amounts, and others.

`cutis.presets.tanning` is one, `cutis.presets.names()` lists them. Each is a document in
`data/looks`, whose note says where its amounts are from.
"""

import difflib
from functools import cache
from typing import Any

from cutis.errors import CutisError
from cutis.looks.look import Look
from cutis.looks.shipped import document, names

__all__ = ["names", "preset"]


@cache
def preset(name: str) -> Look:
    """The preset called `name`; CutisError that says what is there when there is none."""
    if name not in names():
        near = difflib.get_close_matches(name, names(), 1, 0.5)
        hint = f"did you mean {near[0]}? " if near else ""
        raise CutisError(f"unknown preset {name!r}; {hint}known are {', '.join(names())}")
    return Look.of_text(document(name), name)


def __getattr__(name: str) -> Any:
    """`presets.blood_half` is the preset blood-half."""
    if name.replace("_", "-") not in names():
        raise AttributeError(f"there is no preset {name!r}")
    return preset(name.replace("_", "-"))


def __dir__() -> list[str]:
    return sorted([*globals(), *(name.replace("-", "_") for name in names())])
