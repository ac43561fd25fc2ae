"""LUT files: Resolve's .cube, and the Common LUT Format .clf [aces_clf], written by OpenColorIO.

Whatever is written is finite: programs read NaN as black, as white, or not at all.
"""

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cutis.arrays import Floats
from cutis.errors import CutisError
from cutis.textures.atomic import replacing
from cutis.textures.problem import problem

Operator = Any
"""A transform of OpenColorIO; the functions below make them."""

FORMATS = (".cube", ".clf")
"""Extensions of LUTs that are written."""


def write_cube(
    path: str | os.PathLike[str], table: Floats, shaper: Floats | None = None, title: str = ""
) -> None:
    """Writes a .cube: `table` (n, n, n, 3) by red, green, blue, values from 0 to 1.

    `shaper` (m,) comes first, from values of 0 to 1 to places on the grid, where there is one.
    The title is a comment: OpenColorIO reads no shaper from a file with a TITLE. Raises CutisError
    for names that cannot be written and for tables that are not finite.
    """
    finite(table)
    lines = [f"# {' '.join(title.split())}".encode("ascii", "replace").decode()]
    if shaper is not None:
        finite(shaper)
        lines += [f"LUT_1D_SIZE {len(shaper)}", "LUT_1D_INPUT_RANGE 0.0 1.0"]
    lines += [f"LUT_3D_SIZE {len(table)}"]
    if shaper is not None:
        lines += ["LUT_3D_INPUT_RANGE 0.0 1.0", _rows(np.repeat(shaper[:, None], 3, axis=1))]
    lines.append(_rows(table.transpose(2, 1, 0, 3).reshape(-1, 3)))  # red fastest
    _write(path, ".cube", "\n".join(lines) + "\n")


def write_clf(path: str | os.PathLike[str], operators: Sequence[Operator], title: str = "") -> None:
    """Writes a .clf of `operators` in their order; those below make them.

    Raises CutisError for names that cannot be written.
    """
    import PyOpenColorIO as ocio

    group = ocio.GroupTransform()
    for operator in operators:
        group.appendTransform(operator)
    about = group.getFormatMetadata()
    about.setID("cutis")
    about.setName(title or "edit")
    text = ""
    if operators:
        text = group.write("Academy/ASC Common LUT Format", ocio.Config.CreateRaw())
    _write(path, ".clf", text)


def srgb_curve(inverse: bool = False) -> Operator:
    """Encoded sRGB → linear, or the inverse; negative values keep their slope."""
    import PyOpenColorIO as ocio

    return ocio.ExponentWithLinearTransform(
        gamma=[2.4, 2.4, 2.4, 1.0], offset=[0.055, 0.055, 0.055, 0.0],
        negativeStyle=ocio.NEGATIVE_LINEAR, direction=_direction(inverse),
    )  # fmt: skip


def logarithm(offset: float, inverse: bool = False) -> Operator:
    """x → log(x + offset), natural, or the inverse."""
    import PyOpenColorIO as ocio

    found = ocio.LogAffineTransform(linSideOffset=[offset] * 3, direction=_direction(inverse))
    found.setBase(math.e)
    return found


def matrix(values: Floats, shift: Floats) -> Operator:
    """(3,) → values (3, 3) @ it + shift (3,)."""
    import PyOpenColorIO as ocio

    finite(values)
    finite(shift)
    square = np.eye(4)
    square[:3, :3] = values
    return ocio.MatrixTransform(matrix=square.ravel().tolist(), offset=[*map(float, shift), 0.0])


def curves(values: Floats) -> Operator:
    """Three curves (m, 3) over 0 to 1, straight between their points."""
    import PyOpenColorIO as ocio

    finite(values)
    found = ocio.Lut1DTransform(length=len(values), inputHalfDomain=False)
    return _table(found, values)


def grid(table: Floats) -> Operator:
    """(n, n, n, 3) by the first, second and third channel, read trilinearly."""
    import PyOpenColorIO as ocio

    finite(table)
    return _table(ocio.Lut3DTransform(gridSize=len(table)), table)


def finite(values: Floats) -> None:
    """Raises CutisError where `values` are not all finite as float32."""
    if not (np.abs(values) <= np.finfo(np.float32).max).all():
        raise CutisError(
            "this edit gives colours that are no numbers, so there is no LUT of it; look at the "
            "calibration of the maps (cutis info) and at the colour space"
        )


def _table(found: Operator, values: Floats) -> Operator:
    import PyOpenColorIO as ocio

    found.setFileOutputBitDepth(ocio.BIT_DEPTH_F32)
    found.setInterpolation(ocio.INTERP_LINEAR)
    found.setData(np.ascontiguousarray(values, dtype=np.float32).ravel())
    return found


def _direction(inverse: bool) -> Any:
    import PyOpenColorIO as ocio

    return ocio.TRANSFORM_DIR_INVERSE if inverse else ocio.TRANSFORM_DIR_FORWARD


def _rows(values: Floats) -> str:
    line = " ".join(["%.7f"] * values.shape[-1])
    return "\n".join(line % tuple(row) for row in values.tolist())


def _write(path: str | os.PathLike[str], extension: str, text: str) -> None:
    path = Path(path)
    if path.suffix.lower() != extension:
        raise problem(path, f"this LUT is a {extension}; end its name so")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
