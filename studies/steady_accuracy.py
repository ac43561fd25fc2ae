"""Rewrites tables of docs/models.md on steady maps: run `python -m studies.steady_accuracy`.

On the bundled capture and on the dark faces of the shared data: roughness of maps, detail that is
kept, low-passed maps, the closed loop, and noise of edits, each with neighbours and without.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import track
from scipy.ndimage import binary_erosion, gaussian_filter, uniform_filter

from cutis import estimate, read, read_mask
from cutis.colour import delta_e, is_skin_colour, lab
from cutis.inverse.shipped import MEASURED, VARYING
from cutis.maps import SkinMaps
from cutis.optics import NAMES, PARAMETERS, to_coordinates
from studies.figures.section import table
from studies.figures.subjects import data_folder
from studies.pages import rewrite

Array = np.ndarray
ROOT = Path(__file__).parents[1]
FACES = ("bioskin_capture1", "makehuman_young_dark_male_head", "reom_dark_face")
RUNS = ((MEASURED, False), (MEASURED, True), (VARYING, False), (VARYING, True))
FINE = 1.5
"""Texels: noise of an edit is what a Gaussian so wide takes away."""
CUT = 6.0
"""The same for detail: half the power is above 1/16 of the highest frequency."""
LOW = 32
"""Texels that low-passed maps are means over."""
ERODED = 4
EDITS = {
    "melanin × 0.5": ("melanin", "×", 0.5), "melanin × 3": ("melanin", "×", 3.0),
    "blood × 0.125": ("blood", "×", 0.125), "blood × 3": ("blood", "×", 3.0),
    "thinnest": ("thickness", "=", 10.0), "thickest": ("thickness", "=", 250.0),
    "type 0": ("eumelanin", "=", 0.001), "type 1": ("eumelanin", "=", 1.0),
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Face:
    """A face as captured, and where on it numbers are taken."""

    name: str
    rgb: Array
    mask: Array
    eight_bit: object

    def run(self, model: str, steady: bool) -> SkinMaps:
        """Its maps."""
        return estimate(
            self.eight_bit, self.mask, white="auto", model=model, steady=steady, sigma=False
        )


def faces() -> list[Face]:
    """The bundled capture and the dark faces at hand."""
    data, found = data_folder(None), []
    for name in FACES:
        folders = [ROOT / "examples", *([] if data is None else [data / "albedo"])]
        paths = [path for folder in folders for path in folder.glob(f"{name}.*g")]
        if not paths:
            print(f"{name} is not at hand")
            continue
        texture, mask = read(paths[0]), np.ones(0)
        cover = paths[0].with_name(f"{name}_mask.jpg")
        if name.startswith("makehuman"):
            cover = paths[0].with_name("makehuman_head_mask.png")
        mask = read_mask(cover, texture.shape) if cover.is_file() else np.ones(texture.shape)
        found.append(Face(name, texture.linear(), mask.astype(np.float32), texture))
    return found


def high(values: Array, inside: Array, width: float) -> Array:
    """What a Gaussian over the texels inside takes away, (H, W)."""
    cover = inside.astype(np.float64)
    low = gaussian_filter(values * cover, width) / np.maximum(gaussian_filter(cover, width), 1e-6)
    return values - low


def noise(rgb: Array, inside: Array, judged: Array) -> tuple[float, float]:
    """RMS of lightness and of chroma above FINE texels."""
    values = lab(np.maximum(rgb, 0)).astype(np.float64)
    light, a, b = (high(values[..., i], inside, FINE)[judged] for i in range(3))
    return float(np.sqrt((light**2).mean())), float(np.sqrt((a**2 + b**2).mean()))


def edited(skin: SkinMaps, name: str, how: str, amount: float) -> Array:
    """The albedo with an edit, capture included."""
    if how == "×":
        return skin.multiply(**{name: amount}).albedo()
    return skin.replace(**{name: amount}).albedo()


@dataclass(frozen=True, eq=False)
class Judged:
    """What is told of one run."""

    rough: dict[str, float]
    loop: tuple[float, float]
    power: tuple[float, float]
    low: Array
    noise: dict[str, tuple[float, float]]


def judge(face: Face, skin: SkinMaps) -> Judged:
    """All numbers of maps of a face."""
    colours = skin.calibration.apply(face.rgb)
    inside = face.mask > 0
    skin_coloured = inside & is_skin_colour(colours)
    texels = skin_coloured if skin_coloured.mean() > 0.3 * inside.mean() else inside
    inner = binary_erosion(texels, iterations=ERODED)
    u = to_coordinates(skin.parameters()).astype(np.float64)
    sums, base = np.zeros(5), 0.0
    for axis in (0, 1):
        first, second = (np.s_[:-1], np.s_[1:]) if axis == 0 else (np.s_[:, :-1], np.s_[:, 1:])
        both = texels[first] & texels[second]
        sums += np.abs(np.diff(u, axis=axis))[both].sum(axis=0)
        base += float(np.abs(np.diff(face.rgb, axis=axis))[both].mean(axis=1).sum())
    wrong = delta_e(skin.model.decode(skin.parameters()[texels]), colours[texels])
    power = tuple(float((high(u[..., i], texels, CUT)[inner] ** 2).mean()) for i in (0, 1))
    cover = inside.astype(np.float64)
    mean = np.maximum(uniform_filter(cover, LOW), 1e-6)
    low = np.stack([(uniform_filter(u[..., i] * cover, LOW) / mean)[texels] for i in (2, 3, 4)])
    before = noise(face.rgb, texels, inner)
    found = {}
    for label, (name, how, amount) in EDITS.items():
        after = noise(edited(skin, name, how, amount), texels, inner)
        found[label] = (after[0] / before[0], after[1] / before[1])
    return Judged(
        dict(zip(NAMES, sums / base, strict=True)),
        (float(wrong.mean()), float(np.percentile(wrong, 95))),
        (power[0], power[1]), low, found,
    )  # fmt: skip


def main() -> None:
    rough, kept, edits = [], [], []
    for face in track(faces(), "faces"):
        found = {run: judge(face, face.run(*run)) for run in RUNS}
        for (model, steady), one in found.items():
            head = [face.name, f"`{model}`", "on" if steady else "off"]
            rough.append([*head, *(f"{one.rough[name]:.2f}" for name in NAMES)])
            alone = found[model, False]
            detail = [f"{a / b:.3f}" for a, b in zip(one.power, alone.power, strict=True)]
            low = [
                f"{np.corrcoef(a, b)[0, 1]:.3f}" for a, b in zip(one.low, alone.low, strict=True)
            ]
            kept.append([*head, f"{one.loop[0]:.3f}", f"{one.loop[1]:.3f}", *detail, *low])
            edits.append([*head, *(f"{light:.2f}" for light, _ in one.noise.values())])
    head = ["face", "model", "steady"]
    weak = [PARAMETERS[i].name for i in (2, 3, 4)]
    rewrite(
        "models.md",
        steady_rough=table([*head, *NAMES], rough),
        steady_kept=table(
            [*head, "ΔE00 mean", "p95", "melanin kept", "blood kept", *(f"low {w}" for w in weak)],
            kept,
        ),
        steady_edits=table([*head, *EDITS], edits),
    )


if __name__ == "__main__":
    main()
