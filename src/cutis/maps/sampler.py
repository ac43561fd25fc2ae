"""Colours that calibration looks at: evenly picked from images that come in bands of rows."""

import numpy as np
from numpy.typing import NDArray

SAMPLE = 400_000
"""Texels that are looked at, at most."""
ENOUGH = 5_000
"""Texels inside the mask that are wanted."""

Colours = NDArray[np.float32]


class Sampler:
    """Every n-th texel along rows and columns, of images of `total` texels in all.

    Give it all rows of all images with `add`, again and again until `enough`: masks that cover
    little are looked at more closely each time. The result does not depend on the bands.
    """

    def __init__(self, total: int) -> None:
        self._step = max(1, int(np.ceil(np.sqrt(total / SAMPLE))))
        self._sure: list[Colours] = []
        self._weak: list[Colours] = []
        self._begun = False

    def enough(self) -> bool:
        """Whether what was added is enough; if not, everything is to be added once more."""
        if self._begun and (self._step == 1 or sum(map(len, self._sure)) >= ENOUGH):
            return True
        if self._begun:
            self._step = max(1, self._step // 4)
        self._begun, self._sure, self._weak = True, [], []
        return False

    def add(self, first_row: int, colours: Colours, cover: NDArray[np.float32]) -> None:
        """Colours (h, W, 3) and cover (h, W) of some rows, the first of which is `first_row`."""
        start = self._step // 2
        rows = slice((start - first_row) % self._step, None, self._step)
        columns = slice(start, None, self._step)
        found, covered = colours[rows, columns], cover[rows, columns]
        self._sure.append(found[covered >= 0.5])
        self._weak.append(found[(covered > 0) & (covered < 0.5)])

    def colours(self) -> Colours:
        """(n, 3) of texels surely inside the mask (cover of at least ½), else of all inside."""
        sure = np.concatenate(self._sure)
        return sure if len(sure) else np.concatenate(self._weak)
