"""UDIM sets: the tiles of one texture, NAME.1001.EXT, NAME.1002.EXT, …"""

import contextlib
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from cutis.errors import CutisError
from cutis.textures.decoding import Decoder
from cutis.textures.problem import problem

TOKEN = "<UDIM>"
FIRST, LAST = 1001, 1999
"""Tile numbers: 1001 + column + 10 · row, columns 0 to 9."""
_CAMERAS = re.compile(r"_?(IMG|MG|DSC|DJI|PXL|MVI|SAM|PIC|\d{3})")
"""What cameras put in front of the numbers of their pictures."""
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


def tile_numbers(paths: Sequence[Path]) -> tuple[int, ...]:
    """Numbers of files that are the tiles of one texture, in order; none where they are not."""
    patterns = {udim_pattern(path) for path in paths}
    pattern = patterns.pop() if len(patterns) == 1 and len(paths) > 1 else None
    if pattern is None:
        return ()
    head = len(pattern.name.partition(TOKEN)[0])
    return tuple(sorted(int(path.name[head : head + 4]) for path in paths))


def missing_tiles(numbers: Sequence[int]) -> list[int]:
    """Numbers left out in a row of tiles between its first and its last."""
    missing = []
    for row in sorted({(number - FIRST) // 10 for number in numbers}):
        columns = [number for number in numbers if (number - FIRST) // 10 == row]
        missing += [n for n in range(min(columns), max(columns)) if n not in columns]
    return missing


def tile_sets(paths: Sequence[Path]) -> Iterator[tuple[tuple[Path, ...], str]]:
    """Files found side by side in sets: the tiles of a texture, and the others one by one.

    Names alone are no evidence, since cameras and frames number files too: tiles are those that
    begin with 1001, leave none of a row out and are of one size. With each set comes a note for
    people, "" for none: why files with names of tiles are not taken for tiles.
    """
    groups: dict[Path, list[Path]] = {}
    for path in paths:
        groups.setdefault(udim_pattern(path) or path, []).append(path)
    for pattern, found in groups.items():
        doubt = "" if len(found) < 2 else _doubt(pattern, found)
        if not doubt:
            yield tuple(found), ""
            continue
        note = (
            f"{found[0].name} and {len(found) - 1} more like it are taken for separate captures, "
            f"not for tiles of one texture: {doubt}; if they are, give {pattern.name}"
        )
        for path in found:
            yield (path,), note if path is found[0] else ""


def _doubt(pattern: Path, found: Sequence[Path]) -> str:
    """Why files with names of tiles may be none; "" where nothing speaks against it."""
    head = pattern.name.partition(TOKEN)[0]
    numbers = [int(path.name[len(head) : len(head) + 4]) for path in found]
    if _CAMERAS.fullmatch(head[:-1]):
        return "cameras name their pictures so"
    if FIRST not in numbers:
        return f"there is no tile {FIRST}"
    missing = missing_tiles(numbers)
    if missing:
        return f"tile {missing[0]} is missing"
    sizes = set()
    for path in found:
        with contextlib.suppress(CutisError), Decoder(path) as file:
            sizes.add(file.shape)
    return "their sizes differ" if len(sizes) > 1 else ""


def tile_of(pattern: Path, number: int) -> Path:
    """The tile `number` of NAME.<UDIM>.EXT; a name without <UDIM> is itself."""
    return pattern.with_name(pattern.name.replace(TOKEN, str(number)))
