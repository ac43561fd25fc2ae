"""An edit that is the same everywhere, as a function from colour to colour.

Estimate, edit, decode, times what the model does not explain: what `SkinMaps.apply` and `albedo` do
to a texel depends on its colour alone. Colours that are no skin's are not in the reach of an edit
of skin: it fades as the model's own colour moves away from the one given.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from cutis.arrays import Colours, Floats
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model
from cutis.looks import Look, asked
from cutis.maps import Edits, Face, MadeBy, Maps, SkinMaps, Tile
from cutis.maps.defaults import DEFAULT, load_model
from cutis.maps.face import TileOf
from cutis.maps.relighting import DARKEST
from cutis.optics import NAMES

WHOLE, NONE = 8.0, 20.0
"""ΔE00 between a colour and the model's up to which an edit is whole, and from which there is
none."""

Recolouring = Callable[[Floats], Colours]


def recolouring(
    edits: Edits,
    model: Model | str = DEFAULT,
    calibration: Calibration | None = None,
    amount: float = 1.0,
    face: Face | None = None,
) -> Recolouring:
    """The function from (n, 3) linear sRGB as captured to the same with the edits in it.

    `face` is the one that the edits take medians of, where they do. Colours that no edit changes
    come back bit for bit. Raises CutisError for edits that depend on the place (patches, masks,
    blurs), unknown models, and amounts outside 0 to 1.
    """
    inverse = load_model(model)
    wanted = asked(edits, amount)
    wanted.check_everywhere()
    change = wanted.for_face(face or Face(NoFace(inverse)))
    known = calibration or Calibration()
    light = replace(known, gains=(1.0, 1.0, 1.0))

    def recoloured(captured: Floats) -> Colours:
        result = np.array(captured, dtype=np.float32)
        colours = known.apply(result)
        skins = inverse.encode(colours)
        before = inverse.decode(skins)
        share = fading(delta_e(before, np.maximum(colours, 0.0)))
        near = np.flatnonzero(share)
        tile = change(_tile(skins[near], colours[near], inverse if change.trust else None))
        edited = tile.maps.parameters(tile.maps.names)[0]
        plain = np.pad(skins[near], ((0, 0), (0, edited.shape[1] - len(NAMES))))
        changed = (edited != plain).any(axis=1)
        near = near[changed]
        old, new = before[near], inverse.decode(edited[changed])
        if light.conversion is not None:  # gains cancel, a matrix does not
            old, new = light.undo(old), light.undo(new)
        ratio = new / np.maximum(old, DARKEST)
        result[near] *= 1 + share[near, None] * (ratio - 1)
        return result

    return recoloured


def _tile(skins: Colours, colours: Colours, knows: Model | None) -> Tile:
    """Skins (n, 5) as a row of maps, with σ and confidence of their colours if a model is given."""
    values = {name: skins[None, :, column] for column, name in enumerate(NAMES)}
    maps = Maps(values, np.ones((1, len(skins)), np.float32))
    if knows is None or knows.to_trust is None:
        return Tile(maps)
    trust = knows.to_trust(colours)
    sigmas = {name: trust[None, :, column] for column, name in enumerate(NAMES)}
    return Tile(maps, sigmas, (), trust[None, :, len(NAMES)])


class NoFace:
    """Colours of no face, as a `Source` of the maps that a model finds in them."""

    shape, tile, known = (1, 1), TileOf(), None

    def __init__(self, model: Model) -> None:
        """The model is also who knows σ."""
        self.made_by = MadeBy.of(model)
        self.provenance: dict[str, str] = {}

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""
        return self.made_by.load().to_trust is not None

    def bands(self) -> Iterator[slice]:
        """Raises CutisError: there is no face."""
        raise CutisError(
            "these edits take the median of a face; give its maps, with --maps on the command line"
        )

    def rows(self, rows: slice, trust: bool = True) -> SkinMaps:
        """Never asked for."""
        raise NotImplementedError

    def keep(self) -> None:
        """There is nothing to keep."""


def fading(error: Floats) -> Floats:
    """Share of an edit for colours that the model misses by `error` ΔE00: smooth from 1 to 0."""
    x = np.clip((error - WHOLE) / (NONE - WHOLE), 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)


def title(edits: Edits, amount: float = 1.0) -> str:
    """What the edits do, in a line."""
    wanted = asked(edits, amount)
    return "; ".join(wanted.words() if isinstance(wanted, Look) else ("a change",)) or "no edit"
