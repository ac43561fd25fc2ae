"""Fits shared constants of a tissue to measured skin: `python -m studies.calibrate_tissue`.

Every skin has its own five parameters, all skins the same constants. For a choice of constants the
five are fitted exactly; constants then move by Gauss–Newton with the five following (variable
projection). What is minimised is the mean RMSE plus PULL times the sum over wavelengths of the
squared mean residual, inside published ranges. ρ belongs to the instrument, not to skin.
Docs: docs/decisions/0022-measured2026.md.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from cutis.colour import ita, reflectance_to_rgb
from cutis.optics import ALIAGA2022, MEASURED2026, Tissue, from_coordinates
from studies.calibration_kernel import dimensionless_table, fit_skins, reduced
from studies.figures.measured import BANDS, read_skins

LAM = BANDS
PULL = 5.0
RANGES = {
    # cm⁻¹ at 500 nm and slope of skin [jacques2013]; of epidermis, dermis over it [salomatina2006]
    "scattering_500": (29.7, 72.0),
    "mie_power": (0.7, 1.94),
    "rayleigh_fraction": (0.0, 0.62),
    "dermis_scattering": (0.5, 1.0),
    # cm⁻¹: half to all of jacques1998, or to all of saidi1992
    "baseline_offset": (0.12, 0.244),
    "baseline_exponential": (42.6, 85.3),
    "baseline_scale": (0.0, 7.84e8),
    "hemoglobin_shift": (-4.0, 1.0),  # nm; the instruments'
    "eumelanin_power": (-3.48, -2.57),  # jacques1998, and sarna2006 at 400–500 nm
    "pheomelanin_power": (-5.07, -4.40),  # sarna2006 at 400–700 and at 400–550 nm
    "vessel_radius": (0.0, 25.0),  # µm, upper plexus [svaasand1995]
    "bilirubin": (0.0, 0.05),  # g/L of blood
    "beta_carotene_epidermis": (0.0, 1.6e-3),  # g/L, all carotenoids [ribayamercado1995]
    "beta_carotene_dermis": (0.0, 1e-3),  # g/L of blood
    "specular": (0.02, 0.05),  # n = 1.33 to 1.57
}
PINNED = {"eumelanin_power": "eumelanin_scale", "pheomelanin_power": "pheomelanin_scale"}
"""Powers that turn about 550 nm, and the scales that follow."""
FIRST = replace(
    ALIAGA2022, name="variant", scattering_500=68.7, rayleigh_fraction=0.0, mie_power=1.5,
    baseline_scale=0.0, baseline_offset=0.244,
    baseline_exponential=85.3, bilirubin=0.008, dimension=3, boundary="fresnel",
    hemoglobin_table="bosschaart2014",
)  # fmt: skip
"""Published constants as they stand."""
STEPS = (
    ({}, ("mie_power", "baseline_offset", "baseline_exponential")),
    ({"hemoglobin_shift": -1.5}, ("hemoglobin_shift",)),
    ({}, ("eumelanin_power", "pheomelanin_power")),
    ({"hemoglobin_table": "bosschaart2014-prahl1999"}, ()),
    ({"carotene_shift": 15.0, "beta_carotene_epidermis": 1.6e-3}, ("beta_carotene_epidermis",)),
    ({}, ("specular",)),
    ({}, ("scattering_500", "dermis_scattering", "rayleigh_fraction")),
    ({"vessel_radius": 1.0}, ("vessel_radius",)),
    ({}, ("bilirubin", "beta_carotene_dermis")),
    ({}, ("baseline_scale",)),
)
"""What the study sets and frees, in this order."""
FEW = [name for _, names in STEPS[:5] for name in names]
"""Constants that are refitted where one of the others is put back or an origin left out."""
LIBRARY = qmc.Halton(5, scramble=True, rng=0).random(4096) * np.array([0.8, 0.85, 1, 1, 1])
PART = (LIBRARY[:, 2:] > 0.5) @ np.array([1, 2, 4])
Array = np.ndarray


class Study:
    """Spectra (m, 31) with their origins and groups, and the fit of constants to them."""

    def __init__(self, data: Path) -> None:
        skins = read_skins(data)
        self.spectra, self.origins, self.groups = skins.spectra, skins.origins, skins.groups
        self.tables: dict[tuple[int, float], Array] = {}

    def sample(self, count: int, without: int | None = None, seed: int = 0) -> Array:
        """At most `count` spectra of every origin and group of ISSA."""
        rng, chosen = np.random.default_rng(seed), []
        for origin in range(1, 12):
            for group in np.unique(self.groups[self.origins == origin]):
                of = np.flatnonzero((self.origins == origin) & (self.groups == group))
                if origin != without:
                    chosen.append(rng.choice(of, min(count, len(of)), replace=False))
        return np.concatenate(chosen)

    def eight_groups(self, seed: int = 0) -> Array:
        """120 of each of the eight groups of ISSA."""
        rng, issa = np.random.default_rng(seed), self.origins < 12
        return np.concatenate(
            [
                rng.choice(np.flatnonzero((self.groups == g) & issa), 120, replace=False)
                for g in np.unique(self.groups[issa])
            ]
        )

    def table(self, tissue: Tissue) -> Array:
        """The dimensionless table for the tissue's boundary and dimension."""
        key = (tissue.dimension, tissue.outer_index)
        if key not in self.tables:
            self.tables[key] = dimensionless_table(tissue.anisotropy(LAM), *key)
        return self.tables[key]

    def fit(self, tissue: Tissue, rho: float, rows: Array) -> tuple[Array, Array]:
        """Coordinates (m, 5) and RMSE (m,) of spectra `rows` under constants."""
        y, spectra, table = self.spectra[rows], coefficients(tissue), self.table(tissue)
        known, _ = reduced(
            LIBRARY, np.zeros((len(LIBRARY), len(LAM))), spectra, np.zeros((0, 8, len(LAM))),
            table, rho,
        )  # fmt: skip
        distance = (known**2).sum(axis=1) - 2 * y @ known.T
        parts = [np.flatnonzero(np.equal(PART, part)) for part in range(8)]
        nearest = [part[distance[:, part].argmin(axis=1)] for part in parts]
        u = np.empty((len(y), 5))
        cost = fit_skins(LIBRARY[np.array(nearest).T], y, spectra, table, rho, u)
        return u, np.sqrt(cost / len(LAM))

    def calibrate(
        self, tissue: Tissue, free: Sequence[str], rho: float, rows: Array
    ) -> tuple[Tissue, float]:
        """Constants called `free` at the best place near the given ones; ρ too."""
        values = [rho if name == "specular" else getattr(tissue, name) for name in free]
        low, high = np.array([RANGES[name] for name in free]).T
        v = np.clip((np.array(values) - low) / (high - low), 0, 1)
        y, table, damping = self.spectra[rows], self.table(tissue), 1e-2

        def constants(v: Array) -> tuple[Tissue, float]:
            return changed(tissue, rho, dict(zip(free, low + v * (high - low), strict=True)))

        def score(v: Array, u: Array | None) -> tuple[float, Array]:
            made, r = constants(v)
            if u is None:
                u, _ = self.fit(made, r, rows)
            else:
                warm, u = u, np.empty_like(u)
                fit_skins(warm[:, None], y, coefficients(made), table, r, u)
            found, _ = reduced(u, y, coefficients(made), np.zeros((0, 8, len(LAM))), table, r)
            return np.sqrt((found**2).mean(1)).mean() + PULL * (found.mean(0) ** 2).sum(), u

        best, u = score(v, None)
        for _ in range(40):
            made, r = constants(v)
            slopes = []
            for i in range(len(free)):
                ends = np.clip(v[i] + np.array([-1e-4, 1e-4]), 0, 1)
                near = [constants(np.where(np.arange(len(v)) == i, end, v)) for end in ends]
                low_end, high_end = (coefficients(made) for made, _ in near)
                slopes.append((high_end - low_end) / (ends[1] - ends[0]))
            found, slope = reduced(u, y, coefficients(made), np.array(slopes), table, r)
            if "specular" in free:
                i = free.index("specular")
                slope[:, :, i] = slope[:, :, -1] * (high[i] - low[i])
            slope = slope[:, :, :-1]
            weight = 1 / (len(y) * len(LAM) * (np.sqrt((found**2).mean(axis=1)) + 5e-4))
            mean, mean_slope = found.mean(axis=0), slope.mean(axis=0)
            gradient = np.einsum("i,ib,ibq->q", weight, found, slope)
            gradient += 2 * PULL * mean_slope.T @ mean
            curve = np.einsum("i,ibp,ibq->pq", weight, slope, slope, optimize=True)
            curve += 2 * PULL * mean_slope.T @ mean_slope
            moves = ~(((v <= 0) & (gradient > 0)) | ((v >= 1) & (gradient < 0)))
            before = best
            while moves.any() and damping < 1e4:
                part = curve[np.ix_(moves, moves)]
                part = part + (damping * np.diag(part) + 1e-9 * part.max()) * np.eye(len(part))
                trial = v.copy()
                trial[moves] -= np.clip(np.linalg.solve(part, gradient[moves]), -0.25, 0.25)
                new, new_u = score(np.clip(trial, 0, 1), u)
                if new < best:
                    v, best, u = np.clip(trial, 0, 1), new, new_u
                    damping = max(damping * 0.3, 1e-6)
                    break
                damping *= 6
            if before - best < 1e-4 * best:
                break
        return constants(v)


