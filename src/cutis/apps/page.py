"""One page that shows a result: capture, model, edit, maps and numbers, in a single HTML file."""

import base64
import html
from pathlib import Path
from typing import Any

from cutis.optics import PARAMETERS
from cutis.textures import replacing

STYLE = """
body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem;
color:#222;background:#fff}
.row{display:grid;grid-template-columns:repeat(auto-fit,minmax(15rem,1fr));gap:1rem}
figure{margin:0}img{width:100%;height:auto;border-radius:4px}figcaption{color:#444}
table{border-collapse:collapse}td,th{padding:.2rem .9rem;text-align:right}
td:first-child,th:first-child{text-align:left}
"""


def write_page(path: Path, stem: Path, results: dict[str, Any], credit: str) -> None:
    """Writes `path` from the previews that lie under `stem` and the numbers of a report."""
    colours = [("source", "capture"), ("model", "what the model alone gives"),
               ("tanned", "tanned: melanin +40 %, all pheomelanin")]  # fmt: skip
    pictures = [_figure(Path(f"{stem}.{name}.preview.png"), text) for name, text in colours]
    pictures.append(_figure(Path(f"{stem}.error.png"), "error of the model"))
    maps = [_figure(Path(f"{stem}.{p.name}.png"), f"{p.name}: {p.meaning}") for p in PARAMETERS]
    rows = "".join(
        f"<tr><td>{name}</td><td>{row['unit']}</td>"
        + "".join(f"<td>{row[key]:.4g}</td>" for key in ("p5", "median", "p95"))
        + "</tr>"
        for name, row in results["maps"].items()
    )
    colour = results.get("colour")
    error = (
        "No texel inside the mask has the colour of skin."
        if colour is None
        else f"Model alone against capture on {results['skin_texels']:,} skin texels: ΔE00 mean "
        f"{colour['delta_e_mean']:.3f}, 95 % {colour['delta_e_p95']:.3f}; out of gamut "
        f"{100 * colour['out_of_gamut']:.2f} %."
    )
    gains = ", ".join(f"{gain:.3f}" for gain in results["calibration"]["gains"])
    body = f"""<h1>From a face to its skin and back</h1>
<div class="row">{"".join(pictures)}</div>
<h2>Maps</h2><div class="row">{"".join(maps)}</div>
<h2>Numbers</h2>
<table><tr><th>map</th><th>unit</th><th>5 %</th><th>median</th><th>95 %</th></tr>{rows}</table>
<p>{error} Gains found for red, green, blue: {gains}.</p>
<p>RGB fixes melanin and blood well; thickness, melanin type and oxygenation are probable values,
not measurements. Not a medical device.</p><p><small>{html.escape(credit)}</small></p>"""
    page = (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width"><title>cutis</title>'
        f"<style>{STYLE}</style><body>{body}</body></html>\n"
    )
    with replacing(path) as partial:
        partial.write_text(page, encoding="utf-8")


def _figure(path: Path, caption: str) -> str:
    data = base64.b64encode(path.read_bytes()).decode()
    text = html.escape(caption)
    return (
        f'<figure><img alt="{text}" src="data:image/png;base64,{data}">'
        f"<figcaption>{text}</figcaption></figure>"
    )
