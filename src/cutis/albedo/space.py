"""The albedo space: every skin of a tissue, as reflectance and as linear sRGB."""

from collections.abc import Iterator
from functools import cached_property, lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.separated import separate
from cutis.albedo.spectral_table import CELLS, SpectralTable, spectral_table
from cutis.colour import LightLike, spectrum_to_rgb
from cutis.errors import CutisError
from cutis.optics import (
    NAMES,
    WAVELENGTHS,
    Parameter,
    Tissue,
)

Array: TypeAlias = NDArray[np.float32]
Mixture: TypeAlias = tuple[NDArray[np.int64], Array, Array]
Model: TypeAlias = tuple[
    NDArray[np.int64], Array, Array, NDArray[np.intp], Array, Array, Array, Array, Array
]
NO_WEIGHTS = np.empty((0, 3), dtype=np.float32)
BAND = 1 << 18
"""Texels converted at a time."""


class AlbedoSpace:
    """Forward model of a tissue: parameters → albedo, exact to 1e-4 (docs/albedo.md).

    Parameters are (..., 5) in the units and order of `optics.PARAMETERS`; of a tissue with other
    free parameters, (..., n) in those of `tissue.parameters`.
    """

    def __init__(self, table: SpectralTable) -> None:
        """Of an existing table; `albedo_space` makes and keeps the common ones."""
        tissue = table.tissue
        self.tissue = tissue
        self.table = table
        self._axes = (
            table.low.astype(np.float32),
            (np.array(CELLS) / (table.high - table.low)).astype(np.float32),
        )

    @cached_property
    def _to_rgb(self) -> NDArray[np.float32]:
        return spectrum_to_rgb(WAVELENGTHS).astype(np.float32)

    @cached_property
    def _mixture(self) -> Mixture:
        return mixture_of(self.tissue, WAVELENGTHS)

    @cached_property
    def tables(self) -> tuple[Array, Array, Array, Array]:
        """Products of the table and ends of its axes: the last of the model of `slopes_kernel`."""
        return (*separate(self.table), *self._axes)

    @cached_property
    def model(self) -> Model:
        """The model of `slopes_kernel.py` at the wavelengths of the table."""
        bands = np.arange(len(WAVELENGTHS))
        return (*self._mixture, bands, np.zeros(len(bands), np.float32), *self.tables)

    @property
    def rgb_weights(self) -> Array:
        """(41, 3) weights of the bands in linear sRGB under D65."""
        return self._to_rgb

    def reflectance(
        self, parameters: ArrayLike, out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """(..., 5) parameters → (..., 41) reflectance in [0, 1] at `optics.WAVELENGTHS`.

        Written into `out`, C-contiguous float32 of that shape, when it is given (2048² skins take
        0.7 GB). Raises CutisError when `out` is another kind of array.
        """
        flat, shape = self.rows(parameters)
        whole = (*shape, len(WAVELENGTHS))
        if out is None:
            out = np.empty(whole, dtype=np.float32)
        elif out.shape != whole or out.dtype != np.float32 or not out.flags.c_contiguous:
            raise CutisError(f"out must be a C-contiguous float32 array of shape {whole}")
        spectra = out.reshape(-1, len(WAVELENGTHS))
        for band in _bands(len(flat)):
            self._sum(flat[band], NO_WEIGHTS, spectra[band])
        return out

    def rgb(self, parameters: ArrayLike, light: LightLike = "D65") -> NDArray[np.float32]:
        """(..., 5) parameters → (..., 3) linear sRGB, white-balanced under `light`.

        Lights are those of `colour.illuminant`; CutisError for others.
        """
        flat, shape = self.rows(parameters)
        out = np.empty((len(flat), 3), dtype=np.float32)
        weights = self._to_rgb
        if light != "D65":
            weights = spectrum_to_rgb(WAVELENGTHS, light).astype(np.float32)
        for band in _bands(len(flat)):
            self._sum(flat[band], weights, out[band])
        return out.reshape(*shape, 3)

    def _sum(self, skins: NDArray[np.floating], weights: Array, out: Array) -> None:
        from cutis.albedo.spectra_kernel import reflectance_kernel

        some = _float32(skins)
        reflectance_kernel(len(some), some, *self._mixture, *self.tables, weights, out)

    def rgb_gradient(
        self, parameters: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(..., 5) parameters → (..., 3) linear sRGB and (..., 3, 5) its slope per parameter."""
        from cutis.albedo.slopes_kernel import colours_and_slopes

        flat, shape = self.rows(parameters)
        out = np.empty((len(flat), 3), dtype=np.float32)
        slope = np.empty((len(flat), 3, flat.shape[1]), dtype=np.float32)
        for band in _bands(len(flat)):
            some = _float32(flat[band])
            colours_and_slopes(len(some), some, self.model, self._to_rgb, out[band], slope[band])
        slope = slope[..., list(self.places)]
        return out.reshape(*shape, 3), slope.reshape(*shape, 3, len(self.places))

    @cached_property
    def every_parameter(self) -> tuple[Parameter, ...]:
        """What kernels take: all of the tissue's, fixed or free."""
        return self.tissue.every_parameter

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Where the tissue's free parameters stand among those."""
        return tuple(self.every_parameter.index(p) for p in self.tissue.parameters)

    def rows(self, parameters: ArrayLike) -> tuple[NDArray[np.floating], tuple[int, ...]]:
        """(n, p) of every parameter, those that the tissue holds included, and the shape."""
        values = np.asarray(parameters)
        flat = values.reshape(-1, len(self.places))
        if self.tissue.fixed:
            whole = np.empty((len(flat), len(self.every_parameter)))
            for name, value in self.tissue.fixed:
                whole[:, NAMES.index(name)] = value
            whole[:, self.places] = flat
            flat = whole
        return flat, values.shape[:-1]


def mixture_of(tissue: Tissue, wavelengths: NDArray[np.float64]) -> Mixture:
    """The mixture of a tissue at wavelengths (n,), nm, as kernels take it."""
    recipe, above, below = tissue.mixture(wavelengths)
    return recipe, above.astype(np.float32), below.astype(np.float32)


def _float32(values: NDArray[np.floating]) -> NDArray[np.float32]:
    return np.ascontiguousarray(values, dtype=np.float32)


def _bands(count: int) -> Iterator[slice]:
    return (slice(start, start + BAND) for start in range(0, count, BAND))


def albedo_space(tissue: Tissue) -> AlbedoSpace:
    """The albedo space of `tissue`, made once per process."""
    return _albedo_space(tissue)


@lru_cache(maxsize=4)
def _albedo_space(tissue: Tissue) -> AlbedoSpace:
    return AlbedoSpace(spectral_table(tissue))
