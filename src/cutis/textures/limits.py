"""How much a file may claim before it is believed."""

import os

from cutis.textures.problem import problem

LARGEST = 32768  # texels along a side
# Bytes of pixels that any header may claim, and beyond that how many times the length of its file.
# Flat colours come to 200 (JPEG), 650 (LZW), 960 to 1030 (deflate) times the length.
_ALWAYS = 64 << 20
_MOST_PACKED = 2000
_LARGEST_TILE = 256 << 20  # bytes: 9000 × 9000 texels of 8 bit RGB


def check_size(path: str | os.PathLike[str], width: int, height: int) -> None:
    """Refuse an image without texels or with a side longer than `LARGEST` texels."""
    if width < 1 or height < 1:
        raise problem(path, f"has no texels ({width} × {height}); export it again")
    if max(width, height) > LARGEST:
        what = f"claims {width} × {height} texels, the limit is {LARGEST} × {LARGEST}"
        raise problem(path, f"{what}; split it into tiles, or export it again if it is damaged")


def check_claim(path: str | os.PathLike[str], width: int, height: int, size: int) -> None:
    """Refuse `size` bytes of pixels that cannot be in so short a file."""
    length = os.stat(path).st_size
    if size > _ALWAYS and size > _MOST_PACKED * length:
        what = f"claims {width} × {height} texels, but is only {length} bytes long"
        raise problem(path, f"{what}; copy or export it again")


def check_tile(path: str | os.PathLike[str], width: int, height: int, size: int) -> None:
    """Refuse tiles that need more than 256 MiB each, whatever the image needs."""
    if size > _LARGEST_TILE or min(width, height) < 1:
        what = f"claims tiles of {width} × {height} texels"
        raise problem(path, f"{what}; copy or export it again, with smaller tiles")
