"""The skin that best explains a reflectance spectrum, and how well the spectrum tells it.

For each spectrum m at wavelengths λ the fit minimises

    Σ_λ (ρ + (1 − ρ) f(u, λ) − m(λ))²,   u ∈ [0, 1]ᵖ,

over network coordinates u, f being the albedo space at λ and ρ what the surface reflects at once
(0 where the instrument leaves that out). Levenberg–Marquardt with exact slopes starts from the
nearest skins of a library, one from each part of it, and keeps the lowest end.

The covariance is that of coordinates, (JᵀJ / σ² + 12 I)⁻¹, brought to units by the slopes
∂parameter/∂u. σ² is the residual's Σ/(n − p), or `noise`². 12 is the precision of a coordinate of
which nothing is known but its range, so that what a spectrum does not tell gets the width of its
range instead of infinity. A residual that is not noise but the model's error goes from wavelength
to wavelength in waves: σ is then a scale of how far parameters are from what another, equally good
model would say, no more.

Of a tissue whose skins also differ in what its parameters do not say, the most probable skin is
found instead, under what is expected (`expectation.py`): by logits of u, from the same starts. Its
covariance is the inverse of the curvature of that cost, with the hidden variables free.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.errors import CutisError
from cutis.inverse.expectation import PIVOT, Expectation, expected_of
from cutis.inverse.fit import logit
from cutis.optics import (
    NAMES,
    RARE_NAMES,
    WAVELENGTHS,
    Parameter,
    Tissue,
    axes,
    with_rare_chromophores,
)

LIBRARY = 4096
"""Skins among which starts are looked up."""
PARTS = 8
"""Parts of the library, each of which gives a start: low and high thickness, eumelanin, blood."""
ITERATIONS = 60
LARGEST_SHIFT = 10.0
"""nm by which wavelengths may be said to be off."""
UNKNOWN = 12.0
"""Precision of a coordinate that is uniform in [0, 1]."""
LEAST_NOISE = 1e-5
"""Standard deviation of the table itself; no residual is believed to be smaller."""
NO_RESIDUAL = 0.005
"""Noise taken where there are no more wavelengths than free parameters and none is given."""
BATCH = 1 << 13
"""Spectra fitted at a time."""
LARGEST_LOGIT = 4.0
"""Bound on logits that fits start from: nearer to an end, slopes are too flat to leave it."""
RARE_LOGIT = (-3.0, 3.0)
"""What is expected of the logit of a rare chromophore: hardly any, and how loosely."""


@dataclass(frozen=True, eq=False)
class SpectralFit:
    """Skins (n, p) that explain n spectra, in the units and order of `parameters`.

    `values` (n, p) float64; `covariance` (n, p, p) in the same units, 0 for what was held; `rmse`
    (n,) of the reflectance as measured. Of spectra with fewer usable wavelengths than free
    parameters, all are NaN. `scattering` (n, 2) is ln a and b of the dermis beyond what the tissue
    says of it, where its skins differ in that.
    """

    parameters: tuple[Parameter, ...]
    values: NDArray[np.float64]
    covariance: NDArray[np.float64]
    rmse: NDArray[np.float64]
    scattering: NDArray[np.float64] | None = None

    @property
    def sigma(self) -> NDArray[np.float64]:
        """(n, p) standard deviations."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))


