"""The tool that writes docs/validation.md, on a few skins."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cutis.colour import spectrum_to_rgb
from studies.figures.measured import BANDS, read_skins

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def tools():
    """The modules of the tool."""
    from studies import validation, validation_plots, validation_study

    return validation, validation_plots, validation_study


@pytest.fixture(scope="module")
def few(shared_data):
    """About thirty skins of every band of ITA°, of three origins, and all of NIST."""
    skins, rng = read_skins(shared_data), np.random.default_rng(3)
    some = np.isin(skins.origins, (1, 4, 8))
    rows = [rng.permutation(np.flatnonzero(some & (skins.bands == band)))[:30] for band in range(6)]
    forearms = np.flatnonzero(skins.groups == "NIST")
    return skins.some(np.unique(np.concatenate([*rows, forearms])))


@pytest.fixture(scope="module")
def found(tools, few):
    return tools[2].study(few, per_band=20, models=("measured2026b", "aliaga2022-exact"))


def unseen(skins, rows):
    """The skins with other spectra of the same RGB in `rows`."""
    to_rgb, rng = spectrum_to_rgb(BANDS), np.random.default_rng(0)
    noise = 0.02 * rng.standard_normal((rows.sum(), len(BANDS)))
    noise -= noise @ to_rgb @ np.linalg.pinv(to_rgb)
    spectra = skins.spectra.copy()
    spectra[rows] += noise
    return replace(skins, spectra=spectra)


@pytest.mark.slow
def test_page_has_a_place_for_every_table_and_plot(tools, found, tmp_path):
    from PIL import Image

    tables, page = tools[0].tables(found), (ROOT / "docs" / "validation.md").read_text("utf-8")
    for name, table in tables.items():
        assert page.count(f"<!-- {name} -->") == page.count(f"<!-- /{name} -->") == 1
        assert "nan" not in table
    assert page.count("<!-- ") == 2 * len(tables)
    tools[1].draw(found, tmp_path)
    for plot in tools[1].PLOTS:
        assert f"(images/validation-{plot}.png)" in page
        path = tmp_path / f"validation-{plot}.png"
        with Image.open(path) as image:
            assert image.width == 900
        assert path.stat().st_size < 150_000


@pytest.mark.slow
def test_what_knows_skin_is_nearer_to_it(found):
    of = found.issa
    median = {name: np.median(found.rmse(spectra)[of]) for name, spectra in found.implied.items()}
    learned = median["cutis `measured2026b`, subjects left out"]
    assert learned < 0.6 * median["cutis `aliaga2022-exact`, as shipped"]
    assert learned < 0.3 * median["Jakob & Hanika 2019"] < 0.3 * median["Mallett & Yuksel 2019"]
    fits = [found.rmse(found.fits[name])[of].mean() for name in ("measured2026b", "aliaga2022")]
    assert fits[0] < 0.6 * fits[1]
    assert 0.8 < found.inside(found.held["subject"])[of].mean() < 0.97
    assert 0.8 < found.inside(found.held["shipped"])[of].mean() < 0.97
    light = found.relit(found.implied["cutis `measured2026b`, subjects left out"], "A")
    assert np.median(light) < 1


@pytest.mark.slow
def test_priors_see_nothing_of_the_part_left_out(tools, few):
    parts = few.origins % 2
    left_out = tools[2].left_out
    before, intervals = left_out(few, parts, 20, "origin")
    after, changed = left_out(unseen(few, parts == 0), parts, 20, "origin")
    assert np.abs(after - before)[parts == 0].max() < 1e-5
    assert np.allclose(changed.sigma[parts == 0], intervals.sigma[parts == 0], rtol=1e-3)
    assert np.abs(after - before)[parts == 1].max() > 1e-4


def test_regression_sees_nothing_of_the_origin_left_out(tools, few):
    rows = few.origins == 4
    before, after = (tools[2].regression(s, few.origins) for s in (few, unseen(few, rows)))
    assert np.abs(after - before)[rows].max() < 1e-9
    assert np.abs(after - before)[~rows].max() > 1e-4


def test_folds_keep_subjects_together(tools, few):
    folds = tools[2].subject_folds(few)
    assert set(folds) == set(range(tools[2].FOLDS))
    assert all(len(set(folds[few.subjects == s])) == 1 for s in few.subjects)


def test_intervals_reach_as_far_as_they_say(tools, few):
    study = tools[2].Study(few.some([0, 1]), 1)
    study.true = np.array([[0.0] * 5, [0.0] * 5])
    held = tools[2].Held(np.array([[1.64] * 5, [1.65] * 5]), np.ones((2, 5)), np.ones((2, 5)))
    assert study.inside(held).tolist() == [[True] * 5, [False] * 5]
    assert study.inside(held, 0.8).sum() == 0


def test_jakob_hanika_is_that_of_colour_science(tools):
    from colour.recovery import XYZ_to_sd_Jakob2019

    from cutis.colour.spectra import XYZ_TO_SRGB

    colours = np.array([[0.45, 0.28, 0.19], [0.06, 0.035, 0.022], [0.7, 0.5, 0.42]])
    found = tools[2].jakob_hanika(colours)
    assert np.abs(found @ spectrum_to_rgb(BANDS) - colours).max() < 1e-3
    for colour, spectrum in zip(colours, found, strict=True):
        known = XYZ_to_sd_Jakob2019(np.linalg.inv(XYZ_TO_SRGB) @ colour)
        assert np.abs(np.interp(BANDS, known.wavelengths, known.values) - spectrum).max() < 1e-3


def test_mallett_is_taken_at_the_bands_of_the_archive(tools):
    colours = np.array([[0.45, 0.28, 0.19]])
    found = tools[2].mallett(colours)
    assert found.shape == (1, len(BANDS))
    assert np.abs(found @ spectrum_to_rgb(BANDS) - colours).max() < 0.01
