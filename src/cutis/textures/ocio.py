"""Colour spaces of OpenColorIO configurations: names, aliases and roles."""

import contextlib
import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import (
    ACES2065_1,
    LINEAR,
    SPACES,
    RGBSpace,
    Space,
    chromaticities_of,
)
from cutis.errors import CutisError
from cutis.textures.ocio_files import check_config_file, check_lookups
from cutis.textures.problem import shorten

BUILT_IN = "ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4"
"""The configuration when none is given, by its full name: `default` changes with releases."""
BRIDGES: tuple[tuple[RGBSpace, tuple[str, ...]], ...] = (
    (ACES2065_1, ("aces_interchange", "aces2065_1", "ACES2065-1", "ACES - ACES2065-1")),
    (LINEAR, ("lin_rec709", "Linear Rec.709 (sRGB)", "Utility - Linear - sRGB", "lin_srgb")),
)
"""Spaces of ours, and what configurations call them; the first is the role made for this."""
SAME = 1e-5
"""Spaces whose linear colours differ by less are one: configurations round their matrices."""
_HUGE = np.float32(1e30)


@dataclass(frozen=True)
class OcioSpace:
    """A space of a configuration; `to` and `back` are OpenColorIO processors.

    They connect it with `connection`, a space of ours, in float32. `config` is its configuration,
    None for BUILT_IN. Spaces of one name and configuration are equal. `chromaticities` are those of
    linear spaces, adapted to D65.
    """

    name: str
    encoded: bool
    to: Any = field(compare=False)
    back: Any = field(compare=False)
    connection: RGBSpace = field(compare=False)
    config: str | None = None
    chromaticities: tuple[float, ...] | None = field(default=None, compare=False)

    def __reduce__(self) -> tuple[Any, ...]:
        """Travels to other processes by name; what arrives is checked to be the same."""
        config = self.config
        if config is not None and "://" not in config:
            config = os.path.abspath(config)
        return _reopened, (self.name, config, _content(config))

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB, float32."""
        return self.connection.to_linear_srgb(_applied(self.to, values))

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → stored values, float32."""
        return _applied(self.back, self.connection.from_linear_srgb(rgb))


def _content(config: str | None) -> str:
    """SHA-256 of a configuration's file; empty for those that come with OpenColorIO."""
    if config is None or "://" in config:
        return ""
    return hashlib.sha256(Path(config).read_bytes()).hexdigest()


def _reopened(name: str, config: str | None, content: str) -> Space:
    """A space that came from another process; CutisError where it is another one here."""
    try:
        same = _content(config) == content
    except OSError as error:
        raise CutisError(f"{config}: {error.strerror}; all processes need this file") from error
    found = ocio_space(name, config) if same else None
    if found is None:
        raise CutisError(f"{config}: another configuration than where this work was started")
    return found


def _applied(processor: Any, values: ArrayLike) -> NDArray[np.float32]:
    # a copy, since processors work in place, and in rows, since they take nothing else
    colours = np.array(values, dtype=np.float32, order="C")
    flat = colours.reshape(-1, 3)
    if len(flat):
        processor.applyRGB(flat)
    return np.clip(colours, -_HUGE, _HUGE, out=colours)  # beyond the range of a log space


def configured() -> str | None:
    """The configuration that $OCIO names, if any."""
    return os.environ.get("OCIO") or None


