import threading
import time

import pytest

from cutis.kernels.behind import Behind


def test_calls_keep_their_order_and_do_not_pile_up():
    said, here = [], threading.get_ident()

    def slow(number):
        time.sleep(0.01)
        said.append((number, threading.get_ident()))

    with Behind() as behind:
        for number in range(5):
            behind.call(slow, number)
            assert len(said) >= number
    assert [number for number, _ in said] == list(range(5))
    assert here not in {where for _, where in said}


def fails():
    raise OSError("no room")


def twice():
    with Behind() as behind:
        behind.call(fails)
        behind.call(print)


def last():
    with Behind() as behind:
        behind.call(fails)


@pytest.mark.parametrize("run", [twice, last])
def test_what_is_raised_comes_out(run):
    with pytest.raises(OSError, match="no room"):
        run()


def both():
    with Behind() as behind:
        behind.call(fails)
        raise ValueError("mine")


def test_an_error_of_the_main_line_comes_first():
    with pytest.raises(ValueError, match="mine"):
        both()
