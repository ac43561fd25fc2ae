"""Names that moved: they still work for one version, and say where they are now."""

import warnings
from importlib import import_module
from typing import Any


def moved(room: str, name: str, where: dict[str, str]) -> Any:
    """What `room` was asked for under an old `name`; AttributeError for names it never had.

    `where` says of old names where they are now, as module:name. Warns with DeprecationWarning.
    """
    if name not in where:
        raise AttributeError(f"module {room!r} has no attribute {name!r}")
    module, _, new = where[name].partition(":")
    warnings.warn(
        f"{room}.{name} is {module}.{new} now; the old name goes after version 0.2",
        DeprecationWarning,
        stacklevel=3,
    )
    return getattr(import_module(module), new)
