"""Sections of the report page that are tables: the maps in numbers, and regions."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

from cutis.optics import NAMES, PARAMETERS
from cutis.report import page_words as words
from cutis.report.page_words import number, percent


def numbers(report: dict[str, Any]) -> Iterator[str]:
    """The maps inside the mask, and the colour errors."""
    clamped, rough = report.get("clamped") or {}, report.get("smoothness") or {}
    head = ["map", "unit", "5 %", "median", "95 %"]
    spread = any("sigma" in row for row in report.get("maps", {}).values())
    head += ["σ, median", "informed"] if spread else []
    head += ["at an end of its range"] if clamped else []
    head += ["roughness"] if rough else []
    rows = []
    for name, row in report.get("maps", {}).items():
        cells = [name, row["unit"], *(number(row[key]) for key in ("p5", "median", "p95"))]
        cells += [number(row.get("sigma")), percent(row.get("informed"))] if spread else []
        cells += [percent(clamped.get(name))] if clamped else []
        cells += [number(rough.get(name))] if rough else []
        rows.append(cells)
    yield "<section><h2>Numbers</h2>"
    yield table("Maps inside the mask", head, rows)
    if spread:
        yield (
            '<p class="quiet">Informed: by how much the colours of this capture narrow the spread '
            "that such skins have in general, on the even scale of each map.</p>"
        )
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
            "the mask (L* &gt; 35, C*ab &gt; 12), the model alone against the calibrated capture: "
            f"ΔE00 mean {number(colour['delta_e_mean'])}, 95&nbsp;% "
            f"{number(colour['delta_e_p95'])}; mean squared error {number(colour['mse'])} in "
            f"linear RGB; out of gamut (ΔE00 &gt; 1) {percent(colour['out_of_gamut'])}. ITA, "
            f"median {words.degrees(colour['ita_median'])}, moves with exposure too.</p>"
        )
    yield "</section>\n"


def regions(report: dict[str, Any]) -> Iterator[str]:
    """The regions of a region mask, where one was given."""
    regions = report.get("regions")
    if not regions:
        return
    names = [name for name in NAMES if any(name in region["maps"] for region in regions)]
    units = [f"{p.name} [{p.unit}]" if p.unit != "1" else p.name for p in PARAMETERS
             if p.name in names]  # fmt: skip
    rows = []
    for region in regions:
        ita = region.get("ita_median")
        angle = f"{words.degrees(ita)}<small>{words.category(ita)}</small>"
        cells = [escape(str(region["name"])), count(region.get("texels")), angle,
                 number(region.get("delta_e_mean"))]  # fmt: skip
        for name in names:
            row = region["maps"].get(name) or {}
            low, median, high = (number(row.get(key)) for key in ("p5", "median", "p95"))
            cells.append(f"{median}<small>{low} – {high}</small>")
        rows.append(cells)
    yield "<section><h2>Regions</h2>"
    caption = "Median of each map, and below it the range of 90 % of the region's texels"
    yield table(caption, ["region", "texels", "ITA", "mean ΔE00", *units], rows)
    yield "</section>\n"


def table(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table that scrolls inside its box; cells are safe HTML, the first of a row heads it."""
    top = "".join(f'<th scope="col">{cell}</th>' for cell in head)
    body = "".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in rest)}</tr>'
        for first, *rest in rows
    )
    return (
        f'<p class="quiet">{caption}.</p><div class="scroll" tabindex="0" role="group" '
        f'aria-label="{caption}"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>'
        "</div>"
    )


def count(value: int | None) -> str:
    """A number of texels; a dash where there is none."""
    return "–" if value is None else f"{value:,}"
