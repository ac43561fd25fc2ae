"""Progress, and what becomes of Ctrl-C under it."""

import contextlib
import signal

import pytest

from cutis.apps.console import bar


def test_nothing_is_shown_where_nobody_watches(capfd):
    for quiet in (True, False):
        with bar(quiet) as progress:
            progress(0, 3, "one")
            progress(2, 3, "two")
    assert capfd.readouterr() == ("", "")


def test_an_interrupt_that_a_library_swallowed_comes_back_at_the_next_step():
    before = signal.getsignal(signal.SIGINT)
    with bar(True) as progress:
        progress(0, 2, "one")
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            progress(1, 2, "two")
    assert signal.getsignal(signal.SIGINT) is before
