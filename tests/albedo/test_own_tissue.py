"""A tissue with absorbers more, made of a few rows: all that follows, against the solver."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from cutis.albedo import AlbedoSpace, SkinSimulation, Walks, albedo_space, spectral_table
from cutis.albedo.spectral_table import axis_ranges, load, save
from cutis.colour import spectrum_to_rgb
from cutis.errors import CutisError
from cutis.inverse import explain, fit_spectra
from cutis.optics import ALIAGA2022, GITLINA2020, WAVELENGTHS, Absorber, Parameter, Tissue
from cutis.transport import two_layer_albedo

HAIR = Parameter("hair", "V_hair", "hair shafts in the dermis", "1", 0.0, 0.05, 1)
INK = Parameter("ink", "c", "ink in the epidermis", "g/L", 0.0, 2.0, 2)
COLOUR = ((300, 20.0), (550, 2.0), (800, 30.0))
TISSUE = replace(
    ALIAGA2022,
    name="bearded",
    absorbers=(
        Absorber("eumelanin", "dermis", ("hair",), amount=0.8),
        Absorber("pheomelanin", "dermis", ("hair",), amount=0.2),
        Absorber(
            "ink",
            "epidermis",
            ("ink",),
            room=False,
            spectrum=((300, 20.0), (550, 2.0), (800, 30.0)),
        ),
    ),
    more=(HAIR, INK),
)
SKINS = np.array(
    [
        [0.02, 0.02, 80.0, 0.7, 0.7, 0.0, 0.0],
        [0.03, 0.05, 120.0, 0.4, 0.6, 0.02, 0.0],
        [0.1, 0.01, 60.0, 0.9, 0.8, 0.045, 0.3],
        [0.05, 0.1, 200.0, 0.2, 0.3, 0.01, 1.5],
    ]
)
DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def space() -> AlbedoSpace:
    return albedo_space(TISSUE)


def by_hand(skin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """μa of both layers by the formulae of the docs."""
    melanin, blood, _, eumelanin, oxygenation, hair, ink = skin
    lam, t = WAVELENGTHS, ALIAGA2022
    none, full = t.whole_blood(lam)
    pigment = eumelanin * t.eumelanin(lam) + (1 - eumelanin) * t.pheomelanin(lam)
    colour = np.interp(lam, [300, 550, 800], [20.0, 2.0, 30.0])
    epidermis = melanin * pigment + (1 - melanin) * t.epidermis_background(lam) + ink * colour
    shafts = 0.8 * t.eumelanin(lam) + 0.2 * t.pheomelanin(lam)
    whole = oxygenation * full + (1 - oxygenation) * none
    dermis = blood * whole + hair * shafts + (1 - blood - hair) * t.baseline(lam)
    return epidermis, dermis


def exact(skin: np.ndarray) -> np.ndarray:
    """(41,) albedo by the solver."""
    epidermis, dermis = by_hand(skin)
    scattering, g = TISSUE.scattering(WAVELENGTHS), TISSUE.anisotropy(WAVELENGTHS)
    return np.array(
        [
            two_layer_albedo([e], [d], [skin[2]], float(mu), float(cos), count=32)[0, 0, 0]
            for e, d, mu, cos in zip(epidermis, dermis, scattering, g, strict=True)
        ]
    )


def test_absorption_is_the_formula():
    for skin in SKINS:
        values = dict(zip((p.name for p in TISSUE.parameters), skin, strict=True))
        for layer, expected in zip(("epidermis", "dermis"), by_hand(skin), strict=True):
            got = TISSUE.absorption(layer, values, WAVELENGTHS)
            np.testing.assert_allclose(got, expected, rtol=1e-12)


def test_spectra_and_colours_are_those_of_the_solver(space):
    expected = np.array([exact(skin) for skin in SKINS])
    np.testing.assert_allclose(space.reflectance(SKINS), expected, atol=2e-5)
    colours = expected @ spectrum_to_rgb(WAVELENGTHS)
    np.testing.assert_allclose(space.rgb(SKINS), colours, atol=2e-5)


def test_without_its_absorbers_it_is_the_tissue_it_came_from(space):
    plain = albedo_space(ALIAGA2022).reflectance(SKINS[:1, :5])
    np.testing.assert_allclose(space.reflectance(SKINS[:1]), plain, atol=5e-6)


@pytest.mark.parametrize("row", [1, 2, 3])
def test_slopes_are_those_of_the_solver(space, row):
    skin = SKINS[row]
    _, slope = space.rgb_gradient(skin)
    to_rgb = spectrum_to_rgb(WAVELENGTHS)
    for p, step in enumerate([1e-4, 1e-4, 0.3, 1e-2, 1e-2, 1e-3, 1e-3]):
        move = np.eye(7)[p] * min(step, skin[p] / 2 or step)
        if p == 6 and skin[p] == 0:
            difference = exact(skin + move) - exact(skin)
        else:
            difference = (exact(skin + move) - exact(skin - move)) / 2
        np.testing.assert_allclose(slope[:, p] * move[p], difference @ to_rgb, rtol=0.02, atol=2e-6)


def test_fits_find_the_skins_again(space):
    spectra = np.array([exact(skin) for skin in SKINS[1:]])
    found = fit_spectra(spectra, WAVELENGTHS, TISSUE)
    assert [p.name for p in found.parameters][5:] == ["hair", "ink"]
    assert found.rmse.max() < 2e-5
    away = np.abs(found.values - SKINS[1:])
    assert np.all(away[:, 5] < 3e-3)
    assert np.all(away[:, 6] < 0.05)
    held = fit_spectra(spectra, WAVELENGTHS, TISSUE, held={"hair": 0.0})
    assert held.rmse[1] > 10 * found.rmse[1]


def test_colours_are_explained(space):
    colours = space.rgb(SKINS)
    maps, model = explain(colours, TISSUE)
    assert set(maps) == {p.name for p in TISSUE.parameters}
    np.testing.assert_allclose(model, colours, atol=2e-3)


def test_walks_agree_within_their_error(space):
    """At a level of 10⁻³ over all bands of three skins."""
    simulation = SkinSimulation(SKINS[1:], Walks(TISSUE, photons=3000, seed=5))
    parts = [simulation.compute(i) for i in range(simulation.batches)]
    mean, error = simulation.assemble(parts)
    z = (mean - space.reflectance(SKINS[1:])) / error
    assert np.abs(z).max() < norm.isf(1e-3 / 2 / z.size)


def test_it_is_stored_with_its_table(space, tmp_path):
    save(spectral_table(TISSUE), str(tmp_path / "own.npz"))
    again = load(str(tmp_path / "own.npz"))
    assert again.tissue == TISSUE
    for ends, same in zip(axis_ranges(TISSUE), (again.low, again.high), strict=True):
        np.testing.assert_array_equal(ends, same)


def test_ranges_cover_every_skin():
    low, high = axis_ranges(TISSUE)
    rng = np.random.default_rng(1)
    u = rng.random((500, 7)).round(rng.integers(0, 3))
    values = {p.name: p.from_coordinate(u[:, i]) for i, p in enumerate(TISSUE.parameters)}
    for axis, layer in enumerate(("epidermis", "dermis")):
        root = TISSUE.absorption(layer, values, WAVELENGTHS) ** 0.25
        assert np.all((root >= low[:, axis] - 1e-12) & (root <= high[:, axis] + 1e-12))


def test_the_script_of_the_docs(monkeypatch):
    """As printed, of the paper's tissue, whose table takes seconds and not half a minute."""
    text = (DOCS / "own_tissue.md").read_text("utf-8")
    script = re.search(r"```python\n(.*?)```", text, re.S)[1]
    assert len(script.splitlines()) <= 15
    monkeypatch.setattr("cutis.optics.MEASURED2026", ALIAGA2022)
    names: dict = {}
    exec(compile(script, "own_tissue.md", "exec"), names)
    assert names["spectra"].shape == (3, 41)
    assert np.all(np.diff(names["spectra"], axis=0) < 0)  # hair absorbs everywhere
    np.testing.assert_allclose(names["found"].values[:, 5], [0.0, 0.01, 0.03], atol=4e-3)
    np.testing.assert_allclose(names["model"], names["colours"], atol=2e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda: replace(TISSUE, name="odd", baseline_scale=-1.0), "tissue odd.*negative.*nm"),
        (lambda: replace(TISSUE, name="odd", scattering_500=0.0), "tissue odd.*epidermis.*scatter"),
        (lambda: replace(TISSUE, name="odd", anisotropy_offset=2.0), "tissue odd.*anisotropy"),
        (lambda: replace(TISSUE, name="odd", dermis_scattering=0.0), "odd: dermis_scattering"),
        (
            lambda: _with(Absorber("ink", "dermis", ("ink",), spectrum=((380, 1.0), (700, 2.0)))),
            "tissue odd.*ink.*380 to 700 nm.*lacks",
        ),
        (
            lambda: _with(Absorber("ink", "dermis", ("ink",), spectrum=((380, 1.0), (780, -2.0)))),
            "tissue odd.*ink.*dermis.*negative",
        ),
        (lambda: _with(Absorber("eumelanin", "dermis", ("beard",))), "odd.*'beard'.*no parameter"),
        (lambda: _with(Absorber("paint", "dermis", ("ink",))), "paint: no such substance"),
        (lambda: _with(Absorber("eumelanin", "bone", ("ink",))), "epidermis or dermis"),
        (
            lambda: _with(Absorber("a", "dermis", ("ink",), spectrum=((780, 1.0), (380, 1.0)))),
            "a: the wavelengths .* increase",
        ),
        (lambda: _with(Absorber("eumelanin", "dermis", ("ink",), amount=-1)), "not negative"),
        (lambda: replace(TISSUE, more=(HAIR, INK, INK)), "two parameters are called ink"),
        (lambda: replace(TISSUE, more=(HAIR, INK, replace(INK, name="melanin"))), "called melanin"),
        (lambda: Parameter("x", "x", "x", "1", 1.0, 0.5, 1), "parameter x.*rise"),
    ],
)
def test_what_is_no_tissue_is_refused_by_name(change, message):
    with pytest.raises(CutisError, match=message):
        albedo_space(change())


def _with(absorber: Absorber) -> Tissue:
    return replace(TISSUE, name="odd", absorbers=(*TISSUE.absorbers, absorber))


def test_blood_above_goes_with_absorbers_too():
    """Another tissue of another table: the rows add up."""
    tissue = replace(GITLINA2020, name="g", absorbers=TISSUE.absorbers, more=TISSUE.more)
    recipe, above, below = tissue.mixture(WAVELENGTHS)
    assert recipe.shape == (2 + 2 + 1 + 2 + 2, 5 + 1 + 2)
    assert (len(above), len(below)) == (1 + 5, 1 + 4)
