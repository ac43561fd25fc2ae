"""Where texels lie on the picture that is shown, of which more or less may be stored.

OpenEXR stores a data window, anywhere about the display window, which is the picture. Other formats
store the picture.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

Rows = Callable[[slice], NDArray[Any]]
_WHOLE = re.compile(r"-?\d{1,7}")


@dataclass(frozen=True)
class Frame:
    """`shape` (H, W) of what is stored, and where on the picture of `display` (H, W) it begins.

    `top` and `left` count texels from the corner of the picture and may be negative.
    """

    shape: tuple[int, int]
    display: tuple[int, int]
    top: int = 0
    left: int = 0

    @property
    def whole(self) -> bool:
        """Whether exactly the picture is stored."""
        return self.shape == self.display and not (self.top or self.left)

    @property
    def shown(self) -> "Frame":
        """That of the whole picture."""
        return Frame(self.display, self.display)

    @property
    def visible(self) -> bool:
        """Whether any texel is inside the picture."""
        ends = self.top + self.shape[0], self.left + self.shape[1]
        inside = self.top < self.display[0] and self.left < self.display[1]
        return inside and min(ends) > 0

    def note(self) -> str:
        """The same in words of a header, which `noted_frame` reads."""
        return " ".join(map(str, (self.top, self.left, *self.display)))

    def to(self, spec: oiio.ImageSpec, x: int = 0, y: int = 0) -> None:
        """Sets the windows of a header; the picture begins at `x`, `y`."""
        spec.full_x, spec.full_y, spec.full_z = x, y, 0
        spec.full_height, spec.full_width = self.display
        spec.full_depth = spec.depth = 1
        spec.x, spec.y, spec.z = x + self.left, y + self.top, 0
        spec.height, spec.width = self.shape


def whole_frame(shape: tuple[int, int]) -> Frame:
    """The frame of a picture that is stored as it is."""
    return Frame(shape, shape)


def noted_frame(text: str, shape: tuple[int, int]) -> Frame:
    """The frame of an image of `shape` that a note tells of; all of its picture without one."""
    numbers = text.split()
    if len(numbers) == 4 and all(_WHOLE.fullmatch(number) for number in numbers):
        top, left, height, width = map(int, numbers)
        if min(height, width) > 0:
            return Frame(shape, (height, width), top, left)
    return whole_frame(shape)


def frame_of(spec: oiio.ImageSpec, file_format: str) -> Frame:
    """The frame that a header states; only OpenEXR's are believed."""
    shape = (spec.height, spec.width)
    display = (spec.full_height, spec.full_width)
    if file_format != "openexr" or min(display) < 1:
        return whole_frame(shape)
    return Frame(shape, display, spec.y - spec.full_y, spec.x - spec.full_x)


def placed(source: Rows, theirs: Frame, ours: Frame, rows: slice) -> NDArray[Any]:
    """Some rows (h, W, …) of what lies in `ours`, from an image in `theirs` of the same picture.

    Zero where the image has no texels. `source` gives rows (h, W, …) of the image.
    """
    first, last, _ = rows.indices(ours.shape[0])
    down, right = ours.top - theirs.top, ours.left - theirs.left
    top, bottom = max(first + down, 0), min(last + down, theirs.shape[0])
    left, end = max(right, 0), min(right + ours.shape[1], theirs.shape[1])
    there = source(slice(top, max(top, bottom)))
    found = np.zeros((last - first, ours.shape[1], *there.shape[2:]), there.dtype)
    if bottom > top and end > left:
        into = slice(top - down - first, bottom - down - first)
        found[into, left - right : end - right] = there[:, left:end]
    return found
