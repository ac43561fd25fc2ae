"""What `validation.py` measures: fits, implied spectra, intervals, on skins left out."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from rich.progress import track
from scipy.stats import norm

from cutis.albedo import albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.colour import delta_e, reflectance_to_rgb, spectrum_to_rgb, upsample
from cutis.colour.observer import wavelengths
from cutis.inverse import SpectralFitter, load_model
from cutis.inverse.prior import unit_slopes
from cutis.inverse.shipped import EXACT
from cutis.optics import (
    ALIAGA2022,
    MEASURED2026,
    MEASURED2026B,
    Tissue,
    from_coordinates,
    to_coordinates,
)
from studies.figures.measured import BANDS, FACE_SITES, NIST, ArchivedSkins
from studies.prior_training import train_prior

Array = np.ndarray
TISSUES = (ALIAGA2022, MEASURED2026, MEASURED2026B)
"""Tissues whose fits are told; intervals are judged by the parameters that the last one gives."""
CALIBRATED = TISSUES[1:]
JUDGED = TISSUES[-1]
MODELS = (*(t.name for t in CALIBRATED), EXACT, "aliaga2022")
PER_BAND = 600
"""Skins of a band of ITA° that a prior of the validation is trained on, at most."""
FOLDS = 5
LIGHTS = ("A", "FL11", "LED-B3")
LEVELS = (0.5, 0.68, 0.8, 0.9, 0.95)
"""Nominal shares of intervals."""
LEARNED = f"cutis `{JUDGED.name}`"
FARTHEST_LOGIT = 6.2
"""Bound on logits of fitted parameters where people are compared: fits that end at an end."""


@dataclass(frozen=True, eq=False)
class Held:
    """What colours alone told of skins (n): parameters, σ in units and in network coordinates."""

    values: Array
    sigma: Array
    coordinate_sigma: Array


@dataclass(eq=False)
class Study:
    """Measured skins and all that was found about them; spectra are as measured."""

    skins: ArchivedSkins
    per_band: int
    """Skins of a band of ITA° that a prior was trained on, at most."""
    fits: dict[str, Array] = field(default_factory=dict)
    """Spectra fitted by a tissue."""
    true: Array = field(default_factory=lambda: np.empty((0, 5)))
    """(n, 5) parameters that explain the whole spectra, by JUDGED."""
    persons: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    """By tissue, standard deviations (5,) of logits within a person's face and between faces."""
    odd: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    """By tissue, of fits to every other wavelength judged on the others: mean RMSE, worst bias, at
    nm."""
    implied: dict[str, Array] = field(default_factory=dict)
    """Spectra by method, from RGB alone."""
    held: dict[str, Held] = field(default_factory=dict)
    loop: Array = field(default_factory=lambda: np.empty(0))
    """(n,) ΔE00 of the closed loop of the model of JUDGED."""

    @property
    def issa(self) -> Array:
        """(n,) which are of ISSA."""
        return self.skins.origins != NIST

    def rmse(self, spectra: Array) -> Array:
        """(n,) RMS over wavelengths of spectra against the measured ones."""
        return np.sqrt(((spectra - self.skins.spectra) ** 2).mean(axis=1))

    def relit(self, spectra: Array, light: str) -> Array:
        """(n,) ΔE00 between spectra and the measured ones under a light, balanced on it."""
        a, b = (reflectance_to_rgb(s, BANDS, light) for s in (spectra, self.skins.spectra))
        return delta_e(a, b)

    def inside(self, held: Held, level: float = 0.9) -> Array:
        """(n, 5) whether the parameters lie in the intervals that should hold `level` of them."""
        reach = norm.ppf(0.5 + level / 2) * held.sigma
        return np.abs(self.true - held.values) <= reach


def measured(skins: ArchivedSkins, albedo: Array) -> Array:
    """Spectra as the instrument sees them, the surface included."""
    return skins.specular + (1 - skins.specular) * np.asarray(albedo, dtype=np.float64)