def changed(tissue: Tissue, rho: float, values: dict[str, float]) -> tuple[Tissue, float]:
    """Constants with some of them replaced; melanins keep their absorption at 550 nm."""
    fields = {name: float(value) for name, value in values.items()}
    rho = fields.pop("specular", rho)
    for power, scale in PINNED.items():
        if power in fields:
            fields[scale] = getattr(tissue, scale) * 550.0 ** (
                getattr(tissue, power) - fields[power]
            )
    return replace(tissue, name="variant", **fields), rho


def coefficients(tissue: Tissue) -> Array:
    """(8, 31) μa of what skin is made of and μs of both layers."""
    scattering = tissue.scattering(LAM)
    rows = [
        tissue.eumelanin(LAM), tissue.pheomelanin(LAM), tissue.epidermis_background(LAM),
        *tissue.whole_blood(LAM), tissue.baseline(LAM), scattering,
        scattering * tissue.dermis_scattering,
    ]  # fmt: skip
    return np.array(rows)


def describe(study: Study, what: str, constants: tuple[Tissue, float], rows: Array) -> Array:
    """Prints a row: mean RMSE, worst mean residual, medians; returns the parameters (m, 5)."""
    u, rmse = study.fit(*constants, rows)
    tissue, rho = constants
    residual, _ = reduced(
        u, study.spectra[rows], coefficients(tissue), np.zeros((0, 8, len(LAM))),
        study.table(tissue), rho,
    )  # fmt: skip
    bias = residual.mean(axis=0)
    worst = np.abs(bias).argmax()
    skins = from_coordinates(u)
    melanin, blood, thickness, _, oxygen = np.median(skins, axis=0)
    print(
        f"| {what} | {rmse.mean():.5f} | {bias[worst]:+.4f}, {LAM[worst]:g} | {melanin:.3f} | "
        f"{blood:.3f} | {thickness:.0f} | {oxygen:.2f} |",
        flush=True,
    )
    return skins


