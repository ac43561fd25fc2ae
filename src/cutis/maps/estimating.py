"""From a capture to its skin maps: the one way that arrays and files take.

First a capture, or all of a set, is surveyed: for its light and gains, and for whatever its model
wants to know of the whole. Then it goes through the model in bands of rows. A model that looks at
neighbours is given as many rows more on either side as it looks far.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutis.colour import LightLike
from cutis.inverse.calibration import Calibration, Exposure, White, calibrate
from cutis.inverse.model import Found, Model, State, Survey
from cutis.maps.defaults import DEFAULT, load_model
from cutis.maps.plain import Map, Maps, Place
from cutis.maps.sampler import Sampler
from cutis.maps.skin_maps import Estimate, MadeBy
from cutis.maps.source import Capture, in_memory, source_note
from cutis.optics import NAMES
from cutis.textures.reading import read_texture
from cutis.textures.texture import Texture

Progress = Callable[[int, int, str], None]
"""Takes texels done, texels in all, and what is being done; it may raise to stop the work."""


def nobody(done: int, total: int, doing: str) -> None:
    """A `Progress` that nobody watches."""


@dataclass(frozen=True)
class Surveyed:
    """What is known of a capture, or of all captures of a set, before any texel is estimated."""

    calibration: Calibration = field(default_factory=Calibration)
    state: State = field(default_factory=dict)


def survey(
    captures: Sequence[Callable[[], Any]],
    model: Model,
    white: White = None,
    exposure: Exposure = None,
    illuminant: LightLike = "D65",
    progress: Progress = nobody,
) -> Surveyed:
    """Looks at all captures of a set: for gains where they are "auto", and for the model.

    Each of `captures` opens one, as a context manager that yields a `Capture`. `white`, `exposure`
    and `illuminant` are those of `inverse.calibrate`.
    """
    sampler = None
    if "auto" in (white, exposure):
        sampler = Sampler(_texels(captures))
        _look(captures, sampler, None, progress, "looking for gains")
        progress(1, 1, "calibrating")
    colours = np.zeros((0, 3), np.float32) if sampler is None else sampler.colours()
    calibration = calibrate(colours, model.tissue, white, exposure, illuminant)
    if model.survey is None:
        return Surveyed(calibration)
    asked = model.survey()
    _look(captures, asked, calibration, progress, "looking at the whole")
    return Surveyed(calibration, asked.finish())


def estimate_bands(
    capture: Capture,
    model: Model,
    known: Surveyed,
    *,
    sigma: bool = True,
    like: Estimate | None = None,
) -> Iterator[tuple[slice, Estimate]]:
    """Rows of a capture with their estimate, from top to bottom, capture included.

    `like` is an estimate whose provenance the parts get.
    """
    notes = {} if like is None else like.notes
    whole = capture.shape
    for rows, colours, cover, found in _found(capture, model, known, sigma):
        maps = Maps(found.maps, cover, Place(rows.start, whole))
        yield rows, Estimate(
            maps, MadeBy.of(model), known.calibration, found.sigmas, found.confidence,
            colours, notes, known.state,
        )  # fmt: skip


def estimate(
    face: Texture | ArrayLike | str | os.PathLike[str],
    mask: ArrayLike | None = None,
    *,
    white: White = None,
    exposure: Exposure = None,
    model: Model | str = DEFAULT,
    illuminant: LightLike = "D65",
    sigma: bool = True,
    steady: bool = False,
) -> Estimate:
    """Skin maps of a texture, of its file, or of an (H, W, 3) array of linear sRGB.

    Parameters
    ----------
    face
        What `cutis.read` gives, a path, or floating-point linear sRGB.
    mask
        (H, W) in [0, 1], where skin is; without one, wherever alpha is not 0.
    white, exposure
        Gains, "auto" or "none" (`inverse.calibration`).
    model
        A name (`inverse.model_names`) or a `Model`.
    illuminant
        The light of the capture, a name or file that `colour.illuminant` takes.
    sigma
        Adds standard deviations and confidence where the model knows them.
    steady
        Lets models that can look at neighbours, so that melanin type and oxygenation keep still
        (`inverse.steady`); without, every texel is found by itself.

    Raises
    ------
    CutisError
        For arrays of other shapes, NaN or infinite colours, and masks that are empty or of another
        size. For an (n, 3) list of colours use `cutis.load_model().encode`.
    """
    if isinstance(face, str | os.PathLike):
        face = read_texture(face)
    used, capture = load_model(model), in_memory(face, mask)
    used = used if steady else used.alone

    known = survey([lambda: _Open(capture)], used, white, exposure, illuminant)
    maps = {name: np.zeros(capture.shape, np.float32) for name in NAMES}
    spread: dict[str, Map] = {}
    sure: Map | None = None
    for rows, part in estimate_bands(capture, used, known, sigma=sigma):
        for name, values in part.maps.values.items():
            maps[name][rows] = values
        for name, values in part.sigmas.items():
            spread.setdefault(name, np.zeros(capture.shape, np.float32))[rows] = values
        if part.confidence is not None:
            sure = np.zeros(capture.shape, np.float32) if sure is None else sure
            sure[rows] = part.confidence
    notes = source_note(face) if isinstance(face, Texture) else {}
    return Estimate(
        Maps(maps, capture.cover), MadeBy.of(used), known.calibration, spread, sure,
        capture.colours, notes, known.state,
    )  # fmt: skip


class _Open:
    """A capture that is open anyway, as a context manager."""

    def __init__(self, capture: Capture) -> None:
        self._capture = capture

    def __enter__(self) -> Capture:
        return self._capture

    def __exit__(self, *_: object) -> None:
        pass


def _texels(captures: Sequence[Callable[[], Any]]) -> int:
    total = 0
    for opened in captures:
        with opened() as capture:
            total += capture.shape[0] * capture.shape[1]
    return total


def _look(
    captures: Sequence[Callable[[], Any]], asked: Survey, calibration: Calibration | None,
    progress: Progress, doing: str,
) -> None:  # fmt: skip
    """Shows everything to a survey, until it has seen enough."""
    while not asked.enough():
        total, done = _texels(captures), 0
        for opened in captures:
            with opened() as capture:
                for rows in capture.bands():
                    colours, cover = capture.rows(rows)
                    if calibration is not None:
                        colours = calibration.apply(colours)
                    asked.add(rows.start, colours, cover)
                    done += cover.size
                    progress(done, total, doing)


def _found(
    capture: Capture, model: Model, known: Surveyed, sigma: bool
) -> Iterator[tuple[slice, Map, Map, Found]]:
    """Rows, their colours as captured, cover, and what the model finds in them."""
    state = {**known.state, "rounding": capture.rounding}
    if model.reach == 0:
        for rows in capture.bands():
            colours, cover = capture.rows(rows)
            seen = known.calibration.apply(colours)
            yield rows, colours, cover, model.estimate(seen, cover, state, sigma=sigma)
        return
    held: list[tuple[Map, Map]] = []  # bands that are read, from row `first` on
    first = read = 0
    waiting: list[slice] = []
    height = capture.shape[0]
    for rows in capture.bands():
        held.append(capture.rows(rows))
        read = min(rows.stop, height)
        waiting.append(slice(rows.start, read))
        while waiting and (read == height or read >= waiting[0].stop + model.reach):
            wanted = waiting.pop(0)
            top = max(0, wanted.start - model.reach)
            top -= top % model.grid
            bottom = min(height, wanted.stop + model.reach)
            while held and first + len(held[0][1]) <= top:
                first += len(held.pop(0)[1])
            colours, cover = (np.concatenate(parts) for parts in zip(*held, strict=True))
            wide = slice(top - first, bottom - first)
            seen = known.calibration.apply(colours[wide])
            found = model.estimate(seen, cover[wide], state, sigma=sigma)
            own = slice(wanted.start - first, wanted.stop - first)
            inner = slice(wanted.start - top, wanted.stop - top)
            yield wanted, colours[own], cover[own], found.rows(inner)
