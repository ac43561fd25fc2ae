"""Files that an OpenColorIO configuration names, looked at before the library reads them.

A configuration may come from a stranger, and a look-up table that it names may be any file of this
machine: one that never ends, or that is nobody's business.
"""

import os
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.textures.problem import problem
from cutis.textures.regular import open_regular

LONGEST_CONFIG, LONGEST_LOOKUP, LONGEST_ARCHIVE = 64 << 20, 256 << 20, 1 << 30
"""Bytes; those of ACES are below 1 MiB, 10 MiB and 300 MiB."""
_DEEPEST = 8  # files that name files
_REFERENCE = re.compile(rb"""<Reference\b[^>]*?\bpath\s*=\s*["']([^"']+)["']""", re.IGNORECASE)
_MAY_REFER = (".ctf", ".clf")


def check_config_file(path: str) -> None:
    """Refuse a configuration that is no regular file, or one longer than they are.

    Raises CutisError, one line. Names such as ocio://default are built in and fine.
    """
    if "://" in path:
        return
    archive = path.lower().endswith(".ocioz")
    with open_regular(path, LONGEST_ARCHIVE if archive else LONGEST_CONFIG) as file:
        if not archive:
            return
        try:
            with zipfile.ZipFile(file) as held:
                sizes = [entry.file_size for entry in held.infolist()]
        except (zipfile.BadZipFile, ValueError, NotImplementedError, OSError):
            return  # the library has its own words
    if sum(sizes) > LONGEST_ARCHIVE or max(sizes, default=0) > LONGEST_LOOKUP:
        raise problem(path, "holds more than a configuration does; check where it comes from")


def check_lookups(known: Any, config: str, spaces: tuple[str, ...]) -> None:
    """Refuse to read what the transforms of `spaces` of the configuration `known` should not name.

    Look-up tables must be regular files of at most 256 MiB, in the configuration's folder or in one
    of its search path. Raises CutisError, one line. What is missing is left to the library.
    """
    if "://" in config:
        return
    folder = Path(os.path.abspath(config)).parent
    folders = [folder, *(folder / one for one in known.getSearchPaths() if one)]
    context = known.getCurrentContext()
    for source in sorted(set(_sources(known, spaces))):
        _check(config, context, source, [Path(os.path.normpath(one)) for one in folders], 0)


def _check(config: str, context: Any, source: str, folders: list[Path], depth: int) -> None:
    try:
        found = Path(context.resolveFileLocation(source))
    except Exception:  # OpenColorIO's own kinds: it is missing
        return
    found = Path(os.path.normpath(folders[0] / found))
    if not any(found.is_relative_to(folder) for folder in folders):
        what = f"names {source}, which is outside its folder and search path; copy it there"
        raise problem(config, what)
    try:
        with open_regular(found, LONGEST_LOOKUP) as file:
            content = file.read() if found.suffix.lower() in _MAY_REFER else b""
    except CutisError as error:
        raise problem(config, f"names a look-up table that cannot be used: {error}") from error
    for name in _REFERENCE.findall(content):
        if depth == _DEEPEST:
            raise problem(config, f"its look-up table {source} names others without end")
        other = os.fsdecode(name)
        beside = found.parent / other
        _check(config, context, str(beside) if beside.exists() else other, folders, depth + 1)


def _sources(known: Any, spaces: tuple[str, ...]) -> Iterator[str]:
    """What the transforms of some spaces read; of all, where they lead through others."""
    import PyOpenColorIO as ocio

    directions = (ocio.COLORSPACE_DIR_TO_REFERENCE, ocio.COLORSPACE_DIR_FROM_REFERENCE)
    waiting = [known.getColorSpace(name).getTransform(d) for name in spaces for d in directions]
    everything = False
    while waiting:
        transform = waiting.pop()
        if transform is None:
            continue
        if isinstance(transform, ocio.FileTransform):
            yield transform.getSrc()
        elif isinstance(transform, ocio.GroupTransform):
            waiting += list(transform)
        elif not everything and isinstance(
            transform, ocio.ColorSpaceTransform | ocio.LookTransform | ocio.DisplayViewTransform
        ):
            everything = True
            waiting += list(_transforms(known))


def _transforms(known: Any) -> Iterator[Any]:
    """All transforms of a configuration."""
    import PyOpenColorIO as ocio

    for space in known.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL):
        yield space.getTransform(ocio.COLORSPACE_DIR_TO_REFERENCE)
        yield space.getTransform(ocio.COLORSPACE_DIR_FROM_REFERENCE)
    for view in known.getViewTransforms():
        yield view.getTransform(ocio.VIEWTRANSFORM_DIR_TO_REFERENCE)
        yield view.getTransform(ocio.VIEWTRANSFORM_DIR_FROM_REFERENCE)
    for look in known.getLooks():
        yield from (look.getTransform(), look.getInverseTransform())
    for named in known.getNamedTransforms(ocio.NAMEDTRANSFORM_ALL):
        yield named.getTransform(ocio.TRANSFORM_DIR_FORWARD)
        yield named.getTransform(ocio.TRANSFORM_DIR_INVERSE)
