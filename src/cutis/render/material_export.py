"""All files of a skin material at once: textures, description, MaterialX, Blender."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from cutis.errors import CutisError
from cutis.maps import Change
from cutis.render.blender import Blender
from cutis.render.blender_material import write_blender
from cutis.render.heads import credits_of
from cutis.render.material import Gloss, Material, write_description
from cutis.render.material_textures import Progress, Radius, write_textures
from cutis.render.materialx import write_materialx
from cutis.render.skin import Skin
from cutis.textures import replacing


@dataclass(frozen=True)
class Exported:
    """A material and the files that were written of it."""

    material: Material
    files: tuple[Path, ...]


def export_material(
    skin: Skin,
    folder: Path,
    name: str,
    *,
    radius: Radius,
    anisotropy: float,
    millimetres: float,
    gloss: Gloss | None = None,
    normal: Path | None = None,
    roughness: Path | None = None,
    changes: Sequence[Change] = (),
    blender: Blender | None = None,
    progress: Progress | None = None,
) -> Exported:
    """Writes the material of a skin, with edits, into a folder that exists.

    NAME.albedo.exr, NAME.single_scattering.exr, NAME.radius.exr (if `radius` varies; see
    `write_textures`), NAME.material.json, NAME.mtlx and, where `blender` is given, NAME.blend with
    textures for Cycles.
    `millimetres` is the length of one unit of the scene. `normal` and `roughness` are maps of
    `Material`; copies of them, NAME.normal.EXT and NAME.roughness.EXT, go with the others. Raises
    CutisError as the writers do.
    """
    textures = write_textures(
        skin, folder, name, radius, anisotropy, changes, blender is not None, progress
    )
    normal_name = _copied(normal, folder, f"{name}.normal")
    roughness_name = _copied(roughness, folder, f"{name}.roughness")
    material = Material(
        name=name,
        albedo=textures.files["albedo"],
        single_scattering=textures.files["single_scattering"],
        radius=textures.radius,
        radius_texture=textures.files.get("radius"),
        cycles_colour=textures.files.get("cycles_colour"),
        cycles_radius=textures.files.get("cycles_radius"),
        anisotropy=anisotropy,
        millimetres=millimetres,
        normal=normal_name,
        roughness=roughness_name,
        gloss=gloss or Gloss(),
        notes={
            "boundary": "index-matched: the albedo is that of light that has entered",
            "made_by": f"cutis {version('cutis')}",
            "source": skin.path.name,
            **({} if skin.maps is None else {"model": skin.maps.made_by.name}),
            "edits": [*_earlier(skin), *(line for change in changes for line in change.told)],
        },
        credits=credits_of(*skin.origins()),
    )
    description, document = folder / f"{name}.material.json", folder / f"{name}.mtlx"
    write_description(material, description)
    write_materialx(material, document)
    names = [*textures.files.values(), normal_name, roughness_name]
    files = [*(folder / file for file in names if file), description, document]
    if blender is not None:
        files.append(folder / f"{name}.blend")
        write_blender(material, files[-1], blender)
    return Exported(material, tuple(files))


def _copied(file: Path | None, folder: Path, stem: str) -> str | None:
    """Puts a copy of a file into a folder; returns its name."""
    if file is None:
        return None
    if not file.is_file():
        raise CutisError(f"{file}: there is no such file")
    name = stem + file.suffix
    with replacing(folder / name) as temporary:
        shutil.copyfile(file, temporary)
    return name


def _earlier(skin: Skin) -> tuple[str, ...]:
    return () if skin.maps is None else skin.maps.header.edits
