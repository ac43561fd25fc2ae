"""What only we run: the tools behind what ships and what the documentation shows."""

import sys
from typing import Any

READ: set[str] = set()
"""Names of the files that this process has opened to read; see `studies.generated`."""


def _listen(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and isinstance(arguments[0], str) and arguments[1] in ("r", "rb", None):
        READ.add(arguments[0])


sys.addaudithook(_listen)
