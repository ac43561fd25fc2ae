"""How measured faces, arms, hands and palms change from light people to dark ones.

Everything is in log linear sRGB under D65 of skin without its surface, over the person's ITA°: that
of the median of the face's sites. Per band of ITA° a local line through persons, weighted by a
Gaussian of WIDTH, gives the path; what is left of them the spread between persons; the medians of
persons' own standard deviations with the mean of their correlations the spread within a face.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import ita, reflectance_to_rgb
from studies.figures.measured import BANDS, SURFACE, lines_of

SITES = {"face": (2, 3, 4, 6, 8, 9), "arm": (7, 10), "hand": (1,), "palm": (11,)}
"""Places by the archive's `location` [issa2025]: cheek, cheekbone, chin, forehead, neck, nose tip;
inner and outer arm; back of the hand; palm."""
WIDTH = 8.0
"""Degrees."""
ENDS = (-58.0, 52.0)
"""Beyond these, where few persons are, the line goes on."""
GRID = np.arange(-80.0, 75.0, 2.0)
LEAST = 3
"""Sites that a face must have."""
DARKEST = 4e-3

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sites:
    """Measured sites: log RGB (n, 3), place (n,) of the archive, person (n,), age class (n,)."""

    colours: Array
    places: NDArray[np.intp]
    persons: NDArray[np.str_]
    ages: NDArray[np.intp]

    def some(self, rows: NDArray[np.bool_]) -> "Sites":
        """Those of some rows."""
        return Sites(self.colours[rows], self.places[rows], self.persons[rows], self.ages[rows])


@dataclass(frozen=True, eq=False)
class Persons:
    """Persons with enough sites: ITA° (n,), median log RGB (n, 3), covariance of sites (n, 3, 3),
    standard deviation of their ITA° (n,)."""

    names: NDArray[np.str_]
    ita: Array
    colours: Array
    within: Array
    spread: Array


@dataclass(frozen=True, eq=False)
class Path3:
    """On GRID: log RGB (g, 3), covariances between persons and within a face (g, 3, 3), the
    standard deviation of ITA° within a face (g,), and how many persons count (g,)."""

    colours: Array
    between: Array
    within: Array
    spread: Array
    count: Array


def read_sites(data: Path) -> Sites:
    """Plausible records of the archive's half at hand."""
    rows = [
        row
        for row in csv.DictReader(lines_of(data / "spectra" / "measured" / "issa_half_a.csv"))
        if row["qc"] == "0" and all(row[f"{band:g}"] for band in BANDS)
    ]
    spectra = np.array([[float(row[f"{band:g}"]) for band in BANDS] for row in rows])
    rgb = reflectance_to_rgb((spectra - SURFACE) / (1 - SURFACE), BANDS)
    return Sites(
        np.log(np.maximum(rgb, DARKEST)).astype(float),
        np.array([int(row["location"]) for row in rows]),
        np.array([f"{row['origin']}-{row['subject']}" for row in rows]),
        np.array([int(row["age"] or 0) for row in rows]),
    )


def persons_of(sites: Sites) -> Persons:
    """Persons by their faces."""
    on_face = np.isin(sites.places, SITES["face"])
    names, colours, within, spread = [], [], [], []
    for name in np.unique(sites.persons[on_face]):
        rows = on_face & (sites.persons == name)
        places = np.unique(sites.places[rows])
        if len(places) < LEAST:
            continue
        each = np.array([
            np.median(sites.colours[rows & (sites.places == place)], axis=0) for place in places
        ])  # fmt: skip
        names.append(name)
        colours.append(np.median(each, axis=0))
        within.append(np.cov(each.T))
        spread.append(np.std(ita(np.exp(each)), ddof=1))
    medians = np.array(colours)
    tones = ita(np.exp(medians)).astype(float)
    return Persons(np.array(names), tones, medians, np.array(within), np.array(spread))


def path_of(sites: Sites, persons: Persons, place: str) -> Path3:
    """The path of a place of SITES."""
    tones, colours = persons.ita, persons.colours
    if place != "face":
        tones, colours = _elsewhere(sites, persons, SITES[place])
    found = [_at(middle, tones, colours, persons) for middle in GRID]
    return Path3(*(np.array(column) for column in zip(*found, strict=True)))


def _elsewhere(sites: Sites, persons: Persons, places: tuple[int, ...]) -> tuple[Array, Array]:
    """Of persons that have the place: ITA° of their face, log RGB of the place."""
    tones, colours = [], []
    there = np.isin(sites.places, places)
    for name, tone in zip(persons.names, persons.ita, strict=True):
        rows = there & (sites.persons == name)
        if rows.any():
            tones.append(tone)
            colours.append(np.median(sites.colours[rows], axis=0))
    return np.array(tones), np.array(colours)


def _at(
    middle: float, tones: Array, colours: Array, persons: Persons
) -> tuple[Array, Array, Array, float, float]:
    near = float(np.clip(middle, *ENDS))
    weight = np.exp(-0.5 * ((tones - near) / WIDTH) ** 2)
    line = np.stack([np.ones(len(tones)), tones - near], axis=1)
    root = np.sqrt(weight)[:, None]
    fit = np.linalg.lstsq(line * root, colours * root, rcond=None)[0]
    left = colours - line @ fit
    between = (left * weight[:, None]).T @ left / weight.sum()
    count = weight.sum() ** 2 / (weight**2).sum()
    own = np.exp(-0.5 * ((persons.ita - near) / WIDTH) ** 2)
    deviations = np.sqrt(np.diagonal(persons.within, axis1=1, axis2=2))
    correlation = np.tensordot(
        own / own.sum(), persons.within / deviations[:, :, None] / deviations[:, None, :], 1
    )
    medians = np.array([_median(deviations[:, k], own) for k in range(3)])
    within = correlation * np.outer(medians, medians)
    spread = _median(persons.spread, own)
    return fit[0] + fit[1] * (middle - near), between, within, spread, count


def _median(values: Array, weight: Array) -> float:
    order = np.argsort(values)
    total = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(total, 0.5 * total[-1])])
