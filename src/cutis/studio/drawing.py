"""Views of a face, drawn by the code that `cutis edit` runs.

A view is a part of a level. The look is made ready for that level; texels that it changes are
multiplied by the model's albedo after over that before, as `maps.colours.changes` does. What is
before is worked out once for a view, so that a slider that moves costs one decode of the model.
"""

import io
import threading
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.colour import encode_srgb
from cutis.errors import CutisError
from cutis.looks import Look
from cutis.looks.look import LookOnFace
from cutis.maps import Estimate, Maps
from cutis.maps import colours as maps_colours
from cutis.maps.changes import Tile
from cutis.maps.relighting import DARKEST
from cutis.optics import NAMES, RARE_NAMES
from cutis.studio.levels import Level, Rect
from cutis.studio.opening import OpenFace

QUALITY = 92
"""Of JPEGs."""
MOST = 1 << 23
"""Texels of one view; larger ones are drawn at the next level."""
Codes = NDArray[np.uint8]


@dataclass(frozen=True)
class Region:
    """A part of a face in texels, and how many pixels of the screen a texel is wide."""

    left: float
    top: float
    right: float
    bottom: float
    scale: float


@dataclass(frozen=True)
class Drawn:
    """Colours (h, w, 3), linear sRGB, and which texels of the face they are: a part of a level."""

    colours: NDArray[np.float32]
    level: int
    rect: Rect

    @property
    def place(self) -> list[int]:
        """Left, top, right, bottom in texels of the face; the last may be a little beyond it."""
        rows, columns = self.rect
        found = (columns.start, rows.start, columns.stop, rows.stop)
        return [int(one) << self.level for one in found]


@dataclass
class _Before:
    """A part of a level with the model's colours of it, to draw edits of."""

    key: tuple[int, int, int, int, int]
    skin: Estimate
    colours: NDArray[np.float32] = field(repr=False)


class Drawer:
    """Draws views of one face; one at a time."""

    def __init__(self, face: OpenFace) -> None:
        self._face, self._lock = face, threading.Lock()
        self._before: dict[int, _Before] = {}

    def place(self, region: Region, coarser: int = 0) -> tuple[Level, Rect]:
        """The level and the part of it for a region; `coarser` takes a smaller level."""
        levels = self._face.levels
        number = min(levels.at(region.scale).number + coarser, len(levels.all) - 1)
        while True:
            level = levels.all[number]
            size, (height, width) = 1 << number, level.shape
            rows = _within(region.top / size, region.bottom / size, height)
            columns = _within(region.left / size, region.right / size, width)
            count = (rows.stop - rows.start) * (columns.stop - columns.start)
            if count <= MOST or number + 1 == len(levels.all):
                return level, (rows, columns)
            number += 1

    def original(self, region: Region, coarser: int = 0) -> Drawn:
        """The capture."""
        level, rect = self.place(region, coarser)
        return Drawn(np.ascontiguousarray(level.colours[rect]), level.number, rect)

    def edited(
        self, region: Region, look: Look, coarser: int = 0, light: str | None = None
    ) -> Drawn:
        """The capture with a look in it; CutisError where the look does not fit the face."""
        level, rect = self.place(region, coarser)
        if not self._face.ready or (light is None and not any(one.on for one in look.layers)):
            return self.original(region, coarser)
        with self._lock:
            colours = self._draw(level, rect, look, light)
        return Drawn(colours, level.number, rect)

    def cover(self, region: Region, look: Look, number: int, coarser: int = 0) -> Drawn:
        """How much of a layer, from 0 on, each texel gets: (h, w, 1)."""
        level, rect = self.place(region, coarser)
        layer = look.layers[number].model_copy(update={"on": True})
        alone = look.model_copy(update={"layers": (layer,)})
        change = self._face.change(alone, level)
        assert isinstance(change, LookOnFace)
        wide = _wide(level, rect, change.reach) if placed(alone) else rect
        skin = level.part(wide, change.trust)
        (ready,) = change._layers
        weight = ready.weight(Tile(skin.maps, skin.sigmas, (), skin.confidence))
        return Drawn(weight[_inner(wide, rect)][..., None], level.number, rect)

    def values(self, region: Region, look: Look, kind: str, name: str, coarser: int = 0) -> Drawn:
        """A map with the look in it, or σ or confidence as estimated: (h, w, 1), NaN off skin."""
        level, rect = self.place(region, coarser)
        if kind == "map":
            _, after = self.maps(level, rect, look)
            found, mask = after[name], after.mask
        else:
            skin = level.part(rect, trust=True)
            mask = skin.maps.mask
            values = skin.confidence if kind == "confidence" else skin.sigmas.get(name)
            if values is None:
                raise CutisError(f"these maps have no {kind} of {name}")
            found = values
        seen = np.where(mask > 0, found, np.float32(np.nan))[..., None]
        return Drawn(seen, level.number, rect)

    def maps(self, level: Level, rect: Rect, look: Look) -> tuple[Estimate, Maps]:
        """The estimate of a part, and its maps with the look in them."""
        change = self._face.change(look, level)
        wide = _wide(level, rect, change.reach) if placed(look) else rect
        skin = level.part(wide, change.trust)
        start = Tile(skin.maps, skin.sigmas, (), skin.confidence)
        after = change.rows(wide[0])(start).maps if change.told else skin.maps
        return _cut(skin, wide, rect), _cut_maps(after, wide, rect)

    def _draw(self, level: Level, rect: Rect, look: Look, light: str | None) -> Any:
        skin, after = self.maps(level, rect, look)
        file = self._face.file
        model, calibration = self._face.model, file.header.calibration
        assert skin.source is not None
        relight = maps_colours.relighting(model, calibration, light)
        if relight is not None:
            return relight(skin.maps, after, skin.source)
        before = self._model_colours(level, rect, skin)
        names = (*NAMES, *RARE_NAMES) if after.rare else NAMES
        colours = _decoded(model, calibration, after, names)
        from cutis.studio.levels_kernel import recolour

        out = np.empty_like(colours)
        recolour(len(out), skin.source, skin.maps.mask, before, colours, DARKEST, out)
        return out

    def _model_colours(self, level: Level, rect: Rect, skin: Estimate) -> NDArray[np.float32]:
        rows, columns = rect
        key = (level.number, rows.start, rows.stop, columns.start, columns.stop)
        held = self._before.get(level.number)
        if held is None or held.key != key:
            model, calibration = self._face.model, self._face.file.header.calibration
            held = _Before(key, skin, _decoded(model, calibration, skin.maps, NAMES))
            self._before.pop(level.number, None)
            self._before[level.number] = held
            while len(self._before) > 2:
                self._before.pop(next(iter(self._before)))
        return held.colours


