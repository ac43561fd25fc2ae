"""Functions as machine code, by Numba [lam2015numba].

Every compiled function of the package is made here, so that all of them let go of Python's lock,
divide as NumPy does, and are kept between runs (`keeping.py`). A module that imports this one is
taken for a source of machine code, and so is all that it imports: keep such modules small.
"""

import os
from collections.abc import Callable
from functools import wraps
from typing import Any

from cutis.errors import CutisError

if os.environ.get("NUMBA_DISABLE_JIT", "0").strip() not in ("", "0"):
    raise CutisError("NUMBA_DISABLE_JIT is set, but cutis computes with machine code; unset it")
try:
    from numba import njit, types
    from numba.core import cgutils
    from numba.extending import intrinsic
except ImportError:
    raise
except Exception as error:  # of settings that Numba checks while it is imported
    said = ", ".join(f"{k}={v}" for k, v in os.environ.items() if k.startswith("NUMBA_"))
    raise CutisError(f"Numba does not start with {said} ({error}); unset what is wrong") from error

from cutis.kernels.keeping import KeptCode
from cutis.kernels.threads import share_out

__all__ = ["cgutils", "compiled", "intrinsic", "on_all_cores", "types"]
"""Parts of Numba are imported from here, so that what is wrong with its settings is said above."""


def compiled(*, fast: bool = False, inline: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Decorator that makes machine code of a function when it is first called.

    `fast` lets the compiler reorder sums and takes for granted that no number is NaN or infinite;
    `inline` puts the function's code where it is called. Raises no ZeroDivisionError.
    """

    def compile(function: Callable[..., Any]) -> Any:
        made: Any = njit(
            nogil=True,
            error_model="numpy",
            fastmath=fast,
            inline="always" if inline else "never",
        )(function)
        # one made inside another function may hold values of that one, which no source tells
        if not inline and "<locals>" not in function.__qualname__:
            made._cache = KeptCode(function)
        return made

    return compile


def on_all_cores(size: int, *, fast: bool = False) -> Callable[[Callable[..., None]], Any]:
    """Decorator that makes a loop of `kernel(start, stop, *arguments)`, called with (count, …).

    The loop goes from 0 to `count` in pieces of `size`, on all cores; who does a piece changes
    nothing in what is done.
    """

    def compile(kernel: Callable[..., None]) -> Any:
        made = compiled(fast=fast)(kernel)

        @wraps(kernel)
        def loop(count: int, *arguments: Any) -> None:
            share_out(made, count, size, *arguments)

        return loop

    return compile
