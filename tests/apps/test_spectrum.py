"""`cutis spectrum`: tables with the promised columns."""

import csv
import io

import numpy as np

from cutis.albedo import albedo_space
from cutis.optics import WAVELENGTHS, skin


def table(text):
    return list(csv.reader(io.StringIO(text)))


def test_one_skin(cutis, tmp_path):
    out = tmp_path / "skin.csv"
    ended = cutis(
        "spectrum", "--melanin", "0.02", "--blood", "0.01", "--thickness", "80", "-o", out
    )
    assert (ended.code, ended.err) == (0, "")
    header, *rows = table(out.read_text("utf-8"))
    assert header == ["wavelength_nm", "reflectance"]
    assert [float(row[0]) for row in rows] == list(range(380, 781, 10))
    expected = albedo_space().reflectance(skin({"melanin": 0.02, "blood": 0.01, "thickness": 80}))
    np.testing.assert_allclose([float(row[1]) for row in rows], expected, atol=1e-6)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["skin.csv", "skin.plot.png"]
    assert f"wrote {out} and {out.with_suffix('.plot.png')}" in ended.out


def test_without_output_it_is_printed(cutis, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    ended = cutis("spectrum", "--quiet")
    assert (ended.code, ended.err) == (0, "")
    assert len(table(ended.out)) == 42
    assert list(tmp_path.iterdir()) == []


def test_many_skins(cutis, tmp_path):
    source = tmp_path / "skins.csv"
    source.write_text(
        '\ufeff# made by hand\nname, melanin,blood\n\nanna,0.02,0.01\n"ben, jr",0.2,0.05\n', "utf-8"
    )
    out = tmp_path / "out.csv"
    ended = cutis("spectrum", source, "-o", out, "-q")
    assert (ended.code, ended.out, ended.err) == (0, "", "")
    header, *rows = table(out.read_text("utf-8"))
    assert header == ["name", "melanin", "blood", *(f"{lam:g}" for lam in WAVELENGTHS)]
    assert [row[:3] for row in rows] == [["anna", "0.02", "0.01"], ["ben, jr", "0.2", "0.05"]]
    for row in rows:
        expected = albedo_space().reflectance(
            skin({"melanin": float(row[1]), "blood": float(row[2])})
        )
        np.testing.assert_allclose(np.array(row[3:], float), expected, atol=1e-6)


def test_a_misspelled_column_is_named(cutis, one_line, tmp_path):
    skins = tmp_path / "skins.csv"
    skins.write_text("melanine,blood\n0.02,0.01\n")
    line = one_line(cutis("spectrum", skins, "-o", tmp_path / "spectra.csv"))
    assert "'melanine'" in line
    assert "melanin?" in line
