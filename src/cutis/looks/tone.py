"""Another tone for a face: all five maps moved the way people differ, its own features kept.

The colours that maps stand for go along the path of measured skin (`tone_path`), by how much the
face's areas differ from its median; what is small, light that is baked in and hair ride along. The
model of the maps finds the skins of the new colours, so that all five maps are those of a skin of
that tone. The face's median is hit after the model has had its say.
"""

import re
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cutis.colour import delta_e, ita
from cutis.colour.swatches import MONK, swatch
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.looks import tone_fit
from cutis.looks.blur import Blur, tile_of
from cutis.looks.document import Part
from cutis.looks.effect import EditPart
from cutis.looks.tone_fit import Goal, Sample, Way
from cutis.looks.tone_path import TonePath, tone_path
from cutis.maps import Face, Tile
from cutis.maps.plain import Map, Place
from cutis.optics import NAMES
from cutis.textures.problem import shorten

LENGTH = 400.0
"""Millimetres that the longer side of a face's texture spans, unless somebody says another."""
BLUR = 4 / 2.355
"""Standard deviation in millimetres of areas that get the contrast of another tone."""
AREAS = 8 / 2.355
"""The same of the areas whose contrast is measured."""
CELLS = 400
"""Along the longer side of a texture, for its areas."""
SAMPLE = 160_000
"""Texels of a tile that are looked at, at most."""
MEASURED = (-62.0, 56.0)
"""ITA° between which all but one of 200 measured faces lie."""
FARTHEST = 3.0
"""ΔE00 of a colour to the nearest that a model can explain, beyond which it is no skin."""
Channel = Annotated[float, Field(gt=0, le=2)]
Log = Annotated[float, Field(ge=-4, le=4)]


class Like(Part):
    """What is kept of another face.

    The median of its skin, linear sRGB as calibrated, and the covariances rr, gg, bb, rg, rb, gb
    of its log RGB.
    """

    median: tuple[Channel, Channel, Channel]
    spread: tuple[Log, Log, Log, Log, Log, Log]


class Tone(EditPart):
    """Another tone: one of `ita`, `monk`, `colour` and `like`."""

    do: Literal["tone"] = "tone"
    ita: Annotated[float, Field(ge=-65, le=60)] | None = Field(
        default=None, description="Median ITA° of the face's skin, as calibrated."
    )
    monk: Annotated[int, Field(ge=1, le=10)] | None = Field(
        default=None, description="The measured tone that is nearest to a swatch of Monk's scale."
    )
    colour: Annotated[str, Field(pattern="^#[0-9a-fA-F]{6}$")] | None = Field(
        default=None,
        description="Median of the face's skin in the file that is written, as #rrggbb.",
    )
    like: Like | None = Field(default=None, description="Median and contrast of another face.")
    length: Annotated[float, Field(gt=1, le=1e5)] = Field(
        default=LENGTH, description="Millimetres that the texture's longer side spans."
    )

    @model_validator(mode="after")
    def _one(self) -> "Tone":
        given = [one for one in (self.ita, self.monk, self.colour, self.like) if one is not None]
        if len(given) != 1:
            raise ValueError("a tone is one of ita, monk, colour and like")
        return self

    @property
    def touches(self) -> frozenset[str]:
        """All five maps."""
        return frozenset(NAMES)

    @property
    def reads(self) -> frozenset[str]:
        """All five."""
        return frozenset(NAMES)

    @property
    def placed(self) -> bool:
        """It looks at the areas around."""
        return True

    @property
    def absolute(self) -> bool:
        """Colours mean the same in every tissue."""
        return False

    def __str__(self) -> str:
        if self.ita is not None:
            return f"tone ita:{self.ita:g}"
        if self.monk is not None:
            return f"tone monk:{self.monk}"
        return f"tone {self.colour}" if self.colour is not None else "tone like another face"

    def on_face(self, face: Face) -> "ToneOnFace":
        """The tone ready for a face; CutisError where no skin has it."""
        return ToneOnFace(self, face)

    def goal(self, path: TonePath, calibration: Calibration) -> Goal:
        """The target as numbers."""
        if self.ita is not None:
            return Goal(self.ita)
        if self.monk is not None:
            return Goal(nearest_tone(path, swatch(MONK[self.monk - 1])))
        if self.like is not None:
            rr, gg, bb, rg, rb, gb = self.like.spread
            covariance = np.array([[rr, rg, rb], [rg, gg, gb], [rb, gb, bb]])
            rgb = np.array(self.like.median)
            return Goal(float(ita(rgb)), np.log(np.maximum(rgb, 2e-3)), covariance)
        assert self.colour is not None
        rgb = calibration.apply(swatch(self.colour[1:]))
        return Goal(float(ita(rgb)), np.log(np.maximum(rgb, 2e-3)).astype(float))


