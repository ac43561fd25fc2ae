"""Measured spectra from files to files of skins."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.inverse import SpectralFit, SpectralFitter
from cutis.jobs.doubts import Doubts
from cutis.jobs.files import check_outputs
from cutis.jobs.job import digest_of
from cutis.maps.defaults import OLD_DEFAULT, default_tissue
from cutis.maps.estimating import Progress, nobody
from cutis.optics import ALIAGA2022, WAVELENGTHS, Parameter, Tissue
from cutis.spectra import is_table, open_cube, open_table, text_cell
from cutis.spectra.reflectance import HIGHEST, fraction_scale, without_impossible
from cutis.textures import channel_writer, replacing, sweep
from cutis.textures.problem import problem

STEP = 2000
"""Spectra of a table between two looks at the progress bar."""


@dataclass(frozen=True)
class Fitted:
    """What came of a fit: notes on the spectra, a summary, and the table where it has no file."""

    notes: tuple[str, ...]
    summary: str
    table: str | None = None


@dataclass(frozen=True)
class FitJob:
    """Spectra to fit: a table, or a cube (ENVI .hdr, spectral .exr, .npy).

    `output` is a .csv for a table, None to get its text back, and NAME.skin.exr for a cube. `low`
    to `high` are the wavelengths to fit, nm; `wavelengths` a list of those of a cube; `scale` the
    stored value that means a reflectance of 1. `correlations` adds columns to a table. `force`
    keeps what looks like no skin. The others are those of `inverse.fit_spectra`.
    """

    spectra: Path
    output: Path | None = field(default=None, metadata={"result": False})
    tissue: Tissue = field(default_factory=default_tissue)
    specular: float = 0.0
    shift: float = 0.0
    low: float = 380.0
    high: float = 780.0
    wavelengths: Path | None = None
    scale: float | None = None
    noise: float | None = None
    held: Mapping[str, float] = field(default_factory=dict)
    free: tuple[str, ...] = ()
    correlations: bool = False
    force: bool = field(default=False, metadata={"result": False})

    def __post_init__(self) -> None:
        if not 0 < self.low < self.high:
            raise CutisError(
                f"wavelengths to fit must rise from above 0 nm, not {self.low:g} to {self.high:g}"
            )
        name = "" if self.output is None else self.output.suffix.lower()
        if self.is_table and name not in ("", ".csv"):
            raise CutisError(f"{self.output}: skins of a table are a table; end its name in .csv")
        if not self.is_table and name != ".exr":
            raise CutisError("skins of a cube are maps; name them with -o NAME.skin.exr")

    @property
    def is_table(self) -> bool:
        """Whether the spectra are a table; else they are a cube."""
        return is_table(self.spectra)

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> Fitted:
        """Fits all spectra."""
        what = "the file of spectra" if self.is_table else "the cube"
        inputs = {what: self.spectra, "the list of wavelengths": self.wavelengths}
        check_outputs([self.output], inputs)
        if self.output is not None:
            sweep(self.output.parent)
        run = _Run(self, progress)
        return run.table() if self.is_table else run.cube()


class _Run:
    """A fit on its way."""

    def __init__(self, job: FitJob, progress: Progress) -> None:
        self.job, self.progress, self.notes = job, progress, list[str]()

    def chosen(self, wavelengths: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(n,) which wavelengths are fitted; CutisError where none can be."""
        low, high = max(self.job.low, WAVELENGTHS[0]), min(self.job.high, WAVELENGTHS[-1])
        inside = (wavelengths >= low) & (wavelengths <= high)
        if not inside.any():
            have = f"{wavelengths.min():g} to {wavelengths.max():g} nm"
            raise problem(
                self.job.spectra,
                f"its wavelengths, {have}, are outside {low:g} to {high:g} nm; are they in nm?",
            )
        if not inside.all():
            count = int((~inside).sum())
            self.notes.append(
                f"{count} of {len(inside)} wavelengths outside {low:g} to {high:g} nm left out"
            )
        return inside

    def fitter(self, wavelengths: NDArray[np.float64]) -> SpectralFitter:
        """A fitter of what is asked for at `wavelengths`."""
        job = self.job
        try:
            return SpectralFitter(
                wavelengths, job.tissue, specular=job.specular, shift=job.shift, held=job.held,
                noise=job.noise, free=job.free,
            )  # fmt: skip
        except CutisError as error:
            raise problem(job.spectra, str(error)) from error

    def doubted(self, doubts: Doubts, share: float) -> None:
        """Refuses fits of which more than `share` look like no skin, unless they are wanted."""
        if not doubts.more_than(share):
            return
        if not self.job.force:
            remedy = "give reflectance, not absorbance or K/S, or keep the result by --force"
            raise problem(self.job.spectra, f"{doubts.words()}; {remedy}")
        self.notes.append(doubts.words())

    def table(self) -> Fitted:
        """A CSV of spectra → a CSV of skins, one row each, in their order."""
        request, path, output = self.job, self.job.spectra, self.job.output
        table = open_table(path)
        for note in table.notes:
            self.notes.append(note)
        inside = self.chosen(table.wavelengths)
        stored = table.values[:, inside]
        fraction, notes = table.scale(inside, request.scale)
        values, low, high = without_impossible(stored * fraction)
        for note in [*notes, *_left_out(low, high)]:
            self.notes.append(note)
        missing = int(np.isnan(values).sum()) - low - high
        if missing:
            self.notes.append(f"{_values(missing)} missing: the others of their spectra are fitted")
        fitter = self.fitter(table.wavelengths[inside])
        used = np.isfinite(values).sum(axis=1)
        free = int(fitter.free.sum())
        if (used < free).any():
            i = int(np.argmax(used < free))
            raise problem(
                path,
                f"spectrum {'/'.join(table.labels[i])} has {used[i]} usable values for {free} free "
                "parameters; complete it, leave it out or hold some parameters",
            )
        parts = []
        for start in range(0, len(values), STEP):
            self.progress(start, len(values), "fitting")
            parts.append(fitter.fit(values[start : start + STEP]))
        found = _joined(parts)
        doubts = Doubts(request.held)
        doubts.add(found)
        self.doubted(doubts, 0.5)
        if (used == free).any() and request.noise is None:
            self.notes.append("as many wavelengths as parameters: σ is for a noise of 0.005")
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        names = [p.name for p in found.parameters]
        pairs = list(combinations(range(len(names)), 2)) if request.correlations else []
        sigma = found.sigma
        header = [
            *map(text_cell, table.columns),
            *names,
            *(f"{name}_sigma" for name in names),
            "rmse",
            "wavelengths",
        ]
        writer.writerow([*header, *(f"{names[i]}_{names[j]}_correlation" for i, j in pairs)])
        for row, labels in enumerate(table.labels):
            numbers = [*found.values[row], *sigma[row], found.rmse[row]]
            scaled = np.maximum(sigma[row], 1e-30)
            extra = [found.covariance[row, i, j] / (scaled[i] * scaled[j]) for i, j in pairs]
            cells = [*(f"{v:.6g}" for v in numbers), str(used[row]), *(f"{v:.4f}" for v in extra)]
            writer.writerow([*map(text_cell, labels), *cells])
        if output is not None:
            with replacing(output) as partial:
                partial.write_text(text.getvalue(), encoding="utf-8")
        where = "" if output is None else f"wrote {output}: "
        summary = f"{where}{_summary(found, request)}"
        return Fitted(tuple(self.notes), summary, text.getvalue() if output is None else None)

    def cube(self) -> Fitted:
        """A cube → maps NAME.skin.exr with channels <name>.sigma and rmse, some rows at a time."""
        request, output = self.job, self.job.output
        assert output is not None
        with open_cube(request.spectra, request.wavelengths) as cube:
            check_outputs([output], {"the cube": cube.path})
            for note in cube.notes:
                self.notes.append(note)
            inside = self.chosen(cube.wavelengths)
            stored = cube.scale if request.scale is None else request.scale
            fraction, notes = fraction_scale(cube.path, cube.sample()[..., inside], stored)
            if request.scale is None and cube.scale is not None:
                notes.append(f"the header says that {cube.scale:g} means 1")
            for note in notes:
                self.notes.append(note)
            fitter = self.fitter(cube.wavelengths[inside])
            names = [p.name for p in fitter.parameters]
            channels = (*names, "mask", *(f"{name}.sigma" for name in names), "rmse")
            header: dict[str, str | float | int] = {
                f"cutis:{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}"
                for p in fitter.parameters
            }
            tissue = request.tissue.name
            header["cutis:model"] = OLD_DEFAULT if tissue == ALIAGA2022.name else tissue
            header["cutis:tissue"] = tissue
            header["cutis:spectra"] = cube.path.name
            header["cutis:specular"] = f"{request.specular:g}"
            header["cutis:shift"] = f"{request.shift:g}"
            doubts = Doubts(request.held)
            low = high = dropped = done = 0
            total, spread = 0, 0.0
            with (
                channel_writer(output, channels, cube.shape, "float", header) as write,
            ):
                for rows in cube.bands():
                    self.progress(done, cube.shape[0], "fitting")
                    part = cube.rows(rows)[..., inside] * np.float32(fraction)
                    shape = part.shape[:2]
                    values, below, above = without_impossible(part.reshape(-1, part.shape[-1]))
                    low, high = low + below, high + above
                    good = np.isfinite(values).sum(axis=1) >= fitter.free.sum()
                    good &= np.nan_to_num(values).max(axis=1) > 0
                    found = fitter.fit(values[good])
                    doubts.add(found)
                    dropped += int((~good).sum())
                    total, spread = total + int(good.sum()), spread + float(found.rmse.sum())
                    write(_maps(found, good, shape))
                    done = rows.stop
                if not total:
                    what = f"no texel has {fitter.free.sum()} usable values; nothing to fit"
                    raise problem(cube.path, what)
                self.doubted(doubts, 0.9)  # there may be more wall than skin
        for note in _left_out(low, high):
            self.notes.append(note)
        if dropped:
            self.notes.append(f"{dropped} texels without a spectrum are outside the mask")
        mean = f"mean RMSE {spread / total:.4f}"
        summary = f"wrote {output}: {total} skins, {mean}, {_conditions(request)}"
        return Fitted(tuple(self.notes), summary)


