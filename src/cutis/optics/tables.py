"""Measured and standard tables that ship with the package, as CSV with `#` comments."""

from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray


@cache
def packaged_table(folder: str, name: str) -> dict[str, NDArray[np.float64]]:
    """Columns of data/`folder`/`name`.csv by the names of its header row, read-only, read once."""
    text = resources.files("cutis.data").joinpath(folder, f"{name}.csv").read_text("utf-8")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    table = np.array([[float(cell) for cell in row.split(",")] for row in lines[1:]]).T
    table.flags.writeable = False
    return dict(zip(lines[0].split(","), table, strict=True))
