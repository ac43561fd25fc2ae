"""What users hold: skin maps, edits, presets, files of maps."""

from cutis.maps import presets
from cutis.maps.edits import Edit, parse_edit
from cutis.maps.estimate import estimate
from cutis.maps.files import find_source, load_maps, load_skin, save_maps, source_note
from cutis.maps.report import report
from cutis.maps.skin_maps import SkinMaps

__all__ = [
    "Edit",
    "SkinMaps",
    "estimate",
    "find_source",
    "load_maps",
    "load_skin",
    "parse_edit",
    "presets",
    "report",
    "save_maps",
    "source_note",
]