def study(skins: ArchivedSkins, per_band: int = PER_BAND, models: Iterable[str] = MODELS) -> Study:
    """Everything, on these skins."""
    found, colours = Study(skins, per_band), skins.albedo.astype(np.float32)
    for tissue in track(TISSUES, "fits of spectra"):
        fitter = SpectralFitter(BANDS, tissue, specular=skins.specular)
        fit = fitter.fit(skins.spectra)
        found.true = fit.values
        found.fits[tissue.name] = fitter.reflectance(fit.values, fit.scattering)
        found.persons[tissue.name] = within_and_between(skins, fit.values)
        found.odd[tissue.name] = every_other(skins, tissue)
    for what, parts in (("origin", skins.origins), ("subject", subject_folds(skins))):
        name = f"{LEARNED}, {what}s left out"
        found.implied[name], found.held[what] = left_out(skins, parts, per_band, what)
        learned = measured(skins, regression(skins, parts))
        found.implied[f"linear regression, {what}s left out"] = learned
    for name in models:
        model = load_model(name)
        values = model.encode(colours).astype(np.float64)
        spectra = SampledSpace(albedo_space(model.tissue), BANDS).reflectance(values)
        label = f"cutis `{name}`, as shipped"
        found.implied[label] = measured(skins, spectra)
        if model.tissue == JUDGED:
            found.loop = delta_e(model.decode(values), colours)
        trust = model.trust(colours)
        if trust is not None and model.tissue == JUDGED:
            sigma = trust[:, :5].astype(np.float64)
            slopes = unit_slopes(to_coordinates(values).astype(np.float64))
            found.held["shipped"] = Held(values, sigma, sigma / slopes)
    for name, method in (("Jakob & Hanika 2019", jakob_hanika), ("Mallett & Yuksel 2019", mallett)):
        found.implied[name] = measured(skins, method(colours.astype(np.float64)))
    return found


def within_and_between(skins: ArchivedSkins, values: Array) -> tuple[Array, Array]:
    """Standard deviations (5,) of logits between sites of one face, and between all sites.

    `values` (n, 5) are parameters that were fitted to each spectrum by itself.
    """
    face = np.isin(skins.sites, FACE_SITES)
    u = np.asarray(to_coordinates(values[face]), dtype=np.float64)
    least = 1 / (1 + np.exp(FARTHEST_LOGIT))
    u = np.clip(u, least, 1 - least)
    z = np.log(u / (1 - u))
    _, of, number = np.unique(skins.subjects[face], return_inverse=True, return_counts=True)
    means = np.stack([np.bincount(of, column) / number for column in z.T], axis=1)
    within = np.sqrt(((z - means[of]) ** 2).sum(axis=0) / max((number - 1).sum(), 1))
    return within, z.std(axis=0)


def every_other(skins: ArchivedSkins, tissue: Tissue) -> tuple[float, float, float]:
    """Fits to every other wavelength, judged on the others, of ISSA: RMSE, worst bias, at nm."""
    spectra, seen = skins.spectra[skins.origins != NIST], np.arange(len(BANDS)) % 2 == 0
    some = SpectralFitter(BANDS[seen], tissue, specular=skins.specular).fit(spectra[:, seen])
    others = SpectralFitter(BANDS[~seen], tissue, specular=skins.specular)
    wrong = others.reflectance(some.values, some.scattering) - spectra[:, ~seen]
    bias = wrong.mean(axis=0)
    at = int(np.abs(bias).argmax())
    return float(np.sqrt((wrong**2).mean(axis=1)).mean()), float(bias[at]), float(BANDS[~seen][at])


def subject_folds(skins: ArchivedSkins) -> Array:
    """(n,) which of FOLDS parts the subject of each skin is in."""
    names, of = np.unique(skins.subjects, return_inverse=True)
    return np.random.default_rng(1).permutation(len(names))[of] % FOLDS


