"""What a picture or a material shows: skin, from maps or a texture, with edits on it."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.jobs.estimate import EstimateJob
from cutis.jobs.outcome import CaptureFiles
from cutis.looks import asked, nothing
from cutis.maps import Change, Edits, Face, bound
from cutis.maps.estimating import Progress, nobody
from cutis.maps.face import Memo
from cutis.render.heads import Head
from cutis.render.scene import Scene
from cutis.render.skin import MAPS, Skin
from cutis.textures import Orientation, TextureFile
from cutis.textures.scratch import scratch_folder
from cutis.textures.udim import FIRST, TOKEN, tile_of, udim_tiles

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

    def changes(self, skin: Skin, more: Edits = (), memo: Memo | None = None) -> tuple[Change, ...]:
        """The edits, and more of them, as they are on an open skin; see `Face` for `memo`."""
        wanted = [
            asked(one, self.amount, self.mask) for one in (self.edits, more) if not nothing(one)
        ]
        if wanted and skin.maps is None:
            raise skin.no_maps()
        return bound(wanted, Face(skin.maps, memo=memo)) if skin.maps is not None else ()

    def tiles(self) -> "dict[int, Subject]":
        """The subject of each tile of a set NAME.<UDIM>.EXT; itself, as 1001, otherwise."""
        if TOKEN not in self.skin.name:
            return {FIRST: self}
        names = ("skin", "mask", "source")
        paths: dict[str, Any] = {name: getattr(self, name) for name in names}
        return {
            number: self._with({n: p and tile_of(p, number) for n, p in paths.items()})
            for number in udim_tiles(self.skin)
        }

    def _with(self, changed: dict[str, Any]) -> "Subject":
        return replace(self, **changed)

    @contextlib.contextmanager
    def with_maps(self, needed: bool, progress: Progress = nobody) -> Iterator["Subject"]:
        """The same with maps, where they are `needed` and the skin is that of a bundled head.

        They are estimated anew, as fast as a picture is rendered.
        """
        head = self.head
        if not needed or head is None or self.skin not in head.albedos.values():
            yield self
            return
        with scratch_folder() as folder:
            capture = CaptureFiles(self.skin, head.mask)
            EstimateJob((capture,), folder, sigma=False).run(progress)
            yield replace(self, skin=folder / f"{self.skin.stem}{MAPS}", source=self.skin)

    def inputs(self) -> dict[str, Path | None]:
        """All files that are read, by what they are called."""
        scene = self.scene
        maybe = {"mesh": scene.mesh, "normal map": scene.normal, "roughness map": scene.roughness}
        found = {f"the {what}": p for what, p in maybe.items() if isinstance(p, Path)}
        return {
            "the skin to render": self.skin, "the mask": self.mask, "the capture": self.source,
            **found,
        }  # fmt: skip


def needs_maps(subject: Subject) -> bool:
    """Whether a subject cannot be shown by a texture alone."""
    return subject.radius == "maps" or not nothing(subject.edits)


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
