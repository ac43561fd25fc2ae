"""What measured skins of a colour are like: the prior under which colours become skins.

Of the colour c of an albedo, y(c) are the whitened logarithms of its red, green and blue, each
with DARK added, and r their length. Beyond the measured skins, r > `radius`, y is drawn back:
its length becomes r (1 + (r / `radius`)⁸)^−⅛. With φ the ten terms of a quadratic in y, skins are
expected at the logits z₀(c) = φ(y) · `means`, and

    minimise  |f(u) − c|² / s(c)² + (z − z₀)ᵀ P (z − z₀),     u = 1 / (1 + e^−z)

finds the most probable one that has the colour (`fit.py`). P, the inverse covariance of measured
skins around z₀, leaves room for lips, moles, scars and rashes: off the measured colours the
expectation stays at the nearest of them, and the colour decides.

The standard deviation σ_p(c) = exp(ψ(c) · `spreads`), ψ being 1, y and hats over ITA°, is such that
u ± 1.645 σ, with the slope of parameter by coordinate at u, held nine of ten skins that the prior
had not seen, in each band of ITA°. Where colours are unlike measured skin, σ goes to what is known
without a colour, `prior_sigma`.
"""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace
from cutis.colour import delta_e, ita
from cutis.inverse.fit import fit, logistic
from cutis.optics import PARAMETERS, from_coordinates

Array = NDArray[np.float64]
DARK = 0.03
"""Added to albedo before its logarithm, so that noise of the darkest skins does not rule."""
LOGIT = 6.0
"""Bound on the expected logits."""
TOLERANCE = 0.001
"""Relative colour error worth one standard deviation of the prior (see `fit.py`)."""
UNLIKE = 1.1
"""Multiple of `radius` at which colours are half as likely to be skin."""
OFF_GAMUT = 1.0
"""CIEDE2000 between a colour and that of its skin at which confidence is a half."""
TONES = (-47.0, -9.0, 13.0, 28.0, 40.0, 54.0)
"""ITA° of albedo at the tops of the hats: medians of measured skins in the six bands, which are of
ITA° with the surface."""
BAND = 1 << 16
"""Colours fitted at a time."""


@dataclass(frozen=True, eq=False)
class SkinPrior:
    """Prior of one tissue's five parameters given a colour; float64, in network coordinates.

    `centre` (3,), `whitening` (3, 3) and `radius` (1,) say where the colours of measured skins lie;
    `means` (10, 5), `precision` (5, 5), `spreads` (9, 5) and `prior_sigma` (5,) are those above.
    """

    centre: Array
    whitening: Array
    radius: Array
    means: Array
    precision: Array
    spreads: Array
    prior_sigma: Array

    def likeness(self, colours: ArrayLike) -> Array:
        """(n, 3) linear sRGB → (n,) in [0, 1]: 1 for colours of measured skins, 0 far away."""
        r = np.sqrt((self._whitened(colours) ** 2).sum(axis=1))
        return 1 / (1 + (r / (UNLIKE * self.radius[0])) ** 12)

    def features(self, colours: ArrayLike) -> Array:
        """(n, 3) linear sRGB → (n, 10): 1, the three of y, their squares and products."""
        y = self._whitened(colours)
        r = np.sqrt((y**2).sum(axis=1, keepdims=True))
        a, b, c = (y * (1 + (r / self.radius[0]) ** 8) ** (-1 / 8)).T
        return np.stack([np.ones(len(y)), a, b, c, a * a, b * b, c * c, a * b, a * c, b * c], 1)

    def spread_features(self, colours: ArrayLike) -> Array:
        """(n, 3) linear sRGB → (n, 9): the first four `features`, hats over ITA° but the first."""
        tone = ita(np.maximum(np.asarray(colours, dtype=np.float64), 0.0))
        hats = [np.interp(tone, TONES, top) for top in np.eye(len(TONES))[1:]]
        return np.concatenate([self.features(colours)[:, :4], np.stack(hats, axis=1)], axis=1)

    def expected(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) linear sRGB → (n, 5) coordinates that measured skins of about this colour have."""
        return logistic(np.clip(self.features(colours) @ self.means, -LOGIT, LOGIT))

    def skins(self, space: AlbedoSpace, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) linear sRGB → (n, 5) coordinates of the most probable skins of these colours."""
        rgb = np.asarray(colours, dtype=np.float32)
        found = np.empty((len(rgb), 5), dtype=np.float32)
        for start in range(0, len(rgb), BAND):
            part = slice(start, start + BAND)
            expected = self.expected(rgb[part])
            found[part] = fit(space, rgb[part], expected, self.precision, TOLERANCE)
        return found

    def trust(
        self, space: AlbedoSpace, colours: ArrayLike, coordinates: ArrayLike
    ) -> tuple[Array, Array]:
        """σ (n, 5) in network coordinates and confidence (n,) of colours and their skins."""
        rgb = np.asarray(colours, dtype=np.float32)
        error = delta_e(space.rgb(from_coordinates(coordinates)), rgb).astype(np.float64)
        confidence = self.likeness(rgb) / (1 + (error / OFF_GAMUT) ** 4)
        known = np.exp(self.spread_features(rgb) @ self.spreads)
        unknown = np.maximum(known, self.prior_sigma)
        return confidence[:, None] * known + (1 - confidence[:, None]) * unknown, confidence

    def _whitened(self, colours: ArrayLike) -> Array:
        return (log_colours(colours) - self.centre) @ self.whitening.T


def log_colours(colours: ArrayLike) -> Array:
    """(n, 3) linear sRGB → logarithms of it and DARK, float64; below 0 counts as 0."""
    return np.log(np.maximum(np.asarray(colours, dtype=np.float64), 0.0) + DARK)


def unit_slopes(coordinates: Array) -> Array:
    """(n, 5) slopes of parameters, in their units, by coordinates."""
    slopes = [known.slope(coordinates[:, i]) for i, known in enumerate(PARAMETERS)]
    return np.stack(slopes, axis=1)


def save_prior(prior: SkinPrior, file: Path) -> None:
    """Writes a prior as .npz, without pickle."""
    np.savez_compressed(file, **{f.name: getattr(prior, f.name) for f in fields(prior)})


def load_prior(file: Path) -> SkinPrior:
    """Reads what `save_prior` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        return SkinPrior(**{f.name: stored[f.name] for f in fields(SkinPrior)})
