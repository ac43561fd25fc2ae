"""What users hold: skin maps, edits, presets, files of maps, reports."""

from cutis.maps import presets
from cutis.maps.edits import Edit, parse_edit
from cutis.maps.estimate import blank, estimate, estimate_rows
from cutis.maps.files import (
    MapsFile,
    find_source,
    load_maps,
    load_skin,
    maps_writer,
    open_source,
    save_maps,
    source_note,
)
from cutis.maps.sampler import Sampler
from cutis.maps.skin_maps import SkinMaps

__all__ = [
    "Edit",
    "MapsFile",
    "Sampler",
    "SkinMaps",
    "blank",
    "estimate",
    "estimate_rows",
    "find_source",
    "load_maps",
    "load_skin",
    "maps_writer",
    "open_source",
    "parse_edit",
    "presets",
    "save_maps",
    "source_note",
]