@lru_cache(maxsize=64)
def ocio_space(name: str, config: str | None = None) -> Space | None:
    """The space called `name`, a role or an alias in `config`, or in BUILT_IN.

    One of `colour.SPACES` where it is the same. None where there is no such space, or no
    OpenColorIO and no `config`. Raises CutisError for a configuration that cannot be read, and for
    spaces that are not colour or go one way only.
    """
    try:
        import PyOpenColorIO as ocio
    except ImportError:
        if config is None:
            return None
        raise CutisError(
            f"{config} needs OpenColorIO: pip install opencolorio, or do without $OCIO and --ocio"
        ) from None
    known = _config(config or BUILT_IN)
    with _in_one_line(f"{config or BUILT_IN}: not a usable OpenColorIO configuration"):
        space = known.getColorSpace(name)
        if space is None:
            return None
        if space.isData():
            raise CutisError(f"{space.getName()} holds data, not colour; name a colour space")
        connection, here = _connection(known, config or BUILT_IN)
        check_lookups(known, config or BUILT_IN, (space.getName(), here))
    lossless = ocio.OPTIMIZATION_LOSSLESS
    with _in_one_line(f"{name}: OpenColorIO cannot convert it both ways"):
        to = known.getProcessor(space.getName(), here).getOptimizedCPUProcessor(lossless)
        back = known.getProcessor(here, space.getName()).getOptimizedCPUProcessor(lossless)
        found = OcioSpace(space.getName(), True, to, back, connection, config)
        with np.errstate(all="ignore"):  # of spaces that make no sense
            return _ours(found) or _described(found)


@contextlib.contextmanager
def _in_one_line(what: str) -> Iterator[None]:
    """Whatever the library and its parsers raise, as a CutisError that begins with `what`."""
    try:
        yield
    except CutisError:
        raise
    except Exception as error:
        said = "text that is not UTF-8" if isinstance(error, UnicodeError) else str(error)
        reason = shorten(next(iter(said.splitlines()), type(error).__name__))
        raise CutisError(f"{what} ({reason})") from error


def _ours(found: OcioSpace) -> RGBSpace | None:
    """The space of ours that gives the same colours, if any."""
    steps = np.linspace(0, 1, 9, dtype=np.float32)
    values = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    theirs = found.to_linear_srgb(values)
    for space in (*SPACES, ACES2065_1):
        if np.abs(space.to_linear_srgb(values) - theirs).max() < SAME:
            return space
    return None


def _described(found: OcioSpace) -> OcioSpace:
    """The space with what its colours say: whether it is linear, and of which chromaticities."""
    units = np.eye(3, dtype=np.float32)
    levels = np.array([0, 1e-3, 0.02, 0.18, 0.5, 1, 4], dtype=np.float32)
    matrix = found.to_linear_srgb(units)
    expected = levels[:, None, None] * matrix
    measured = found.to_linear_srgb(levels[:, None, None] * units)
    if np.abs(measured - expected).max() > 1e-4 * np.abs(expected).max():
        return found
    return OcioSpace(
        found.name, False, found.to, found.back, found.connection, found.config,
        chromaticities_of(matrix.T),
    )  # fmt: skip


def ocio_names(config: str | None = None) -> tuple[list[str], list[str]]:
    """Names of the colour spaces of a configuration, and its aliases and roles.

    Nothing without OpenColorIO.
    """
    try:
        known = _config(config or BUILT_IN)
    except ImportError:
        return [], []
    with _in_one_line(f"{config or BUILT_IN}: not a usable OpenColorIO configuration"):
        spaces = [space for space in known.getColorSpaces() if not space.isData()]
        aliases = [alias for space in spaces for alias in space.getAliases()]
        roles = [role for role, _ in known.getRoles()]
        return [space.getName() for space in spaces], [*aliases, *roles]


def _connection(known: Any, config: str) -> tuple[RGBSpace, str]:
    """A space of our own and its name in the configuration."""
    for space, names in BRIDGES:
        for name in names:
            if known.getColorSpace(name) is not None:
                return space, name
    raise CutisError(
        f"{config}: has neither the role aces_interchange nor a linear Rec.709, so that its "
        "colours cannot be told; give another configuration with --ocio"
    )


@lru_cache(maxsize=4)
def _config(path: str) -> Any:
    import PyOpenColorIO as ocio

    what = f"{path}: not a usable OpenColorIO configuration"
    try:
        check_config_file(path)
    except CutisError as error:
        raise CutisError(f"{what} ({str(error).removeprefix(f'{path}: ')})") from error
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)  # what matters is raised
    with _in_one_line(what):
        return ocio.Config.CreateFromFile(path)
