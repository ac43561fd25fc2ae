"""Figures are drawn from real maps and say what their numbers say."""

import re
from pathlib import Path

import numpy as np
import pytest

from cutis.errors import CutisError
from studies.figures import FIGURES, cast, lights, write_page
from studies.figures.measured import (
    BANDS,
    GROUPS,
    NIST,
    ORIGINS,
    SURFACE,
    measured_skins,
    read_skins,
)
from studies.figures.quantisation import roughness
from studies.figures.subjects import data_folder, every_face


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """The bundled capture alone, a few thousand texels of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("studies.figures.subjects.TALLEST", 70)
        patch.setenv("CUTIS_SHARED_DATA", str(tmp_path_factory.mktemp("nothing")))
        players = cast()
        assert players.data is None
        assert [s.name for s in players.subjects] == ["bioskin_capture1"]
        yield players


@pytest.fixture(scope="module")
def sections(small):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            lights, "TONES", {k: v for k, v in lights.TONES.items() if k != "intermediate"}
        )
        patch.setattr("studies.figures.baselines.MOST", 500)
        yield {name: draw(small) for name, draw in FIGURES.items()}


def numbers(section):
    """Rows of the section's tables as lists of cells."""
    lines = [line for line in section.table.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_figure_is_drawn(sections, tmp_path):
    page = write_page(list(sections.values()), tmp_path)
    text = page.read_text("utf-8")
    for name, section in sections.items():
        assert section.name == name
        assert f"## {section.words()[0]}" in text
        assert len(numbers(section)) > 2
    linked = set(re.findall(r"\(reproduction/([\w-]+\.jpg)\)", text))
    assert linked == {path.name for path in (tmp_path / "reproduction").iterdir()}
    assert all(path.stat().st_size > 5000 for path in (tmp_path / "reproduction").iterdir())
    assert "nan" not in text.replace("nano", "").lower().split()


def test_tensors_are_rough_and_networks_are_not(sections):
    table = {row[0]: row for row in numbers(sections["quantisation"])}
    tensor, network = float(table["tensor, 55k"][2]), float(table["network"][2])
    assert tensor > 1.5 * network
    assert int(table["tensor, 55k"][3]) < int(table["network"][3])


def test_reconstructions_are_ranked(sections):
    table = {row[1]: float(row[2]) for row in numbers(sections["reconstruction"])[2:]}
    assert table["exact"] < min(table["network"], table["tensor, 256k"]) < 1e-4
    km = {row[1]: float(row[2]) for row in numbers(sections["kubelka-munk"])[2:]}
    assert km["kubelka-munk"] > 100 * km["aliaga2022-exact"]


def test_edits_go_the_way_their_names_say(sections):
    rows = {row[1]: [float(v) for v in row[2:]] for row in numbers(sections["editing-grid"])[2:]}
    assert rows["blood × 3"][1] > 0 > rows["blood × 0.125"][1]
    assert rows["melanin × 5"][0] < rows["melanin × 3"][0] < rows["melanin × 1.5"][0] < 0


def test_gitlina_is_farther_from_the_capture(sections):
    table = {row[1]: float(row[2]) for row in numbers(sections["gitlina"])[2:]}
    assert table["gitlina2020"] > 2 * table["aliaga2022"]


def test_roughness_is_that_of_steps():
    ramp = np.tile(np.linspace(0.2, 0.4, 64)[None, :, None], (8, 1, 3))
    where = np.ones((8, 64), bool)
    stepped = np.round(ramp * 40) / 40
    assert roughness(ramp, where) < 1e-12
    assert roughness(stepped, where) > 1e-3


def test_measured_skins(shared_data):
    skins = measured_skins(shared_data)
    assert skins.shape[1] == len(BANDS)
    assert len(skins) > 7000
    assert -0.03 < skins.min() < skins.max() < 1
    assert 0.2 < np.median(skins[:, np.searchsorted(BANDS, 550)]) < 0.3


def test_measured_skins_say_who_they_are_of(shared_data):
    skins = read_skins(shared_data)
    assert skins.spectra.shape == (len(skins.subjects), len(BANDS))
    assert set(skins.origins) == set(ORIGINS)
    assert set(skins.groups) == set(GROUPS)
    assert (skins.origins == NIST).sum() == 50 == len(set(skins.subjects[skins.origins == NIST]))
    assert len(set(skins.subjects)) == 1054 + 50  # a person has one origin
    assert all(len(set(skins.origins[skins.subjects == s])) == 1 for s in set(skins.subjects))
    assert np.allclose(SURFACE + (1 - SURFACE) * measured_skins(shared_data), skins.spectra)
    first = skins.some([0, -1])
    assert list(first.origins) == [1, NIST]
    assert list(first.groups) == ["CA", "NIST"]
    assert first.spectra[0, 0] == 0.1712
    assert len(first.bands) == 2


def test_every_face_of_the_larger_data(shared_data):
    found = dict(every_face(shared_data, 300))
    assert len(found) == 13
    assert all(100 < len(colours) <= 300 for colours in found.values())


def test_the_larger_data_is_used_when_at_hand(shared_data, monkeypatch):
    monkeypatch.setattr("studies.figures.subjects.TALLEST", 40)
    players = cast(shared_data)
    assert [s.skin for s in players.subjects] == [
        "very light", "light", "intermediate", "brown", "dark"
    ]  # fmt: skip
    medians = [float(np.median(s.maps.melanin[s.texels])) for s in players.subjects]
    assert max(medians[:3]) < min(medians[3:])


def test_folders_without_data():
    with pytest.raises(CutisError, match="no folder albedo"):
        data_folder(Path("nowhere"))
