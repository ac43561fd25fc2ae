"""Small pictures of textures and maps for notebooks."""

import base64
import io
from html import escape

import numpy as np
from numpy.typing import NDArray

from cutis.colour.transfer import encode_srgb

LONGEST = 256
"""Pixels of the longer side of a thumbnail."""


def picture_html(linear: NDArray[np.floating], caption: str) -> str:
    """An (H, W, 3) linear sRGB picture, every n-th texel, as an image in HTML with a caption."""
    from PIL import Image

    step = max(1, -(-max(linear.shape[:2]) // LONGEST))
    shown = np.clip(encode_srgb(np.nan_to_num(linear[::step, ::step])), 0, 1)
    data = io.BytesIO()
    Image.fromarray(np.rint(255 * shown).astype(np.uint8)).save(data, "PNG")
    address = base64.b64encode(data.getvalue()).decode()
    return (
        f'<figure style="margin:0"><img alt="{escape(caption)}" '
        f'src="data:image/png;base64,{address}"><figcaption>{escape(caption)}</figcaption></figure>'
    )
