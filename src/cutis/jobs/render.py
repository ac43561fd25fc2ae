"""Pictures and materials of one skin: textures for Cycles, rendered, and put under their names."""

import contextlib
import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.jobs.files import check_outputs, made_folder
from cutis.jobs.job import digest_of, tell, told
from cutis.jobs.subject import Subject, needs_maps
from cutis.looks import nothing
from cutis.maps import Change
from cutis.maps.estimating import Progress, nobody
from cutis.maps.face import Memo
from cutis.maps.source import digest
from cutis.render.blender import Blender, find_blender
from cutis.render.cycles import INDEX, METHOD, base_colour, facing
from cutis.render.cycles import radius as cycles_radius
from cutis.render.cycles_process import render
from cutis.render.display import write_animation, write_picture
from cutis.render.feed import write_feed
from cutis.render.finished import Finished
from cutis.render.finished import digest as recipe_digest
from cutis.render.frames import Frame, file_names
from cutis.render.heads import credits_of
from cutis.render.material_export import export_material
from cutis.render.medium import mean_free_path, of_maps
from cutis.render.scene import Scene
from cutis.render.skin import MAPS, Rows, Skin
from cutis.textures import format_of, read_texture, sweep
from cutis.textures.scratch import scratch_folder
from cutis.textures.udim import FIRST, TOKEN, tile_of

METRE = 1000.0
"""Millimetres per scene unit of an exported material, unless the scene says otherwise."""


@dataclass
class Rendered:
    """What came of it: pictures written now, those that were there, by which device, whose."""

    written: list[Path] = field(default_factory=list)
    there: list[Path] = field(default_factory=list)
    animation: Path | None = None
    device: str = ""
    credits: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class RenderJob:
    """A picture of a subject, or the `frames` of a sequence, whose name `output` gives.

    A sequence that was stopped goes on where it was; `again` makes its pictures anew. `blender` is
    the program to use, None for the one that is found.
    """

    subject: Subject
    output: Path = field(metadata={"result": False})
    frames: tuple[Frame, ...] = ()
    again: bool = field(default=False, metadata={"result": False})
    blender: Path | None = None

    def __post_init__(self) -> None:
        format_of(self.output)

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> Rendered:
        """Renders what is missing."""
        subject, sequence = self.subject, bool(self.frames)
        needed = needs_maps(subject) or any(not nothing(one.edits) for one in self.frames)
        with subject.with_maps(needed, progress) as found:
            return replace(self, subject=found)._run(progress, sequence)

    def _run(self, progress: Progress, sequence: bool) -> Rendered:
        subject, tiles = self.subject, self.subject.tiles()
        frames = list(self.frames) or [Frame(1)]
        stem, suffix = self.output.with_suffix(""), self.output.suffix
        names = [self.output]
        if sequence:
            names = [Path(name) for _, name in file_names(frames, str(stem), suffix)]
        for tile in tiles.values():
            check_outputs(names, tile.inputs())
        blender = find_blender(self.blender)
        sweep(self.output.parent)
        result, log = Rendered(), Finished(Path(f"{stem}.frames.json"))
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(scratch_folder())
            feeds = _Feeds(subject.scene, folder)
            origins, notes = [], []
            for number, tile in tiles.items():
                skin, changes = stack.enter_context(tile.opened())
                feeds.add(number, tile, skin)
                check_outputs(
                    names, {"the capture": None if skin.capture is None else skin.capture.path}
                )
                origins += skin.origins()
                notes += [*skin.notes, *(note for change in changes for note in change.notes)]
            result.credits = credits_of(subject.scene.mesh, *origins)
            notes = list(dict.fromkeys(notes))
            base = _recipe(subject, feeds.tiles, blender) if sequence else {}
            recipes: dict[Path, tuple[Path, str]] = {}
            every: list[str] = []
            todo: list[tuple[Scene, Path]] = []
            for frame, name in zip(frames, names, strict=True):
                more = tell(frame.edits)
                step = {"turn": frame.turn, "edits": [more.asked, more.content]}
                recipe = recipe_digest(base | step)
                every.append(recipe)
                if sequence and not self.again and log.has(name, recipe):
                    result.there.append(name)
                    continue
                progress(len(todo), len(frames), "writing textures")
                light = folder / f"{name.stem}.exr"
                todo.append((feeds.scene(frame), light))
                recipes[light] = name, recipe

            def keep(light: Path) -> None:
                name, recipe = recipes[light]
                texture = read_texture(light)
                notes = {"ImageDescription": f"rendered by cutis from {subject.skin.name}"}
                if result.credits:
                    notes["Copyright"] = "; ".join(result.credits)
                log.drop(name)  # a stop between the two must not leave it under another recipe
                write_picture(texture.linear(), name, notes)
                light.unlink()
                if sequence:
                    log.put(name, recipe)
                result.written.append(name)

            result.device = render(todo, blender, progress, keep, notes.append)
            result.notes = tuple(notes)
        if sequence:
            result.animation = Path(f"{stem}.webp")
            film = recipe_digest({"frames": every, "suffix": suffix})
            if not log.has(result.animation, film):
                progress(1, 1, "moving preview")
                log.drop(result.animation)
                write_animation(names, result.animation)
                log.put(result.animation, film)
        return result


