"""All checks of one texture, in the order in which people mend things."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cutis.checks import calibration, colour_space, content, gloss, grain, light, orientation, tones
from cutis.checks.evidence import Evidence
from cutis.checks.finding import Finding
from cutis.checks.gathering import Gathered, Gathering, Stored
from cutis.checks.thresholds import Limits, Thresholds, shipped
from cutis.checks.tone import Tone, tone

if TYPE_CHECKING:
    from cutis.inverse import Model
    from cutis.maps import FileCapture

Check = Callable[[Evidence, Limits], Iterator[Finding]]

CHECKS: Sequence[tuple[str, Check]] = (
    ("scale", content.scale),
    ("mask", content.mask),
    ("size", content.amount),
    ("orientation", orientation.check),
    ("colour-space", colour_space.check),
    ("not-skin", content.skin),
    ("exposure", calibration.exposure),
    ("cast", calibration.cast),
    ("baked-light", light.check),
    ("occlusion", light.occlusion),
    ("gloss", gloss.check),
    ("clipped", tones.clipped),
    ("crushed", tones.crushed),
    ("banding", grain.banding),
    ("jpeg-blocks", grain.blocks),
)
"""Checks by the name of their thresholds."""
ENDS = {"scale", "size", "flat", "mask-inverted"}
"""Kinds after whose finding nothing else can be said: numbers mean something else, or nothing."""
INSTEAD = {"colour-space": {"exposure", "cast", "not-skin", "banding"}, "not-skin": {"baked-light",
           "occlusion", "gloss", "exposure", "cast"}}  # fmt: skip
"""What is not asked where something else was found that explains it."""


@dataclass(frozen=True)
class Examined:
    """What the checks say of a texture, and its tone; None where no skin is seen."""

    findings: tuple[Finding, ...]
    tone: Tone | None = None


def watch(capture: "FileCapture") -> Gathering:
    """Gathers from now on what is read of a capture; `finish` it when all bands have been."""
    texture = capture.texture
    first = texture.rows(slice(0, 0))
    stored = Stored(
        first.pixels.dtype.name, texture.space, texture.origin, texture.turned,
        orientation.tag_of(texture),
    )  # fmt: skip
    found = Gathering(texture.shape, stored, capture.mask is not None)
    capture.watched = found.add
    return found


def gather(capture: "FileCapture") -> Gathered:
    """One pass over an open capture."""
    found = watch(capture)
    for rows in capture.bands():
        capture.rows(rows)
    return found.finish()


def examine(
    gathered: Gathered, model: "Model | None" = None, limits: Thresholds | None = None
) -> Examined:
    """All that the checks find in a texture, judged by a model (the default) and thresholds."""
    if model is None:
        from cutis.maps import load_model

        model = load_model()
    seen, found = Evidence(gathered, model), list[Finding]()
    limits = limits or shipped()
    for name, check in CHECKS:
        kinds = {one.kind for one in found if one.level == "finding"}
        if any(name in INSTEAD.get(kind, ()) for kind in kinds):
            continue
        found += check(seen, limits[name])
        if any(one.kind in ENDS for one in found):
            return Examined(tuple(found))
    return Examined(tuple(found), tone(seen))
