"""An edit as a three-dimensional look-up table, for programs that know nothing of skin.

An edit that is the same everywhere turns every colour into one other: estimate, edit, decode, times
what the model does not explain. Sampled on a grid of colours it is a LUT. Colours that are no
skin's pass through: the edit fades as the model's own colour moves away from the one given.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.colour import decode_srgb, delta_e, encode_srgb
from cutis.colour.spaces import RGBSpace, rgb_space
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.models import load_model
from cutis.maps.edits import Edit
from cutis.maps.skin_maps import DARKEST
from cutis.optics import NAMES

WHOLE, NONE = 3.0, 12.0
"""ΔE00 between a colour and the model's up to which an edit is whole, and from which there is
none."""
SHAPER = 4096
"""Entries of the shaper of linear spaces: the sRGB curve, nearly even in lightness."""
LARGEST = 129


@dataclass(frozen=True, eq=False)
class Lut:
    """`table` (n, n, n, 3) by red, green, blue: values of `space` for shaped values of it.

    `shaper` (SHAPER,) maps values of 0 to 1 to places of 0 to 1 on the grid, the same for the three
    channels; None where the grid is even in the values themselves. `title` says what the edit is.
    """

    table: NDArray[np.float32]
    shaper: NDArray[np.float32] | None
    space: RGBSpace
    title: str


def edit_lut(
    edits: Sequence[Edit],
    size: int = 65,
    space: str = "sRGB",
    *,
    model: str = "default",
    calibration: Calibration | None = None,
    amount: float = 1.0,
) -> Lut:
    """The LUT of edits for albedos stored in `space`, with values from 0 to 1.

    `calibration` is that of the captures it will be used on. Raises CutisError for edits that
    depend on the place (patches), unknown spaces and models, and sizes outside 2 to LARGEST.
    """
    if not 2 <= size <= LARGEST:
        raise CutisError(f"a LUT has 2 to {LARGEST} nodes along a side, not {size}")
    if not 0 <= amount <= 1:
        raise CutisError(f"amount = {amount:g}: it must lie in 0 to 1")
    for edit in edits:
        if edit.where != "everywhere":
            raise CutisError(f"{edit}: a LUT cannot tell places apart; leave this edit out")
    chosen = rgb_space(space)
    known = calibration or Calibration()
    inverse = load_model(model)
    nodes = np.linspace(0.0, 1.0, size)
    shaper = None
    if not chosen.encoded:
        shaper = encode_srgb(np.linspace(0.0, 1.0, SHAPER)).astype(np.float32)
        nodes = decode_srgb(nodes)
    stored = np.stack(np.meshgrid(nodes, nodes, nodes, indexing="ij"), axis=-1).reshape(-1, 3)
    captured = chosen.to_linear_srgb(stored).astype(np.float32)
    colours = known.apply(captured)
    skins = inverse.encode(colours)
    before = inverse.decode(skins)
    edited = skins.copy()
    weight = np.full(len(skins), amount, dtype=np.float32)
    for edit in edits:
        column = NAMES.index(edit.parameter)
        edited[:, column] = edit(edited[:, column], weight)[0]
    after = inverse.decode(edited)
    if known.conversion is not None:
        ratio = known.undo(after) / np.maximum(known.undo(before), DARKEST)
    else:
        ratio = after / np.maximum(before, DARKEST)
    share = fading(delta_e(before, np.maximum(colours, 0.0)))[:, None]
    result = chosen.from_linear_srgb(captured * (1 + share * (ratio - 1)))
    unchanged = (edited == skins).all(axis=1) | (share[:, 0] == 0)
    result[unchanged] = stored[unchanged]
    table = np.asarray(result, dtype=np.float32).reshape(size, size, size, 3)
    title = ", ".join(str(edit) for edit in edits) or "no edit"
    return Lut(
        _balanced(table), shaper, chosen, title if amount == 1 else f"{title}, amount {amount:g}"
    )


def _balanced(table: NDArray[np.float32]) -> NDArray[np.float32]:
    """Nodes moved so that straight lines between them lie about the curve, not on one side of it.

    Between nodes a curve of second difference d lies up to d/8 and on average d/12 from the line.
    """
    result = table.copy()
    for axis in range(3):
        inner, after, before = ([slice(None)] * 3 for _ in range(3))
        inner[axis], after[axis], before[axis] = slice(1, -1), slice(2, None), slice(None, -2)
        middle = table[tuple(inner)]
        result[tuple(inner)] -= (table[tuple(after)] - 2 * middle + table[tuple(before)]) / 12
    return result


def fading(error: NDArray[np.floating]) -> NDArray[np.floating]:
    """Share of an edit for colours that the model misses by `error` ΔE00: smooth from 1 to 0."""
    x = np.clip((error - WHOLE) / (NONE - WHOLE), 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)
