"""A model as a value: how colours become skins, and skins colours.

A model sees tiles of an albedo and says how far around a texel it looks (`reach`, 0 for those that
look at one texel alone). It may ask for one survey of the whole texture or set first, whose
findings, a few numbers, are kept with the maps. Bands, batches and front ends know no more of a
model than that.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.rare import rare_ratio
from cutis.optics import NAMES, PARAMETERS, Tissue

Map: TypeAlias = NDArray[np.float32]
Conversion: TypeAlias = Callable[[Map], Map]
State: TypeAlias = Mapping[str, Any]
"""What a survey found, as JSON holds it."""
BAND = 1 << 18
"""Texels converted at a time."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a model finds in a tile: maps by name, their σ by name, confidence; all (h, W), float32.

    Maps and σ are in the units of `optics.PARAMETERS`; all are 0 off the mask.
    """

    maps: Mapping[str, Map]
    sigmas: Mapping[str, Map] = field(default_factory=dict)
    confidence: Map | None = None

    def rows(self, rows: slice) -> "Found":
        """Some rows of it."""
        return Found(
            {name: values[rows] for name, values in self.maps.items()},
            {name: values[rows] for name, values in self.sigmas.items()},
            None if self.confidence is None else self.confidence[rows],
        )


class Survey(Protocol):
    """One look, or a few, at all that will be estimated together, before it is.

    Everything is added in tiles, from top to bottom, texture by texture, once more each time
    that `enough` says no. What is found must not depend on how tiles are cut.
    """

    def enough(self) -> bool:
        """Whether no further look is wanted; asked before the first one too."""

    def add(self, first_row: int, colours: Map, cover: Map) -> None:
        """Colours (h, W, 3), linear sRGB, and where skin is (h, W), from row `first_row` on."""


class ModelSurvey(Survey, Protocol):
    """A survey that a model asks for; its colours are calibrated."""

    def finish(self) -> State:
        """What was found."""


TileEstimate: TypeAlias = Callable[[Map, Map, State, bool], Found]
"""(h, W, 3) calibrated colours, (h, W) cover, the survey's findings, whether σ is wanted → maps.

Where no σ is found, it is that of each texel's colour (`Model.trust`)."""