@dataclass(frozen=True)
class Material:
    """The files of a material that was written, and whose they are."""

    files: tuple[Path, ...]
    credits: tuple[str, ...]


@dataclass(frozen=True)
class MaterialJob:
    """The material of a subject into a folder; the .blend only where a Blender is found.

    A Blender that is named and does not work is an error.
    """

    subject: Subject
    folder: Path = field(metadata={"result": False})
    blender: Path | None = None

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> Material:
        """Writes the material."""
        try:
            found = find_blender(self.blender)
        except CutisError:
            if self.blender is not None or os.environ.get("BLENDER"):
                raise
            found = None
        if TOKEN in self.subject.skin.name:
            raise CutisError(
                f"{self.subject.skin}: a material is made of one tile; give one after the other"
            )
        with self.subject.with_maps(needs_maps(self.subject), progress) as subject:
            return self._export(subject, found, progress)

    def _export(self, subject: Subject, found: Blender | None, progress: Progress) -> Material:
        scene = subject.scene
        g = scene.anisotropy
        with made_folder(self.folder), subject.opened() as (skin, changes):
            sweep(self.folder)
            red, green, blue = (float(length) for length in mean_free_path(skin.tissue, g))
            everywhere = subject.radius == "tissue"
            files = export_material(
                skin, self.folder, skin.stem,
                radius=(red, green, blue) if everywhere else lambda maps: of_maps(maps, g),
                anisotropy=g, millimetres=scene.millimetres_per_unit or METRE,
                changes=changes, blender=found, progress=progress, normal=scene.normal,
                roughness=scene.roughness if isinstance(scene.roughness, Path) else None,
            ).files  # fmt: skip
            return Material(files, credits_of(scene.mesh, *skin.origins()))


class _Feeds:
    """Textures for Cycles in a folder, each written once however many frames share it."""

    def __init__(self, scene: Scene, folder: Path) -> None:
        self._scene, self._folder = scene, folder
        self.tiles: dict[int, tuple[Subject, Skin]] = {}
        self._written: dict[Any, tuple[Path, Any]] = {}

    def add(self, number: int, subject: Subject, skin: Skin) -> None:
        """A tile of the textures, by its number."""
        self.tiles[number] = subject, skin

    def scene(self, frame: Frame) -> Scene:
        """The scene of a frame, with its textures."""
        if frame.edits not in self._written:
            count, single = len(self._written), list(self.tiles) == [FIRST]
            names = [f"{what}{count}{'' if single else '.' + TOKEN}.exr" for what in _FEEDS]
            colour, radius = (self._folder / name for name in names)
            memo: Memo = {}
            for number, (subject, skin) in self.tiles.items():
                changes = subject.changes(skin, frame.edits, memo)
                _feed(subject, skin, changes, tile_of(colour, number), tile_of(radius, number))
            self._written[frame.edits] = colour, radius
        colour, radius = self._written[frame.edits]
        scene = self._scene
        return replace(
            scene, base_colour=colour, radius=radius, turn=scene.turn + frame.turn,
            method=METHOD, subsurface_ior=INDEX, facing=facing(scene.anisotropy),
        )  # fmt: skip


