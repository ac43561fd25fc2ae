"""Skin maps: what `estimate` returns, what people edit, what becomes albedo again.

There are two kinds. An `Estimate` is what a model found in a capture; an `EditedEstimate` is an
estimate with changes, which are worked out when somebody looks at them. Both do what `SkinMaps`
says.
"""

import abc
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cutis.colour import LightLike
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model, State
from cutis.maps import colours
from cutis.maps.changes import Change, Edits, Recipe, Step, Tile, recipe
from cutis.maps.defaults import DEFAULT, load_model
from cutis.maps.edits import Edit
from cutis.maps.face import Face, Held, TileOf
from cutis.maps.plain import Map, Maps, read_only
from cutis.maps.statistics import MapStatistics, Quantiles
from cutis.maps.writing import save_maps
from cutis.optics import NAMES, Tissue, parameter
from cutis.textures.texture import Texture, bands


class MapOf:
    """An attribute that is one of the maps: `skin.melanin`; None for a rare one that is not set."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        self.__doc__ = parameter(name).meaning

    def __get__(self, skin: "SkinMaps | None", owner: type | None = None) -> Any:
        return self if skin is None else skin.maps.values.get(self._name)


@dataclass(frozen=True)
class MadeBy:
    """The model of maps: its name, its digest where that is known, and the model once loaded."""

    name: str
    digest: str = ""
    loaded: Model | None = field(default=None, compare=False, repr=False)

    @classmethod
    def of(cls, model: Model) -> "MadeBy":
        """A model that is here."""
        return cls(model.name, model.digest, model)

    def load(self) -> Model:
        """The model; CutisError where there is none of that name."""
        return load_model(self.name) if self.loaded is None else self.loaded


class SkinMaps(abc.ABC):
    """Five maps of what a skin is made of, float32 (H, W), in the units of `optics.PARAMETERS`.

    `melanin`, `blood`, `thickness`, `eumelanin`, `oxygenation`; `bilirubin`, `carotene` and
    `methaemoglobin` are maps of the rare chromophores (`optics.RARE`), None where no edit or fit
    has set them: what the tissue itself holds. `mask` (H, W) in [0, 1] says where they hold; maps
    are 0 where it is 0.

    `calibration` was applied to the capture before the estimate, by `model`. `source` is the
    capture, linear sRGB (H, W, 3), or None when only the maps were loaded. `original` is the
    estimate that this was edited from, None for an estimate itself; `edits` what was done since,
    and `clamped` how many texels each edit pushed against the end of a range. `provenance` is free
    text for the file header. `sigmas` has the standard deviation (H, W) of maps, by name and in
    their units, where the model knows it, and `confidence` (H, W) in [0, 1] how likely each colour
    is one of skin; see `sigma`.

    All arrays are read-only: a map changed in place would not count as an edit.
    """

    melanin = MapOf()
    blood = MapOf()
    thickness = MapOf()
    eumelanin = MapOf()
    oxygenation = MapOf()
    bilirubin = MapOf()
    carotene = MapOf()
    methaemoglobin = MapOf()

    # what there is -----------------------------------------------------------------------------

    @property
    @abc.abstractmethod
    def maps(self) -> Maps:
        """The maps by name, with mask and place."""

    @property
    @abc.abstractmethod
    def sigmas(self) -> Mapping[str, Map]:
        """Standard deviations (H, W) by name, as far as they are known."""

    @property
    @abc.abstractmethod
    def estimate(self) -> "Estimate":
        """The estimate without edits."""

    @property
    @abc.abstractmethod
    def edits(self) -> tuple[str, ...]:
        """What was done to the estimate, a line each."""

    @property
    @abc.abstractmethod
    def clamped(self) -> tuple[int, ...]:
        """Of each of `edits`, how many texels it pushed against the end of a range."""

    @abc.abstractmethod
    def rows(self, rows: slice) -> "SkinMaps":
        """The maps of some rows, capture and original included."""

    @abc.abstractmethod
    def with_capture(
        self, capture: Map | None, notes: Mapping[str, str] | None = None
    ) -> "SkinMaps":
        """The same with the capture that it is of, and what is known of that."""

    @abc.abstractmethod
    def by_model(self, model: Model) -> "SkinMaps":
        """The same maps, whose colours another model tells."""

    @abc.abstractmethod
    def changed_by(self, recipe: Recipe) -> "EditedEstimate":
        """These maps with something done on top; CutisError where that does not fit them."""

    @property
    @abc.abstractmethod
    def documents(self) -> tuple[str, ...]:
        """Looks that were applied, as headers keep them."""

    @property
    def original(self) -> "Estimate | None":
        """The estimate that this was edited from; None for an estimate itself."""
        return None if self.estimate is self else self.estimate

    @property
    def mask(self) -> Map:
        """(H, W) in [0, 1]: where the maps hold."""
        return self.maps.mask

    @property
    def confidence(self) -> Map | None:
        """(H, W) in [0, 1]: how likely each colour is one of skin; None where not known."""
        return self.estimate.sure

    @property
    def calibration(self) -> Calibration:
        """Light and gains of the capture."""
        return self.estimate.calibrated

    @property
    def source(self) -> Map | None:
        """The capture (H, W, 3), linear sRGB; None where it is not at hand."""
        return self.estimate.capture

    @property
    def provenance(self) -> Mapping[str, str]:
        """Where the maps are from: free text."""
        return self.estimate.notes

    @property
    def made_by(self) -> MadeBy:
        """The model by name and digest, whether or not it is here."""
        return self.estimate.by

    @property
    def model(self) -> Model:
        """The model; CutisError where it is not here any more."""
        return self.made_by.load()

    @property
    def tissue(self) -> Tissue:
        """The tissue that these skins are of: that of the model."""
        return self.model.tissue

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.maps.shape

    @property
    def rare(self) -> tuple[str, ...]:
        """Names of the rare chromophores that have a map."""
        return self.maps.rare

    def map(self, name: str) -> Map:
        """(H, W) the map called `name`, of 0 for a rare chromophore that has none."""
        return self.maps[name]

    def parameters(self, rows: slice | None = None, names: Sequence[str] = NAMES) -> Map:
        """(H, W, 5) parameters, or those of some rows, or others by name; 0 where there is no map.

        Rare chromophores are among them where `names` says so, as NAMES + RARE_NAMES does.
        """
        return (self.maps if rows is None else self.maps.rows(rows)).parameters(names)

    def coordinates(self) -> Map:
        """(H, W, 5) network coordinates where the mask is not 0, else 0."""
        return self.maps.coordinates()

    def sigma(self, name: str) -> Map:
        """(H, W) standard deviation of a map in its unit, 0 off the mask: `skin.sigma("melanin")`.

        What a fit to the whole spectrum finds lies within ± 1.645 σ for nine of ten skins
        (docs/validation.md). Edits carry it on: a factor scales it, an offset leaves it, a set
        value has 0. Raises CutisError for maps without: only some models know it.
        """
        if name not in self.sigmas:
            parameter(name)
            raise CutisError(
                f"these maps have no σ of {name}: {self.made_by.name} does not know it, or they "
                "were made without; estimate again"
            )
        return self.sigmas[name]

    def statistics(self) -> Iterator[tuple[str, str, float, float, float]]:
        """(name, unit, 5th percentile, median, 95th percentile) of each map inside the mask."""
        found = MapStatistics()
        for rows in bands(self.shape):
            part = self.maps.rows(rows)
            found.add(part.coordinates(), part.mask > 0)
        for name, (low, median, high) in found.percentiles().items():
            yield name, parameter(name).unit, low, median, high

    # editing -----------------------------------------------------------------------------------

    def multiply(self, *, where: ArrayLike | None = None, **factors: ArrayLike) -> "EditedEstimate":
        """Multiplies maps by factors: `skin.multiply(melanin=1.4)`; numbers or (H, W) arrays."""
        return self.apply([_edit(k, "multiply", v) for k, v in factors.items()], where)

    def offset(self, *, where: ArrayLike | None = None, **amounts: ArrayLike) -> "EditedEstimate":
        """Adds amounts in the parameter's unit: `skin.offset(thickness=-20)`; numbers or arrays."""
        return self.apply([_edit(k, "offset", v) for k, v in amounts.items()], where)

    def replace(self, *, where: ArrayLike | None = None, **values: ArrayLike) -> "EditedEstimate":
        """Sets maps to values: `skin.replace(eumelanin=0.001)`; numbers or (H, W) arrays."""
        return self.apply([_edit(k, "set", v) for k, v in values.items()], where)

    def blend(
        self, amount: float, *, where: ArrayLike | None = None, **values: ArrayLike
    ) -> "EditedEstimate":
        """Moves maps part of the way, `amount` in [0, 1], towards values."""
        return self.apply([_edit(k, "set", v) for k, v in values.items()], where, amount=amount)

    def apply(
        self,
        edits: Edits,
        where: ArrayLike | None = None,
        *,
        amount: float = 1.0,
    ) -> "EditedEstimate":
        """Applies edits in order, a preset, a look or any other `Recipe`, inside the mask `where`.

        `where` (H, W) in [0, 1] takes the place of procedural masks; `amount` in [0, 1] blends
        between the old values and the new. Values are clamped to range and counted in `clamped`.
        Texels whose mask is 0 are never touched.
        """
        wanted = recipe(edits)
        painted = None if where is None else np.asarray(where, dtype=np.float32)
        if painted is not None and painted.shape != self.shape:
            raise CutisError(f"the edit mask is {painted.shape}, the maps are {self.shape}")
        for edit in wanted.edits if isinstance(wanted, Step) else ():
            array = edit.amount
            if isinstance(array, np.ndarray) and array.shape != self.shape:
                raise CutisError(
                    f"the amount of {edit.parameter} is {array.shape}, the maps are {self.shape}"
                )
        return self.changed_by(wanted.within(amount, painted))

    def to_tone(self, tone: "str | SkinMaps") -> "EditedEstimate":
        """The face in another tone, its features kept: `skin.to_tone("ita:-20")`.

        `tone` is `ita:-20`, the median ITA° of its skin; `monk:7`, the measured tone nearest to a
        swatch; `#8d5524`, the median of its skin in the file; `like:OTHER.skin.exr`, or other maps.
        Raises CutisError for a tone that no skin has. See docs/tones.md.
        """
        looks = import_module("cutis.looks")  # a room behind this one: not before it is asked for
        return self.apply(looks.tone_look(tone))

    # colour ------------------------------------------------------------------------------------

    @cached_property
    def model_albedo(self) -> Map:
        """(H, W, 3) linear sRGB that the model alone gives, calibration undone; 0 off the mask."""
        return colours.model_albedo(self.model, self.calibration, self.maps)

    def albedo(self, illuminant: LightLike | None = None) -> Map:
        """(H, W, 3) linear sRGB as captured, edits included; relit where `illuminant` is given.

        What the model does not explain (hair, eyes, detail) rides along as the ratio of capture
        to model; texels that no edit changed are those of the capture, bit for bit. Without the
        capture, the model's albedo.

        `illuminant`, a name or file that `colour.illuminant` takes, shows the skin under that light
        and balanced on it (`maps.relighting`); the light of the capture changes nothing.
        """
        if self.source is None:
            alone = colours.alone(self.model, self.calibration, self.maps, illuminant)
            return self.model_albedo.copy() if alone is None else alone
        look = self.recolouring(illuminant)
        return np.concatenate([
            look(self.rows(rows), self.source[rows])[1] for rows in bands(self.shape)
        ])  # fmt: skip

    def relit(self, illuminant: LightLike) -> Map:
        """(H, W, 3) linear sRGB under another light, edits included: `albedo(illuminant)`."""
        return self.albedo(illuminant)

    def retouch(self, texture: Texture, illuminant: LightLike | None = None) -> Texture:
        """The texture with the edits in it: same format, depth and space, other texels verbatim.

        With an `illuminant` all texels are as `albedo(illuminant)` shows them.
        """
        if texture.shape != self.shape:
            raise CutisError(f"the texture is {texture.shape}, the maps are {self.shape}")
        look = self.recolouring(illuminant)
        changed = np.zeros(self.shape, dtype=bool)
        edited = np.zeros((*self.shape, 3), dtype=np.float32)
        for rows in bands(self.shape):
            changed[rows], edited[rows] = look(self.rows(rows), texture.rows(rows).linear())
        return texture.with_linear(edited, changed)

    def recolouring(self, illuminant: LightLike | None = None) -> "Recolouring":
        """How rows of these maps change rows of their capture; made once for all of them."""
        return Recolouring(self.model, self.calibration, illuminant)

    def residual(self) -> Map:
        """(H, W, 3) capture over model of the estimate: what the model does not explain, 1 = all.

        1 off the mask. Raises CutisError without the capture.
        """
        if self.source is None:
            raise CutisError("these maps came without their capture; read it and estimate again")
        return colours.residual(self.source, self.estimate.model_albedo, self.mask)

    def reflectance(self, rows: slice | None = None) -> Map:
        """(H, W, 41) reflectance at `optics.WAVELENGTHS`, 0 off the mask.

        It is that of the exact albedo space of `tissue`, of the maps alone: neither calibration nor
        what the model does not explain is in it. A whole 2048² face takes 0.7 GB; give `rows` to go
        in bands.
        """
        return colours.reflectance(self.tissue, (self if rows is None else self.rows(rows)).maps)

    def save(self, path: str | os.PathLike[str], dtype: Literal["float", "half"] = "float") -> None:
        """Writes maps and mask as channels of one EXR; `dtype` float (exact) or half."""
        save_maps(self, path, dtype)

    def _repr_html_(self) -> str:
        """A thumbnail of the albedo, for notebooks."""
        from cutis.textures.thumbnail import LONGEST, picture_html

        step = max(1, -(-max(self.shape) // LONGEST))
        few = [self.rows(slice(row, row + 1)).albedo() for row in range(0, self.shape[0], step)]
        return picture_html(np.concatenate(few), repr(self)) if few else repr(self)

    def __repr__(self) -> str:
        height, width = self.shape
        cover = float(np.mean(self.mask > 0)) if self.mask.size else 0.0
        done = f", {len(self.edits)} edits" if self.edits else ""
        known = "" if self.source is not None else ", without its capture"
        return (
            f"<skin maps of {width} × {height} texels, {100 * cover:.0f} % skin, by "
            f"{self.made_by.name}{done}{known}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(SkinMaps):
    """What a model found in a capture.

    `found` are the maps, `spread` their σ by name, `sure` the confidence, `capture` the colours
    (H, W, 3) that they were found in, `by` the model, `state` what its survey found (`inverse`). Of
    maps out of a file `tile` says which of a set they are, `quantiles` is what its header keeps.
    """

    found: Maps
    by: MadeBy
    calibrated: Calibration = field(default_factory=Calibration)
    spread: Mapping[str, Map] = field(default_factory=dict)
    sure: Map | None = None
    capture: Map | None = None
    notes: Mapping[str, str] = field(default_factory=dict)
    state: State = field(default_factory=dict)
    tile: TileOf = field(default_factory=TileOf)
    quantiles: Quantiles | None = None

    def __post_init__(self) -> None:
        shape = self.found.shape
        spread = {n: read_only(f"σ of {n}", values, shape) for n, values in self.spread.items()}
        object.__setattr__(self, "spread", spread)
        for name, size in (("sure", shape), ("capture", (*shape, 3))):
            values = getattr(self, name)
            if values is not None:
                told = "confidence" if name == "sure" else "source"
                object.__setattr__(self, name, read_only(told, values, size))

    @property
    def maps(self) -> Maps:
        """What was found."""
        return self.found

    @property
    def sigmas(self) -> Mapping[str, Map]:
        """Standard deviations by name."""
        return self.spread

    @property
    def estimate(self) -> "Estimate":
        """Itself."""
        return self

    @property
    def edits(self) -> tuple[str, ...]:
        """None."""
        return ()

    @property
    def clamped(self) -> tuple[int, ...]:
        """None."""
        return ()

    def rows(self, rows: slice) -> "Estimate":
        """The estimate of some rows."""
        part = replace(
            self,
            found=self.found.rows(rows),
            spread={name: values[rows] for name, values in self.spread.items()},
            sure=None if self.sure is None else self.sure[rows],
            capture=None if self.capture is None else self.capture[rows],
        )
        if "model_albedo" in self.__dict__:  # decoded already
            part.__dict__["model_albedo"] = self.model_albedo[rows]
        return part

    def with_capture(
        self, capture: Map | None, notes: Mapping[str, str] | None = None
    ) -> "Estimate":
        """The same with the capture that it is of, and what is known of that."""
        return replace(self, capture=capture, notes=self.notes if notes is None else notes)

    def by_model(self, model: Model) -> "Estimate":
        """The same maps, whose colours another model tells."""
        return replace(self, by=MadeBy.of(model))

    @property
    def documents(self) -> tuple[str, ...]:
        """None."""
        return ()

    def changed_by(self, recipe: Recipe) -> "EditedEstimate":
        """An edited estimate."""
        return EditedEstimate(self).changed_by(recipe)


def skin_of(
    maps: Mapping[str, ArrayLike],
    mask: ArrayLike | None = None,
    *,
    model: Model | str = DEFAULT,
    calibration: Calibration | None = None,
    source: ArrayLike | None = None,
    sigmas: Mapping[str, ArrayLike] | None = None,
    confidence: ArrayLike | None = None,
    provenance: Mapping[str, str] | None = None,
) -> Estimate:
    """Skin maps of arrays (H, W) by name, in their units, as an estimate would have them.

    `mask` is 1 everywhere unless given. The others are those of `SkinMaps`; `source` is the capture
    (H, W, 3), linear sRGB. Raises CutisError for arrays of different sizes and missing maps.
    """
    arrays = {name: np.asarray(values, dtype=np.float32) for name, values in maps.items()}
    shape = np.shape(next(iter(arrays.values()), np.zeros(())))
    cover = np.ones(shape, np.float32) if mask is None else np.asarray(mask, dtype=np.float32)
    spread = {name: np.asarray(v, dtype=np.float32) for name, v in (sigmas or {}).items()}
    return Estimate(
        Maps(arrays, cover), MadeBy.of(load_model(model)), calibration or Calibration(), spread,
        None if confidence is None else np.asarray(confidence, dtype=np.float32),
        None if source is None else np.asarray(source, dtype=np.float32),
        provenance or {},
    )  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class EditedEstimate(SkinMaps):
    """An estimate with changes, which are worked out when their maps are asked for.

    `before` is the estimate; `changes` are applied in order to `base`, maps that are edited already
    (as files hold them, with `told` and `kept`, lines and documents of what was done to them), or
    to the estimate's. `done` are the recipes that the changes were made of.
    """

    before: Estimate
    changes: tuple[Change, ...] = ()
    base: Tile | None = None
    told: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    done: tuple[Recipe, ...] = ()

    @cached_property
    def _tile(self) -> Tile:
        return self._worked_out(slice(0, self.before.shape[0]))

    def _worked_out(self, rows: slice) -> Tile:
        """The tile of some rows; changes that look further see so much more."""
        height = self.before.shape[0]
        start, stop, _ = rows.indices(height)
        reach = sum(change.reach for change in self.changes)
        wide = slice(max(0, start - reach), min(height, stop + reach))
        tile = self._start.rows(wide)
        for change in self.changes:
            tile = change.rows(wide)(tile)
        return tile.rows(slice(start - wide.start, stop - wide.start))

    @property
    def _start(self) -> Tile:
        if self.base is not None:
            return self.base
        return Tile(self.before.maps, self.before.sigmas, (), self.before.sure)

    @property
    def maps(self) -> Maps:
        """The edited maps."""
        return self._tile.maps

    @property
    def sigmas(self) -> Mapping[str, Map]:
        """Standard deviations by name, carried through the edits."""
        return self._tile.sigmas

    @property
    def estimate(self) -> Estimate:
        """The estimate without edits."""
        return self.before

    @property
    def mask(self) -> Map:
        """That of the estimate: edits do not move it."""
        return self.before.mask

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.before.shape

    @property
    def edits(self) -> tuple[str, ...]:
        """What was done to the estimate, a line each."""
        return (*self.told, *(line for change in self.changes for line in change.told))

    @property
    def clamped(self) -> tuple[int, ...]:
        """Of each of `edits`, how many texels it pushed against the end of a range."""
        return self._tile.clamped

    def rows(self, rows: slice) -> "EditedEstimate":
        """The edited estimate of some rows, worked out; its counts are those of the rows."""
        done = "_tile" in self.__dict__
        tile = self._tile.rows(rows) if done else self._worked_out(rows)
        return EditedEstimate(self.before.rows(rows), (), tile, self.edits, self.documents)

    @property
    def documents(self) -> tuple[str, ...]:
        """Looks that were applied."""
        return (*self.kept, *(text for recipe in self.done for text in recipe.documents))

    def changed_by(self, recipe: Recipe) -> "EditedEstimate":
        """The same with one more change."""
        bare = replace(self, changes=(), done=())
        change = recipe.for_face(Face(Held(bare), self.done, self.changes))
        return replace(self, changes=(*self.changes, change), done=(*self.done, recipe))

    def with_capture(
        self, capture: Map | None, notes: Mapping[str, str] | None = None
    ) -> "EditedEstimate":
        """The same with the capture that it is of, and what is known of that."""
        return replace(self, before=self.before.with_capture(capture, notes))

    def by_model(self, model: Model) -> "EditedEstimate":
        """The same maps, whose colours another model tells."""
        return replace(self, before=self.before.by_model(model))


class Recolouring:
    """From rows of a capture to the same with the edits of rows of maps in them.

    Called with some rows of maps and the colours (h, W, 3) of their capture it gives which texels
    change (h, W), and all colours (h, W, 3): texels that no edit changed are verbatim.
    """

    def __init__(
        self, model: Model, calibration: Calibration, illuminant: LightLike | None = None
    ) -> None:
        self._model, self._calibration = model, calibration
        self._relight = colours.relighting(model, calibration, illuminant)

    def __call__(self, skin: SkinMaps, source: Map) -> tuple[Any, Map]:
        """Changed texels, and colours."""
        before, after = skin.estimate.maps, skin.maps
        if self._relight is not None:
            return np.ones(skin.shape, dtype=bool), self._relight(before, after, source)
        return colours.changes(self._model, self._calibration, before, after, source)


def _edit(name: str, operation: str, amount: ArrayLike) -> Edit:
    if np.ndim(amount) == 0:
        return Edit(name, operation, float(np.asarray(amount)))
    return Edit(name, operation, np.asarray(amount, dtype=np.float32))
