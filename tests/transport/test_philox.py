"""Known answers of Philox 4×32-10, and what follows from it being counter-based."""

import numpy as np
import pytest

from cutis.transport.philox import philox

# From the test vectors that come with Random123 [salmon2011]: counter, key, answer.
KNOWN = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000",
     "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff",
     "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0",
     "d16cfe09 94fdcceb 5001e420 24126ea1"),
]  # fmt: skip


def words(text):
    return [np.uint64(int(word, 16)) for word in text.split()]


@pytest.mark.parametrize(("counter", "key", "answer"), KNOWN)
def test_known_answers(counter, key, answer):
    assert list(philox(*words(counter), *words(key))) == words(answer)


def test_words_are_uniform_over_counters():
    """χ² of the leading byte of every word over neighbouring counters."""
    from scipy.stats import chi2

    zero = np.zeros(1 << 16, dtype=np.uint64)
    counters = np.arange(1 << 16, dtype=np.uint64)
    for word in philox(counters, zero, zero, zero, np.uint64(5), np.uint64(0)):
        counts = np.bincount((word >> np.uint64(24)).astype(int), minlength=256)
        statistic = np.sum((counts - 256) ** 2 / 256)
        assert chi2.isf(1 - 1e-4, 255) < statistic < chi2.isf(1e-4, 255)
