"""Arrays in files, read some rows at a time.

They are read, not mapped: a file that shrinks while it is mapped ends the process by a signal.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.textures.closing import Closing
from cutis.textures.decoding import available_memory
from cutis.textures.problem import problem, shorten
from cutis.textures.regular import open_regular

KINDS = "fui"
"""Letters of the types that are read: floats and whole numbers."""
_LONGEST_HEADER = 1 << 16  # bytes of an .npy header; those of plain arrays have 128
_MAGIC = b"\x93NUMPY"


class StoredArray(Closing):
    """Values of `dtype` in C order at `offset` of a file, of `shape`; `axis` is that of its rows.

    Raises CutisError where the file is shorter than that, also when it became so since.
    """

    def __init__(
        self,
        path: Path,
        dtype: np.dtype[np.generic],
        offset: int,
        shape: tuple[int, ...],
        axis: int,
    ) -> None:
        self.path, self.dtype, self.shape, self.axis = path, dtype, shape, axis
        self._offset = offset
        self._file = open_regular(path)
        self._whole: NDArray[np.generic] | None = None
        need, length = offset + math.prod(shape) * dtype.itemsize, self._file.seek(0, 2)
        if min(shape, default=0) < 1 or offset < 0 or length < need:
            self.close()
            what = f"is {length} bytes long where its header claims {need}"
            raise problem(path, f"{what}; copy or export it again")

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()
        self._whole = None

    def rows(self, rows: slice) -> NDArray[np.generic]:
        """Those values whose place along `axis` is in `rows`, in the order of the axes."""
        first, last, _ = rows.indices(self.shape[self.axis])
        before, behind = self.shape[: self.axis], self.shape[self.axis + 1 :]
        inner = math.prod(behind)
        if inner * max(last - first, 1) < 64 < math.prod(before):
            return self._all().take(
                range(first, last), self.axis
            )  # else a seek for each few values
        size = inner * self.dtype.itemsize
        stride = self.shape[self.axis] * size
        count = max(0, last - first)
        found = np.empty((math.prod(before), count * inner), self.dtype)
        for i, part in enumerate(found):
            part[:] = self._read(len(part), self._offset + i * stride + first * size)
        return found.reshape(*before, count, *behind)

    def _all(self) -> NDArray[np.generic]:
        if self._whole is None:
            need, free = math.prod(self.shape) * self.dtype.itemsize, available_memory()
            if free is not None and need > free:
                what = f"needs {need / 2**30:.1f} GiB of memory in the order that it is stored in"
                raise problem(self.path, f"{what}; store its lines one after the other")
            self._whole = self._read(math.prod(self.shape), self._offset).reshape(self.shape)
        return self._whole

    def _read(self, count: int, at: int) -> NDArray[np.generic]:
        self._file.seek(at)
        content = self._file.read(count * self.dtype.itemsize)
        if len(content) != count * self.dtype.itemsize:
            raise problem(self.path, "became shorter while it was read; copy or export it again")
        return np.frombuffer(content, self.dtype)


def npy_header(path: Path) -> tuple[np.dtype[np.generic], tuple[int, ...], bool, int]:
    """Type, shape, whether in Fortran's order, and where the values of a .npy file begin.

    Raises CutisError where it is something else than an array of real numbers.
    """
    instead = "is no NumPy array of real numbers; save it again by numpy.save"
    with open_regular(path) as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise problem(path, instead)
        file.seek(0)
        try:
            version = np.lib.format.read_magic(file)
            read = (
                np.lib.format.read_array_header_1_0
                if version == (1, 0)
                else np.lib.format.read_array_header_2_0
            )
            shape, fortran, dtype = read(file, max_header_size=_LONGEST_HEADER)
        except Exception as error:  # its parser raises whatever Python's own raises
            raise problem(path, f"{instead} ({shorten(type(error).__name__)})") from error
        offset = file.tell()
    good = bool(shape) and dtype.kind in KINDS and all(isinstance(n, int) and n >= 0 for n in shape)
    if not good or math.prod(shape) > 1 << 60:
        raise problem(path, instead)
    return dtype, tuple(shape), bool(fortran), offset


def load_numbers(path: Path, longest: int = 1 << 20) -> NDArray[np.generic]:
    """All of a short .npy file of numbers, at most `longest` of them."""
    dtype, shape, fortran, offset = npy_header(path)
    if math.prod(shape) > longest:
        raise problem(path, f"holds {math.prod(shape)} numbers; give a list of wavelengths")
    with StoredArray(path, dtype, offset, (math.prod(shape),), 0) as file:
        values = file.rows(slice(None))
    return values.reshape(shape, order="F" if fortran else "C")
