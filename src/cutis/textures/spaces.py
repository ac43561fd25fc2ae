"""Colour spaces by name, and their siblings in files of another kind."""

import difflib

from cutis.colour.spaces import ALIASES, LINEAR, REC709, SPACES, SRGB, RGBSpace, Space, rgb_space
from cutis.errors import CutisError
from cutis.textures.ocio import configured, ocio_names, ocio_space

MOST = 8
"""Names shown of the many that there are."""


def colour_space(name: str, config: str | None = None) -> Space:
    """The space called `name`: a colour space, role or alias of OpenColorIO, or one of ours.

    With a configuration, `config` or $OCIO, its names come first; without, or with `config` "",
    sRGB, linear, ACEScg, Display P3 and Rec.2020 are ours and the rest are those of OpenColorIO's
    ACES studio configuration. Raises CutisError for a name that neither has.
    """
    config = (configured() if config is None else config) or None
    if config is not None:
        found = ocio_space(name, config)
        if found is not None:
            return found
    try:
        return rgb_space(name)
    except CutisError:
        other = None if config is not None else ocio_space(name)
        if other is not None:
            return other
    where = f" in {config}" if config else ""
    raise CutisError(f"unknown colour space {name!r}{where}; {_suggestion(name, config)}")


def _suggestion(name: str, config: str | None) -> str:
    """Names close to `name`, else some of those known: configurations hold hundreds."""
    spaces, others = ocio_names(config)
    if not spaces:
        ours = ", ".join(space.name for space in SPACES)
        return f"known are {ours}; others need OpenColorIO: pip install opencolorio"
    spaces = list(dict.fromkeys([*(space.name for space in SPACES), *spaces]))
    by_case = {known.lower(): known for known in [*others, *ALIASES, *spaces]}
    close = difflib.get_close_matches(name.lower(), by_case, n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(by_case[one] for one in close)}?"
    shown, more = ", ".join(spaces[:MOST]), len(spaces) - MOST
    return f"known are {shown}" + (f" and {more} more" if more > 0 else "")


def _linear_p3() -> RGBSpace:
    return rgb_space("Display P3").with_curve(False)


def sibling(space: Space, encoded: bool) -> Space:
    """The space for the same colours in a file of the other kind: encoded integers, linear floats.

    The same primaries where they are sRGB's or P3's or the result is linear; else sRGB's.
    """
    if space.encoded == encoded:
        return space
    if isinstance(space, RGBSpace) and (
        not encoded or space.primaries == REC709 or space == _linear_p3()
    ):
        return space.with_curve(encoded)
    return SRGB if encoded else LINEAR