_FEEDS = ("colour", "radius")


def _feed(
    subject: Subject, skin: Skin, changes: tuple[Change, ...], colours: Path, radii: Path
) -> None:
    """Writes the textures of one tile."""
    g = subject.scene.anisotropy
    everywhere = mean_free_path(skin.tissue)
    if subject.radius == "maps" and skin.maps is None:
        raise CutisError(
            f"{subject.skin.name} is a texture; --radius maps needs its maps (NAME{MAPS}), "
            "which cutis estimate makes"
        )

    def colour(rows: Rows) -> NDArray[np.floating]:
        return base_colour(rows.albedo, g)

    def lengths(rows: Rows) -> NDArray[np.float32]:
        mapped = subject.radius == "maps" and rows.maps is not None
        return cycles_radius(colour(rows), of_maps(rows.maps) if mapped else everywhere)  # type: ignore[arg-type]

    for path, convert in ((colours, colour), (radii, lengths)):
        write_feed(skin, path, convert, changes)


def _recipe(
    subject: Subject, tiles: Mapping[int, tuple[Subject, Skin]], blender: Blender
) -> dict[str, Any]:
    """All that every picture of a sequence depends on, as JSON holds it."""
    script = resources.files("cutis.data").joinpath("blender", "scene.py")
    scene, g = subject.scene, subject.scene.anisotropy
    job = scene.job(Path("picture.exr"))
    for machine in ("output", "device", "base_colour", "turn"):
        del job[machine]
    files: dict[str, Path | None] = {
        "mesh": scene.mesh if isinstance(scene.mesh, Path) else None,
        **_beside(scene.mesh),
        "normal": scene.normal,
        "roughness": scene.roughness if isinstance(scene.roughness, Path) else None,
    }
    for number, (one, skin) in tiles.items():
        files[f"skin {number}"], files[f"mask {number}"] = one.skin, one.mask
        if skin.maps is not None and skin.capture is not None:
            files[f"capture {number}"] = skin.capture.path
    tissue = next(iter(tiles.values()))[1].tissue
    digests = {name: digest(path) for name, path in files.items() if path is not None}
    for name in ("mesh", "normal", "roughness"):
        job[name] = digests.get(name, job[name])
    return {
        "version": version("cutis"),
        "blender": blender.version,
        "script": hashlib.sha256(script.read_bytes()).hexdigest(),
        "subject": {
            n: [one.asked, one.content] for n, one in told(subject).items() if n != "scene"
        },
        "scene": job,
        "files": digests,
        "medium": [METHOD, INDEX, *facing(g), *mean_free_path(tissue, g).tolist()],
        "first_turn": scene.turn,
    }


def _beside(mesh: str | Path) -> dict[str, Path | None]:
    """Files that a mesh may be stored in besides its own: buffers of glTF, layers of USD."""
    suffixes: tuple[str, ...] = {".gltf": (".bin",)}.get(Path(mesh).suffix.lower(), ())
    if Path(mesh).suffix.lower().startswith(".usd"):
        suffixes = (".usd", ".usda", ".usdc")
    if not suffixes:
        return {}
    there = sorted(Path(mesh).parent.iterdir())
    return {f"beside {path.name}": path for path in there if path.suffix.lower() in suffixes}
