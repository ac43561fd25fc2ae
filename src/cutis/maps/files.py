"""Skin maps as one multi-channel EXR: named channels, units and provenance in its header.

Parameter maps are data, not colour: no transfer function ever touches them. The capture itself
is not copied; the header names it (relative to the EXR) and its SHA-256, so that an edit can find
it again and refuses another file. Of edited maps, what the estimate was before is kept as
`original.<map>`: the capture shows the skin before the edit, so its colours change by the ratio of
the two, however often the maps are saved and edited again.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import cutis.textures as textures
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.models import stored_name
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import NAMES, PARAMETERS, RARE, RARE_NAMES, Parameter
from cutis.textures.closing import Closing

PREFIX = "cutis:"
PATHS = ("source", "source_ocio")
"""Provenance that names files: whole in memory, as seen from the folder of the maps when stored."""
ORIGINAL = "original."
"""Before the names of maps as they were before edits; maps that are the same are left out."""


def save_maps(
    skin: SkinMaps, path: str | os.PathLike[str], dtype: Literal["float", "half"] = "float"
) -> None:
    """Writes maps and mask to `path` (.exr); `dtype` is float (exact) or half (11 bits)."""
    before = skin.original
    changed = () if before is None else tuple(
        name for name in NAMES if not np.array_equal(getattr(before, name), getattr(skin, name))
    )  # fmt: skip
    with maps_writer(path, skin, skin.shape, dtype, changed, skin.rare) as write:
        for rows in textures.bands(skin.shape):
            write(skin.rows(rows))


@contextlib.contextmanager
def maps_writer(
    path: str | os.PathLike[str],
    like: SkinMaps,
    shape: tuple[int, int],
    dtype: Literal["float", "half"] = "float",
    changed: Sequence[str] = (),
    rare: Sequence[str] = (),
) -> Iterator[Callable[[SkinMaps], None]]:
    """What `save_maps` does, some rows at a time: yields a function that takes the next rows.

    The header is that of `like`; `changed` names the maps that edits may have changed, `rare` the
    rare chromophores that have a map.
    """
    known = (*PARAMETERS, *(p for p in RARE if p.name in rare))
    maps = (*(p.name for p in known), "mask")
    header: dict[str, str | float | int] = {
        f"{PREFIX}{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}" for p in known
    }
    header[f"{PREFIX}model"] = like.model
    header[f"{PREFIX}calibration"] = json.dumps(asdict(like.calibration))
    if like.edits:
        header[f"{PREFIX}edits"] = json.dumps(list(zip(like.edits, like.clamped, strict=True)))
    for key, value in like.provenance.items():
        header[f"{PREFIX}{key}"] = _from_folder(value, path) if key in PATHS else value
    if dtype not in ("float", "half"):
        raise CutisError(f"maps are stored as float or half, not {dtype}")
    if like.edits:  # without a map before edits, a rare chromophore was not there
        changed = tuple(dict.fromkeys((*changed, *rare)))
    names = (*maps, *(ORIGINAL + name for name in changed))
    with textures.channel_writer(path, names, shape, dtype, header) as put:

        def write(part: SkinMaps) -> None:
            channels = {name: part.map(name) for name in maps}
            for name in changed:
                channels[ORIGINAL + name] = (part.original or part).map(name)
            put(channels)

        yield write


class MapsFile(Closing):
    """An open file of skin maps: what its header says, and its maps some rows at a time.

    `edits` and `clamped` are those of `SkinMaps`, `rare` names the rare chromophores that have a
    map, `changed` the maps whose values before edits are stored too. Close it, or use it in a with
    block. Raises CutisError where channels are missing, out of range, or the header is damaged.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        if self.path.is_file() and self.path.suffix.lower() != ".exr":
            raise CutisError(
                f"{self.path.name} is not a file of skin maps (NAME.skin.exr); "
                "make one from a texture with: cutis estimate"
            )
        self._file = textures.ChannelFile(path)
        try:
            self._read_header()
        except BaseException:
            self.close()
            raise

    def _read_header(self) -> None:
        missing = [name for name in NAMES if name not in self._file.names]
        if missing:
            raise CutisError(
                f"{self.path.name}: not a file of skin maps (no channel {', '.join(missing)}); "
                "make one with: cutis estimate"
            )
        self.shape = self._file.shape
        self.rare = tuple(name for name in RARE_NAMES if name in self._file.names)
        self.changed = tuple(
            name for name in (*NAMES, *self.rare) if ORIGINAL + name in self._file.names
        )
        metadata = self._file.metadata
        notes = {k[len(PREFIX) :]: str(v) for k, v in metadata.items() if k.startswith(PREFIX)}
        try:
            self.calibration = _calibration(notes.pop("calibration", "{}"))
            edits = [
                (str(edit), int(clamped)) for edit, clamped in json.loads(notes.pop("edits", "[]"))
            ]
        except (ValueError, KeyError, TypeError, np.linalg.LinAlgError) as error:
            raise CutisError(f"{self.path.name}: its header is damaged; estimate again") from error
        self.edits = tuple(edit for edit, _ in edits)
        self.clamped = tuple(clamped for _, clamped in edits)
        self.model = stored_name(notes.pop("model", "default"))
        self.provenance = {
            key: value for key, value in notes.items() if key not in (*NAMES, *RARE_NAMES)
        }
        config = self.provenance.get("source_ocio")
        if config and "://" not in config:
            self.provenance["source_ocio"] = os.path.join(self.path.resolve().parent, config)

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the maps, of about half a million texels each."""
        return self._file.bands()

    def rows(self, rows: slice) -> SkinMaps:
        """Maps of some rows, without their capture."""
        channels = self._file.rows(rows)
        mask = channels.get("mask", np.ones(channels["melanin"].shape, dtype=np.float32))
        if not (mask.min() >= 0 and mask.max() <= 1):  # NaN fails too
            raise self.no_mask()
        found: dict[str, Any] = {
            p.name: _checked(self.path, channels[p.name], p, mask)
            for p in (*PARAMETERS, *RARE)
            if p.name in (*NAMES, *self.rare)
        }
        skin = SkinMaps(
            **found, mask=mask, calibration=self.calibration, model=self.model,
            provenance=self.provenance, first_row=rows.indices(self.shape[0])[0], whole=self.shape,
        )  # fmt: skip
        if not (self.edits or self.changed):
            return skin
        before: dict[str, Any] = {
            p.name: _checked(self.path, channels[ORIGINAL + p.name], p, mask)
            for p in (*PARAMETERS, *RARE)
            if p.name in self.changed
        }
        original = replace(skin, **before)
        return replace(skin, original=original, edits=self.edits, clamped=self.clamped)

    def no_mask(self) -> CutisError:
        """What to raise when the mask is empty or broken."""
        return CutisError(
            f"{self.path.name}: its mask is empty or not within 0 to 1; estimate again"
        )


def load_maps(path: str | os.PathLike[str]) -> SkinMaps:
    """Reads what `save_maps` wrote; CutisError when channels are missing or out of range."""
    with MapsFile(path) as file:
        skin = file.rows(slice(None))
        if not skin.mask.max() > 0:
            raise file.no_mask()
    return skin


def _calibration(text: str) -> Calibration:
    stored = {"gains": [1, 1, 1], "origin": "none", **json.loads(text)}
    red, green, blue = (float(g) for g in stored["gains"])
    if not all(0 < gain < float("inf") for gain in (red, green, blue)):
        raise ValueError("gains must be positive")
    light, conversion = str(stored.get("light", "D65")), stored.get("conversion")
    if conversion is not None:
        conversion = tuple(tuple(float(v) for v in row) for row in conversion)
        if not np.isfinite(np.linalg.inv(np.array(conversion)) @ np.ones(3)).all():
            raise ValueError("the conversion of light must be invertible")
    return Calibration((red, green, blue), str(stored["origin"]), light, conversion)


def load_skin(
    path: str | os.PathLike[str], source: str | os.PathLike[str] | None = None
) -> SkinMaps:
    """Skin maps with their capture: `source`, or the one that their header names if it is there.

    With its capture, `albedo()` gives the capture with the edits in it; without, the model alone.
    Raises CutisError when `source` is missing or is not the capture that the maps were made from.
    """
    path = Path(path)
    skin = load_maps(path)
    try:
        capture = find_source(skin.provenance, path, None if source is None else Path(source))
    except CutisError:
        if source is not None:
            raise
        return skin
    with open_source(skin.provenance, capture) as file:
        colours = file.read().linear()
        note = source_note(file)
    original = skin.original and replace(skin.original, source=colours)
    return replace(skin, source=colours, original=original, provenance=note)


def _checked(
    path: Path, values: NDArray[np.float32], known: Parameter, mask: NDArray[np.float32]
) -> NDArray[np.float32]:
    """A stored map, 0 off the mask; CutisError where it is out of range."""
    inside = mask > 0
    slack = 1e-3 * (known.high - known.low)  # what storing as half may add
    bad = ~((values >= known.low - slack) & (values <= known.high + slack)) & inside
    if bad.any():
        raise CutisError(
            f"{path.name}: {int(bad.sum())} texels of {known.name} are outside "
            f"{known.low:g} to {known.high:g} {known.unit}; estimate again"
        )
    low, high = np.float32(known.low), np.float32(known.high)
    return np.where(inside, np.clip(values, low, high), np.float32(0))


def _from_folder(source: str, maps: str | os.PathLike[str]) -> str:
    """A capture's whole path as one from the folder of the maps; others as they are."""
    if Path(source).is_absolute():
        with contextlib.suppress(ValueError):  # on another drive
            return Path(os.path.relpath(source, Path(maps).resolve().parent)).as_posix()
    return source


