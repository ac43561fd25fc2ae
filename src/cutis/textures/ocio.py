"""Colour spaces of OpenColorIO configurations: names, aliases and roles."""

import os
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import ACES2065_1, rgb_space
from cutis.errors import CutisError

BUILT_IN = "ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4"
"""The configuration when none is given, by its full name: `default` changes with releases."""
ROLE = "aces_interchange"
"""The role by which configurations say which of their spaces is ACES2065-1."""


@dataclass(frozen=True, eq=False)
class OcioSpace:
    """A space of a configuration; `to` and `back` are OpenColorIO processors.

    They connect it with `connection`, a space that we know, in float32. `config` is its
    configuration, None for BUILT_IN.
    """

    name: str
    encoded: bool
    to: Any
    back: Any
    connection: Any
    config: str | None = None
    chromaticities: None = None

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB, float32."""
        return self.connection.to_linear_srgb(_applied(self.to, values))

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → stored values, float32."""
        return _applied(self.back, self.connection.from_linear_srgb(rgb))


def _applied(processor: Any, values: ArrayLike) -> NDArray[np.float32]:
    colours = np.array(values, np.float32, order="C")  # a copy: processors work in place
    flat = colours.reshape(-1, 3)
    if len(flat):
        processor.applyRGB(flat)
    return flat.reshape(colours.shape)


def configured() -> str | None:
    """The configuration that $OCIO names, if any."""
    return os.environ.get("OCIO") or None


def ocio_space(name: str, config: str | None = None) -> OcioSpace | None:
    """The space called `name`, a role or an alias in `config`, or in BUILT_IN.

    None where there is no such space, or no OpenColorIO and no `config`. Raises CutisError for a
    configuration that cannot be read, and for spaces that are not colour.
    """
    try:
        import PyOpenColorIO as ocio
    except ModuleNotFoundError:
        if config is None:
            return None
        raise CutisError("OpenColorIO is missing; pip install opencolorio") from None
    known = _config(config or BUILT_IN)
    space = known.getColorSpace(name)
    if space is None:
        return None
    if space.isData():
        raise CutisError(f"{space.getName()} holds data, not colour; name a colour space")
    connection, here = _connection(known)
    lossless = ocio.OPTIMIZATION_LOSSLESS
    try:
        to = known.getProcessor(space.getName(), here).getOptimizedCPUProcessor(lossless)
        back = known.getProcessor(here, space.getName()).getOptimizedCPUProcessor(lossless)
    except ocio.Exception as error:
        raise CutisError(f"{name}: OpenColorIO cannot convert it both ways ({error})") from error
    grey = np.array([[0.2, 0.2, 0.2], [0.4, 0.4, 0.4]], np.float32)
    to.applyRGB(grey)
    linear = abs(grey[1, 1] - 2 * grey[0, 1]) < 1e-4 * abs(grey[1, 1])
    return OcioSpace(space.getName(), not linear, to, back, connection, config)


def ocio_names(config: str | None = None) -> list[str]:
    """Names of the colour spaces of a configuration; empty without OpenColorIO."""
    try:
        return list(_config(config or BUILT_IN).getColorSpaceNames())
    except ModuleNotFoundError:
        return []


def _connection(known: Any) -> tuple[Any, str]:
    """A space of our own and its name in the configuration."""
    if known.hasRole(ROLE):
        return ACES2065_1, ROLE
    for alias in ("lin_rec709", "Linear Rec.709 (sRGB)", "Utility - Linear - sRGB", "lin_srgb"):
        if known.getColorSpace(alias) is not None:
            return rgb_space("linear"), alias
    raise CutisError(
        f"this OpenColorIO configuration has neither the role {ROLE} nor a linear Rec.709; "
        "give another with --ocio"
    )


@lru_cache(maxsize=4)
def _config(path: str) -> Any:
    import PyOpenColorIO as ocio

    try:
        config = ocio.Config.CreateFromFile(path)
        config.validate()
    except (ocio.Exception, UnicodeError) as error:
        text = str(error).splitlines()[0]
        raise CutisError(f"{path}: not a usable OpenColorIO configuration ({text})") from error
    return config