def _conditions(request: FitJob) -> str:
    shift = f", wavelengths shifted by {request.shift:g} nm" if request.shift else ""
    return f"{request.tissue.name}, surface reflection {request.specular:g}{shift}"


def _maps(
    found: SpectralFit, good: NDArray[np.bool_], shape: tuple[int, int]
) -> dict[str, NDArray[np.float32]]:
    """Channels (h, W): those of texels that are no skin are 0, parameters at the low end."""

    def channel(values: NDArray[np.float64], blank: float) -> NDArray[np.float32]:
        whole = np.full(len(good), blank, dtype=np.float32)
        whole[good] = values
        return whole.reshape(shape)

    sigma = found.sigma
    maps = {p.name: channel(found.values[:, i], p.low) for i, p in enumerate(found.parameters)}
    maps |= {f"{p.name}.sigma": channel(sigma[:, i], 0) for i, p in enumerate(found.parameters)}
    maps["mask"] = good.astype(np.float32).reshape(shape)
    maps["rmse"] = channel(found.rmse, 0)
    return maps


def _joined(parts: Sequence[SpectralFit]) -> SpectralFit:
    parameters: tuple[Parameter, ...] = parts[0].parameters
    return SpectralFit(
        parameters,
        np.concatenate([part.values for part in parts]),
        np.concatenate([part.covariance for part in parts]),
        np.concatenate([part.rmse for part in parts]),
    )


def _left_out(low: int, high: int) -> list[str]:
    notes = []
    if low:
        notes.append(f"{_values(low)} negative: left out")
    if high:
        notes.append(f"{_values(high)} above {HIGHEST:g}: left out")
    return notes


def _values(number: int) -> str:
    return "1 value is" if number == 1 else f"{number} values are"


def _summary(found: SpectralFit, request: FitJob) -> str:
    rmse = found.rmse
    return (
        f"{len(rmse)} skins, RMSE mean {rmse.mean():.4f}, worst {rmse.max():.4f}, "
        f"{_conditions(request)}"
    )
