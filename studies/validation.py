"""Tables and plots of docs/validation.md, on measured skins: `python -m studies.validation`.

`validation_study.py` holds what is measured, `validation_plots.py` the plots. The data is
../shared/data beside the project, or the folder named.
"""

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from cutis.optics import NAMES
from studies.figures.measured import BANDS, GROUPS, NIST, ORIGINS, read_skins
from studies.figures.section import table
from studies.figures.subjects import data_folder
from studies.generated import record
from studies.pages import DOCS, rewrite
from studies.validation_plots import BAND_NAMES, PLOTS, draw
from studies.validation_study import (
    CALIBRATED,
    FOLDS,
    JUDGED,
    LEARNED,
    LIGHTS,
    PER_BAND,
    TISSUES,
    Study,
    study,
)

Array = np.ndarray
HELD_OUT = f"{LEARNED}, origins left out"
REPORTED = {
    "the best other biophysical inversion known": (0.0094, 0.0209),
    "BioSkin": (0.0153, 0.0337),
}
"""Median and 95th percentile that others got on the same archive; not run here."""


def parts(found: Study, what: str) -> dict[str, Array]:
    """Names and rows of bands, groups or origins; bands and groups are those of ISSA."""
    skins = found.skins
    if what == "band":
        named = {BAND_NAMES[b]: (skins.bands == b) & found.issa for b in range(len(BAND_NAMES))}
    elif what == "group":
        named = {label: skins.groups == key for key, label in GROUPS.items() if key != "NIST"}
    else:
        named = {label: skins.origins == key for key, label in ORIGINS.items()}
    return {label: rows for label, rows in named.items() if rows.any()}


def worst_bias(wrong: Array) -> tuple[float, float]:
    """The mean residual that is farthest from 0, and its wavelength."""
    mean = wrong.mean(axis=0)
    at = int(np.abs(mean).argmax())
    return float(mean[at]), float(BANDS[at])


def fit_table(found: Study, named: dict[str, Array], what: str) -> str:
    """Mean RMSE and worst bias of all tissues."""
    rows = []
    for label, of in named.items():
        row = [label, str(of.sum())]
        for tissue in TISSUES:
            spectra = found.fits[tissue.name]
            bias, at = worst_bias((spectra - found.skins.spectra)[of])
            row += [f"{found.rmse(spectra)[of].mean():.4f}", f"{bias:+.4f} at {at:g}"]
        rows.append(row)
    every = [c for t in TISSUES for c in (f"`{t.name}`: RMSE", "worst bias, nm")]
    return table([what, "skins", *every], rows)


def spectrum_table(found: Study) -> str:
    """RMS of implied spectra by method."""
    bands, rows = parts(found, "band"), []
    nist = found.skins.origins == NIST
    for name, spectra in found.implied.items():
        rms = found.rmse(spectra)
        row = [f"{np.median(rms[found.issa]):.4f}", f"{np.percentile(rms[found.issa], 95):.4f}"]
        row += [f"{np.median(rms[of]):.4f}" for of in (nist, *bands.values()) if of.any()]
        rows.append([name, *row])
    rows += [
        [f"{name}, as reported", f"{median:.4f}", f"{high:.4f}"] + ["–"] * (len(bands) + nist.any())
        for name, (median, high) in REPORTED.items()
    ]
    rows.sort(key=lambda row: float(row[1]))
    extra = ["NIST"] if nist.any() else []
    return table(["method", "median", "p95", *extra, *bands], rows)


def light_table(found: Study) -> str:
    """ΔE00 of implied against measured spectra, by method and light."""
    rows = []
    for name, spectra in found.implied.items():
        row = [name]
        for light in LIGHTS:
            error = found.relit(spectra, light)[found.issa]
            row += [f"{np.median(error):.2f}", f"{np.percentile(error, 95):.2f}"]
        rows.append(row)
    rows.sort(key=lambda row: float(row[1]))
    return table(["method", *(c for light in LIGHTS for c in (f"{light}: median", "p95"))], rows)


