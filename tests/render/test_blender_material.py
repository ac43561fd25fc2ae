"""Blender files of a material: opened and appended by a fresh Blender, whose pictures are compared.

Skipped where there is no Blender.
"""

import json
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.render.blender import quiet_environment
from cutis.render.blender_material import preview_scene, write_blender
from cutis.render.cycles_process import render
from cutis.render.material import Gloss, Material
from cutis.textures import read_channels, write_channels

pytestmark = pytest.mark.slow

SAME = 0.003
"""Mean difference of two pictures of the same, as a share of their mean."""

OPEN = """
import bpy, json, sys
blend, out = sys.argv[-2:]
bpy.ops.wm.open_mainfile(filepath=blend)
scene = bpy.context.scene
scene.render.resolution_x = scene.render.resolution_y = 48
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
material = bpy.data.materials["face"]
nodes = material.node_tree.nodes
print("TOLD " + json.dumps({
    "asset": material.asset_data is not None,
    "copyright": material.asset_data.copyright,
    "images": sorted(i.filepath for i in bpy.data.images if i.users and i.filepath),
    "unit": nodes["Scene units per millimetre"].outputs[0].default_value,
    "places": len({tuple(n.location) for n in nodes}),
    "nodes": len(nodes),
    "preview": sum(material.preview.image_pixels_float) if material.preview else 0,
    "size": max(bpy.context.scene.objects["subject"].dimensions),
}))
"""

APPEND = """
import bpy, json, sys
blend = sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
with bpy.data.libraries.load(blend, link=False, assets_only=True) as (there, here):
    here.materials = list(there.materials)
(material,) = here.materials
image = next(n.image for n in material.node_tree.nodes if n.type == "TEX_IMAGE")
print("TOLD " + json.dumps({
    "name": material.name,
    "size": list(image.size),
    "space": image.colorspace_settings.name,
    "texel": list(image.pixels[:3]),
    "others": len(bpy.data.objects),
}))
"""


def ask(blender, folder, script, *arguments):
    """What a script told, run in a Blender of its own."""
    file = folder / "script.py"
    file.write_text(script, encoding="utf-8")
    done = subprocess.run(
        blender.command(file, *map(str, arguments)),
        env=dict(quiet_environment(folder)), capture_output=True, text=True, timeout=250,
    )  # fmt: skip
    told = [line[5:] for line in done.stdout.splitlines() if line.startswith("TOLD ")]
    assert told, done.stdout + done.stderr
    return json.loads(told[0])


def skin(**changes):
    given = {
        "name": "face",
        "albedo": "face.albedo.exr",
        "single_scattering": "face.single_scattering.exr",
        "radius": (60.0, 30.0, 20.0),  # mm, on a ball of 240 mm: a wrong unit would show
        "anisotropy": 0.0,
        "millimetres": 100.0,
        "credits": ("by nobody",),
        **changes,
    }
    return Material(**given)


@pytest.fixture
def folder(tmp_path):
    """Textures of a material whose colour varies."""
    y, x = np.mgrid[:16, :32] / 32
    write_channels(
        tmp_path / "face.albedo.exr", {"R": 0.5 + 0.3 * x, "G": 0.35 + 0.2 * y, "B": 0.3 - 0.1 * x}
    )
    radii = {"R": 60 - 20 * x, "G": 20 + 20 * y, "B": 20 + 0 * x}
    write_channels(tmp_path / "face.radius.exr", radii)
    return tmp_path


@pytest.mark.parametrize(
    "changes", [{}, {"radius_texture": "face.radius.exr", "millimetres": 1000.0}]
)
def test_file_opens_as_the_picture_that_cutis_renders(blender, folder, tmp_path_factory, changes):
    """Moved with its textures, in a fresh process: the same numbers, whatever the units."""
    material = skin(**changes)
    write_blender(material, folder / "face.blend", blender)
    ours = folder / "ours.exr"
    render([(replace(preview_scene(material, folder), width=48, height=48), ours)], blender)

    moved = tmp_path_factory.mktemp("elsewhere") / "moved"
    folder.rename(moved)
    told = ask(blender, moved, OPEN, moved / "face.blend", moved / "theirs.exr")
    names = [n for n in (material.albedo, material.radius_texture) if n]
    assert told["images"] == [f"//{name}" for name in names]
    assert told["asset"]
    assert told["copyright"] == "by nobody"
    assert told["unit"] == pytest.approx(1 / material.millimetres)
    assert told["size"] == pytest.approx(240 / material.millimetres, rel=1e-3)  # a head's ball
    assert told["places"] == told["nodes"]  # none on top of another
    assert told["preview"] > 0

    pictures = [read_channels(moved / name)[0] for name in ("ours.exr", "theirs.exr")]
    a, b = (np.stack([picture[c] for c in "RGB"], axis=-1) for picture in pictures)
    assert a.mean() > 0.1
    # At another scale rays round differently, and a few take another way.
    assert b.mean(axis=(0, 1)) == pytest.approx(a.mean(axis=(0, 1)), rel=1e-3)
    assert np.abs(a - b).mean() < SAME * a.mean()


def test_material_is_appended_with_its_texture_and_nothing_else(blender, folder):
    write_blender(skin(), folder / "face.blend", blender)
    told = ask(blender, folder, APPEND, folder / "face.blend")
    assert told["name"] == "face"
    assert told["size"] == [32, 16]
    assert told["space"] == "Linear Rec.709"
    assert told["texel"] == pytest.approx([0.5, 0.35 + 0.2 * 15 / 32, 0.3], rel=1e-5)  # lower left
    assert told["others"] == 0


def test_a_wrong_unit_would_be_seen(blender, folder):
    """Ten times less scattering changes pictures by more than what the comparison allows."""
    pictures = []
    for radius in ((60.0, 30.0, 20.0), (6.0, 3.0, 2.0)):
        scene = preview_scene(skin(radius=radius), folder)
        path = folder / f"{radius[0]}.exr"
        render([(replace(scene, width=48, height=48), path)], blender)
        channels = read_channels(path)[0]
        pictures.append(np.stack([channels[c] for c in "RGB"], axis=-1))
    a, b = pictures
    assert np.abs(a - b).mean() > 5 * SAME * a.mean()


def test_missing_texture_is_one_clear_line(blender, folder):
    (folder / "face.albedo.exr").write_bytes(b"not a picture")
    with pytest.raises(CutisError, match=r"face\.albedo\.exr cannot be read"):
        write_blender(skin(), folder / "face.blend", blender)
    assert not (folder / "face.blend").exists()


def test_strength_and_backward_scattering_reach_the_scene(folder):
    scene = preview_scene(skin(gloss=Gloss(strength=0.4), anisotropy=-0.3), folder)
    assert scene.specular == 0.4
    assert scene.anisotropy == 0.0  # Cycles has no backward scattering
