"""Pictures of the report page: photographs, maps with their colour scale, histograms.

All of it ends up inside the page, so sizes are bounded: ten pictures stay below 3 MB of HTML.
"""

import base64
import io
from collections.abc import Iterator

import numpy as np

from cutis.arrays import Floats, Map
from cutis.report.appearance import colour_map, displayed
from cutis.report.scale import Scale

LONGEST = 900
"""Pixels of the longer side of a picture, at most."""
BYTES = 200_000
"""What one picture may take; larger ones are reduced further."""
LEVELS = 95
"""Colours of a map, besides that of texels outside the mask, which is none."""


def photograph(rgb: Floats) -> tuple[bytes, tuple[int, int]]:
    """(H, W, 3) in [0, 1], encoded as shown → a JPEG and its width and height."""
    from PIL import Image

    for longest in _lengths():
        picture = Image.fromarray(np.uint8(np.rint(255 * np.nan_to_num(reduced(rgb, longest)))))
        data = io.BytesIO()
        picture.save(data, "JPEG", quality=88, optimize=True)
        if data.tell() <= BYTES:
            break
    return data.getvalue(), picture.size


def coloured(values: Floats, colours: str, scale: Scale) -> tuple[bytes, tuple[int, int]]:
    """A map (H, W), NaN outside the mask → a PNG, transparent there, and its width and height."""
    from PIL import Image

    for longest in _lengths():
        shown = reduced(values, longest)
        place = np.nan_to_num(scale.place(shown))
        index = np.where(np.isfinite(shown), 1 + np.rint((LEVELS - 1) * place), 0)
        picture = Image.fromarray(index.astype(np.uint8))
        picture.putpalette(bytes(3) + colour_map(colours, LEVELS).tobytes())
        data = io.BytesIO()
        picture.save(data, "PNG", transparency=0, optimize=True)
        if data.tell() <= BYTES:
            break
    return data.getvalue(), picture.size


def _lengths() -> Iterator[int]:
    longest = LONGEST
    while longest > 64:
        yield longest
        longest = longest * 4 // 5


def reduced(values: Floats, longest: int) -> Map:
    """(H, W[, 3]) → the mean over what is known of each pixel, longer side at most `longest`.

    A pixel most of which is not known (not finite) is NaN.
    """
    from PIL import Image

    height, width = values.shape[:2]
    factor = min(1.0, longest / max(height, width))
    size = max(1, round(width * factor)), max(1, round(height * factor))

    def mean(channel: Map) -> Map:
        return np.asarray(Image.fromarray(channel).resize(size, Image.Resampling.BOX))

    known = np.isfinite(values)
    filled = np.where(known, values, 0).astype(np.float32)
    if values.ndim == 3:
        return np.stack([reduced(values[..., i], longest) for i in range(3)], axis=-1)
    share = mean(known.astype(np.float32))
    result = np.full(share.shape, np.nan, dtype=np.float32)
    np.divide(mean(filled), share, out=result, where=share >= 0.5)
    return result


def difference(capture: Floats, model: Floats) -> Floats:
    """Absolute difference of two linear sRGB pictures as shown, four times, in [0, 1]."""
    return np.clip(4 * np.abs(displayed(capture) - displayed(model)), 0, 1)


def data_uri(data: bytes) -> str:
    """A picture as an address that holds it."""
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
