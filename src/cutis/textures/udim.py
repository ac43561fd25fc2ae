"""UDIM sets: the tiles of one texture, NAME.1001.EXT, NAME.1002.EXT, …"""

import re
from collections.abc import Sequence
from pathlib import Path

from cutis.textures.problem import problem

TOKEN = "<UDIM>"
FIRST, LAST = 1001, 1999
"""Tile numbers: 1001 + column + 10 · row, columns 0 to 9."""
_NUMBER = re.compile(r"^(?P<head>.*[._])(?P<tile>\d{4})(?P<tail>(\.[A-Za-z]\w*)+)$")


def udim_pattern(path: Path) -> Path | None:
    """NAME.<UDIM>.EXT of a tile NAME.1001.EXT or NAME_1001.EXT; None for other names."""
    match = _NUMBER.match(path.name)
    if match is None or not FIRST <= int(match["tile"]) <= LAST:
        return None
    return path.with_name(f"{match['head']}{TOKEN}{match['tail']}")


def udim_tiles(pattern: Path) -> dict[int, Path]:
    """Tiles by number of NAME.<UDIM>.EXT, in order.

    Raises CutisError where there are none, and for files that have the form of a tile but no tile's
    number (NAME.0999.EXT, NAME.10010.EXT), which somebody misnamed.
    """
    head, _, tail = pattern.name.partition(TOKEN)
    folder = pattern.parent
    if not folder.is_dir():
        raise problem(pattern, f"the folder {folder} does not exist; check the name")
    tiles: dict[int, Path] = {}
    for path in sorted(folder.iterdir()):
        middle = path.name[len(head) : len(path.name) - len(tail)]
        like = path.name.startswith(head) and path.name.endswith(tail) and middle.isdigit()
        if not like or not path.is_file():
            continue
        if len(middle) != 4 or not FIRST <= int(middle) <= LAST:
            raise problem(path, f"is no UDIM tile ({FIRST} to {LAST}); rename or remove it")
        tiles[int(middle)] = path
    if not tiles:
        raise problem(pattern, "no tile is there; check the name")
    return tiles


def missing_tiles(numbers: Sequence[int]) -> list[int]:
    """Numbers left out in a row of tiles between its first and its last."""
    missing = []
    for row in sorted({(number - FIRST) // 10 for number in numbers}):
        columns = [number for number in numbers if (number - FIRST) // 10 == row]
        missing += [n for n in range(min(columns), max(columns)) if n not in columns]
    return missing


def tile_of(pattern: Path, number: int) -> Path:
    """The tile `number` of NAME.<UDIM>.EXT; a name without <UDIM> is itself."""
    return pattern.with_name(pattern.name.replace(TOKEN, str(number)))
