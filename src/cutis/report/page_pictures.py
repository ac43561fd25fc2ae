"""Sections of the report page that hold pictures: colour and the five maps."""

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.optics import PARAMETERS
from cutis.report import page_figures as figures
from cutis.report import page_words as words
from cutis.report import trust_words
from cutis.report.appearance import COLOUR_MAPS, displayed
from cutis.report.page_words import number

Pictures = Mapping[str, NDArray[np.float32]]
GREY = 0.45
"""Of pictures outside the mask, encoded: no colour that could be taken for one of the skin."""


def colour(report: dict[str, Any], pictures: Pictures) -> Iterator[str]:
    """Capture, reconstruction, difference and edited picture, as far as they are there."""
    yield "<section><h2>Colour</h2><p>The reconstruction is what the five maps alone give back."
    yield ' Grey or hatched areas are outside the mask.</p><div class="row">'
    outside = ~np.isfinite(pictures["error"])[..., None] if "error" in pictures else False
    if "capture" in pictures:
        yield _photograph(displayed(pictures["capture"]), "Input", "the capture", "before")
    if "model" in pictures:
        yield _photograph(
            np.where(outside, GREY, displayed(pictures["model"])), "Reconstruction",
            "from the maps, under the light of the capture", "after",
        )  # fmt: skip
    if "capture" in pictures and "model" in pictures:
        difference = figures.difference(pictures["capture"], pictures["model"])
        yield _photograph(
            np.where(outside, GREY, difference), "Difference × 4",
            "absolute, of encoded sRGB; black is none",
        )  # fmt: skip
    if "error" in pictures:
        yield f'<div class="card">{_error(report, pictures["error"])}</div>'
    if "edited" in pictures:
        yield _photograph(displayed(pictures["edited"]), "Edited", "the maps changed", "after")
    yield "</div></section>\n"


def _error(report: dict[str, Any], error: NDArray[np.floating]) -> str:
    """ΔE00 from 0 to what 99 % stay below, 2 at least, so that good ones can be compared."""
    known = error[np.isfinite(error)]
    if not known.size:
        known = np.full(1, np.nan)
    band = tuple(float(v) for v in np.percentile(known, [5, 50, 95]))
    high = np.nan_to_num(np.ceil(np.percentile(known, 99)))
    mean = (report.get("colour") or {}).get("delta_e_mean")
    text = f"as perceived, below 1 hardly visible; mean on skin {number(mean)}"
    scale = figures.Scale(0.0, float(np.clip(high, 2, 20)))
    return _map_figure(
        error, "magma", scale, figures.Histogram.of(error), band,
        "colour difference ΔE00", f"<strong>Colour difference ΔE00</strong>{text}",
    )  # fmt: skip


def maps(report: dict[str, Any], pictures: Pictures) -> Iterator[str]:
    """The five maps with scale and histogram; without one in the report, the picture's."""
    yield "<section><h2>Skin maps</h2>"
    yield (
        "<p>Each bar chart counts texels over the values that its colours stand for. The line is "
        "the median; 90 % of the texels lie in the shaded band.</p>"
        '<div class="row maps">'
    )
    for known in PARAMETERS:
        row = report.get("maps", {}).get(known.name)
        if row is None or known.name not in pictures:
            continue
        level, fixed = words.fixed(report, known.name)
        values = pictures[known.name]
        histogram = figures.Histogram.of(values)
        if row.get("histogram"):
            histogram = figures.Histogram(
                np.asarray(row["histogram"]["edges"], np.float64),
                np.asarray(row["histogram"]["counts"]),
            )
        unit = "" if known.unit == "1" else f" {known.unit}"
        band = (row["p5"], row["median"], row["p95"])
        text = (
            f"{known.meaning}: median {number(band[1])}{unit}, "
            f"90 % within {number(band[0])} to {number(band[2])}{unit}"
        )
        if "sigma" in row:
            text += f"; {trust_words.spread(report['maps'], known.name)} each (median σ)"
        yield f'<article class="card map"><header><h3>{known.name}</h3>'
        yield f'<span class="tag {level}">{fixed}</span></header>'
        yield _map_figure(
            values, COLOUR_MAPS[known.name], figures.scale_of(histogram, known.root), histogram,
            band, f"{known.name} map", text, unit,
        )  # fmt: skip
        yield "</article>"
    yield "</div></section>\n"


def _map_figure(
    values: NDArray[np.floating], colour_map: str, scale: figures.Scale,
    histogram: figures.Histogram, band: tuple[float, ...], what: str, caption: str,
    unit: str = "",
) -> str:  # fmt: skip
    low, middle, high = (f"{number(scale.value(at))}{unit}" for at in (0, 0.5, 1))
    picture, (width, height) = figures.coloured(values, colour_map, scale)
    levels = np.array([[scale.value(at) for at in np.linspace(0, 1, figures.LEVELS)]])
    strip, _ = figures.coloured(levels, colour_map, scale)
    bars = figures.histogram_svg(
        histogram, scale, band, escape(f"Histogram of {what} from {low} to {high}")
    )
    return (
        f'<figure><img class="picture hatched" alt="{escape(what)}" width="{width}" '
        f'height="{height}" src="{figures.data_uri(picture)}">{bars}'
        f'<img class="strip" alt="" src="{figures.data_uri(strip)}">'
        f'<div class="ticks"><span>{low}</span><span>{middle}</span><span>{high}</span></div>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _photograph(shown: NDArray[np.floating], name: str, text: str, side: str = "") -> str:
    data, (width, height) = figures.photograph(shown)
    compare = f' data-compare="{side}"' if side else ""
    return (
        f'<figure class="card"><img class="picture"{compare} alt="{name}: {text}" '
        f'width="{width}" height="{height}" src="{figures.data_uri(data)}">'
        f"<figcaption><strong>{name}</strong>{text}</figcaption></figure>"
    )
