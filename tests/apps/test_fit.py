"""`cutis fit` on tables and cubes, good and bad."""

import csv
import io

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.maps.reading import MapsFile
from cutis.optics import (
    ALIAGA2022,
    MEASURED2026,
    NAMES,
    from_coordinates,
    to_coordinates,
    with_rare_chromophores,
)
from cutis.textures import read_channels, write_channels

LAM = np.arange(400.0, 701.0, 10.0)


@pytest.fixture(scope="module")
def skins():
    """(12, 5) skins away from the ends of the ranges."""
    u = np.random.default_rng(4).uniform(0.25, 0.6, (12, 5))
    u[:, 0] *= 0.7
    return from_coordinates(u)


@pytest.fixture(scope="module")
def spectra(skins):
    """(12, 31) albedo of them."""
    return SampledSpace(albedo_space(MEASURED2026), LAM).reflectance(skins).astype(float)


def write_columns(path, values, lam=LAM):
    """A CSV with a column per spectrum."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["wavelength_nm", *(f"s{i}" for i in range(len(values)))])
        for wavelength, row in zip(lam, np.transpose(values), strict=True):
            writer.writerow([f"{wavelength:g}", *("" if np.isnan(v) else f"{v:.8f}" for v in row)])
    return path


def read_skins(text):
    """Rows of the CSV that comes out, and (n, 5) parameters."""
    rows = list(csv.DictReader(io.StringIO(text)))
    return rows, np.array([[float(row[name]) for name in NAMES] for row in rows])


def near(found, skins):
    """Whether parameters agree in coordinates."""
    return np.abs(to_coordinates(found) - to_coordinates(skins)).max() < 0.02


def test_columns_of_spectra_give_rows_of_skins(cutis, tmp_path, skins, spectra):
    path = write_columns(tmp_path / "a.csv", spectra)
    ended = cutis("fit", path, "-o", tmp_path / "skins.csv")
    assert ended.code == 0, ended.err
    assert "12 skins" in ended.err
    rows, found = read_skins((tmp_path / "skins.csv").read_text("utf-8"))
    assert near(found, skins)
    assert [row["spectrum"] for row in rows] == [f"s{i}" for i in range(12)]
    assert all(float(row["rmse"]) < 2e-5 for row in rows)
    assert all(float(row[f"{name}_sigma"]) > 0 for row in rows for name in NAMES)
    assert all(row["wavelengths"] == "31" for row in rows)


def test_what_cutis_spectrum_prints_is_understood(cutis, tmp_path):
    made = cutis("spectrum", "--melanin", 0.05, "--blood", 0.01, "--thickness", 90)
    (tmp_path / "one.csv").write_text(made.out, encoding="utf-8")
    ended = cutis("fit", tmp_path / "one.csv", "-q")
    assert ended.err == ""
    _, found = read_skins(ended.out)
    assert near(found, np.array([[0.05, 0.01, 90, 0.7, 0.7]]))


def test_rows_keep_their_labels_and_correlations_are_asked_for(cutis, tmp_path, skins, spectra):
    lines = [",".join(["subject", *(f"R_{lam:g}" for lam in LAM), "site"])]
    lines += [
        ",".join([f"p{i}", *(f"{v:.8f}" for v in row), "cheek"]) for i, row in enumerate(spectra)
    ]
    (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8")
    ended = cutis("fit", tmp_path / "a.csv", "--correlations", "-q")
    rows, found = read_skins(ended.out)
    assert near(found, skins)
    assert [row["subject"] for row in rows] == [f"p{i}" for i in range(12)]
    assert list(rows[0])[:2] == ["subject", "site"]
    assert abs(float(rows[0]["melanin_thickness_correlation"])) <= 1
    assert sum(name.endswith("_correlation") for name in rows[0]) == 10


def test_specular_part_and_held_parameters(cutis, tmp_path, skins, spectra):
    path = write_columns(tmp_path / "a.csv", 0.028 + 0.972 * spectra)
    ended = cutis("fit", path, "--specular", 0.028)
    assert "surface reflection 0.028" in ended.err
    assert near(read_skins(ended.out)[1], skins)
    ended = cutis("fit", path, "--specular", 0.028, "--oxygenation", 0.5)
    rows, found = read_skins(ended.out)
    assert (found[:, NAMES.index("oxygenation")] == 0.5).all()
    assert all(float(row["oxygenation_sigma"]) == 0 for row in rows)


def test_tissue_and_shift_are_said(cutis, tmp_path, skins):
    values = SampledSpace(albedo_space(MEASURED2026), LAM + 1.5).reflectance(skins).astype(float)
    path = write_columns(tmp_path / "a.csv", values)
    ended = cutis("fit", path, "--shift", 1.5)
    assert "measured2026, surface reflection 0, wavelengths shifted by 1.5 nm" in ended.err
    assert near(read_skins(ended.out)[1], skins)
    values = SampledSpace(albedo_space(ALIAGA2022), LAM).reflectance(skins).astype(float)
    ended = cutis("fit", write_columns(path, values), "--tissue", "aliaga2022")
    assert "aliaga2022, surface reflection 0" in ended.err
    assert near(read_skins(ended.out)[1], skins)


def rare_spectra():
    """(12, 8) skins with bilirubin and methaemoglobin, and their (12, 31) spectra."""
    rng = np.random.default_rng(9)
    low, high = [0.01, 0.01, 50, 0.3, 0.3, 0.01, 0, 0.1], [0.08, 0.05, 120, 0.9, 0.9, 0.06, 0, 0.4]
    skins = rng.uniform(low, high, (12, 8))
    space = albedo_space(with_rare_chromophores(MEASURED2026))
    return skins, SampledSpace(space, LAM).reflectance(skins).astype(float)


def test_rare_chromophores_are_found_or_held(cutis, tmp_path):
    skins, values = rare_spectra()
    path = write_columns(tmp_path / "a.csv", values)
    flags = "--free", "bilirubin", "--free", "methaemoglobin", "--noise", "0.001"
    rows = read_skins(cutis("fit", path, *flags).out)[0]
    assert "carotene" not in rows[0]
    for name, column in (("bilirubin", 5), ("methaemoglobin", 7)):
        found = np.array([[float(row[name]), float(row[f"{name}_sigma"])] for row in rows])
        assert np.all(np.abs(found[:, 0] - skins[:, column]) < found[:, 1])
    held = cutis("fit", path, "--bilirubin", "0.1", "--free", "methaemoglobin")
    rows = read_skins(held.out)[0]
    assert {(row["bilirubin"], row["bilirubin_sigma"]) for row in rows} == {("0.1", "0")}


def test_rare_chromophores_of_a_cube_are_maps(cutis, tmp_path):
    skins, values = rare_spectra()
    np.save(tmp_path / "a.npy", values.reshape(3, 4, -1).astype(np.float32))
    np.savetxt(tmp_path / "a.wavelengths.txt", LAM)
    out = tmp_path / "a.skin.exr"
    flags = "--free", "bilirubin", "--free", "methaemoglobin"
    ended = cutis("fit", tmp_path / "a.npy", *flags, "-o", out)
    assert ended.code == 0, ended.err
    with MapsFile(out) as file:
        maps = file.rows(slice(0, 3))
    assert maps.rare == ("bilirubin", "methaemoglobin")
    np.testing.assert_allclose(maps.bilirubin.ravel(), skins[:, 5], atol=0.003)
    np.testing.assert_allclose(maps.methaemoglobin.ravel(), skins[:, 7], atol=0.01)
    assert "bilirubin.sigma" in read_channels(out)[0]
    assert "methaemoglobin: 0." in cutis("info", out).out


def test_range_leaves_wavelengths_out(cutis, tmp_path, skins, spectra):
    wide = np.concatenate([LAM, [800.0, 900.0]])
    values = np.hstack([spectra, np.full((12, 2), 0.9)])
    path = write_columns(tmp_path / "a.csv", values, wide)
    ended = cutis("fit", path)
    assert "2 of 33 wavelengths outside 380 to 780 nm left out" in ended.err
    assert near(read_skins(ended.out)[1], skins)
    ended = cutis("fit", path, "--range", "450,650")
    assert read_skins(ended.out)[0][0]["wavelengths"] == "21"


def test_percent_gaps_and_negative_values_are_announced(cutis, tmp_path, skins, spectra):
    values = 100 * spectra
    values[0, 3], values[1, 4], values[2, 5] = np.nan, -0.2, 180.0
    ended = cutis("fit", write_columns(tmp_path / "a.csv", values))
    for words in ("percent", "1 value is negative", "1 value is above 1.2", "1 value is mis"):
        assert words in ended.err
    rows, found = read_skins(ended.out)
    assert [row["wavelengths"] for row in rows[:4]] == ["30", "30", "30", "31"]
    assert near(found, skins)


def test_micrometres_are_announced(cutis, tmp_path, skins, spectra):
    ended = cutis("fit", write_columns(tmp_path / "a.csv", spectra, LAM / 1000))
    assert "micrometres" in ended.err
    assert near(read_skins(ended.out)[1], skins)


@pytest.mark.parametrize(
    ("change", "arguments", "words"),
    [
        (lambda y, lam: (y[:, :4], lam[:4]), [], "too few for 5 free parameters"),
        (lambda y, lam: (y, lam * 10), [], "are they in nm"),
        (lambda y, lam: (y * 6000, lam), [], "--scale"),
        (lambda y, lam: (-y, lam), [], "no value above 0"),
        (lambda y, lam: (np.full_like(y, np.nan), lam), [], "no value above 0"),
        (lambda y, lam: (np.where(np.arange(31) < 27, np.nan, y), lam), [], "s0 has 4 usable"),
        (lambda y, lam: (y, lam), ["--range", "700,400"], "--range takes"),
        (lambda y, lam: (y, lam), ["--range", "visible"], "--range takes"),
        (lambda y, lam: (y, lam), ["--range", "100,200"], "are outside"),
        (lambda y, lam: (y, lam), ["--specular", "3"], "specular"),
        (lambda y, lam: (y, lam), ["--blood", "3"], "outside its range"),
        (lambda y, lam: (y, lam), ["--noise", "0"], "noise"),
        (lambda y, lam: (y, lam), ["--scale", "0"], "scale"),
        (lambda y, lam: (y, lam), ["--shift", "40"], "shift"),
        (lambda y, lam: (y, lam), ["--tissue", "skin"], "unknown tissue"),
        (lambda y, lam: (y[:, :5], lam[:5]), ["--free", "carotene"], "for 6 free parameters"),
        (lambda y, lam: (y, lam), ["--free", "water"], "water cannot be freed"),
        (lambda y, lam: (y, lam), ["--bilirubin", "2"], "bilirubin = 2 is outside its range"),
        (lambda y, lam: (y, lam), ["-o", "skins.txt"], "end its name in .csv"),
        (lambda y, lam: (y, lam), ["-o", "absent/skins.csv"], "does not exist"),
    ],
)
def test_bad_input_is_one_line(cutis, tmp_path, monkeypatch, spectra, change, arguments, words):
    monkeypatch.chdir(tmp_path)
    path = write_columns(tmp_path / "a.csv", *change(spectra, LAM))
    ended = cutis("fit", path, *arguments, "-q")
    assert ended.code == 1
    assert words in ended.err
    assert ended.err.count("\n") == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv"]


def test_the_spectra_themselves_are_not_overwritten(cutis, tmp_path, spectra):
    path = write_columns(tmp_path / "a.csv", spectra)
    before = path.read_bytes()
    assert "write to another name" in cutis("fit", path, "-o", path).err
    assert path.read_bytes() == before


@pytest.fixture
def write_cube(write_envi, tmp_path, spectra):
    """`write_cube(kind)` writes a 3 × 4 cube of the spectra; path, and arguments for it."""

    def write(kind, values=None):
        values = (spectra if values is None else values).reshape(3, 4, -1)
        if kind == "exr":
            names = [f"T.{lam:g},000000nm" for lam in LAM]
            channels = {name: values[..., i] for i, name in enumerate(names)}
            write_channels(tmp_path / "face.exr", channels)
            return tmp_path / "face.exr", []
        if kind == "npy":
            np.save(tmp_path / "face.npy", values)
            np.savetxt(tmp_path / "w.txt", LAM)
            return tmp_path / "face.npy", ["--wavelengths", tmp_path / "w.txt"]
        listed = "{" + ",".join(f"{lam:g}" for lam in LAM) + "}"
        return write_envi(tmp_path / "face.hdr", values, kind, wavelength=listed), []

    return write


@pytest.mark.parametrize("kind", ["exr", "npy", "bsq", "bil", "bip"])
def test_cubes_become_maps(cutis, write_cube, tmp_path, monkeypatch, skins, kind):
    monkeypatch.setattr("cutis.spectra.spectral_cube.TEXELS", 4)  # a row at a time
    path, arguments = write_cube(kind)
    ended = cutis("fit", path, *arguments, "-o", tmp_path / "face.skin.exr")
    assert ended.code == 0, ended.err
    assert "12 skins" in ended.err
    with MapsFile(tmp_path / "face.skin.exr") as file:
        assert near(file.rows(slice(0, 3)).parameters().reshape(12, 5), skins)
    channels, metadata = read_channels(tmp_path / "face.skin.exr")
    assert all((channels[f"{name}.sigma"] > 0).all() for name in NAMES)
    assert channels["rmse"].max() < 2e-5
    assert metadata["cutis:specular"] == "0"
    assert cutis("info", tmp_path / "face.skin.exr").code == 0


def test_texels_without_spectrum_are_outside_the_mask(cutis, write_cube, tmp_path, spectra):
    values = 100 * spectra
    values[0], values[5], values[7, 4:] = 0.0, np.nan, np.nan
    values[9, 2] = 1e6
    path, arguments = write_cube("bil", values)
    ended = cutis("fit", path, *arguments, "-o", tmp_path / "face.skin.exr")
    for words in ("percent", "3 texels without a spectrum", "1 value is above 1.2", "9 skins"):
        assert words in ended.err
    channels, _ = read_channels(tmp_path / "face.skin.exr")
    mask = channels["mask"].ravel()
    assert np.flatnonzero(mask == 0).tolist() == [0, 5, 7]
    assert all(np.isfinite(values).all() for values in channels.values())


def test_a_cubes_scale_is_that_of_its_header_or_given(
    cutis, write_envi, tmp_path, skins, spectra
):  # fmt: skip
    listed = "{" + ",".join(f"{lam:g}" for lam in LAM) + "}"
    stored = np.rint(spectra * 50000).reshape(3, 4, -1)
    fields = {"wavelength": listed, "reflectance scale factor": 50000}
    path = write_envi(tmp_path / "a.hdr", stored, dtype="<u2", **fields)
    out = tmp_path / "a.skin.exr"
    assert "50000 means 1" in cutis("fit", path, "-o", out).err
    with MapsFile(out) as file:
        assert near(file.rows(slice(0, 3)).parameters().reshape(12, 5), skins)
    path = write_envi(tmp_path / "b.hdr", stored, dtype="<u2", wavelength=listed)
    assert "--scale" in cutis("fit", path, "-o", out).err
    assert cutis("fit", path, "--scale", 50000, "-o", out).code == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "-o NAME.skin.exr"),
        (["-o", "a.csv"], "-o NAME.skin.exr"),
        (["-o", "absent/a.exr"], "does not exist"),
        (["-o", "face.exr"], "the cube itself"),
        (["-o", "a.exr", "--wavelengths", "face.exr"], "is no"),
        (["-o", "a.exr", "--range", "400,430"], "too few"),
    ],
)
def test_bad_cubes_are_one_line(cutis, write_cube, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    path, _ = write_cube("exr")
    ended = cutis("fit", path.name, *arguments, "-q")
    assert ended.code == 1
    assert words in ended.err
    assert ended.err.count("\n") == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["face.exr"]


def test_a_cube_of_nothing(cutis, write_cube, tmp_path, spectra):
    path, arguments = write_cube("npy", np.full_like(spectra, np.nan))
    ended = cutis("fit", path, *arguments, "-o", tmp_path / "a.exr")
    assert (ended.code, ended.err.count("\n")) == (1, 1)
    assert not (tmp_path / "a.exr").exists()


def test_a_colour_texture_is_no_cube(cutis, write_face, tmp_path):
    ended = cutis("fit", write_face(tmp_path, "exr"), "-o", tmp_path / "a.exr")
    assert "cutis estimate" in ended.err
    ended = cutis("fit", write_face(tmp_path, "png8"), "-o", tmp_path / "a.exr")
    assert ended.code == 1
    assert "ENVI" in ended.err


@pytest.mark.parametrize("quantity", ["absorbance", "K/S", "transmittance"])
def test_what_is_no_reflectance_is_refused_unless_forced(
    cutis, one_line, tmp_path, spectra, quantity
):
    r = spectra[:6]
    values = {"absorbance": -np.log10(r), "K/S": (1 - r) ** 2 / 2 / r, "transmittance": 1 - r}
    path, out = write_columns(tmp_path / "a.csv", values[quantity]), tmp_path / "out.csv"
    flags = ("--scale", "100") if quantity == "K/S" else ()
    message = one_line(cutis("fit", path, "-o", out, *flags))
    assert "6 of 6 spectra look like no skin (mean RMSE" in message
    assert "give reflectance, not absorbance or K/S, or keep the result by --force" in message
    assert not out.exists()
    kept = cutis("fit", path, "-o", out, "--force", *flags)
    assert kept.code == 0
    assert "6 of 6 spectra look like no skin" in kept.err
    assert out.exists()


def test_so_is_a_cube_of_it(cutis, one_line, tmp_path, spectra):
    np.save(tmp_path / "a.npy", (-np.log10(spectra)).reshape(3, 4, 31).clip(0.01, 1.2))
    np.savetxt(tmp_path / "a.wavelengths.txt", LAM)
    out = tmp_path / "a.skin.exr"
    assert "12 of 12 spectra look like no skin" in one_line(
        cutis("fit", tmp_path / "a.npy", "-o", out)
    )
    assert not out.exists()
    assert cutis("fit", tmp_path / "a.npy", "-o", out, "--force").code == 0
    assert out.exists()


def test_names_in_what_comes_out_are_no_formulas(cutis, tmp_path, spectra):
    path = write_columns(tmp_path / "a.csv", spectra[:2])
    path.write_text(path.read_text().replace("s0", "=1+cmd|x").replace("s1", "-s1"))
    rows = list(csv.reader(io.StringIO(cutis("fit", path).out)))
    assert [row[0] for row in rows[1:]] == ["'=1+cmd|x", "'-s1"]


def test_a_spectral_library_is_a_table(cutis, one_line, tmp_path, spectra, skins):
    (tmp_path / "lib.sli").write_bytes(spectra.astype("<f4").tobytes())
    listed = ", ".join(f"{lam:g}" for lam in LAM)
    (tmp_path / "lib.hdr").write_text(
        f"ENVI\nsamples = 31\nlines = {len(spectra)}\nbands = 1\ndata type = 4\n"
        "file type = ENVI Spectral Library\ninterleave = bsq\nbyte order = 0\n"
        f"wavelength units = Nanometer\nwavelength = {{{listed}}}\n"
    )
    for name in ("lib.sli", "lib.hdr"):
        ended = cutis("fit", tmp_path / name)
        assert ended.code == 0
        assert near(read_skins(ended.out)[1], skins)
    message = one_line(cutis("fit", tmp_path / "lib.hdr", "-o", tmp_path / "a.skin.exr"))
    assert "skins of a table are a table" in message
