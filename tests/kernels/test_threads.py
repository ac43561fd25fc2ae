"""Loops on all cores: every item once, in pieces of one size, after a fork too."""

import multiprocessing
import os
import threading

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.kernels import threads, use_threads
from cutis.kernels.compiling import on_all_cores
from cutis.kernels.threads import share_out


@pytest.fixture(autouse=True)
def _as_before():
    yield
    use_threads(None)


@on_all_cores(5)
def _count(start, stop, counts, sizes):
    sizes[start // 5] = stop - start
    for i in range(start, stop):
        counts[i] += 1


@pytest.mark.parametrize("number", [1, 2, 7])
@pytest.mark.parametrize("count", [0, 1, 5, 6, 1003])
def test_every_item_once_in_pieces_of_one_size(number, count):
    use_threads(number)
    counts, sizes = np.zeros(count, int), np.zeros(-(-count // 5), int)
    _count(count, counts, sizes)
    assert np.all(counts == 1)
    assert np.all(sizes[:-1] == 5)


def test_pieces_are_shared_among_threads():
    """Two pieces that wait for each other end only if two threads work on them."""
    use_threads(2)
    both = threading.Barrier(2, timeout=60)
    share_out(lambda start, stop: both.wait(), 2, 1)


def test_an_exception_ends_the_loop_and_reaches_the_caller():
    use_threads(2)
    begun = []

    def fail(start, stop):
        begun.append(start)
        raise ValueError(f"at {start}")

    with pytest.raises(ValueError, match="at "):
        share_out(fail, 1000, 1)
    assert len(begun) <= 2
    share_out(lambda start, stop: begun.append(start), 10, 1)  # the pool lives


def test_callers_from_many_threads():
    use_threads(2)
    results = [np.zeros(999, int) for _ in range(8)]
    callers = [
        threading.Thread(target=_count, args=(999, counts, np.zeros(200, int)))
        for counts in results
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join(60)
    assert all(np.all(counts == 1) for counts in results)


def test_number_of_threads(monkeypatch):
    monkeypatch.delenv("CUTIS_THREADS", raising=False)
    if hasattr(os, "sched_getaffinity"):
        assert threads() == len(os.sched_getaffinity(0))
    monkeypatch.setenv("CUTIS_THREADS", "3")
    assert threads() == 3
    use_threads(5)
    assert threads() == 5
    use_threads(None)
    assert threads() == 3
    with pytest.raises(CutisError, match="from 1 to"):
        use_threads(0)


@pytest.mark.parametrize("wrong", ["0", "-1", "two", "1.5", "99999", "²"])
def test_wrong_numbers_are_refused(wrong, monkeypatch):
    monkeypatch.setenv("CUTIS_THREADS", wrong)
    with pytest.raises(CutisError, match=r"CUTIS_THREADS = .*from 1 to"):
        threads()


def _estimated(rgb):
    import cutis

    return cutis.estimate(rgb).melanin


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_a_fork_after_use_computes_too(face_rgb):
    """What data loaders do: the parent has used all of it, and its children go on."""
    use_threads(2)
    large = np.tile(face_rgb, (8, 8, 1))
    here = _estimated(large)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        there = pool.map_async(_estimated, [large] * 4).get(timeout=120)
    for melanin in there:
        np.testing.assert_array_equal(melanin, here)
