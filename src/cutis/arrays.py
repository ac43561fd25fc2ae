"""Names for arrays by what they hold, so that signatures say their shapes."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Map: TypeAlias = NDArray[np.float32]
"""(H, W), one value for each texel, in the unit of what it is a map of; NaN where none is."""
Picture: TypeAlias = NDArray[np.float32]
"""(H, W, 3) linear sRGB."""
Colours: TypeAlias = NDArray[np.float32]
"""(n, 3) linear sRGB, without neighbours."""
Coordinates: TypeAlias = NDArray[np.float32]
"""(H, W, 5) or (n, 5) network coordinates of the five parameters, 0 to 1."""
Where: TypeAlias = NDArray[np.bool_]
"""(H, W) or (n,), whether a texel counts."""
Bytes: TypeAlias = NDArray[np.uint8]
"""Samples or places in a palette, 0 to 255."""
Floats: TypeAlias = NDArray[np.floating]
"""Numbers of any float type, of a shape that is said beside."""
