"""Pictures of the report page: photographs, maps with their colour scale, histograms.

All of it ends up inside the page, so sizes are bounded: ten pictures stay below 3 MB of HTML.
"""

import base64
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.report.appearance import displayed

PHOTOGRAPH = 900
"""Pixels of the longer side of a photograph, at most."""
MAP = 512
"""The same of a map."""
BYTES = 200_000
"""What one picture may take; larger ones are reduced further."""
LEVELS = 95
"""Colours of a map, besides that of texels outside the mask, which is none."""
TAILS = 0.005
"""Share of texels beyond each end of a colour scale, at most."""


@dataclass(frozen=True)
class Histogram:
    """`edges` (n + 1) in the unit of a map, rising, and `counts` (n) of texels between them."""

    edges: NDArray[np.float64]
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, values: NDArray[np.floating], bins: int = 64) -> "Histogram":
        """That of the finite among `values`, its outermost thousandths left out."""
        finite = values[np.isfinite(values)]
        ends = np.percentile(finite, [0.1, 99.9]) if finite.size else (0.0, 1.0)
        counts, edges = np.histogram(finite, bins, range=(float(ends[0]), float(ends[1])))
        return cls(edges, counts)


@dataclass(frozen=True)
class Scale:
    """A colour scale from `low` to `high`, even in the `root`-th root of the values."""

    low: float
    high: float
    root: int = 1

    def place(self, values: ArrayLike) -> NDArray[np.float64]:
        """Values → where they lie on the scale, [0, 1]; NaN stays."""
        rooted = np.clip(np.asarray(values, np.float64), self.low, self.high) ** (1 / self.root)
        low, high = self.low ** (1 / self.root), self.high ** (1 / self.root)
        return (rooted - low) / (high - low)

    def value(self, place: float) -> float:
        """The value at a place of the scale."""
        low, high = self.low ** (1 / self.root), self.high ** (1 / self.root)
        return float((low + place * (high - low)) ** self.root)


def scale_of(histogram: Histogram, root: int = 1) -> Scale:
    """A scale over all bins but the emptiest at both ends, TAILS of the texels each."""
    below = np.cumsum(histogram.counts)
    if not below.size or below[-1] == 0:
        return Scale(0.0, 1.0, root)
    first = int(np.searchsorted(below, TAILS * below[-1], side="right"))
    last = int(np.searchsorted(below, (1 - TAILS) * below[-1]))
    low, high = (max(float(e), 0.0) for e in (histogram.edges[first], histogram.edges[last + 1]))
    return Scale(low, max(high, low + 1e-6 * max(low, 1.0)), root)


def photograph(rgb: NDArray[np.floating]) -> tuple[bytes, tuple[int, int]]:
    """(H, W, 3) in [0, 1], encoded as shown → a JPEG and its width and height."""
    from PIL import Image

    longest = PHOTOGRAPH
    while True:
        picture = Image.fromarray(np.uint8(np.rint(255 * np.nan_to_num(reduced(rgb, longest)))))
        data = io.BytesIO()
        picture.save(data, "JPEG", quality=88, optimize=True)
        if data.tell() <= BYTES or longest <= 64:
            return data.getvalue(), picture.size
        longest = longest * 4 // 5


def coloured(
    values: NDArray[np.floating], colour_map: str, scale: Scale
) -> tuple[bytes, tuple[int, int]]:
    """A map (H, W), NaN outside the mask → a PNG, transparent there, and its width and height."""
    from matplotlib import colormaps
    from PIL import Image

    shown = reduced(values, MAP)
    place = np.nan_to_num(scale.place(shown))
    index = np.where(np.isfinite(shown), 1 + np.rint((LEVELS - 1) * place), 0)
    colours = colormaps[colour_map](np.linspace(0, 1, LEVELS))[:, :3]
    picture = Image.fromarray(index.astype(np.uint8))
    picture.putpalette([0, 0, 0, *(int(c) for c in np.rint(255 * colours).ravel())])
    data = io.BytesIO()
    picture.save(data, "PNG", transparency=0, optimize=True)
    return data.getvalue(), picture.size


def reduced(values: NDArray[np.floating], longest: int) -> NDArray[np.float32]:
    """(H, W[, 3]) → the mean over what is known of each pixel, longer side at most `longest`.

    A pixel most of which is not known (not finite) is NaN.
    """
    from PIL import Image

    height, width = values.shape[:2]
    factor = min(1.0, longest / max(height, width))
    size = max(1, round(width * factor)), max(1, round(height * factor))

    def mean(channel: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.asarray(Image.fromarray(channel).resize(size, Image.Resampling.BOX))

    known = np.isfinite(values)
    filled = np.where(known, values, 0).astype(np.float32)
    if values.ndim == 3:
        return np.stack([reduced(values[..., i], longest) for i in range(3)], axis=-1)
    share = mean(known.astype(np.float32))
    result = np.full(share.shape, np.nan, dtype=np.float32)
    np.divide(mean(filled), share, out=result, where=share >= 0.5)
    return result


def difference(capture: NDArray[np.floating], model: NDArray[np.floating]) -> NDArray[np.floating]:
    """Absolute difference of two linear sRGB pictures as shown, four times, in [0, 1]."""
    return np.clip(4 * np.abs(displayed(capture) - displayed(model)), 0, 1)


def data_uri(data: bytes) -> str:
    """A picture as an address that holds it."""
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def histogram_svg(histogram: Histogram, scale: Scale, band: tuple[float, ...], words: str) -> str:
    """A histogram over `scale` as inline SVG, 256 × 64.

    `band` is where 90 % of texels lie and the median: (low, median, high). Areas are texels, also
    where bins differ in width. `words`, safe in HTML, say what is drawn.
    """
    x = 256 * scale.place(np.maximum(histogram.edges, 0))
    width = np.diff(x)
    shown = width > 1e-9
    density = np.divide(histogram.counts, width, out=np.zeros(len(width)), where=shown)
    y = 64 - 62 * density / max(float(density.max(initial=0)), 1e-300)
    steps = "".join(
        f"V{top:.1f}H{right:.1f}"
        for top, right in zip(y[shown], x[1:][shown], strict=True)
    )  # fmt: skip
    under = over = ""
    if np.isfinite(band).all():
        low, median, high = 256 * scale.place(band)
        under = f'<rect x="{low:.1f}" width="{high - low:.1f}" y="0" height="64"/>'
        over = f'<line x1="{median:.1f}" x2="{median:.1f}" y1="0" y2="64"/>'
    return (
        f'<svg class="histogram" viewBox="0 0 256 64" preserveAspectRatio="none" role="img" '
        f'aria-label="{words}">{under}<path d="M{x[0]:.1f} 64{steps}V64Z"/>{over}</svg>'
    )