class ToneOnFace:
    """A tone that is ready for a face."""

    trust = True

    def __init__(self, tone: Tone, face: Face) -> None:
        path = tone_path()
        self._model = face.made_by.load()
        sigma = max(tone.length, 1.0)
        texels = max(face.shape) / sigma * BLUR

        samples = _samples(face, tone)
        sample = _together([part for part, _ in samples])
        goal = tone.goal(path, samples[0][1])
        if goal.colour is not None:
            _check_skin(tone, goal, self._model)
        self._spread = tone_fit.spread_of(sample, path)
        self._blur = Blur(max(texels, 0.3), self._field, face, trust=True)

        def way() -> Way:
            def degrees(one: Face) -> Map:
                own = (
                    self._blur
                    if one is face
                    else Blur(max(max(one.shape) / sigma * BLUR, 0.3), self._field, one, trust=True)
                )
                return _Gathered(one, tone).degrees(self._field, own)

            parts = face.over_set(tone, "degrees", degrees)
            whole = Sample(sample.colours, sample.confidence, sample.areas, np.concatenate(parts))
            seen = tone_fit.Seen(self._model)
            return tone_fit.solve(whole, self._spread, goal, path, seen)

        self._way = face.once(tone, "way", way)
        self.reach = self._blur.reach

    def _field(self, tile: Tile) -> tuple[Map, Map]:
        """Degrees along the path (h, W), and how much they count."""
        from cutis.looks.tone_kernel import along

        colours, sure = _colours(self._model, tile), _sure(tile)
        out, weights = np.empty(sure.shape, np.float32), np.empty(sure.shape, np.float32)
        s = self._spread
        along(len(out), colours, sure, tile.maps.mask > 0, s.median, s.line, s.limit, out, weights)
        return out, weights

    def __call__(self, tile: Tile, weight: Map) -> Tile:
        """The tile with `weight` (h, W) of the tone."""
        colours, sure = _colours(self._model, tile), _sure(tile)
        degrees = self._blur(*self._field(tile), tile.maps.whole)
        moved = self._way(colours, sure, np.ascontiguousarray(weight, np.float32), degrees)
        changed = (moved != colours).any(axis=-1)
        skins = self._model.encode(moved[changed])
        values = {}
        for number, name in enumerate(NAMES):
            values[name] = tile.maps[name].copy()
            values[name][changed] = skins[:, number]
        sigmas = dict(tile.sigmas)
        found = self._model.trust(moved[changed]) if sigmas else None
        if found is not None:
            for number, name in enumerate(NAMES):
                if name in sigmas:
                    sigmas[name] = sigmas[name].copy()
                    sigmas[name][changed] = found[:, number]
        return Tile(tile.maps.with_values(values), sigmas, (*tile.clamped, 0), tile.confidence)


