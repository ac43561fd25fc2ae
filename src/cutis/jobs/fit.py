"""Files of spectra to files of skins: what `cutis fit` does."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.apps.console import err, steps
from cutis.errors import CutisError
from cutis.inverse import SpectralFit, SpectralFitter
from cutis.inverse.models import EXACT
from cutis.optics import ALIAGA2022, MEASURED2026, WAVELENGTHS, Parameter, tissue_named
from cutis.spectra import open_cube, open_table, text_cell
from cutis.spectra.reflectance import HIGHEST, fraction_scale, without_impossible
from cutis.textures import channel_writer, replacing
from cutis.textures.problem import problem

STEP = 2000
"""Spectra of a table between two looks at the progress bar."""


@dataclass(frozen=True)
class Request:
    """What was asked for; `low` to `high` are the wavelengths to fit, nm."""

    spectra: Path
    output: Path | None
    specular: float = 0.0
    low: float = 380.0
    high: float = 780.0
    scale: float | None = None
    noise: float | None = None
    held: Mapping[str, float] | None = None
    quiet: bool = False
    tissue: str = MEASURED2026.name
    shift: float = 0.0
    free: tuple[str, ...] = ()

    def say(self, note: str) -> None:
        """A note to whoever watches; on stderr, since results may go to stdout."""
        if not self.quiet:
            err.print(f"{self.spectra.name}: {note}", soft_wrap=True)

    def chosen(self, wavelengths: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(n,) which wavelengths are fitted; CutisError where none can be."""
        low, high = max(self.low, WAVELENGTHS[0]), min(self.high, WAVELENGTHS[-1])
        inside = (wavelengths >= low) & (wavelengths <= high)
        if not inside.any():
            have = f"{wavelengths.min():g} to {wavelengths.max():g} nm"
            raise problem(
                self.spectra,
                f"its wavelengths, {have}, are outside {low:g} to {high:g} nm; are they in nm?",
            )
        if not inside.all():
            count = int((~inside).sum())
            self.say(
                f"{count} of {len(inside)} wavelengths outside {low:g} to {high:g} nm left out"
            )
        return inside

    def fitter(self, wavelengths: NDArray[np.float64]) -> SpectralFitter:
        """A fitter of what is asked for at `wavelengths`."""
        tissue = tissue_named(self.tissue)
        try:
            return SpectralFitter(
                wavelengths,
                tissue,
                specular=self.specular,
                shift=self.shift,
                held=self.held,
                noise=self.noise,
                free=self.free,
            )
        except CutisError as error:
            raise problem(self.spectra, str(error)) from error


