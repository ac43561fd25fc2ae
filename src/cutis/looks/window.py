"""Rows of a file that are asked for again and again, a little further down each time."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Window:
    """Keeps the rows that were read last, so that a file is read from top to bottom only once."""

    def __init__(self, read: Callable[[slice], NDArray[Any]]) -> None:
        """`read` gives the rows (h, W) of a slice."""
        self._read = read
        self._first, self._held = 0, np.zeros((0, 0))

    def rows(self, first: int, last: int) -> NDArray[Any]:
        """Rows `first` to `last`, the latter not among them."""
        end = self._first + len(self._held)
        if self._first <= first < end < last:
            new = self._read(slice(end, last))
            self._held = np.concatenate([self._held[first - self._first :], new])
            self._first = first
        elif not self._first <= first <= last <= end:
            self._first, self._held = first, self._read(slice(first, last))
        return self._held[first - self._first : last - self._first]
