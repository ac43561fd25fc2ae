"""Pictures of maps for people: colour-mapped PNG with a scale bar.

Previews are for the eye; the numbers are in the EXR.
"""

import contextlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cutis.arrays import Map
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse import Calibration
from cutis.maps import MapsFile, SkinMaps, find_source, open_source
from cutis.maps.trust import CONFIDENCE, LOW, SIGMA
from cutis.optics import PARAMETERS, Parameter
from cutis.report.appearance import COLOUR_MAPS, ERRORS, SURE
from cutis.report.drawing import Panel, drawn, in_a_row
from cutis.report.scale import Scale
from cutis.textures import replacing

if TYPE_CHECKING:
    from PIL.Image import Image

LONGEST = 900
"""Texels of the longer side of a preview."""
CELL = 450
"""Texels of the longer side of one map of several in a row."""


def reduced(values: Map) -> Map:
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
        self._parts: dict[str, list[Map]] = {}
        self._whole: dict[str, Map] | None = None

    def add(self, skin: SkinMaps) -> None:
        """The next rows."""
        rows = slice(-skin.maps.whole.first_row % self._step, None, self._step)
        for name, values in self._seen(skin).items():
            self._parts.setdefault(name, []).append(values[rows, :: self._step].copy())

    def _seen(self, skin: SkinMaps) -> dict[str, Map]:
        found = {known.name: getattr(skin, known.name) for known in PARAMETERS}
        found |= {"mask": skin.mask, "model": skin.model_albedo}
        found |= {name + SIGMA: sigma for name, sigma in skin.sigmas.items()}
        if skin.confidence is not None:
            found[CONFIDENCE] = skin.confidence
        if skin.source is not None:
            found["capture"] = skin.source
        return found

    def pictures(self) -> dict[str, Map]:
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
        pictures, drawings = self.pictures(), {}
        for known in PARAMETERS:
            values = pictures[known.name]
            low, high = known.low, known.high
            if np.isfinite(values).any():
                low, high = (float(v) for v in np.nanpercentile(values, [1, 99]))
            scale = Scale(low, max(high, low + 1e-9), known.root)
            panel = Panel(values, COLOUR_MAPS[known.name], scale, titled(known.meaning, known))
            drawings[known.name] = drawn(panel)
        if "error" in pictures:
            title = "model against capture [ΔE00]"
            panel = Panel(pictures["error"], ERRORS, Scale(0.0, 2.0), title)
            drawings["error"] = drawn(panel)
        if CONFIDENCE in pictures:
            title = "confidence that the colour is one of skin"
            panel = Panel(pictures[CONFIDENCE], SURE, Scale(0.0, 1.0), title)
            drawings["confidence"] = drawn(panel)
        sigmas = [known for known in PARAMETERS if known.name + SIGMA in pictures]
        if sigmas:
            drawings["sigma"] = in_a_row([_spread(known, pictures) for known in sigmas])
        return [_saved(one, Path(f"{stem}.{name}.png")) for name, one in drawings.items()]


def previews_of(maps: Path) -> dict[str, Map]:
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


def titled(text: str, known: Parameter) -> str:
    """A title with the unit of a map."""
    return text if known.unit == "1" else f"{text} [{known.unit}]"


def _spread(known: Parameter, pictures: Mapping[str, Map]) -> Panel:
    """σ of a map from 0 to what 95 % stay below.

    Of texels that are likely skin, where there are some: what little is known of hair and edges
    would leave skin blank.
    """
    values, confidence = pictures[known.name + SIGMA], pictures.get(CONFIDENCE)
    sure = np.bool_(True) if confidence is None else confidence >= LOW
    sure = sure if np.any(sure) else np.bool_(True)
    seen = values[np.isfinite(values) & sure]
    high = float(np.percentile(seen, 95)) if seen.size else 1.0
    step = -(-max(values.shape) // CELL)
    return Panel(
        values[::step, ::step], COLOUR_MAPS[known.name], Scale(0.0, max(high, 1e-9)),
        titled(f"σ of {known.name}", known),
    )  # fmt: skip


def _saved(picture: "Image", path: Path) -> Path:
    with replacing(path) as partial:
        picture.save(partial, "PNG")
    return path
