"""The prior of measured skin, learned from reflectance spectra.

What counts is the spectrum that a colour implies. With u(c) the most probable skin of the colour c
of a measured spectrum m (`prior.py`), ρ the surface and f(u, λ) the albedo space, the means are
moved by Gauss–Newton to minimise

    Σ_skins w · RMS_λ (ρ + (1 − ρ) f(u(c), λ) − m(λ)),

every band of ITA° weighing the same, with a weak pull to the skins that fit the whole spectra, the
most probable ones under the spread of all (dark skins say little of their blood). The
slope of u by the expectation is, to first order, that of a fit that keeps the colour, I − K J, J
being the slope of colour by logits and K = P⁻¹Jᵀ (J P⁻¹ Jᵀ + s²)⁻¹; steps that do not help are cut.

Spreads are the ninth decile of |parameter − estimate|, over slope, as a function of the colour
(`SkinPrior.spread_features`), by linear quantile regression of logarithms [koenker1978] on skins of
subjects that were left out, weighted by the root of the weights above: bands that are nearly even,
without a few skins of a rare one ruling.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.colour import ita, reflectance_to_rgb
from cutis.inverse.fit import logit
from cutis.inverse.prior import TOLERANCE, SkinPrior, log_colours, unit_slopes
from cutis.inverse.spectral_fit import SpectralFitter
from cutis.optics import MEASURED2026B, Tissue, from_coordinates, to_coordinates

Array = NDArray[np.float64]
ITA_BANDS = (-30.0, 10.0, 28.0, 41.0, 55.0)
"""ITA° between the bands dark, brown, tan, intermediate, light and very light [chardon1991ita]."""
EDGE = 0.1
"""Fitted coordinates this near to an end of their range count as this far, so that logits stay."""
SLACK = 0.02
"""Added to the covariance of logits around the means."""
PULL, PULLS = 0.02, {MEASURED2026B.name: 0.004}
"""Weight of the pull to fitted skins, over the loss, and that of tissues with one of their own."""
INSIDE = 0.99
"""Share of measured skins within whose distance colours are those of measured skins."""
ITERATIONS, CONVERGED = 12, 1e-4
FOLDS = 5
"""Parts of the subjects, each left out once to find spreads."""
NINETY = 1.645
"""Standard deviations either side that hold nine of ten of a normal variable."""


@dataclass(frozen=True, eq=False)
class MeasuredSkins:
    """Spectra (n, w) of skins as measured at wavelengths (w,), nm, and who they are of.

    `subjects` (n,) names persons; `specular` is ρ, what the surface reflects at once.
    """

    spectra: Array
    wavelengths: Array
    subjects: NDArray[np.str_]
    specular: float

    @property
    def albedo(self) -> Array:
        """(n, 3) linear sRGB under D65 of the skins without their surface."""
        bare = (self.spectra - self.specular) / (1 - self.specular)
        return reflectance_to_rgb(bare, self.wavelengths)

    @property
    def bands(self) -> NDArray[np.intp]:
        """(n,) index of the ITA° band of each, from dark."""
        rgb = reflectance_to_rgb(self.spectra, self.wavelengths)
        return np.digitize(ita(rgb), ITA_BANDS)

    def some(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> "MeasuredSkins":
        """Those of some rows."""
        return replace(self, spectra=self.spectra[rows], subjects=self.subjects[rows])


def even_weights(bands: NDArray[np.intp]) -> Array:
    """(n,) weights, of sum 1, that let every band that occurs weigh the same."""
    weight = 1.0 / np.bincount(bands)[bands]
    return np.asarray(weight / weight.sum())


def train_prior(
    skins: MeasuredSkins,
    tissue: Tissue,
    progress: Callable[[int, int], None] | None = None,
    freedom: ArrayLike = (1.0, 1.0, 1.0, 1.0, 1.0),
) -> SkinPrior:
    """The prior of `tissue` from measured skins. `progress(done, total)` is called per fold.

    `freedom` (5,), above 0 and up to 1, is how far each parameter may follow the colour: less makes
    steadier maps whose spectra are farther from the measured ones (docs/decisions/0023).
    """
    fitter = SpectralFitter(skins.wavelengths, tissue, specular=skins.specular)
    found = fitter.fit(skins.spectra)
    fitted = np.asarray(to_coordinates(found.values), dtype=np.float64)
    slopes = unit_slopes(fitted)
    doubt = found.covariance / (slopes[:, :, None] * slopes[:, None, :])
    learner = _Learner(skins, tissue, fitted, doubt, freedom)
    folds = _folds(skins.subjects)
    rest = np.full(fitted.shape, np.nan)
    for k in range(FOLDS):
        out = folds == k
        prior = learner.learn(np.flatnonzero(~out))
        rest[out] = learner.errors(prior, np.flatnonzero(out))
        if progress:
            progress(k + 1, FOLDS + 1)
    prior = learner.learn(np.arange(len(fitted)))
    terms, even = prior.spread_features(learner.colours), np.sqrt(learner.weights)
    spreads = regression_quantiles(terms, rest, even / even.mean(), 0.9)
    spreads[0] -= np.log(NINETY)
    if progress:
        progress(FOLDS + 1, FOLDS + 1)
    return replace(prior, spreads=spreads)


def _folds(subjects: NDArray[np.str_]) -> NDArray[np.intp]:
    """(n,) which fold the subject of each skin is in."""
    names, of = np.unique(subjects, return_inverse=True)
    return np.random.default_rng(0).permutation(len(names))[of] % FOLDS


class _Learner:
    """Measured skins with what training needs of them."""

    def __init__(
        self, skins: MeasuredSkins, tissue: Tissue, fitted: Array, doubt: Array, freedom: ArrayLike
    ) -> None:
        self.skins, self.fitted, self.doubt = skins, fitted, doubt
        self.freedom = np.asarray(freedom, dtype=np.float64)
        self.pull = PULLS.get(tissue.name, PULL)
        self.space: AlbedoSpace = albedo_space(tissue)
        self.sampled = SampledSpace(self.space, skins.wavelengths)
        self.colours = skins.albedo.astype(np.float32)
        self.weights = even_weights(skins.bands)

    def learn(self, rows: NDArray[np.intp]) -> SkinPrior:
        """Means, precision and domain from some skins; spreads are 0."""
        u, w = self.fitted[rows], self.weights[rows] / self.weights[rows].sum()
        logs = log_colours(self.colours[rows])
        centre = w @ logs
        covariance = ((logs - centre) * w[:, None]).T @ (logs - centre)
        whitening = np.linalg.inv(np.linalg.cholesky(covariance))
        distance = np.sqrt((((logs - centre) @ whitening.T) ** 2).sum(axis=1))
        radius = np.array([_quantile(distance, w, INSIDE)])
        mean = w @ u
        away = np.abs(u - mean)
        sigma = np.array([_quantile(column, w, 0.9) for column in away.T]) / NINETY
        means, spreads = np.zeros((10, 5)), np.zeros((9, 5))
        start = SkinPrior(centre, whitening, radius, means, np.eye(5), spreads, sigma)
        terms = start.features(self.colours[rows])
        z = logit(np.clip(self._believed(rows, w), EDGE, 1 - EDGE)).astype(np.float64)
        z = w @ z + self.freedom * (z - w @ z)
        gram = terms.T @ (terms * w[:, None]) + 1e-4 * np.eye(terms.shape[1])
        means = np.linalg.solve(gram, terms.T @ (z * w[:, None]))
        around = z - terms @ means
        spare = (around * w[:, None]).T @ around + SLACK * np.diag(self.freedom**2)
        prior = replace(start, means=means, precision=np.linalg.inv(spare))
        return self._towards_spectra(prior, rows, terms, w)

    def _believed(self, rows: NDArray[np.intp], w: Array) -> Array:
        """(n, 5) fitted coordinates drawn to the mean of all as far as spectra leave them open."""
        u = self.fitted[rows]
        away = u - w @ u
        spread = (away * w[:, None]).T @ away
        solved = np.linalg.solve(spread + self.doubt[rows], away[:, :, None])[:, :, 0]
        return np.asarray(w @ u + solved @ spread)

    def _towards_spectra(
        self, prior: SkinPrior, rows: NDArray[np.intp], terms: Array, w: Array
    ) -> SkinPrior:
        """Moves the means to where the implied spectra are nearest to the measured ones."""
        start, damping, size = prior.means, 1e-3, prior.means.size
        residual = self._residuals(prior, rows)
        rms = np.sqrt((residual**2).mean(axis=1))
        cost, pulled = w @ rms, 0.0
        pull = self.pull * cost * np.kron(terms.T @ (terms * w[:, None]), prior.precision)
        for _ in range(ITERATIONS):
            slope = self._slopes(prior, rows)
            weight = w / np.maximum(rms, 1e-3) / residual.shape[1]
            inner = np.einsum("nlp,nlq,n->npq", slope, slope, weight, optimize=True)
            curve = np.einsum("nf,ng,npq->fpgq", terms, terms, inner, optimize=True).reshape(
                size, size
            )
            lever = np.einsum("nlp,nl,n->np", slope, residual, weight, optimize=True)
            gradient = (terms.T @ lever).ravel() + pull @ (prior.means - start).ravel()
            curve = curve + pull
            for _ in range(6):
                damped = curve + damping * np.diag(np.diag(curve)) + 1e-9 * np.eye(size)
                step = np.linalg.solve(damped, gradient).reshape(prior.means.shape)
                trial = replace(prior, means=prior.means - step)
                new = self._residuals(trial, rows)
                new_rms = np.sqrt((new**2).mean(axis=1))
                moved = (trial.means - start).ravel()
                new_pulled = 0.5 * moved @ pull @ moved
                gain = cost + pulled - w @ new_rms - new_pulled
                if gain > 0:
                    break
                damping *= 6
            if gain <= 0:
                break
            prior, residual, rms = trial, new, new_rms
            cost, pulled = w @ rms, new_pulled
            damping = max(damping * 0.2, 1e-6)
            if gain < CONVERGED * cost:
                break
        return prior

    def _residuals(self, prior: SkinPrior, rows: NDArray[np.intp]) -> Array:
        u = prior.skins(self.space, self.colours[rows])
        albedo = self.sampled.reflectance(from_coordinates(u.astype(np.float64)))
        rho = self.skins.specular
        return np.asarray(rho + (1 - rho) * albedo - self.skins.spectra[rows])

    def _slopes(self, prior: SkinPrior, rows: NDArray[np.intp]) -> Array:
        """(n, w, 5) slopes of implied spectra by the expected logits."""
        colours = self.colours[rows]
        u = prior.skins(self.space, colours).astype(np.float64)
        x = from_coordinates(u)
        _, by_band = self.sampled.gradient(x)
        _, by_channel = self.space.rgb_gradient(x)
        chain = (unit_slopes(u) * u * (1 - u))[:, None, :]
        spectrum = (1 - self.skins.specular) * by_band * chain
        colour = by_channel * chain
        error = TOLERANCE * (colours.mean(axis=1) + 0.01) ** (2 / 3)
        lever = colour @ np.linalg.inv(prior.precision)
        inner = lever @ np.swapaxes(colour, 1, 2) + np.eye(3) * (error**2)[:, None, None]
        gain = np.swapaxes(np.linalg.solve(inner, lever), 1, 2)
        return np.asarray(spectrum @ (np.eye(5) - gain @ colour))

    def errors(self, prior: SkinPrior, rows: NDArray[np.intp]) -> Array:
        """(n, 5) |fitted − estimated parameter| over the slope of parameter by coordinate."""
        u = prior.skins(self.space, self.colours[rows]).astype(np.float64)
        wrong = from_coordinates(self.fitted[rows]) - from_coordinates(u)
        return np.asarray(np.abs(wrong) / unit_slopes(u))


def _quantile(values: Array, weights: Array, share: float) -> float:
    """The value below which `share` of the weights (sum 1) lie."""
    order = np.argsort(values)
    place = min(int(np.searchsorted(np.cumsum(weights[order]), share)), len(values) - 1)
    return float(values[order[place]])


def regression_quantiles(terms: Array, values: Array, weights: Array, share: float) -> Array:
    """(m, p) coefficients c such that `share` of values (n, p) lie below exp(terms (n, m) · c).

    The dual of the linear program whose minimum is the regression quantile of the logarithms.
    """
    from scipy.optimize import linprog

    ends = np.stack([np.zeros(len(weights)), weights], axis=1)
    found = np.empty((terms.shape[1], values.shape[1]))
    for i, column in enumerate(np.log(np.maximum(values, 1e-6)).T):
        balance = (1 - share) * terms.T @ weights
        solved = linprog(-column, A_eq=terms.T, b_eq=balance, bounds=ends, method="highs")
        found[:, i] = -solved.eqlin.marginals
    return found