def coverage_table(found: Study, named: Iterable[tuple[str, str, Array]]) -> str:
    """What the 90 % intervals hold, in percent: of (label, split, rows)."""
    rows = []
    for label, split, of in named:
        share = 100 * found.inside(found.held[split])[of].mean(axis=0)
        rows.append([label, str(of.sum()), *(f"{s:.0f}" for s in share), f"{share.mean():.1f}"])
    return table(["skins", "number", *NAMES, "mean"], rows)


def coverage_tables(found: Study) -> dict[str, str]:
    """Overall, per band, per origin."""
    splits = {"subject": "subjects left out", "origin": "origins left out", "shipped": "as shipped"}
    splits = {key: words for key, words in splits.items() if key in found.held}
    bands, origins = parts(found, "band"), parts(found, "origin")
    return {
        "coverage": coverage_table(found, [(w, s, found.issa) for s, w in splits.items()]),
        "coverage_bands": coverage_table(
            found,
            [
                (f"{b}, {splits[s]}", s, of)
                for b, of in bands.items()
                for s in ("subject", "origin")
            ],
        ),
        "coverage_origins": coverage_table(found, [(o, "origin", of) for o, of in origins.items()]),
    }


def fairness_table(found: Study, what: str) -> str:
    """Closed loop, spectra, light, coverage and σ side by side, and worst over best."""
    spectra, held = found.implied[HELD_OUT], found.held["subject"]
    rms, light, inside = found.rmse(spectra), found.relit(spectra, "A"), found.inside(held)
    columns: dict[str, Callable[[Array], float]] = {
        "closed loop ΔE00, mean": lambda of: float(found.loop[of].mean()),
        "p95": lambda of: float(np.percentile(found.loop[of], 95)),
        "spectral RMS, median": lambda of: float(np.median(rms[of])),
        "ΔE00 under A, median": lambda of: float(np.median(light[of])),
        "coverage, %": lambda of: float(100 * inside[of].mean()),
    }
    for i, name in enumerate(NAMES):
        columns[f"σ {name}"] = lambda of, i=i: float(np.median(held.coordinate_sigma[of, i]))
    named = parts(found, what)
    values = np.array([[column(of) for column in columns.values()] for of in named.values()])
    form = (".3f", ".3f", ".4f", ".2f", ".1f", *[".2f"] * len(NAMES))
    rows = [
        [label, str(of.sum()), *(f"{v:{f}}" for v, f in zip(row, form, strict=True))]
        for (label, of), row in zip(named.items(), values, strict=True)
    ]
    ratio = values.max(axis=0) / np.maximum(values.min(axis=0), 1e-9)
    rows.append(["worst / best", "", *(f"{r:.2f}" for r in ratio)])
    return table([what, "skins", *columns], rows)


