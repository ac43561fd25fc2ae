"""One pass over a texture: all that the checks look at, in bounded memory.

A reduced picture shows what is broad, single texels show colours as stored, windows in full size
show what is fine, and tallies count every texel.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cutis.arrays import Picture
from cutis.colour import Space
from cutis.maps.plain import Map
from cutis.textures import Texture
from cutis.textures.texture import colour_channels, to_unit

SIDE = 384
"""Texels along the longer side of the reduced picture, at most."""
WINDOW, WINDOWS = 128, 6
"""Texels along a window, and windows along a side of a large texture."""
INSIDE = 0.5
"""Cover from which a texel is surely inside the mask."""


@dataclass(frozen=True)
class Stored:
    """How colour is stored: the type of numbers, the space that counts, and where it is from."""

    dtype: str
    space: Space
    origin: str
    turned: int = 1
    tag: int = 1


@dataclass
class Tallies:
    """Counts over all texels inside the mask."""

    inside: int = 0
    top: int = 0
    bottom: int = 0
    above: int = 0
    below: int = 0
    highest: float = 0.0
    lowest: float = np.inf


@dataclass(frozen=True)
class Gathered:
    """What one pass found.

    `picture` (h, w, 3) holds means of blocks of `step` × `step` texels inside the mask, linear
    sRGB, `cover` (h, w) how much of a block is inside. `texels` (n, 3) are single texels of blocks,
    one each, `values` (n, 3) the same as stored, `places` (n, 2) their blocks, `sure` (n,) whether
    the mask holds them. `windows` are parts in full size, `(top, left, values (k, l, 3))`, inside
    the mask, as stored, from 0 to 1. `edges` are the outermost texels, top, right, bottom, left:
    colours (L, 3) and cover (L,).
    """

    shape: tuple[int, int]
    stored: Stored
    tallies: Tallies
    step: int
    picture: Picture
    cover: Map
    texels: Map
    values: Map
    places: np.ndarray
    sure: np.ndarray
    windows: Sequence[tuple[int, int, Map]] = ()
    edges: Sequence[tuple[Map, Map]] = ()
    masked: bool = False


@dataclass
class Gathering:
    """The pass: `add` rows from top to bottom, then `finish`."""

    shape: tuple[int, int]
    stored: Stored
    masked: bool = False
    _tallies: Tallies = field(default_factory=Tallies)

    def __post_init__(self) -> None:
        height, width = self.shape
        self._step = step = max(1, -(-max(self.shape) // SIDE))
        size = -(-height // step), -(-width // step)
        self._sum, self._weight = np.zeros((*size, 3)), np.zeros(size)
        self._count = np.zeros(size)
        self._texels: list[tuple[Map, Map, np.ndarray, np.ndarray]] = []
        self._windows = [
            (top, left, np.zeros((min(WINDOW, height), min(WINDOW, width), 3), np.float32),
             np.zeros((min(WINDOW, height), min(WINDOW, width)), np.float32))
            for top in _starts(height) for left in _starts(width)
        ]  # fmt: skip
        self._sides: list[tuple[Map, Map]] = []
        self._left: list[tuple[Map, Map]] = []
        self._right: list[tuple[Map, Map]] = []

    def add(self, first: int, part: Texture, linear: Map, cover: Map) -> None:
        """The next rows, the first of which is `first`, their colours and cover (h, W)."""
        columns, _ = colour_channels(part.channels)
        stored = part.pixels[..., columns]
        inside = cover > INSIDE
        self._tally(stored, linear, inside)
        self._reduce(first, linear, cover)
        self._pick(first, stored, linear, inside)
        for top, left, values, covered in self._windows:
            begin, end = max(top, first), min(top + len(values), first + len(cover))
            if begin < end:
                where = slice(begin - first, end - first), slice(left, left + values.shape[1])
                values[begin - top : end - top] = to_unit(stored[where])
                covered[begin - top : end - top] = cover[where]
        if first == 0:
            self._sides.append((linear[0].copy(), cover[0].copy()))
        if first + len(cover) == self.shape[0]:
            self._sides.append((linear[-1].copy(), cover[-1].copy()))
        self._left.append((linear[:, 0].copy(), cover[:, 0].copy()))
        self._right.append((linear[:, -1].copy(), cover[:, -1].copy()))

    def _tally(self, stored: np.ndarray, linear: Map, inside: np.ndarray) -> None:
        found = self._tallies
        found.inside += int(inside.sum())
        if stored.dtype.kind == "u":
            largest = np.iinfo(stored.dtype).max
            found.top += int(((stored == largest).any(axis=-1) & inside).sum())
            found.bottom += int(((stored == 0).any(axis=-1) & inside).sum())
        else:
            found.bottom += int(((stored == 0).any(axis=-1) & inside).sum())
        chosen = linear[inside]
        if len(chosen):
            found.above += int((chosen > 1.0005).any(axis=1).sum())
            found.below += int((chosen < -1e-4).any(axis=1).sum())
            found.highest = max(found.highest, float(chosen.max()))
            found.lowest = min(found.lowest, float(chosen.min()))

    def _reduce(self, first: int, linear: Map, cover: Map) -> None:
        """Adds to the means of blocks; of large blocks three texels a side are enough."""
        stride = max(1, self._step // 3)
        rows = np.arange(len(cover))
        rows = rows[(first + rows) % self._step % stride == 0]
        columns = np.arange(self.shape[1])
        columns = columns[columns % self._step % stride == 0]
        weights = cover[np.ix_(rows, columns)].astype(np.float64)
        colours = linear[np.ix_(rows, columns)] * weights[..., None]
        starts = np.flatnonzero(np.diff(columns // self._step, prepend=-1))
        wide = np.add.reduceat(colours, starts, axis=1)
        weight = np.add.reduceat(weights, starts, axis=1)
        counts = np.diff(starts, append=len(columns))
        blocks = (first + rows) // self._step
        np.add.at(self._sum, blocks, wide)
        np.add.at(self._weight, blocks, weight)
        np.add.at(self._count, blocks, np.broadcast_to(counts, weight.shape))

    def _pick(self, first: int, stored: np.ndarray, linear: Map, inside: np.ndarray) -> None:
        """One texel of each block, the middle one."""
        rows = _middles(self.shape[0], self._step) - first
        rows = rows[(rows >= 0) & (rows < len(linear))]
        columns = _middles(self.shape[1], self._step)
        if not len(rows):
            return
        where = np.ix_(rows, columns)
        grid = np.stack(
            np.meshgrid((rows + first) // self._step, columns // self._step, indexing="ij"), axis=-1
        )
        values = to_unit(stored[where]).reshape(-1, 3)
        picked = linear[where].reshape(-1, 3), values, grid.reshape(-1, 2), inside[where].ravel()
        self._texels.append(picked)

    def finish(self) -> Gathered:
        """All of it."""
        texels, values, places, sure = (
            np.concatenate(parts) for parts in zip(*self._texels, strict=True)
        )
        weight = np.maximum(self._weight, 1e-6)
        picture = np.asarray(self._sum / weight[..., None], np.float32)
        cover = np.asarray(self._weight / np.maximum(self._count, 1), np.float32)
        windows = [
            (top, left, values)
            for top, left, values, covered in self._windows
            if (covered > INSIDE).mean() > 0.9
        ]
        top, bottom = self._sides
        right, left = (
            (np.concatenate([c for c, _ in side]), np.concatenate([m for _, m in side]))
            for side in (self._right, self._left)
        )
        return Gathered(
            self.shape, self.stored, self._tallies, self._step, picture, cover, texels, values,
            places, sure, windows, (top, right, bottom, left), self.masked,
        )  # fmt: skip


def _middles(size: int, step: int) -> np.ndarray:
    """The middle of each block along a side; of one that is cut off the last texel at most."""
    return np.minimum(np.arange(step // 2, size + step // 2, step), size - 1)


def _starts(size: int) -> list[int]:
    """Where windows begin along a side: multiples of 8, evenly spread, no two of them meeting."""
    if size <= WINDOW:
        return [0]
    count = min(WINDOWS, size // WINDOW)
    free = size - WINDOW
    return [round(free * i / max(1, count - 1)) // 8 * 8 for i in range(count)]
