"""The table of what absorbs in skin: which substance, in which layer, in which share.

A layer is filled by its absorbers, and the rest of it by the background of `REST`:

    share = amount · Π_q x_q (q in `times`) · Π_q (1 − x_q) (q in `without`),
    μa    = Σ share · μ(substance) + (1 − Σ share of those that take up room) · μ(rest),

x being the parameters of a skin. Spectra, kernels, ranges of tables, fits and files all read this
table; another absorber is another row (docs/optics.md).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.optics.tissue import Tissue

LAYERS = ("epidermis", "dermis")
CAROTENE_IN_DERMIS = 1 / 3
"""Concentration of β-carotene in the dermis over that in the epidermis, where it is a parameter: an
assumption. The epidermis always holds more [vahlquist1982]; a third is the ratio of the constants
of `ALIAGA2022`, of which the second is per litre of blood."""


@dataclass(frozen=True)
class Absorber:
    """One substance in one of LAYERS, and the parameters, by name, that say how much of it.

    `substance` is one of SUBSTANCES, or has its own `spectrum`: rows of (nm, cm⁻¹), wavelengths
    increasing, linear between them. `room` says whether it takes up room, as a fraction of volume
    does and what is dissolved, in g/L, does not.
    """

    substance: str
    layer: str
    times: tuple[str, ...]
    without: tuple[str, ...] = ()
    amount: float = 1.0
    room: bool = True
    spectrum: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        # what comes from a file has lists
        object.__setattr__(self, "times", tuple(self.times))
        object.__setattr__(self, "without", tuple(self.without))
        rows = tuple((float(lam), float(mu)) for lam, mu in self.spectrum)
        object.__setattr__(self, "spectrum", rows)
        if self.layer not in LAYERS:
            raise CutisError(f"{self.substance}: its layer must be {' or '.join(LAYERS)}")
        if not (self.spectrum or self.substance in SUBSTANCES):
            raise CutisError(
                f"{self.substance}: no such substance; give its spectrum, or take one of "
                f"{', '.join(SUBSTANCES)}"
            )
        if rows and not (len(rows) > 1 and np.all(np.diff(np.array(rows)[:, 0]) > 0)):
            raise CutisError(f"{self.substance}: the wavelengths of its spectrum must increase")
        if not (np.isfinite(self.amount) and self.amount >= 0):
            raise CutisError(f"{self.substance}: its amount must be a number that is not negative")

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of all that its share depends on."""
        return (*self.times, *self.without)

    def share(self, values: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Its share of the layer, of parameters by name, any shapes that fit."""
        share = np.asarray(self.amount)
        for name in self.times:
            share = share * values[name]
        for name in self.without:
            share = share * (1 - values[name])
        return share

    def absorption(self, tissue: "Tissue", wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of a share of 1, cm⁻¹, any shape; CutisError outside its own spectrum."""
        if not self.spectrum:
            return SUBSTANCES[self.substance](tissue, wavelength)
        lam, (nodes, values) = np.asarray(wavelength), np.array(self.spectrum).T
        if lam.size and not (lam.min() >= nodes[0] and lam.max() <= nodes[-1]):
            raise CutisError(
                f"tissue {tissue.name}: the spectrum of {self.substance} goes from {nodes[0]:g} to "
                f"{nodes[-1]:g} nm and lacks some of {lam.min():g} to {lam.max():g} nm"
            )
        return np.interp(lam, nodes, values)


SUBSTANCES = {
    "eumelanin": lambda tissue, lam: tissue.eumelanin(lam),
    "pheomelanin": lambda tissue, lam: tissue.pheomelanin(lam),
    "deoxygenated blood": lambda tissue, lam: tissue.whole_blood(lam)[0],
    "oxygenated blood": lambda tissue, lam: tissue.whole_blood(lam)[1],
    "methaemoglobin": lambda tissue, lam: tissue.brown_blood(lam),
    "bilirubin": lambda tissue, lam: tissue.added_bilirubin(lam),
    "carotene": lambda tissue, lam: tissue.added_carotene(lam),
}
"""What tissues have constants for: μa of a tissue at wavelengths, cm⁻¹ of the pure substance or,
of bilirubin and carotene, per g/L."""
REST = {
    "epidermis": lambda tissue, lam: tissue.epidermis_background(lam),
    "dermis": lambda tissue, lam: tissue.baseline(lam),
}
"""What fills a layer where nothing else does."""

MELANIN = (
    Absorber("eumelanin", "epidermis", ("melanin", "eumelanin")),
    Absorber("pheomelanin", "epidermis", ("melanin",), ("eumelanin",)),
)
BLOOD = (
    Absorber("deoxygenated blood", "dermis", ("blood",), ("oxygenation",)),
    Absorber("oxygenated blood", "dermis", ("blood", "oxygenation")),
)
BLOOD_ABOVE = (
    Absorber("deoxygenated blood", "epidermis", ("epidermal_blood",), ("oxygenation",)),
    Absorber("oxygenated blood", "epidermis", ("epidermal_blood", "oxygenation")),
)
"""Of tissues that have blood in their epidermis."""
BLOOD_WITH_BROWN = (
    Absorber("deoxygenated blood", "dermis", ("blood",), ("oxygenation", "methaemoglobin")),
    Absorber("oxygenated blood", "dermis", ("blood", "oxygenation"), ("methaemoglobin",)),
    Absorber("methaemoglobin", "dermis", ("blood", "methaemoglobin")),
)
DISSOLVED = (
    Absorber("carotene", "epidermis", ("carotene",), room=False),
    Absorber("bilirubin", "dermis", ("bilirubin",), room=False),
    Absorber("carotene", "dermis", ("carotene",), amount=CAROTENE_IN_DERMIS, room=False),
)
"""Of tissues with rare chromophores, with the blood above."""