class SpectralFitter:
    """Fits spectra at the same wavelengths; makes its library of starts once."""

    def __init__(
        self,
        wavelengths: ArrayLike,
        tissue: Tissue,
        *,
        specular: float = 0.0,
        shift: float = 0.0,
        held: Mapping[str, float] | None = None,
        noise: float | None = None,
        free: Sequence[str] = (),
    ) -> None:
        """Arguments and errors are those of `fit_spectra`."""
        if not 0 <= specular < 0.2:
            raise CutisError(f"specular = {specular:g}: a surface of skin reflects 0 to 0.2")
        if not abs(shift) <= LARGEST_SHIFT:
            raise CutisError(f"shift = {shift:g} nm: no spectrophotometer is off by more than 10")
        if noise is not None and not 0 < noise < 1:
            raise CutisError(f"noise = {noise:g}: it must lie between 0 and 1")
        self.specular, self.noise = float(specular), noise
        tissue, self._held, self._told = _with_rare(tissue, dict(held or {}), free)
        self.space: AlbedoSpace = albedo_space(tissue)
        self.expected: Expectation | None = expected_of(tissue)
        self.sampled = SampledSpace(self.space, _shifted(wavelengths, shift))
        self.free = _free(tissue, self._held)
        if not self.free.any():
            raise CutisError("every parameter is held; leave one free to fit")
        if len(np.unique(self.sampled.wavelengths)) < self.free.sum():
            loose = [
                known.name for known, free in zip(tissue.parameters, self.free, strict=True) if free
            ]
            example = "oxygenation" if "oxygenation" in loose else loose[-1]
            raise CutisError(
                f"{len(np.unique(self.sampled.wavelengths))} wavelengths are too few for "
                f"{self.free.sum()} free parameters; hold some of them, {example} for one"
            )
        self._library, self._spectra, self._part = self._make_library()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """What is fitted or held, in the order of results."""
        return tuple(self._parameters[i] for i in self._told)

    @property
    def _parameters(self) -> tuple[Parameter, ...]:
        """The same with rare chromophores that nobody asked for, which are held at 0."""
        return self.space.tissue.parameters

    def fit(self, spectra: ArrayLike, weights: ArrayLike | None = None) -> SpectralFit:
        """(n, wavelengths) reflectance → skins; NaN marks what was not measured.

        `weights` of the same shape (or one per wavelength) scale squared residuals.
        """
        measured = np.asarray(spectra, dtype=np.float64)
        bands = len(self.sampled.wavelengths)
        if measured.ndim != 2 or measured.shape[1] != bands:
            raise CutisError(f"spectra must be (n, {bands}), not of shape {measured.shape}")
        weight = np.broadcast_to(1.0 if weights is None else np.asarray(weights), measured.shape)
        count, size = len(measured), len(self._parameters)
        found = SpectralFit(
            self._parameters,
            np.empty((count, size)),
            np.empty((count, size, size)),
            np.empty(count),
            None if self.expected is None else np.empty((count, 2)),
        )
        for start in range(0, count, BATCH):
            part = slice(start, start + BATCH)
            self._fit(measured[part], weight[part], found, part)
        told = list(self._told)
        if len(told) == size:
            return found
        return replace(
            found,
            parameters=self.parameters,
            values=found.values[:, told],
            covariance=found.covariance[:, told][:, :, told],
        )

    def reflectance(
        self, values: ArrayLike, scattering: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """(n, p) skins → (n, wavelengths) reflectance as the instrument sees it.

        With `scattering` (n, 2), that of `SpectralFit`, of dermis that scatters so.
        """
        skins = np.zeros((len(np.asarray(values)), len(self._parameters)))
        skins[:, list(self._told)] = values
        if scattering is None:
            albedo = self.sampled.reflectance(skins)
        else:
            from cutis.inverse.expected_fit_kernel import scattered

            rows, _ = self.space.rows(skins)
            rows = np.ascontiguousarray(rows, dtype=np.float32)
            albedo = np.empty((len(rows), len(self.sampled.wavelengths)), np.float32)
            hidden = np.ascontiguousarray(scattering, dtype=np.float64)
            scattered(len(rows), rows, hidden, self.sampled.model, self._powers, albedo)
        return np.asarray(self.specular + (1 - self.specular) * albedo, dtype=np.float64)

    @property
    def _powers(self) -> NDArray[np.float64]:
        return np.asarray(np.log(self.sampled.wavelengths / PIVOT))

    def _fit(
        self, measured: NDArray[np.float64], weight: NDArray[np.floating], found: SpectralFit,
        part: slice,
    ) -> None:  # fmt: skip
        from cutis.inverse.spectral_kernel import fit_kernel

        known = np.isfinite(measured) & (weight > 0)
        w = np.where(known, weight, 0.0).astype(np.float32)
        y = np.where(known, (measured - self.specular) / (1 - self.specular), 0.0)
        y = y.astype(np.float32)
        used = known.sum(axis=1)
        every = self.space.every_parameter
        best = np.empty((len(y), len(every)))
        matrices = np.empty((len(y), len(every), len(every)))
        costs = np.empty(len(y))
        starts, held = self.starts(y, w), np.ones(len(every), dtype=np.bool_)
        held[list(self.space.places)] = ~self.free
        if self.expected is not None:
            return self._fit_expected(y, w, starts, known, self.expected, found, part)
        ranges = axes(every, dict(self.space.tissue.fixed)).astype(np.float32)
        fit_kernel(
            len(y), y, w, starts, held, ITERATIONS, ranges, self.sampled.model, best, matrices,
            costs,
        )  # fmt: skip
        places = list(self.space.places)
        u = best[:, places]
        values = np.stack(
            [p.from_coordinate(u[:, i]) for i, p in enumerate(self._parameters)], axis=-1
        )
        for i, p in enumerate(self._parameters):
            if p.name in self._held:
                values[:, i] = self._held[p.name]
        unit = 1 - self.specular
        mean = np.where(known, weight, 0.0).sum(axis=1) / np.maximum(used, 1)
        spread = unit**2 * costs / np.where(mean > 0, mean, 1.0)  # Σ residual², as measured
        bad = used < self.free.sum()
        found.values[part] = np.where(bad[:, None], np.nan, values)
        found.rmse[part] = np.where(bad, np.nan, np.sqrt(spread / np.maximum(used, 1)))
        variance = self._variance(spread, used) / unit**2
        covariance = self._covariance(matrices[:, places][:, :, places], variance, mean, u)
        found.covariance[part] = np.where(bad[:, None, None], np.nan, covariance)

    def _fit_expected(
        self, y: NDArray[np.float32], weight: NDArray[np.float32], starts: NDArray[np.float64],
        known: NDArray[np.bool_], expected: Expectation, found: SpectralFit, part: slice,
    ) -> None:  # fmt: skip
        from cutis.inverse.expected_fit_kernel import fit_expected

        every, unit = self.space.every_parameter, 1 - self.specular
        size = len(every)
        # the five, then rare chromophores, then ln a and b
        order = [*range(len(NAMES)), size, size + 1]
        precision = np.zeros((size + 2, size + 2))
        precision[np.ix_(order, order)] = expected.precision
        centre = np.zeros(size + 2)
        centre[: len(NAMES)] = expected.centre
        for i in range(len(NAMES), size):
            centre[i], precision[i, i] = RARE_LOGIT[0], RARE_LOGIT[1] ** -2
        held = np.full(size, -1.0)
        for i, p in enumerate(every):
            if p.name in self._held:
                held[i] = p.to_coordinate(self._held[p.name])
        first = np.zeros((*starts.shape[:2], size + 2))
        first[..., :size] = np.clip(logit(starts), -LARGEST_LOGIT, LARGEST_LOGIT)
        noise = expected.noise if self.noise is None else self.noise
        scaled = (weight * (unit / noise) ** 2).astype(np.float32)
        best, costs = np.empty((len(y), size + 2)), np.empty(len(y))
        matrices = np.empty((len(y), size + 2, size + 2))
        ranges = axes(every, dict(self.space.tissue.fixed)).astype(np.float32)
        fit_expected(
            len(y), y, scaled, first, centre, precision, held, ITERATIONS, ranges,
            self.sampled.model, self._powers, best, matrices, costs,
        )  # fmt: skip
        u = 1 / (1 + np.exp(-best[:, :size]))
        values = np.stack([p.from_coordinate(u[:, i]) for i, p in enumerate(every)], axis=-1)
        for i, p in enumerate(every):
            if p.name in self._held:
                values[:, i] = self._held[p.name]
        used = known.sum(axis=1)
        bad = used < self.free.sum()
        wrong = self.reflectance(values[:, list(self._told)], best[:, size:]) - self.specular
        residual = np.where(known, wrong - unit * y, 0.0)
        found.rmse[part] = np.sqrt((residual**2).sum(axis=1) / np.maximum(used, 1))
        loose = [*np.flatnonzero(held < 0), size, size + 1]
        inverse = np.linalg.inv(matrices[:, loose][:, :, loose])
        slope = np.stack([p.slope(u[:, i]) * u[:, i] * (1 - u[:, i]) for i, p in enumerate(every)])
        some = loose[:-2]
        covariance = np.zeros((len(y), size, size))
        covariance[:, np.array(some)[:, None], some] = inverse[:, :-2, :-2]
        covariance *= slope.T[:, :, None] * slope.T[:, None, :]
        assert found.scattering is not None
        for values_of, told in (
            (found.values, values),
            (found.covariance, covariance),
            (found.scattering, best[:, size:]),
        ):
            values_of[part] = told
            values_of[part][bad] = np.nan
        found.rmse[part][bad] = np.nan

    def _variance(
        self, spread: NDArray[np.float64], used: NDArray[np.intp]
    ) -> NDArray[np.float64]:  # fmt: skip
        """(n,) variance of the reflectance as measured."""
        if self.noise is not None:
            return np.full(len(spread), self.noise**2)
        spare = used - self.free.sum()
        estimated = np.where(spare > 0, spread / np.maximum(spare, 1), NO_RESIDUAL**2)
        return np.asarray(np.maximum(estimated, LEAST_NOISE**2))

    def _covariance(
        self, matrices: NDArray[np.float64], variance: NDArray[np.float64],
        mean: NDArray[np.floating], u: NDArray[np.float64],
    ) -> NDArray[np.float64]:  # fmt: skip
        free = np.flatnonzero(self.free)
        scale = np.maximum(variance * np.where(mean > 0, mean, 1.0), 1e-30)
        inner = matrices[:, free][:, :, free] / scale[:, None, None]
        inner += UNKNOWN * np.eye(len(free))
        inverse = np.linalg.inv(inner)
        slope = np.stack([self._parameters[i].slope(u[:, i]) for i in free], axis=1)
        whole = np.zeros((len(u), len(self._parameters), len(self._parameters)))
        whole[:, free[:, None], free] = inverse * slope[:, :, None] * slope[:, None, :]
        return whole

    def starts(
        self, y: NDArray[np.float32], weight: NDArray[np.float32]
    ) -> NDArray[np.float64]:  # fmt: skip
        """(n, PARTS, every parameter) coordinates: of each part of the library, the nearest."""
        distance = weight @ (self._spectra**2).T - 2 * (weight * y) @ self._spectra.T
        nearest = [
            np.flatnonzero(self._part == k)[distance[:, self._part == k].argmin(axis=1)]
            for k in np.unique(self._part)
        ]
        return np.ascontiguousarray(np.swapaxes(self._library[np.array(nearest)], 0, 1))

    def _make_library(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.intp]]:
        from scipy.stats import qmc

        every, places = self.space.every_parameter, list(self.space.places)
        u = qmc.Halton(len(places), scramble=True, rng=0).random(LIBRARY)
        held = {**dict(self.space.tissue.fixed), **self._held}
        for i, p in enumerate(self._parameters):
            if p.name in held:
                u[:, i] = p.to_coordinate(held[p.name])
        free = [p.from_coordinate(u[:, i]) for i, p in enumerate(self._parameters)]
        spectra = self.sampled.reflectance(np.stack(free, axis=-1))
        library = np.empty((LIBRARY, len(every)))
        for i, p in enumerate(every):
            if i in places:
                library[:, i] = u[:, places.index(i)]
            else:
                library[:, i] = p.to_coordinate(held[p.name])
        part = np.zeros(LIBRARY, dtype=np.intp)
        for bit, name in enumerate(("thickness", "eumelanin", "oxygenation")):
            i = NAMES.index(name)
            part += (library[:, i] > 0.5).astype(np.intp) << bit
        return library, spectra, part


