"""Times are taken in turns, memory is what a call adds."""

import io
import sys
import time
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from cutis.apps.timing import (
    Timed,
    announced,
    copy_bandwidth,
    fastest,
    matrix_rate,
    peak_memory,
    race,
    table,
)


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


@pytest.mark.parametrize(("seconds", "rounds"), [(0, 1), (1, 1), (3, 3), (100, 5)])
def test_a_race_ends_in_time_but_not_before_its_first_round(seconds, rounds, monkeypatch):
    clock = SimpleNamespace(monotonic=count().__next__, perf_counter=time.perf_counter)
    monkeypatch.setattr("cutis.apps.timing.time", clock)  # a second each time it is asked
    entries = [Timed(name, "x", lambda: None, 1) for name in "ab"]
    assert len(list(race(entries, 5, seconds))) == 2 + 2 * rounds
    assert [len(e.seconds) for e in entries] == [rounds] * 2


def timed(system, step, seconds):
    return Timed(system, step, lambda: None, 10**9, list(seconds), 5_000_000)


def rows(rendered):
    text = io.StringIO()
    Console(width=120, file=text).print(rendered)
    return [" ".join(line.split()) for line in text.getvalue().splitlines()]


def test_ratios_are_to_the_faster_form_of_the_rival():
    entries = [
        timed("default", "encode", [0.5, 0.4, 0.6]),
        timed("default", "decode", [0.1]),
        timed("slow", "encode", [9]),
        timed("slow", "decode", [9]),
        timed("tiles", "encode", [8]),
        timed("tiles", "decode", [2]),
        timed("exact space", "41 bands", [1]),
    ]
    assert fastest(entries, ("slow", "tiles")) == "tiles"
    assert fastest(entries[:2], ("slow", "tiles")) is None
    heading, encode, decode, both, *_, spectra = rows(table(entries, 1e10, ("slow", "tiles")))
    assert heading == "best median ratio copying memory"
    assert encode == "default encode 0.400 s 0.500 s 20.00 25.0 % 5 MB"
    assert decode == "decode 0.100 s 0.100 s 20.00 100.0 % 5 MB"
    assert both == "both 0.500 s 20.00"
    assert spectra == "exact space 41 bands 1.000 s 1.000 s 10.0 % 5 MB"
    heading, encode, *_ = rows(table(entries, 1e10))
    assert heading == "best median copying memory"
    assert encode == "default encode 0.400 s 0.500 s 25.0 % 5 MB"


@pytest.mark.parametrize("terminal", [True, False])
def test_what_goes_on_is_said_with_and_without_a_terminal(terminal, monkeypatch):
    text = io.StringIO()
    monkeypatch.setattr(
        "cutis.apps.console.err", Console(file=text, force_terminal=terminal, width=80)
    )
    with announced(quiet=False) as say:
        say("making skins")
        time.sleep(0.3)
    assert "making skins" in text.getvalue()
    with announced(quiet=True) as say:
        say("in silence")
    assert "silence" not in text.getvalue()


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
