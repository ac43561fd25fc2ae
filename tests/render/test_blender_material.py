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
from cutis.render.material_textures import write_textures
from cutis.render.skin import Skin
from cutis.textures import read_channels, write_channels

pytestmark = pytest.mark.slow

SAME = 0.012
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
images = {n.image.name: n.image for n in material.node_tree.nodes if n.type == "TEX_IMAGE"}
print("TOLD " + json.dumps({
    "name": material.name,
    "spaces": {k: [list(i.size), i.colorspace_settings.name] for k, i in images.items()},
    "texel": list(images["face.cycles_colour.exr"].pixels[:3]),
    "others": len(bpy.data.objects),
}))
"""


FURNACE = """
import bpy, sys
blend, out = sys.argv[-2:]
bpy.ops.wm.open_mainfile(filepath=blend)
scene = bpy.context.scene
for thing in list(bpy.data.objects):
    if thing.type == "LIGHT" or thing.name == "wall":
        bpy.data.objects.remove(thing)
background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
for link in list(scene.world.node_tree.links):
    if link.to_node == background:
        scene.world.node_tree.links.remove(link)
background.inputs["Color"].default_value = (1, 1, 1, 1)
background.inputs["Strength"].default_value = 1
scene.cycles.film_exposure, scene.cycles.use_denoising, scene.cycles.samples = 1, False, 128
scene.render.resolution_x = scene.render.resolution_y = 48
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
print("TOLD {}")
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


ALBEDO = (0.62, 0.35, 0.2)


def exported(folder, albedo=None, anisotropy=0.0, radius=(60.0, 30.0, 20.0), **changes):
    """A material with its textures; lengths are long, so that a wrong unit would show."""
    y, x = np.mgrid[:16, :32] / 32
    varying = {"R": 0.5 + 0.3 * x, "G": 0.35 + 0.2 * y, "B": 0.3 - 0.1 * x}
    write_channels(folder / "given.exr", albedo or varying)
    with Skin(folder / "given.exr") as skin:
        found = write_textures(skin, folder, "face", radius, anisotropy, for_cycles=True)
    given = {
        "name": "face",
        **found.files,
        "radius": found.radius,
        "anisotropy": anisotropy,
        "millimetres": 100.0,
        "credits": ("by nobody",),
        **changes,
    }
    return Material(**given)


def pixels(path):
    channels = read_channels(path)[0]
    return np.stack([channels[c] for c in "RGB"], axis=-1)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"anisotropy": 0.5, "millimetres": 1000.0},
        {"normal": "face.normal.exr", "roughness": "face.roughness.exr", "millimetres": 1000.0},
    ],
    ids=["decimetres", "metres", "maps"],
)
def test_file_opens_as_the_picture_that_cutis_renders(blender, tmp_path, changes):
    """Moved with its textures, in a fresh process: the same numbers, whatever the units."""
    folder = tmp_path / "here"
    folder.mkdir()
    flat = np.full((4, 4), 0.5)
    write_channels(folder / "face.normal.exr", {"R": flat + 0.2, "G": flat, "B": flat + 0.4})
    write_channels(folder / "face.roughness.exr", dict.fromkeys("RGB", flat - 0.2))
    material = exported(folder, **changes)
    write_blender(material, folder / "face.blend", blender)
    ours = folder / "ours.exr"
    render([(replace(preview_scene(material, folder), width=48, height=48), ours)], blender)

    moved = tmp_path / "there"
    folder.rename(moved)
    told = ask(blender, moved, OPEN, moved / "face.blend", moved / "theirs.exr")
    names = [material.cycles_colour, material.cycles_radius, material.normal, material.roughness]
    assert told["images"] == sorted(f"//{name}" for name in names if name)
    assert told["asset"]
    assert told["copyright"] == "by nobody"
    assert told["unit"] == pytest.approx(1 / material.millimetres)
    assert told["size"] == pytest.approx(240 / material.millimetres, rel=1e-3)  # a head's ball
    assert told["places"] == told["nodes"]  # none on top of another
    assert told["preview"] > 0

    a, b = pixels(moved / "ours.exr"), pixels(moved / "theirs.exr")
    assert a.mean() > 0.1
    # At another scale rays round differently, and some take another way: noise, also in the mean.
    assert b.mean(axis=(0, 1)) == pytest.approx(a.mean(axis=(0, 1)), rel=SAME)
    assert np.abs(a - b).mean() < SAME * a.mean()
    if material.millimetres == 1000:  # the unit that pictures are made in
        np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-6)


def test_material_is_appended_with_its_textures_and_nothing_else(blender, tmp_path):
    material = exported(tmp_path)
    write_blender(material, tmp_path / "face.blend", blender)
    told = ask(blender, tmp_path, APPEND, tmp_path / "face.blend")
    assert told["name"] == "face"
    assert told["spaces"] == {
        material.cycles_colour: [[32, 16], "Linear Rec.709"],
        material.cycles_radius: [[32, 16], "Non-Color"],
    }
    stored = pixels(tmp_path / material.cycles_colour)[-1, 0]  # Blender's first is lower left
    assert told["texel"] == pytest.approx(stored, rel=1e-5)
    assert told["others"] == 0


def test_its_walk_returns_the_albedo(blender, tmp_path):
    """Below white light from everywhere, without gloss, the ball has the colour asked for."""
    flat = {c: np.full((4, 4), value) for c, value in zip("RGB", ALBEDO, strict=True)}
    material = exported(tmp_path, flat, radius=(0.4, 0.3, 0.2), gloss=Gloss(strength=0.0))
    write_blender(material, tmp_path / "face.blend", blender)
    ask(blender, tmp_path, FURNACE, tmp_path / "face.blend", tmp_path / "lit.exr")
    middle = pixels(tmp_path / "lit.exr")[16:32, 16:32].reshape(-1, 3)
    error = middle.std(axis=0) / np.sqrt(len(middle))
    assert (np.abs(middle.mean(axis=0) - ALBEDO) < 0.01 * np.array(ALBEDO) + 4 * error).all()
    assert (error < 0.005 * np.array(ALBEDO)).all()  # or it would say little


def test_a_wrong_unit_would_be_seen(blender, tmp_path):
    """Ten times less scattering changes pictures by more than what the comparison allows."""
    pictures = []
    for radius in ((60.0, 30.0, 20.0), (6.0, 3.0, 2.0)):
        scene = preview_scene(exported(tmp_path, radius=radius), tmp_path)
        path = tmp_path / f"{radius[0]}.exr"
        render([(replace(scene, width=48, height=48), path)], blender)
        pictures.append(pixels(path))
    a, b = pictures
    assert np.abs(a - b).mean() > 5 * SAME * a.mean()


def test_missing_texture_is_one_clear_line(blender, tmp_path):
    material = exported(tmp_path)
    (tmp_path / material.cycles_colour).write_bytes(b"not a picture")
    with pytest.raises(CutisError, match=r"face\.cycles_colour\.exr cannot be read"):
        write_blender(material, tmp_path / "face.blend", blender)
    assert not (tmp_path / "face.blend").exists()


def test_material_without_textures_for_cycles_is_refused(tmp_path):
    material = replace(exported(tmp_path), cycles_colour=None)
    with pytest.raises(CutisError, match="no textures for Cycles"):
        preview_scene(material, tmp_path)
