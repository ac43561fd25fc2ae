"""The same face under another light.

A capture is linear sRGB balanced on its own light, and what comes out is balanced on the new one:
white is (1, 1, 1) under both, as `estimate(…, illuminant=…)` expects. On skin each channel of the
capture is multiplied by

    RGB of the skin's spectrum under the new light, edits included
    ──────────────────────────────────────────────────────────────,
    RGB of the estimate's spectrum under the light of the capture

both summed over the 41 bands of the exact albedo space, so that what the model does not explain
rides along. Dark saturated skins have next to no blue under a warm light, some less than none in
sRGB: what is not explained is then multiplied by at most STEEPEST. What is not skin has no
spectrum; it goes through `colour.light_conversion`, and the mask blends between the two.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.colour import LightLike, illuminant, light_conversion
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration, to_d65
from cutis.maps.exact import exact
from cutis.maps.plain import Maps
from cutis.optics import Tissue

Array = NDArray[np.float32]
STEEPEST = np.float32(4)
"""Most that a channel's residual is multiplied by."""
DARKEST = np.float32(1e-4)
"""Model albedo that ratios are taken over at least, so that they stay finite."""


class Relighting:
    """From captures of one calibration to what they show under `light` (`colour.illuminant`).

    `changes` says whether that is another light than that of the captures. Raises CutisError for
    unknown lights, and those that no camera can be balanced on.
    """

    def __init__(self, calibration: Calibration, tissue: Tissue, light: LightLike) -> None:
        self._light, self._calibration, self._tissue = light, calibration, tissue
        self._before, self.changes = _light_of(calibration, tissue), True
        other = light_conversion("D65", light)
        if self._before is None:
            other = other @ np.array(calibration.conversion)
        elif self._before != "D65":
            other = light_conversion(self._before, light)
        if self._before is not None:
            self.changes = not np.array_equal(illuminant(self._before), illuminant(light))
        self._other = other.T.astype(np.float32)

    def __call__(self, before: Maps, after: Maps, source: Array) -> Array:
        """(h, W, 3) linear sRGB of rows of maps, edited or not, whose capture `source` is."""
        result = np.asarray(source @ self._other, dtype=np.float32)
        inside = before.mask > 0
        new, old = self._under(after, self._light), self._captured(before)
        gains = np.array(self._calibration.gains, np.float32)
        # source · new / old, as a sum so that it holds where old is 0
        ratio = np.clip(new / np.maximum(old, DARKEST), 0, STEEPEST)
        relit = (new + (source[inside] * gains - old) * ratio) / gains
        result[inside] += before.mask[inside][:, None] * (relit - result[inside])
        return result

    def alone(self, maps: Maps) -> Array:
        """(h, W, 3) what the model gives under the light, gains undone; 0 off the mask."""
        result = np.zeros((*maps.shape, 3), dtype=np.float32)
        gains = np.array(self._calibration.gains, np.float32)
        result[maps.mask > 0] = self._under(maps, self._light) / gains
        return result

    def _under(self, maps: Maps, light: LightLike) -> Array:
        """(n, 3) linear sRGB of the texels of the mask under a light, balanced on it."""
        space, skins = exact(self._tissue, maps)
        return space.rgb(skins, light)

    def _captured(self, maps: Maps) -> Array:
        """(n, 3) colours of the texels of the mask under the light of the capture."""
        if self._before is not None:
            return self._under(maps, self._before)
        back = np.linalg.inv(np.array(self._calibration.conversion)).T.astype(np.float32)
        return np.asarray(self._under(maps, "D65") @ back, dtype=np.float32)


def _light_of(calibration: Calibration, tissue: Tissue) -> str | None:
    """The light of a capture; None where it was a file that is gone, or is another by now."""
    if calibration.conversion is None:
        return "D65"
    try:
        found = to_d65(calibration.light, tissue)
    except CutisError:
        return None
    return calibration.light if np.allclose(found, calibration.conversion, atol=1e-4) else None
