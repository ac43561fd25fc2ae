"""Label pictures: flat colours that say which texels belong together."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.textures.closing import Closing
from cutis.textures.decoding import Decoder, check_finite
from cutis.textures.frame import Frame, placed, whole_frame
from cutis.textures.problem import problem
from cutis.textures.texture import colour_channels, to_unit
from cutis.textures.turning import Orientation

_LOSSY = {"jpeg", "webp", "b44", "b44a", "dwaa", "dwab", "pxr24", "lerc"}


class LabelFile(Closing):
    """An open label picture, read some rows at a time: RGB, grey or with a palette, 8 or 16 bit.

    Labels are 0xRRGGBB; black, and what is transparent, is 0 and no region. `like` is the frame, or
    the shape, of the texture. Raises CutisError, one line that names the file, for a picture of
    another size and for one that is stored lossily, whose colours are flat no more.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        like: tuple[int, int] | Frame,
        orientation: Orientation = "auto",
    ) -> None:
        self.path = Path(path)
        self.frame = like if isinstance(like, Frame) else whole_frame(like)
        self._source = Decoder(self.path, orientation)
        try:
            self.notes = list(self._source.notes)
            self._check()
        except BaseException:
            self.close()
            raise

    def _check(self) -> None:
        spec, theirs = self._source.spec, self._source.frame
        packing = spec.get_string_attribute("compression").split(":")[0]
        if self._source.file_format == "jpeg" or packing in _LOSSY:
            what = f"is packed lossily ({packing or 'jpeg'}), which makes many colours of each"
            raise problem(self.path, f"{what}; save the regions as PNG")
        if theirs.display != self.frame.display and theirs.shape != self.frame.shape:
            size, ours = (f"{w} × {h}" for h, w in (theirs.display, self.frame.display))
            what = f"the regions have {size} texels, the texture {ours}"
            raise problem(self.path, f"{what}; resize them without smoothing")
        self._from = theirs if theirs.display == self.frame.display else self.frame
        names = [name.lower() for name in spec.channelnames]
        if len(names) < 3:
            alpha = names.index("a") if len(names) == 2 and "a" in names else None
            self._columns = [1 if alpha == 0 else 0] * 3
        else:
            try:
                self._columns, alpha = colour_channels(names)
            except ValueError as error:
                raise problem(self.path, f"as regions: {error}") from error
        self._alpha = alpha

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def rows(self, rows: slice) -> NDArray[np.int32]:
        """Labels (h, W) of some rows; 0 where the picture has no texels."""
        return placed(self._rows, self._from, self.frame, rows)

    def _rows(self, rows: slice) -> NDArray[np.int32]:
        pixels = self._source.rows(rows)
        check_finite(self.path, pixels, rows.indices(self._from.shape[0])[0])
        codes = np.rint(np.clip(to_unit(pixels), 0, 1) * 255).astype(np.int32)
        red, green, blue = (codes[..., column] for column in self._columns)
        labels = red << 16 | green << 8 | blue
        return labels if self._alpha is None else np.where(codes[..., self._alpha] > 0, labels, 0)
