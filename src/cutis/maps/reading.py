"""Skin maps out of the files that `writing` makes, and out of those of earlier versions."""

import contextlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cutis.errors import CutisError
from cutis.inverse import Model
from cutis.inverse.calibration import Calibration
from cutis.maps.changes import Change, Tile
from cutis.maps.defaults import DEFAULT, OLD_DEFAULT
from cutis.maps.face import TileOf, edited
from cutis.maps.lost import lost_note
from cutis.maps.plain import Map, Maps, Place
from cutis.maps.skin_maps import EditedEstimate, Estimate, MadeBy, SkinMaps
from cutis.maps.source import find_source, open_source, source_note
from cutis.maps.statistics import Quantiles
from cutis.maps.trust import CONFIDENCE, SIGMA, stored_sigma
from cutis.maps.writing import ORIGINAL, PREFIX, Header
from cutis.optics import NAMES, PARAMETERS, RARE, RARE_NAMES, Parameter, parameter
from cutis.textures.channels import ChannelFile
from cutis.textures.closing import Closing
from cutis.textures.udim import tile_of, udim_pattern

KEPT = 1 << 28
"""Bytes of maps that are kept, where they will be asked for again."""
LARGEST = 1e3
"""Of gains, and of the numbers that turn the RGB of one light into that of another."""


