"""Rewrites the tables of docs/albedo.md: run `python -m studies.albedo_accuracy`."""

import os
import time

import numpy as np
from rich.progress import track

from cutis.albedo import albedo_space, uniform
from cutis.albedo.colour_table import colour_table
from cutis.colour import delta_e
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, TISSUES, WAVELENGTHS, from_coordinates
from cutis.transport import two_layer_albedo
from studies.figures.subjects import data_folder, every_face
from studies.pages import rewrite

BLOCKS, SIZE = 6, 6
PAIRS = 600_000
INVERSES = {"aliaga2022": "aliaga2022-exact", "measured2026": "measured2026"}
"""Models that find the skins of textures, by tissue."""
RANDOM, TEXELS = 500_000, 40_000
"""Uniformly random skins, and texels of each texture, that the colour table is tried on."""


def errors(band: int, rng: np.random.Generator) -> np.ndarray:
    """Table minus solver (48 directions) at random skins, some of them at ends of the range."""
    space, lam = albedo_space(ALIAGA2022), WAVELENGTHS[band : band + 1]
    found = []
    for _ in range(BLOCKS):
        u = rng.random((SIZE, 5))
        u[0] = u[0].round()
        skins = from_coordinates(u)
        exact = two_layer_albedo(
            ALIAGA2022.epidermis_absorption(skins[:, 0], skins[:, 3], lam)[:, 0],
            ALIAGA2022.dermis_absorption(skins[:, 1], skins[:, 4], lam)[:, 0],
            skins[:, 2],
            float(ALIAGA2022.scattering(lam)[0]),
            float(ALIAGA2022.anisotropy(lam)[0]),
            count=48,
        )
        e, d, t = np.meshgrid(*[np.arange(SIZE)] * 3, indexing="ij")
        columns = (skins[e, 0], skins[d, 1], skins[t, 2], skins[e, 3], skins[d, 4])
        found.append(space.reflectance(np.stack(columns, -1))[..., band] - exact)
    return np.concatenate([x.ravel() for x in found])


def accuracy() -> str:
    rng = np.random.default_rng(0)
    lines = ["| λ, nm | worst error | rms error |", "|---|---|---|"]
    everything = []
    for band in track(range(len(WAVELENGTHS)), "accuracy"):
        error = errors(band, rng)
        everything.append(error)
        if band % 4 == 0:
            lines.append(
                f"| {WAVELENGTHS[band]:.0f} | {np.abs(error).max():.1e} "
                f"| {np.sqrt(np.mean(error**2)):.1e} |"
            )
    error = np.concatenate(everything)
    lines.append(
        f"| all 41, {error.size} albedos | {np.abs(error).max():.1e} "
        f"| {np.sqrt(np.mean(error**2)):.1e} |"
    )
    return "\n".join(lines)


def timing() -> str:
    space, skins = albedo_space(ALIAGA2022), uniform(PAIRS).astype(np.float32)
    lines = [
        f"| {PAIRS:,} skins on {os.cpu_count()} cores | seconds |".replace(",", " "),
        "|---|---|",
    ]
    for name, call in (
        ("reflectance, 41 bands", space.reflectance),
        ("linear sRGB", space.rgb),
        ("linear sRGB by the colour table", colour_table(ALIAGA2022).rgb),
        ("linear sRGB and its 15 slopes", space.rgb_gradient),
    ):
        call(skins[:10])  # compiles
        best = np.inf
        for _ in range(7):
            start = time.perf_counter()
            call(skins)
            best = min(best, time.perf_counter() - start)
        lines.append(f"| {name} | {best:.3f} |")
    return "\n".join(lines)


def decoder() -> str:
    """The colour table against the exact space, on the skins that the models find."""
    lines = [
        "| tissue | skins of | worst RGB | ΔE00 mean | p99 | worst |",
        "|---|---|---|---|---|---|",
    ]
    random = f"{RANDOM // 1000} 000 uniformly random", uniform(RANDOM, seed=1)
    faces = list(every_face(data_folder(None), TEXELS))
    sets = [
        (tissue, *named)
        for tissue in TISSUES.values()
        for named in (
            random,
            *((name, load_model(INVERSES[tissue.name]).encode(rgb)) for name, rgb in faces),
        )
    ]
    for tissue, name, skins in sets:
        exact, table = albedo_space(tissue).rgb(skins), colour_table(tissue).rgb(skins)
        error = delta_e(exact, table)
        lines.append(
            f"| {tissue.name} | {name} | {np.abs(exact - table).max():.1e} | {error.mean():.4f} "
            f"| {np.percentile(error, 99):.4f} | {error.max():.4f} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    rewrite("albedo.md", accuracy=accuracy(), decoder=decoder(), timing=timing())
