"""Rewrites the Kubelka–Munk tables of docs/models.md: `python -m studies.kubelka_munk_accuracy`.

Two free parameters, by every variant of the two-flux skin and by the exact transport that the
exact inverse has, on faces and on measured skins. Needs the larger data beside the project, or its
folder as the only argument.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.progress import track

from cutis import estimate, read, read_mask
from cutis.albedo import albedo_space
from cutis.albedo.kubelka_munk import EPIDERMES, KubelkaMunkSkin
from cutis.colour import delta_e, is_skin_colour, reflectance_to_rgb
from cutis.inverse.kubelka_munk import KubelkaMunkInverse
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates
from cutis.transport import Layer, stack_balance
from studies.figures.measured import BANDS, measured_skins
from studies.figures.subjects import data_folder
from studies.pages import rewrite

FACES = ("bioskin_capture1.jpg", "leeperrysmith_color.jpg", "reom_light_face.jpg",
         "makehuman_middleage_dark_male_head.png", "reom_dark_face.jpg")  # fmt: skip
MELANIN = (0.005, 0.02, 0.05, 0.15, 0.4)
BLOOD = 0.02


@dataclass(frozen=True)
class ExactSkin(KubelkaMunkSkin):
    """The same two parameters through the exact albedo space of the tissue."""

    def reflectance(self, melanin: ArrayLike, blood: ArrayLike) -> NDArray[np.float64]:
        held = (self.thickness, self.eumelanin, self.oxygenation)
        skins = np.stack(np.broadcast_arrays(melanin, blood, *held), axis=-1)
        return albedo_space(self.tissue).reflectance(skins).astype(np.float64)


WHOLE = {"melanin": (0.001, 1.0), "blood": (0.001, 1.0)}
VARIANTS = {
    "`kubelka-munk`": KubelkaMunkSkin(ALIAGA2022),
    "the same, star1988": KubelkaMunkSkin(ALIAGA2022, conversion="star1988"),
    "the same, plain": KubelkaMunkSkin(ALIAGA2022, conversion="plain"),
    "the same, whole ranges": KubelkaMunkSkin(ALIAGA2022, **WHOLE),
    "the same, epidermis of 80 µm": KubelkaMunkSkin(ALIAGA2022, thickness=80.0),
    "epidermis of two fluxes": KubelkaMunkSkin(ALIAGA2022, epidermis="scattering"),
    "the same, 80 µm": KubelkaMunkSkin(ALIAGA2022, epidermis="scattering", thickness=80.0),
    "exact transport, two parameters": ExactSkin(ALIAGA2022, **WHOLE),
    "the same, 80 µm ": ExactSkin(ALIAGA2022, thickness=80.0, **WHOLE),
}
ON_FACES = ("`kubelka-munk`", "epidermis of two fluxes", "exact transport, two parameters")


def errors(model: np.ndarray, truth: np.ndarray) -> str:
    distance = delta_e(model, truth)
    mse = np.mean((model - truth) ** 2, dtype=np.float64)
    return f"{mse:.1e} | {distance.mean():.2f} | {np.percentile(distance, 95):.2f}"


def reconstructed(skin: KubelkaMunkSkin, colours: np.ndarray) -> np.ndarray:
    inverse = KubelkaMunkInverse(skin)
    return inverse.decode(from_coordinates(inverse.encode(colours)))


def faces(data: Path) -> str:
    """Skin texels of each face, with and without the gains of --white auto."""
    rows = ["| texture | gains | model | MSE | ΔE00 mean | p95 |", "|---|---|---|---|---|---|"]
    for name in track(FACES, "faces"):
        path = data / "albedo" / name
        if name.startswith("makehuman"):
            mask = path.with_name("makehuman_head_mask.png")
        else:
            mask = path.with_name(f"{path.stem}_mask{path.suffix}")
        face = read(path)
        cover = read_mask(mask, face.shape) if mask.is_file() else None
        for white in ("auto", "none"):
            skin = estimate(face, cover, white=white)
            colours = skin.calibration.apply(face.linear()[skin.mask > 0])
            colours = colours[is_skin_colour(colours)]
            gains = " ".join(f"{g:.2f}" for g in skin.calibration.gains)
            start = f"| {path.stem} | {gains if white == 'auto' else 'none'} "
            for label in ON_FACES:
                found = errors(reconstructed(VARIANTS[label], colours), colours)
                rows.append(f"{start}| {label} | {found} |")
    return "\n".join(rows)


def measured(data: Path) -> str:
    """Every variant on measured skins, under D65."""
    colours = reflectance_to_rgb(measured_skins(data), BANDS).astype(np.float32)
    rows = [
        f"| model, on {len(colours)} measured skins | free | MSE | ΔE00 mean | p95 |",
        "|---|---|---|---|---|",
    ]
    for label, skin in track(VARIANTS.items(), "measured skins"):
        rows.append(f"| {label.strip()} | 2 | {errors(reconstructed(skin, colours), colours)} |")
    exact = load_model("aliaga2022-exact")
    rows.append(f"| `{exact.name}` | 5 | {errors(exact.decode(exact.encode(colours)), colours)} |")
    return "\n".join(rows)


def transport() -> str:
    """Either epidermis against the exact solver in space, at the same parameters."""
    rows = [
        "| melanin | " + " | ".join(f"{e}, 200 µm | {e}, 80 µm" for e in EPIDERMES) + " |",
        "|---|---|---|---|---|",
    ]
    for melanin in MELANIN:
        cells = []
        for epidermis in EPIDERMES:
            for thickness in (200.0, 80.0):
                skin = KubelkaMunkSkin(ALIAGA2022, epidermis=epidermis, thickness=thickness)
                exact = reflectance_to_rgb(solved(skin, melanin), WAVELENGTHS)
                cells.append(f"{delta_e(skin.rgb(melanin, BLOOD), exact):.1f}")
        rows.append(f"| {melanin:g} | {' | '.join(cells)} |")
    return "\n".join(rows)


def solved(skin: KubelkaMunkSkin, melanin: float) -> np.ndarray:
    """(41,) of the same layers by the exact solver, 3-D."""
    tissue = skin.tissue
    above = tissue.epidermis_absorption(melanin, skin.eumelanin, WAVELENGTHS)
    below = tissue.dermis_absorption(BLOOD, skin.oxygenation, WAVELENGTHS)
    scattering, g = tissue.scattering(WAVELENGTHS), tissue.anisotropy(WAVELENGTHS)
    depth = skin.thickness * 1e-4
    return np.array(
        [
            stack_balance([Layer(a, s, h, depth), Layer(b, s, h)], dimension=3).reflected
            for a, b, s, h in zip(above, below, scattering, g, strict=True)
        ]
    )


def main() -> None:
    data = data_folder(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder")
    tables = {
        "kubelka-transport": transport(),
        "kubelka-measured": measured(data),
        "kubelka-faces": faces(data),
    }
    rewrite("models.md", **tables)


if __name__ == "__main__":
    main()
