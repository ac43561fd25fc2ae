"""Tables of spectra, whatever way round."""

import re

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


SKINS = {"arm": [0.213, 0.314, 0.427, 0.551], "cheek": [0.126, 0.187, 0.268, 0.409]}
BANDS = [400, 450, 500, 600]


def rows_of(head="{}", cell="{:.3f}", between=",", end="", site="site", factor=1.0, comma=False):
    """The two skins as a row each."""
    lines = [between.join([site, *(head.format(b) for b in BANDS)]) + end]
    for name, values in SKINS.items():
        cells = [cell.format(v * factor) for v in values]
        lines.append(
            between.join([name, *(c.replace(".", ",") if comma else c for c in cells)]) + end
        )
    return "\n".join(lines) + "\n"


def columns_of(axis="wavelength_nm", lam="{}", between=",", end="", head_end=None, factor=1.0,
               comma=False, cell="{:.3f}", names=True):  # fmt: skip
    """The two skins as a column each."""
    head = between.join([axis, *SKINS]) + (end if head_end is None else head_end)
    lines = [head] if names else []
    for i, band in enumerate(BANDS):
        cells = [lam.format(band), *(cell.format(v[i] * factor) for v in SKINS.values())]
        lines.append(between.join(c.replace(".", ",") if comma else c for c in cells) + end)
    return "\n".join(lines) + "\n"


CGATS = (
    'CGATS.17\nORIGINATOR "somebody else"\nNUMBER_OF_FIELDS 5\nBEGIN_DATA_FORMAT\n{fields}\n'
    "END_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n{data}\nEND_DATA\n"
)


def cgats(field="SPECTRAL_NM_{}", between="\t"):
    fields = between.join(["SAMPLE_ID", *(field.format(b) for b in BANDS)])
    data = "\n".join(between.join([f'"{n}"', *(f"{v:.3f}" for v in vs)]) for n, vs in SKINS.items())
    return CGATS.format(fields=fields, data=data)


