"""Pictures of one skin: its textures written for Cycles, rendered, and put under their names."""

import hashlib
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cutis.errors import CutisError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from cutis.maps import Edit
    from cutis.render.blender import Blender
    from cutis.render.frames import Frame
    from cutis.render.scene import Scene
    from cutis.render.skin import Rows, Skin

Progress = Callable[[int, int, str], None]
"""Takes what is done, all, and what is being done."""
METRE = 1000.0
"""Millimetres per scene unit of an exported material, unless --unit says otherwise."""
RADII = ("tissue", "maps")
"""Where mean free paths come from."""


@dataclass(frozen=True)
class Order:
    """What to render: a skin with edits, `scene` with all that is not skin, frames of a sequence.

    Without `frames` it is one picture, `output`; else `output` names them all.
    """

    skin: Path
    output: Path
    scene: "Scene"
    edits: "tuple[Edit, ...]" = ()
    amount: float = 1.0
    paint: Path | None = None
    source: Path | None = None
    model_only: bool = False
    colorspace: str = "auto"
    ocio: str | None = None
    radius: str = "tissue"
    frames: "tuple[Frame, ...]" = ()
    again: bool = False
    credits: tuple[str, ...] = ()

    def opened(self) -> "Skin":
        """The skin, open."""
        from cutis.render.skin import Skin

        return Skin(
            self.skin, source=self.source, model_only=self.model_only, paint=self.paint,
            colorspace=self.colorspace, ocio=self.ocio,
        )  # fmt: skip


@dataclass
class Rendered:
    """What came of an order: pictures written now, those that were there, and by which device."""

    written: list[Path] = field(default_factory=list)
    there: list[Path] = field(default_factory=list)
    animation: Path | None = None
    device: str = ""


def render_pictures(order: Order, blender: "Blender", progress: Progress) -> Rendered:
    """Renders what is missing of an order; a sequence that was stopped goes on."""
    from cutis.render.cycles_process import render
    from cutis.render.display import write_animation, write_picture
    from cutis.render.finished import Finished, digest
    from cutis.render.frames import Frame, file_names
    from cutis.textures import read_texture, sweep

    frames = list(order.frames) or [Frame(1)]
    stem, suffix = order.output.with_suffix(""), order.output.suffix
    sequence = bool(order.frames)
    sweep(order.output.parent)
    names = [order.output]
    if sequence:
        names = [Path(name) for _, name in file_names(frames, str(stem), suffix)]
    result, log = Rendered(), Finished(Path(f"{stem}.frames.json"))
    with order.opened() as skin, tempfile.TemporaryDirectory(prefix="cutis-") as folder:
        base = _recipe(order, skin, blender) if sequence else {}
        feeds = _Feeds(order, skin, Path(folder))
        recipes: dict[Path, tuple[Path, str]] = {}
        every: list[str] = []
        todo: list[tuple[Scene, Path]] = []
        for frame, name in zip(frames, names, strict=True):
            recipe = digest(base | {"turn": frame.turn, "edits": [str(e) for e in frame.edits]})
            every.append(recipe)
            if sequence and not order.again and log.has(name, recipe):
                result.there.append(name)
                continue
            progress(len(todo), len(frames), "writing textures")
            light = Path(folder) / f"{name.stem}.exr"
            todo.append((feeds.scene(frame), light))
            recipes[light] = name, recipe

        def keep(light: Path) -> None:
            name, recipe = recipes[light]
            texture = read_texture(light)
            notes = {"ImageDescription": f"rendered by cutis from {order.skin.name}"}
            if order.credits:
                notes["Copyright"] = "; ".join(order.credits)
            log.drop(name)  # a stop between the two must not leave it under another recipe
            write_picture(texture.linear(), name, notes)
            light.unlink()
            if sequence:
                log.put(name, recipe)
            result.written.append(name)

        result.device = render(todo, blender, progress, keep)
    if sequence:
        result.animation = Path(f"{stem}.webp")
        film = digest({"frames": every, "suffix": suffix})
        if not log.has(result.animation, film):
            progress(1, 1, "moving preview")
            log.drop(result.animation)
            write_animation(names, result.animation)
            log.put(result.animation, film)
    return result


