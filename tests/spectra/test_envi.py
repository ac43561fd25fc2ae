"""ENVI cubes: every order, type and ending comes back; damage is one line."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cutis.errors import CutisError
from cutis.spectra import open_cube

LAM = np.array([450.0, 500.0, 550.0, 600.0, 650.0, 700.0])


def cube(shape=(5, 4)):
    """(H, W, 6) values, no two alike."""
    return (np.arange(np.prod(shape) * len(LAM)).reshape(*shape, len(LAM)) + 1) / 256


@pytest.mark.parametrize("interleave", ["bsq", "bil", "bip"])
@pytest.mark.parametrize("dtype", ["<f4", ">f4", "<f8", "<u2", ">i2", "<i4", "<u1"])
def test_round_trip(write_envi, tmp_path, interleave, dtype):
    values = cube() if dtype[1] == "f" else np.rint(cube() * 256)
    path = write_envi(tmp_path / "face.hdr", values, interleave, dtype, offset=7)
    with open_cube(path) as file:
        assert file.shape == (5, 4)
        np.testing.assert_array_equal(file.wavelengths, LAM)
        np.testing.assert_array_equal(file.rows(slice(0, 5)), values.astype(np.float32))
        np.testing.assert_array_equal(file.rows(slice(2, 4)), values[2:4].astype(np.float32))
        assert not file.notes
    with open_cube(path.with_suffix(".img")) as file:  # named by its values
        np.testing.assert_array_equal(file.rows(slice(0, 1)), values[:1].astype(np.float32))


@pytest.mark.parametrize("ending", ["", ".raw", ".dat", ".bsq", ".IMG"])
def test_endings(write_envi, tmp_path, ending):
    with open_cube(write_envi(tmp_path / "a.hdr", cube(), ending=ending)) as file:
        assert file.shape == (5, 4)


def test_bands_of_rows_cover_the_cube(write_envi, tmp_path, monkeypatch):
    monkeypatch.setattr("cutis.spectra.spectral_cube.TEXELS", 8)
    with open_cube(write_envi(tmp_path / "a.hdr", cube())) as file:
        parts = [file.rows(rows) for rows in file.bands()]
        assert len(parts) == 3
        np.testing.assert_array_equal(np.concatenate(parts), cube().astype(np.float32))


def test_what_the_header_says_counts(write_envi, tmp_path):
    values = np.rint(cube() * 256)
    values[1, 2, 3] = 9999
    path = write_envi(
        tmp_path / "a.hdr", values, dtype="<i2",
        **{"data ignore value": 9999, "reflectance scale factor": 10000, "bbl": "{1,1,0,1,1,1}"},
    )  # fmt: skip
    with open_cube(path) as file:
        found = file.rows(slice(0, 5))
        assert file.scale == 10000
        assert np.isnan(found[1, 2, 3])
        assert np.isnan(found[..., 2]).all()
        assert np.isfinite(np.delete(found, 2, axis=-1)).sum() == 5 * 4 * 5 - 1
        assert "1 bands are marked as bad" in file.notes[0]


def test_micrometres_by_the_header(write_envi, tmp_path):
    listed = "{" + ",".join(f"{lam / 1e3:g}" for lam in LAM) + "}"
    fields = {"wavelength": listed, "wavelength units": "Micrometers"}
    with open_cube(write_envi(tmp_path / "a.hdr", cube(), **fields)) as file:
        np.testing.assert_allclose(file.wavelengths, LAM)


def test_wavelengths_from_elsewhere(write_envi, tmp_path):
    path = write_envi(tmp_path / "a.hdr", cube(), wavelength=None)
    with pytest.raises(CutisError, match="--wavelengths"):
        open_cube(path)
    (tmp_path / "w.txt").write_text("\n".join(f"{lam:g}" for lam in LAM))
    with open_cube(path, tmp_path / "w.txt") as file:
        np.testing.assert_array_equal(file.wavelengths, LAM)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"bands": 7}, "header claims"),
        ({"bands": 5}, "6 wavelengths are given for 5 bands"),
        ({"lines": None}, "does not say its lines"),
        ({"lines": "many"}, "does not say its lines"),
        ({"lines": 0}, "no texels"),
        ({"lines": -5}, "no texels"),
        ({"samples": 1 << 40}, "limit is"),
        ({"header offset": -4}, "header claims"),
        ({"data type": 6}, "data type 6"),
        ({"byte order": 3}, "byte order 3"),
        ({"interleave": "bsp"}, "not bsq, bil or bip"),
        ({"file compression": 1}, "compressed"),
        ({"wavelength": "{450, red}"}, "not numbers"),
        ({"wavelength": "{450, 500"}, "has no end"),
        ({"wavelength units": "Wavenumber"}, "not known"),
        ({"bbl": "{1,1}"}, "bad bands"),
        ({"data ignore value": "none"}, "not a number"),
    ],
)
def test_damaged_headers_are_one_line(write_envi, tmp_path, fields, words):
    path = write_envi(tmp_path / "a.hdr", cube(), **fields)
    with pytest.raises(CutisError, match=words) as raised:
        open_cube(path)
    assert "\n" not in str(raised.value)


def test_missing_halves(write_envi, tmp_path):
    path = write_envi(tmp_path / "a.hdr", cube())
    path.with_suffix(".img").unlink()
    with pytest.raises(CutisError, match="no file of values"):
        open_cube(path)
    (tmp_path / "b.raw").write_bytes(b"abc")
    with pytest.raises(CutisError, match="no ENVI header"):
        open_cube(tmp_path / "b.raw")
    (tmp_path / "b.hdr").write_bytes(b"RIFF\xff\x00")
    with pytest.raises(CutisError, match="no ENVI header"):
        open_cube(tmp_path / "b.raw")


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.dictionaries(
        st.sampled_from(
            ["lines", "samples", "bands", "header offset", "data type", "interleave", "byte order",
             "wavelength", "wavelength units", "bbl", "data ignore value"]
        ),
        st.one_of(
            st.integers(-(2**70), 2**70).map(str),
            st.sampled_from(["{", "{}", "{1,2}", "bsq", "nan", "1e999", "", "5", "µm"]),
            st.text(max_size=8).map(lambda text: text.replace("\n", " ")),
        ),
        max_size=3,
    )
)  # fmt: skip
def test_any_header_is_a_cube_or_one_line(write_envi, tmp_path, fields):
    path = write_envi(tmp_path / "a.hdr", cube(), **fields)
    said = ""
    try:
        with open_cube(path) as file:
            assert file.rows(slice(0, 1)).shape[-1] == len(file.wavelengths)
    except CutisError as error:
        said = str(error)
    assert "\n" not in said


UNITS = {
    "Nanometer": 1, "nanometers": 1, "{Nanometers}": 1, "nm": 1, "Micrometer": 1e-3,
    "Micrometers": 1e-3, "{ Micrometers }": 1e-3, "microns": 1e-3, "um": 1e-3,
    "Angstrom": 10, "Angstroms": 10, "Meters": 1e-9, "Unknown": 1, "": 1,
}  # fmt: skip


@pytest.mark.parametrize("unit", UNITS)
def test_units_in_the_singular_and_plural(write_envi, tmp_path, unit):
    listed = "{" + ", ".join(f"{lam * UNITS[unit]:.9g}" for lam in LAM) + "}"
    fields = {"wavelength": listed, "wavelength units": unit}
    with open_cube(write_envi(tmp_path / "a.hdr", cube(), **fields)) as file:
        np.testing.assert_allclose(file.wavelengths, LAM)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("700}", "700,\n}"),
        lambda text: text.replace("700}", "700, , }"),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("wavelength units", "Wavelength_Units"),
        lambda text: text.replace("wavelength =", "Wavelengths ="),
        lambda text: text.replace("samples = 4", "samples = 4.0"),
        lambda text: text.replace("ENVI\n", "ENVI \n; a comment = x\n"),
        lambda text: text.replace("interleave = bsq", "interleave = BSQ"),
    ],
)
def test_headers_nearly_as_they_should_be(write_envi, tmp_path, change):
    path = write_envi(tmp_path / "a.hdr", cube())
    path.write_bytes(change(path.read_text("utf-8")).encode())
    with open_cube(path) as file:
        np.testing.assert_array_equal(file.wavelengths, LAM)
        np.testing.assert_array_equal(file.rows(slice(0, 5)), cube().astype(np.float32))


@pytest.mark.parametrize("dtype", ["<u1", "<u2", "<i4", "<f4"])
def test_whole_numbers_are_not_percent(write_envi, tmp_path, dtype):
    """A camera of 8 bits sees dark skin below 50."""
    from cutis.spectra.reflectance import fraction_scale

    values = np.rint(cube() * 120)
    with open_cube(write_envi(tmp_path / "a.hdr", values, dtype=dtype)) as file:
        with pytest.raises(CutisError, match=r"whole numbers of up to \d+ are percent or counts"):
            fraction_scale(file.path, file.sample())
        assert fraction_scale(file.path, file.sample(), 255)[0] == 1 / 255
