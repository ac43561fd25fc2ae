"""Maps as pictures for people: in colour, with a title, a scale bar and its numbers.

Pictures have a palette of GREYS greys, for text and what is outside the mask, and the colours of
their maps: so they are small, and quick to write.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from cutis.arrays import Bytes, Floats
from cutis.report.appearance import colour_map
from cutis.report.scale import Scale, tick_text

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageFont import FreeTypeFont

GREYS = 16
WHITE, OUTSIDE, BLACK = 15, 13, 0
"""Greys of the palette: paper, texels outside the mask, text."""
SMALLEST = 240
"""Pixels that the longer side of a map has at least: fewer texels are drawn as squares."""
MARGIN, TITLE, TEXT = 10, 15, 13
"""Pixels around and between things; heights of the two sizes of text."""
HEAD = TITLE + 2 * MARGIN
BAR, TICK = 22, 5
"""Width of a scale bar, length of its ticks."""
BESIDE = BAR + 64
"""Pixels that a scale bar and its numbers take beside a map."""


@dataclass(frozen=True)
class Panel:
    """A map (h, W), NaN outside the mask, with its colour map, its scale and its title."""

    values: Floats
    colours: str
    scale: Scale
    title: str

    def indices(self, first: int, levels: int, factor: int = 1) -> Bytes:
        """Places in the palette, the colours of the map being `levels` from `first` on."""
        place = self.scale.place(np.asarray(self.values, dtype=np.float32))
        known = np.isfinite(place)
        index = np.full(place.shape, OUTSIDE, dtype=np.uint8)
        index[known] = first + np.rint((levels - 1) * place[known]).astype(np.uint8)
        return index.repeat(factor, axis=0).repeat(factor, axis=1)


def drawn(panel: Panel) -> "Image":
    """A map below its title, its scale bar at its right."""
    levels = 256 - GREYS
    factor = max(1, SMALLEST // max(panel.values.shape))
    cells = panel.indices(GREYS, levels, factor)
    height, width = cells.shape
    tall = max(height, SMALLEST // 2)  # of the bar
    right = max(width + 2 * MARGIN + BESIDE, text_width(panel.title, TITLE) + 2 * MARGIN)
    page = Page((HEAD + tall + 2 * MARGIN, right))
    page.write((MARGIN, MARGIN), panel.title, TITLE)
    left = width + 2 * MARGIN
    for value in panel.scale.ticks(max(2, tall // 50)):
        y = HEAD + round((1 - float(panel.scale.place(value))) * (tall - 1))
        page.line((left + BAR, y), (left + BAR + TICK, y))
        page.write((left + BAR + 2 * TICK, y), tick_text(value), TEXT, "lm")
    index = page.indices()
    index[HEAD : HEAD + height, MARGIN : MARGIN + width] = cells
    ramp = np.rint((levels - 1) * np.linspace(1, 0, tall)).astype(np.uint8)
    index[HEAD : HEAD + tall, left : left + BAR] = GREYS + ramp[:, None]
    return paletted(index, [colour_map(panel.colours, levels)])


def in_a_row(panels: Sequence[Panel]) -> "Image":
    """Maps of one size side by side, each with its scale bar and title below."""
    levels = (256 - GREYS) // len(panels)
    shape = panels[0].values.shape
    factor = max(1, SMALLEST // max(shape))
    height, width = (n * factor for n in shape)
    cell = max(width, *(text_width(panel.title, TEXT) for panel in panels)) + MARGIN
    low = MARGIN + height + MARGIN  # of the bars
    page = Page((low + BAR // 2 + 2 * TEXT + 3 * MARGIN, MARGIN + cell * len(panels)))
    for number, panel in enumerate(panels):
        left = MARGIN + number * cell
        wide = cell - 3 * MARGIN  # what is left is for the text of the last tick
        bottom = low + BAR // 2
        for value in panel.scale.ticks(max(2, wide // 55)):
            x = left + MARGIN + round(float(panel.scale.place(value)) * (wide - 1))
            page.line((x, bottom), (x, bottom + TICK))
            page.write((x, bottom + TICK + 2), tick_text(value), TEXT, "mt")
        middle = left + MARGIN + wide // 2
        page.write((middle, bottom + TEXT + 2 * MARGIN), panel.title, TEXT, "mt")
    index = page.indices()
    for number, panel in enumerate(panels):
        left, first = MARGIN + number * cell, GREYS + number * levels
        start = left + (cell - MARGIN - width) // 2
        index[MARGIN : MARGIN + height, start : start + width] = panel.indices(
            first, levels, factor
        )
        ramp = np.rint((levels - 1) * np.linspace(0, 1, cell - 3 * MARGIN)).astype(np.uint8)
        index[low : low + BAR // 2, left + MARGIN : left + cell - 2 * MARGIN] = first + ramp
    return paletted(index, [colour_map(panel.colours, levels) for panel in panels])


class Page:
    """White paper of (rows, columns) to write on in black."""

    def __init__(self, size: tuple[int, int]) -> None:
        from PIL import Image, ImageDraw

        self._image = Image.new("L", size[::-1], 255)
        self._draw = ImageDraw.Draw(self._image)

    def write(self, place: tuple[int, int], text: str, size: int, anchor: str = "la") -> None:
        """Text with the point `anchor` of it (as Pillow names them) at (x, y)."""
        self._draw.text(place, text, 0, font(size), anchor)

    def line(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        """A thin line."""
        self._draw.line((start, end), 0)

    def indices(self) -> Bytes:
        """(rows, columns) greys of the palette."""
        return np.asarray(self._image) >> np.uint8(4)


def paletted(index: Bytes, tables: Sequence[Bytes]) -> "Image":
    """A picture of places in a palette: GREYS greys, then the colours of `tables`."""
    from PIL import Image

    greys = np.arange(GREYS, dtype=np.uint8)[:, None] * np.full(3, 17, np.uint8)
    picture = Image.fromarray(index)
    picture.putpalette(np.concatenate([greys, *tables]).tobytes())
    return picture


def text_width(text: str, size: int) -> int:
    """Pixels that a text takes."""
    return int(np.ceil(font(size).getlength(text)))


@lru_cache
def font(size: int) -> "FreeTypeFont":
    """DejaVu Sans with the letters that labels use, `size` pixels high."""
    from PIL import ImageFont

    file = resources.files("cutis.data").joinpath("page", "DejaVuSans-letters.ttf")
    return ImageFont.truetype(io.BytesIO(file.read_bytes()), size)
