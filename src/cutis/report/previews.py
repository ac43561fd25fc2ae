"""Pictures of maps for people: colour-mapped PNG with a scale bar.

Previews are for the eye; the numbers are in the EXR.
"""

import contextlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse import Calibration
from cutis.maps import MapsFile, SkinMaps, find_source, open_source
from cutis.maps.trust import CONFIDENCE, LOW, SIGMA
from cutis.optics import PARAMETERS, Parameter
from cutis.report.appearance import COLOUR_MAPS
from cutis.textures import replacing

LONGEST = 900
"""Texels of the longer side of a preview."""


def reduced(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Every n-th texel, so that the longer side is at most LONGEST."""
    step = _step(values.shape[:2])
    return values[::step, ::step]


def _step(shape: tuple[int, ...]) -> int:
    return max(1, -(-max(shape) // LONGEST))


class Previews:
    """Pictures of an estimate of (H, W) texels in the making: `add` its rows from the top."""

    def __init__(self, calibration: Calibration, shape: tuple[int, int]) -> None:
        self._calibration = calibration
        self._step = _step(shape)
        self._parts: dict[str, list[NDArray[np.float32]]] = {}
        self._whole: dict[str, NDArray[np.float32]] | None = None

    def add(self, skin: SkinMaps) -> None:
        """The next rows."""
        rows = slice(-skin.maps.whole.first_row % self._step, None, self._step)
        for name, values in self._seen(skin).items():
            self._parts.setdefault(name, []).append(values[rows, :: self._step].copy())

    def _seen(self, skin: SkinMaps) -> dict[str, NDArray[np.float32]]:
        found = {known.name: getattr(skin, known.name) for known in PARAMETERS}
        found |= {"mask": skin.mask, "model": skin.model_albedo}
        found |= {name + SIGMA: sigma for name, sigma in skin.sigmas.items()}
        if skin.confidence is not None:
            found[CONFIDENCE] = skin.confidence
        if skin.source is not None:
            found["capture"] = skin.source
        return found

    def pictures(self) -> dict[str, NDArray[np.float32]]:
        """Reduced pictures by name, NaN off the mask.

        `capture` and `model` (h, w, 3) in linear sRGB, `error` (h, w) in ΔE00, the maps (h, w) and,
        where the model knows them, `<map>.sigma` and `confidence` (h, w).
        """
        if self._whole is None:
            whole = {name: np.concatenate(parts) for name, parts in self._parts.items()}
            outside = whole.pop("mask") <= 0
            if "capture" in whole:
                how = self._calibration.apply
                whole["error"] = delta_e(how(whole["model"]), how(whole["capture"]))
            for name in whole.keys() - {"model", "capture"}:
                whole[name] = np.where(outside, np.float32(np.nan), whole[name])
            self._whole = whole
        return self._whole

    def write(self, stem: Path) -> list[Path]:
        """Writes `stem`.<map>.png for the five maps and, with the capture, `stem`.error.png.

        Where the model knows them, `stem`.sigma.png shows σ of all maps side by side, and
        `stem`.confidence.png how likely each colour is one of skin. Returns what it wrote.
        """
        pictures, written = self.pictures(), []
        for known in PARAMETERS:
            values = pictures[known.name]
            low, high = known.low, known.high
            if np.isfinite(values).any():
                low, high = (float(v) for v in np.nanpercentile(values, [1, 99]))
            unit = "" if known.unit == "1" else f" [{known.unit}]"
            label, colours = f"{known.meaning}{unit}", COLOUR_MAPS[known.name]
            path = Path(f"{stem}.{known.name}.png")
            written.append(path)
            _figure(path, values, label, colours, (low, high), known.root)
        if "error" in pictures:
            label = "model against capture [ΔE00]"
            written.append(Path(f"{stem}.error.png"))
            _figure(written[-1], pictures["error"], label, "magma", (0.0, 2.0))
        if CONFIDENCE in pictures:
            label, values = "confidence that the colour is one of skin", pictures[CONFIDENCE]
            written.append(Path(f"{stem}.confidence.png"))
            _figure(written[-1], values, label, "viridis", (0.0, 1.0))
        sigmas = [known for known in PARAMETERS if known.name + SIGMA in pictures]
        if sigmas:
            written.append(Path(f"{stem}.sigma.png"))
            _sheet(written[-1], sigmas, pictures)
        return written


def previews_of(maps: Path) -> dict[str, NDArray[np.float32]]:
    """Reduced pictures of a file of maps, with its capture where that is at hand."""
    with contextlib.ExitStack() as stack:
        file = stack.enter_context(MapsFile(maps))
        capture = None
        with contextlib.suppress(CutisError):
            source = find_source(file.provenance, maps)
            capture = stack.enter_context(open_source(file.provenance, source))
        previews = Previews(file.header.calibration, file.shape)
        for rows in file.bands():
            skin = file.rows(rows)
            if capture is not None:
                skin = skin.with_capture(capture.rows(rows).linear())
            previews.add(skin)
    return previews.pictures()


def _sheet(
    path: Path, sigmas: Sequence[Parameter], pictures: Mapping[str, NDArray[np.float32]]
) -> None:
    """σ of the maps in a row, each with its scale below, from 0 to what 95 % stay below.

    Of texels that are likely skin, where there are some: what little is known of hair and edges
    would leave skin blank.
    """
    from matplotlib.figure import Figure

    height, width = pictures[sigmas[0].name + SIGMA].shape
    cell = min(4.0, 4.0 * width / height)
    figure = Figure(figsize=(len(sigmas) * cell, cell * height / width + 0.9), dpi=100)
    rows = figure.subplots(1, len(sigmas), squeeze=False)[0]
    confidence = pictures.get(CONFIDENCE)
    sure = np.bool_(True) if confidence is None else confidence >= LOW
    sure = sure if np.any(sure) else np.bool_(True)
    for axes, known in zip(rows, sigmas, strict=True):
        values = pictures[known.name + SIGMA]
        seen = values[np.isfinite(values) & sure]
        high = float(np.percentile(seen, 95)) if seen.size else 1.0
        step = max(1, values.shape[1] // 400)
        shown = axes.imshow(
            values[::step, ::step], cmap=COLOUR_MAPS[known.name], vmin=0, vmax=max(high, 1e-9),
            interpolation="nearest",
        )  # fmt: skip
        axes.set_axis_off()
        unit = "" if known.unit == "1" else f" [{known.unit}]"
        figure.colorbar(
            shown, ax=axes, orientation="horizontal", label=f"σ of {known.name}{unit}", pad=0.03
        )
    with replacing(path) as partial:
        figure.savefig(partial, facecolor="white", bbox_inches="tight")


def _figure(
    path: Path,
    values: NDArray[np.float32],
    label: str,
    colour_map: str,
    limits: tuple[float, float],
    root: int = 1,
) -> None:
    """A colour-mapped picture with its scale bar, even in the `root`-th root of the values."""
    from matplotlib.colors import PowerNorm
    from matplotlib.figure import Figure

    height, width = values.shape
    low, high = limits
    figure = Figure(figsize=(width / 100 + 1.3, height / 100), dpi=100)
    axes = figure.add_axes((0, 0, width / (width + 130), 1))
    axes.set_axis_off()
    axes.set_facecolor("0.5")
    shown = axes.imshow(
        values,
        cmap=colour_map,
        norm=PowerNorm(1 / root, low, max(high, low + 1e-9)),
        interpolation="nearest",
    )
    bar = figure.add_axes(((width + 20) / (width + 130), 0.08, 22 / (width + 130), 0.84))
    figure.colorbar(shown, cax=bar, label=label)
    with replacing(path) as partial:
        figure.savefig(partial, facecolor="white")
