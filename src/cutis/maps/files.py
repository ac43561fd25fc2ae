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
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cutis.textures as textures
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import NAMES, PARAMETERS, Parameter

PREFIX = "cutis:"
ORIGINAL = "original."
"""Before the names of maps as they were before edits; maps that are the same are left out."""


def save_maps(skin: SkinMaps, path: str | os.PathLike[str], dtype: str = "float") -> None:
    """Writes maps and mask to `path` (.exr); `dtype` is float (exact) or half (11 bits)."""
    channels = {name: getattr(skin, name) for name in (*NAMES, "mask")}
    if skin.original is not None:
        for name in NAMES:
            before = getattr(skin.original, name)
            if not np.array_equal(before, channels[name]):
                channels[ORIGINAL + name] = before
    header: dict[str, str | float | int] = {
        f"{PREFIX}{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}" for p in PARAMETERS
    }
    header[f"{PREFIX}model"] = skin.model
    header[f"{PREFIX}calibration"] = json.dumps(asdict(skin.calibration))
    if skin.edits:
        header[f"{PREFIX}edits"] = json.dumps(list(zip(skin.edits, skin.clamped, strict=True)))
    for key, value in skin.provenance.items():
        header[f"{PREFIX}{key}"] = _from_folder(value, path) if key == "source" else value
    if dtype not in ("float", "half"):
        raise CutisError(f"maps are stored as float or half, not {dtype}")
    textures.write_channels(path, channels, "half" if dtype == "half" else "float", header)


def load_maps(path: str | os.PathLike[str]) -> SkinMaps:
    """Reads what `save_maps` wrote; CutisError when channels are missing or out of range."""
    path = Path(path)
    if path.is_file() and path.suffix.lower() != ".exr":
        raise CutisError(
            f"{path.name} is not a file of skin maps (NAME.skin.exr); "
            "make one from a texture with: cutis estimate"
        )
    channels, metadata = textures.read_channels(path)
    missing = [name for name in NAMES if name not in channels]
    if missing:
        raise CutisError(
            f"{path.name}: not a file of skin maps (no channel {', '.join(missing)}); "
            "make one with: cutis estimate"
        )
    mask = channels.get("mask", np.ones(channels["melanin"].shape, dtype=np.float32))
    if not (mask.min() >= 0 and 0 < mask.max() <= 1):  # NaN fails too
        raise CutisError(f"{path.name}: its mask is empty or not within 0 to 1; estimate again")
    maps: dict[str, Any] = {p.name: _checked(path, channels[p.name], p, mask) for p in PARAMETERS}
    before = {
        p.name: _checked(path, channels[ORIGINAL + p.name], p, mask)
        for p in PARAMETERS
        if ORIGINAL + p.name in channels
    }
    notes = {k[len(PREFIX) :]: str(v) for k, v in metadata.items() if k.startswith(PREFIX)}
    try:
        stored = json.loads(notes.pop("calibration", '{"gains": [1, 1, 1], "origin": "none"}'))
        red, green, blue = (float(g) for g in stored["gains"])
        if not all(0 < gain < float("inf") for gain in (red, green, blue)):
            raise ValueError("gains must be positive")
        light, conversion = str(stored.get("light", "D65")), stored.get("conversion")
        if conversion is not None:
            conversion = tuple(tuple(float(v) for v in row) for row in conversion)
            if not np.isfinite(np.linalg.inv(np.array(conversion)) @ np.ones(3)).all():
                raise ValueError("the conversion of light must be invertible")
        calibration = Calibration((red, green, blue), str(stored["origin"]), light, conversion)
        edits = [
            (str(edit), int(clamped)) for edit, clamped in json.loads(notes.pop("edits", "[]"))
        ]
    except (ValueError, KeyError, TypeError, np.linalg.LinAlgError) as error:
        raise CutisError(f"{path.name}: its header is damaged; estimate again") from error
    model = notes.pop("model", "default")
    provenance = {key: value for key, value in notes.items() if key not in NAMES}
    skin = SkinMaps(**maps, mask=mask, calibration=calibration, model=model, provenance=provenance)
    if not (edits or before):
        return skin
    changes: dict[str, Any] = before
    return replace(
        skin,
        original=replace(skin, **changes),
        edits=tuple(edit for edit, _ in edits),
        clamped=tuple(clamped for _, clamped in edits),
    )


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
        capture = find_source(skin, path, None if source is None else Path(source))
    except CutisError:
        if source is not None:
            raise
        return skin
    encoding = skin.provenance.get("source_encoding")
    texture = textures.read_texture(capture, "srgb" if encoding == "srgb" else "linear")
    colours = texture.linear()
    original = skin.original and replace(skin.original, source=colours)
    note = source_note(capture, texture.encoding)
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


def source_note(source: Path, encoding: str) -> dict[str, str]:
    """Provenance of a capture: its whole path, SHA-256 and encoding.

    `save_maps` stores the path as seen from the folder of the maps.
    """
    return {
        "source": source.resolve().as_posix(),
        "source_sha256": digest(source),
        "source_encoding": encoding,
    }


def find_source(skin: SkinMaps, maps_path: Path, given: Path | None = None) -> Path:
    """The capture that maps were made from: `given`, or what their header names.

    Raises CutisError when it is gone or has changed since.
    """
    name = skin.provenance.get("source")
    if given is None and name is None:
        raise CutisError(f"{maps_path.name} does not name its capture; give it with --source")
    beside = maps_path.parent
    candidates = [given] if given else [beside / str(name), beside / Path(str(name)).name]
    present = [candidate for candidate in candidates if candidate.is_file()]
    expected = skin.provenance.get("source_sha256")
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
