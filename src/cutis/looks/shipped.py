"""The documents of looks that come with cutis."""

from functools import cache
from importlib import resources

END = ".look.json"


@cache
def names() -> tuple[str, ...]:
    """Names of all presets, in the order of the alphabet."""
    folder = resources.files("cutis.data").joinpath("looks")
    found = (file.name for file in folder.iterdir())
    return tuple(sorted(name.removesuffix(END) for name in found if name.endswith(END)))


def document(name: str) -> bytes:
    """The JSON of one of them."""
    return resources.files("cutis.data").joinpath("looks", f"{name}{END}").read_bytes()
