"""The report page: pictures, maps and numbers of one estimate in a single HTML file.

It holds all it shows and asks for nothing from outside, so that it can be sent, archived and
printed. It is complete without scripts.
"""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.apps import page_figures as figures
from cutis.apps import page_words as words
from cutis.apps.page_words import number, percent
from cutis.figures.layout import COLOUR_MAPS, displayed
from cutis.optics import NAMES, PARAMETERS
from cutis.textures import replacing

Pictures = Mapping[str, NDArray[np.float32]]
POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
"""What the page may do: show what it holds."""


def write_report(
    path: Path, report: dict[str, Any], pictures: Pictures, title: str, notes: Sequence[str] = ()
) -> None:
    """Writes the page `path` for the numbers of `maps.report` and reduced pictures.

    `pictures` may hold: "capture", "model" and "edited", (H, W, 3) linear sRGB; "error", ΔE00
    (H, W), NaN outside the mask; and the five maps by name, (H, W) in their units, NaN outside the
    mask. Those that are missing are left out. `title` names the input, `notes` are paragraphs for
    the end of the page; both are plain text. Raises CutisError where `path` cannot be written.
    """
    style, script = (_data(f"report.{kind}") for kind in ("css", "js"))
    sections = (
        _head(report, title), _colour(report, pictures), _edit(pictures), _maps(report, pictures),
        _numbers(report), _regions(report), _calibration(report), _trust(report), _foot(notes),
    )  # fmt: skip
    page = f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{escape(title)} – skin report</title>