def export_to(
    order: Order, folder: Path, blender: Path | None, progress: Progress
) -> tuple[Path, ...]:
    """Writes the skin's material into a folder; the .blend only where a Blender is found.

    A Blender that is named and does not work is an error.
    """
    from cutis.apps.options import made_folder
    from cutis.render.blender import find_blender
    from cutis.render.material_export import export_material
    from cutis.render.medium import mean_free_path, of_maps

    try:
        found = find_blender(blender)
    except CutisError:
        if blender is not None or os.environ.get("BLENDER"):
            raise
        found = None
    g = order.scene.anisotropy
    with made_folder(folder), order.opened() as skin:
        red, green, blue = (float(length) for length in mean_free_path(g, skin.tissue))
        everywhere = order.radius == "tissue"
        radius = (red, green, blue) if everywhere else lambda maps: of_maps(maps, g)
        return export_material(
            skin, folder, skin.stem,
            radius=radius,
            anisotropy=g, millimetres=order.scene.millimetres_per_unit or METRE,
            edits=order.edits, amount=order.amount, blender=found, progress=progress,
            normal=order.scene.normal,
            roughness=order.scene.roughness if isinstance(order.scene.roughness, Path) else None,
        ).files  # fmt: skip


class _Feeds:
    """Textures for Cycles in a folder, each written once however many frames share it."""

    def __init__(self, order: Order, skin: "Skin", folder: Path) -> None:
        self._order, self._skin, self._folder = order, skin, folder
        self._written: dict[Any, tuple[Path, Any]] = {}

    def scene(self, frame: "Frame") -> "Scene":
        """The scene of a frame, with its textures."""
        from cutis.render.cycles import INDEX, METHOD, facing

        order = self._order
        if frame.edits not in self._written:
            self._written[frame.edits] = self._write((*order.edits, *frame.edits))
        colour, radius = self._written[frame.edits]
        scene = order.scene
        return replace(
            scene, base_colour=colour, radius=radius, turn=scene.turn + frame.turn,
            method=METHOD, subsurface_ior=INDEX, facing=facing(scene.anisotropy),
        )  # fmt: skip

    def _write(self, edits: "tuple[Edit, ...]") -> tuple[Path, Path]:
        from cutis.render.cycles import base_colour, radius
        from cutis.render.feed import write_feed
        from cutis.render.medium import mean_free_path, of_maps

        number, order = len(self._written), self._order
        g = order.scene.anisotropy
        everywhere = mean_free_path(tissue=self._skin.tissue)
        if order.radius == "maps" and self._skin.maps is None:
            raise CutisError(
                f"{order.skin.name} is a texture; --radius maps needs its maps (NAME.skin.exr), "
                "which cutis estimate makes"
            )

        def colour(rows: "Rows") -> "NDArray[np.floating]":
            return base_colour(rows.albedo, g)

        def lengths(rows: "Rows") -> "NDArray[np.float32]":
            mapped = order.radius == "maps" and rows.maps is not None
            return radius(colour(rows), of_maps(rows.maps) if mapped else everywhere)  # type: ignore[arg-type]

        written = self._folder / f"colour{number}.exr", self._folder / f"radius{number}.exr"
        for path, convert in zip(written, (colour, lengths), strict=True):
            write_feed(self._skin, path, convert, edits, order.amount)
        return written


def _recipe(order: Order, skin: "Skin", blender: "Blender") -> dict[str, Any]:
    """All that every picture of a sequence depends on, as JSON holds it."""
    from importlib.metadata import version

    from cutis.maps.files import digest
    from cutis.render.cycles import INDEX, METHOD, facing
    from cutis.render.medium import mean_free_path

    script = resources.files("cutis.data").joinpath("blender", "scene.py")
    scene, g = order.scene, order.scene.anisotropy
    job = scene.job(Path("picture.exr"))
    for machine in ("output", "device", "base_colour", "turn"):
        del job[machine]
    files: dict[str, Path | None] = {
        "skin": order.skin,
        "capture": None if skin.maps is None or skin.capture is None else skin.capture.path,
        "paint": order.paint,
        "mesh": scene.mesh if isinstance(scene.mesh, Path) else None,
        "ocio": Path(order.ocio) if order.ocio and Path(order.ocio).is_file() else None,
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
        "scene": job,
        "files": digests,
        "edited": [str(edit) for edit in order.edits],
        "amount": order.amount,
        "radius": order.radius,
        "medium": [METHOD, INDEX, *facing(g), *mean_free_path(g, skin.tissue).tolist()],
        "model_only": order.model_only,
        "colorspace": order.colorspace,
        "ocio": order.ocio,
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


def check_fit(order: Order, ratio: float, head: str) -> None:
    """CutisError where a texture has not the width : height of those of a bundled head."""
    with order.opened() as skin:
        height, width = skin.shape
    if abs(width / height / ratio - 1) > 0.01:
        raise CutisError(
            f"{order.skin.name} is {width} × {height} texels; textures of the head {head} are "
            f"{ratio:.3g} times as wide as high, so these maps belong to another mesh: give it "
            "with --mesh"
        )
