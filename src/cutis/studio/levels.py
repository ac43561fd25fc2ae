"""A face at its own size, half, a quarter, …: what views are drawn of.

Level 0 holds the capture's colours and its maps as they are, in files without a name that vanish
with the process, so that memory is the system's to give and to take. Each further level holds means
of 2 × 2 texels of the one before, weighted by the mask for maps. A level is a `maps.face.Source`,
so that looks are made ready for it as for the face itself.
"""

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.maps import Estimate, MadeBy, Maps, MapsFile
from cutis.maps.face import TileOf
from cutis.maps.plain import Map, Place
from cutis.maps.statistics import Quantiles
from cutis.maps.trust import CONFIDENCE
from cutis.optics import NAMES
from cutis.textures import TextureFile, bands

SMALLEST = 48
"""Texels of the longer side at which no further level is made."""
Rect = tuple[slice, slice]
"""Rows and columns."""


def held(shape: tuple[int, ...], folder: Path) -> NDArray[np.float32]:
    """An array of zeros on disk, in a file that nobody else sees and that ends with it."""
    with tempfile.TemporaryFile(dir=folder) as file:
        file.truncate(4 * int(np.prod(shape)))
        return np.memmap(file, np.float32, "r+", shape=shape)


class Level:
    """A face at one size: `colours` (h, w, 3), and once they are known `maps` (h, w, 5), `mask`.

    `trust` (h, w, 6) are σ of the five and confidence, where somebody has asked for them.
    """

    def __init__(self, number: int, colours: NDArray[np.float32]) -> None:
        self.number, self.colours = number, colours
        self.shape: tuple[int, int] = (colours.shape[0], colours.shape[1])
        self.maps: NDArray[np.float32] | None = None
        self.mask: NDArray[np.float32] | None = None
        self.trust: NDArray[np.float32] | None = None
        self._file: MapsFile | None = None
        self._ask: Levels | None = None

    def knowing(self, file: MapsFile, whole: "Levels") -> None:
        """From now on it is a source of maps."""
        self._file, self._ask = file, whole

    # as a source of maps ----------------------------------------------------------------------

    @property
    def made_by(self) -> MadeBy:
        """The model."""
        return self.file.made_by

    @property
    def tile(self) -> TileOf:
        """Of no set: percentiles come from `known`."""
        return TileOf()

    @property
    def known(self) -> Quantiles | None:
        """Where values of the maps lie: those of the whole face at its own size."""
        return self.file.known

    @property
    def provenance(self) -> Mapping[str, str]:
        """Where the maps are from."""
        return {**self.file.provenance, "window": ""}

    @property
    def file(self) -> MapsFile:
        """The file of maps."""
        assert self._file is not None, "maps are not there yet"
        return self._file

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""
        return self.file.knows(name)

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it."""
        return bands(self.shape)

    def keep(self) -> None:
        """They are at hand anyway."""

    def rows(self, rows: slice, trust: bool = True) -> Estimate:
        """Maps and colours of some rows."""
        return self.part((rows, slice(None)), trust)

    def part(self, rect: Rect, trust: bool = False) -> Estimate:
        """Maps and colours of a part; its place is that of its rows where all columns are asked."""
        assert self.maps is not None
        assert self.mask is not None
        maps, mask = self.maps[rect], np.ascontiguousarray(self.mask[rect])
        place = None
        if mask.shape[1] == self.shape[1]:
            place = Place(rect[0].indices(self.shape[0])[0], self.shape)
        values = {name: np.ascontiguousarray(maps[..., i]) for i, name in enumerate(NAMES)}
        spread: dict[str, Map] = {}
        sure: Map | None = None
        if trust and self._ask is not None:
            known = self._ask.trusted(self)[rect]
            spread = {n: known[..., i] for i, n in enumerate(NAMES) if self.knows(n)}
            sure = known[..., -1] if self.knows(CONFIDENCE) else None
        return Estimate(
            Maps(values, mask, place), self.made_by, self.file.header.calibration, spread, sure,
            np.ascontiguousarray(self.colours[rect]), self.provenance, self.file.header.state,
            quantiles=self.known,
        )  # fmt: skip


class Levels:
    """All sizes of a face, the first its own."""

    def __init__(self, texture: TextureFile, folder: Path) -> None:
        """Reads the colours of an open texture; the folder holds the files without a name."""
        self._folder = folder
        first = held((*texture.shape, 3), folder)
        for rows in texture.bands():
            first[rows] = texture.rows(rows).linear()
        self.all = [Level(0, first)]
        ones = np.ones(texture.shape, np.float32)
        while max(self.all[-1].shape) > SMALLEST:
            last = self.all[-1]
            shape = _half(last.shape)
            ones = ones[: last.shape[0], : last.shape[1]]
            self.all.append(Level(last.number + 1, self._halved(last.colours, ones, shape)))

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the face."""
        return self.all[0].shape

    def at(self, scale: float) -> Level:
        """The level for `scale` pixels of a view per texel: it is drawn 0.6 to 1.2 times as large.

        The smallest one for less, the face itself for more.
        """
        number = int(np.floor(np.log2(1 / max(scale, 1e-6)) + 0.25))
        return self.all[min(max(number, 0), len(self.all) - 1)]

    def add_maps(self, file: MapsFile) -> None:
        """Reads the maps of an open file, which stays open as long as this."""
        maps, mask = held((*self.shape, 5), self._folder), held(self.shape, self._folder)
        for rows in file.bands():
            skin = file.rows(rows, trust=False)
            for i, name in enumerate(NAMES):
                maps[rows, :, i] = skin.maps[name]
            mask[rows] = skin.mask
        for level in self.all:
            if level.number:
                inside = (mask > 0).astype(np.float32)
                maps = self._halved(maps, inside, level.shape)
                ones = np.ones(mask.shape, np.float32)
                mask = self._halved(mask[..., None], ones, level.shape)[..., 0]
            level.knowing(file, self)
            level.maps, level.mask = maps, mask

    def close(self) -> None:
        """Lets go of everything."""
        self.all = []

    def trusted(self, level: Level) -> NDArray[np.float32]:
        """(h, w, 6) σ of the five and confidence of a level; read once, when first asked for."""
        if level.trust is None:
            self._read_trust(level.file)
        assert level.trust is not None
        return level.trust

    def _read_trust(self, file: MapsFile) -> None:
        trust = held((*self.shape, 6), self._folder)
        for rows in file.bands():
            skin = file.rows(rows)
            for i, name in enumerate(NAMES):
                if name in skin.sigmas:
                    trust[rows, :, i] = skin.sigmas[name]
            if skin.confidence is not None:
                trust[rows, :, -1] = skin.confidence
        for level, before in zip(self.all, [None, *self.all], strict=False):
            if before is not None:
                assert before.mask is not None
                inside = (before.mask > 0).astype(np.float32)
                trust = self._halved(trust, inside, level.shape)
            level.trust = trust

    def _halved(
        self, values: NDArray[np.float32], weights: NDArray[np.float32], shape: tuple[int, int]
    ) -> NDArray[np.float32]:
        from cutis.studio.levels_kernel import halve

        out = held((*shape, values.shape[2]), self._folder)
        halve(shape[0], values, weights, out)
        return out


def _half(shape: tuple[int, int]) -> tuple[int, int]:
    return -(-shape[0] // 2), -(-shape[1] // 2)