@dataclass(frozen=True, eq=False)
class Model:
    """An inverse and its forward model; models of one name and digest are equal.

    `to_skins` maps (n, 3) calibrated linear sRGB to (n, 5) parameters in their units and within
    their ranges, `to_rgb` maps those to (n, 3) linear sRGB. `tissue` is the one whose albedo space
    gives the spectra of its skins. `to_trust`, where there is one, maps the same colours to (n, 6):
    the standard deviation of each parameter in its unit and the confidence, in [0, 1], that the
    colour is one of skin. `prior_sigma` is what the standard deviations were before a colour was
    seen, in network coordinates. `digest` stands for all that results depend on: tables, weights,
    constants (`content_digest`).

    A model that looks at neighbours has `of_tile`, which looks `reach` texels far in tiles that
    begin at a multiple of `grid` rows, and may have `survey`, which makes a survey of what will be
    estimated. `recipe` is what another process finds
    the model by: a name of the registry or the whole path of a file, and the device.
    """

    name: str
    to_skins: Conversion
    to_rgb: Conversion
    tissue: Tissue
    to_trust: Conversion | None = None
    prior_sigma: tuple[float, ...] | None = None
    digest: str = ""
    reach: int = 0
    grid: int = 1
    of_tile: TileEstimate | None = None
    survey: Callable[[], ModelSurvey] | None = None
    recipe: tuple[str, str] | None = None

    def __eq__(self, other: object) -> bool:
        """Of one name and digest; a name alone is compared with the name."""
        if isinstance(other, str):
            return self.name == other
        if not isinstance(other, Model):
            return NotImplemented
        return (self.name, self.digest) == (other.name, other.digest)

    def __hash__(self) -> int:
        return hash(self.name)

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"<cutis model {self.name}, tissue {self.tissue.name}, {self.digest[:12]}>"

    @property
    def alone(self) -> "Model":
        """The same without neighbours: every texel by itself."""
        if self.of_tile is None:
            return self
        return replace(self, reach=0, grid=1, of_tile=None, survey=None)

    def encode(self, rgb: ArrayLike) -> Map:
        """(..., 3) calibrated linear sRGB → (..., 5) parameters in their units.

        Each colour by itself, without neighbours: this is the way for an (n, 3) list of colours.
        """
        return _in_bands(self.to_skins, rgb, 5)

    def decode(self, parameters: ArrayLike) -> Map:
        """(..., 5) parameters in their units → (..., 3) linear sRGB under D65.

        Of (..., 8), the last three are rare chromophores (`optics.RARE`): their colour is the
        model's, times what they change in the exact albedo space of its tissue.
        """
        skins = np.asarray(parameters, dtype=np.float32)
        colours = _in_bands(self.to_rgb, skins[..., : len(PARAMETERS)], 3)
        if skins.shape[-1] > len(PARAMETERS):
            colours *= _in_bands(lambda some: rare_ratio(self.tissue, some), skins, 3)
        return colours

    def trust(self, rgb: ArrayLike) -> Map | None:
        """(..., 3) calibrated linear sRGB → (..., 6): σ of the five parameters, and confidence.

        σ is in the parameter's unit: what a fit to the whole spectrum of a skin finds lies within
        ± 1.645 σ for nine of ten skins. None where the model does not know.
        """
        return None if self.to_trust is None else _in_bands(self.to_trust, rgb, 6)

    def estimate(
        self, colours: Map, cover: Map, state: State | None = None, *, sigma: bool = True
    ) -> Found:
        """Maps of a tile: (h, W, 3) calibrated linear sRGB where `cover` (h, W) is not 0.

        `state` is what the survey found, and under "rounding" the step that encoded colours of the
        capture are rounded to, 1/255 for instance; without it they are not.

        Rows within `reach` of an edge of the tile that is no edge of the texture are not yet what
        they are inside: whoever cuts tiles gives so many more rows and leaves them out afterwards.
        """
        inside = cover > 0
        chosen = texels(colours, inside)
        if self.of_tile is None:
            found = Found(dict(zip(NAMES, spread(self.encode(chosen), inside), strict=True)))
        else:
            found = self.of_tile(colours, cover, state or {}, sigma)
        trust = self.trust(chosen) if sigma and not found.sigmas else None
        if trust is None:
            return found
        *sigmas, confidence = spread(trust, inside)
        return replace(found, sigmas=dict(zip(NAMES, sigmas, strict=True)), confidence=confidence)


def content_digest(*parts: object) -> str:
    """SHA-256 of bytes, and of anything that JSON holds, in order."""
    total = hashlib.sha256()
    for part in parts:
        data = part if isinstance(part, bytes) else json.dumps(part, sort_keys=True).encode()
        total.update(len(data).to_bytes(8, "little"))
        total.update(data)
    return total.hexdigest()


def texels(values: Map, inside: NDArray[np.bool_]) -> Map:
    """(h, W, c) → (n, c) of the texels inside; no copy where that is all."""
    return values.reshape(-1, values.shape[-1]) if inside.all() else values[inside]


def spread(values: Map, inside: NDArray[np.bool_]) -> Map:
    """(n, c) values of the texels inside → (c, h, W), 0 elsewhere."""
    whole = np.zeros((values.shape[1], *inside.shape), dtype=np.float32)
    whole[:, inside] = values.T
    return whole


def _in_bands(function: Conversion, values: ArrayLike, size: int) -> Map:
    array = np.asarray(values, dtype=np.float32)
    flat = array.reshape(-1, array.shape[-1])
    out = np.empty((len(flat), size), dtype=np.float32)
    for start in range(0, len(flat), BAND):
        out[start : start + BAND] = function(flat[start : start + BAND])
    return out.reshape(*array.shape[:-1], size)
