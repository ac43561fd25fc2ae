"""LUT files: Resolve's .cube, and the operators of the Common LUT Format .clf [aces_clf]."""

import os
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from cutis.textures.atomic import replacing
from cutis.textures.problem import problem

Array = NDArray[np.floating]

FORMATS = (".cube", ".clf")
"""Extensions of LUTs that are written."""


def write_cube(
    path: str | os.PathLike[str], table: Array, shaper: Array | None = None, title: str = ""
) -> None:
    """Writes a .cube: `table` (n, n, n, 3) by red, green, blue, values from 0 to 1.

    `shaper` (m,) comes first, from values of 0 to 1 to places on the grid, where there is one.
    The title is a comment: OpenColorIO reads no shaper from a file with a TITLE. Raises CutisError
    for names that cannot be written.
    """
    lines = [f"# {' '.join(title.split())}".encode("ascii", "replace").decode()]
    if shaper is not None:
        lines += [f"LUT_1D_SIZE {len(shaper)}", "LUT_1D_INPUT_RANGE 0.0 1.0"]
    lines += [f"LUT_3D_SIZE {len(table)}"]
    if shaper is not None:
        lines += ["LUT_3D_INPUT_RANGE 0.0 1.0", _rows(np.repeat(shaper[:, None], 3, axis=1))]
    lines.append(_rows(table.transpose(2, 1, 0, 3).reshape(-1, 3)))  # red fastest
    _write(path, ".cube", "\n".join(lines) + "\n")


def write_clf(path: str | os.PathLike[str], operators: Sequence[str], title: str = "") -> None:
    """Writes a .clf of `operators` in their order; those below make them.

    Raises CutisError for names that cannot be written.
    """
    name, body = quoteattr(title or "edit"), "\n".join(operators)  # no empty names
    _write(
        path,
        ".clf",
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList id="cutis" compCLFversion="3.0" name={name}>\n'
        f"{body}\n</ProcessList>\n",
    )


def srgb_curve(inverse: bool = False) -> str:
    """Encoded sRGB → linear, or the inverse; negative values keep their slope."""
    style = "monCurveRev" if inverse else "monCurveFwd"
    return (
        f'<Exponent {DEPTHS} style="{style}">'
        '<ExponentParams exponent="2.4" offset="0.055"/></Exponent>'
    )


def logarithm(offset: float, inverse: bool = False) -> str:
    """x → log(x + offset), natural, or the inverse."""
    style = "logToLin" if inverse else "linToLog"
    return (
        f'<Log {DEPTHS} style="{style}">'
        f'<LogParams base="{np.e:.15g}" linSideSlope="1" linSideOffset="{offset:.9g}" '
        'logSideSlope="1" logSideOffset="0"/></Log>'
    )


def matrix(values: Array, shift: Array) -> str:
    """(3,) → values (3, 3) @ it + shift (3,)."""
    rows = np.hstack([values, shift[:, None]])
    text = "\n".join(" ".join(f"{v:.10g}" for v in row) for row in rows)
    return f'<Matrix {DEPTHS}><Array dim="3 4">\n{text}\n</Array></Matrix>'


def curves(values: Array) -> str:
    """Three curves (m, 3) over 0 to 1, straight between their points."""
    return (
        f'<LUT1D {DEPTHS} interpolation="linear"><Array dim="{len(values)} 3">\n'
        f"{_rows(values, 9)}\n</Array></LUT1D>"
    )


def grid(table: Array) -> str:
    """(n, n, n, 3) by the first, second and third channel, read trilinearly."""
    size = len(table)
    return (
        f'<LUT3D {DEPTHS} interpolation="trilinear"><Array dim="{size} {size} {size} 3">\n'
        f"{_rows(table.reshape(-1, 3))}\n</Array></LUT3D>"
    )


DEPTHS = 'inBitDepth="32f" outBitDepth="32f"'


def _rows(values: Array, digits: int = 7) -> str:
    line = " ".join([f"%.{digits}f"] * values.shape[-1])
    return "\n".join(line % tuple(row) for row in values.tolist())


def _write(path: str | os.PathLike[str], extension: str, text: str) -> None:
    path = Path(path)
    if path.suffix.lower() != extension:
        raise problem(path, f"this LUT is a {extension}; end its name so")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
