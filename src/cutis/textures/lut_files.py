"""LUT files: Resolve's .cube and the Common LUT Format .clf of the Academy [aces_clf]."""

import os
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from cutis.textures.atomic import replacing
from cutis.textures.problem import problem

Table = NDArray[np.floating]


def write_lut(path: str | os.PathLike[str], table: Table, shaper: Table | None, title: str) -> None:
    """Writes a LUT to `path`, .cube or .clf by its extension.

    `table` (n, n, n, 3) by red, green, blue; `shaper` (m,) first, from values of 0 to 1 to places
    on the grid, where there is one. Raises CutisError for other extensions and names that cannot be
    written.
    """
    path = Path(path)
    writers = {".cube": _cube, ".clf": _clf}
    if path.suffix.lower() not in writers:
        raise problem(path, "a LUT is written as .cube or .clf; end its name so")
    text = writers[path.suffix.lower()](table, shaper, title)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _rows(values: Table) -> str:
    return "\n".join(" ".join(f"{v:.7f}" for v in row) for row in values)


def _cube(table: Table, shaper: Table | None, title: str) -> str:
    plain = " ".join(title.split()).encode("ascii", "replace").decode()
    lines = [f"# {plain}"]  # as a TITLE it would keep OpenColorIO from reading the shaper
    if shaper is not None:
        lines += [f"LUT_1D_SIZE {len(shaper)}", "LUT_1D_INPUT_RANGE 0.0 1.0"]
    lines += [f"LUT_3D_SIZE {len(table)}"]
    if shaper is not None:
        lines += ["LUT_3D_INPUT_RANGE 0.0 1.0", _rows(np.repeat(shaper[:, None], 3, axis=1))]
    lines.append(_rows(table.transpose(2, 1, 0, 3).reshape(-1, 3)))  # red fastest
    return "\n".join(lines) + "\n"


def _clf(table: Table, shaper: Table | None, title: str) -> str:
    size = len(table)
    nodes = []
    if shaper is not None:
        values = "\n".join(f"{v:.7f}" for v in shaper)
        nodes.append(
            '<LUT1D id="shaper" inBitDepth="32f" outBitDepth="32f" interpolation="linear">\n'
            f'<Array dim="{len(shaper)} 1">\n{values}\n</Array>\n</LUT1D>'
        )
    nodes.append(
        '<LUT3D id="edit" inBitDepth="32f" outBitDepth="32f" interpolation="tetrahedral">\n'
        f'<Array dim="{size} {size} {size} 3">\n{_rows(table.reshape(-1, 3))}\n</Array>\n</LUT3D>'
    )  # blue fastest
    body = "\n".join(nodes)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList id="cutis" compCLFversion="3.0" name={quoteattr(title)}>\n'
        f"{body}\n</ProcessList>\n"
    )
