"""What a face is told, as a value: report.json, the printed summary and the page are made of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from cutis.errors import CutisError


@dataclass(frozen=True)
class Bars:
    """A histogram: `edges` (n + 1) in the unit of a map, rising, `counts` (n) of texels between."""

    edges: tuple[float, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True)
class Percentiles:
    """Values of a map below which 5, 50 and 95 % of the texels lie, in its unit."""

    p5: float
    median: float
    p95: float


@dataclass(frozen=True)
class MapNumbers:
    """One map inside the mask, and where the model has σ, how far it is known.

    `sigma` and `sure_median` are medians of σ and of the map over texels of a colour that is likely
    skin's; `informed` is 1 − σ / σ of the prior, from 0 (the colour said nothing) to 1.
    """

    unit: str
    p5: float
    median: float
    p95: float
    sure_median: float | None = None
    sigma: float | None = None
    informed: float | None = None
    histogram: Bars | None = None


@dataclass(frozen=True)
class ColourNumbers:
    """The model alone against the calibrated capture, on skin texels.

    `mse` in linear sRGB, errors in CIEDE2000, `out_of_gamut` the share of texels with more than 1,
    `ita_median` in degrees.
    """

    mse: float
    delta_e_mean: float
    delta_e_p95: float
    out_of_gamut: float
    ita_median: float


@dataclass(frozen=True)
class CalibrationNumbers:
    """Gains of red, green and blue, where they come from, and the light of the capture."""

    gains: tuple[float, ...] = (1.0, 1.0, 1.0)
    origin: str = "none"
    illuminant: str = "D65"


@dataclass(frozen=True)
class RegionNumbers:
    """The texels of one colour of a region picture, by the name of that colour."""

    name: str
    texels: int
    ita_median: float
    delta_e_mean: float
    maps: Mapping[str, Percentiles]


@dataclass(frozen=True)
class Doubt:
    """Why the input may be no albedo of skin: a kind of `checks`, a sentence, how to go on."""

    kind: str
    sentence: str
    hint: str = ""


@dataclass(frozen=True)
class Report:
    """The numbers of one estimate; see `cutis.report.report` for what they mean.

    What is not known is None or empty: `colour` and `smoothness` without a skin texel, regions
    without a picture of them, `low_confidence` and what maps say of σ where the model has none.
    `notes` say in words what was chosen in the files, or not believed; `doubts` what speaks
    against the input, for whose sake no map is called well known.
    """

    model: str = ""
    size: tuple[int, ...] = (0, 0)
    masked_texels: int = 0
    skin_texels: int = 0
    below_0: int = 0
    above_1: int = 0
    calibration: CalibrationNumbers = CalibrationNumbers()
    maps: Mapping[str, MapNumbers] = field(default_factory=dict)
    clamped: Mapping[str, float] = field(default_factory=dict)
    low_confidence: float | None = None
    colour: ColourNumbers | None = None
    smoothness: Mapping[str, float] = field(default_factory=dict)
    colorspace: str | None = None
    regions: tuple[RegionNumbers, ...] = ()
    notes: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()

    @property
    def skin_share(self) -> float:
        """Share of the mask that has the colour of skin; 1 for an empty mask."""
        return self.skin_texels / self.masked_texels if self.masked_texels else 1.0

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as report.json holds it; what is not known is left out."""
        return dict(_plain(self))

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Report":
        """The inverse of `as_dict`. Raises CutisError for data that is no report."""
        try:
            known = dict(data)
            if "calibration" in known:
                known["calibration"] = _made(CalibrationNumbers, known["calibration"])
            if "colour" in known:
                known["colour"] = _made(ColourNumbers, known["colour"])
            if "maps" in known:
                known["maps"] = {name: _map(row) for name, row in known["maps"].items()}
            known["regions"] = tuple(_region(one) for one in known.get("regions", ()))
            known["doubts"] = tuple(_made(Doubt, one) for one in known.get("doubts", ()))
            found = _made(cls, known)
        except (TypeError, KeyError, AttributeError, ValueError) as error:
            raise CutisError(f"this is no report of an estimate ({error})") from None
        assert isinstance(found, cls)
        return found


def _map(row: Mapping[str, Any]) -> MapNumbers:
    bars = row.get("histogram")
    found = _made(MapNumbers, {**row, "histogram": None if bars is None else _made(Bars, bars)})
    assert isinstance(found, MapNumbers)
    return found


def _region(one: Mapping[str, Any]) -> RegionNumbers:
    maps = {name: Percentiles(**row) for name, row in one["maps"].items()}
    return RegionNumbers(**{**one, "maps": maps})


def _made(kind: type, row: Mapping[str, Any]) -> Any:
    values = {key: tuple(v) if isinstance(v, list) else v for key, v in row.items()}
    return kind(**values)


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        pairs = ((f.name, getattr(value, f.name)) for f in fields(value))
        return {name: _plain(part) for name, part in pairs if part not in (None, (), {})}
    if isinstance(value, Mapping):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, tuple):
        return [_plain(part) for part in value]
    return value
