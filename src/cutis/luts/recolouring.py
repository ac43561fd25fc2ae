"""An edit that is the same everywhere, as a function from colour to colour.

Estimate, edit, decode, times what the model does not explain: what `SkinMaps.apply` and `albedo` do
to a texel depends on its colour alone. Colours that are no skin's are not in the reach of an edit
of skin: it fades as the model's own colour moves away from the one given.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cutis.arrays import Colours, Floats
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model
from cutis.maps.defaults import DEFAULT, load_model
from cutis.maps.edits import Edit
from cutis.maps.relighting import DARKEST
from cutis.optics import NAMES, RARE_NAMES

WHOLE, NONE = 8.0, 20.0
"""ΔE00 between a colour and the model's up to which an edit is whole, and from which there is
none."""

Recolouring = Callable[[Floats], Colours]


def recolouring(
    edits: Sequence[Edit],
    model: Model | str = DEFAULT,
    calibration: Calibration | None = None,
    amount: float = 1.0,
) -> Recolouring:
    """The function from (n, 3) linear sRGB as captured to the same with the edits in it.

    Colours that no edit changes come back bit for bit. Raises CutisError for edits that depend on
    the place (patches), unknown models, and amounts outside 0 to 1.
    """
    if not 0 <= amount <= 1:
        raise CutisError(f"the amount of an edit must lie in 0 to 1, not {amount:g}")
    for edit in edits:
        if edit.where != "everywhere":
            raise CutisError(f"{edit}: a LUT cannot tell places apart; leave this edit out")
        if isinstance(edit.amount, np.ndarray):
            raise CutisError(f"{edit}: a LUT cannot tell places apart; give one amount for all")
    known = calibration or Calibration()
    light = replace(known, gains=(1.0, 1.0, 1.0))
    inverse = load_model(model)

    def recoloured(captured: Floats) -> Colours:
        result = np.array(captured, dtype=np.float32)
        colours = known.apply(result)
        skins = inverse.encode(colours)
        before = inverse.decode(skins)
        if any(edit.parameter in RARE_NAMES for edit in edits):
            skins = np.pad(skins, ((0, 0), (0, len(RARE_NAMES))))
        share = fading(delta_e(before, np.maximum(colours, 0.0)))
        near = np.flatnonzero(share)
        edited = skins[near]
        weight = np.full(len(near), amount, dtype=np.float32)
        for edit in edits:
            column = (*NAMES, *RARE_NAMES).index(edit.parameter)
            edited[:, column] = edit(edited[:, column], weight)[0]
        changed = (edited != skins[near]).any(axis=1)
        near = near[changed]
        old, new = before[near], inverse.decode(edited[changed])
        if light.conversion is not None:  # gains cancel, a matrix does not
            old, new = light.undo(old), light.undo(new)
        ratio = new / np.maximum(old, DARKEST)
        result[near] *= 1 + share[near, None] * (ratio - 1)
        return result

    return recoloured


def fading(error: Floats) -> Floats:
    """Share of an edit for colours that the model misses by `error` ΔE00: smooth from 1 to 0."""
    x = np.clip((error - WHOLE) / (NONE - WHOLE), 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)


def title(edits: Sequence[Edit], amount: float = 1.0) -> str:
    """What the edits do, in a line."""
    text = ", ".join(str(edit) for edit in edits) or "no edit"
    return text if amount == 1 else f"{text}, amount {amount:g}"
