"""A light as a value: its name, and its spectrum read once."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour.observer import LightLike, illuminant


@dataclass(frozen=True, eq=False)
class Light:
    """`power` (81,), relative, at `observer.wavelengths`; of a file, `name` is that of the file."""

    name: str
    power: NDArray[np.float64]

    @property
    def digest(self) -> str:
        """SHA-256 of the spectrum."""
        return hashlib.sha256(np.ascontiguousarray(self.power, "<f8").tobytes()).hexdigest()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Light):
            return NotImplemented
        return self.name == other.name and np.array_equal(self.power, other.power)

    def __hash__(self) -> int:
        return hash((self.name, self.digest))

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"<light {self.name}>"


def light(name: LightLike) -> Light:
    """The light of a name or file that `illuminant` takes; a `Light` is itself."""
    if isinstance(name, Light):
        return name
    power = illuminant(name)
    if not isinstance(name, str):
        return Light("a light", power)
    return Light(Path(name).name if Path(name).is_file() else name, power)
