"""Which of several pictures in a file is the picture.

Pages of a TIFF may be thumbnails, masks or smaller copies of another, parts of an OpenEXR may hold
depth or what another eye sees.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import OpenImageIO as oiio

from cutis.textures import ifd
from cutis.textures.headers import Header
from cutis.textures.problem import shorten

MOST = 64
"""Pictures of a file that are looked at."""
_SEVERAL = ("tiff", "openexr")
_REDUCED, _TRANSPARENCY = 1, 4  # of TIFF's NewSubfileType
_OLD_REDUCED = 2  # of its SubfileType
_NAMED = 6  # others that a note lists


@dataclass(frozen=True)
class Part:
    """A picture of a file, counted from 0; `aside`: the file itself calls it a lesser one."""

    number: int
    name: str
    size: tuple[int, int]
    usable: bool
    aside: bool = False


def chosen_part(
    source: oiio.ImageInput, header: Header, usable: Callable[[oiio.ImageSpec], bool]
) -> tuple[int, list[str]]:
    """The number of the picture to read, and notes about the others, for people.

    The first full-size one that is `usable`: none that its file calls a thumbnail or a mask, and no
    smaller copy of another. The first where none is. `source` stands at that picture afterwards.
    """
    if header.format not in _SEVERAL:
        more = f"the file {header.more}; its first picture is read" if header.more else ""
        return 0, [more] if more else []
    parts: list[Part] = []
    while len(parts) < MOST and source.seek_subimage(len(parts), 0):
        parts.append(_part(source.spec(), len(parts), header, usable))
    source.geterror()  # of the one that is not there
    good = [part for part in parts if part.usable and not part.aside]
    good = good or [part for part in parts if part.usable]
    full = [part for part in good if not any(_copy_of(part, other) for other in good)]
    number = full[0].number if full else 0
    source.seek_subimage(number, 0)
    return number, _notes(parts, number, header.format) if full else []


def _part(
    spec: oiio.ImageSpec, number: int, header: Header, usable: Callable[[oiio.ImageSpec], bool]
) -> Part:
    name = spec.get_string_attribute("oiio:subimagename") or spec.get_string_attribute("name")
    aside = False
    if header.format == "tiff" and number < len(header.pages):
        page = header.pages[number]
        aside = bool(page.number(ifd.SUBFILE) & (_REDUCED | _TRANSPARENCY))
        aside |= page.number(ifd.OLD_SUBFILE) == _OLD_REDUCED
    size = (spec.width, spec.height)
    return Part(number, name, size, not spec.deep and usable(spec), aside)


def _copy_of(part: Part, other: Part) -> bool:
    """Whether a picture is another at half its size or less."""
    (width, height), (across, down) = part.size, other.size
    alike = abs(width * down - across * height) <= max(across, down)
    return alike and 2 * width <= across + 1 and 2 * height <= down + 1 and max(across, down) > 2


def _notes(parts: Sequence[Part], number: int, file_format: str) -> list[str]:
    chosen = parts[number]
    others = [
        part
        for part in parts
        if part is not chosen
        and not (part.number > number and (part.aside or _copy_of(part, chosen)))
    ]
    if not others:
        return []
    word = "page" if file_format == "tiff" else "part"
    listed = ", ".join(_called(part, word) for part in others[:_NAMED])
    rest = f" and {len(others) - _NAMED} more" if len(others) > _NAMED else ""
    count = f"{len(parts)}{' or more' if len(parts) == MOST else ''}"
    return [
        f"of {count} pictures {_called(chosen, word)} is read and edited; {listed}{rest} "
        f"{'is' if len(others) == 1 else 'are'} left out"
    ]


def _called(part: Part, word: str) -> str:
    size = f"{part.size[0]} × {part.size[1]}"
    name = f" {shorten(part.name)}" if part.name else ""
    return f"{word} {part.number + 1}{name} ({size})"