def summary_table(found: Study) -> str:
    """What was aimed at, and what came out."""
    of, bands = found.issa, parts(found, "band")
    fitted = found.fits[JUDGED.name]
    bias, at = worst_bias((fitted - found.skins.spectra)[of])
    light = found.relit(found.implied[HELD_OUT], "A")
    inside = {split: found.inside(found.held[split]) for split in ("subject", "origin")}

    def share(split: str, rows: Array) -> Array:
        return 100 * inside[split][rows].mean(axis=0)

    def span(split: str) -> tuple[float, float]:
        every = np.array([share(split, rows) for rows in bands.values()])
        return float(every.min()), float(every.max())

    loop = [float(found.loop[rows].mean()) for rows in bands.values()]
    relit = [float(np.median(light[rows])) for rows in bands.values()]
    fit = found.rmse(fitted)[of].mean()
    rows = [
        ("Fits of spectra: mean RMSE", "0.005", f"{fit:.5f}", fit <= 0.005),
        ("worst mean bias of a wavelength", "0.003", f"{bias:+.5f} at {at:g} nm",
         abs(bias) < 0.003),
    ]  # fmt: skip
    for split in ("subject", "origin"):
        rms = found.rmse(found.implied[f"{LEARNED}, {split}s left out"])[of]
        median, high = np.percentile(rms, [50, 95])
        rows += [
            (f"RGB → spectrum, {split}s left out: median RMS", "0.0055", f"{median:.5f}",
             median <= 0.0055),
            ("95th percentile", "0.015", f"{high:.5f}", high <= 0.015),
        ]  # fmt: skip
    for split in ("subject", "origin"):
        overall, (low, top) = share(split, of), span(split)
        rows += [
            (f"90 % intervals, {split}s left out: hold", "87–93 %",
             f"{overall.min():.1f}–{overall.max():.1f} %, by parameter",
             overall.min() >= 87 and overall.max() <= 93),
            ("in every band of ITA°", "87–93 %", f"{low:.1f}–{top:.1f} %, by band and parameter",
             low >= 87 and top <= 93),
        ]  # fmt: skip
    for what, values in (("closed loop", loop), ("relit by A", relit)):
        ratio = max(values) / max(min(values), 1e-9)
        rows.append(
            (f"ΔE00 of the worst band over the best, {what}", "1.50", f"{ratio:.2f}", ratio <= 1.5)
        )
    return table(
        ["what", "aim", "found", ""],
        [[what, aim, value, "met" if met else "not met"] for what, aim, value, met in rows],
    )


def person_table(found: Study) -> str:
    """How much skins of one face differ, over how much all faces do, by parameter."""
    rows = []
    for tissue in CALIBRATED:
        within, between = found.persons[tissue.name]
        shares = (f"{w:.2f} / {b:.2f} = {w / b:.2f}" for w, b in zip(within, between, strict=True))
        rows.append([f"`{tissue.name}`", *shares])
    return table(["tissue", *NAMES], rows)


def odd_table(found: Study) -> str:
    """Fits to every other wavelength, judged on those in between."""
    rows = [
        [f"`{name}`", f"{rmse:.4f}", f"{bias:+.4f} at {at:g}"]
        for name, (rmse, bias, at) in found.odd.items()
    ]
    return table(["tissue", "mean RMSE", "worst bias, nm"], rows)


def scope(found: Study) -> str:
    """How many skins of whom, and how much was learned on."""
    skins, people = found.skins, len(set(found.skins.subjects[found.issa]))
    return (
        f"{found.issa.sum()} spectra of {people} people in {len(set(skins.origins[found.issa]))} "
        f"campaigns of ISSA, and {(~found.issa).sum()} forearms of NIST. Where skins are left out, "
        f"a prior is learned anew on the others, at most {found.per_band} from each band of ITA°; "
        f"subjects are left out in {FOLDS} parts, origins one by one."
    )


def tables(found: Study) -> dict[str, str]:
    """The tables of the page by their markers."""
    every = {"all of ISSA": found.issa, "NIST": ~found.issa}
    return {
        "scope": scope(found),
        "summary": summary_table(found),
        "fits_groups": fit_table(
            found,
            {label: of for label, of in {**every, **parts(found, "group")}.items() if of.any()},
            "group",
        ),
        "fits_bands": fit_table(found, parts(found, "band"), "ITA° band"),
        "fits_origins": fit_table(found, parts(found, "origin"), "origin"),
        "odd": odd_table(found),
        "persons": person_table(found),
        "spectra": spectrum_table(found),
        "lights": light_table(found),
        **coverage_tables(found),
        "fairness_bands": fairness_table(found, "band"),
        "fairness_groups": fairness_table(found, "group"),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, nargs="?", help="folder of the larger data")
    parser.add_argument(
        "--per-band", type=int, default=PER_BAND,
        help="skins of an ITA° band that priors are learned on, at most",
    )  # fmt: skip
    given = parser.parse_args()
    data = data_folder(given.data)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder")
    found = study(read_skins(data), given.per_band)
    draw(found, DOCS / "images")
    record(*(DOCS / "images" / f"validation-{name}.png" for name in PLOTS))
    rewrite("validation.md", **tables(found))


if __name__ == "__main__":
    main()
