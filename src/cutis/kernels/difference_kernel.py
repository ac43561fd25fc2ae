"""Compiled CIELAB and CIEDE2000 over many texels [cie15] [sharma2005ciede2000].

colour-science has both, at some 2 µs a texel and with temporaries many times the image; tests hold
these kernels against it.
"""

import math
from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 4096
"""Texels that a thread works on at a time."""
EPSILON, KAPPA = 216 / 24389, 24389 / 27
"""Where the cube root of CIELAB turns into a line, and how steep that is."""
POWER_25_7 = 25.0**7


@compiled(inline=True)
def _f(t: Any) -> Any:
    return np.cbrt(t) if t > EPSILON else (KAPPA * t + 16.0) / 116.0


@compiled()
def relative_lab(red: Any, green: Any, blue: Any, m: Any) -> Any:
    """CIELAB of linear RGB; `m` (3, 3) gives XYZ over that of white."""
    fx = _f(m[0, 0] * red + m[0, 1] * green + m[0, 2] * blue)
    fy = _f(m[1, 0] * red + m[1, 1] * green + m[1, 2] * blue)
    fz = _f(m[2, 0] * red + m[2, 1] * green + m[2, 2] * blue)
    return 116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)


@compiled()
def _hue(b: Any, a: Any) -> Any:
    """Degrees from 0 to 360; 0 for grey."""
    if a == 0.0 and b == 0.0:
        return 0.0
    h = math.degrees(math.atan2(b, a))
    return h + 360.0 if h < 0.0 else h


@compiled()
def colour_difference(l1: Any, a1: Any, b1: Any, l2: Any, a2: Any, b2: Any) -> Any:
    """CIEDE2000 with k_L = k_C = k_H = 1; equation numbers of Sharma et al."""
    mean = 0.5 * (math.hypot(a1, b1) + math.hypot(a2, b2))  # (3)
    m7 = mean**7
    g = 0.5 * (1.0 - math.sqrt(m7 / (m7 + POWER_25_7)))  # (4)
    a1, a2 = (1.0 + g) * a1, (1.0 + g) * a2  # (5)
    c1, c2 = math.hypot(a1, b1), math.hypot(a2, b2)
    h1, h2 = _hue(b1, a1), _hue(b2, a2)  # (7)
    dl, dc = l2 - l1, c2 - c1
    dh = h2 - h1 if c1 * c2 != 0.0 else 0.0  # (10)
    if dh > 180.0:
        dh -= 360.0
    elif dh < -180.0:
        dh += 360.0
    big_h = 2.0 * math.sqrt(c1 * c2) * math.sin(math.radians(0.5 * dh))  # (11)
    lm, cm = 0.5 * (l1 + l2), 0.5 * (c1 + c2)
    total = h1 + h2  # (14)
    if c1 * c2 == 0.0:
        hm = total
    elif abs(h1 - h2) <= 180.0:
        hm = 0.5 * total
    else:
        hm = 0.5 * (total + 360.0) if total < 360.0 else 0.5 * (total - 360.0)
    t = (
        1.0
        - 0.17 * math.cos(math.radians(hm - 30.0))
        + 0.24 * math.cos(math.radians(2.0 * hm))
        + 0.32 * math.cos(math.radians(3.0 * hm + 6.0))
        - 0.20 * math.cos(math.radians(4.0 * hm - 63.0))
    )  # (15)
    turn = 30.0 * math.exp(-(((hm - 275.0) / 25.0) ** 2))  # (16)
    cm7 = cm**7
    rc = 2.0 * math.sqrt(cm7 / (cm7 + POWER_25_7))  # (17)
    lm50 = (lm - 50.0) ** 2
    sl = 1.0 + 0.015 * lm50 / math.sqrt(20.0 + lm50)  # (18)
    sc, sh = 1.0 + 0.045 * cm, 1.0 + 0.015 * cm * t  # (19), (20)
    x, y, z = dl / sl, dc / sc, big_h / sh
    rt = -math.sin(math.radians(2.0 * turn)) * rc  # (21)
    return math.sqrt(max(x * x + y * y + z * z + rt * y * z, 0.0))  # (22)


@on_all_cores(PIECE)
def lab_kernel(start: Any, stop: Any, rgb: Any, m: Any, out: Any) -> None:
    """Fills out (n, 3) with CIELAB of rgb (n, 3)."""
    for i in range(start, stop):
        out[i, 0], out[i, 1], out[i, 2] = relative_lab(rgb[i, 0], rgb[i, 1], rgb[i, 2], m)


@on_all_cores(PIECE)
def delta_e_kernel(start: Any, stop: Any, one: Any, two: Any, m: Any, out: Any) -> None:
    """Fills out (n,) with the CIEDE2000 of linear RGB one (n, 3) and two (n, 3)."""
    for i in range(start, stop):
        l1, a1, b1 = relative_lab(one[i, 0], one[i, 1], one[i, 2], m)
        l2, a2, b2 = relative_lab(two[i, 0], two[i, 1], two[i, 2], m)
        out[i] = colour_difference(l1, a1, b1, l2, a2, b2)
