"""Skin maps: what `estimate` returns, what people edit, what becomes albedo again."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.models import load_model, model_name, tissue_of
from cutis.maps.edits import Edit
from cutis.maps.patches import patches
from cutis.maps.statistics import MapStatistics, coordinates
from cutis.optics import NAMES, RARE_NAMES, Tissue, parameter, with_rare_chromophores
from cutis.textures.texture import Texture, bands

if TYPE_CHECKING:
    from cutis.albedo import AlbedoSpace
    from cutis.maps.relighting import Relighting

Map = NDArray[np.float32]

DARKEST = np.float32(1e-4)
"""Model albedo that ratios are taken over at least, so that they stay finite."""


@dataclass(frozen=True, eq=False)
class SkinMaps:
    """Five maps of what a skin is made of, float32 (H, W), in the units of `optics.PARAMETERS`.

    `bilirubin`, `carotene` and `methaemoglobin` are maps of the rare chromophores (`optics.RARE`),
    None where no edit or fit has set them: what the tissue itself holds, 0 in those maps.
    `mask` (H, W) in [0, 1] says where they hold; maps are 0 where it is 0. `calibration` was
    applied to the capture before the estimate, by the model called `model` (the name that `default`
    stands for, if that is given). `source` is the capture, linear sRGB (H, W, 3), or None when only
    the maps were loaded. `original` is the estimate that this was edited from, None for an estimate
    itself; `edits` what was done since, and `clamped` how many texels each edit pushed against the
    end of a range. `provenance` is free text for the file header. Of some rows of a larger image,
    `first_row` is the number of the first and `whole` the (H, W) of all. `sigmas` has the standard
    deviation (H, W) of maps, by name and in their units, where the model knows it, and
    `confidence` (H, W) in [0, 1] how likely each colour is one of skin; see `sigma`.

    All arrays are read-only: a map changed in place would not count as an edit.
    """

    melanin: Map
    blood: Map
    thickness: Map
    eumelanin: Map
    oxygenation: Map
    mask: Map
    calibration: Calibration = field(default_factory=Calibration)
    model: str = "default"
    source: Map | None = None
    original: "SkinMaps | None" = None
    edits: tuple[str, ...] = ()
    clamped: tuple[int, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)
    first_row: int = 0
    whole: tuple[int, int] | None = None
    bilirubin: Map | None = None
    carotene: Map | None = None
    methaemoglobin: Map | None = None
    sigmas: Mapping[str, Map] = field(default_factory=dict)
    confidence: Map | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", model_name(self.model))
        for name in (*NAMES, *RARE_NAMES, "mask", "source", "confidence"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, self._view(name, getattr(self, name)))
        sigmas = {name: self._view(f"σ of {name}", found) for name, found in self.sigmas.items()}
        object.__setattr__(self, "sigmas", sigmas)

    def _view(self, name: str, values: Map) -> Map:
        """A view that cannot be written to; CutisError where it is of another size than the maps"""
        view = np.asarray(values, dtype=np.float32).view()
        view.flags.writeable = False
        shape = np.shape(self.melanin)
        if view.shape != ((*shape, 3) if name == "source" else shape) or len(shape) != 2:
            raise CutisError(f"{name} is {view.shape}, the maps are {shape}")
        return view

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.melanin.shape[0], self.melanin.shape[1]

    @property
    def tissue(self) -> Tissue:
        """The tissue that these skins are of: that of the model."""
        return tissue_of(self.model)

    @property
    def rare(self) -> tuple[str, ...]:
        """Names of the rare chromophores that have a map."""
        return tuple(name for name in RARE_NAMES if getattr(self, name) is not None)

    def parameters(self, rows: slice | None = None, names: Sequence[str] = NAMES) -> Map:
        """(H, W, 5) parameters, or those of some rows, or others by name; 0 where there is no map.

        Rare chromophores are among them where `names` says so, as NAMES + RARE_NAMES does.
        """
        rows = slice(None) if rows is None else rows
        return np.stack([self.map(name)[rows] for name in names], axis=-1)

    def map(self, name: str) -> Map:
        """(H, W) the map called `name`, of 0 for a rare chromophore that has none."""
        values: Map | None = getattr(self, name)
        return np.zeros(self.shape, dtype=np.float32) if values is None else values

    def _names(self) -> tuple[str, ...]:
        """What the colours of these maps depend on."""
        return (*NAMES, *RARE_NAMES) if self.rare else NAMES

    def rows(self, rows: slice) -> "SkinMaps":
        """The maps of some rows, capture and original included."""
        first = rows.indices(self.shape[0])[0]
        names = (*NAMES, *self.rare, "mask")
        parts: dict[str, Any] = {name: getattr(self, name)[rows] for name in names}
        result = replace(
            self,
            **parts,
            source=None if self.source is None else self.source[rows],
            original=None if self.original is None else self.original.rows(rows),
            first_row=self.first_row + first,
            whole=self.whole or self.shape,
            sigmas={name: sigma[rows] for name, sigma in self.sigmas.items()},
            confidence=None if self.confidence is None else self.confidence[rows],
        )
        if "model_albedo" in self.__dict__:  # decoded already
            result.__dict__["model_albedo"] = self.model_albedo[rows]
        return result

    def coordinates(self) -> Map:
        """(H, W, 5) network coordinates where the mask is not 0, else 0."""
        return coordinates([getattr(self, name) for name in NAMES], self.mask > 0)

    def sigma(self, name: str) -> Map:
        """(H, W) standard deviation of a map in its unit, 0 off the mask: `skin.sigma("melanin")`.

        What a fit to the whole spectrum finds lies within ± 1.645 σ for nine of ten skins
        (docs/validation.md). Edits carry it on: a factor scales it, an offset leaves it, a set
        value has 0. Raises CutisError for maps without: only some models know it.
        """
        if name not in self.sigmas:
            parameter(name)
            raise CutisError(
                f"these maps have no σ of {name}: {self.model} does not know it, or they were made "
                "without; estimate again"
            )
        return self.sigmas[name]

    # editing --------------------------------------------------------------------------------

    def multiply(self, *, where: ArrayLike | None = None, **factors: float) -> "SkinMaps":
        """Multiplies maps by factors: `skin.multiply(melanin=1.4)`."""
        return self.apply([Edit(k, "multiply", v) for k, v in factors.items()], where)

    def offset(self, *, where: ArrayLike | None = None, **amounts: float) -> "SkinMaps":
        """Adds amounts in the parameter's unit: `skin.offset(thickness=-20)`."""
        return self.apply([Edit(k, "offset", v) for k, v in amounts.items()], where)

    def replace(self, *, where: ArrayLike | None = None, **values: float) -> "SkinMaps":
        """Sets maps to values: `skin.replace(eumelanin=0.001)`."""
        return self.apply([Edit(k, "set", v) for k, v in values.items()], where)

    def blend(
        self, amount: float, *, where: ArrayLike | None = None, **values: float
    ) -> "SkinMaps":
        """Moves maps part of the way, `amount` in [0, 1], towards values."""
        return self.apply([Edit(k, "set", v) for k, v in values.items()], where, amount=amount)

    def apply(
        self,
        edits: Edit | tuple[Edit, ...] | list[Edit],
        where: ArrayLike | None = None,
        *,
        amount: float = 1.0,
    ) -> "SkinMaps":
        """Applies edits or a preset in order, inside the painted mask `where` (H, W), 0–1.

        `amount` in [0, 1] blends between the old values and the new. A painted mask takes the
        place of procedural patches. Values are clamped to range and counted in `clamped`. Texels
        whose mask is 0 are never touched.
        """
        if not 0 <= amount <= 1:
            raise CutisError(f"the amount of an edit must lie in 0 to 1, not {amount:g}")
        edits = [edits] if isinstance(edits, Edit) else list(edits)
        everywhere = np.float32(amount) * self._weight(where)
        how = (f", amount {amount:g}" if amount < 1 else "") + (
            ", painted" if where is not None else ""
        )
        result = self
        for edit in edits:
            procedural = where is None and edit.where == "patches"
            weight = everywhere * self._patches() if procedural else everywhere
            edited, clamped = edit(result.map(edit.parameter), weight)
            changes: dict[str, Any] = {edit.parameter: edited}
            if edit.parameter in result.sigmas:
                sigma = edit.sigma(result.sigmas[edit.parameter], weight)
                changes["sigmas"] = {**result.sigmas, edit.parameter: sigma}
            result = replace(
                result,
                **changes,
                original=self.original or self,
                edits=(*result.edits, str(edit) + how),
                clamped=(*result.clamped, clamped),
            )
        return result

    def _patches(self) -> Map:
        """(H, W) weights of procedural patches; those of the whole image, in some rows of it."""
        rows = slice(self.first_row, self.first_row + self.shape[0])
        return patches(self.whole or self.shape, rows)

    def _weight(self, where: ArrayLike | None) -> Map:
        """(H, W) 0–1: `where`, and nothing outside the skin."""
        inside = (self.mask > 0).astype(np.float32)
        if where is None:
            return inside
        weight = np.asarray(where, dtype=np.float32)
        if weight.shape != self.shape:
            raise CutisError(f"the edit mask is {weight.shape}, the maps are {self.shape}")
        if not (np.isfinite(weight).all() and weight.min() >= 0 and weight.max() <= 1):
            raise CutisError("the edit mask must hold values from 0 to 1")
        return weight * inside

    def save(self, path: str | os.PathLike[str], dtype: Literal["float", "half"] = "float") -> None:
        """Writes maps and mask as channels of one EXR; `dtype` float (exact) or half."""
        from cutis.maps.files import save_maps

        save_maps(self, path, dtype)

    # colour -----------------------------------------------------------------------------------

    @cached_property
    def model_albedo(self) -> Map:
        """(H, W, 3) linear sRGB that the model alone gives, calibration undone; 0 off the mask."""
        model = load_model(self.model)
        result = np.zeros((*self.shape, 3), dtype=np.float32)
        for rows in bands(self.shape):
            inside = self.mask[rows] > 0
            result[rows][inside] = self.calibration.undo(
                model.decode(self.parameters(rows, self._names())[inside])
            )
        result.flags.writeable = False  # it is kept
        return result

    def albedo(self, illuminant: str | None = None) -> Map:
        """(H, W, 3) linear sRGB as captured, edits included; relit where `illuminant` is given.

        What the model does not explain (hair, eyes, detail) rides along as the ratio of capture
        to model; texels that no edit changed are those of the capture, bit for bit. Without the
        capture, the model's albedo.

        `illuminant`, a name or file that `colour.illuminant` takes, shows the skin under that light
        and balanced on it (`maps.relighting`); the light of the capture changes nothing.
        """
        relight = self._relighting(illuminant)
        if self.source is None:
            return self.model_albedo.copy() if relight is None else relight.alone(self)
        if relight is not None:
            parts = (relight(self.rows(rows), self.source[rows]) for rows in bands(self.shape))
            return np.concatenate(list(parts))
        result = self.source.copy()
        for rows in bands(self.shape):
            changed, colours = self._changes(rows, self.source[rows])
            result[rows][changed] = colours
        return result

    def relit(self, illuminant: str) -> Map:
        """(H, W, 3) linear sRGB under another light, edits included: `albedo(illuminant)`."""
        return self.albedo(illuminant)

    def retouch(self, texture: Texture, illuminant: str | None = None) -> Texture:
        """The texture with the edits in it: same format, depth and space, other texels verbatim.

        With an `illuminant` all texels are as `albedo(illuminant)` shows them.
        """
        if texture.shape != self.shape:
            raise CutisError(f"the texture is {texture.shape}, the maps are {self.shape}")
        relight = self._relighting(illuminant)
        everywhere = np.full(self.shape, relight is not None)
        colours = np.zeros((*self.shape, 3), dtype=np.float32)
        for rows in bands(self.shape):
            if relight is not None:
                colours[rows] = relight(self.rows(rows), texture.rows(rows).linear())
                continue
            changed, edited = self._changes(rows, texture.rows(rows).linear())
            everywhere[rows] = changed
            colours[rows][changed] = edited
        return texture.with_linear(colours, everywhere)

    def _relighting(self, light: str | None) -> "Relighting | None":
        """How to relight; None where the light is that of the capture."""
        from cutis.maps.relighting import Relighting

        found = None if light is None else Relighting(self.calibration, self.tissue, light)
        return found if found is not None and found.changes else None

    def _changes(self, rows: slice, source: Map) -> tuple[NDArray[np.bool_], Map]:
        """Texels of some rows that edits changed, and their new colours (n, 3)."""
        base = self.original or self
        names = self._names() if self.rare else base._names()
        before, after = base.parameters(rows, names), self.parameters(rows, names)
        changed = (before != after).any(axis=-1) & (self.mask[rows] > 0)
        new, old = (self._captured(skins[changed]) for skins in (after, before))
        ratio = new / np.maximum(old, DARKEST)
        cover = self.mask[rows][changed][:, None]
        return changed, source[changed] * (1 + cover * (ratio - 1))

    def _captured(self, skins: Map) -> Map:
        """(n, 5 or 8) skins → (n, 3) colours under the light of the capture, gains left."""
        colours = load_model(self.model).decode(skins)
        if self.calibration.conversion is None:
            return colours
        return replace(self.calibration, gains=(1.0, 1.0, 1.0)).undo(colours)

    def residual(self) -> Map:
        """(H, W, 3) capture over model of the estimate: what the model does not explain, 1 = all.

        1 off the mask. Raises CutisError without the capture.
        """
        if self.source is None:
            raise CutisError("these maps came without their capture; read it and estimate again")
        base = self.original or self
        result = np.ones_like(self.source)
        inside = self.mask > 0
        result[inside] = self.source[inside] / np.maximum(base.model_albedo[inside], DARKEST)
        return result

    def reflectance(self, rows: slice | None = None) -> Map:
        """(H, W, 41) reflectance at `optics.WAVELENGTHS`, 0 off the mask.

        It is that of the exact albedo space of `tissue`.

        Of the maps alone: neither calibration nor what the model does not explain is in it.

        A whole 2048² face takes 0.7 GB; give `rows` to go in bands.
        """
        part = self if rows is None else self.rows(rows)
        space, skins = part._exact()
        spectra = space.reflectance(skins)
        result = np.zeros((*part.shape, spectra.shape[-1]), dtype=np.float32)
        result[part.mask > 0] = spectra
        return result

    def colours_under(self, light: str) -> Map:
        """(n, 3) linear sRGB of the texels of the mask, as `reflectance` has it under `light`.

        Of the maps alone, and balanced on the light.
        """
        space, skins = self._exact()
        return space.rgb(skins, light)

    def _exact(self) -> "tuple[AlbedoSpace, Map]":
        """The exact albedo space, and the skins (n, 5 or 8) of the texels of the mask."""
        from cutis.albedo import albedo_space

        skins = self.parameters(names=self._names())[self.mask > 0]
        tissue = with_rare_chromophores(self.tissue) if self.rare else self.tissue
        return albedo_space(tissue), skins

    def statistics(self) -> Iterator[tuple[str, str, float, float, float]]:
        """(name, unit, 5th percentile, median, 95th percentile) of each map inside the mask."""
        found = MapStatistics()
        for rows in bands(self.shape):
            found.add(self.rows(rows).coordinates(), self.mask[rows] > 0)
        for name, (low, median, high) in found.percentiles().items():
            yield name, parameter(name).unit, low, median, high
