"""Where findings begin: numbers in one file, which people may override."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from cutis.errors import CutisError

Limits = Mapping[str, float]
"""The numbers of one check by name."""
Thresholds = Mapping[str, Limits]
"""Limits by check."""


@cache
def shipped() -> Thresholds:
    """The thresholds that ship, `data/checks/thresholds.toml`."""
    text = resources.files("cutis.data").joinpath("checks/thresholds.toml").read_text("utf-8")
    return tomllib.loads(text)


def thresholds(path: Path | None = None) -> Thresholds:
    """Those that ship, with what a file of the same form overrides.

    Raises CutisError for a file that is no TOML, and for checks, names and values that are unknown.
    """
    if path is None:
        return shipped()
    try:
        given: Any = tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        raise CutisError(f"{path}: {error.strerror or error}; check the name") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise CutisError(f"{path}: is no TOML ({error})") from error
    found = {name: dict(limits) for name, limits in shipped().items()}
    for check, limits in given.items():
        if check not in found or not isinstance(limits, dict):
            raise CutisError(f"{path}: there is no check {check!r}; {_known(found)}")
        for name, value in limits.items():
            if name not in found[check]:
                raise CutisError(f"{path}: [{check}] has no {name!r}; {_known(found[check])}")
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise CutisError(f"{path}: [{check}] {name} must be a number, not {value!r}")
            found[check][name] = float(value)
    return found


def _known(names: Mapping[str, object]) -> str:
    return f"known are {', '.join(names)}"
