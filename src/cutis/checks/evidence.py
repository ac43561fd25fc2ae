"""What the model of skin makes of a texture: found once, when the first check asks for it."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cutis.arrays import Colours, Floats, Picture, Where
from cutis.checks.gathering import INSIDE, Gathered
from cutis.colour import encode_srgb
from cutis.colour.transfer import decode_srgb
from cutis.errors import CutisError
from cutis.inverse import Model
from cutis.inverse.calibration import search
from cutis.maps.plain import Map
from cutis.maps.trust import LOW

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear sRGB."""
SAMPLE = 20_000
"""Texels that the model is asked about, at most."""


class Evidence:
    """A gathered texture in the eyes of a model that knows skin."""

    def __init__(self, gathered: Gathered, model: Model) -> None:
        self.gathered, self._model = gathered, model

    # single texels --------------------------------------------------------------------------------

    @cached_property
    def colours(self) -> Colours:
        """(n, 3) of texels inside the mask."""
        return thinned(self.gathered.texels[self.gathered.sure])

    @cached_property
    def outside(self) -> Colours:
        """(n, 3) of texels off the mask."""
        return thinned(self.gathered.texels[~self.gathered.sure])

    @cached_property
    def gains(self) -> NDArray[np.float64]:
        """(3,) what `--white auto` would take."""
        return self.gains_of(self.colours)

    @cached_property
    def share(self) -> float:
        """Share of texels that have a colour of skin, as labelled."""
        return self.share_of(self.colours)

    @cached_property
    def share_balanced(self) -> float:
        """The same with `gains`."""
        return self.share_of(self.colours * self.gains)

    @cached_property
    def skin(self) -> Colours:
        """(n, 3) of the texels that have a colour of skin once balanced, as labelled."""
        chosen = self.confidence(self.colours * self.gains) >= LOW
        return self.colours[chosen] if chosen.any() else self.colours

    @cached_property
    def luminance(self) -> float:
        """Median luminance of skin."""
        return float(np.median(self.skin @ LUMINANCE)) if len(self.skin) else 0.0

    def confidence(self, colours: Floats) -> Map:
        """How likely colours (..., 3) are ones of skin."""
        wanted = np.asarray(colours, np.float32).reshape(-1, 3)
        if self._model.to_trust is None:  # a model without a prior: what it explains is skin
            from cutis.colour import delta_e

            explained = self._model.decode(self._model.encode(wanted))
            found = np.asarray(delta_e(explained, wanted) < 1, np.float32)
        else:
            found = self._model.to_trust(wanted)[:, 5]
        return found.reshape(np.shape(colours)[:-1])

    def share_of(self, colours: Floats) -> float:
        """Share of colours (n, 3) that are ones of skin."""
        return float((self.confidence(colours) >= LOW).mean()) if len(colours) else 0.0

    def gains_of(self, colours: Colours) -> NDArray[np.float64]:
        """(3,) gains with which the model explains most of the colours (n, 3); 1 of few."""
        try:
            return search(colours, lambda c: self._model.decode(self._model.encode(c)))
        except CutisError:  # hardly a texel that is not black
            return np.ones(3)

    # the whole, reduced ---------------------------------------------------------------------------

    @cached_property
    def inside(self) -> Where:
        """(h, w) blocks of the reduced picture that the mask holds."""
        return self.gathered.cover > INSIDE

    @cached_property
    def size(self) -> float:
        """The side of a square as large as the skin, in blocks."""
        return float(np.sqrt(max(1, self.skin_blocks.sum())))

    @cached_property
    def balanced(self) -> Picture:
        """The reduced picture with `gains`."""
        return np.asarray(self.gathered.picture * self.gains, np.float32)

    @cached_property
    def skin_blocks(self) -> Where:
        """(h, w) blocks that look like skin and are not far darker than most of it."""
        bright = self.balanced @ LUMINANCE
        sure = self.inside & (self.confidence(self.balanced) >= LOW)
        if not sure.any():
            return sure
        return sure & (bright > 0.35 * np.median(bright[sure]))


def thinned(colours: Colours) -> Colours:
    """Every n-th of colours, SAMPLE at most."""
    return colours[:: max(1, -(-len(colours) // SAMPLE))]


def read_as(values: Floats, encoded: bool) -> Colours:
    """Stored values (n, 3) read as sRGB, or as linear: linear sRGB."""
    if encoded:
        return np.asarray(decode_srgb(np.clip(values, 0, 1)), np.float32)
    return np.asarray(values, np.float32)


def shown(linear: Floats) -> Floats:
    """Linear sRGB as codes from 0 to 255."""
    return 255 * np.asarray(encode_srgb(np.clip(linear, 0, 1)))


def blurred(values: Floats, weight: Floats, sigma: float) -> tuple[Floats, Floats]:
    """Means of values (h, w) under a Gaussian within `weight`, and how much weight is near."""
    near = gaussian_filter(weight, sigma, mode="constant")
    found = gaussian_filter(values * weight, sigma, mode="constant")
    return found / np.maximum(near, 1e-6), near
