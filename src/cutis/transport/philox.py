"""Counter-based random numbers: Philox 4×32 with ten rounds [salmon2011].

A number is a function of (counter, key) alone, not of the numbers drawn before it. So every photon
of every case has numbers of its own, and a simulation gives the same answer in whatever order and
on however many threads or devices it runs.

The function is plain Python on 64-bit unsigned integers that hold 32-bit words; callers compile it
(`history.py`).
"""

from typing import Any

import numpy as np

MULTIPLIER_0, MULTIPLIER_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
WEYL_0, WEYL_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
WORD, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


def philox(c0: Any, c1: Any, c2: Any, c3: Any, k0: Any, k1: Any) -> Any:
    """Four random 32-bit words of the counter (c0, c1, c2, c3) and the key (k0, k1)."""
    for _ in range(10):
        p, q = MULTIPLIER_0 * c0, MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (q >> HALF) ^ c1 ^ k0, q & WORD, (p >> HALF) ^ c3 ^ k1, p & WORD
        k0, k1 = (k0 + WEYL_0) & WORD, (k1 + WEYL_1) & WORD
    return c0, c1, c2, c3