class _Gathered:
    """Every n-th texel of the rows and columns of a tile, and its areas."""

    def __init__(self, face: Face, tone: Tone) -> None:
        self._face, self._length = face, tone.length
        self._every = max(1, int(np.ceil(np.sqrt(face.shape[0] * face.shape[1] / SAMPLE))))

    def _picked(self, rows: slice, inside: Any) -> Any:
        chosen = np.zeros(inside.shape, bool)
        start = self._every // 2
        chosen[(start - rows.start) % self._every :: self._every, start :: self._every] = True
        return chosen & inside

    def sample(self) -> tuple[Sample, Calibration]:
        """Its texels and areas, and the calibration of its capture."""
        step = max(1, max(self._face.shape) // CELLS)
        shape = tuple(-(-side // step) for side in self._face.shape)
        sums, counts = np.zeros((*shape, 3)), np.zeros(shape)
        model, colours, sure = self._face.made_by.load(), [], []
        calibration = Calibration()
        for rows, skin in self._face.bands(True):
            tile, calibration = tile_of(skin), skin.calibration
            rgb, confidence, inside = _colours(model, tile), _sure(tile), tile.maps.mask > 0
            picked = self._picked(rows, inside)
            colours.append(rgb[picked])
            sure.append(confidence[picked])
            at = np.nonzero(inside & (confidence >= tone_fit.SURE))
            cells = (at[0] + rows.start) // step, at[1] // step
            np.add.at(sums, cells, np.log(np.maximum(rgb[at], 2e-3)))
            np.add.at(counts, cells, 1)
        areas = np.zeros((0, 3))
        if counts.any():
            cell = self._length / max(self._face.shape) * step
            areas = tone_fit.areas_of(sums, counts, AREAS / cell)
        return Sample(np.concatenate(colours), np.concatenate(sure), areas), calibration

    def degrees(self, field: Any, blur: Blur) -> Map:
        """Of the same texels, their degrees along the path."""
        found = []
        if blur.reach:  # a small texture: in one piece, so that bands make no difference
            parts = [tile_of(skin) for _, skin in self._face.bands(True)]
            both = [field(tile) for tile in parts]
            values, weights = (np.concatenate(part) for part in zip(*both, strict=True))
            inside = np.concatenate([tile.maps.mask > 0 for tile in parts])
            whole = blur(values, weights, Place(0, self._face.shape))
            return np.asarray(whole[self._picked(slice(0, len(inside)), inside)])
        for rows, skin in self._face.bands(True):
            tile = tile_of(skin)
            picked = self._picked(rows, tile.maps.mask > 0)
            values, weights = field(tile)
            found.append(blur(values, weights, tile.maps.whole)[picked])
        return np.concatenate(found)


def sampled(face: Face, tone: Tone) -> Sample:
    """Texels and areas of a face, of all its tiles."""
    return _together([part for part, _ in _samples(face, tone)])


def _samples(face: Face, tone: Tone) -> tuple[tuple[Sample, Calibration], ...]:
    return face.over_set(tone, "sample", lambda one: _Gathered(one, tone).sample())


def tone_of(text: str) -> Tone:
    """`ita:-20`, `monk:7` or `#8d5524` as a tone; CutisError for anything else."""
    try:
        if re.fullmatch("#[0-9a-fA-F]{6}", text):
            return Tone(colour=text.lower())
        kind, _, value = text.partition(":")
        if kind == "ita":
            return Tone(ita=float(value))
        if kind == "monk":
            return Tone(monk=int(value))
    except ValueError:
        pass
    raise CutisError(
        f"{shorten(text)}: is no tone; use ita:-65 to ita:60, monk:1 to monk:10, a colour as "
        "#8d5524, or like:OTHER.skin.exr"
    )


def nearest_tone(path: TonePath, rgb: Any) -> float:
    """ITA° of the measured tone nearest to a colour by ΔE00."""
    tones = np.arange(MEASURED[0], MEASURED[1] + 0.1, 0.25)
    colours = np.exp(np.array([path.colour(tone) for tone in tones]))
    return float(tones[np.argmin(delta_e(colours, np.broadcast_to(rgb, colours.shape)))])


def _colours(model: Any, tile: Tile) -> Map:
    inside = tile.maps.mask > 0
    out = np.zeros((*tile.maps.shape, 3), np.float32)
    out[inside] = model.decode(tile.maps.parameters()[inside])
    return out


def _sure(tile: Tile) -> Map:
    if tile.confidence is None:
        return (tile.maps.mask > 0).astype(np.float32)
    return np.ascontiguousarray(tile.confidence, np.float32)


def _together(parts: list[Sample]) -> Sample:
    return Sample(*(np.concatenate([getattr(part, name) for part in parts])
                    for name in ("colours", "confidence", "areas")))  # fmt: skip


def _check_skin(tone: Tone, goal: Goal, model: Any) -> None:
    assert goal.colour is not None
    rgb = np.exp(goal.colour).astype(np.float32)[None]
    apart = float(delta_e(model.decode(model.encode(rgb)), rgb)[0])
    if apart > FARTHEST or not -70 <= goal.tone <= 75:
        raise CutisError(
            f"{tone}: no skin has this colour (the nearest is {apart:.1f} ΔE00 away); "
            "pick a lighter, darker or less saturated one"
        )
