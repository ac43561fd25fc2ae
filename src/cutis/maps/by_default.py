"""What lies below the maps, with the tissue of the default model where none is named."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace
from cutis.albedo import albedo_space as albedo_space_of
from cutis.inverse import Family, SpectralFit
from cutis.inverse import explain as explain_by
from cutis.inverse import fit_spectra as fit_spectra_by
from cutis.inverse import metamers as metamers_in
from cutis.maps.defaults import default_tissue
from cutis.optics import Tissue


def albedo_space(tissue: Tissue | None = None) -> AlbedoSpace:
    """The albedo space of `tissue`, or of that of the default model: parameters → albedo."""
    return albedo_space_of(tissue or default_tissue())


def explain(
    rgb: ArrayLike, tissue: Tissue | None = None, *, centre: float = 0.4, tolerance: float = 0.001
) -> tuple[dict[str, NDArray[np.float32]], NDArray[np.float32]]:
    """`inverse.explain` by `tissue`, or by that of the default model."""
    return explain_by(rgb, tissue or default_tissue(), centre=centre, tolerance=tolerance)


def fit_spectra(
    reflectance: ArrayLike,
    wavelengths: ArrayLike,
    tissue: Tissue | None = None,
    *,
    specular: float = 0.0,
    shift: float = 0.0,
    held: Mapping[str, float] | None = None,
    noise: float | None = None,
    free: Sequence[str] = (),
) -> SpectralFit:
    """`inverse.fit_spectra` by `tissue`, or by that of the default model."""
    return fit_spectra_by(
        reflectance, wavelengths, tissue or default_tissue(), specular=specular, shift=shift,
        held=held, noise=noise, free=free,
    )  # fmt: skip


def metamers(
    colour: ArrayLike,
    tolerance: float = 1.0,
    count: int = 1000,
    *,
    tissue: Tissue | None = None,
    seed: int = 0,
) -> Family:
    """`inverse.metamers` in the albedo space of `tissue`, or of that of the default model."""
    return metamers_in(colour, tolerance, count, space=albedo_space(tissue), seed=seed)
