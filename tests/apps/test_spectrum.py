"""`cutis spectrum`: tables with the promised columns."""

import csv
import io

import numpy as np

from cutis.albedo import albedo_space
from cutis.optics import (
    ALIAGA2022,
    MEASURED2026,
    PARAMETERS,
    RARE,
    WAVELENGTHS,
    skin,
    with_rare_chromophores,
)


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
    expected = albedo_space(MEASURED2026).reflectance(
        skin({"melanin": 0.02, "blood": 0.01, "thickness": 80})
    )
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
        expected = albedo_space(MEASURED2026).reflectance(
            skin({"melanin": float(row[1]), "blood": float(row[2])})
        )
        np.testing.assert_allclose(np.array(row[3:], float), expected, atol=1e-6)


def test_a_misspelled_column_is_named(cutis, one_line, tmp_path):
    skins = tmp_path / "skins.csv"
    skins.write_text("melanine,blood\n0.02,0.01\n")
    line = one_line(cutis("spectrum", skins, "-o", tmp_path / "spectra.csv"))
    assert "'melanine'" in line
    assert "melanin?" in line


def test_the_tissue_can_be_chosen(cutis, one_line):
    ended = cutis("spectrum", "--melanin", "0.03", "--tissue", "aliaga2022")
    expected = albedo_space(ALIAGA2022).reflectance(skin({"melanin": 0.03}))
    got = [float(row[1]) for row in table(ended.out)[1:]]
    np.testing.assert_allclose(got, expected, atol=1e-6)
    line = one_line(cutis("spectrum", "--tissue", "mine"))
    assert "unknown tissue 'mine'; choose aliaga2022 or measured2026" in line


def test_rare_chromophores_are_flags_or_columns(cutis, one_line, tmp_path):
    space = albedo_space(with_rare_chromophores(MEASURED2026))
    some = {"melanin": 0.02, "bilirubin": 0.05, "methaemoglobin": 0.2}
    expected = space.reflectance(skin(some, (*PARAMETERS, *RARE)))
    flags = [part for name, value in some.items() for part in (f"--{name}", value)]
    got = [float(row[1]) for row in table(cutis("spectrum", *flags).out)[1:]]
    np.testing.assert_allclose(got, expected, atol=1e-6)
    skins = tmp_path / "skins.csv"
    skins.write_text("melanin,bilirubin,methaemoglobin\n0.02,0.05,0.2\n0.02,0,0\n")
    rows = table(cutis("spectrum", skins).out)[1:]
    np.testing.assert_allclose(np.array(rows[0][3:], float), expected, atol=1e-6)
    plain = albedo_space(MEASURED2026).reflectance(skin({"melanin": 0.02}))
    np.testing.assert_allclose(np.array(rows[1][3:], float), plain, atol=1e-4)
    assert "bilirubin = 3 is outside its range 0 to 0.2 g/L" in one_line(
        cutis("spectrum", "--bilirubin", "3")
    )
    line = one_line(cutis("simulate", skins, "-o", tmp_path / "walks.csv"))
    assert "bilirubin is not taken here" in line
