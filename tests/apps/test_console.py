"""Progress, and what becomes of Ctrl-C under it."""

import contextlib
import signal

import pytest

from cutis.apps.console import steps


def test_nothing_is_shown_where_nobody_watches(capfd):
    for quiet in (True, False):
        with steps(3, quiet) as progress:
            progress.step("one")
            progress.at(2, 3, "two")
    assert capfd.readouterr() == ("", "")


def test_an_interrupt_that_a_library_swallowed_comes_back_at_the_next_step():
    before = signal.getsignal(signal.SIGINT)
    with steps(2, True) as progress:
        progress.step("one")
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            progress.step("two")
    assert signal.getsignal(signal.SIGINT) is before
