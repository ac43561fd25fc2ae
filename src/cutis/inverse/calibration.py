"""Light, exposure and white balance of a capture: a matrix and gains on linear sRGB.

A capture carries the exposure and the colour cast of its lights. `auto` looks for the gains at
which the model explains the masked skin, with a pull towards 1: it minimises

    mean over a sample of texels of  r² / (r² + ρ²)  +  PULL · Σ (log gain)²,

r being the relative colour error of the best skin. The first term counts texels out of the
albedo space and saturates, so that clothes and hair inside the mask do not decide. Nothing pulls
towards a skin tone; the price is that under-exposure cannot be found, since darker colours are
skins too. A capture under a light other than D65 is first converted to it (`to_d65`).
Conversion and gains are undone on output, so colours come back as they came.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import albedo_space
from cutis.albedo.lights import skin_conversion
from cutis.colour import LightLike, light_conversion
from cutis.colour.light import light as named_light
from cutis.errors import CutisError
from cutis.inverse.fit import fit
from cutis.kernels.nearest import curve_order
from cutis.optics import ALIAGA2022, Tissue, from_coordinates

SAMPLE = 1600
"""Texels that gains are judged on."""
DARK = 0.25
"""Share of the 90th percentile of brightness below which texels are hair or holes, not skin."""
SCALE = 0.02
"""ρ, the relative colour error at which a texel counts half as out of the albedo space."""
PULL = 0.3
"""Weight of the pull of gains towards 1."""
EXPOSURES = (0.0, 0.3, -0.3, -0.6, -0.9, -1.2, -1.5)
"""Logarithms of the exposures that the search may start from."""
LIMITS = (0.1, 10.0)
"""Gains outside are refused."""

White = Literal["none", "auto"] | Sequence[float] | None
Exposure = Literal["none", "auto"] | float | None
Matrix = tuple[tuple[float, ...], ...]
Nearest = Callable[[NDArray[np.float32]], NDArray[np.float32]]
"""Colours (n, 3) of linear sRGB → the nearest that skin has."""


@dataclass(frozen=True)
class Calibration:
    """What was applied to linear sRGB as captured, and a word on the origin of the gains.

    `gains` (red, green, blue) after `conversion`, the 3 × 3 matrix from the RGB of `light` to that
    of D65; None where the capture was made under D65. `light` is a name; that of a file without
    its folder.
    """

    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)
    origin: str = "none"
    light: str = "D65"
    conversion: Matrix | None = None

    def apply(self, rgb: ArrayLike) -> NDArray[np.float32]:
        """(..., 3) linear sRGB as captured → calibrated."""
        if self.conversion is not None:
            rgb = np.asarray(rgb, np.float32) @ np.array(self.conversion, np.float32).T
        return np.multiply(rgb, np.array(self.gains, np.float32), dtype=np.float32)

    def undo(self, rgb: ArrayLike) -> NDArray[np.float32]:
        """(..., 3) calibrated linear sRGB → as captured."""
        captured = np.divide(rgb, np.array(self.gains, np.float32), dtype=np.float32)
        if self.conversion is not None:
            captured = captured @ np.linalg.inv(np.array(self.conversion)).T.astype(np.float32)
        return captured


def to_d65(light: LightLike, tissue: Tissue) -> NDArray[np.float64]:
    """(3, 3) matrix from the RGB of captures under `light` to that under D65, rgb @ C.T.

    Of the paper's tissue the conversion that the paper took, of mixes of three bands
    (`colour.light_conversion`); of another, the one that suits its skins (`albedo.lights`).
    """
    return light_conversion(light) if tissue == ALIAGA2022 else skin_conversion(light, tissue)


def calibrate(
    rgb: ArrayLike,
    tissue: Tissue,
    white: White = None,
    exposure: Exposure = None,
    light: LightLike = "D65",
) -> Calibration:
    """Light and gains for masked texels `rgb` (n, 3) of linear sRGB.

    Gains are looked for in the albedo space of `tissue`. `light` is that of the capture, on which
    it is balanced: a name or file that `colour.illuminant` takes.
    `white` is "none", "auto" or three gains; `exposure` is "none", "auto" or one gain, which
    multiplies those of `white`. `white="auto"` looks for three gains, exposure included;
    `exposure="auto"` alone for one common gain.
    """
    matrix = to_d65(light, tissue)
    conversion = None
    if not np.array_equal(matrix, np.eye(3)):
        conversion = tuple(tuple(float(v) for v in row) for row in matrix)
        rgb = np.asarray(rgb) @ matrix.T
        name = named_light(light).name
    else:
        name = "D65"
    fixed = np.ones(3)
    if not (white is None or isinstance(white, str)):
        fixed = fixed * _checked(white, 3, "white")
    if not (exposure is None or isinstance(exposure, str)):
        fixed = fixed * _checked([exposure], 1, "exposure")
    for which, value in (("white", white), ("exposure", exposure)):
        if isinstance(value, str) and value not in ("none", "auto"):
            raise CutisError(f"{which} must be none, auto or numbers, not {value!r}")
    if white != "auto" and exposure != "auto":
        red, green, blue = (float(g) for g in fixed)
        origin = "given" if np.any(fixed != 1) else "none"
        return Calibration((red, green, blue), origin, name, conversion)
    directions = np.eye(3) if white == "auto" else np.ones((1, 3))
    found = search(np.asarray(rgb) * fixed, nearest_of(tissue), directions)
    red, green, blue = (float(g) for g in fixed * found)
    return Calibration((red, green, blue), "auto", name, conversion)


def _checked(values: Sequence[float], count: int, name: str) -> NDArray[np.float64]:
    try:
        gains = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        gains = np.empty(0)
    low, high = LIMITS
    if gains.shape != (count,) or not np.all((gains >= low) & (gains <= high)):
        numbers = "one number" if count == 1 else "three numbers (red,green,blue)"
        raise CutisError(f"{name} takes none, auto or {numbers} from {low:g} to {high:g}")
    return gains


def nearest_of(tissue: Tissue) -> Nearest:
    """Colours (n, 3) → those of the skins of a tissue that are fitted to them (n, 3)."""
    space = albedo_space(tissue)
    start = np.array([0.35, 0.4, 0.4, 0.5, 0.5])

    def nearest(colours: NDArray[np.float32]) -> NDArray[np.float32]:
        skins = fit(space, colours, start, np.eye(5), 3e-3, iterations=10)
        return space.rgb(from_coordinates(skins))

    return nearest


def search(
    rgb: NDArray[np.floating], nearest: Nearest, directions: ArrayLike | None = None
) -> NDArray[np.float64]:
    """The best gains (3,) of the form exp(x @ directions), for texels `rgb` (n, 3).

    Without `directions` (k, 3) each channel has a gain of its own.
    """
    from scipy.optimize import minimize

    bright = rgb[(rgb > 0.0).all(axis=1)]
    if len(bright) < 10:
        raise CutisError("too few texels with colour inside the mask to calibrate; check the mask")
    brightness = bright.mean(axis=1)
    bright = bright[brightness > DARK * np.percentile(brightness, 90)]
    # evenly along a curve through the colours, so that the sample is as spread as they are
    ordered = bright[curve_order(bright.astype(np.float32))]
    places = np.linspace(0, len(ordered) - 1, min(SAMPLE, len(ordered))).astype(int)
    sample = ordered[places].astype(np.float32)
    directions = np.asarray(np.eye(3) if directions is None else directions, dtype=np.float64)

    def cost(x: NDArray[np.floating]) -> float:
        log_gains = x @ directions
        colours = sample * np.exp(log_gains).astype(np.float32)
        error = (nearest(colours) - colours) / (colours.mean(axis=1, keepdims=True) + 0.01)
        r2 = (error.astype(np.float64) ** 2).sum(axis=1)
        return float(np.mean(r2 / (r2 + SCALE**2)) + PULL * np.sum(log_gains**2))

    # far from the space every texel is unexplained and the cost is flat, so the search starts at
    # the best of a few common exposures
    size = len(directions)
    common = np.linalg.lstsq(directions.T, np.ones(3), rcond=None)[0]
    start_at = min((exposure * common for exposure in EXPOSURES), key=cost)
    simplex = np.vstack([np.zeros(size), 0.15 * np.eye(size)])
    best = min(
        (
            minimize(
                cost,
                start_at,
                method="Nelder-Mead",
                options={
                    "initial_simplex": start_at + side * simplex,
                    "xatol": 4e-3,
                    "fatol": 1e-4,
                    "maxfev": 80,
                },
            )
            for side in (1.0, -1.0)
        ),
        key=lambda result: result.fun,
    )
    return np.exp(best.x @ directions)
