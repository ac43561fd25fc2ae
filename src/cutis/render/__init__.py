"""Pictures: subsurface inversion, materials, and scenes that Cycles renders."""

from cutis.render.blender import Blender, find_blender
from cutis.render.cycles_process import render
from cutis.render.heads import Head, head, heads
from cutis.render.inversion import diffuse_albedo, single_scattering_albedo
from cutis.render.material_export import export_material
from cutis.render.medium import mean_free_path
from cutis.render.scene import Scene
from cutis.render.skin import Skin

__all__ = [
    "Blender",
    "Head",
    "Scene",
    "Skin",
    "diffuse_albedo",
    "export_material",
    "find_blender",
    "head",
    "heads",
    "mean_free_path",
    "render",
    "single_scattering_albedo",
]
