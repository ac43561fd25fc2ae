"""Two-layer skin: parameters → absorption and scattering of epidermis and dermis.

A tissue is an immutable value that holds every constant, so that a published model, a calibrated
variant and a user's own differ in data, not in code (`dataclasses.replace`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.kernels.mixture import TIMES, WITHOUT
from cutis.optics import chromophores
from cutis.optics.absorbers import (
    BLOOD,
    BLOOD_ABOVE,
    BLOOD_WITH_BROWN,
    DISSOLVED,
    LAYERS,
    MELANIN,
    REST,
    Absorber,
)
from cutis.optics.parameters import EPIDERMAL_BLOOD, NAMES, PARAMETERS, RARE, Parameter, parameter

WAVELENGTHS = np.arange(380.0, 781.0, 10.0)
"""nm, the 41 bands of every spectrum of this package."""
WAVELENGTHS.flags.writeable = False
LARGEST_SHIFT = 30.0
"""nm that bands of a tissue may lie off their tables: from hexane to any lipid, with room."""


@dataclass(frozen=True)
class Tissue:
    """Constants shared by all skins of a model. Concentrations in g/L, scattering in cm⁻¹.

    `fixed` holds (name, value) of standard parameters that all skins share; `epidermal_blood` says
    that blood in the epidermis is a parameter too. The baseline is the sum of a power law
    [saidi1992] and an exponential [jacques1998]. `dermis_scattering` is the dermis' scattering over
    the epidermis'. `hemoglobin_table` is one of `chromophores.HEMOGLOBIN_TABLES`. Blood in vessels
    of `vessel_radius` µm shades itself: it absorbs as μa (1 − e^−2μa r) / (2 μa r) [svaasand1995].
    Bands of haemoglobin and of carotene lie `hemoglobin_shift` and `carotene_shift` nm to the red
    of their tables (to the blue below 0). The first is an error of the wavelengths of the
    instruments that a tissue was calibrated with [berns1988]; the second is what lipids do.
    `rare_chromophores` makes the three of `optics.RARE` parameters too: bilirubin of the dermis as
    a whole, β-carotene of the epidermis with a third of it in the dermis, and methaemoglobin in
    place of the other haemoglobin. `absorbers` are rows of the table of `absorbers.py` on top of
    those that all tissues have, and `more` the parameters that they bring.

    `dermis_by_type`, where given, says how the dermis scatters instead of `dermis_scattering`: μs′
    at 500 nm, cm⁻¹, and its power, below skin whose melanin is all pheomelanin, and the same where
    it is all eumelanin. Between them reduced mean free paths 1 / μs′ mix as the melanins do.
    """

    name: str
    eumelanin_scale: float = 6.6e11
    eumelanin_power: float = -3.33
    pheomelanin_scale: float = 2.9e15
    pheomelanin_power: float = -4.75
    baseline_scale: float = 7.84e8
    baseline_power: float = -3.255
    baseline_offset: float = 0.0
    baseline_exponential: float = 0.0
    hemoglobin: float = 150.0
    hemoglobin_table: str = "prahl1999"
    hemoglobin_shift: float = 0.0
    vessel_radius: float = 0.0
    bilirubin: float = 0.05
    beta_carotene_epidermis: float = 2.1e-4
    beta_carotene_dermis: float = 7e-5
    carotene_shift: float = 0.0
    scattering_500: float = 36.4
    rayleigh_fraction: float = 0.48
    mie_power: float = 0.22
    dermis_scattering: float = 1.0
    dermis_by_type: tuple[tuple[float, float], ...] = ()
    anisotropy_offset: float = 0.62
    anisotropy_slope: float = 0.29e-3
    refractive_index: float = 1.4
    dimension: int = 2
    boundary: str = "matched"
    fixed: tuple[tuple[str, float], ...] = ()
    epidermal_blood: bool = False
    rare_chromophores: bool = False
    absorbers: tuple[Absorber, ...] = ()
    more: tuple[Parameter, ...] = ()

    def __post_init__(self) -> None:
        if self.dimension not in (2, 3):
            raise CutisError(f"tissue {self.name}: dimension must be 2 or 3, not {self.dimension}")
        if self.boundary not in ("matched", "fresnel"):
            raise CutisError(
                f"tissue {self.name}: boundary must be matched or fresnel, not {self.boundary!r}"
            )
        if self.hemoglobin_table not in chromophores.HEMOGLOBIN_TABLES:
            known = " or ".join(chromophores.HEMOGLOBIN_TABLES)
            raise CutisError(f"tissue {self.name}: hemoglobin_table must be {known}")
        for name in ("hemoglobin_shift", "carotene_shift"):
            if not abs(getattr(self, name)) <= LARGEST_SHIFT:
                raise CutisError(f"tissue {self.name}: {name} must be within {LARGEST_SHIFT:g} nm")
        if not 0 <= self.vessel_radius < 1000:
            raise CutisError(f"tissue {self.name}: vessel_radius must lie in 0 to 1000 µm")
        if not 0 <= self.rayleigh_fraction <= 1:
            raise CutisError(f"tissue {self.name}: rayleigh_fraction must lie in 0 to 1")
        if not self.dermis_scattering > 0:
            raise CutisError(f"tissue {self.name}: dermis_scattering must be above 0")
        ends = tuple((float(at_500), float(power)) for at_500, power in self.dermis_by_type)
        object.__setattr__(self, "dermis_by_type", ends)
        if ends and not (len(ends) == 2 and min(at_500 for at_500, _ in ends) > 0):
            raise CutisError(
                f"tissue {self.name}: dermis_by_type must hold two pairs, of a scattering above 0 "
                "and a power"
            )
        if self.epidermal_blood and self.rare_chromophores:
            raise CutisError(
                f"tissue {self.name}: blood in the epidermis and rare chromophores do not go "
                "together; choose one of the two"
            )
        for name, _ in self.fixed:
            if name not in NAMES:
                known = ", ".join(NAMES)
                raise CutisError(
                    f"tissue {self.name}: unknown parameter {name!r} is fixed; known are {known}"
                )
        fixed = tuple((str(name), parameter(name).check(value)) for name, value in self.fixed)
        object.__setattr__(self, "fixed", fixed)
        # what comes from a file has mappings
        rows = (a if isinstance(a, Absorber) else Absorber(**a) for a in self.absorbers)
        object.__setattr__(self, "absorbers", tuple(rows))
        more = (p if isinstance(p, Parameter) else Parameter(**p) for p in self.more)
        object.__setattr__(self, "more", tuple(more))
        self._check_table()

    def _check_table(self) -> None:
        names = [p.name for p in self.every_parameter]
        for name in names:
            if names.count(name) > 1:
                raise CutisError(f"tissue {self.name}: two parameters are called {name}")
        for absorber in self.absorbers:
            for name in absorber.parameters:
                if name not in names:
                    raise CutisError(
                        f"tissue {self.name}: {absorber.substance} depends on {name!r}, which is "
                        f"no parameter of it; add it to `more`, or take one of {', '.join(names)}"
                    )

    def check(self) -> None:
        """Raises CutisError, naming what is wrong, unless light can move in it at WAVELENGTHS."""
        lam = WAVELENGTHS
        for layer in LAYERS:
            parts = {a.substance: a.absorption(self, lam) for a in self.table(layer)}
            for substance, mu in {**parts, "the rest": REST[layer](self, lam)}.items():
                bad = ~(np.isfinite(mu) & (mu >= 0))
                if bad.any():
                    raise CutisError(
                        f"tissue {self.name}: the absorption of {substance} in the {layer} is "
                        f"negative or not finite at {lam[bad][0]:g} nm"
                    )
        scattering = (
            ("epidermis", self.reduced_scattering(lam)),
            *(("dermis", self.dermis_reduced_scattering(lam, share)) for share in (0.0, 1.0)),
        )
        for layer, mu in scattering:
            bad = ~(np.isfinite(mu) & (mu > 0))
            if bad.any():
                raise CutisError(
                    f"tissue {self.name}: the {layer} does not scatter at {lam[bad][0]:g} nm; "
                    "scattering must be above 0 and finite"
                )
        if not np.all(np.abs(self.anisotropy(lam)) < 1):
            raise CutisError(f"tissue {self.name}: its anisotropy must lie inside (-1, 1)")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The free parameters of a skin, in the order of its arrays."""
        held = dict(self.fixed)
        return tuple(p for p in self.every_parameter if p.name not in held)

    @property
    def every_parameter(self) -> tuple[Parameter, ...]:
        """The same with those that `fixed` holds."""
        rare = RARE if self.rare_chromophores else ()
        above = (EPIDERMAL_BLOOD,) if self.epidermal_blood else ()
        return (*PARAMETERS, *above, *rare, *self.more)

    def table(self, layer: str) -> tuple[Absorber, ...]:
        """What absorbs in a layer besides the rest of it."""
        return tuple(a for a in self._table if a.layer == layer)

    @cached_property
    def _table(self) -> tuple[Absorber, ...]:
        above = BLOOD_ABOVE if self.epidermal_blood else ()
        below = (*BLOOD_WITH_BROWN, *DISSOLVED) if self.rare_chromophores else BLOOD
        return (*MELANIN, *above, *below, *self.absorbers)

    def mixture(
        self, wavelength: ArrayLike
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
        """The table as matrices, for `kernels.mixture`: recipe (c, p) and what they absorb.

        The recipe, in every parameter, has the epidermis' absorbers first. Spectra (1 + c, n) of
        epidermis and of dermis begin with the rest; amounts are in them.
        """
        lam = np.atleast_1d(np.asarray(wavelength, dtype=np.float64))
        names = [p.name for p in self.every_parameter]
        recipe, pure = [], []
        for layer in LAYERS:
            rest = REST[layer](self, lam)
            rows, holds = [rest], []
            for a in self.table(layer):
                rows.append(a.amount * (a.absorption(self, lam) - (rest if a.room else 0.0)))
                holds.append([TIMES * (n in a.times) + WITHOUT * (n in a.without) for n in names])
            if layer == "dermis" and self.dermis_by_type:
                rows, holds = self._longer_paths(rows, holds, lam)
            recipe += holds
            pure.append(np.array(rows))
        return np.array(recipe, dtype=np.int64), pure[0], pure[1]

    def _longer_paths(
        self, rows: list[NDArray[np.float64]], holds: list[list[int]], lam: NDArray[np.float64]
    ) -> tuple[list[NDArray[np.float64]], list[list[int]]]:
        """The dermis with μa times μs′ of the pheomelanin's end over its own, k = 1 + φ (k₁ − 1).

        A half space has no length, so that its albedo depends on μa / μs alone: absorption that is
        k times as strong stands for scattering that is as much weaker. μa k = μa (1 − φ) + k₁ μa φ
        is linear in the share of eumelanin φ, as mixtures are.
        """
        share = [p.name for p in self.every_parameter].index("eumelanin")
        rest, *others = rows
        longer = self.dermis_reduced_scattering(lam, 0.0) / self.dermis_reduced_scattering(lam, 1.0)
        alone = [0] * len(holds[0])
        alone[share] = TIMES
        made, held = [rest, (longer - 1) * rest], [alone]
        for row, hold in zip(others, holds, strict=True):
            for kind, factor in ((WITHOUT, 1.0), (TIMES, longer)):
                made.append(factor * row)
                held.append([kind if i == share else h for i, h in enumerate(hold)])
        return made, held

    def absorption(
        self, layer: str, values: Mapping[str, ArrayLike], wavelength: ArrayLike
    ) -> NDArray[np.float64]:
        """μa of a layer, cm⁻¹; parameters (...) by name, result (..., wavelengths).

        Parameters that `fixed` holds may be left out; others that are left out are 0.
        """
        lam = np.atleast_1d(wavelength)
        known = {
            p.name: np.asarray(values.get(p.name, dict(self.fixed).get(p.name, 0.0)), float)
            for p in self.every_parameter
        }
        return _filled(self, self.table(layer), REST[layer](self, lam), known, lam)

    @property
    def outer_index(self) -> float:
        """Refractive index that light meets on its way out: 1 where the boundary is matched."""
        return self.refractive_index if self.boundary == "fresnel" else 1.0

    def eumelanin(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of eumelanin in the melanosome, cm⁻¹."""
        return chromophores.eumelanin(wavelength, self.eumelanin_scale, self.eumelanin_power)

    def pheomelanin(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of pheomelanin in the melanosome, cm⁻¹."""
        return chromophores.pheomelanin(wavelength, self.pheomelanin_scale, self.pheomelanin_power)

    def baseline(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of tissue without melanin and blood, cm⁻¹."""
        power = chromophores.baseline(wavelength, self.baseline_scale, self.baseline_power)
        return power + chromophores.baseline_jacques(
            wavelength, self.baseline_offset, self.baseline_exponential
        )

    def anisotropy(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """g = ⟨cos θ⟩ of both layers; 0.73 at 380 nm to 0.85 at 780 nm [vangemert1989]."""
        lam = np.asarray(wavelength, dtype=np.float64)
        return self.anisotropy_offset + self.anisotropy_slope * lam

    def reduced_scattering(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μs′ of the epidermis, cm⁻¹ [jacques2013, coefficients of bashkatov2011]."""
        x = np.asarray(wavelength, dtype=np.float64) / 500.0
        rayleigh = self.rayleigh_fraction * x**-4.0
        mie = (1.0 - self.rayleigh_fraction) * x**-self.mie_power
        return self.scattering_500 * (rayleigh + mie)

    def dermis_reduced_scattering(
        self, wavelength: ArrayLike, eumelanin: ArrayLike = 0.0
    ) -> NDArray[np.float64]:
        """μs′ of the dermis, cm⁻¹; shares of eumelanin (...), wavelengths (n,) → (..., n).

        The shares count where there is `dermis_by_type` alone; without, the result is (n,).
        """
        lam = np.asarray(wavelength, dtype=np.float64)
        if not self.dermis_by_type:
            return self.dermis_scattering * self.reduced_scattering(lam)
        pheo, eu = (at_500 * (lam / 500.0) ** -power for at_500, power in self.dermis_by_type)
        share = np.asarray(eumelanin, dtype=np.float64)
        share = share[..., None] if lam.ndim else share
        return np.asarray(1.0 / ((1 - share) / pheo + share / eu))

    def scattering(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μs = μs′ / (1 − g) of the epidermis, cm⁻¹."""
        return self.reduced_scattering(wavelength) / (1.0 - self.anisotropy(wavelength))

    def scattering_below(
        self, wavelength: ArrayLike, eumelanin: ArrayLike = 0.0
    ) -> NDArray[np.float64]:
        """μs of the dermis, cm⁻¹, as `dermis_reduced_scattering` has it."""
        below = self.dermis_reduced_scattering(wavelength, eumelanin)
        return below / (1.0 - self.anisotropy(wavelength))

    def epidermis_absorption(
        self,
        melanin: ArrayLike,
        eumelanin: ArrayLike,
        wavelength: ArrayLike,
        carotene: ArrayLike = 0.0,
    ) -> NDArray[np.float64]:
        """μa of the epidermis, cm⁻¹; parameters (...,), result (..., wavelengths).

        `carotene` is what a rare chromophore adds.
        """
        given = {"melanin": melanin, "eumelanin": eumelanin, "carotene": carotene}
        values = {name: np.asarray(value, dtype=np.float64) for name, value in given.items()}
        table = (*MELANIN, *(a for a in DISSOLVED if a.layer == "epidermis"))
        lam = np.atleast_1d(wavelength)
        return _filled(self, table, self.epidermis_background(lam), values, lam)

    def dermis_absorption(
        self,
        blood: ArrayLike,
        oxygenation: ArrayLike,
        wavelength: ArrayLike,
        bilirubin: ArrayLike = 0.0,
        carotene: ArrayLike = 0.0,
        methaemoglobin: ArrayLike = 0.0,
    ) -> NDArray[np.float64]:
        """μa of the dermis, cm⁻¹; parameters (...,), result (..., wavelengths).

        The last three are what rare chromophores add, `carotene` being that of the epidermis.
        """
        given = {
            "blood": blood,
            "oxygenation": oxygenation,
            "bilirubin": bilirubin,
            "carotene": carotene,
            "methaemoglobin": methaemoglobin,
        }
        values = {name: np.asarray(value, dtype=np.float64) for name, value in given.items()}
        table = (*BLOOD_WITH_BROWN, *(a for a in DISSOLVED if a.layer == "dermis"))
        lam = np.atleast_1d(wavelength)
        return _filled(self, table, self.baseline(lam), values, lam)

    def epidermis_background(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of epidermis without melanin, cm⁻¹: β-carotene and baseline."""
        return self._carotene(wavelength, self.beta_carotene_epidermis) + self.baseline(wavelength)

    def whole_blood(self, wavelength: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """μa of fully deoxygenated and fully oxygenated blood, cm⁻¹, pigments in it included."""
        dissolved = self._dissolved(wavelength)
        substances = (chromophores.deoxyhemoglobin, chromophores.oxyhemoglobin)
        tabulated = np.asarray(wavelength, dtype=np.float64) - self.hemoglobin_shift
        none, full = (
            self._packed(substance(tabulated, self.hemoglobin, self.hemoglobin_table))
            for substance in substances
        )
        return none + dissolved, full + dissolved

    def added_bilirubin(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of the parameter bilirubin in the dermis, cm⁻¹ per g/L."""
        return chromophores.bilirubin(wavelength, 1.0, chromophores.YELLOW_ENDS)

    def added_carotene(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of the parameter carotene in the epidermis, cm⁻¹ per g/L."""
        return self._carotene(wavelength, 1.0, chromophores.YELLOW_ENDS)

    def brown_blood(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        """μa of blood all of whose haemoglobin is methaemoglobin, cm⁻¹, pigments in it included."""
        tabulated = np.asarray(wavelength, dtype=np.float64) - self.hemoglobin_shift
        brown = self._packed(chromophores.methemoglobin(tabulated, self.hemoglobin))
        return brown + self._dissolved(wavelength)

    def _dissolved(self, wavelength: ArrayLike) -> NDArray[np.float64]:
        yellow = chromophores.bilirubin(wavelength, self.bilirubin)
        return yellow + self._carotene(wavelength, self.beta_carotene_dermis)

    def _carotene(
        self, wavelength: ArrayLike, concentration: float, last: float = np.inf
    ) -> NDArray[np.float64]:
        tabulated = np.asarray(wavelength, dtype=np.float64) - self.carotene_shift
        return chromophores.beta_carotene(tabulated, concentration, last)

    def _packed(self, absorption: NDArray[np.float64]) -> NDArray[np.float64]:
        """What blood of such an absorption, cm⁻¹, absorbs on average in its vessels."""
        if self.vessel_radius == 0:
            return absorption
        depth = np.maximum(2e-4 * self.vessel_radius * absorption, 1e-12)
        return absorption * -np.expm1(-depth) / depth


def _filled(
    tissue: Tissue,
    table: tuple[Absorber, ...],
    rest: NDArray[np.float64],
    values: dict[str, NDArray[np.float64]],
    wavelength: NDArray[np.float64],
) -> NDArray[np.float64]:
    """μa (..., n) of a layer that holds a table in the shares of `values`, and rest (n,)."""
    total: NDArray[np.float64] = np.zeros(1)
    room: NDArray[np.float64] = np.zeros(())
    for absorber in table:
        share = absorber.share(values)
        if not np.any(share):  # some tables end where nobody asks for what they hold
            room = room + 0.0 * share
            continue
        total = total + share[..., None] * absorber.absorption(tissue, wavelength)
        if absorber.room:
            room = room + share
    return total + (1 - room)[..., None] * rest


ALIAGA2022 = Tissue(name="aliaga2022")
"""The model of the paper: flatland transport, index-matched boundary [aliaga2022]."""

MEASURED2026 = Tissue(
    name="measured2026",
    eumelanin_scale=6.6e11 * 550.0 ** (2.57 - 3.33),
    eumelanin_power=-2.57,
    pheomelanin_scale=2.9e15 * 550.0 ** (5.07 - 4.75),
    pheomelanin_power=-5.07,
    baseline_scale=0.0,
    baseline_offset=0.244,
    baseline_exponential=42.6,
    hemoglobin_table="bosschaart2014-prahl1999",
    hemoglobin_shift=-2.2,
    bilirubin=0.008,
    beta_carotene_epidermis=1.6e-3,
    carotene_shift=15.0,
    scattering_500=68.7,
    rayleigh_fraction=0.0,
    mie_power=1.9,
    dimension=3,
    boundary="fresnel",
)
"""Calibrated on thousands of measured skins inside published ranges; five free parameters as in
`ALIAGA2022`. Its albedo goes with a surface of reflectance 0.028 (docs/decisions/0022)."""

MEASURED2026B = Tissue(
    name="measured2026b",
    eumelanin_scale=6.6e11 * 550.0 ** (3.48 - 3.33),
    eumelanin_power=-3.48,
    pheomelanin_scale=2.9e15 * 550.0 ** (4.95 - 4.75),
    pheomelanin_power=-4.95,
    baseline_scale=0.0,
    baseline_offset=0.244,
    baseline_exponential=85.3,
    hemoglobin_table="bosschaart2014-prahl1999",
    hemoglobin_shift=-2.7,
    bilirubin=0.008,
    beta_carotene_epidermis=1.6e-3,
    carotene_shift=15.0,
    scattering_500=72.0,
    rayleigh_fraction=0.0,
    mie_power=1.35,
    dermis_by_type=((80.0, 0.7), (14.5, 2.4)),
    dimension=3,
    boundary="fresnel",
)
"""The successor of `MEASURED2026`: the scattering of the dermis differs between skins
(docs/decisions/0029)."""

TISSUES = {tissue.name: tissue for tissue in (ALIAGA2022, MEASURED2026, MEASURED2026B)}
"""Tissues by name: those with the five parameters of skin maps, which commands take."""


def tissue_named(name: str) -> Tissue:
    """The one of `TISSUES` called `name`; CutisError that lists them when there is none."""
    if name not in TISSUES:
        raise CutisError(f"unknown tissue {name!r}; choose {' or '.join(TISSUES)}")
    return TISSUES[name]


def with_rare_chromophores(tissue: Tissue) -> Tissue:
    """The same tissue with bilirubin, β-carotene and methaemoglobin as parameters too."""
    return replace(tissue, rare_chromophores=True)


# 14.74 λ^−0.22 and 2.2e11 λ^−4 mm⁻¹ [donner2006] at 500 nm, in cm⁻¹
_MIE, _RAYLEIGH = 147.4 * 500.0**-0.22, 2.2e12 * 500.0**-4.0

GITLINA2020 = Tissue(
    name="gitlina2020",
    baseline_scale=0.0,
    baseline_offset=0.244,
    baseline_exponential=85.3,
    bilirubin=0.0,
    beta_carotene_epidermis=0.0,
    beta_carotene_dermis=0.0,
    scattering_500=_MIE + _RAYLEIGH,
    rayleigh_fraction=_RAYLEIGH / (_MIE + _RAYLEIGH),
    dermis_scattering=0.5,
    dimension=3,
    boundary="fresnel",
    fixed=(("thickness", 250.0), ("oxygenation", 0.75)),
    epidermal_blood=True,
)
"""Melanin, its blend, blood in the dermis and in the epidermis are free; thickness and oxygenation
are not [gitlina2020, with the constants of donner2006 and donner2008]. Physical walks and a
dielectric boundary, as the dipoles of those models have; solved exactly here."""
