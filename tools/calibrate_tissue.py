"""Fits shared constants of a tissue to measured skin: `python tools/calibrate_tissue.py`.

Every skin has its own five parameters, all skins the same constants. For a choice of constants the
five are fitted exactly; constants then move by Gauss–Newton with the five following (variable
projection). What is minimised is the mean RMSE plus PULL times the sum over wavelengths of the
squared mean residual, inside published ranges. ρ and the shift of wavelengths belong to
instruments, not to skin. Docs: docs/decisions/0022-measured2026.md.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from calibration_kernel import dimensionless_table, fit_skins, reduced
from scipy.stats import qmc

from cutis.figures.measured import BANDS, read_skins
from cutis.optics import ALIAGA2022, MEASURED2026, Tissue, from_coordinates

LAM = BANDS
PULL = 5.0
RANGES = {
    # cm⁻¹ at 500 nm and slope of skin [jacques2013]; of epidermis, dermis over it [salomatina2006]
    "scattering_500": (29.7, 72.0),
    "mie_power": (0.7, 1.83),
    "rayleigh_fraction": (0.0, 0.62),
    "dermis_scattering": (0.5, 1.0),
    # cm⁻¹: half to all of jacques1998, or to all of saidi1992
    "baseline_offset": (0.12, 0.244),
    "baseline_exponential": (42.6, 85.3),
    "baseline_scale": (0.0, 7.84e8),
    "eumelanin_power": (-3.48, -2.70),  # jacques1998, and sarna2006 at 400–550 nm
    "pheomelanin_power": (-5.07, -4.40),  # sarna2006 at 400–700 and at 400–550 nm
    "vessel_radius": (0.0, 25.0),  # µm, upper plexus [svaasand1995]
    "bilirubin": (0.0, 0.05),  # g/L of blood
    "beta_carotene_epidermis": (0.0, 1e-3),  # g/L, all carotenoids
    "beta_carotene_dermis": (0.0, 1e-3),
    "specular": (0.02, 0.05),  # n = 1.33 to 1.57
    "shift": (-1.0, 4.0),  # nm
}
PINNED = {"eumelanin_power": "eumelanin_scale", "pheomelanin_power": "pheomelanin_scale"}
"""Powers that turn about 550 nm, and the scales that follow."""
STEPS = (
    ("mie_power", "baseline_offset", "baseline_exponential"),
    ("shift",),
    ("eumelanin_power", "pheomelanin_power"),
    ("specular",),
    ("scattering_500", "dermis_scattering", "rayleigh_fraction"),
    ("vessel_radius",),
    ("bilirubin", "beta_carotene_epidermis", "beta_carotene_dermis"),
    ("baseline_scale",),
)
"""Constants in the order in which the study frees them."""
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

    def fit(self, tissue: Tissue, rho: float, shift: float, rows: Array) -> tuple[Array, Array]:
        """Coordinates (m, 5) and RMSE (m,) of spectra `rows` under constants."""
        y, spectra, table = self.spectra[rows], coefficients(tissue, shift), self.table(tissue)
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
        self, tissue: Tissue, free: Sequence[str], rho: float, shift: float, rows: Array
    ) -> tuple[Tissue, float, float]:
        """Constants called `free` at the best place near the given ones; ρ and shift too."""
        values = [shift if n == "shift" else rho if n == "specular" else getattr(tissue, n)
                  for n in free]  # fmt: skip
        low, high = np.array([RANGES[name] for name in free]).T
        v = np.clip((np.array(values) - low) / (high - low), 0, 1)
        y, table, damping = self.spectra[rows], self.table(tissue), 1e-2

        def constants(v: Array) -> tuple[Tissue, float, float]:
            return changed(tissue, rho, shift, dict(zip(free, low + v * (high - low), strict=True)))

        def score(v: Array, u: Array | None) -> tuple[float, Array]:
            made, r, s = constants(v)
            if u is None:
                u, _ = self.fit(made, r, s, rows)
            else:
                warm, u = u, np.empty_like(u)
                fit_skins(warm[:, None], y, coefficients(made, s), table, r, u)
            found, _ = reduced(u, y, coefficients(made, s), np.zeros((0, 8, len(LAM))), table, r)
            return np.sqrt((found**2).mean(1)).mean() + PULL * (found.mean(0) ** 2).sum(), u

        best, u = score(v, None)
        for _ in range(40):
            made, r, s = constants(v)
            slopes = []
            for i in range(len(free)):
                ends = np.clip(v[i] + np.array([-1e-4, 1e-4]), 0, 1)
                near = [constants(np.where(np.arange(len(v)) == i, end, v)) for end in ends]
                low_end, high_end = (coefficients(made, shifted) for made, _, shifted in near)
                slopes.append((high_end - low_end) / (ends[1] - ends[0]))
            found, slope = reduced(u, y, coefficients(made, s), np.array(slopes), table, r)
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


def changed(
    tissue: Tissue, rho: float, shift: float, values: dict[str, float]
) -> tuple[Tissue, float, float]:
    """Constants with some of them replaced; melanins keep their absorption at 550 nm."""
    fields = {name: float(value) for name, value in values.items()}
    rho, shift = fields.pop("specular", rho), fields.pop("shift", shift)
    for power, scale in PINNED.items():
        if power in fields:
            fields[scale] = getattr(tissue, scale) * 550.0 ** (
                getattr(tissue, power) - fields[power]
            )
    return replace(tissue, name="variant", **fields), rho, shift


def coefficients(tissue: Tissue, shift: float) -> Array:
    """(8, 31) μa of what skin is made of and μs of both layers, as the instrument sees them."""
    lam = LAM + shift
    scattering = tissue.scattering(lam)
    rows = [
        tissue.eumelanin(lam), tissue.pheomelanin(lam), tissue.epidermis_background(lam),
        *tissue.whole_blood(lam), tissue.baseline(lam), scattering,
        scattering * tissue.dermis_scattering,
    ]  # fmt: skip
    return np.array(rows)


def describe(study: Study, what: str, constants: tuple[Tissue, float, float], rows: Array) -> None:
    """Prints a row: mean RMSE, worst mean residual, medians."""
    u, rmse = study.fit(*constants, rows)
    tissue, rho, shift = constants
    residual, _ = reduced(
        u, study.spectra[rows], coefficients(tissue, shift), np.zeros((0, 8, len(LAM))),
        study.table(tissue), rho,
    )  # fmt: skip
    bias = residual.mean(axis=0)
    worst = np.abs(bias).argmax()
    melanin, blood, thickness, _, oxygen = np.median(from_coordinates(u), axis=0)
    print(
        f"| {what} | {rmse.mean():.5f} | {bias[worst]:+.4f} at {LAM[worst]:g} | {melanin:.3f} | "
        f"{blood:.3f} | {thickness:.0f} | {oxygen:.2f} |",
        flush=True,
    )


def listed(constants: tuple[Tissue, float, float], names: Sequence[str]) -> str:
    """Values of constants, for the eye."""
    tissue, rho, shift = constants
    known = {"specular": rho, "shift": shift}
    return ", ".join(f"{n} {known[n] if n in known else getattr(tissue, n):.4g}" for n in names)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parents[2] / "shared" / "data"
    parser.add_argument("data", type=Path, nargs="?", default=default)
    study = Study(parser.parse_args().data)
    test, train = study.eight_groups(), study.sample(60)
    print("| constants | mean RMSE | worst bias, nm | melanin | blood | thickness | oxygenation |")
    print("|---|---|---|---|---|---|---|")
    describe(study, "aliaga2022", (ALIAGA2022, 0.028, 0.0), test)
    first = replace(
        ALIAGA2022, name="variant", scattering_500=68.7, rayleigh_fraction=0.0, mie_power=1.5,
        baseline_scale=0.0, baseline_offset=0.244,
        baseline_exponential=85.3, bilirubin=0.008, dimension=3, boundary="fresnel",
        hemoglobin_table="bosschaart2014",
    )  # fmt: skip
    free: list[str] = []
    constants = (first, 0.028, 0.0)
    describe(study, "published ones, none fitted", constants, test)
    for step in STEPS:
        free += step
        if step == ("shift",):
            constants = (*constants[:2], 1.5)
        constants = study.calibrate(constants[0], free, *constants[1:], train)
        describe(study, "and " + ", ".join(step), constants, test)
        print(f"<!-- {listed(constants, free)} -->")
    few = [*STEPS[0], *STEPS[1], *STEPS[2]]
    print("\nWithout some of it, refitted:")
    for what, fields in (
        ("flatland, matched", {"dimension": 2, "boundary": "matched"}),
        ("matched", {"boundary": "matched"}),
        ("flatland", {"dimension": 2}),
        ("haemoglobin prahl1999", {"hemoglobin_table": "prahl1999"}),
        ("dermis 0.65 of scattering", {"dermis_scattering": 0.65}),
        ("scattering 46", {"scattering_500": 46.0}),
        ("baseline saidi1992", {"baseline_scale": 7.84e8, "baseline_offset": 0.0}),
        ("half of saidi1992", {"baseline_scale": 3.92e8, "baseline_offset": 0.0}),
    ):
        start = replace(MEASURED2026, name="variant", **fields)
        names = [n for n in few if "baseline" not in n or "saidi" not in what]
        if "saidi" in what:
            start = replace(start, baseline_exponential=0.0)
        rho = [] if start.boundary == "fresnel" else ["specular"]
        describe(study, what, study.calibrate(start, names + rho, 0.028, 1.8, train), test)
    print("\nmeasured2026, constants of all origins and of all but the one tested:")
    for origin in range(1, 13):
        rows = np.flatnonzero(study.origins == origin)
        for shift in (0.0, 1.8):
            describe(study, f"{origin}, shift {shift:g}", (MEASURED2026, 0.028, shift), rows)
        left = study.calibrate(MEASURED2026, few, 0.028, 1.8, study.sample(60, without=origin))
        describe(study, f"{origin}, left out, {listed(left, few)}", left, rows)


if __name__ == "__main__":
    main()
