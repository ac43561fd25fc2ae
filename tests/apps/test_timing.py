"""Times are taken in turns, memory is what a call adds."""

import sys
import time

import numpy as np
import pytest

from cutis.apps.timing import Timed, copy_bandwidth, matrix_rate, peak_memory, race


def test_entries_take_turns():
    order = []
    entries = [
        Timed("a", "x", lambda: order.append("a"), 1),
        Timed("b", "x", lambda: order.append("b"), 1),
    ]
    announced = [entry.system for entry in race(entries, 3)]
    assert announced == ["a", "b"] * 4
    assert order == ["a", "a", "b", "b", *["a", "b"] * 3]
    assert [len(e.seconds) for e in entries] == [3, 3]


def test_seconds_are_those_of_the_run():
    waits = iter([0, 0, 0.05, 0.02, 0.03])
    entry = Timed("a", "x", lambda: time.sleep(next(waits)), 1)
    for _ in race([entry], 3):
        pass
    assert 0.02 <= entry.best < 0.03 <= entry.median < 0.05 <= max(entry.seconds)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is known on Linux only")
def test_peak_memory_is_what_was_there_for_a_moment():
    peak = peak_memory(lambda: np.ones(30_000_000).sum())  # 240 MB, gone at the end
    assert peak is not None
    assert 230e6 < peak < 300e6
    small = peak_memory(lambda: None)
    assert small is not None
    assert small < 20e6


def test_floors_are_of_this_machine():
    assert 1e8 < copy_bandwidth(1, repeats=1, size=1 << 22) < 1e13
    assert 1e8 < matrix_rate(repeats=1, size=64) < 1e14
