"""Compiled comparison of a model with its capture; tests work it out again in NumPy."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.difference_kernel import colour_difference, relative_lab

ROWS = 16
"""Rows that a thread works on at a time."""
MASKED, BELOW, ABOVE, BEYOND, SQUARES = range(5)
"""Columns of `tallies`."""


@compiled(inline=True)
def _changed(red: Any, green: Any, blue: Any, m: Any) -> Any:
    return (
        m[0, 0] * red + m[0, 1] * green + m[0, 2] * blue,
        m[1, 0] * red + m[1, 1] * green + m[1, 2] * blue,
        m[2, 0] * red + m[2, 1] * green + m[2, 2] * blue,
    )


@on_all_cores(ROWS)
def judge(
    start: Any, stop: Any, capture: Any, model: Any, inside: Any, change: Any, matrix: Any,
    least: Any, gamut: Any, skin: Any, errors: Any, angles: Any, tallies: Any,
) -> None:  # fmt: skip
    """Compares model with capture (h, W, 3), linear RGB as captured, where `inside`.

    Fills skin (h, W) with whether a texel has the colour of skin, and where it has, errors in
    CIEDE2000 and angles, ITA in degrees, all after `change` (3, 3), the calibration. `least` are
    L* and C*ab that skin lies above, `matrix` (3, 3) gives XYZ over that of white. Rows of tallies
    (h, 5) are how many texels are inside, have a channel below 0, one above 1, an error above
    `gamut`, and the sum of squared differences.
    """
    for row in range(start, stop):
        masked, below, above, beyond = 0, 0, 0, 0
        squares = 0.0
        for column in range(capture.shape[1]):
            skin[row, column] = False
            if not inside[row, column]:
                continue
            red, green, blue = capture[row, column]
            masked += 1
            below += red < 0.0 or green < 0.0 or blue < 0.0
            above += red > 1.0 or green > 1.0 or blue > 1.0
            r1, g1, b1 = _changed(red, green, blue, change)
            light1, green1, yellow1 = relative_lab(r1, g1, b1, matrix)
            skin[row, column] = (
                light1 > least[0] and green1 * green1 + yellow1 * yellow1 > least[1] * least[1]
            )
            if not skin[row, column]:
                continue
            red, green, blue = model[row, column]
            r2, g2, b2 = _changed(red, green, blue, change)
            light2, green2, yellow2 = relative_lab(r2, g2, b2, matrix)
            error = colour_difference(light1, green1, yellow1, light2, green2, yellow2)
            errors[row, column] = error
            angles[row, column] = np.degrees(np.arctan2(light1 - 50.0, yellow1))
            beyond += error > gamut
            squares += (r2 - r1) ** 2 + (g2 - g1) ** 2 + (b2 - b1) ** 2
        tallies[row, MASKED], tallies[row, BELOW], tallies[row, ABOVE] = masked, below, above
        tallies[row, BEYOND], tallies[row, SQUARES] = beyond, squares