def fit_spectra(
    reflectance: ArrayLike,
    wavelengths: ArrayLike,
    tissue: Tissue,
    *,
    specular: float = 0.0,
    shift: float = 0.0,
    held: Mapping[str, float] | None = None,
    noise: float | None = None,
    free: Sequence[str] = (),
) -> SpectralFit:
    """(n, w) reflectance, 0 to 1, at wavelengths (w,) in 380–780 nm → skins with covariance.

    NaN marks what was not measured. `specular` is ρ, 0.028 for spectra of n = 1.4 with the surface
    included; `shift` how many nm the instrument's wavelengths are too short; `held`
    gives parameters, by name, that are known; `noise` the standard deviation of a reflectance, by
    default taken from the residual. `free` names rare chromophores (`optics.RARE`) to be found too:
    of a tissue that has none, those neither in `free` nor in `held` are 0 and not in the result.
    Raises CutisError for wavelengths outside or fewer than free parameters, for values held outside
    their range, and names that are not rare chromophores.
    """
    fitter = SpectralFitter(
        wavelengths, tissue, specular=specular, shift=shift, held=held, noise=noise, free=free
    )
    return fitter.fit(reflectance)


def _shifted(wavelengths: ArrayLike, shift: float) -> NDArray[np.float64]:
    """True wavelengths, nm; those that the shift takes over an end of the table rest on it."""
    stated = np.asarray(wavelengths, dtype=np.float64)
    first, last = WAVELENGTHS[0], WAVELENGTHS[-1]
    inside = (stated >= first) & (stated <= last)
    return np.where(inside, np.clip(stated + shift, first, last), stated)


