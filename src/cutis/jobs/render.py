"""Pictures and materials of one skin: textures for Cycles, rendered, and put under their names."""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from importlib import resources
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.jobs.files import check_outputs, made_folder
from cutis.jobs.job import digest_of, tell, told
from cutis.looks import asked, nothing
from cutis.maps import Change, Edits, Face, bound
from cutis.maps.estimating import Progress, nobody
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
from cutis.render.heads import Head, credits_of
from cutis.render.material_export import export_material
from cutis.render.medium import mean_free_path, of_maps
from cutis.render.scene import Scene
from cutis.render.skin import MAPS, Rows, Skin
from cutis.textures import Orientation, TextureFile, format_of, read_texture, sweep

METRE = 1000.0
"""Millimetres per scene unit of an exported material, unless the scene says otherwise."""
RADII = ("tissue", "maps")
"""Where mean free paths come from."""


@dataclass(frozen=True)
class Subject:
    """What is rendered: a skin with edits, and `scene` with all that is not skin.

    `skin` is a file of maps or an albedo texture. `edits` are a look, or edits in order: `amount`
    (0–1) of them, inside the painted `mask`. `source` is the capture of maps where it is not where
    they say, `model_only` leaves it out. `colorspace` is that of a texture, None for what it says.
    `radius` is one of `RADII`. `head` is the bundled head that the scene shows, if it is one.
    `orientation` "ignore" keeps a texture in the order it is stored in.
    """

    skin: Path
    scene: Scene = field(default_factory=Scene)
    edits: Edits = ()
    amount: float = 1.0
    mask: Path | None = None
    source: Path | None = None
    model_only: bool = False
    colorspace: Space | None = None
    radius: str = "tissue"
    head: Head | None = None
    orientation: Orientation = "auto"

    def __post_init__(self) -> None:
        if self.radius not in RADII:
            raise CutisError(f"--radius must be {' or '.join(RADII)}, not {self.radius!r}")
        asked(self.edits, self.amount)

    @contextlib.contextmanager
    def opened(self) -> Iterator[tuple[Skin, tuple[Change, ...]]]:
        """The skin, open, and the changes that the edits are."""
        with contextlib.ExitStack() as stack:
            space = self.colorspace or "auto"
            skin = Skin(
                self.skin, source=self.source, model_only=self.model_only, colorspace=space,
                orientation=self.orientation,
            )  # fmt: skip
            stack.enter_context(skin)
            if self.head is not None:
                _check_fit(skin, self.head)
            yield skin, self.changes(skin)

    def changes(self, skin: Skin, more: Edits = ()) -> tuple[Change, ...]:
        """The edits, and more of them, as they are on an open skin."""
        wanted = [
            asked(one, self.amount, self.mask) for one in (self.edits, more) if not nothing(one)
        ]
        if wanted and skin.maps is None:
            raise skin.no_maps()
        return bound(wanted, Face(skin.maps)) if skin.maps is not None else ()

    def inputs(self) -> dict[str, Path | None]:
        """All files that are read, by what they are called."""
        scene = self.scene
        maybe = {"mesh": scene.mesh, "normal map": scene.normal, "roughness map": scene.roughness}
        found = {f"the {what}": p for what, p in maybe.items() if isinstance(p, Path)}
        return {
            "the skin to render": self.skin, "the mask": self.mask, "the capture": self.source,
            **found,
        }  # fmt: skip


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
        frames = list(self.frames) or [Frame(1)]
        stem, suffix = self.output.with_suffix(""), self.output.suffix
        names = [self.output]
        if sequence:
            names = [Path(name) for _, name in file_names(frames, str(stem), suffix)]
        check_outputs(names, subject.inputs())
        blender = find_blender(self.blender)
        sweep(self.output.parent)
        result, log = Rendered(), Finished(Path(f"{stem}.frames.json"))
        with (
            subject.opened() as (skin, changes),
            tempfile.TemporaryDirectory(prefix="cutis-") as folder,
        ):
            check_outputs(
                names, {"the capture": None if skin.capture is None else skin.capture.path}
            )
            result.credits = credits_of(subject.scene.mesh, *skin.origins())
            said = (note for change in changes for note in change.notes)
            result.notes = (*skin.notes, *said)
            base = _recipe(subject, skin, blender) if sequence else {}
            feeds = _Feeds(subject, skin, Path(folder))
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
                light = Path(folder) / f"{name.stem}.exr"
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

            result.device = render(todo, blender, progress, keep)
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
        subject, scene = self.subject, self.subject.scene
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

    def __init__(self, subject: Subject, skin: Skin, folder: Path) -> None:
        self._subject, self._skin, self._folder = subject, skin, folder
        self._written: dict[Any, tuple[Path, Any]] = {}

    def scene(self, frame: Frame) -> Scene:
        """The scene of a frame, with its textures."""
        if frame.edits not in self._written:
            changes = self._subject.changes(self._skin, frame.edits)
            self._written[frame.edits] = self._write(changes)
        colour, radius = self._written[frame.edits]
        scene = self._subject.scene
        return replace(
            scene, base_colour=colour, radius=radius, turn=scene.turn + frame.turn,
            method=METHOD, subsurface_ior=INDEX, facing=facing(scene.anisotropy),
        )  # fmt: skip

    def _write(self, changes: tuple[Change, ...]) -> tuple[Path, Path]:
        number, subject = len(self._written), self._subject
        g = subject.scene.anisotropy
        everywhere = mean_free_path(self._skin.tissue)
        if subject.radius == "maps" and self._skin.maps is None:
            raise CutisError(
                f"{subject.skin.name} is a texture; --radius maps needs its maps (NAME{MAPS}), "
                "which cutis estimate makes"
            )

        def colour(rows: Rows) -> NDArray[np.floating]:
            return base_colour(rows.albedo, g)

        def lengths(rows: Rows) -> NDArray[np.float32]:
            mapped = subject.radius == "maps" and rows.maps is not None
            return cycles_radius(colour(rows), of_maps(rows.maps) if mapped else everywhere)  # type: ignore[arg-type]

        written = self._folder / f"colour{number}.exr", self._folder / f"radius{number}.exr"
        for path, convert in zip(written, (colour, lengths), strict=True):
            write_feed(self._skin, path, convert, changes)
        return written