def source_note(source: textures.TextureFile | textures.Texture) -> dict[str, str]:
    """Provenance of a capture: its whole path, SHA-256 and the colour space it was read in.

    `save_maps` stores the path as seen from the folder of the maps. Empty without a file.
    """
    if source.path is None or not source.path.is_file():
        return {}
    note = {
        "source": source.path.resolve().as_posix(),
        "source_sha256": digest(source.path),
        "source_colorspace": source.space.name if source.origin == "given" else "auto",
    }
    config = getattr(source.space, "config", None)
    if not config or source.origin != "given":
        return note
    return {**note, "source_ocio": config if "://" in config else Path(config).resolve().as_posix()}


def open_source(provenance: Mapping[str, str], capture: Path) -> textures.TextureFile:
    """The capture that maps were made from, opened and understood as it was then."""
    space = provenance.get("source_colorspace", "auto")
    # the configuration of then, or none: $OCIO may have changed since
    return textures.TextureFile(capture, space, provenance.get("source_ocio", ""))


def find_source(provenance: Mapping[str, str], maps_path: Path, given: Path | None = None) -> Path:
    """The capture that maps were made from: `given`, or what their provenance names.

    Raises CutisError when it is gone or has changed since.
    """
    name = provenance.get("source")
    if given is None and name is None:
        raise CutisError(f"{maps_path.name} does not name its capture; give it with --source")
    beside = maps_path.parent
    candidates = [given] if given else [beside / str(name), beside / Path(str(name)).name]
    present = [candidate for candidate in candidates if candidate.is_file()]
    expected = provenance.get("source_sha256")
    for candidate in present:
        if expected is None or digest(candidate) == expected:
            return candidate
    if present:
        raise CutisError(
            f"{present[0].name} has changed since {maps_path.name} was made; "
            "estimate again, or give the original with --source"
        )
    raise CutisError(
        f"the capture {candidates[0]} of {maps_path.name} is missing; give it with --source"
    )


def digest(path: Path) -> str:
    """SHA-256 of a file, hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
