"""Work that goes on behind the main line, such as writing a band while the next is computed."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any


class Behind:
    """Calls in their order on one thread of their own; `call` waits until the one before is done.

    So no more than one band is on its way. What a call raises comes out of the next one, or of the
    end of the block.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="cutis-behind")
        self._last: Future[None] | None = None

    def call(self, function: Callable[..., None], *arguments: Any) -> None:
        """Begins `function(*arguments)` when the call before has ended."""
        self._wait()
        self._last = self._pool.submit(function, *arguments)

    def _wait(self) -> None:
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def __enter__(self) -> "Behind":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                self._wait()
        finally:
            self._pool.shutdown(cancel_futures=True)