def evenly(skins: ArchivedSkins, rows: Array, per_band: int) -> Array:
    """At most `per_band` of these rows from every band of ITA°, at random."""
    rng, bands = np.random.default_rng(0), skins.bands[rows]
    return np.concatenate(
        [rng.permutation(rows[bands == band])[:per_band] for band in np.unique(bands)]
    )


def left_out(
    skins: ArchivedSkins, parts: Array, per_band: int, what: str, tissue: Tissue = JUDGED
) -> tuple[Array, Held]:
    """Spectra and intervals of the skins of every part by a prior that has not seen the part."""
    space, colours = albedo_space(tissue), skins.albedo.astype(np.float32)
    u, sigma = np.empty((len(colours), 5)), np.empty((len(colours), 5))
    for part in track(np.unique(parts), f"{what}s left out"):
        out = np.flatnonzero(parts == part)
        rest = evenly(skins, np.flatnonzero(parts != part), per_band)
        prior = train_prior(skins.some(rest), tissue)
        u[out] = prior.skins(space, colours[out])
        sigma[out], _ = prior.trust(space, colours[out], u[out])
    values = from_coordinates(u)
    spectra = measured(skins, SampledSpace(space, BANDS).reflectance(values))
    return spectra, Held(values, sigma * unit_slopes(u), sigma)


def regression(skins: ArchivedSkins, parts: Array) -> Array:
    """(n, w) albedo as a constant and multiples of R, G, B, fitted to the other parts."""
    terms = np.column_stack([np.ones(len(skins.spectra)), skins.albedo])
    albedo = (skins.spectra - skins.specular) / (1 - skins.specular)
    found = np.empty_like(albedo)
    for part in np.unique(parts):
        out = parts == part
        found[out] = terms[out] @ np.linalg.lstsq(terms[~out], albedo[~out], rcond=None)[0]
    return found


def mallett(colours: Array) -> Array:
    """(n, 3) → (n, w) albedo by the basis of three reflectances [mallett2019]."""
    return upsample(colours)[:, np.isin(wavelengths(), BANDS)]


def jakob_hanika(colours: Array) -> Array:
    """(n, 3) → (n, w) albedo 1/2 + x / (2 √(1 + x²)), x quadratic in wavelength [jakob2019].

    The three coefficients that give the colour, by damped Newton steps.
    """
    t = (wavelengths() - 550) / 150
    terms, to_rgb = np.stack([np.ones_like(t), t, t**2], axis=1), spectrum_to_rgb(wavelengths())
    grey = np.clip(2 * colours.mean(axis=1) - 1, -0.99, 0.99)
    c = np.zeros((len(colours), 3))
    c[:, 0] = grey / np.sqrt(1 - grey**2)
    damping = np.full(len(colours), 1e-3)
    error, spectra, slopes = np.full(len(colours), np.inf), np.empty((len(c), len(t))), None
    trial = c
    for _ in range(100):
        x = trial @ terms.T
        new = 0.5 + x / (2 * np.sqrt(1 + x**2))
        wrong = new @ to_rgb - colours
        better = (wrong**2).sum(axis=1) < error
        if slopes is None:
            slopes, miss = np.empty((len(c), 3, 3)), wrong.copy()
        c[better], spectra[better], miss[better] = trial[better], new[better], wrong[better]
        error[better] = (wrong[better] ** 2).sum(axis=1)
        rise = 0.5 * (1 + x[better] ** 2) ** -1.5
        slopes[better] = np.einsum("nw,wk,wc->nck", rise, terms, to_rgb, optimize=True)
        damping = np.where(better, damping * 0.2, damping * 8)
        square = np.swapaxes(slopes, 1, 2) @ slopes
        square += (damping[:, None] * np.diagonal(square, axis1=1, axis2=2))[:, :, None] * np.eye(3)
        lever = np.einsum("nck,nc->nk", slopes, miss)
        trial = c - np.linalg.solve(square, lever[..., None])[..., 0]
    return spectra[:, np.isin(wavelengths(), BANDS)]
