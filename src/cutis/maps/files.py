"""Skin maps as one multi-channel EXR: named channels, units and provenance in its header.

Parameter maps are data, not colour: no transfer function ever touches them. The capture itself
is not copied; the header names it (relative to the EXR) and its SHA-256, so that an edit can find
it again and refuses another file.
"""

import hashlib
import json
import os
from pathlib import Path

import numpy as np

import cutis.textures as textures
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import NAMES, PARAMETERS

PREFIX = "cutis:"


def save_maps(skin: SkinMaps, path: str | os.PathLike[str], dtype: str = "float") -> None:
    """Writes maps and mask to `path` (.exr); `dtype` is float (exact) or half (11 bits)."""
    channels = {name: getattr(skin, name) for name in (*NAMES, "mask")}
    header: dict[str, str | float | int] = {
        f"{PREFIX}{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}" for p in PARAMETERS
    }
    header[f"{PREFIX}model"] = skin.model
    header[f"{PREFIX}calibration"] = json.dumps(
        {"gains": skin.calibration.gains, "origin": skin.calibration.origin}
    )
    if skin.edits:
        header[f"{PREFIX}edits"] = json.dumps(list(skin.edits))
    for key, value in skin.provenance.items():
        header[f"{PREFIX}{key}"] = value
    if dtype not in ("float", "half"):
        raise CutisError(f"maps are stored as float or half, not {dtype}")
    textures.write_channels(path, channels, "half" if dtype == "half" else "float", header)


def load_maps(path: str | os.PathLike[str]) -> SkinMaps:
    """Reads what `save_maps` wrote; CutisError when channels are missing or out of range."""
    path = Path(path)
    channels, metadata = textures.read_channels(path)
    missing = [name for name in NAMES if name not in channels]
    if missing:
        raise CutisError(
            f"{path.name}: not a file of skin maps (no channel {', '.join(missing)}); "
            "make one with: cutis estimate"
        )
    shape = channels["melanin"].shape
    mask = channels.get("mask", np.ones(shape, dtype=np.float32))
    inside = mask > 0
    maps = {}
    for known in PARAMETERS:
        values = channels[known.name]
        slack = 1e-3 * (known.high - known.low)  # what storing as half may add
        bad = ~((values >= known.low - slack) & (values <= known.high + slack)) & inside
        if bad.any():
            raise CutisError(
                f"{path.name}: {int(bad.sum())} texels of {known.name} are outside "
                f"{known.low:g} to {known.high:g} {known.unit}"
            )
        maps[known.name] = np.where(inside, np.clip(values, known.low, known.high), 0).astype(
            np.float32
        )
    notes = {k[len(PREFIX) :]: str(v) for k, v in metadata.items() if k.startswith(PREFIX)}
    try:
        stored = json.loads(notes.pop("calibration", '{"gains": [1, 1, 1], "origin": "none"}'))
        red, green, blue = (float(g) for g in stored["gains"])
        calibration = Calibration((red, green, blue), str(stored["origin"]))
        edits = tuple(str(e) for e in json.loads(notes.pop("edits", "[]")))
    except (ValueError, KeyError, TypeError) as error:
        raise CutisError(f"{path.name}: its header is damaged; estimate again") from error
    model = notes.pop("model", "default")
    provenance = {key: value for key, value in notes.items() if key not in NAMES}
    return SkinMaps(
        **maps, mask=mask, calibration=calibration, model=model, edits=edits, provenance=provenance
    )


def source_note(source: Path, beside: Path, encoding: str) -> dict[str, str]:
    """Provenance of a capture: its path from the folder of `beside`, SHA-256 and encoding."""
    relative = os.path.relpath(source.resolve(), beside.resolve().parent)
    return {"source": Path(relative).as_posix(), "source_sha256": digest(source),
            "source_encoding": encoding}  # fmt: skip


def find_source(skin: SkinMaps, maps_path: Path, given: Path | None = None) -> Path:
    """The capture that maps were made from: `given`, or what their header names.

    Raises CutisError when it is gone or has changed since.
    """
    name = skin.provenance.get("source")
    if given is None and name is None:
        raise CutisError(f"{maps_path.name} does not name its capture; give it with --source")
    candidates = [given] if given else [maps_path.parent / str(name),
                                        maps_path.parent / Path(str(name)).name]  # fmt: skip
    for candidate in candidates:
        if candidate.is_file():
            expected = skin.provenance.get("source_sha256")
            if expected and digest(candidate) != expected:
                raise CutisError(
                    f"{candidate.name} has changed since {maps_path.name} was made; "
                    "estimate again, or give the original with --source"
                )
            return candidate
    raise CutisError(
        f"the capture {candidates[0]} of {maps_path.name} is missing; give it with --source"
    )


def digest(path: Path) -> str:
    """SHA-256 of a file, hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
