"""Plots of `validation.py`: one colour per band of ITA°, that of its skins."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from PIL import Image

from cutis.colour import encode_srgb
from cutis.optics import ALIAGA2022, PARAMETERS
from studies.figures.measured import BANDS, GROUPS, ORIGINS
from studies.validation_study import JUDGED, LEARNED, LEVELS, Study

Array = np.ndarray
BAND_NAMES = ("dark", "brown", "tan", "intermediate", "light", "very light")
WIDTH = 9.0
"""Inches; 900 px."""
INK, GRID = "#2b2622", "#e8e4df"
METHODS = {
    f"{LEARNED}, origins left out": ("#b3432b", "-"),
    "linear regression, origins left out": ("#4a6fa5", "-"),
    "cutis `aliaga2022-exact`, as shipped": ("#7a8f3c", "-"),
    "Jakob & Hanika 2019": ("#8a6bb1", "--"),
    "Mallett & Yuksel 2019": ("#777777", "--"),
}
PARAMETER_COLOURS = ("#8c5a2b", "#c0392b", "#2a8c82", "#d4a017", "#4a6fa5")
STYLE = {
    "font.size": 8.5,
    "axes.edgecolor": "#b8b0a8",
    "axes.labelcolor": INK,
    "axes.titlesize": 9.5,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.grid": True,
    "grid.color": GRID,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
}


def band_colours(study: Study) -> dict[int, Array]:
    """sRGB of the skin of every band, to tell them apart.

    As light as the darker ones of the dark to the lighter ones of the very light, 1.6 times.
    """
    skins, colours = study.skins, {}
    for band in np.unique(skins.bands):
        of = skins.albedo[skins.bands == band]
        mean, lightness = of.mean(axis=0), of.mean(axis=1)
        scale = np.percentile(lightness, 10 + 16 * band) / mean.mean()
        colours[int(band)] = np.clip(encode_srgb(1.6 * scale * mean), 0, 1)
    return colours


def examples(study: Study) -> Figure:
    """A median and a badly fitted skin of every group, measured and fitted."""
    figure = Figure(figsize=(WIDTH, 4.9), layout="constrained")
    rmse = study.rmse(study.fits[JUDGED.name])
    groups = [g for g in GROUPS if (study.skins.groups[study.issa] == g).any()]
    panels = figure.subplots(2, 4, sharex=True, sharey=True).ravel()
    for axes, group in zip(panels, groups, strict=False):
        of = np.flatnonzero(study.skins.groups == group)
        order = of[np.argsort(rmse[of])]
        found = []
        for share, marker in ((0.5, "o"), (0.95, "D")):
            i = order[min(int(share * len(order)), len(order) - 1)]
            colour = np.clip(encode_srgb(study.skins.albedo[i]), 0, 1)
            axes.plot(
                BANDS, study.fits[ALIAGA2022.name][i], color="#9a948d", linewidth=1, linestyle="--"
            )
            axes.plot(BANDS, study.fits[JUDGED.name][i], color=INK, linewidth=1.2)
            axes.plot(
                BANDS, study.skins.spectra[i], marker, color=colour, markersize=4.2,
                markeredgecolor=INK, markeredgewidth=0.4,
            )  # fmt: skip
            found.append(rmse[i])
        axes.text(
            0.04, 0.97, "RMSE\n● {:.4f}\n◆ {:.4f}".format(*found), transform=axes.transAxes,
            va="top", fontsize=7.5, linespacing=1.35,
        )  # fmt: skip
        axes.set_title(f"{GROUPS[group]} ({len(of)})")
    panels[0].set(ylim=(0, 0.75), xlim=(395, 705), xticks=(400, 500, 600, 700))
    for axes in panels[4:]:
        axes.set_xlabel("wavelength [nm]")
    for axes in panels[::4]:
        axes.set_ylabel("reflectance")
    handles = [
        panels[0].plot([], [], "o", color="#d8ab8e", markeredgecolor=INK, markersize=5)[0],
        panels[0].plot([], [], "D", color="#d8ab8e", markeredgecolor=INK, markersize=4.5)[0],
        panels[0].plot([], [], color=INK)[0],
        panels[0].plot([], [], color="#9a948d", linestyle="--")[0],
    ]
    figure.legend(
        handles,
        ["measured, median RMSE of the group", "measured, 95th percentile",
         f"fit, {JUDGED.name}", "fit, aliaga2022"],
        loc="outside upper center", ncols=4,
    )  # fmt: skip
    return figure


def residuals(study: Study) -> Figure:
    """Mean residual by wavelength of every band, for both tissues."""
    figure, colours = Figure(figsize=(WIDTH, 3.6), layout="constrained"), band_colours(study)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, tissue in zip(panels, (ALIAGA2022, JUDGED), strict=True):
        wrong = study.fits[tissue.name] - study.skins.spectra
        axes.axhspan(-0.003, 0.003, color="#f1efe8", zorder=0)
        axes.axhline(0, color="#b8b0a8", linewidth=0.8)
        for band, colour in colours.items():
            mean = wrong[(study.skins.bands == band) & study.issa].mean(axis=0)
            axes.plot(BANDS, mean, color=INK, linewidth=3.2)
            axes.plot(BANDS, mean, color=colour, linewidth=2.2)
        mean = wrong[study.issa].mean(axis=0)
        axes.plot(BANDS, mean, color=INK, linewidth=1.2, linestyle=":")
        axes.set(title=tissue.name, xlabel="wavelength [nm]", xlim=(400, 700))
    panels[0].set_ylabel("mean of fit − measured, reflectance")
    _band_legend(figure, colours, [("all of ISSA", ":")])
    return figure


def implied(study: Study) -> Figure:
    """Four skins by every method, and how RMS is distributed."""
    figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(1, 1.02))
    rms = {name: study.rmse(study.implied[name]) for name in METHODS if name in study.implied}
    first = next(iter(rms.values()))
    shown = [b for b in (0, 2, 3, 5) if (study.skins.bands == b).any()]
    for axes, band in zip(top.subplots(1, len(shown), squeeze=False)[0], shown, strict=True):
        of = np.flatnonzero((study.skins.bands == band) & study.issa)
        i = of[np.argsort(first[of])[len(of) // 2]]
        for name in list(rms)[::-1]:
            colour, line = METHODS[name]
            axes.plot(BANDS, study.implied[name][i], line, color=colour, linewidth=1.4)
        axes.plot(
            BANDS, study.skins.spectra[i], "o", markersize=4.2, markeredgewidth=0.4,
            color=np.clip(encode_srgb(study.skins.albedo[i]), 0, 1), markeredgecolor=INK,
        )  # fmt: skip
        axes.set(title=BAND_NAMES[band], xlim=(400, 700), ylim=(0, None), xticks=(400, 550, 700))
        axes.set_xlabel("wavelength [nm]")
    top.axes[0].set_ylabel("reflectance")
    axes = bottom.subplots()
    for name, values in rms.items():
        colour, line = METHODS[name]
        some = np.sort(values[study.issa])
        share = np.linspace(0, 1, len(some))
        axes.plot(some, 100 * share, line, color=colour, linewidth=1.8, label=name.replace("`", ""))
        axes.plot(np.median(some), 50, "o", color=colour, markersize=5)
        axes.plot(np.percentile(some, 95), 95, "o", color=colour, markersize=5)
    axes.set(xscale="log", xlim=(0.0015, 0.12), ylim=(0, 100), ylabel="skins below it [%]")
    ticks = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_xlabel(
        "RMS between the implied and the measured spectrum, 400–700 nm (dots: 50, 95 %)"
    )
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def coverage(study: Study) -> Figure:
    """What 90 % intervals hold, per band and origin, and other levels."""
    figure = Figure(figsize=(WIDTH, 5.8), layout="constrained")
    grid = figure.add_gridspec(2, 5)
    bands, level = np.unique(study.skins.bands), figure.add_subplot(grid[0, 3:])
    by_band, by_origin = figure.add_subplot(grid[0, :3]), figure.add_subplot(grid[1, :])
    inside = study.inside(study.held["subject"])
    counts = [((study.skins.bands == b) & study.issa).sum() for b in bands]
    _dots(by_band, [inside[(study.skins.bands == b) & study.issa] for b in bands])
    by_band.set_xticks(
        range(len(bands)), [f"{BAND_NAMES[b]}\n{n}" for b, n in zip(bands, counts, strict=True)]
    )
    by_band.set(title="subjects left out, by ITA° band", ylabel="inside the 90 % interval [%]")
    inside = study.inside(study.held["origin"])
    origins = np.unique(study.skins.origins)
    _dots(by_origin, [inside[study.skins.origins == o] for o in origins])
    by_origin.set_xticks(
        range(len(origins)),
        [f"{ORIGINS[int(o)]}\n{(study.skins.origins == o).sum()}" for o in origins],
    )
    by_origin.set(title="each origin left out", ylabel="inside the 90 % interval [%]")
    level.plot([40, 100], [40, 100], color="#b8b0a8", linewidth=1)
    for p, (known, colour) in enumerate(zip(PARAMETERS, PARAMETER_COLOURS, strict=True)):
        actual = [
            100 * study.inside(study.held["subject"], nominal)[study.issa, p].mean()
            for nominal in LEVELS
        ]
        level.plot(
            100 * np.array(LEVELS), actual, "o-", color=colour, markersize=4, label=known.name
        )
    level.set(title="other levels", xlabel="nominal [%]", ylabel="inside [%]")
    level.set(xlim=(45, 100), ylim=(45, 100))
    figure.legend(*level.get_legend_handles_labels(), loc="outside upper center", ncols=5)
    return figure


def fairness(study: Study) -> Figure:
    """Per band: closed loop, spectra, light, and what σ is of the range before."""
    figure, colours = Figure(figsize=(WIDTH, 5.2), layout="constrained"), band_colours(study)
    panels, bands = figure.subplots(2, 4), list(colours)
    spectra, held = study.implied[f"{LEARNED}, origins left out"], study.held["subject"]
    rows = {b: (study.skins.bands == b) & study.issa for b in bands}
    bars: list[tuple[str, str, Array]] = [
        ("closed loop", "median ΔE00", study.loop),
        ("RGB → spectrum", "median RMS", study.rmse(spectra)),
        ("relit by A", "median ΔE00", study.relit(spectra, "A")),
    ]
    bars += [
        (f"σ of {known.name}", "median, of the range", held.coordinate_sigma[:, i])
        for i, known in enumerate(PARAMETERS)
    ]
    for axes, (title, label, values) in zip(panels.ravel(), bars, strict=True):
        axes.bar(
            range(len(bands)), [np.median(values[rows[b]]) for b in bands], width=0.78,
            color=[colours[b] for b in bands], edgecolor=INK, linewidth=0.6,
        )  # fmt: skip
        axes.set(title=title, ylabel=label, xticks=[], ylim=(0, None))
        axes.grid(visible=False, axis="x")
        axes.ticklabel_format(axis="y", scilimits=(-3, 3))
    _band_legend(figure, colours)
    return figure


def _dots(axes: Axes, parts: Sequence[Array]) -> None:
    """Shares of five parameters side by side, over the strip of 90 ± 3 %."""
    axes.axhspan(87, 93, color="#e9efe3", zorder=0)
    axes.axhline(90, color="#a9bd98", linewidth=0.8)
    lowest = 70.0
    for x, part in enumerate(parts):
        for i, colour in enumerate(PARAMETER_COLOURS):
            share = 100 * part[:, i].mean()
            lowest = min(lowest, share - 3)
            axes.plot(x + 0.14 * (i - 2), share, "o", color=colour, markersize=6)
    axes.set(ylim=(lowest, 101), xlim=(-0.6, len(parts) - 0.4))
    axes.grid(visible=False, axis="x")


def _band_legend(
    figure: Figure, colours: dict[int, Array], others: Sequence[tuple[str, str]] = ()
) -> None:
    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor=INK, linewidth=0.6, label=BAND_NAMES[band])
        for band, colour in colours.items()
    ]
    for label, line in others:
        handles += figure.axes[0].plot([], [], line, color=INK, linewidth=1.2, label=label)
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))


PLOTS = {
    "fits": examples,
    "residuals": residuals,
    "spectra": implied,
    "coverage": coverage,
    "fairness": fairness,
}


def draw(study: Study, folder: Path) -> None:
    """Writes validation-NAME.png of every plot to `folder`."""
    import matplotlib as mpl

    for name, plot in PLOTS.items():
        with mpl.rc_context(STYLE):
            picture = io.BytesIO()
            plot(study).savefig(picture, dpi=100, facecolor="white")
        image = Image.open(picture).convert("RGB").quantize(256, dither=Image.Dither.NONE)
        image.save(folder / f"validation-{name}.png", optimize=True)
