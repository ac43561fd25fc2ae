"""The report page: pictures, maps and numbers of one estimate in a single HTML file.

It holds all it shows and asks for nothing from outside, so that it can be sent, archived and
printed. It is complete without scripts.
"""

from collections.abc import Iterator, Sequence
from html import escape
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import Any

from cutis.report import page_pictures, page_tables
from cutis.report import page_words as words
from cutis.report.page_words import number, percent
from cutis.textures import replacing

POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
"""What the page may do: show what it holds."""


def write_report(
    path: Path,
    report: dict[str, Any],
    pictures: page_pictures.Pictures,
    title: str,
    notes: Sequence[str] = (),
) -> None:
    """Writes the page `path` for the numbers of `maps.report` and reduced pictures.

    `pictures` may hold: "capture", "model" and "edited", (H, W, 3) linear sRGB; "error", ΔE00
    (H, W), NaN outside the mask; and the five maps by name, (H, W) in their units, NaN outside the
    mask. Those that are missing are left out. `title` names the input, `notes` are paragraphs for
    the end of the page; both are plain text. Raises CutisError where `path` cannot be written.
    """
    style, script = (_data(f"report.{kind}") for kind in ("css", "js"))
    sections = (
        _head(report, title), page_pictures.colour(report, pictures),
        page_pictures.maps(report, pictures), page_tables.numbers(report),
        page_tables.regions(report), _calibration(report), _trust(report), _foot(notes),
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
        (f"ITA, median: {words.category(ita)}", words.degrees(ita)),
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


def _calibration(report: dict[str, Any]) -> Iterator[str]:
    found = report.get("calibration")
    if found is None:
        return
    yield "<section><h2>Calibration</h2>"
    gains = zip(("red", "green", "blue"), found["gains"], strict=True)
    yield '<dl class="tiles gains">'
    yield "".join(f"<div><dt>{c} gain</dt><dd>{gain:.3f}</dd></div>" for c, gain in gains)
    yield "</dl>"
    yield "".join(f"<p>{escape(text)}</p>" for text in words.calibration(found))
    yield "</section>\n"


def _trust(report: dict[str, Any]) -> Iterator[str]:
    yield '<section><h2>What the maps can be trusted for</h2><ul class="findings">'
    for level, text in words.findings(report):
        yield f'<li class="{level}"><span class="tag">{words.LEVELS[level]}</span>'
        yield f"<p>{escape(text)}</p></li>"
    yield "</ul><p>Not a medical device: these maps are no ground for a diagnosis.</p></section>\n"


def _foot(notes: Sequence[str]) -> Iterator[str]:
    yield "</main>\n<footer>" + "".join(f"<p>{escape(note)}</p>" for note in notes)
    yield f"<p>Made by cutis {version('cutis')}.</p></footer>"
