"""Numbers of docs/decisions/0024: what rare chromophores do, and how well spectra tell them.

Run `python -m studies.rare_chromophores`; a minute.
"""

from unittest import mock

import numpy as np

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import build
from cutis.colour.difference import delta_e, lab
from cutis.inverse import fit_spectra
from cutis.optics import (
    MEASURED2026,
    PARAMETERS,
    RARE,
    TISSUES,
    WAVELENGTHS,
    Tissue,
    chromophores,
    skin,
    with_rare_chromophores,
)

NOISE, COUNT = 1e-3, 2000
PRESETS = {"bilirubin": 0.04, "carotene": 0.015, "methaemoglobin": 0.3}
LIGHT = {"melanin": 0.03, "blood": 0.015}
DARK = {"melanin": 0.2, "blood": 0.02}


def main() -> None:
    for tissue in TISSUES.values():
        print(f"{tissue.name}: 90 % intervals from 31 bands with noise {NOISE:g}, {COUNT} skins")
        coverage(tissue)
        colours(tissue)
    extension()


def coverage(tissue: Tissue) -> None:
    """Share of truths inside the fit's intervals and median σ, each freed alone and all at once."""
    rng = np.random.default_rng(0)
    low = [0.01, 0.01, 50, 0.3, 0.3, 0, 0, 0]
    high = [0.08, 0.05, 120, 0.9, 0.9, 0.06, 0.02, 0.4]
    space = albedo_space(with_rare_chromophores(tissue))
    names = [p.name for p in RARE]
    for free in (*([name] for name in names), names):
        skins = rng.uniform(low, high, (COUNT, 8))
        for i, name in enumerate(names):
            if name not in free:
                skins[:, 5 + i] = 0
        spectra = space.reflectance(skins)[:, 2:33]
        spectra = spectra + rng.normal(0, NOISE, spectra.shape)
        found = fit_spectra(spectra, WAVELENGTHS[2:33], tissue, free=free, noise=NOISE)
        truth = skins[:, 5:][:, [name in free for name in names]]
        inside = np.abs(found.values[:, 5:] - truth) < 1.645 * found.sigma[:, 5:]
        for name, share, sigma in zip(
            free, inside.mean(axis=0), np.median(found.sigma[:, 5:], axis=0), strict=True
        ):
            print(f"  {'+'.join(free)}: {name} inside {100 * share:.1f} %, median σ {sigma:.4f}")


def colours(tissue: Tissue) -> None:
    """CIELAB of a light and a dark skin, and by how much presets move it."""
    space = albedo_space(with_rare_chromophores(tissue))
    for word, some in (("light", LIGHT), ("dark", DARK)):
        plain = space.rgb(skin(some, (*PARAMETERS, *RARE)))[None]
        for name, value in PRESETS.items():
            ill = space.rgb(skin({**some, name: value}, (*PARAMETERS, *RARE)))[None]
            moved = ", ".join(f"{v:+.1f}" for v in (lab(ill) - lab(plain))[0])
            apart = delta_e(ill, plain)[0]
            print(f"  {word}, {name} {value:g}: ΔL* Δa* Δb* {moved}; ΔE00 {apart:.1f}")


def extension() -> None:
    """What the extension of methaemoglobin below 450 nm changes, against holding its end."""
    rare = with_rare_chromophores(MEASURED2026)
    x = skin({**LIGHT, "methaemoglobin": 0.3}, (*PARAMETERS, *RARE))
    ours = albedo_space(rare)
    as_it_is = chromophores.methemoglobin

    def held(wavelength: object, concentration: float = 150.0) -> object:
        return as_it_is(np.maximum(wavelength, 450.0), concentration)

    with mock.patch.object(chromophores, "methemoglobin", held):
        other = AlbedoSpace(build(rare))
    gap = np.abs(ours.reflectance(x) - other.reflectance(x))
    colour = delta_e(ours.rgb(x)[None], other.rgb(x)[None])[0]
    print(
        f"held at 450 nm instead: reflectance of a light skin with 0.3 changes by at most "
        f"{gap.max():.4f} at {WAVELENGTHS[gap.argmax()]:g} nm, its colour by {colour:.2f} ΔE00"
    )


if __name__ == "__main__":
    main()
