"""Looks: edits of a skin as documents with layers and masks, which do the same anywhere."""

from cutis.looks import presets
from cutis.looks.edits import (
    Blend,
    Ceiling,
    Contrast,
    Floor,
    Multiply,
    Offset,
    Set,
    Soften,
)
from cutis.looks.layer import Layer
from cutis.looks.look import Look, asked, nothing
from cutis.looks.masks import MaskPart
from cutis.looks.pictures import PicturePart, RegionsPart
from cutis.looks.procedural import BlotchesPart, FrecklesPart, PatchesPart
from cutis.looks.ranges import RangePart
from cutis.looks.strokes import Stroke, StrokesPart
from cutis.looks.tone import Like, Tone, tone_of
from cutis.looks.tone_like import tone_look

__all__ = [
    "Blend",
    "BlotchesPart",
    "Ceiling",
    "Contrast",
    "Floor",
    "FrecklesPart",
    "Layer",
    "Like",
    "Look",
    "MaskPart",
    "Multiply",
    "Offset",
    "PatchesPart",
    "PicturePart",
    "RangePart",
    "RegionsPart",
    "Set",
    "Soften",
    "Stroke",
    "StrokesPart",
    "Tone",
    "asked",
    "nothing",
    "presets",
    "tone_look",
    "tone_of",
]
