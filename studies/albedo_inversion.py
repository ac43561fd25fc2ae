"""Rewrites the table and the plot of docs/subsurface.md: `python -m studies.albedo_inversion`.

How far published fits of single-scattering albedo are from the exact inversion, as what a random
walk with their value returns.
"""

import numpy as np
from matplotlib.figure import Figure

from cutis.render.inversion import diffuse_albedo, single_scattering_albedo
from cutis.render.published_fits import chiang2016, kulla_conty2017, wrenninge2017
from studies.generated import record
from studies.pages import DOCS, rewrite

ALBEDO = np.linspace(0.01, 0.95, 189)
FITS = {
    "Kulla and Conty 2017": kulla_conty2017,
    "Chiang et al. 2016": lambda albedo, g: chiang2016(albedo),
    "Wrenninge et al. 2017": wrenninge2017,
}


def main() -> None:
    lines = [
        "| fit | g | worst α | worst A | rms A | worst A, relative |",
        "|---|---|---|---|---|---|",
    ]
    figure = Figure(figsize=(6.4, 3.6), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    for name, fit in FITS.items():
        for g in (0.0, 0.3, 0.6, 0.8) if fit is not FITS["Chiang et al. 2016"] else (0.0,):
            alpha = np.clip(fit(ALBEDO, g), 0, 1)
            off = diffuse_albedo(alpha, g) - ALBEDO
            exact = single_scattering_albedo(ALBEDO, g)
            lines.append(
                f"| {name} | {g:g} | {np.abs(alpha - exact).max():.4f} | {np.abs(off).max():.4f} | "
                f"{np.sqrt((off**2).mean()):.4f} | {100 * np.abs(off / ALBEDO).max():.1f} % |"
            )
            if g in (0.0, 0.8):
                axes.plot(ALBEDO, off, "--" if g else "-", label=f"{name}, g = {g:g}")
    axes.axhline(0, color="0.5", linewidth=0.8)
    axes.set(xlabel="diffuse albedo asked for", ylabel="returned − asked for", xlim=(0, 1))
    axes.legend(fontsize=7, frameon=False)
    target = DOCS / "images" / "subsurface.png"
    figure.savefig(target)
    record(target)
    print(f"wrote docs/images/{target.name}")
    rewrite("subsurface.md", fits="\n".join(lines))


if __name__ == "__main__":
    main()
