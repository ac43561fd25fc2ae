"""MIP levels of a texture, made while its rows come, so that memory does not grow with it.

Each level halves the one before, rounded down, to a single texel: the mean of the texels that each
covers. Levels wait in files without a name until all of them are known.
"""

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.generic]
_BAND = 1 << 22  # bytes read at a time


class Pyramid:
    """All levels below an image of `shape` (H, W, C), stored as `dtype`; `push` takes its rows.

    Integers are averaged before they are rounded. Waiting levels take a third of the image's bytes
    in `folder`. Close it.
    """

    def __init__(self, shape: tuple[int, int, int], dtype: np.dtype[np.generic], folder: Path):
        self._dtype = dtype
        self._halves: list[Half] = []
        self._files: list[IO[bytes]] = []
        while shape[:2] != (1, 1):
            self._halves.append(Half(shape))
            self._files.append(tempfile.TemporaryFile(dir=folder))  # noqa: SIM115
            shape = self._halves[-1].shape

    def push(self, pixels: Pixels) -> None:
        """The next rows (h, W, C)."""
        with np.errstate(invalid="ignore", over="ignore"):  # other channels may be infinite
            rows = pixels.astype(np.float32)
            for half, file in zip(self._halves, self._files, strict=True):
                rows = half.push(rows)
                stored = np.rint(rows) if self._dtype.kind == "u" else rows
                file.write(stored.astype(self._dtype).tobytes())

    def levels(self) -> Iterator[tuple[tuple[int, int, int], Iterator[Pixels]]]:
        """Shape and rows, from top to bottom, of each level, the largest first."""
        for half, file in zip(self._halves, self._files, strict=True):
            file.seek(0)
            yield half.shape, self._rows(half.shape, file)

    def _rows(self, shape: tuple[int, int, int], file: IO[bytes]) -> Iterator[Pixels]:
        size = shape[1] * shape[2] * self._dtype.itemsize
        while data := file.read(max(1, _BAND // size) * size):
            yield np.frombuffer(data, self._dtype).reshape(-1, *shape[1:])

    def close(self) -> None:
        """Gives the space of the levels back."""
        for file in self._files:
            file.close()


class Half:
    """An image (H, W, C) at half its size, `shape`, some rows at a time."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        height, width, count = shape
        self.shape = max(1, height // 2), max(1, width // 2), count
        self._down, self._across = _weights(height), _weights(width)
        self._waiting = np.empty((0, self.shape[1], count), np.float32)
        self._next = 0

    def push(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """The next rows (h, W, C) → those rows of the half that are known now."""
        narrow = _mean(rows, self._across, 1)
        self._waiting = np.concatenate([self._waiting, narrow])
        taps = len(self._down)
        known = max(0, (len(self._waiting) - taps) // 2 + 1) if taps > 1 else len(rows)
        weights = self._down[:, self._next : self._next + known]
        out = _mean(self._waiting, weights, 0)
        self._waiting = self._waiting[2 * known :]
        self._next += known
        return out


def _weights(count: int) -> NDArray[np.float32]:
    """(taps, n) shares of texels 2j, 2j + 1, 2j + 2 in texel j of n = count // 2."""
    half = count // 2
    if half == 0:
        return np.ones((1, 1), np.float32)
    if count == 2 * half:
        return np.full((2, half), 0.5, np.float32)
    j = np.arange(half)
    return np.stack([half - j, np.full(half, half), j + 1]).astype(np.float32) / np.float32(count)


def _mean(
    values: NDArray[np.float32], weights: NDArray[np.float32], axis: int
) -> NDArray[np.float32]:
    """`values` along `axis` weighted into as many as `weights` (taps, n) has."""
    count = weights.shape[1]
    total = np.zeros(1, np.float32)
    for tap, share in enumerate(weights):
        part = [slice(None)] * 3
        part[axis] = slice(tap, tap + 2 * count - 1 if count else tap, 2)
        scale = share[:, None, None] if axis == 0 else share[None, :, None]
        total = total + values[tuple(part)] * scale
    return total
