"""What users hold: skin maps, edits, and the files they are kept in."""

from typing import Any

from cutis.maps.changes import Change, Edits, Recipe, Step, Tile, recipe
from cutis.maps.defaults import DEFAULT, default_tissue, load_model
from cutis.maps.edits import Edit, parse_edit
from cutis.maps.estimating import Surveyed, estimate, estimate_bands, survey
from cutis.maps.face import Face, bound
from cutis.maps.plain import Maps
from cutis.maps.reading import MapsFile, load_maps, load_skin
from cutis.maps.sampler import Sampler
from cutis.maps.skin_maps import EditedEstimate, Estimate, MadeBy, SkinMaps, skin_of
from cutis.maps.source import Capture, FileCapture, find_source, open_source, source_note
from cutis.maps.writing import Header, maps_writer, save_maps
from cutis.moved import moved

__all__ = [
    "DEFAULT",
    "Capture",
    "Change",
    "Edit",
    "EditedEstimate",
    "Edits",
    "Estimate",
    "Face",
    "FileCapture",
    "Header",
    "MadeBy",
    "Maps",
    "MapsFile",
    "Recipe",
    "Sampler",
    "SkinMaps",
    "Step",
    "Surveyed",
    "Tile",
    "bound",
    "default_tissue",
    "estimate",
    "estimate_bands",
    "find_source",
    "load_maps",
    "load_model",
    "load_skin",
    "maps_writer",
    "open_source",
    "parse_edit",
    "recipe",
    "save_maps",
    "skin_of",
    "source_note",
    "survey",
]

_MOVED = {
    "Regions": "cutis.report:Regions",
    "report": "cutis.report:report",
    "export_lut": "cutis.luts:export_lut",
    "presets": "cutis.looks:presets",
}


def __getattr__(name: str) -> Any:
    return moved(__name__, name, _MOVED)
