"""One picture: what is seen, what it is made of, by which light, and how carefully."""

import math
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.textures.udim import TOKEN, udim_tiles

MESHES = ("sphere", "patch")
"""Meshes that need no file: a ball as high as a head, and a flat square of 200 mm."""
FORMATS = (".obj", ".gltf", ".glb", ".usd", ".usda", ".usdc", ".usdz")
"""Extensions of mesh files that can be read."""
LIGHTS = ("studio", "sun", "interior", "furnace")
"""Sets of lights; `furnace`, radiance 1 from everywhere, is for checks."""
METHODS = ("random_walk", "random_walk_skin", "diffuse")
"""How light enters and leaves the skin in Cycles; `diffuse` has no subsurface scattering at all."""
DEVICES = ("auto", "cpu", "gpu")

RGB = tuple[float, float, float]
Source = RGB | Path
"""Three numbers, one for each of linear Rec.709's channels, or an EXR file with them.

NAME.<UDIM>.exr is one of several tiles."""


@dataclass(frozen=True)
class Scene:
    """Everything about one picture, in the units Blender's script is told.

    What it is made of
        base_colour: what Cycles is given as the colour of the surface, 0–1, linear Rec.709;
        radius: what it is given as subsurface radius, mm, times `scale`; anisotropy: 0–0.99;
        subsurface_ior: 1.01–3.8, used by `random_walk_skin` alone; facing: a cubic k and a table
        h at equal steps of √c, 0 to 1, the base colour c becomes c (1 + k(cosine of the view)
        h(c)). `cutis.render.cycles` says which of them bring back a wanted albedo. specular: share
        of the surface's reflection, 0–1: two GGX lobes at index 1.4 [walter2007], 85 % of 0.75
        times the roughness and 15 % of 1.30 times [unreal2022]; roughness: 0–1, or a file; normal:
        a tangent-space normal map.
    What is seen
        mesh: one of `MESHES` or a file in one of `FORMATS`, +Y up, the face towards +Z in files
        of OBJ and glTF; millimetres_per_unit: of the file, None to take it for a head 240 mm high;
        subdivision: levels of Catmull–Clark, None for 1 or 2 on cages of few quadrilaterals;
        turn: degrees about the vertical, positive to the picture's right; tilt: degrees
        backwards, None for 15 on the patch (0 under `furnace`) and 0 on everything else;
        zoom: 1 shows the whole mesh at any turn; centre: the place of that picture which a zoomed
        one shows in its middle, from the lower left (0, 0) to the upper right (1, 1).
    Light and picture
        light: one of `LIGHTS`, set so that a white card facing the camera has luminance 0.8;
        exposure: stops; backdrop: a wall behind the subject; transparent: no background (nor
        backdrop) and an alpha channel; width, height: pixels; samples: a pixel; seed; denoise: by
        Open Image Denoise with albedo and normals; device: `auto` takes a GPU where Cycles finds
        one.

    Raises CutisError for values out of range and files that do not exist.
    """

    base_colour: Source = (0.6, 0.4, 0.3)
    radius: Source = (1.0, 1.0, 1.0)
    scale: float = 1.0
    anisotropy: float = 0.0
    method: str = "random_walk"
    subsurface_ior: float = 1.4
    facing: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    specular: float = 1.0
    roughness: float | Path = 0.5
    normal: Path | None = None
    mesh: str | Path = "sphere"
    millimetres_per_unit: float | None = None
    subdivision: int | None = None
    turn: float = 0.0
    tilt: float | None = None
    zoom: float = 1.0
    centre: tuple[float, float] = (0.5, 0.5)
    light: str = "studio"
    exposure: float = 0.0
    backdrop: bool = True
    transparent: bool = False
    width: int = 512
    height: int = 512
    samples: int = 64
    seed: int = 0
    denoise: bool = True
    device: str = "auto"

    def __post_init__(self) -> None:
        """Checks ranges and files."""
        _source("base colour", self.base_colour, 0.0, 1.0)
        _source("subsurface radius", self.radius, 0.0, 1e4)
        _number("scale of the subsurface radius", self.scale, 1e-6, 1e6)
        _number("anisotropy", self.anisotropy, 0.0, 0.99)
        _number("subsurface index of refraction", self.subsurface_ior, 1.01, 3.8)
        _number("specular share", self.specular, 0.0, 1.0)
        if isinstance(self.roughness, Path):
            _file("roughness map", self.roughness)
        else:
            _number("roughness", self.roughness, 0.0, 1.0)
        if self.normal is not None:
            _file("normal map", self.normal)
        self._check_mesh()
        _number("turn", self.turn, -3600.0, 3600.0)
        _number("tilt", 0.0 if self.tilt is None else self.tilt, -90.0, 90.0)
        _number("zoom", self.zoom, 0.1, 100.0)
        for value in self.centre:
            _number("centre", value, 0.0, 1.0)
        _one_of("light", self.light, LIGHTS)
        _one_of("subsurface method", self.method, METHODS)
        _one_of("device", self.device, DEVICES)
        _number("exposure", self.exposure, -20.0, 20.0)
        _whole("width", self.width, 1, 16384)
        _whole("height", self.height, 1, 16384)
        _whole("number of samples", self.samples, 1, 1 << 20)
        _whole("seed", self.seed, 0, (1 << 31) - 1)

    def _check_mesh(self) -> None:
        if self.mesh not in MESHES:
            path = Path(self.mesh)
            if path.suffix.lower() not in FORMATS:
                known = ", ".join(FORMATS)
                raise CutisError(
                    f"{path}: not a mesh that can be read; give one of {known}, or sphere or patch"
                )
            _file("mesh", path)
        if self.millimetres_per_unit is not None:
            _number("millimetres per mesh unit", self.millimetres_per_unit, 1e-9, 1e9)
        if self.subdivision is not None:
            _whole("subdivision", self.subdivision, 0, 4)

    def job(self, output: Path) -> dict[str, Any]:
        """What Blender's script is told about this picture: plain values, absolute paths."""
        job: dict[str, Any] = asdict(self) | {"output": os.path.abspath(output)}
        job["tilt"] = self._tilt()
        if self.mesh not in MESHES:
            job["mesh"] = Path(self.mesh)
        for field in fields(self):
            value = job[field.name]
            if isinstance(value, Path):
                job[field.name] = os.path.abspath(value)
            elif isinstance(value, tuple):
                job[field.name] = list(value)
        return job

    def _tilt(self) -> float:
        if self.tilt is not None:
            return self.tilt
        return 15.0 if self.mesh == "patch" and self.light != "furnace" else 0.0


def _source(name: str, value: Source, low: float, high: float) -> None:
    if isinstance(value, Path):
        _file(name, value)
        return
    if len(value) != 3:
        raise CutisError(f"the {name} has {len(value)} values; give three, or a file")
    for one in value:
        _number(name, one, low, high)


def _file(name: str, path: Path) -> None:
    if TOKEN in path.name:
        udim_tiles(path)
    elif not path.is_file():
        raise CutisError(f"{path}: there is no such file to take the {name} from")


def _number(name: str, value: float, low: float, high: float) -> None:
    if not (math.isfinite(value) and low <= value <= high):
        raise CutisError(f"the {name} is {value:g}; it has to be {low:g} to {high:g}")


def _whole(name: str, value: int, low: int, high: int) -> None:
    if int(value) != value:
        raise CutisError(f"the {name} is {value}; it has to be a whole number")
    _number(name, value, low, high)


def _one_of(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise CutisError(f"the {name} is {value!r}; it has to be one of {', '.join(known)}")
