"""Pictures of maps for people: colour-mapped PNG with a scale bar.

Previews are for the eye; the numbers are in the EXR.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.figures.layout import COLOUR_MAPS
from cutis.maps import SkinMaps
from cutis.optics import PARAMETERS
from cutis.textures import replacing

LONGEST = 900
"""Texels of the longer side of a preview."""


def reduced(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Every n-th texel, so that the longer side is at most LONGEST."""
    step = max(1, -(-max(values.shape[:2]) // LONGEST))
    return values[::step, ::step]


def write_previews(skin: SkinMaps, stem: Path) -> None:
    """Writes `stem`.<map>.png for the five maps and, with the capture, `stem`.error.png."""
    inside = reduced(skin.mask) > 0
    masked = skin.mask > 0
    for known in PARAMETERS:
        whole = getattr(skin, known.name)
        low, high = np.percentile(whole[masked], [1, 99])
        values = np.where(inside, reduced(whole), np.nan)
        unit = "" if known.unit == "1" else f" [{known.unit}]"
        _figure(
            Path(f"{stem}.{known.name}.png"),
            values,
            f"{known.meaning}{unit}",
            COLOUR_MAPS[known.name],
            (float(low), float(high)),
            known.root,
        )
    if skin.source is not None:
        from cutis.colour import delta_e

        error = delta_e(
            skin.calibration.apply(reduced(skin.model_albedo)),
            skin.calibration.apply(reduced(skin.source)),
        )
        _figure(
            Path(f"{stem}.error.png"),
            np.where(inside, error, np.nan),
            "model against capture [ΔE00]",
            "magma",
            (0.0, 2.0),
        )


def write_colour(path: Path, rgb: NDArray[np.float32]) -> None:
    """Writes linear sRGB (H, W, 3) as a reduced 8-bit sRGB PNG."""
    from matplotlib.image import imsave

    from cutis.colour import encode_srgb

    with replacing(path) as partial:
        imsave(partial, np.clip(encode_srgb(reduced(rgb)), 0, 1))


def _figure(
    path: Path,
    values: NDArray[np.float32],
    label: str,
    colour_map: str,
    limits: tuple[float, float],
    root: int = 1,
) -> None:
    """A colour-mapped picture with its scale bar, even in the `root`-th root of the values."""
    from matplotlib.colors import PowerNorm
    from matplotlib.figure import Figure

    height, width = values.shape
    low, high = limits
    figure = Figure(figsize=(width / 100 + 1.3, height / 100), dpi=100)
    axes = figure.add_axes((0, 0, width / (width + 130), 1))
    axes.set_axis_off()
    axes.set_facecolor("0.5")
    shown = axes.imshow(
        values,
        cmap=colour_map,
        norm=PowerNorm(1 / root, low, max(high, low + 1e-9)),
        interpolation="nearest",
    )
    bar = figure.add_axes(((width + 20) / (width + 130), 0.08, 22 / (width + 130), 0.84))
    figure.colorbar(shown, cax=bar, label=label)
    with replacing(path) as partial:
        figure.savefig(partial, facecolor="white")
