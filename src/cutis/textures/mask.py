"""Which texels count."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.textures.closing import Closing
from cutis.textures.decoding import Decoder, check_finite
from cutis.textures.frame import Frame, placed, whole_frame
from cutis.textures.problem import problem
from cutis.textures.texture import bands, colour_channels, to_unit
from cutis.textures.turning import Orientation

_NEAR = 4 / 255
"""How far from black and white JPEG may take them."""
_TWO_VALUED = 0.9  # share of texels that are black or white in a channel that is a mask


class WrongSize(CutisError):
    """A mask that is not of the size of its texture."""


class MaskFile(Closing):
    """An open mask, read some rows at a time; see `read_mask`, also for errors.

    `notes` say in words what was made of a mask that can be understood in several ways.
    """

    BLACK = 0.02
    """What JPEG may make of black: a mask that is nowhere lighter is empty."""

    def __init__(
        self,
        path: str | os.PathLike[str],
        like: tuple[int, int] | Frame,
        orientation: Orientation = "auto",
    ) -> None:
        self.path = Path(path)
        self.frame = like if isinstance(like, Frame) else whole_frame(like)
        self.shape = self.frame.shape
        self._source = Decoder(self.path, orientation)
        try:
            self.notes = list(self._source.notes)
            self._from = self._laid()
            self._find()
        except BaseException:
            self.close()
            raise

    def _laid(self) -> Frame:
        """Where the mask's own texels lie on the picture."""
        theirs, ours = self._source.frame, self.frame
        if theirs.display == ours.display:
            return theirs
        if theirs.shape == ours.shape:
            return ours
        size, wanted = (f"{w} × {h}" for h, w in (theirs.display, ours.display))
        stored = "" if ours.whole else f" (of which {ours.shape[1]} × {ours.shape[0]} are stored)"
        what = f"the mask has {size} texels, the texture {wanted}{stored}; resize it"
        raise WrongSize(str(problem(self.path, what)))

    def _find(self) -> None:
        """Which channels are the mask."""
        names = [name.lower() for name in self._source.spec.channelnames]
        self._alpha: int | None = None
        if "mask" in names:
            self._columns = [names.index("mask")]
            return
        if len(names) < 3:
            alpha = names.index("a") if len(names) == 2 and "a" in names else None
            self._columns = [1 if alpha == 0 else 0]  # OpenEXR sorts channels by name
        else:
            try:
                self._columns, alpha = colour_channels(names)
            except ValueError as error:
                raise problem(self.path, f"as a mask: {error}, or a channel called mask") from error
        if alpha is not None:
            self._weigh(alpha)

    def _weigh(self, alpha: int) -> None:
        """Whether colour or alpha is the mask, or what both show.

        Programs that paint masks leave one of them as it is; a cut-out face has its mask in alpha.
        """
        grey, opacity = _Range(), _Range()
        for rows in bands(self._source.shape, self._source.step):
            pixels = self._source.rows(rows)
            opaque = to_unit(pixels[..., alpha])
            opacity.add(opaque)
            grey.add(to_unit(pixels[..., self._columns]).mean(axis=-1)[opaque > _NEAR])
        if not opacity.varies or opacity.highest <= _NEAR:
            return
        if not grey.varies or (opacity.two_valued and not grey.two_valued):
            self._columns = [alpha]
            self.notes.append("the mask is in its alpha channel")
        elif not opacity.two_valued:
            self.notes.append("the mask is its colour; its alpha channel is not used")
        elif self._source.spec.get_int_attribute("oiio:UnassociatedAlpha"):
            self._alpha = alpha
            self.notes.append("the mask is its colour where its alpha channel is opaque")

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """Values (h, W) in [0, 1] of some rows; 0 where the mask has no texels."""
        return placed(self._rows, self._from, self.frame, rows)

    def _rows(self, rows: slice) -> NDArray[np.float32]:
        pixels = self._source.rows(rows)
        used = self._columns if self._alpha is None else [*self._columns, self._alpha]
        first = rows.indices(self._from.shape[0])[0]
        for column in used:
            check_finite(self.path, pixels[..., column : column + 1], first)
        mask = to_unit(pixels[..., self._columns]).mean(axis=-1)
        if self._alpha is not None:
            mask *= to_unit(pixels[..., self._alpha])
        return mask.clip(0, 1)

    def empty(self) -> CutisError:
        """What to raise when no value was above BLACK."""
        return problem(self.path, "the mask is empty: all of it is black; paint white what counts")


class _Range:
    """Whether values vary, and whether nearly all of them are black or white."""

    def __init__(self) -> None:
        self.lowest, self.highest = np.inf, -np.inf
        self._extreme = self._count = 0

    def add(self, values: NDArray[np.float32]) -> None:
        """Some more values, any shape."""
        if values.size:
            self.lowest = min(self.lowest, float(values.min()))
            self.highest = max(self.highest, float(values.max()))
            extreme = (values <= _NEAR) | (values >= 1 - _NEAR)
            self._extreme += int(np.count_nonzero(extreme))
            self._count += values.size

    @property
    def varies(self) -> bool:
        return self.highest - self.lowest > _NEAR

    @property
    def two_valued(self) -> bool:
        return self._extreme >= _TWO_VALUED * self._count


def read_mask(
    path: str | os.PathLike[str],
    like: tuple[int, int] | Frame,
    orientation: Orientation = "auto",
) -> NDArray[np.float32]:
    """Mask (H, W) in [0, 1] from a grey or colour image of the size of the picture that it is for.

    `like` is the texture's `frame`, or its shape (H, W). A mask of a picture of which a part is
    stored is cut to that part. The channel called `mask` counts if there is one; else the mean of
    R, G, B; else, of one or two channels, the first. An alpha channel counts instead where colour
    is the same everywhere or no mask, and together with colour where both are masks. Stored values
    count as they are, over 255 or 65535 for integers, without a transfer function. Raises
    CutisError if the file is unreadable, of another size, or black.
    """
    with MaskFile(path, like, orientation) as file:
        mask = np.empty(file.shape, np.float32)
        for rows in bands(file.shape):
            mask[rows] = file.rows(rows)
        if not (mask > MaskFile.BLACK).any():
            raise file.empty()
    return mask
