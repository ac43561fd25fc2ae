"""ENVI spectral libraries: tables, named by header or values."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.spectra import is_table, open_cube, open_table

SKINS = np.array([[0.2, 0.3, 0.4], [0.1, 0.2, 0.3]], np.float32)


def library(folder, values=SKINS, ending=".sli", **fields):
    (folder / f"lib{ending}").write_bytes(values.astype("<f4").tobytes())
    header = {
        "samples": values.shape[1], "lines": len(values), "bands": 1, "header offset": 0,
        "file type": "ENVI Spectral Library", "data type": 4, "interleave": "bsq",
        "byte order": 0, "wavelength units": "Micrometers", "spectra names": "{arm,\n cheek}",
        "wavelength": "{0.4, 0.5, 0.6,}", **fields,
    }  # fmt: skip
    text = "\n".join(f"{k} = {v}" for k, v in header.items() if v is not None)
    (folder / "lib.hdr").write_text("ENVI\n" + text)
    return folder / "lib.hdr"


@pytest.mark.parametrize("ending", [".sli", "", ".lib"])
def test_a_library_is_a_table(tmp_path, ending):
    header = library(tmp_path, ending=ending)
    for path in (header, tmp_path / f"lib{ending}") if ending else (header,):
        assert is_table(path)
        found = open_table(path)
        assert found.labels == [["arm"], ["cheek"]]
        np.testing.assert_allclose(found.wavelengths, [400, 500, 600])
        np.testing.assert_allclose(found.values, SKINS)
        assert found.scale(np.ones(3, bool))[0].tolist() == [[1], [1]]


def test_what_its_header_says_counts(tmp_path):
    values = SKINS * 10000
    values[0, 1] = -1
    path = library(tmp_path, values, **{"data ignore value": -1, "spectra names": None,
                                        "reflectance scale factor": 10000})  # fmt: skip
    found = open_table(path)
    assert found.labels == [["1"], ["2"]]
    assert np.isnan(found.values[0, 1])
    factor, notes = found.scale(np.ones(3, bool))
    np.testing.assert_allclose(factor, 1e-4)
    assert notes == ["the header says that 10000 means 1"]


def test_tables_and_cubes_are_told_apart(tmp_path, write_envi):
    cube = write_envi(tmp_path / "cube.hdr", np.full((2, 3, 3), 0.3))
    assert not is_table(cube)
    assert not is_table(tmp_path / "cube.img")
    assert not is_table(tmp_path / "a.exr")
    assert is_table(tmp_path / "a.CSV")
    assert is_table(tmp_path / "gone.sli")
    with pytest.raises(CutisError, match="is a spectral library, a table"):
        open_cube(library(tmp_path))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"wavelength": "{0.4, 0.5}"}, "2 wavelengths are given for spectra of 3 values"),
        ({"wavelength": None}, "does not say its wavelengths"),
        ({"bands": 3, "lines": 1, "samples": 2}, "a library of 3 bands"),
        ({"lines": 9}, "header claims"),
        ({"wavelength units": "Wavenumber"}, "wavelengths in wavenumber are not known"),
    ],
)
def test_damage_is_one_line(tmp_path, fields, words):
    with pytest.raises(CutisError, match=words) as caught:
        open_table(library(tmp_path, **fields))
    assert len(str(caught.value).splitlines()) == 1
