"""A skin material: everything of it that is not a texel, in words that any renderer understands."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.textures import replacing

Triple = tuple[float, float, float]
LINEAR = "linear Rec.709 (scene-linear, Rec.709 primaries, D65)"
NEUTRAL = 0.5
"""Value of a roughness map at which the lobes are as rough as without it, else in proportion."""


@dataclass(frozen=True)
class Gloss:
    """Mirror reflection at the surface: two GGX lobes of one dielectric interface.

    A share `mix` of the light that is reflected goes to the lobe of the first `roughness`, the rest
    to that of the second; GGX α is roughness². `refractive_index` is that of both; `strength`, 0 to
    1, multiplies what they reflect.
    """

    roughness: tuple[float, float] = (0.375, 0.65)
    mix: float = 0.85
    refractive_index: float = 1.4
    strength: float = 1.0

    def __post_init__(self) -> None:
        if not all(0 <= r <= 1 for r in self.roughness):
            raise CutisError(f"roughness must lie in 0 to 1, not {self.roughness}")
        for name, value in (("mix of two lobes", self.mix), ("strength", self.strength)):
            if not 0 <= value <= 1:
                raise CutisError(f"the {name} must lie in 0 to 1, not {value:g}")
        if not 1 <= self.refractive_index < 3:
            raise CutisError(f"a refractive index of {self.refractive_index:g} is not that of skin")

    @property
    def lobes(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(roughness, share) of the stronger lobe, then of the other; rougher first if equal."""
        first, second = self.roughness
        ordered = sorted([(self.mix, first), (1 - self.mix, second)], reverse=True)
        (share, roughness), (other_share, other) = ordered
        return (roughness, share), (other, other_share)


@dataclass(frozen=True)
class Material:
    """Subsurface medium and surface of a skin, with the names of its textures.

    `albedo` is the texture of diffuse albedo (linear Rec.709), which renderers invert themselves;
    `single_scattering` that of the medium's single-scattering albedo, for those that do not.
    `radius` is the mean free path in mm of red, green and blue, where `radius_texture` (in mm too)
    is given its mean. `anisotropy` is the g of the Henyey–Greenstein phase function that belongs
    to both. `cycles_colour` and `cycles_radius` (mm) are textures for Cycles alone, with which its
    walk returns the albedo. `millimetres` is the length of one unit of the scene. `normal` is a
    tangent-space normal map and `roughness` a grey map that the roughness of both lobes is in
    proportion to (see `NEUTRAL`). File names are relative to the folder of the material. Raises
    CutisError for lengths that are not positive and g outside −1 to 1.
    """

    name: str
    albedo: str
    single_scattering: str
    radius: Triple
    anisotropy: float
    millimetres: float
    radius_texture: str | None = None
    cycles_colour: str | None = None
    cycles_radius: str | None = None
    normal: str | None = None
    roughness: str | None = None
    gloss: Gloss = field(default_factory=Gloss)
    notes: Mapping[str, Any] = field(default_factory=dict)
    credits: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not all(0 < r < float("inf") for r in (*self.radius, self.millimetres)):
            raise CutisError(
                f"mean free path {self.radius} and millimetres per unit {self.millimetres} "
                "must be positive"
            )
        if not -1 < self.anisotropy < 1:
            raise CutisError(f"anisotropy must lie between -1 and 1, not {self.anisotropy:g}")

    @property
    def scale(self) -> float:
        """Scene units per millimetre, what radii in mm are multiplied by."""
        return 1 / self.millimetres

    def description(self) -> dict[str, Any]:
        """What the sidecar says, ready for JSON."""
        textures = {
            kind: {"file": file, "colour_space": space, "unit": unit, "meaning": meaning}
            for kind, file, space, unit, meaning in (
                ("albedo", self.albedo, LINEAR, "1", "diffuse albedo; for subsurface colour "
                 "inputs, which renderers invert"),
                ("single_scattering", self.single_scattering, "data", "1", "single-scattering "
                 "albedo of the medium per RGB band; instead of the albedo where a medium is given "
                 "by its coefficients"),
                ("radius", self.radius_texture, "data", "mm", "mean free path per RGB band"),
                ("cycles_colour", self.cycles_colour, LINEAR, "1", "base colour for Blender's "
                 "Random Walk (Skin), with which it returns the albedo"),
                ("cycles_radius", self.cycles_radius, "data", "mm", "subsurface radius for that "
                 "base colour"),
                ("normal", self.normal, "data", "1", "tangent-space normal, 0 to 1 for -1 to 1"),
                ("roughness", self.roughness, "data", "1", "roughness of both lobes, as without "
                 f"the map where it is {NEUTRAL:g}, else in proportion"),
            )
            if file is not None
        }  # fmt: skip
        return {
            "name": self.name,
            "textures": textures,
            "radius_mm": list(self.radius),
            "anisotropy": self.anisotropy,
            "phase_function": "Henyey-Greenstein",
            "millimetres_per_unit": self.millimetres,
            "scene_units_per_millimetre": self.scale,
            "specular": {
                "distribution": "GGX, alpha = roughness^2",
                "roughness": list(self.gloss.roughness),
                "mix": self.gloss.mix,
                "refractive_index": self.gloss.refractive_index,
                "strength": self.gloss.strength,
            },
            **self.notes,
            "credits": list(self.credits),
        }


def write_description(material: Material, path: Path) -> None:
    """Writes NAME.material.json: units, g, index, scale, specular lobes, what made it, credits."""
    text = json.dumps(material.description(), indent=1, ensure_ascii=False) + "\n"
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
