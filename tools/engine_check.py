"""Rewrites the table of docs/engines.md: `python tools/engine_check.py`.

Patches of 34 skin tones under light from everywhere, in Cycles (square on, and as a ball, which
shows all views) and in Mitsuba: what comes back against the albedo asked for. Needs Blender
(`make blender`) and `pip install 'cutis[mitsuba]'`.
"""

import tempfile
from pathlib import Path

import numpy as np
from pages import rewrite
from rich.progress import Progress

from cutis.albedo import albedo_space
from cutis.render.cycles import INDEX, METHOD, base_colour, facing, radius
from cutis.render.cycles_process import render
from cutis.render.inversion import single_scattering_albedo
from cutis.render.medium import mean_free_path
from cutis.render.mitsuba_patch import patch_albedo
from cutis.render.scene import Scene
from cutis.textures import read_channels

MELANIN = (0.002, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
BLOOD = (0.002, 0.02, 0.08)
SEEDS = 4


def tones() -> dict[str, np.ndarray]:
    """Linear Rec.709 albedo of skins from very light to very dark, and of greys."""
    skins = [(m, b, 100.0, 0.7, 0.75) for m in MELANIN for b in BLOOD]
    rgb = albedo_space().rgb(np.array(skins))
    found = {
        f"melanin {m:g}, blood {b:g}": colour for (m, b, *_), colour in zip(skins, rgb, strict=True)
    }
    for grey in (0.9, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005):
        found[f"grey {grey:g}"] = np.full(3, grey)
    return found


def scenes(albedo: np.ndarray, mesh: str) -> list[Scene]:
    """The same picture with several seeds."""
    colour = base_colour(albedo)
    lengths = radius(colour, mean_free_path())
    return [
        Scene(
            mesh=mesh, light="furnace", specular=0.0, denoise=False, width=48, height=48,
            samples=64, seed=seed, transparent=True, method=METHOD, subsurface_ior=INDEX,
            base_colour=tuple(float(v) for v in colour), radius=tuple(float(v) for v in lengths),
            facing=facing(), device="cpu",
        )
        for seed in range(SEEDS)
    ]  # fmt: skip


def seen(path: Path) -> np.ndarray:
    """Mean light of what is not background."""
    channels, _ = read_channels(path)
    cover = channels["A"].mean()
    return np.array([channels[name].mean() for name in "RGB"]) / cover


def main() -> None:
    cast = tones()
    with tempfile.TemporaryDirectory() as name, Progress() as bar:
        folder = Path(name)
        jobs = {
            (tone, mesh, seed): (scene, folder / f"{i}-{mesh}-{seed}.exr")
            for i, (tone, albedo) in enumerate(cast.items())
            for mesh in ("patch", "sphere")
            for seed, scene in enumerate(scenes(albedo, mesh))
        }
        task = bar.add_task("Cycles", total=None)
        render(
            list(jobs.values()),
            progress=lambda done, total, _: bar.update(task, completed=done, total=total),
        )
        lines = [
            "| tone | asked | Cycles, square on | Cycles, all views | Mitsuba | z |",
            "|---|---|---|---|---|---|",
        ]
        worst = dict.fromkeys(("patch", "sphere", "mitsuba", "z"), 0.0)
        for i, (tone, albedo) in enumerate(cast.items()):
            cells = [tone, " ".join(f"{v:.4f}" for v in albedo)]
            for mesh in ("patch", "sphere"):
                each = np.stack([seen(jobs[tone, mesh, seed][1]) for seed in range(SEEDS)])
                off = each.mean(axis=0) / albedo - 1
                worst[mesh] = max(worst[mesh], float(np.abs(off).max()))
                cells.append(" ".join(f"{100 * v:+.2f}" for v in off))
            found = patch_albedo(single_scattering_albedo(albedo), samples=2048, seed=i)
            off, z = found.albedo / albedo - 1, (found.albedo - albedo) / found.error
            worst["mitsuba"] = max(worst["mitsuba"], float(np.abs(off).max()))
            worst["z"] = max(worst["z"], float(np.abs(z).max()))
            cells += [" ".join(f"{100 * v:+.2f}" for v in off), " ".join(f"{v:+.1f}" for v in z)]
            lines.append("| " + " | ".join(cells) + " |")
    lines.append(
        f"| largest | | {100 * worst['patch']:.2f} | {100 * worst['sphere']:.2f} | "
        f"{100 * worst['mitsuba']:.2f} | {worst['z']:.1f} |"
    )
    rewrite("engines.md", tones="\n".join(lines))


if __name__ == "__main__":
    main()
