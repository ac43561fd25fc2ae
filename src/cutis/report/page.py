"""The report page: pictures, maps and numbers of one estimate in a single HTML file.

It holds all it shows and asks for nothing from outside, so that it can be sent, archived and
printed. It is complete without scripts. Its template is data/page/report.html; what goes into it
is made here and in `figures.py`.
"""

from collections.abc import Sequence
from importlib import resources
from importlib.metadata import version
from pathlib import Path

from cutis.report import findings, words
from cutis.report.figures import Pictures, colour_figures, map_figures
from cutis.report.numbers import Report
from cutis.textures import replacing


def write_report(
    path: Path,
    report: Report,
    pictures: Pictures,
    title: str,
    notes: Sequence[str] = (),
) -> None:
    """Writes the page `path` for the numbers of an estimate and reduced pictures.

    `pictures` may hold: "capture", "model" and "edited", (H, W, 3) linear sRGB; "error", ΔE00
    (H, W), NaN outside the mask; and the five maps by name, (H, W) in their units, NaN outside the
    mask. Those that are missing are left out. `title` names the input, `notes` are paragraphs for
    the end of the page; both are plain text. Raises CutisError where `path` cannot be written.
    """
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    for make in (words.number, words.percent, words.degrees, words.category, words.with_unit):
        environment.filters[make.__name__] = make
    page = environment.from_string(_data("report.html")).render(
        report=report,
        title=title,
        notes=notes,
        style=Markup(_data("report.css")),
        script=Markup(_data("report.js")),
        colour_figures=colour_figures(report, pictures),
        map_figures=map_figures(report, pictures),
        verdict=findings.verdict(report),
        calibration=list(findings.calibration(report.calibration)),
        findings=list(findings.findings(report)),
        steps=list(findings.next_steps(report, title, f"{Path(title).stem}.skin.exr")),
        levels=words.LEVELS,
        version=version("cutis"),
    )
    with replacing(path) as partial:
        partial.write_text(page, encoding="utf-8")


def _data(name: str) -> str:
    return resources.files("cutis.data").joinpath("page", name).read_text("utf-8")