def _recipe(subject: Subject, skin: Skin, blender: Blender) -> dict[str, Any]:
    """All that every picture of a sequence depends on, as JSON holds it."""
    script = resources.files("cutis.data").joinpath("blender", "scene.py")
    scene, g = subject.scene, subject.scene.anisotropy
    job = scene.job(Path("picture.exr"))
    for machine in ("output", "device", "base_colour", "turn"):
        del job[machine]
    files: dict[str, Path | None] = {
        "skin": subject.skin,
        "capture": None if skin.maps is None or skin.capture is None else skin.capture.path,
        "mask": subject.mask,
        "mesh": scene.mesh if isinstance(scene.mesh, Path) else None,
        **_beside(scene.mesh),
        "normal": scene.normal,
        "roughness": scene.roughness if isinstance(scene.roughness, Path) else None,
    }
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
        "medium": [METHOD, INDEX, *facing(g), *mean_free_path(skin.tissue, g).tolist()],
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


def _check_fit(skin: Skin, head: Head) -> None:
    """CutisError where a texture has not the width : height of those of a bundled head."""
    with TextureFile(head.albedo) as texture:
        ratio = texture.shape[1] / texture.shape[0]
    height, width = skin.shape
    if abs(width / height / ratio - 1) > 0.01:
        raise CutisError(
            f"{skin.path.name} is {width} × {height} texels; textures of the head {head.name} are "
            f"{ratio:.3g} times as wide as high, so these maps belong to another mesh: give it "
            "with --mesh"
        )