<style>
{style}</style>
</head>
<body>
{"".join("".join(section) for section in sections)}
<script>
{script}</script>
</body>
</html>
"""
    with replacing(path) as partial:
        partial.write_text(page, encoding="utf-8")


def _data(name: str) -> str:
    return resources.files("cutis.data").joinpath("page", name).read_text("utf-8")


def _head(report: dict[str, Any], title: str) -> Iterator[str]:
    colour = report.get("colour") or {}
    ita = colour.get("ita_median")
    tiles = [
        ("mean ΔE00, model against capture", number(colour.get("delta_e_mean"))),
        ("ΔE00 that 95 % of the skin stay below", number(colour.get("delta_e_p95"))),
        ("of the skin out of gamut (ΔE00 > 1)", percent(colour.get("out_of_gamut"))),
        (f"ITA, median: {words.category(ita)}", "–" if ita is None else f"{number(ita)}°"),
        ("skin texels", _count(report.get("skin_texels"))),
    ]
    facts = []
    if "size" in report:
        height, width = report["size"]
        facts.append(f"{width} × {height} texels")
    if "masked_texels" in report:
        facts.append(f"{report['masked_texels']:,} inside the mask")
    if "colorspace" in report:
        facts.append(f"colour taken as {escape(str(report['colorspace']))}")
    if "model" in report:
        facts.append(f"model {escape(str(report['model']))}")
    yield f'<header><p class="kicker">Skin report</p><h1>{escape(title)}</h1>'
    yield f'<p class="quiet">{" · ".join(facts)}</p></header>\n<main>\n'
    yield f'<p class="verdict">{escape(words.verdict(report))}</p>\n<dl class="tiles">'
    yield "".join(f"<div><dt>{what}</dt><dd>{value}</dd></div>" for what, value in tiles)
    yield "</dl>\n"


def _colour(report: dict[str, Any], pictures: Pictures) -> Iterator[str]:
    yield "<section><h2>Colour</h2><p>The reconstruction is what the five maps alone give back.</p>"
    yield '<div class="row">'
    if "capture" in pictures:
        yield _photograph(displayed(pictures["capture"]), "Input", "the capture", "before")
    if "model" in pictures:
        side = "" if "edited" in pictures else "after"
        yield _photograph(
            displayed(pictures["model"]), "Reconstruction", "maps and calibration only", side
        )
    if "capture" in pictures and "model" in pictures:
        error = figures.difference(pictures["capture"], pictures["model"])
        yield _photograph(error, "Difference × 4", "absolute, of encoded sRGB; black is none")
    if "error" in pictures:
        colour = report.get("colour") or {}
        error = pictures["error"]
        known = error[np.isfinite(error)]
        high = float(np.ceil(np.percentile(known, 99))) if known.size else 2.0
        middle = float(np.median(known)) if known.size else np.nan
        low, top = np.percentile(known, [5, 95]) if known.size else (np.nan, np.nan)
        scale = figures.Scale(0.0, min(max(high, 2.0), 20.0))
        text = f"ΔE00, mean {number(colour.get('delta_e_mean'))} on skin; hatched: no mask"
        yield '<div class="card">'
        yield _map_figure(
            error, "magma", scale, figures.Histogram.of(error), (float(low), middle, float(top)),
            "colour difference ΔE00", f"<strong>Visible difference</strong>{text}",
        )  # fmt: skip
        yield "</div>"
    yield "</div>"
    if {"capture", "model"} <= set(pictures) and "edited" not in pictures:
        yield '<div id="compare" data-before="Input" data-after="Reconstruction"></div>'
    yield "</section>\n"


def _edit(pictures: Pictures) -> Iterator[str]:
    if "edited" not in pictures:
        return
    yield '<section><h2>Edit</h2><div class="row">'
    yield _photograph(displayed(pictures["edited"]), "Edited", "the maps changed", "after")
    yield '<div id="compare" data-before="Input" data-after="Edited"></div></div></section>\n'


def _maps(report: dict[str, Any], pictures: Pictures) -> Iterator[str]:
    yield "<section><h2>Skin maps</h2>"
    yield (
        "<p>Each bar chart counts texels over the values that its colours stand for. The line is "
        "the median; 90 % of the texels lie in the shaded band. Hatched areas are outside the "
        'mask.</p><div class="row maps">'
    )
    for known in PARAMETERS:
        row = report.get("maps", {}).get(known.name)
        if row is None or known.name not in pictures:
            continue
        level, fixed = words.FIXED[known.name]
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
    histogram: figures.Histogram, band: tuple[float, float, float], what: str, caption: str,
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


def _numbers(report: dict[str, Any]) -> Iterator[str]:
    clamped, rough = report.get("clamped") or {}, report.get("smoothness") or {}
    head = ["map", "unit", "5 %", "median", "95 %"]
    head += ["at an end of its range"] if clamped else []
    head += ["roughness"] if rough else []
    rows = []
    for name, row in report.get("maps", {}).items():
        cells = [name, row["unit"], *(number(row[key]) for key in ("p5", "median", "p95"))]
        cells += [percent(clamped.get(name))] if clamped else []
        cells += [number(rough.get(name))] if rough else []
        rows.append(cells)
    yield "<section><h2>Numbers</h2>"
    yield _table("Maps inside the mask", head, rows)
    if rough:
        yield (
            '<p class="quiet">Roughness: mean difference of neighbouring texels, on the even '
            "scale of each map, over that of the capture. Much above 1, a map is noisier than the "
            "capture it comes from.</p>"
        )
    colour = report.get("colour")
    if colour is not None:
        yield (
            f'<p class="quiet">Colour errors are of {report["skin_texels"]:,} skin texels inside '
            f"the mask (L* &gt; 35, C*ab &gt; 12): ΔE00 mean {number(colour['delta_e_mean'])}, 95 "
            f"% {number(colour['delta_e_p95'])}; mean squared error {number(colour['mse'])} in "
            f"linear RGB; out of gamut {percent(colour['out_of_gamut'])}.</p>"
        )
    yield "</section>\n"


def _regions(report: dict[str, Any]) -> Iterator[str]:
    regions = report.get("regions")
    if not regions:
        return
    names = [name for name in NAMES if any(name in region["maps"] for region in regions)]
    units = [f"{p.name} [{p.unit}]" if p.unit != "1" else p.name for p in PARAMETERS
             if p.name in names]  # fmt: skip
    rows = []
    for region in regions:
        ita = region.get("ita_median")
        angle = "–" if ita is None else f"{number(ita)}°<small>{words.category(ita)}</small>"
        cells = [escape(str(region["name"])), _count(region.get("texels")), angle,
                 number(region.get("delta_e_mean"))]  # fmt: skip
        for name in names:
            row = region["maps"].get(name) or {}
            low, median, high = (number(row.get(key)) for key in ("p5", "median", "p95"))
            cells.append(f"{median}<small>{low} – {high}</small>")
        rows.append(cells)
    yield "<section><h2>Regions</h2>"
    caption = "Median of each map, and below it the range of 90 % of the region's texels"
    yield _table(caption, ["region", "texels", "ITA", "mean ΔE00", *units], rows)
    yield "</section>\n"


def _calibration(report: dict[str, Any]) -> Iterator[str]:
    found = report.get("calibration")
    if found is None:
        return
    yield "<section><h2>Calibration</h2>"
    gains = [f"{gain:.3f}" for gain in found["gains"]]
    yield _table("Gains on linear RGB", ["", "red", "green", "blue"], [["gain", *gains]])
    yield "".join(f"<p>{escape(text)}</p>" for text in words.calibration(found))
    yield "</section>\n"


def _trust(report: dict[str, Any]) -> Iterator[str]:
    yield '<section><h2>What the maps can be trusted for</h2><ul class="findings">'
    for level, text in words.findings(report):
        yield f'<li class="{level}"><span class="tag">{words.LEVELS[level]}</span>'
        yield f"<p>{escape(text)}</p></li>"
    yield "</ul><p>Not a medical device: these maps are no ground for a diagnosis.</p></section>\n"


def _foot(notes: Sequence[str]) -> Iterator[str]:
    import cutis

    yield "</main>\n<footer>" + "".join(f"<p>{escape(note)}</p>" for note in notes)
    yield f"<p>Made by cutis {escape(cutis.__version__)}.</p></footer>"


def _table(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table that scrolls inside its box; cells are safe HTML, the first of a row heads it."""
    top = "".join(f'<th scope="col">{cell}</th>' if cell else "<td></td>" for cell in head)
    body = "".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in rest)}</tr>'
        for first, *rest in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{caption}"><table>'
        f"<caption>{caption}</caption><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
        "</div>"
    )


def _count(value: int | None) -> str:
    return "–" if value is None else f"{value:,}"
