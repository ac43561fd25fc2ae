"""Skins that best explain measured spectra: parameters, how sure they are, what is left over.

Of a spectrum y at m wavelengths the fit minimises

    Σ (f(λ) − y(λ))² + Σ w (z − z₀)²,   f = (measured as albedo),

over logits z of the five parameters' coordinates, by Levenberg–Marquardt from several starts. The
prior w is that weak that it decides only what the spectrum leaves open: one standard deviation of
it (WIDTH logits) costs as much as a root mean square error of PULL.

Instruments that include the specular part measure ρ + (1 − ρ) · albedo; `specular` is that ρ.
Transport is solved at the wavelengths of the data, not interpolated.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import build
from cutis.errors import CutisError
from cutis.inverse.fit import logistic, logit
from cutis.optics import ALIAGA2022, PARAMETERS, WAVELENGTHS, Tissue

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]

NOISE = 1e-3
"""Error of measured reflectance that is taken for granted."""
PULL = 2e-4
"""Root mean square error that the prior may cause."""
WIDTH = 2.0
"""Standard deviation of the prior, in logits."""
CENTRE = (0.25, 0.35, 0.4, 0.6, 0.6)
"""Coordinates that the prior expects: those of an ordinary light to medium skin."""
STARTS = (
    (0.15, 0.3, 0.4, 0.6, 0.6),
    (0.4, 0.35, 0.5, 0.7, 0.6),
    (0.65, 0.4, 0.3, 0.7, 0.7),
    (0.3, 0.3, 0.15, 0.3, 0.2),
    (0.3, 0.5, 0.85, 0.9, 0.9),
    (0.6, 0.25, 0.1, 0.9, 0.3),
)
ITERATIONS = 60
BATCH = 4096
"""Spectra between two reports of progress."""


@dataclass(frozen=True, eq=False)
class SpectraFit:
    """Fits of n spectra, in the units and order of `optics.PARAMETERS`.

    `parameters`, `sigma` (n, 5): estimates and their standard deviations, the prior's where the
    spectrum says nothing; `covariance` (n, 5, 5); `rmse` (n,) of the measured reflectance;
    `model` (n, m) reflectance as it would be measured. NaN where a spectrum could not be used.
    """

    parameters: Array
    sigma: Array
    covariance: Array
    rmse: Array
    model: Array


def fit_spectra(
    reflectance: ArrayLike,
    wavelengths: ArrayLike,
    tissue: Tissue = ALIAGA2022,
    *,
    specular: float = 0.0,
    progress: Progress | None = None,
) -> SpectraFit:
    """The skins of reflectance spectra (n, m), 0 to 1, at `wavelengths` (m,) in nm, 380 to 780.

    `specular` is the ρ of the measurement, 0 where the specular part is excluded. Spectra with
    values that are not finite give NaN. `progress(done, total)` counts spectra. Raises CutisError
    for wavelengths out of range or not increasing, fewer of them than parameters, and reflectance
    outside −0.05 to 1.2 (per cent, for example).
    """
    at = check_wavelengths(wavelengths)
    measured = np.asarray(reflectance, dtype=np.float64)
    if measured.ndim != 2 or measured.shape[1] != len(at):
        raise CutisError(f"spectra must be (n, {len(at)}), not {measured.shape}")
    if not 0 <= specular < 0.2:
        raise CutisError(f"specular = {specular:g}: a share from 0 to 0.2 is needed")
    good = np.isfinite(measured).all(axis=1)
    check_reflectance(measured[good])
    albedo = (measured - specular) / (1 - specular)
    count, space = len(measured), spectral_space(tissue, at)
    parameters, sigma = np.full((count, 5), np.nan), np.full((count, 5), np.nan)
    covariance, rmse = np.full((count, 5, 5), np.nan), np.full(count, np.nan)
    model = np.full(measured.shape, np.nan)
    rows = np.flatnonzero(good)
    for start in range(0, len(rows), BATCH):
        part = rows[start : start + BATCH]
        found = _fit(space, albedo[part], len(at))
        parameters[part], covariance[part], squares = found
        rmse[part] = (1 - specular) * np.sqrt(squares / len(at))
        seen = space.reflectance(parameters[part])
        model[part] = specular + (1 - specular) * seen
        if progress:
            progress(min(start + BATCH, len(rows)), len(rows))
    sigma = np.sqrt(np.einsum("npp->np", covariance))
    return SpectraFit(parameters, sigma, covariance, rmse, model)


def _fit(space: AlbedoSpace, albedo: Array, bands: int) -> tuple[Array, Array, Array]:
    """Parameters (n, 5), covariances (n, 5, 5), sums of squares (n,)."""
    from cutis.inverse.spectra_kernel import spectra_kernel

    power = np.array([p.root for p in PARAMETERS], dtype=np.float32)
    low = np.array([p.low ** (1 / p.root) for p in PARAMETERS], dtype=np.float32)
    span = np.array([p.high ** (1 / p.root) for p in PARAMETERS], dtype=np.float32) - low
    weight = np.full(5, bands * PULL**2 / WIDTH**2)
    best = np.empty((len(albedo), 5), dtype=np.float32)
    squares, hessian = np.empty(len(albedo)), np.empty((len(albedo), 5, 5))
    spectra_kernel(
        np.ascontiguousarray(albedo, dtype=np.float32), logit(STARTS),
        logit(CENTRE).astype(np.float64), weight, ITERATIONS, (low, span, power), space.slots,
        space.model[:4], best, squares, hessian,
    )  # fmt: skip
    u = logistic(best).astype(np.float64)
    root = low + u * span
    parameters = np.asarray(root**power, dtype=np.float64)
    slope = power * root ** (power - 1) * span * u * (1 - u)  # by logit
    variance = np.maximum(squares / max(bands - 5, 1), NOISE**2)
    # the prior's share of the Hessian keeps what it is worth, whatever the residual
    prior = np.eye(5) / WIDTH**2
    data = hessian - np.diag(weight)
    covariance = np.linalg.inv(data / variance[:, None, None] + prior)
    return parameters, covariance * slope[:, :, None] * slope[:, None, :], squares


def check_wavelengths(wavelengths: ArrayLike) -> Array:
    """(m,) nm; CutisError where they cannot be those of a spectrum of skin."""
    at = np.asarray(wavelengths, dtype=np.float64)
    if at.ndim != 1 or not np.isfinite(at).all() or (at.size > 1 and not (np.diff(at) > 0).all()):
        raise CutisError("wavelengths must be finite numbers in nm, each larger than the last")
    if at.size and at.max() < 3:
        raise CutisError(f"wavelengths up to {at.max():g} look like µm; give them in nm")
    low, high = WAVELENGTHS[[0, -1]]
    if at.size and not (at[0] >= low and at[-1] <= high):
        raise CutisError(
            f"wavelengths {at[0]:g} to {at[-1]:g} nm reach beyond {low:g} to {high:g}; leave out "
            "what lies beyond"
        )
    if at.size < len(PARAMETERS):
        raise CutisError(f"{at.size} wavelengths are too few for {len(PARAMETERS)} parameters")
    return at


def check_reflectance(measured: Array) -> None:
    """CutisError where values are no reflectances of skin."""
    if not measured.size:
        return
    low, high = float(measured.min()), float(measured.max())
    if high > 1.2:
        hint = "they look like per cent; divide by 100" if high <= 120 else "check the file"
        raise CutisError(f"reflectances reach {high:g}; {hint}")
    if low < -0.05:
        raise CutisError(f"reflectances go down to {low:g}; they cannot be negative")


def spectral_space(tissue: Tissue, wavelengths: Array) -> AlbedoSpace:
    """The albedo space of a tissue at other wavelengths; built where they are not its own."""
    if len(wavelengths) == len(WAVELENGTHS) and np.array_equal(wavelengths, WAVELENGTHS):
        return albedo_space(tissue)
    places = np.searchsorted(WAVELENGTHS, wavelengths)
    if np.array_equal(WAVELENGTHS[np.minimum(places, len(WAVELENGTHS) - 1)], wavelengths):
        return _subset(tissue, tuple(int(i) for i in places))
    return _built(tissue, tuple(float(v) for v in wavelengths))


@lru_cache(maxsize=4)
def _subset(tissue: Tissue, places: tuple[int, ...]) -> AlbedoSpace:
    from dataclasses import replace

    table, rows = albedo_space(tissue).table, list(places)
    return AlbedoSpace(replace(
        table, nodes=table.nodes[rows], coefficients=np.ascontiguousarray(table.coefficients[rows]),
        low=table.low[rows], high=table.high[rows], wavelengths=table.wavelengths[rows],
    ))  # fmt: skip


@lru_cache(maxsize=4)
def _built(tissue: Tissue, wavelengths: tuple[float, ...]) -> AlbedoSpace:
    return AlbedoSpace(build(tissue, wavelengths=np.array(wavelengths)))
