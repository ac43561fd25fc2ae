"""Drawings that figures share: grids of pictures, maps with their scale, curves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.floating] | tuple[NDArray[np.floating], str, float, float]


def grid(
    rows: Sequence[Sequence[Picture]],
    row_labels: Sequence[str],
    column_labels: Sequence[str],
    cell: float = 1.35,
) -> Any:
    """A matplotlib figure of pictures in rows and columns.

    All cells of a row are as high as its first picture asks.

    A picture is (H, W, 3), ready to be shown, or a map as (values, colour map, low, high).
    """
    from matplotlib.figure import Figure

    shapes = [_pixels(row[0]).shape for row in rows]
    heights = [cell * shape[0] / shape[1] for shape in shapes]
    margin, top = 0.3, 0.3
    columns = max(len(row) for row in rows)
    width, height = margin + columns * cell, top + sum(heights)
    figure = Figure(figsize=(width, height), dpi=150)
    y = height - top
    for row, label, tall in zip(rows, row_labels, heights, strict=True):
        y -= tall
        figure.text(
            0.6 * margin / width, (y + tall / 2) / height, label,
            rotation=90, ha="center", va="center", fontsize=7,
        )  # fmt: skip
        for column, picture in enumerate(row):
            place = (margin + column * cell, y, 0.98 * cell, 0.98 * tall)
            axes = figure.add_axes(
                (place[0] / width, place[1] / height, place[2] / width, place[3] / height)
            )
            axes.set_axis_off()
            if isinstance(picture, tuple):
                values, colours, low, high = picture
                axes.imshow(
                    values, cmap=colours, vmin=low, vmax=high, interpolation="nearest",
                    aspect="auto",
                )  # fmt: skip
            else:
                axes.imshow(picture, interpolation="nearest", aspect="auto")
    for column, label in enumerate(column_labels):
        x = (margin + (column + 0.49) * cell) / width
        figure.text(x, 1 - 0.5 * top / height, label, ha="center", va="center", fontsize=7)
    return figure


def magnified(error: NDArray[np.floating], factor: float = 4.0) -> NDArray[np.floating]:
    """An absolute difference of linear colours, `factor` times, as a picture."""
    return np.clip(factor * np.abs(error), 0, 1)


def curves(
    panels: Sequence[tuple[str, NDArray[np.floating], Sequence[Any]]],
    ylabel: str,
    band: tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating], str]
    | None = None,
) -> Any:
    """A matplotlib figure of panels (title, x, [(y, colour, label), …]), a grey band behind."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * len(panels), 3.2), dpi=150, layout="constrained")
    for axes, (title, x, lines) in zip(
        figure.subplots(1, len(panels), sharey=True, squeeze=False)[0], panels, strict=True
    ):
        if band is not None:
            axes.fill_between(*band[:3], color="0.86", label=band[3])
        for y, colour, label in lines:
            axes.plot(x, y, color=colour, label=label, linewidth=1.8)
        axes.set(title=title, xlabel="wavelength [nm]", xlim=(x[0], x[-1]), ylim=(0, None))
        if any(label for *_, label in lines):
            axes.legend(fontsize=6, loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    figure.axes[0].set_ylabel(ylabel)
    return figure


def _pixels(picture: Picture) -> NDArray[np.floating]:
    return picture[0] if isinstance(picture, tuple) else picture
