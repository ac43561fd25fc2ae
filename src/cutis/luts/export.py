"""An edit into a LUT file that other programs load: .cube or .clf by its extension."""

import os
from pathlib import Path

import numpy as np

from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model
from cutis.luts import lut_files
from cutis.luts.clf_lut import OFFSET, skin_lut
from cutis.luts.cube_lut import Space, edit_lut
from cutis.luts.recolouring import recolouring, title
from cutis.maps import DEFAULT, Edits, Face, load_model


def export_lut(
    path: str | os.PathLike[str],
    edits: Edits,
    space: Space,
    size: int = 65,
    *,
    model: Model | str = DEFAULT,
    calibration: Calibration | None = None,
    amount: float = 1.0,
    face: Face | None = None,
) -> str:
    """Writes the LUT of edits for albedos stored in `space`; returns its title.

    `size` is the number of nodes along a side; `calibration` that of the captures it will be used
    on, `face` the one that the edits take medians of. Raises CutisError for other extensions, sizes
    out of range, edits that depend on the place, and calibrations under which colours are no
    numbers.
    """
    kind = Path(path).suffix.lower()
    if kind not in lut_files.FORMATS:
        raise CutisError(f"{path}: a LUT is written as .cube or .clf; end its name so")
    if calibration is not None:
        _check(calibration)
    edit = recolouring(edits, model, calibration, amount, face)
    text = f"{title(edits, amount)}, for {space.name}"
    if kind == ".cube":
        plain = edit_lut(edit, size, space)
        lut_files.write_cube(path, plain.table, plain.shaper, text)
        return text
    lut = skin_lut(edit, size, space, load_model(model).tissue, calibration)
    undone = np.linalg.inv(lut.matrix)
    operators = [
        lut_files.logarithm(OFFSET),
        lut_files.matrix(lut.matrix, lut.shift),
        lut_files.curves(lut.spread),
        lut_files.grid(lut.table),
        lut_files.curves(lut.gather),
        lut_files.matrix(undone, -undone @ lut.shift),
        lut_files.logarithm(OFFSET, inverse=True),
    ]
    if lut.encoded:
        operators = [lut_files.srgb_curve(), *operators, lut_files.srgb_curve(inverse=True)]
    lut_files.write_clf(path, operators, text)
    return text


def _check(calibration: Calibration) -> None:
    """Colours of 0 to 1 must be numbers under a calibration, and come back from it."""
    colours = np.concatenate([np.eye(3), 1 - np.eye(3)]).astype(np.float32)
    with np.errstate(all="ignore"):
        applied = calibration.apply(colours)
        lut_files.finite(applied)
        try:
            lut_files.finite(calibration.undo(applied))
        except np.linalg.LinAlgError:
            lut_files.finite(np.array([np.nan]))
