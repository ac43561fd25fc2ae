"""The albedo space at wavelengths of the caller's choice, with slopes by every parameter.

Chromophores have bands narrower than the table's 10 nm, so neither measured nor model spectra are
interpolated: absorption is taken at the wavelength itself, and only transport, at given
absorptions, is blended between the two neighbouring bands of the table, by log μs. The blend is
within 1e-4 of the exact solver, 8e-4 where blood fills the dermis (tests/albedo). At the table's
own wavelengths nothing is blended.
"""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.space import AlbedoSpace, Model, mixture_of
from cutis.errors import CutisError
from cutis.optics import WAVELENGTHS

BAND = 1 << 14
"""Skins evaluated at a time."""


class SampledSpace:
    """`AlbedoSpace` at wavelengths (n,), nm, in 380–780; CutisError outside."""

    def __init__(self, space: AlbedoSpace, wavelengths: ArrayLike) -> None:
        lam = np.atleast_1d(np.asarray(wavelengths, dtype=np.float64))
        first, last = WAVELENGTHS[0], WAVELENGTHS[-1]
        if lam.ndim != 1 or not lam.size or not ((lam >= first) & (lam <= last)).all():
            raise CutisError(f"wavelengths must be a list inside {first:g} to {last:g} nm")
        self.space, self.wavelengths = space, lam
        known = np.log(space.tissue.scattering(WAVELENGTHS))
        self._bands = np.searchsorted(WAVELENGTHS, lam, side="right") - 1
        above = np.minimum(self._bands + 1, len(WAVELENGTHS) - 1)
        rise = np.where(above > self._bands, known[above] - known[self._bands], 1.0)
        share = (np.log(space.tissue.scattering(lam)) - known[self._bands]) / rise
        on = lam == WAVELENGTHS[self._bands]
        self._blends = np.where(on, 0.0, share).astype(np.float32)

    @cached_property
    def model(self) -> Model:
        """The model of `slopes_kernel.py` at these wavelengths."""
        mixture = mixture_of(self.space.tissue, self.wavelengths)
        return (*mixture, self._bands, self._blends, *self.space.tables)

    def reflectance(self, parameters: ArrayLike) -> NDArray[np.float32]:
        """(m, p) free parameters of the tissue → (m, n) albedo."""
        return self.gradient(parameters)[0]

    def gradient(self, parameters: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(m, p) free parameters → (m, n) albedo and (m, n, p) its slopes, per unit of each."""
        from cutis.albedo.slopes_kernel import spectra_and_slopes

        flat, _ = self.space.rows(parameters)
        skins = np.ascontiguousarray(flat, dtype=np.float32)
        spectra = np.empty((len(skins), len(self.wavelengths)), dtype=np.float32)
        slopes = np.empty((*spectra.shape, skins.shape[1]), dtype=np.float32)
        for start in range(0, len(skins), BAND):
            part = slice(start, start + BAND)
            some = skins[part]
            spectra_and_slopes(len(some), some, self.model, spectra[part], slopes[part])
        return spectra, slopes[..., list(self.space.places)]
