"""Tables of spectra, whatever way round."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cutis.errors import CutisError
from cutis.spectra.table_files import read_spectra

LAM = np.array([400.0, 450.0, 500.5, 600.0])
VALUES = np.array([[0.1, 0.2, 0.3, 0.4], [0.15, 0.25, np.nan, 0.45]])


def _cell(value, decimal="."):
    return "" if np.isnan(value) else f"{value:g}".replace(".", decimal)


def by_columns(delimiter=",", decimal=".", first="wavelength_nm", order=slice(None)):
    lines = [delimiter.join([first, "cheek", "palm"])]
    for lam, pair in list(zip(LAM, VALUES.T, strict=True))[order]:
        lines.append(delimiter.join([_cell(lam, decimal), *(_cell(v, decimal) for v in pair)]))
    return "\n".join(lines)


def by_rows(form="{:g}"):
    lines = [",".join(["site", "age", *(form.format(lam) for lam in LAM)])]
    for site, row in zip(("cheek", "palm"), VALUES, strict=True):
        lines.append(",".join([site, "30", *map(_cell, row)]))
    return "\n".join(lines)


@pytest.mark.parametrize(
    "text",
    [
        by_columns(),
        by_columns(first="lambda_nm"),
        by_columns(first="Wavelength (nm)"),
        by_columns(first=""),
        by_columns(delimiter="\t"),
        by_columns(delimiter=";", decimal=","),
        by_columns(order=slice(None, None, -1)),
        "# made\n\n" + by_columns(),
        "\ufeff" + by_columns(),
    ],
)
def test_a_column_per_spectrum(tmp_path, text):
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    found = read_spectra(path)
    np.testing.assert_array_equal(found.wavelengths, LAM)
    np.testing.assert_array_equal(found.values, VALUES)
    assert found.columns == ["spectrum"]
    assert found.labels == [["cheek"], ["palm"]]


@pytest.mark.parametrize("form", ["{:g}", "R_{:g}", "{:g} nm", "{:g}nm", "refl.{:g}"])
def test_a_row_per_spectrum(tmp_path, form):
    path = tmp_path / "a.csv"
    path.write_text(by_rows(form), encoding="utf-8")
    found = read_spectra(path)
    np.testing.assert_array_equal(found.wavelengths, LAM)
    np.testing.assert_array_equal(found.values, VALUES)
    assert found.columns == ["site", "age"]
    assert found.labels == [["cheek", "30"], ["palm", "30"]]


def test_micrometres(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("wavelength,a\n0.4,0.1\n0.5,0.2\n", encoding="utf-8")
    found = read_spectra(path)
    np.testing.assert_allclose(found.wavelengths, [400, 500])
    assert "micrometres" in found.notes[0]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is empty"),
        (b"# only words\n", "is empty"),
        (b"wavelength_nm,a\n", "no rows"),
        (b"wavelength_nm\n400\n", "no column of reflectance"),
        (b"wavelength_nm,a\n400,0.1\n500\n", "row 2 has 1 cells"),
        (b"wavelength_nm,a\n400,bright\n", "row 1, column a is 'bright'"),
        (b"wavelength_nm,a\nred,0.1\n", "column wavelength_nm is 'red'"),
        (b"wavelength_nm,a\n,0.1\n", "missing or not above 0"),
        (b"wavelength_nm,a\n400,0.1\n400,0.2\n", "400 nm twice"),
        (b"site,red,green,blue\ncheek,1,2,3\n", "call the first column wavelength_nm"),
        (b"\xff\xfe\x00\x01", "UTF-8"),
        (b'wavelength_nm,a\n"400,0.1\n', "no CSV"),
    ],
)
def test_what_is_no_table_is_one_line(tmp_path, data, words):
    path = tmp_path / "a.csv"
    path.write_bytes(data)
    with pytest.raises(CutisError, match=words) as raised:
        read_spectra(path)
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(CutisError, match="no such file"):
        read_spectra(tmp_path / "absent.csv")


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.one_of(
        st.binary(max_size=200),
        st.lists(
            st.lists(st.sampled_from(["wavelength_nm", "400", "nan", "", "-1", "1e999", '"', "λ"])),
            max_size=5,
        ).map(lambda rows: "\n".join(",".join(row) for row in rows).encode()),
    )
)
def test_any_file_is_a_table_or_one_line(tmp_path, data):
    path = tmp_path / "any.csv"
    path.write_bytes(data)
    said = ""
    try:
        found = read_spectra(path)
        assert found.values.shape == (len(found.labels), len(found.wavelengths))
        assert (found.wavelengths > 0).all()
    except CutisError as error:
        said = str(error)
    assert "\n" not in said
