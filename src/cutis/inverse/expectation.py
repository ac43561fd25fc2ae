"""What a skin is expected to be before its spectrum is seen, where spectra leave it open.

Melanin type, thickness and the scattering of the dermis all turn slopes of spectra, so no spectrum
tells them apart. With z the logits of the five network coordinates and d = (ln a, b) how the dermis
scatters beyond what the tissue says of it,

    μs′(λ) → a μs′(λ) (λ / 550 nm)^−b,

fits of spectra add (z − z₀)ᵀ P (z − z₀) + Σ (d / s)² to their squared residuals, these in units of
`noise`². Melanin type is expected to follow melanin, at `follows` logits per logit: dark skin holds
more of the dark, insoluble melanin [alaluf2002].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.optics import MEASURED2026B, NAMES, PARAMETERS, Tissue

PIVOT = 550.0
"""nm at which the power of scattering leaves it as it is."""


@dataclass(frozen=True)
class Expectation:
    """Normal expectation of the five logits and of the dermis' scattering.

    `centre` and `spread` (5) are means and standard deviations of logits; that of the melanin type
    is around what melanin lets expect. `scattering` (2) are standard deviations of ln a and b;
    `noise` is that of a reflectance, model error included.
    """

    centre: tuple[float, ...]
    spread: tuple[float, ...]
    follows: float
    scattering: tuple[float, float]
    noise: float

    @property
    def precision(self) -> NDArray[np.float64]:
        """(7, 7) inverse covariance of the logits, then of ln a and b."""
        rows = np.eye(len(NAMES) + 2)
        rows[NAMES.index("eumelanin"), NAMES.index("melanin")] = -self.follows
        weight = 1 / np.array([*self.spread, *self.scattering]) ** 2
        return rows.T @ (rows * weight[:, None])


EXPECTED = {
    MEASURED2026B.name: Expectation(
        centre=(-0.9, -1.25, -0.87, -0.6, 0.38),
        spread=(2.0, 0.7, 0.3, 0.235, 1.2),
        follows=3.1,
        scattering=(0.3, 0.52),
        noise=0.003,
    )
}
"""By the name of the tissue; the others have none. Where from: docs/decisions/0029."""


def expected_of(tissue: Tissue) -> Expectation | None:
    """What is expected of the skins of a tissue with the five parameters, if anything is."""
    return EXPECTED.get(tissue.name) if tissue.parameters[: len(NAMES)] == PARAMETERS else None
