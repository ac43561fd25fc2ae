"""What the report page shows: photographs, and maps with their colour scale and histogram."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cutis.arrays import Floats, Map
from cutis.optics import PARAMETERS
from cutis.report import findings, trust_words
from cutis.report.appearance import COLOUR_MAPS, ERRORS, displayed
from cutis.report.numbers import Bars, Report
from cutis.report.pictures import LEVELS, coloured, data_uri, difference, photograph
from cutis.report.scale import Scale, bars_of, scale_of
from cutis.report.words import number, percent, with_unit

Pictures = Mapping[str, Map]
"""Reduced pictures by name; see `page.write_report`."""
GREY = 0.45
"""Of pictures outside the mask, encoded: no colour that could be taken for one of the skin."""
BLACK = 12 / 255
"""Encoded value below which a picture is black to the eye."""
MOSTLY = 0.95
"""Share of a difference picture that is black from which it says why."""
WIDTH, HEIGHT = 256, 64
"""Of a histogram, in units of its drawing."""


@dataclass(frozen=True)
class Picture:
    """A picture as a page holds it: an address with all its bytes, and its size in pixels."""

    uri: str
    width: int
    height: int

    @classmethod
    def of(cls, made: tuple[bytes, tuple[int, int]]) -> "Picture":
        """That of encoded bytes and a size."""
        data, (width, height) = made
        return cls(data_uri(data), width, height)


@dataclass(frozen=True)
class Photograph:
    """A picture with its name and a sentence; pictures of `side` can be compared with others."""

    picture: Picture
    name: str
    text: str
    side: str = ""


@dataclass(frozen=True)
class MapFigure:
    """A map, the strip of its colours with three numbers, and its histogram as paths of SVG.

    `level` and `tag` say how far it is known, where that is to be said.
    """

    picture: Picture
    strip: Picture
    name: str
    what: str
    text: str
    ticks: tuple[str, str, str]
    bars: str
    band: tuple[float, float] | None
    median: float
    level: str = ""
    tag: str = ""


def colour_figures(report: Report, pictures: Pictures) -> list[Photograph | MapFigure]:
    """Capture, reconstruction, difference, ΔE00 and edited picture, as far as they are there."""
    outside = np.zeros((1, 1, 1), dtype=bool)
    if "error" in pictures:
        outside = ~np.isfinite(pictures["error"])[..., None]

    def photo(rgb: Floats, name: str, text: str, side: str = "") -> Photograph:
        return Photograph(Picture.of(photograph(rgb)), name, text, side)

    found: list[Photograph | MapFigure] = []
    if "capture" in pictures:
        found.append(photo(displayed(pictures["capture"]), "Input", "the capture", "before"))
    if "model" in pictures:
        model = np.where(outside, GREY, displayed(pictures["model"]))
        text = "from the maps, under the light of the capture"
        found.append(photo(model, "Reconstruction", text, "after"))
    if "capture" in pictures and "model" in pictures:
        apart = difference(pictures["capture"], pictures["model"])
        black = (apart.max(axis=2) < BLACK)[np.broadcast_to(~outside, apart.shape)[..., 0]]
        share = float(black.mean()) if black.size else 0.0
        text = "absolute, of encoded sRGB; black is none"
        if share > MOSTLY:
            text = (
                f"black on {percent(share)}: there the maps give each colour back to within "
                f"{255 * BLACK / 4:.0f} of 255 steps"
            )
        found.append(photo(np.where(outside, GREY, apart), "Difference × 4", text))
    if "error" in pictures:
        found.append(_error(report, pictures["error"]))
    if "edited" in pictures:
        found.append(photo(displayed(pictures["edited"]), "Edited", "the maps changed", "after"))
    return found


def map_figures(report: Report, pictures: Pictures) -> list[MapFigure]:
    """The five maps with scale and histogram; without one in the report, the picture's."""
    found = []
    for known in PARAMETERS:
        row = report.maps.get(known.name)
        if row is None or known.name not in pictures:
            continue
        values = pictures[known.name]
        bars = row.histogram or bars_of(values)
        text = (
            f"{known.meaning}: median {with_unit(number(row.median), known.unit)}, "
            f"90 % within {number(row.p5)} to {with_unit(number(row.p95), known.unit)}"
        )
        if row.sigma is not None:
            text += f"; {trust_words.spread(report.maps, known.name)} each (median σ)"
        figure = _map_figure(
            values, COLOUR_MAPS[known.name], scale_of(bars, known.root), bars,
            (row.p5, row.median, row.p95), known.name, f"{known.name} map", text, known.unit,
            findings.fixed(report, known.name),
        )  # fmt: skip
        found.append(figure)
    return found


def _error(report: Report, error: Floats) -> MapFigure:
    """ΔE00 from 0 to what 99 % stay below, 2 at least, so that good ones can be compared."""
    known = error[np.isfinite(error)]
    if not known.size:
        known = np.full(1, np.nan)
    low, median, high, highest = (float(v) for v in np.percentile(known, [5, 50, 95, 99]))
    mean = None if report.colour is None else report.colour.delta_e_mean
    scale = Scale(0.0, float(np.clip(np.nan_to_num(np.ceil(highest)), 2, 20)))
    name = "Colour difference ΔE00"
    text = f"as perceived, below 1 hardly visible; mean on skin {number(mean)}"
    return _map_figure(
        error, ERRORS, scale, bars_of(error), (low, median, high), name, name, text
    )  # fmt: skip


def _map_figure(
    values: Floats, colours: str, scale: Scale, bars: Bars,
    band: tuple[float, float, float], name: str, what: str, text: str, unit: str = "",
    known: tuple[str, str] = ("", ""),
) -> MapFigure:  # fmt: skip
    low, middle, high = (with_unit(number(scale.value(at)), unit) for at in (0, 0.5, 1))
    levels = np.array([[scale.value(at) for at in np.linspace(0, 1, LEVELS)]])
    first, median, last = (float(v) for v in WIDTH * scale.place(band))
    shown = np.isfinite(band).all()
    return MapFigure(
        picture=Picture.of(coloured(values, colours, scale)),
        strip=Picture.of(coloured(levels, colours, scale)),
        name=name, what=what, text=text, ticks=(low, middle, high),
        bars=bar_path(bars, scale), band=(first, last) if shown else None, median=median,
        level=known[0], tag=known[1],
    )  # fmt: skip


def bar_path(bars: Bars, scale: Scale) -> str:
    """A histogram over `scale` as a path of SVG, WIDTH × HEIGHT.

    Areas are texels, also where bars differ in width.
    """
    x = WIDTH * scale.place(np.maximum(bars.edges, 0))
    width = np.diff(x)
    shown = width > 1e-9
    density = np.divide(bars.counts, width, out=np.zeros(len(width)), where=shown)
    y = HEIGHT - (HEIGHT - 2) * density / max(float(density.max(initial=0)), 1e-300)
    steps = "".join(
        f"V{top:.1f}H{right:.1f}" for top, right in zip(y[shown], x[1:][shown], strict=True)
    )
    return f"M{x[0]:.1f} {HEIGHT}{steps}V{HEIGHT}Z"
