"""Example heads that come with cutis: meshes, albedos that fit their UVs, and whom to credit."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from cutis.errors import CutisError


@dataclass(frozen=True)
class Head:
    """A head to render skin on.

    `mesh` is an OBJ file with UVs in [0, 1]; `albedos` maps names to 8 bit sRGB textures that fit
    them, light to dark, the first of which is the default; `mask` (white = head) covers what of the
    textures is head, None for all. Groups of the mesh in `untextured` have no UVs of their own.
    `zoom` and `centre` frame the face (`Scene`). `millimetres` is the length of one unit of the
    mesh. `credit` is what to print wherever a picture of this head is published.
    """

    name: str
    mesh: Path
    albedos: Mapping[str, Path]
    mask: Path | None
    millimetres: float
    credit: str
    licence: str
    untextured: tuple[str, ...] = ()
    zoom: float = 1.0
    centre: tuple[float, float] = (0.5, 0.5)

    @property
    def albedo(self) -> Path:
        """The default texture."""
        return next(iter(self.albedos.values()))


def heads() -> tuple[Head, ...]:
    """The heads that come with cutis, the default first.

    The mesh of MakeHuman is in decimetres. That of Lee Perry-Smith has no unit: 4.19 of its units
    from brow to back of the head and 3.15 across above the ears are the mean of men, 199 mm and
    154 mm, at 47.5 and 48.9 mm per unit [gordon2014]; 48 is between.
    """
    folder = Path(str(resources.files("cutis.data").joinpath("heads")))
    scan = Head(
        name="leeperrysmith",
        mesh=folder / "leeperrysmith_head.obj",
        albedos={"scan": folder / "leeperrysmith_color.jpg"},
        mask=None,
        millimetres=48.0,
        credit="head scan by Lee Perry-Smith / Infinite-Realities (www.triplegangers.com), "
        "CC BY 3.0 (creativecommons.org/licenses/by/3.0)",
        licence="CC BY 3.0",
        zoom=1.65,
        centre=(0.5, 0.7),
    )
    people = (
        "young_light_female2",
        "middleage_light_male",
        "old_light_male2",
        "african_middleage_mindfront",
        "young_dark_male",
    )
    made = Head(
        name="makehuman",
        mesh=folder / "makehuman_head.obj",
        albedos={name: folder / f"makehuman_{name}.jpg" for name in people},
        mask=folder / "makehuman_head_mask.png",
        millimetres=100.0,
        credit="head by the MakeHuman team and MINDFRONT, CC0 1.0",
        licence="CC0 1.0",
        untextured=("eyes",),
    )
    return scan, made


def head(name: str) -> Head:
    """The head of that name; CutisError, listing the names, if there is none."""
    found = {each.name: each for each in heads()}
    if name not in found:
        raise CutisError(f"there is no head called {name}; choose from {', '.join(found)}")
    return found[name]


def credits_of(*files: str | os.PathLike[str]) -> tuple[str, ...]:
    """Credits due for a picture made from these files: those of heads that any belong to."""
    used = {Path(file).resolve() for file in files}
    return tuple(
        each.credit
        for each in heads()
        if used & {path.resolve() for path in (each.mesh, *each.albedos.values())}
    )
