"""Looks that come with cutis: those that the paper shows, with its amounts, and others.

`cutis.presets.tanning` is one, `cutis.presets.names()` lists them. Each is a document in
`data/looks`, whose note says where its amounts are from.
"""

import difflib
from functools import cache
from importlib import resources
from typing import Any

from cutis.errors import CutisError
from cutis.looks.look import Look

END = ".look.json"


@cache
def names() -> tuple[str, ...]:
    """Names of all presets, in the order of the alphabet."""
    folder = resources.files("cutis.data").joinpath("looks")
    found = (file.name for file in folder.iterdir())
    return tuple(sorted(name.removesuffix(END) for name in found if name.endswith(END)))


@cache
def preset(name: str) -> Look:
    """The preset called `name`; CutisError that says what is there when there is none."""
    if name not in names():
        near = difflib.get_close_matches(name, names(), 1, 0.5)
        hint = f"did you mean {near[0]}? " if near else ""
        raise CutisError(f"unknown preset {name!r}; {hint}known are {', '.join(names())}")
    file = resources.files("cutis.data").joinpath("looks", f"{name}{END}")
    return Look.of_text(file.read_bytes(), name)


def __getattr__(name: str) -> Any:
    """`presets.blood_half` is the preset blood-half."""
    if name.replace("_", "-") not in names():
        raise AttributeError(f"there is no preset {name!r}")
    return preset(name.replace("_", "-"))


def __dir__() -> list[str]:
    return sorted([*globals(), *(name.replace("-", "_") for name in names())])
