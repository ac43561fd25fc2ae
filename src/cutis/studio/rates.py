"""How much one page may ask for in a time."""

import time


class Rate:
    """A bucket that fills with `each` tokens a second up to `most`; what is asked for takes one."""

    def __init__(self, each: float, most: float) -> None:
        self._each, self._most, self._left = each, most, most
        self._last = time.monotonic()

    def take(self, cost: float = 1.0) -> bool:
        """Whether there was enough, which is then taken."""
        now = time.monotonic()
        self._left = min(self._most, self._left + (now - self._last) * self._each)
        self._last = now
        if self._left < cost:
            return False
        self._left -= cost
        return True
