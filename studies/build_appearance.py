"""Writes what pictures are drawn with into src/cutis/data/page: colour maps, and a font.

    python -m studies.build_appearance

Both come from matplotlib's files, which are needed here only: six colour maps of 256 colours as a
table, and of DejaVu Sans the letters that labels use.
"""

import io
from pathlib import Path

import numpy as np
from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont
from matplotlib import colormaps, get_data_path

from cutis.textures import replacing
from studies.generated import record

PAGE = Path(__file__).parents[1] / "src" / "cutis" / "data" / "page"
NAMES = ("copper_r", "Reds", "viridis", "cividis", "coolwarm", "magma")
LETTERS = [
    *range(0x20, 0x7F), *range(0xA0, 0x100), *range(0x391, 0x3CA),
    *map(ord, "–—‘’“”…−×√≈≤≥→⁰⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉"),
]  # fmt: skip
HEADER = """\
# Colour maps, 256 colours each from low to high: red, green, blue of encoded sRGB. Unit: 1/255.
# Source: matplotlib. viridis and magma: N. J. Smith and S. van der Walt, CC0. cividis: J. R. Nunez,
# C. R. Anderton and R. S. Renslow 2018 (key nunez2018cividis). coolwarm: K. Moreland 2009 (key
# moreland2009). Reds: ColorBrewer, C. A. Brewer and M. Harrower, Apache 2.0. copper_r: a formula.
# Terms: see THIRD_PARTY.md. Made by python -m studies.build_appearance.
"""


def main() -> None:
    tables = np.stack([colormaps[name](np.arange(256), bytes=True)[:, :3] for name in NAMES])
    heads = ",".join(f"{name} {channel}" for name in NAMES for channel in ("red", "green", "blue"))
    rows = tables.transpose(1, 0, 2).reshape(256, -1)
    with replacing(PAGE / "colour_maps.csv") as partial:
        lines = [",".join(map(str, row)) for row in rows.tolist()]
        partial.write_text("\n".join([HEADER + heads, *lines, ""]), encoding="utf-8")
    font = TTFont(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), recalcTimestamp=False)
    subsetter = Subsetter(Options(layout_features=["kern"], name_IDs=["*"], drop_tables=["FFTM"]))
    subsetter.populate(unicodes=LETTERS)
    subsetter.subset(font)
    data = io.BytesIO()
    font.save(data)
    with replacing(PAGE / "DejaVuSans-letters.ttf") as partial:
        partial.write_bytes(data.getvalue())
    record(PAGE / "colour_maps.csv", PAGE / "DejaVuSans-letters.ttf")


if __name__ == "__main__":
    main()
