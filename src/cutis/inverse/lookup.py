"""The look-up tensor of the paper: a grid of skins, searched for the nearest colour.

Nodes are even in network coordinates, ends included. The inverse takes, for every colour, the node
whose linear sRGB is nearest (exactly, by squared L2; the first of equals); edited skins take the
colour of the node nearest to them in network coordinates. Nothing is interpolated: quantisation is
what the paper shows of this method [aliaga2022].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace, albedo_space, grid_skins
from cutis.colour import reflectance_to_rgb
from cutis.errors import CutisError
from cutis.kernels.nearest import NearestColour, finite_colours
from cutis.optics import ALIAGA2022, PARAMETERS, WAVELENGTHS, to_coordinates

SHAPES = {"lookup": (64, 32, 5, 5, 5), "lookup-55k": (64, 32, 3, 3, 3)}
"""The two tensors of the paper, melanin, blood, thickness, eumelanin and oxygenation."""


@dataclass(frozen=True, eq=False)
class LookupTensor:
    """A grid of skins of `shape` and the linear sRGB colour (n, 3) of each, float32."""

    shape: tuple[int, ...]
    colours: NDArray[np.float32]

    def __post_init__(self) -> None:
        count = len(_nodes(self.shape))
        if self.colours.shape != (count, 3) or not np.isfinite(self.colours).all():
            raise CutisError(f"a tensor of {count} skins needs as many finite colours")

    @cached_property
    def skins(self) -> NDArray[np.float32]:
        """(n, 5) parameters of the nodes."""
        return _nodes(self.shape).astype(np.float32)

    @cached_property
    def _tree(self) -> NearestColour:
        return NearestColour(self.colours)

    def nearest(self, colours: ArrayLike) -> NDArray[np.int64]:
        """(n, 3) linear sRGB → (n,) index of the skin with the nearest colour, the first of equals.

        Raises CutisError for colours that are not finite.
        """
        return self._tree(finite_colours(colours))

    def encode(self, colours: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 3) linear sRGB → (n, 5) network coordinates of the nearest skin."""
        return to_coordinates(self.skins[self.nearest(colours)]).astype(np.float32)

    def decode(self, skins: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 5) parameters → (n, 3) linear sRGB of the nearest node.

        Parameters outside their range are taken as its end; CutisError for NaN.
        """
        if np.isnan(skins).any():
            raise CutisError("some skins are NaN; mask them out")
        low, high = np.array([(p.low, p.high) for p in PARAMETERS], dtype=np.float32).T
        cells = np.array(self.shape) - 1
        node = np.rint(to_coordinates(np.clip(skins, low, high)) * cells).astype(np.int64)
        return self.colours[np.ravel_multi_index(tuple(node.T), self.shape)]


def build_tensor(shape: Sequence[int], space: AlbedoSpace) -> LookupTensor:
    """The tensor of that shape, its colours from the exact albedo space (a second).

    Raises CutisError unless the shape is five whole numbers above zero.
    """
    colours = space.rgb(_nodes(shape))
    return LookupTensor(tuple(int(n) for n in shape), colours)


def tensor_of_spectra(shape: Sequence[int], reflectance: ArrayLike) -> LookupTensor:
    """A tensor whose nodes were simulated elsewhere: reflectance (n, 41), as Monte Carlo gives."""
    spectra = np.asarray(reflectance)
    if spectra.ndim != 2 or spectra.shape[1] != len(WAVELENGTHS):
        raise CutisError(f"reflectance must be (n, {len(WAVELENGTHS)}), not {spectra.shape}")
    _nodes(shape)  # a shape that is none fails here
    colours = reflectance_to_rgb(spectra, WAVELENGTHS).astype(np.float32)
    return LookupTensor(tuple(int(n) for n in shape), colours)


@lru_cache(maxsize=2)
def lookup_tensor(name: str = "lookup") -> LookupTensor:
    """One of the paper's two tensors by name, built once per process."""
    return build_tensor(SHAPES[name], albedo_space(ALIAGA2022))


def _nodes(shape: Sequence[int]) -> NDArray[np.float64]:
    """(n, 5) parameters of the nodes; CutisError for what is no shape."""
    try:
        return grid_skins(shape)
    except (TypeError, ValueError, OverflowError) as error:
        raise CutisError(
            "the shape of a tensor is five whole numbers above zero, such as (64, 32, 5, 5, 5), "
            f"not {shape!r}"
        ) from error