def _decoded(model: Any, calibration: Any, maps: Maps, names: Any) -> NDArray[np.float32]:
    """(h, w, 3) colours of the model under the light of the capture; of no skin, anything."""
    skins = maps.parameters(names)
    if not (maps.mask > 0).all():
        # what is no skin has maps of 0, which no model need know
        skins[maps.mask <= 0] = np.float32(0.5)
    found = maps_colours.captured(model, calibration, skins.reshape(-1, skins.shape[-1]))
    return np.asarray(found.reshape(*maps.shape, 3), np.float32)


def placed(look: Look) -> bool:
    """Whether what becomes of a texel depends on where it is or on its neighbours."""
    return any(
        part.placed for layer in look.layers if layer.on for part in (*layer.edits, *layer.mask)
    )


def codes(linear: NDArray[np.floating]) -> Codes:
    """(H, W, 3) linear sRGB → 8 bits of sRGB."""
    from cutis.studio.levels_kernel import to_codes

    colours = np.ascontiguousarray(linear, dtype=np.float32)
    out = np.empty(colours.shape, np.uint8)
    to_codes(len(out), colours, _curve(), out)
    return out


def jpeg(picture: Codes, quality: int = QUALITY) -> bytes:
    """(H, W, 3) 8 bits of sRGB as a JPEG, colours as fine as brightness."""
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(picture).save(data, "JPEG", quality=quality, subsampling=0)
    return data.getvalue()


@cache
def _curve() -> Codes:
    from cutis.studio.levels_kernel import STEPS

    return np.rint(255 * encode_srgb(np.linspace(0, 1, STEPS))).astype(np.uint8)


def _within(low: float, high: float, size: int) -> slice:
    """Whole rows or columns that cover low to high, at least one of `size`."""
    if not (np.isfinite(low) and np.isfinite(high)):
        raise CutisError("a view has finite edges")
    first = min(max(int(np.floor(low)), 0), size - 1)
    return slice(first, min(max(int(np.ceil(high)), first + 1), size))


def _wide(level: Level, rect: Rect, reach: int) -> Rect:
    rows = slice(max(0, rect[0].start - reach), min(level.shape[0], rect[0].stop + reach))
    return rows, slice(0, level.shape[1])


def _inner(wide: Rect, rect: Rect) -> Rect:
    return (
        slice(rect[0].start - wide[0].start, rect[0].stop - wide[0].start),
        slice(rect[1].start - wide[1].start, rect[1].stop - wide[1].start),
    )


def _cut_maps(maps: Maps, wide: Rect, rect: Rect) -> Maps:
    if wide == rect:
        return maps
    inner = _inner(wide, rect)
    values = {name: np.ascontiguousarray(found[inner]) for name, found in maps.values.items()}
    return Maps(values, np.ascontiguousarray(maps.mask[inner]))


def _cut(skin: Estimate, wide: Rect, rect: Rect) -> Estimate:
    if wide == rect:
        return skin
    assert skin.source is not None
    return Estimate(
        _cut_maps(skin.maps, wide, rect), skin.by, skin.calibrated,
        capture=np.ascontiguousarray(skin.source[_inner(wide, rect)]), notes=skin.notes,
    )  # fmt: skip
