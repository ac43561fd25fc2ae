"""Skin maps into one multi-channel EXR: named channels, units and provenance in its header.

Parameter maps are data, not colour: no transfer function ever touches them. The capture itself
is not copied; the header names it (relative to the EXR) and its SHA-256, so that an edit can find
it again and refuses another file. Of edited maps, what the estimate was before is kept as
`original.<map>`: the capture shows the skin before the edit, so its colours change by the ratio of
the two, however often the maps are saved and edited again; the looks that were applied are kept as
documents. Where the values of the five maps lie (`Quantiles`) is kept too, and which tiles the face
has: looks take medians over all of it, whichever part is at hand. Standard deviations
`<map>.sigma` and `confidence` are stored as half in any case, which is more than they are known to.
The model is named with its digest.
"""

import contextlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import State
from cutis.maps.statistics import MapStatistics, Quantiles
from cutis.maps.trust import CONFIDENCE, SIGMA
from cutis.optics import NAMES, PARAMETERS, RARE
from cutis.textures.channels import channel_writer
from cutis.textures.frame import noted_frame
from cutis.textures.texture import bands

if TYPE_CHECKING:
    from cutis.maps.skin_maps import SkinMaps

PREFIX = "cutis:"
PATHS = ("source", "source_ocio")
"""Provenance that names files: whole in memory, as seen from the folder of the maps when stored."""
ORIGINAL = "original."
"""Before the names of maps as they were before edits; maps that are the same are left out."""


@dataclass(frozen=True)
class Header:
    """What a file of maps says of itself, and which channels it has.

    `sigmas` names the maps that have a σ, `confident` says whether there is a confidence, `changed`
    names the maps that edits may have changed, `rare` the rare chromophores that have a map.
    `looks` are the documents of what was applied, `tiles` the numbers of all tiles of a UDIM set
    that this is one of. `quantiles` is what the writer found, None in files from before.
    """

    model: str
    digest: str = ""
    calibration: Calibration = field(default_factory=Calibration)
    provenance: Mapping[str, str] = field(default_factory=dict)
    state: State = field(default_factory=dict)
    edits: tuple[str, ...] = ()
    clamped: tuple[int, ...] = ()
    sigmas: tuple[str, ...] = ()
    confident: bool = False
    changed: tuple[str, ...] = ()
    rare: tuple[str, ...] = ()
    looks: tuple[str, ...] = ()
    tiles: tuple[int, ...] = ()
    quantiles: Quantiles | None = None

    def attributes(self, path: str | os.PathLike[str]) -> dict[str, str | float | int]:
        """The attributes of an EXR at `path`."""
        found: dict[str, str | float | int] = {
            f"{PREFIX}{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}"
            for p in (*PARAMETERS, *(p for p in RARE if p.name in self.rare))
        }
        found[f"{PREFIX}model"] = self.model
        if self.digest:
            found[f"{PREFIX}model_digest"] = self.digest
        found[f"{PREFIX}calibration"] = json.dumps(asdict(self.calibration))
        if self.state:
            found[f"{PREFIX}survey"] = json.dumps(dict(self.state))
        if self.edits:
            found[f"{PREFIX}edits"] = json.dumps(list(zip(self.edits, self.clamped, strict=True)))
        if self.looks:
            found[f"{PREFIX}looks"] = json.dumps([json.loads(look) for look in self.looks])
        if self.tiles:
            found[f"{PREFIX}tiles"] = " ".join(map(str, self.tiles))
        for key, value in self.provenance.items():
            found[f"{PREFIX}{key}"] = _from_folder(value, path) if key in PATHS else value
        return found


def save_maps(
    skin: "SkinMaps", path: str | os.PathLike[str], dtype: Literal["float", "half"] = "float"
) -> None:
    """Writes maps and mask to `path` (.exr); `dtype` is float (exact) or half (11 bits)."""
    before = skin.original
    changed = () if before is None else tuple(
        name for name in NAMES if not np.array_equal(before.map(name), skin.map(name))
    )  # fmt: skip
    made = skin.made_by
    header = Header(
        made.name, made.digest, skin.calibration, skin.provenance, skin.estimate.state,
        skin.edits, skin.clamped, tuple(skin.sigmas), skin.confidence is not None, changed,
        skin.rare, skin.documents, tuple(skin.estimate.tile.files),
    )  # fmt: skip
    with maps_writer(path, header, skin.shape, dtype) as write:
        for rows in bands(skin.shape):
            write(skin.rows(rows))


@contextlib.contextmanager
def maps_writer(
    path: str | os.PathLike[str],
    header: Header,
    shape: tuple[int, int],
    dtype: Literal["float", "half"] = "float",
    statistics: MapStatistics | None = None,
) -> Iterator[Callable[["SkinMaps"], None]]:
    """What `save_maps` does, some rows at a time: yields a function that takes the next rows.

    `statistics` are those of the whole, where somebody else gathers them before the end.
    """
    if dtype not in ("float", "half"):
        raise CutisError(f"maps are stored as float or half, not {dtype}")
    maps = (*NAMES, *(p.name for p in RARE if p.name in header.rare), "mask")
    changed: Sequence[str] = header.changed
    if header.edits:  # without a map before edits, a rare chromophore was not there
        changed = tuple(dict.fromkeys((*changed, *header.rare)))
    trust = (*(name + SIGMA for name in header.sigmas),)
    trust += (CONFIDENCE,) if header.confident else ()
    names = (*maps, *(ORIGINAL + name for name in changed), *trust)
    attributes, found = header.attributes(path), statistics or MapStatistics()
    late = {f"{PREFIX}quantiles": lambda: found.quantiles().text()}
    frame = noted_frame(header.provenance.get("window", ""), shape)
    with channel_writer(path, names, shape, dtype, attributes, trust, frame, late) as put:

        def write(part: "SkinMaps") -> None:
            if statistics is None:
                found.add(part.coordinates(), part.mask > 0)
            channels: dict[str, Any] = {name: part.map(name) for name in maps[:-1]}
            channels["mask"] = part.mask
            for name in changed:
                channels[ORIGINAL + name] = part.estimate.map(name)
            channels |= {name + SIGMA: part.sigmas[name] for name in header.sigmas}
            if header.confident:
                channels[CONFIDENCE] = part.confidence
            put(channels)

        yield write


def _from_folder(source: str, maps: str | os.PathLike[str]) -> str:
    """A capture's whole path as one from the folder of the maps; others as they are."""
    if Path(source).is_absolute():
        with contextlib.suppress(ValueError):  # on another drive
            return Path(os.path.relpath(source, Path(maps).resolve().parent)).as_posix()
    return source