# Text, lines left out, words that a note has.
TABLES = {
    "plain rows": (rows_of(), 0, ""),
    "plain columns": (columns_of(), 0, ""),
    "sep=; and decimal commas": ("sep=;\n" + rows_of(between=";", comma=True), 0, ""),
    "sep=; in quotes": ('"sep=;"\n' + rows_of(between=";", comma=True), 0, ""),
    "three lines of metadata": (
        "Data Name,Project 12\nInstrument,CM-700d\nMask/Gloss,S/I\n" + rows_of(), 3, "1-3: Da"),
    "metadata with numbers": ("Range,400,700,10\nScans,3,4\n\n" + rows_of(), 2, "1-2"),
    "metadata about wavelengths": ("Wavelength,400 to 700\n\n" + columns_of(), 1, "line 1"),
    "a row of units": (columns_of("Wavelength").replace("\n", "\nnm,1,1\n", 1), 0, "line 2 is"),
    "units of percent": (
        columns_of("Wavelength", factor=100, cell="{:.1f}").replace("\n", "\n[nm],%,%\n", 1),
        0, "line 2 is taken"),
    "units under rows": (rows_of().replace("\n", "\n,nm,nm,nm,nm\n", 1), 0, "line 2 is taken"),
    "trailing delimiters": (columns_of(end=",", head_end=""), 0, ""),
    "trailing delimiters everywhere": (columns_of(end=",,"), 0, ""),
    "trailing semicolons": (rows_of(between=";", end=";"), 0, ""),
    "empty last rows": (rows_of() + ",,,,\n,,,,\n", 0, ""),
    "empty rows between": (rows_of().replace("\n", "\n\n,,,,\n"), 0, ""),
    "SpectraSuite": (
        "SpectraSuite Data File\n++++++\nDate: Tue Nov 26 10:12:13 CET 2024\nDark Corrected: No\n"
        ">>>>>Begin Processed Spectral Data<<<<<\n"
        + columns_of(between="\t", names=False, lam="{}.00")
        + ">>>>>End Processed Spectral Data<<<<<\n", 6, "there is no header"),
    "CGATS": (cgats(), 0, ""),
    "CGATS with spaces": (cgats(between=" "), 0, ""),
    "CGATS of others": (cgats("SPECTRAL_NM{}"), 0, ""),
    "CGATS by nm": (cgats("nm{}"), 0, ""),
    "decimal commas with tabs": (columns_of(between="\t", comma=True, lam="{}.00"), 0, ""),
    "decimal commas with semicolons in the header too": (
        rows_of("{},0", between=";", comma=True), 0, ""),
    "spaces": (columns_of(between="   "), 0, ""),
    "bars": (rows_of(between="|"), 0, ""),
    "SPECTRAL_NM_400": (rows_of("SPECTRAL_NM_{}"), 0, ""),
    "400[nm]": (rows_of("{}[nm]"), 0, ""),
    "400(nm)": (rows_of("{} (nm)"), 0, ""),
    "R%_400": (rows_of("R%_{}", factor=100, cell="{:.1f}"), 0, ""),
    "R[400nm]": (rows_of("R[{}nm]"), 0, ""),
    "SCI 400": (rows_of("SCI {} nm"), 0, ""),
    "nm in capitals": (rows_of("{}NM"), 0, ""),
    "exponents": (rows_of("{:.2e}", cell="{:.4e}"), 0, ""),
    "cells in nm": (columns_of(lam="{} nm"), 0, ""),
    "cells in percent": (rows_of(factor=100, cell="{:.1f} %"), 0, ""),
    "micrometres in the name": (
        re.sub(r"(?m)^(\d)(\d\d),", r"0.\1\2,", columns_of("Wavelength (µm)")), 0, ""),
    "a header by NumPy": ("# wavelength,arm,cheek\n" + columns_of(names=False), 0, ""),
    "comments in front": ("# by somebody\n# with care\n" + rows_of(), 2, "1-2"),
    "comments behind": (rows_of() + "# done\n", 1, "line 4"),
    "comments between": (rows_of().replace("cheek", "# the cheek:\ncheek"), 1, "line 3"),
    "old Macs": (rows_of().replace("\n", "\r"), 0, ""),
    "Windows with a byte order mark": ("\ufeff" + rows_of().replace("\n", "\r\n"), 0, ""),
    "quoted": (rows_of().replace("cheek", '"cheek"').replace("site", '"site"'), 0, ""),
    "the axis called so in a table of rows": (rows_of(site="Wavelength (nm)"), 0, ""),
    "numbered samples under wavelengths": (
        rows_of(site="No.").replace("arm", "1").replace("cheek", "2"), 0, ""),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_tables_as_instruments_write_them(tmp_path, name):
    text, count, word = TABLES[name]
    path = tmp_path / "skins.csv"
    path.write_bytes(text.encode())
    found = read_spectra(path)
    np.testing.assert_allclose(found.wavelengths, BANDS)
    factor, notes = found.scale(np.ones(4, bool))
    values = found.values * factor
    np.testing.assert_allclose(values, list(SKINS.values()), rtol=1e-6)
    if name not in ("SpectraSuite", "numbered samples under wavelengths"):
        assert [label[-1] for label in found.labels] == list(SKINS)
    told = " ".join([*found.notes, *notes])
    assert word in told
    assert (f"{count} line" in told) == (count > 0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (rows_of() + "brow,0.1,0.2\n", "line 4: row 3 has 3 cells under 5 columns"),
        (rows_of() + "brow,0.1,0.2,0.3,0.4,0.5\n", "line 4: row 3 has 6 cells under 5 columns"),
        (
            "a,b\n\n" + rows_of().replace("0.187", "pale"),
            "line 5: row 2, column 450 is 'pale', not a number",
        ),
        (
            rows_of().replace("0.187", "0.187 %"),
            "line 3: row 2, column 450 is '0.187 %', in '%' where cells above are in ''",
        ),
        (
            columns_of(between=";").replace("0.409", "0,409"),
            "line 5: row 4, column cheek is '0,409', with ',' where cells above have '.'",
        ),
        (rows_of().replace("0.187", "1e999"), "line 3: row 2, column 450 is '1e999', too large"),
        (rows_of().replace("0.187", "inf"), "column 450 is 'inf', not a number"),
        (rows_of() + rows_of(), "line 4: another table begins; keep one in each file"),
        (
            rows_of("SCI_{}")
            .replace("\n", ",0.1,0.1,0.1,0.1\n")
            .replace("SCI_600,0.1,0.1,0.1,0.1", "SCI_600,SCE_400,SCE_450,SCE_500,SCE_600"),
            "several kinds at each wavelength (sci and sce); keep one",
        ),
        (
            rows_of("{}nm").replace("600nm", "0.6µm"),
            "gives wavelengths in nm and µm; keep one unit",
        ),
        (columns_of("Wavelength (cm-1)"), "no spectra in columns"),
        (cgats().replace("END_DATA\n", ""), "CGATS whose DATA is not whole"),
        ("BEGIN_DATA_FORMAT\nEND_DATA_FORMAT\n" + cgats(), "CGATS without fields"),
        ('a,"b\n' + rows_of(), "line 1: is no CSV"),
        (columns_of().replace("400,", "red,"), "line 2: row 1, column wavelength_nm is 'red'"),
        (columns_of().encode("utf-16").decode("latin-1"), "no CSV file in UTF-8"),
    ],
)
def test_what_is_at_fault_is_named_by_its_line(tmp_path, text, words):
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode("latin-1" if "UTF-8" in words else "utf-8"))
    with pytest.raises(CutisError) as raised:
        read_spectra(path)
    assert words in str(raised.value)
    assert len(str(raised.value).splitlines()) == 1