def listed(constants: tuple[Tissue, float], names: Sequence[str]) -> str:
    """Values of constants, for the eye."""
    tissue, rho = constants
    return ", ".join(f"{n} {rho if n == 'specular' else getattr(tissue, n):.4g}" for n in names)


def by_colour(study: Study, rows: Array, skins: Array) -> None:
    """Prints medians in bands of ITA°."""
    angle = ita(reflectance_to_rgb(study.spectra[rows], LAM))
    ends = [90, 55, 41, 28, 10, -30, -90]
    for high, low in pairwise(ends):
        inside = (angle > low) & (angle <= high)
        melanin, blood, thickness, _, oxygen = np.median(skins[inside], axis=0)
        print(
            f"| {low} to {high} | {inside.sum()} | {melanin:.3f} | {blood:.3f} | {thickness:.0f} "
            f"| {oxygen:.2f} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parents[2] / "shared" / "data"
    parser.add_argument("data", type=Path, nargs="?", default=default)
    study = Study(parser.parse_args().data)
    test, train = study.eight_groups(), study.sample(60)
    issa = np.flatnonzero(study.origins < 12)
    print("| constants | mean RMSE | worst bias, nm | melanin | blood | thickness | oxygenation |")
    print("|---|---|---|---|---|---|---|")
    describe(study, "aliaga2022", (ALIAGA2022, 0.028), test)
    free: list[str] = []
    constants = (FIRST, 0.028)
    describe(study, "published ones, none fitted", constants, test)
    for fields, names in STEPS:
        free += names
        tissue, rho = constants
        constants = study.calibrate(replace(tissue, **fields), free, rho, train)
        describe(study, "and " + ", ".join({**fields, **dict.fromkeys(names)}), constants, test)
        print(f"<!-- {listed(constants, free)} -->")
    describe(study, "measured2026", (MEASURED2026, 0.028), test)
    skins = describe(study, "measured2026, all of ISSA", (MEASURED2026, 0.028), issa)
    print("\nmeasured2026, medians by ITA°:")
    by_colour(study, issa, skins)
    print("\nWithout some of it, the others refitted:")
    for what, fields in (
        ("nothing put back", {}),
        ("flatland, matched", {"dimension": 2, "boundary": "matched"}),
        ("matched", {"boundary": "matched"}),
        ("flatland", {"dimension": 2}),
        ("haemoglobin prahl1999", {"hemoglobin_table": "prahl1999"}),
        ("haemoglobin bosschaart2014", {"hemoglobin_table": "bosschaart2014"}),
        ("haemoglobin not shifted", {"hemoglobin_shift": 0.0}),
        ("carotene as in hexane, 2.1e-4", {"carotene_shift": 0.0,
                                           "beta_carotene_epidermis": 2.1e-4}),
        ("eumelanin of -2.70", {"eumelanin_power": -2.7,
                                "eumelanin_scale": 6.6e11 * 550.0 ** (2.7 - 3.33)}),
        ("dermis 0.65 of scattering", {"dermis_scattering": 0.65}),
        ("scattering 46", {"scattering_500": 46.0}),
        ("baseline saidi1992", {"baseline_scale": 7.84e8, "baseline_offset": 0.0,
                                "baseline_exponential": 0.0}),
        ("half of saidi1992", {"baseline_scale": 3.92e8, "baseline_offset": 0.0,
                               "baseline_exponential": 0.0}),
    ):  # fmt: skip
        start = replace(MEASURED2026, name="variant", **fields)
        names = [n for n in FEW if n not in fields]
        rho = [] if start.boundary == "fresnel" else ["specular"]
        describe(study, what, study.calibrate(start, names + rho, 0.028, train), test)
    print("\nmeasured2026, the same without the shift, and constants of all but the origin tested:")
    bare = replace(MEASURED2026, name="variant", hemoglobin_shift=0.0)
    for origin in range(1, 13):
        rows = np.flatnonzero(study.origins == origin)
        describe(study, f"{origin}, {len(rows)} skins", (MEASURED2026, 0.028), rows)
        describe(study, f"{origin}, not shifted", (bare, 0.028), rows)
        left = study.calibrate(MEASURED2026, FEW, 0.028, study.sample(60, without=origin))
        describe(study, f"{origin}, left out, {listed(left, FEW)}", left, rows)


if __name__ == "__main__":
    main()
