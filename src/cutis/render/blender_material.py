"""A skin material as a Blender file: an asset to append, which also opens as a scene.

Blender writes it in a process of its own, by the script that renders pictures, and Cycles is fed as
it is for pictures, so that it returns the albedo (`render.cycles`). The file names its textures
relative to itself, so that a folder with both can be moved.
"""

import json
import shutil
from importlib import resources
from pathlib import Path

from cutis.errors import CutisError
from cutis.render.blender import Blender, find_blender
from cutis.render.confined import end, spoken, started, words
from cutis.render.cycles import INDEX, METHOD, facing
from cutis.render.material import NEUTRAL, Material
from cutis.render.scene import Scene
from cutis.textures import replacing
from cutis.textures.scratch import scratch_folder

PREVIEW = 128
"""Pixels along a side of the picture in the asset browser."""


def write_blender(material: Material, path: Path, blender: Blender | None = None) -> None:
    """Writes NAME.blend beside the textures of a material, which must be there.

    The material is an asset; opened as a file, it shows on a ball in the studio light, ready to be
    rendered. `blender` is by default that of `find_blender()`. Raises CutisError where Blender is
    missing or fails.
    """
    blender = blender or find_blender()
    scene = preview_scene(material, path.parent)
    with scratch_folder() as folder:
        made = folder / "material.blend"
        job = scene.job(made) | {"asset": _asset(material)}
        (folder / "job.json").write_text(json.dumps({"pictures": [job]}), encoding="utf-8")
        script = resources.files("cutis.data").joinpath("blender", "scene.py")
        with resources.as_file(script) as file:
            _run(blender.command(file, str(folder / "job.json")), folder)
        if not made.is_file():
            raise CutisError(f"{path}: Blender wrote no file")
        with replacing(path) as temporary:
            shutil.copyfile(made, temporary)


def preview_scene(material: Material, folder: Path) -> Scene:
    """The scene that the file opens as, in the units of the material."""
    if material.cycles_colour is None or material.cycles_radius is None:
        raise CutisError(f"the material {material.name} has no textures for Cycles; export it anew")
    return Scene(
        base_colour=folder / material.cycles_colour,
        radius=folder / material.cycles_radius,
        anisotropy=material.anisotropy,
        method=METHOD,
        subsurface_ior=INDEX,
        facing=facing(material.anisotropy),
        specular=material.gloss.strength,
        normal=None if material.normal is None else folder / material.normal,
        roughness=NEUTRAL if material.roughness is None else folder / material.roughness,
        width=PREVIEW,
        height=PREVIEW,
        samples=32,
        device="cpu",
    )


def _asset(material: Material) -> dict[str, object]:
    return {
        "name": material.name,
        "units_per_millimetre": material.scale,
        "author": "cutis",
        "description": "Skin: subsurface medium from its albedo, lengths in mm by one node",
        "license": "",
        "copyright": "; ".join(material.credits),
        "tags": ["skin", "subsurface"],
    }


def _run(command: list[str], folder: Path) -> None:
    process, last = started(command, folder), "nothing"
    try:
        for text in spoken(process):
            if text.startswith("CUTIS {"):
                event = json.loads(text[6:])
                if event["event"] == "error":
                    raise CutisError(words(event["message"]))
            elif text:
                last = text
        if process.wait():
            raise CutisError(f"Blender ended with status {process.returncode}; it said: "
                             f"{words(last)}")  # fmt: skip
    finally:
        end(process)
