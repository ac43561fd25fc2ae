"""An edit as a chain of operators around a grid that is spread over skin, for a .clf.

The Common LUT Format may do more before its grid than a .cube [aces_clf]. Here values go to linear
light, their logarithms to

    u = log G,   v = log R − log G,   w = log B − log G,

in which skins of every lightness lie side by side, and each of the three by straight lines to
the grid: all but a few cells over skin, narrower where more skins are, the others over all that is
left of RGB. After the grid
everything is undone. A grid that moves nothing is exact between its nodes too, so what is not skin
passes unchanged.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import albedo_space, halton
from cutis.arrays import Floats
from cutis.colour import decode_srgb
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.luts.cube_lut import LARGEST, Space, is_linear
from cutis.luts.recolouring import Recolouring
from cutis.optics import Tissue

OFFSET = 0.002
"""Linear value added before the logarithm, so that black has one."""
BRIGHTEST = 4.0
"""Largest linear value that the grid reaches."""
SMALLEST = 9
"""Fewest nodes along a side."""
AROUND = 2
"""Cells beside skin at each end of an axis: one in which an edit fades, one for all the rest."""
FADE = 0.25
"""Width of the first of them, in natural logarithms."""
EVEN = 0.5
"""Share of the nodes over skin that lie evenly; the others lie as skins do."""
STEPS = 8192
"""Cells of the curves that spread the grid: many to each of the grid's, whose ends are rounded to
theirs so that what the edit leaves is left exactly."""
TO_UVW = np.array([[0.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, -1.0, 1.0]])
"""Logarithms of red, green, blue → u, v, w."""


@dataclass(frozen=True, eq=False)
class SkinLut:
    """The chain of a .clf, from first to last.

    Stored values, decoded by the sRGB curve if `encoded`; log(x + OFFSET); `matrix` (3, 3) and
    `shift` (3,); `spread` (STEPS + 1, 3), curves over 0 to 1; `table` (n, n, n, 3); `gather`
    (n, 3), curves over 0 to 1; then the inverses of matrix and shift, logarithm and decoding.
    """

    encoded: bool
    matrix: Floats
    shift: Floats
    spread: Floats
    table: Floats
    gather: Floats


def is_encoded(space: Space) -> bool:
    """Whether a space stores linear light by the sRGB curve."""
    some = np.array([[0.2, 0.1, 0.05], [0.02, 0.7, 0.9]])
    basis = space.to_linear_srgb(np.eye(3))
    return bool(np.allclose(space.to_linear_srgb(some), decode_srgb(some) @ basis, atol=1e-5))


def skin_lut(
    edit: Recolouring,
    size: int,
    space: Space,
    tissue: Tissue,
    calibration: Calibration | None = None,
) -> SkinLut:
    """The chain of an edit (`recolouring`) for albedos stored in `space`, values from 0 to 4.

    `calibration` and `tissue` say where skin lies in captured colours. Raises CutisError for sizes
    outside SMALLEST to LARGEST, and spaces that are neither linear nor encoded by the sRGB curve.
    """
    if not SMALLEST <= size <= LARGEST:
        raise CutisError(f"a .clf has {SMALLEST} to {LARGEST} nodes along a side, not {size}")
    encoded = not is_linear(space)
    if encoded and not is_encoded(space):
        raise CutisError(
            f"{space.name} is neither linear nor encoded by the sRGB curve; export a .cube"
        )
    to_srgb = np.asarray(space.to_linear_srgb(np.eye(3)), dtype=np.float64)  # rows: primaries
    from_srgb = np.linalg.inv(to_srgb)
    skins = _skins(calibration or Calibration(), from_srgb, tissue)
    first, step, starts, ends = _axes(skins)
    matrix = TO_UVW / (STEPS * step)[:, None]
    shift = -first / (STEPS * step)
    spread, gather = np.empty((STEPS + 1, 3)), np.empty((size, 3))
    for axis in range(3):
        fade = np.ceil(FADE / step[axis])
        low, high = starts[axis], ends[axis]
        over = _nodes((skins[:, axis] - first[axis]) / step[axis], low, high, size - 2 * AROUND)
        gather[:, axis] = np.array([0, low - fade, *over, high + fade, STEPS]) / STEPS
        nodes = np.linspace(0, 1, size)
        spread[:, axis] = np.interp(np.linspace(0, 1, STEPS + 1), gather[:, axis], nodes)
    logs = (gather[_grid(size), np.arange(3)] - shift) @ np.linalg.inv(matrix).T
    colours = (np.exp(logs) - OFFSET) @ to_srgb
    captured = np.maximum(colours, 0).astype(np.float32)
    edited = edit(captured)
    # dark colours are near skin whatever their hue; what lies beyond the fade must not feel them
    beside = np.minimum(_grid(size), size - 1 - _grid(size)).min(axis=1) < AROUND
    changed = (edited != captured).any(axis=1) & ~beside
    after = np.maximum(edited[changed] @ from_srgb, 0) + OFFSET
    before = np.maximum(captured[changed] @ from_srgb, 0) + OFFSET
    table = _grid(size) / (size - 1)
    places = (logs[changed] + np.log(after / before)) @ matrix.T + shift
    for axis in range(3):
        table[changed, axis] = np.interp(
            places[:, axis], np.linspace(0, 1, STEPS + 1), spread[:, axis]
        )
    return SkinLut(
        encoded, matrix, shift, spread, balanced(table.reshape(size, size, size, 3)), gather
    )


def balanced(table: Floats) -> Floats:
    """Nodes over skin moved so that straight lines between them lie about the curve.

    Between nodes a curve of second difference d lies up to d/8 and on average d/12 off the line.
    """
    result = table.copy()
    over = slice(AROUND + 1, -AROUND - 1)
    for axis in range(3):
        middle, after, before = [over] * 3, [over] * 3, [over] * 3
        after[axis] = slice(AROUND + 2, -AROUND)
        before[axis] = slice(AROUND, -AROUND - 2)
        bend = table[tuple(after)] - 2 * table[tuple(middle)] + table[tuple(before)]
        result[tuple(middle)] -= bend / 12
    return result


def _grid(size: int) -> NDArray[np.int64]:
    """(size³, 3) indices of the nodes, blue fastest."""
    return np.indices((size, size, size)).reshape(3, -1).T


def _skins(known: Calibration, from_srgb: Floats, tissue: Tissue) -> Floats:
    """(n, 3) u, v, w of the albedo space under the light of the capture."""
    skins = known.undo(albedo_space(tissue).rgb(halton(20_000, 3))) @ from_srgb
    return np.asarray(np.log(np.maximum(skins, 0) + OFFSET) @ TO_UVW.T)


def _nodes(places: Floats, low: float, high: float, count: int) -> Floats:
    """(count,) steps from `low` to `high`, EVEN of them evenly and the rest as skins' `places`."""
    line = np.linspace(low, high, STEPS + 1)
    share = np.searchsorted(np.sort(places), line) / len(places)
    share[0], share[-1] = 0, 1
    share += EVEN * (np.linspace(0, 1, STEPS + 1) - share)
    return np.round(np.interp(np.linspace(0, 1, count), share, line))


def _axes(skins: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """First value and step (3,) of the curves over u, v, w; their steps at which skin starts, ends.

    `skins` (n, 3) are u, v, w of all that is skin.
    """
    low, high = skins.min(axis=0), skins.max(axis=0)
    low[0] -= 1.0  # creases
    black, white = np.log(OFFSET), np.log(BRIGHTEST + OFFSET)
    least = np.array([black, black - white, black - white])
    most = np.array([white, white - black, white - black])
    cells = np.floor(STEPS * (high - low) / (most - least)) - 2  # so that both ends are reached
    step = (high - low) / cells
    starts = np.ceil((low - least) / step)
    return low - starts * step, step, starts, starts + cells