def fit_table(request: Request, correlations: bool = False) -> None:
    """A CSV of spectra → a CSV of skins, one row each, in their order."""
    path, output = request.spectra, request.output
    if output is not None and output.suffix.lower() != ".csv":
        raise CutisError(f"{output}: skins of a table are a table; end its name in .csv")
    if output is not None and output.resolve() == path.resolve():
        raise CutisError(f"{output.name} is the file of spectra itself; write to another name")
    table = open_table(path)
    for note in table.notes:
        request.say(note)
    inside = request.chosen(table.wavelengths)
    stored = table.values[:, inside]
    fraction, notes = table.scale(inside, request.scale)
    values, low, high = without_impossible(stored * fraction)
    for note in [*notes, *_left_out(low, high)]:
        request.say(note)
    missing = int(np.isnan(values).sum()) - low - high
    if missing:
        request.say(f"{_values(missing)} missing: the others of their spectra are fitted")
    fitter = request.fitter(table.wavelengths[inside])
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
    with steps(-(-len(values) // STEP), request.quiet) as progress:
        for start in range(0, len(values), STEP):
            progress.step("fitting")
            parts.append(fitter.fit(values[start : start + STEP]))
    found = _joined(parts)
    if (used == free).any() and request.noise is None:
        request.say("as many wavelengths as parameters: σ is for a noise of 0.005")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [p.name for p in found.parameters]
    pairs = list(combinations(range(len(names)), 2)) if correlations else []
    sigma = found.sigma
    header = [
        *map(text_cell, table.columns),
        *names,
        *(f"{name}_sigma" for name in names),
        "rmse",
        "wavelengths",
    ]
    writer.writerow([*header, *(f"{names[i]}_{names[j]}_correlation" for i, j in pairs)])
    for row, label in enumerate(table.labels):
        numbers = [*found.values[row], *sigma[row], found.rmse[row]]
        scaled = np.maximum(sigma[row], 1e-30)
        extra = [found.covariance[row, i, j] / (scaled[i] * scaled[j]) for i, j in pairs]
        cells = [*(f"{v:.6g}" for v in numbers), str(used[row]), *(f"{v:.4f}" for v in extra)]
        writer.writerow([*map(text_cell, label), *cells])
    if output is None:
        print(text.getvalue(), end="")
    else:
        with replacing(output) as partial:
            partial.write_text(text.getvalue(), encoding="utf-8")
    where = "" if output is None else f"wrote {output}: "
    request.say(f"{where}{_summary(found, request)}")


def fit_cube(request: Request, wavelengths: Path | None = None) -> None:
    """A cube → maps NAME.skin.exr with channels <name>.sigma and rmse, some rows at a time."""
    output = request.output
    if output is None or output.suffix.lower() != ".exr":
        raise CutisError("skins of a cube are maps; name them with -o NAME.skin.exr")
    with open_cube(request.spectra, wavelengths) as cube:
        if output.exists() and output.samefile(cube.path):
            raise CutisError(f"{output.name} is the cube itself; write to another name")
        for note in cube.notes:
            request.say(note)
        inside = request.chosen(cube.wavelengths)
        stored = cube.scale if request.scale is None else request.scale
        fraction, notes = fraction_scale(cube.path, cube.sample()[..., inside], stored)
        if request.scale is None and cube.scale is not None:
            notes.append(f"the header says that {cube.scale:g} means 1")
        for note in notes:
            request.say(note)
        fitter = request.fitter(cube.wavelengths[inside])
        names = [p.name for p in fitter.parameters]
        channels = (*names, "mask", *(f"{name}.sigma" for name in names), "rmse")
        header: dict[str, str | float | int] = {
            f"cutis:{p.name}": f"{p.meaning} [{p.unit}], {p.low:g} to {p.high:g}"
            for p in fitter.parameters
        }
        tissue = request.tissue
        header["cutis:model"] = EXACT if tissue == ALIAGA2022.name else tissue
        header["cutis:tissue"] = tissue
        header["cutis:spectra"] = cube.path.name
        header["cutis:specular"] = f"{request.specular:g}"
        header["cutis:shift"] = f"{request.shift:g}"
        low = high = dropped = done = 0
        total, spread = 0, 0.0
        with (
            channel_writer(output, channels, cube.shape, "float", header) as write,
            steps(1, request.quiet) as progress,
        ):
            for rows in cube.bands():
                progress.at(done, cube.shape[0], "fitting")
                part = cube.rows(rows)[..., inside] * np.float32(fraction)
                shape = part.shape[:2]
                values, below, above = without_impossible(part.reshape(-1, part.shape[-1]))
                low, high = low + below, high + above
                good = np.isfinite(values).sum(axis=1) >= fitter.free.sum()
                good &= np.nan_to_num(values).max(axis=1) > 0
                found = fitter.fit(values[good])
                dropped += int((~good).sum())
                total, spread = total + int(good.sum()), spread + float(found.rmse.sum())
                write(_maps(found, good, shape))
                done = rows.stop
            if not total:
                what = f"no texel has {fitter.free.sum()} usable values; nothing to fit"
                raise problem(cube.path, what)
    for note in _left_out(low, high):
        request.say(note)
    if dropped:
        request.say(f"{dropped} texels without a spectrum are outside the mask")
    request.say(
        f"wrote {output}: {total} skins, mean RMSE {spread / total:.4f}, {_conditions(request)}"
    )


def _conditions(request: Request) -> str:
    shift = f", wavelengths shifted by {request.shift:g} nm" if request.shift else ""
    return f"{request.tissue}, surface reflection {request.specular:g}{shift}"


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


def _summary(found: SpectralFit, request: Request) -> str:
    rmse = found.rmse
    return (
        f"{len(rmse)} skins, RMSE mean {rmse.mean():.4f}, worst {rmse.max():.4f}, "
        f"{_conditions(request)}"
    )
