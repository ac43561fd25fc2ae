"""The free parameters of a skin: names, units, ranges and network coordinates.

A *coordinate* u ∈ [0, 1] is the warped form of a parameter in which sampling, losses, smoothness
and priors are expressed: u = (p^(1/k) − low^(1/k)) / (high^(1/k) − low^(1/k)), with k = 3 for
melanin, 4 for blood and 1 for the others [aliaga2022, albedo space parametrisation].
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.kernels import warp


@dataclass(frozen=True)
class Parameter:
    """One free parameter: what it means, its unit and its range."""

    name: str
    symbol: str
    meaning: str
    unit: str
    low: float
    high: float
    root: int

    def __post_init__(self) -> None:
        if self.root not in (1, 2, 3, 4) or not 0 <= self.low < self.high < np.inf:
            raise CutisError(
                f"parameter {self.name}: its range must rise from 0 or more, its root be 1 to 4"
            )

    def to_coordinate(self, value: ArrayLike) -> NDArray[np.floating]:
        """Parameter in its unit → coordinate u ∈ [0, 1]; any shape, not clamped."""
        return warp.to_coordinate(value, self.low, self.high, self.root)

    def from_coordinate(self, coordinate: ArrayLike) -> NDArray[np.floating]:
        """Coordinate u ∈ [0, 1] → parameter in its unit; any shape, clamped to the range."""
        return warp.from_coordinate(coordinate, self.low, self.high, self.root)

    def slope(self, coordinate: ArrayLike) -> NDArray[np.floating]:
        """∂parameter/∂u, in its unit, at coordinates u ∈ [0, 1]; any shape."""
        return warp.slope(coordinate, self.low, self.high, self.root)

    def check(self, value: float) -> float:
        """Returns `value`, or raises CutisError when it is not a number inside the range."""
        if not self.low <= value <= self.high:  # also catches NaN
            raise CutisError(
                f"{self.name} = {value:g} is outside its range "
                f"{self.low:g} to {self.high:g}{' ' + self.unit if self.unit != '1' else ''}"
            )
        return value


MELANIN = Parameter("melanin", "V_m", "melanosome volume fraction, epidermis", "1", 0.001, 1.0, 3)
BLOOD = Parameter("blood", "V_b", "blood volume fraction, dermis", "1", 0.001, 1.0, 4)
THICKNESS = Parameter("thickness", "t", "epidermal thickness", "µm", 10.0, 250.0, 1)
EUMELANIN = Parameter("eumelanin", "φ_m", "eumelanin share of melanin", "1", 0.001, 1.0, 1)
OXYGENATION = Parameter(
    "oxygenation", "1−φ_h", "oxygenated share of haemoglobin", "1", 0.0, 0.999, 1
)
EPIDERMAL_BLOOD = Parameter(
    "epidermal_blood", "V_be", "blood volume fraction, epidermis", "1", 1e-5, 0.1, 4
)
"""Only of tissues that have blood in their epidermis; its range is this project's choice."""

BILIRUBIN = Parameter("bilirubin", "c_bil", "bilirubin in the dermis", "g/L", 0.0, 0.2, 1)
CAROTENE = Parameter("carotene", "c_βc", "β-carotene in the epidermis", "g/L", 0.0, 0.05, 1)
METHAEMOGLOBIN = Parameter(
    "methaemoglobin", "φ_met", "share of haemoglobin that is methaemoglobin", "1", 0.0, 0.7, 1
)
RARE = (BILIRUBIN, CAROTENE, METHAEMOGLOBIN)
"""Only of tissues with rare chromophores, `optics.with_rare_chromophores`; 0 is the tissue without.
Bilirubin and β-carotene come on top of what the tissue's constants hold."""
RARE_NAMES = tuple(p.name for p in RARE)
"""Their names, in the same order."""

PARAMETERS = (MELANIN, BLOOD, THICKNESS, EUMELANIN, OXYGENATION)
"""The five, in the order of every (..., 5) array of this package."""
NAMES = tuple(p.name for p in PARAMETERS)
"""Their names, in the same order."""
TYPICAL = {"melanin": 0.02, "blood": 0.02, "thickness": 80.0, "eumelanin": 0.7, "oxygenation": 0.7}
"""A light skin, for single skins whose other parameters were not given; rare chromophores are 0."""


def parameter(name: str) -> Parameter:
    """The parameter called `name`, of the five or a rare one; CutisError naming them for others."""
    for candidate in (*PARAMETERS, *RARE):
        if candidate.name == name:
            return candidate
    raise CutisError(
        f"unknown parameter {name!r}; the five are {', '.join(NAMES)}, "
        f"the rarer {', '.join(RARE_NAMES)}"
    )


def to_coordinates(parameters: ArrayLike) -> NDArray[np.floating]:
    """(..., 5) parameters in their units → (..., 5) coordinates u ∈ [0, 1]."""
    values = np.asarray(parameters)
    return np.stack([p.to_coordinate(values[..., i]) for i, p in enumerate(PARAMETERS)], axis=-1)


def from_coordinates(coordinates: ArrayLike) -> NDArray[np.floating]:
    """(..., 5) coordinates u ∈ [0, 1] → (..., 5) parameters in their units, clamped to range."""
    u = np.asarray(coordinates)
    return np.stack([p.from_coordinate(u[..., i]) for i, p in enumerate(PARAMETERS)], axis=-1)


def axes(
    parameters: Sequence[Parameter] = PARAMETERS, held: Mapping[str, float] | None = None
) -> NDArray[np.float64]:
    """(5, p) the numbers of their coordinates, as `kernels.warp.axes` has them.

    A parameter that is `held` has no span, and stays at its value.
    """
    fixed = dict(held or {})
    ends = [(fixed.get(p.name, p.low), fixed.get(p.name, p.high), p.root) for p in parameters]
    low, high, root = zip(*ends, strict=True)
    return warp.axes(low, high, root)


def skin(
    values: Mapping[str, float], parameters: Sequence[Parameter] = PARAMETERS
) -> NDArray[np.float64]:
    """(p,) parameters of one skin from a mapping; those missing are TYPICAL or 0, all checked."""
    names = [p.name for p in parameters]
    for name in values:
        if name not in names:
            raise CutisError(f"{parameter(name).name} is not a parameter of this tissue")
    return np.array(
        [p.check(float(values.get(p.name, TYPICAL.get(p.name, 0.0)))) for p in parameters]
    )