def _with_rare(
    tissue: Tissue, held: dict[str, float], free: Sequence[str]
) -> tuple[Tissue, dict[str, float], tuple[int, ...]]:
    """The tissue with the rare chromophores asked for, all that is held, places of results."""
    for name in free:
        if name not in RARE_NAMES:
            listed = ", ".join(RARE_NAMES)
            raise CutisError(f"{name} cannot be freed; what can is {listed}, the five are free")
        if name in held:
            raise CutisError(f"{name} is both free and held at {held[name]:g}; choose one")
    asked = {*free, *held} & {*RARE_NAMES}
    if asked and not tissue.rare_chromophores:
        tissue = with_rare_chromophores(tissue)
        absent = [name for name in RARE_NAMES if name not in asked]
        held = {**held, **dict.fromkeys(absent, 0.0)}
    else:
        absent = []
    told = (i for i, p in enumerate(tissue.parameters) if p.name not in absent)
    return tissue, held, tuple(told)


def _free(tissue: Tissue, held: Mapping[str, float]) -> NDArray[np.bool_]:
    """(p,) which of the tissue's parameters are to be found."""
    names = [p.name for p in tissue.parameters]
    for name, value in held.items():
        if name not in names:
            listed = ", ".join(names)
            raise CutisError(f"{name} is not a free parameter of {tissue.name}; those are {listed}")
        tissue.parameters[names.index(name)].check(float(value))
    return np.array([name not in held for name in names])
