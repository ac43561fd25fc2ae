"""What `cutis estimate` is given: files, folders, patterns and UDIM sets."""

import contextlib
import glob
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.optics import NAMES
from cutis.textures import TextureFile
from cutis.textures.headers import EXTENSIONS
from cutis.textures.udim import (
    TOKEN,
    missing_tiles,
    tile_of,
    tile_sets,
    udim_pattern,
    udim_tiles,
)

Set = tuple[Path, ...]
"""Captures that share one calibration."""
PICTURES = (*NAMES, "error", "sigma", "confidence")
RESULTS = (".skin.exr", ".model.exr", *(f".{name}.png" for name in PICTURES))
"""Ends of names that are results, not captures, where NAME.report.json lies beside."""


def capture_sets(
    words: Sequence[str],
    udim: bool,
    sequence: bool,
    say: Callable[[str], None] = lambda _: None,
    results: bool = True,
) -> list[Set]:
    """The captures that the words on the command line mean, in sets.

    A word is a file, NAME.<UDIM>.EXT, a folder, a pattern such as 'show/*.exr', or, after a folder,
    a pattern inside it. What is there under its name is no pattern. Tiles of a UDIM texture make
    one set: those of NAME.<UDIM>.EXT, of NAME.1001.EXT with `udim`, and those found side by side
    that are sure to be tiles (`textures.udim.tile_sets`); `say` is told of the others. With
    `sequence` all captures are one set. Where there will be `results`, names of captures differ.
    Raises CutisError where nothing is found.
    """
    sets: list[Set] = []
    words = list(words)
    while words:
        word = words.pop(0)
        path = Path(word)
        if _is_there(path, Path.is_dir):
            inside = None
            if words and _is_pattern(words[0]) and not Path(words[0]).is_absolute():
                inside = words.pop(0)
            sets += _found(path, inside, say)
        elif _is_there(path, Path.exists):
            sets.append(_whole_set(path) if udim else (path,))
        elif TOKEN in path.name:
            sets.append(tuple(udim_tiles(path).values()))
        elif _is_pattern(word):
            sets += _found(None, word, say)
        else:
            sets.append(_whole_set(path) if udim else (path,))
    if sequence:
        sets = [tuple(path for one in sets for path in one)]
    if not results:
        return sets
    seen: set[str] = set()
    for one in sets:
        for path in one:
            if path.stem in seen:
                raise CutisError(
                    f"{path}: another capture is called {path.stem} too, and results would "
                    "overwrite each other; estimate them into different folders"
                )
            seen.add(path.stem)
    return sets


def _whole_set(path: Path) -> Set:
    pattern = udim_pattern(path)
    if pattern is None:
        raise CutisError(f"{path}: with --udim a tile's name ends like face.1001.exr; rename it")
    return tuple(udim_tiles(pattern).values())


def _is_there(path: Path, how: Callable[[Path], bool]) -> bool:
    try:
        return how(path)
    except (OSError, ValueError):  # a name longer than names may be, or with a NUL
        return False


def _is_pattern(word: str) -> bool:
    """Whether a word that is no file's name stands for some."""
    return any(c in word for c in "*?[") and not _is_there(Path(word), Path.exists)


def _found(folder: Path | None, pattern: str | None, say: Callable[[str], None]) -> list[Set]:
    """Captures in a folder, those that match a pattern inside it, or those of a pattern alone."""
    names = glob.glob(pattern or "*", root_dir=folder, recursive=True)
    paths = [Path(name) if folder is None else folder / name for name in names]
    found = [
        path
        for path in sorted(paths)
        if _is_there(path, Path.is_file)
        and not path.name.startswith(".")
        and not _is_result(path)
        and (pattern is not None or path.suffix.lower() in EXTENSIONS)
    ]
    if not found:
        where = "" if folder is None else f"{folder}: "
        what = f"no file matches {pattern}" if pattern else "there is no image in this folder"
        inside = " in this folder" if pattern and folder is not None else ""
        raise CutisError(f"{where}{what}{inside}; check the name")
    sets = []
    for one, note in tile_sets(found):
        sets.append(one)
        if note:
            say(note)
    return sets


def _is_result(path: Path) -> bool:
    ends = (end for end in RESULTS if path.name.endswith(end))
    return any(path.with_name(f"{path.name[: -len(end)]}.report.json").is_file() for end in ends)


def gaps(captures: Set) -> list[str]:
    """Names of tiles that are missing between others of a row of a UDIM set."""
    patterns = {udim_pattern(path) for path in captures}
    pattern = patterns.pop() if len(patterns) == 1 else None
    if pattern is None or len(captures) < 2:
        return []
    head = len(pattern.name.partition(TOKEN)[0])
    numbers = [int(path.name[head : head + 4]) for path in captures]
    return [tile_of(pattern, number).name for number in missing_tiles(numbers)]


def odd_ones(captures: Set, colorspace: Space | None = None) -> list[str]:
    """What to say of captures of a set that are stored unlike most of it: depth, channels, space.

    Sizes may differ, as tiles' do. Captures that cannot be read are left to what reads them.
    """
    kinds: dict[Path, str] = {}
    for path in captures if len(captures) > 2 else ():
        with contextlib.suppress(CutisError), TextureFile(path, colorspace or "auto") as file:
            pixels = file.rows(slice(0, 0)).pixels
            kinds[path] = f"{pixels.dtype} {','.join(file.channels)} in {file.space.name}"
    counts = Counter(kinds.values()).most_common()
    if len(counts) < 2 or counts[0][1] == counts[1][1]:
        return []
    usual = counts[0][0]
    return [
        f"{path.name} is odd: it holds {kind}, most of its set {usual}"
        for path, kind in kinds.items()
        if kind != usual
    ]


def companion(path: Path | None, capture: Path) -> Path | None:
    """The mask that belongs to a capture: one file for all, or MASK.<UDIM>.EXT tile by tile."""
    if path is None or TOKEN not in path.name:
        return path
    pattern = udim_pattern(capture)
    if pattern is None:
        raise CutisError(f"{path}: {capture.name} is no UDIM tile that a mask could belong to")
    head = len(pattern.name.partition(TOKEN)[0])
    return tile_of(path, int(capture.name[head : head + 4]))