class MapsFile(Closing):
    """An open file of skin maps: what its header says, and its maps some rows at a time.

    `header` is a `Header`, `frame` says where the maps lie on their picture; with `shown` they are
    those of all of it, outside the mask where nothing is stored. Close it, or use it in a with
    block. `untold` names what the header does not say and should: "model", "calibration". Raises
    CutisError where channels are missing, out of range, or the header is
    damaged.
    """

    def __init__(self, path: str | os.PathLike[str], shown: bool = False) -> None:
        self.path = Path(path)
        if self.path.is_file() and self.path.suffix.lower() != ".exr":
            raise CutisError(
                f"{self.path.name} is not a file of skin maps (NAME.skin.exr); "
                "make one from a texture with: cutis estimate"
            )
        self._file = ChannelFile(path, shown)
        self._keeping, self._kept = False, dict[str, Map]()
        try:
            self._check_channels()
            self.shape, self.frame = self._file.shape, self._file.frame
            self.untold: tuple[str, ...] = ()
            self.header = self._read_header()
        except BaseException:
            self.close()
            raise

    def _check_channels(self) -> None:
        missing = [name for name in NAMES if name not in self._file.names]
        if missing:
            raise CutisError(
                f"{self.path.name}: not a file of skin maps (no channel {', '.join(missing)}); "
                "make one with: cutis estimate"
            )

    def _read_header(self) -> Header:
        there, metadata = self._file.names, self._file.metadata
        notes = {k[len(PREFIX) :]: str(v) for k, v in metadata.items() if k.startswith(PREFIX)}
        without = OLD_DEFAULT if notes else DEFAULT  # the first files named no model
        needed = ("model", "calibration")
        if "model" not in notes or "source" in notes:  # of fitted spectra there are no gains
            self.untold = tuple(name for name in needed if name not in notes)
        try:
            calibration = _calibration(notes.pop("calibration", "{}"))
            state = json.loads(notes.pop("survey", "{}"))
            edits = [
                (str(edit), int(clamped)) for edit, clamped in json.loads(notes.pop("edits", "[]"))
            ]
            looks = tuple(json.dumps(look) for look in json.loads(notes.pop("looks", "[]")))
            tiles = tuple(int(number) for number in notes.pop("tiles", "").split())
            text = notes.pop("quantiles", "")
            quantiles = Quantiles.of_text(text) if text else None
            if not isinstance(state, dict):
                raise TypeError("a survey is an object")
        except (
            ValueError, KeyError, TypeError, OverflowError, RecursionError, AttributeError,
            np.linalg.LinAlgError,
        ) as error:  # fmt: skip
            raise CutisError(f"{self.path.name}: its header is damaged; estimate again") from error
        model, digest = notes.pop("model", without), notes.pop("model_digest", "")
        rare = tuple(name for name in RARE_NAMES if name in there)
        known = (*NAMES, *rare)
        provenance = {k: v for k, v in notes.items() if k not in (*NAMES, *RARE_NAMES)}
        provenance.pop("window", None)  # what the file says of itself counts
        if not self.frame.whole:
            provenance["window"] = self.frame.note()
        config = provenance.get("source_ocio")
        if config and "://" not in config:
            provenance["source_ocio"] = os.path.join(self.path.resolve().parent, config)
        return Header(
            OLD_DEFAULT if model == "default" else model, digest, calibration, provenance, state,
            edits=tuple(edit for edit, _ in edits),
            clamped=tuple(clamped for _, clamped in edits),
            sigmas=tuple(name for name in known if name + SIGMA in there),
            confident=CONFIDENCE in there,
            changed=tuple(name for name in known if ORIGINAL + name in there),
            rare=rare, looks=looks, tiles=tiles,
            quantiles=quantiles if quantiles is not None and quantiles.count else None,
        )  # fmt: skip

    @property
    def provenance(self) -> Mapping[str, str]:
        """Where the maps are from."""
        return self.header.provenance

    @property
    def made_by(self) -> MadeBy:
        """The model, whether or not it is here."""
        return MadeBy(self.header.model, self.header.digest)

    @property
    def notes(self) -> list[str]:
        """What people should know of the header."""
        return [lost_note(self.path, self.untold, self.header.model)] if self.untold else []

    def named(self, model: Model | None, calibration: Calibration | None) -> None:
        """Takes a calibration, and a model where the header says none, in place of what it says."""
        if model is not None and "model" in self.untold:
            self.header = replace(self.header, model=model.name, digest=model.digest)
        if calibration is not None:
            self.header = replace(self.header, calibration=calibration)
        given = {"model": model, "calibration": calibration}
        self.untold = tuple(name for name in self.untold if given[name] is None)

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the maps, of about half a million texels each."""
        return self._file.bands()

    def rows(self, rows: slice, trust: bool = True) -> Estimate | EditedEstimate:
        """Maps of some rows, without their capture; σ and confidence only if `trust`."""
        header, channels = self.header, self._channels(rows, trust)
        mask = channels.get("mask", np.ones(channels["melanin"].shape, dtype=np.float32))
        if not (mask.min(initial=0) >= 0 and mask.max(initial=0) <= 1):  # NaN fails too
            raise self.no_mask()
        names = (*NAMES, *header.rare)
        known = [p for p in (*PARAMETERS, *RARE) if p.name in names]
        place = Place(rows.indices(self.shape[0])[0], self.shape)
        stored = {p.name: _checked(self.path, channels[p.name], p, mask) for p in known}
        inside = mask > 0
        spread = {
            name: np.where(inside, stored_sigma(channels[name + SIGMA], parameter(name)), 0)
            for name in (header.sigmas if trust else ())
        }
        sure = None
        if trust and header.confident:
            sure = np.where(inside, np.clip(np.nan_to_num(channels[CONFIDENCE]), 0, 1), 0)
        now = Maps(stored, mask, place)
        rest: dict[str, Any] = {
            "by": self.made_by, "calibrated": header.calibration, "sure": sure,
            "notes": header.provenance, "state": header.state, "tile": self.tile,
            "quantiles": header.quantiles,
        }  # fmt: skip
        if not (header.edits or header.changed):
            return Estimate(now, spread=spread, **rest)
        before = {
            p.name: _checked(self.path, channels[ORIGINAL + p.name], p, mask)
            for p in known
            if p.name in header.changed
        }
        return EditedEstimate(
            Estimate(now.with_values(before), **rest), (), Tile(now, spread, header.clamped, sure),
            header.edits, kept=header.looks,
        )  # fmt: skip

    def keep(self) -> None:
        """Says that rows will be asked for again: they are kept, if KEPT bytes are enough."""
        self._keeping = True

    def _channels(self, rows: slice, trust: bool) -> dict[str, Map]:
        header = self.header
        wanted = {*NAMES, *header.rare, "mask", *(ORIGINAL + name for name in header.changed)}
        if trust:
            wanted |= {CONFIDENCE, *(name + SIGMA for name in header.sigmas)}
        wanted &= set(self._file.names)
        height, width = self.shape
        if not self._keeping or 4 * len(wanted) * height * width > KEPT:
            return self._file.rows(rows, wanted)
        if not wanted <= set(self._kept):
            self._kept = {name: np.empty(self.shape, np.float32) for name in wanted}
            self._read = np.zeros(height, dtype=bool)
        missing = np.flatnonzero(~self._read[rows]) + rows.indices(height)[0]
        if len(missing):
            new = slice(int(missing[0]), int(missing[-1]) + 1)
            for name, values in self._file.rows(new, set(self._kept)).items():
                self._kept[name][new] = values
            self._read[new] = True
        return {name: self._kept[name][rows] for name in wanted}

    def edited(self, rows: slice, changes: Sequence[Change], trust: bool = True) -> SkinMaps:
        """Maps of some rows with changes that are ready for this face applied; see `rows`."""
        return edited(self, rows, changes, trust)

    @property
    def known(self) -> Quantiles | None:
        """Where the values of the maps lie, as the header says."""
        return self.header.quantiles

    @property
    def tile(self) -> TileOf:
        """Which tile of a set it is: as the header says, if the name still does too."""
        pattern = udim_pattern(self.path)
        files = {} if pattern is None else {n: tile_of(pattern, n) for n in self.header.tiles}
        own = next((n for n, path in files.items() if path == self.path), None)
        return TileOf() if own is None else TileOf(own, files, MapsFile)

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""
        return self.header.confident if name == CONFIDENCE else name in self.header.sigmas

    def no_mask(self) -> CutisError:
        """What to raise when the mask is empty or broken."""
        return CutisError(
            f"{self.path.name}: its mask is empty or not within 0 to 1; estimate again"
        )


def load_maps(path: str | os.PathLike[str]) -> Estimate | EditedEstimate:
    """Reads what `save_maps` wrote; CutisError when channels are missing or out of range."""
    with MapsFile(path) as file:
        skin = file.rows(slice(None))
        if not skin.mask.max() > 0:
            raise file.no_mask()
    return skin


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
        return skin.with_capture(file.read().linear(), source_note(file))


def _calibration(text: str) -> Calibration:
    stored = {"gains": [1, 1, 1], "origin": "none", **json.loads(text)}
    red, green, blue = (float(g) for g in stored["gains"])
    if not all(1 / LARGEST < gain < LARGEST for gain in (red, green, blue)):
        raise ValueError("gains must be positive numbers of a camera")
    light, conversion = str(stored.get("light", "D65")), stored.get("conversion")
    if conversion is not None:
        conversion = tuple(tuple(float(v) for v in row) for row in conversion)
        matrix = np.array(conversion)
        with contextlib.suppress(FloatingPointError), np.errstate(all="ignore"):
            back = np.linalg.inv(matrix) @ matrix
        # 1e308 has an inverse, but nothing that goes through it and back is what it was
        if matrix.shape != (3, 3) or not np.allclose(back, np.eye(3), atol=1e-3):
            raise ValueError("the conversion of light must be invertible")
        if np.abs(matrix).max() > LARGEST:
            raise ValueError("the conversion of light is none between lights")
    return Calibration((red, green, blue), str(stored["origin"]), light, conversion)


def _checked(path: Path, values: Map, known: Parameter, mask: Map) -> Map:
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