def test_rows_that_begin_with_a_hash(tmp_path):
    """Sample numbers are written so; only what has the cells of a row is one."""
    text = rows_of().replace("arm", "#1 arm").replace("cheek", "#2 cheek") + "# end of the day\n"
    path = tmp_path / "a.csv"
    path.write_text(text)
    found = read_spectra(path)
    assert found.labels == [["#1 arm"], ["#2 cheek"]]
    assert found.notes == [
        "1 line is no part of the table and left out (line 4: # end of the day …)"
    ]


def scales(tmp_path, text, given=None):
    path = tmp_path / "a.csv"
    path.write_text(text)
    found = read_spectra(path)
    factor, notes = found.scale(np.ones(len(found.wavelengths), bool), given)
    return factor[:, 0].tolist(), notes


def test_spectra_in_columns_are_scaled_one_by_one(tmp_path):
    mixed = columns_of(factor=100, cell="{:.1f}").replace("cheek", "cheek,nose")
    lines = [f"{line},0.{i}1" if i else line for i, line in enumerate(mixed.splitlines())]
    assert scales(tmp_path, "\n".join(lines)) == (
        [0.01, 0.01, 1.0], ["values of up to 50.8: taken for percent (arm, cheek)"]
    )  # fmt: skip


def test_rows_that_disagree_are_refused(tmp_path):
    text = rows_of(factor=100, cell="{:.1f}") + "brow,0.1,0.2,0.3,0.4\n"
    with pytest.raises(CutisError, match="line 4: brow looks like fractions, others like percent"):
        scales(tmp_path, text)
    assert scales(tmp_path, text, 100.0) == ([0.01] * 3, [])


def test_whole_numbers_are_not_percent_without_a_word(tmp_path):
    for text in (rows_of(factor=100, cell="{:.0f}"), columns_of(factor=200, cell="{:.0f}")):
        with pytest.raises(CutisError, match=r"whole numbers .* are percent or counts; give the"):
            scales(tmp_path, text)
        assert scales(tmp_path, text, 255.0)[0] == [1 / 255] * 2
    for said in ("R%_{}", "{} nm [%]"):
        text = rows_of(said, factor=100, cell="{:.0f}")
        assert scales(tmp_path, text) == ([0.01] * 2, ["in percent, as the table says"])
    with pytest.raises(CutisError, match="said to be percent, but looks like fractions"):
        scales(tmp_path, rows_of("R%_{}"))


def test_other_scales_name_the_spectrum(tmp_path):
    text = rows_of() + "brow,1000,2000,3000,4000\n"
    with pytest.raises(CutisError, match=r"line 4: brow: values of up to .* neither fractions nor"):
        scales(tmp_path, text)


def test_devices_and_long_files_are_refused(tmp_path, monkeypatch):
    (tmp_path / "z.csv").symlink_to("/dev/zero")
    with pytest.raises(CutisError, match="is a device"):
        read_spectra(tmp_path / "z.csv")
    path = tmp_path / "a.csv"
    path.write_text(rows_of())
    monkeypatch.setattr("cutis.spectra.sheets.LONGEST", 10)
    with pytest.raises(CutisError, match="longer than"):
        read_spectra(path)


@pytest.mark.slow
def test_many_spectra_are_read_in_little_time_and_memory(tmp_path):
    """20 000 spectra of 41 bands, whose rows begin with a number."""
    import time

    rng = np.random.default_rng(0)
    values = rng.random((20_000, 41))
    lines = ["no," + ",".join(str(400 + 10 * i) for i in range(41))]
    lines += [f"{i}," + ",".join(f"{v:.4f}" for v in row) for i, row in enumerate(values)]
    path = tmp_path / "many.csv"
    path.write_text("\n".join(lines))
    start = time.process_time()
    found = read_spectra(path)
    assert time.process_time() - start < 10
    np.testing.assert_allclose(found.values, values, atol=6e-5)


@settings(
    max_examples=300,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    st.one_of(
        st.binary(max_size=200),
        st.lists(
            st.lists(
                st.sampled_from(
                    [
                        "wavelength_nm",
                        "400",
                        "500",
                        "600",
                        "nan",
                        "",
                        "-1",
                        "1e999",
                        '"',
                        "λ",
                        "#",
                        "sep=;",
                    ]
                )
            ),
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
