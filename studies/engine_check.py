"""Rewrites the table of docs/engines.md: `python -m studies.engine_check`.

Patches of skin tones under light from everywhere, in Cycles (square on, and as a ball, which shows
all views) and in Mitsuba: what comes back against the albedo asked for, and whether it is shown to
be within 1 % of it. Needs Blender (`make setup-render`) and `pip install 'cutis[mitsuba]'`; the
Monk tones are read from the shared data (CUTIS_SHARED_DATA), and left out where it is absent.
"""

import csv
import os
import tempfile
from pathlib import Path

import numpy as np
from rich.progress import Progress
from scipy.stats import norm
from scipy.stats import t as student

from cutis.albedo import albedo_space
from cutis.colour.transfer import decode_srgb
from cutis.optics import ALIAGA2022
from cutis.render.cycles import INDEX, METHOD, base_colour, facing, radius
from cutis.render.cycles_process import render
from cutis.render.inversion import single_scattering_albedo
from cutis.render.medium import mean_free_path
from cutis.render.mitsuba_patch import patch_albedo
from cutis.render.scene import Scene
from cutis.textures import read_channels
from studies.pages import rewrite

MELANIN = (0.002, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
BLOOD = (0.002, 0.02, 0.08)
GREYS = (0.9, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.04, 0.03, 0.02, 0.01, 0.005)
SEEDS = 32
"""Pictures of a tone in Cycles. Errors are from how they differ: pixels of one picture may
share random numbers."""
WITHIN = 0.01
LEVEL = 1e-3
"""Chance that any of the tones is wrongly said to be within it; fixed before the first run."""
MONK = "albedo/monk_skin_tone.csv"


def tones() -> dict[str, np.ndarray]:
    """Linear Rec.709 albedo of skins from very light to very dark, and of greys."""
    skins = [(m, b, 100.0, 0.7, 0.75) for m in MELANIN for b in BLOOD]
    rgb = albedo_space(ALIAGA2022).rgb(np.array(skins))
    found = {
        f"melanin {m:g}, blood {b:g}": colour for (m, b, *_), colour in zip(skins, rgb, strict=True)
    }
    for name, colour in monk().items():
        found[name] = colour
    for grey in GREYS:
        found[f"grey {grey:g}"] = np.full(3, grey)
    return found


def monk() -> dict[str, np.ndarray]:
    """The ten tones of the Monk scale, display colours for annotation."""
    default = Path(__file__).parents[2] / "shared" / "data"
    path = Path(os.environ.get("CUTIS_SHARED_DATA") or default) / MONK
    if not path.is_file():
        return {}
    lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    return {
        f"Monk {row['level']}": decode_srgb(np.array([*bytes.fromhex(row["hex"])]) / 255)
        for row in csv.DictReader(lines)
    }


def dark(albedo: np.ndarray) -> bool:
    """Whether noise, relative to it, asks for more samples."""
    return bool(albedo.min() < 0.12)


def scenes(albedo: np.ndarray, mesh: str) -> list[Scene]:
    """The same picture with several seeds."""
    colour = base_colour(albedo)
    lengths = radius(colour, mean_free_path(ALIAGA2022))
    samples = 256 if mesh == "patch" and dark(albedo) else 64
    return [
        Scene(
            mesh=mesh, light="furnace", specular=0.0, denoise=False, width=32, height=32,
            samples=samples, seed=seed, transparent=True, method=METHOD, subsurface_ior=INDEX,
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


class Row:
    """One tone: deviations and standard errors, relative, and degrees of freedom of each check."""

    def __init__(self, tone: str, asked: np.ndarray) -> None:
        self.tone, self.asked = tone, asked
        self.checks: list[tuple[np.ndarray, np.ndarray, int | None]] = []

    def add(self, mean: np.ndarray, error: np.ndarray, freedom: int | None) -> None:
        self.checks.append((mean / self.asked - 1, error / self.asked, freedom))


def table(rows: list[Row]) -> str:
    """The page's table: per cent, and in bold what is not shown to be within 1 %."""
    lines = [
        "| tone | asked | Cycles, square on | ± | Cycles, all views | ± | Mitsuba | ± | z |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    level = LEVEL / (3 * len(rows))  # of one channel of one tone, in each of the three columns
    worst, shown = [0.0] * 3, [0] * 3
    for row in rows:
        cells = [row.tone, " ".join(f"{v:.4f}" for v in row.asked)]
        for column, (off, error, freedom) in enumerate(row.checks):
            bound = norm.isf(level) if freedom is None else student.isf(level, freedom)
            good = np.abs(off) + bound * error < WITHIN
            worst[column] = max(worst[column], float(np.abs(off).max()))
            shown[column] += int(good.sum())
            each = [
                f"{100 * v:+.2f}" if ok else f"**{100 * v:+.2f}**"
                for v, ok in zip(off, good, strict=True)
            ]
            cells += [" ".join(each), f"{100 * error.max():.2f}"]
        off, error, _ = row.checks[-1]
        cells.append(" ".join(f"{v:+.1f}" for v in off / error))
        lines.append("| " + " | ".join(cells) + " |")
    total = 3 * len(rows)
    z = max(float(np.abs(row.checks[-1][0] / row.checks[-1][1]).max()) for row in rows)
    largest = " | ".join(f"{100 * value:.2f} |" for value in worst)
    counts = " | ".join(f"{count} of {total} |" for count in shown)
    return "\n".join([*lines, f"| largest | | {largest} | {z:.1f} |", f"| shown | | {counts} | |"])


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
        rows = {tone: Row(tone, albedo) for tone, albedo in cast.items()}
        for i, (tone, albedo) in enumerate(cast.items()):
            for mesh in ("patch", "sphere"):
                each = np.stack([seen(jobs[tone, mesh, seed][1]) for seed in range(SEEDS)])
                error = each.std(axis=0, ddof=1) / np.sqrt(SEEDS)
                rows[tone].add(each.mean(axis=0), error, SEEDS - 1)
            bar.console.print(f"Mitsuba: {tone}")
            found = patch_albedo(
                single_scattering_albedo(albedo), seed=i, samples=4096 if dark(albedo) else 2048
            )
            rows[tone].add(found.albedo, found.error, None)
    rewrite("engines.md", tones=table(list(rows.values())))


if __name__ == "__main__":
    main()
