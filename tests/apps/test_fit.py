"""`cutis fit`: tables in both forms, holes, and what is no table of spectra."""

import csv

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.apps.spectra_table import read_spectra
from cutis.errors import CutisError
from cutis.optics import NAMES, WAVELENGTHS

SKINS = np.array([[0.02, 0.01, 80, 0.7, 0.7], [0.1, 0.03, 60, 0.6, 0.6], [0.3, 0.02, 90, 0.8, 0.7]])


@pytest.fixture
def spectra():
    return albedo_space().reflectance(SKINS)


def by_rows(path, spectra):
    lines = ["# measured", "subject,site," + ",".join(f"{w:g}" for w in WAVELENGTHS)]
    for number, values in enumerate(spectra):
        lines.append(f"S{number},arm," + ",".join(f"{v:.6f}" for v in values))
    path.write_text("\n".join(lines) + "\n")


def by_columns(path, spectra):
    lines = ["wavelength_nm," + ",".join(f"S{n}" for n in range(len(spectra)))]
    for wavelength, values in zip(WAVELENGTHS, spectra.T, strict=True):
        lines.append(f"{wavelength:g}," + ",".join(f"{v:.6f}" for v in values))
    path.write_text("\n".join(lines) + "\n")


def table(path):
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("write", [by_rows, by_columns])
def test_skins_come_back(cutis, tmp_path, spectra, write):
    write(tmp_path / "in.csv", spectra)
    ended = cutis("fit", tmp_path / "in.csv", "-o", tmp_path / "out.csv")
    assert (ended.code, ended.err) == (0, "")
    assert "3 spectra, rmse 0.00" in ended.out
    rows = table(tmp_path / "out.csv")
    assert [row["subject" if write is by_rows else "spectrum"] for row in rows] == [
        "S0",
        "S1",
        "S2",
    ]
    for row, skin in zip(rows, SKINS, strict=True):
        for name, value in zip(NAMES, skin, strict=True):
            assert abs(float(row[name]) - value) < 4 * float(row[f"{name}.sigma"])
        assert float(row["rmse"]) < 3e-4


def test_holes_are_left_out(cutis, tmp_path, spectra):
    spectra[1, 5:9] = np.nan
    spectra[2, 4:] = np.nan
    by_rows(tmp_path / "in.csv", spectra)
    ended = cutis("fit", tmp_path / "in.csv", "-o", tmp_path / "out.csv")
    assert ended.code == 0
    assert "1 spectra have fewer values" in ended.out
    rows = table(tmp_path / "out.csv")
    assert float(rows[1]["melanin"]) == pytest.approx(0.1, rel=0.2)
    assert rows[2]["melanin"] == "nan"


def test_without_a_name_it_is_printed(cutis, tmp_path, spectra):
    by_columns(tmp_path / "in.csv", spectra)
    ended = cutis("fit", tmp_path / "in.csv", "--from", "400", "--to", "700")
    assert ended.code == 0
    assert ended.out.startswith("spectrum,melanin,blood")


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "needs a header"),
        ("a,b\n1,2\n", "wavelength_nm"),
        ("wavelength_nm,S1\n400,0.4\n410\n", "row 2: 1 cells"),
        ("wavelength_nm,S1\n400,0.4\n410,high\n", "'high' is not a number"),
        ("wavelength_nm,S1\n400,0.4\n,0.4\n", "a wavelength is missing"),
        ("wavelength_nm,S1\n" + "".join(f"{w},40\n" for w in range(400, 500, 10)), "per cent"),
        ("wavelength_nm,S1\n" + "".join(f"0.{w},0.4\n" for w in range(400, 500, 10)), "µm"),
        ("wavelength_nm,S1\n" + "400,0.4\n" * 9, "larger than the last"),
        ("wavelength_nm,S1\n400,0.4\n410,0.4\n", "too few"),
    ],
)
def test_what_is_no_table_of_spectra(cutis, tmp_path, text, what):
    (tmp_path / "in.csv").write_text(text)
    ended = cutis("fit", tmp_path / "in.csv", "-o", tmp_path / "out.csv")
    assert ended.code == 1
    assert what in ended.err, ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "out.csv").exists()


def test_names_of_wavelengths(tmp_path):
    (tmp_path / "a.csv").write_text("id,R410,R400,700nm\nx,0.2,0.1,0.3\n")
    found = read_spectra(tmp_path / "a.csv")
    np.testing.assert_array_equal(found.wavelengths, [400, 410, 700])
    np.testing.assert_array_equal(found.spectra, [[0.1, 0.2, 0.3]])
    assert (found.labels, found.cells) == (("id",), (("x",),))
    with pytest.raises(CutisError, match="no such file"):
        read_spectra(tmp_path / "none.csv")
