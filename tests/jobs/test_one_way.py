"""What the command line gives is what the library gives, bit for bit, for every field of a job.

Each field of each job is named here with a value that changes the result, the flags that say the
same, and nothing is left out: a new field fails the first test until it has its line.
"""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import cutis as package
from cutis.colour import light
from cutis.inverse import Calibration
from cutis.jobs import CaptureFiles, EditJob, EstimateJob, ExportJob, FitJob
from cutis.jobs.render import MaterialJob, RenderJob
from cutis.jobs.subject import Subject
from cutis.maps import Edit, load_maps, load_model
from cutis.optics import ALIAGA2022
from cutis.textures import Texture, colour_space, read_channels, write_texture

LAMP = "wavelength_nm,power\n" + "\n".join(
    f"{lam},{1 + (lam - 380) / 200}" for lam in range(380, 781, 10)
)
ESTIMATE = {
    "captures": ({}, ()),
    "output": ({}, ()),
    "white": ({"white": (0.9, 1.0, 1.1)}, ("--white", "0.9,1,1.1")),
    "exposure": ({"exposure": "auto"}, ("--exposure", "auto")),
    "light": ({"light": "A"}, ("--illuminant", "A")),
    "model": ({"model": "aliaga2022"}, ("--model", "aliaga2022")),
    "colorspace": ({"colorspace": "linear"}, ("--colorspace", "linear")),
    "output_colorspace": ({"output_colorspace": "ACEScg"}, ("--output-colorspace", "ACEScg")),
    "half": ({"half": True}, ("--half",)),
    "sigma": ({"sigma": False}, ("--no-sigma",)),
    "page": ({"page": True}, ("--report",)),
    "orientation": ({"orientation": "ignore"}, ("--orientation", "ignore")),
    "steady": ({"steady": True}, ("--steady", "on")),
    "again": ({"again": True}, ("--again",)),
}
GAINS = Calibration((1.1, 1.0, 0.9), "given")
EDIT = {
    "maps": ({}, ()),
    "output": ({}, ()),
    "edits": ({"edits": (Edit("melanin", "multiply", 1.4),)}, ("--melanin", "x1.4")),
    "amount": ({"amount": 0.5}, ("--amount", "0.5")),
    "mask": ({"mask": "mask.png"}, ("--mask", "mask.png")),
    "source": ({"source": "face.png"}, ("--source", "face.png")),
    "light": ({"light": "FL11"}, ("--illuminant", "FL11")),
    "model": ({"model": "lookup"}, ("--method", "lookup")),
    "calibration": ({"calibration": GAINS}, ("--calibration", "1.1,1,0.9")),
    "space": ({"space": "linear"}, ("--output-colorspace", "linear")),
    "save_maps": ({"save_maps": "kept.skin.exr"}, ("--save-maps", "kept.skin.exr")),
}
EXPORT = {
    "output": ({}, ()),
    "edits": ({"edits": (Edit("blood", "multiply", 2.0),)}, ("--blood", "x2")),
    "amount": ({"amount": 0.5}, ("--amount", "0.5")),
    "size": ({"size": 9}, ("--size", "9")),
    "space": ({"space": "linear"}, ("--colorspace", "linear")),
    "maps": ({"maps": "out/face.skin.exr"}, ("--maps", "out/face.skin.exr")),
    "model": ({"model": "aliaga2022-exact"}, ("--model", "aliaga2022-exact")),
}
FIT = {
    "spectra": ({}, ()),
    "output": ({}, ()),
    "tissue": ({"tissue": ALIAGA2022}, ("--tissue", "aliaga2022")),
    "specular": ({"specular": 0.028}, ("--specular", "0.028")),
    "shift": ({"shift": 1.5}, ("--shift", "1.5")),
    "low": ({"low": 420.0, "high": 700.0}, ("--range", "420,700")),
    "high": ({"low": 420.0, "high": 700.0}, ("--range", "420,700")),
    "wavelengths": None,  # of cubes: below
    "scale": ({"scale": 2.0}, ("--scale", "2")),
    "noise": ({"noise": 0.01}, ("--noise", "0.01")),
    "held": ({"held": {"thickness": 80.0}}, ("--thickness", "80")),
    "free": ({"free": ("bilirubin",)}, ("--free", "bilirubin")),
    "correlations": ({"correlations": True}, ("--correlations",)),
}


def fields(job):
    return {field.name for field in dataclasses.fields(job)}


def test_every_field_has_its_line():
    for job, lines in ((EstimateJob, ESTIMATE), (EditJob, EDIT), (ExportJob, EXPORT)):
        assert fields(job) == set(lines), job.__name__
    assert fields(FitJob) - set(FIT) <= {"force"}
    assert set(FIT) <= fields(FitJob)
    assert fields(RenderJob) == {"subject", "output", "frames", "again", "blender"}
    assert fields(MaterialJob) == {"subject", "folder", "blender"}


@pytest.fixture
def work(tmp_path, write_face, face_mask, monkeypatch):
    """A folder with face.png, mask.png, maps in out/, and spectra; the current one."""
    write_face(tmp_path)
    codes = np.rint(255 * face_mask).astype(np.uint8)
    mask = Texture(np.repeat(codes[..., None], 3, -1), ("R", "G", "B"), colour_space("linear"))
    write_texture(mask, tmp_path / "mask.png")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def resolved(values):
    """Values as a job takes them."""
    found = dict(values)
    for name in ("mask", "source", "save_maps", "maps"):
        if isinstance(found.get(name), str):
            found[name] = Path(found[name])
    if "light" in found:
        found["light"] = light(found["light"])
    if "model" in found:
        found["model"] = load_model(found["model"])
    for name in ("colorspace", "output_colorspace", "space"):
        if name in found:
            found[name] = colour_space(found[name])
    return found


def same_files(one: Path, other: Path) -> None:
    assert {p.name for p in one.iterdir()} == {p.name for p in other.iterdir()}
    for path in one.iterdir():
        if path.suffix == ".exr":
            mine, theirs = read_channels(path), read_channels(other / path.name)
            assert mine[1] == theirs[1]
            assert mine[0].keys() == theirs[0].keys()
            for name, values in mine[0].items():
                np.testing.assert_array_equal(values, theirs[0][name], name)
        else:
            assert path.read_bytes() == (other / path.name).read_bytes(), path.name


@pytest.mark.parametrize("name", ESTIMATE)
def test_estimate(name, work, cutis):
    values, flags = ESTIMATE[name]
    assert cutis("estimate", "face.png", "-o", "cli", "-q", *flags).code == 0
    (done,) = EstimateJob((CaptureFiles(Path("face.png")),), Path("job"), **resolved(values)).run()
    assert done.failure is None
    same_files(work / "cli", work / "job")


@pytest.mark.parametrize("name", ["white", "exposure", "light", "model", "sigma", "steady"])
def test_estimate_in_memory(name, work, cutis):
    values, flags = ESTIMATE[name]
    assert cutis("estimate", "face.png", "--mask", "mask.png", "-o", "cli", "-q", *flags).code == 0
    stored = load_maps(work / "cli" / "face.skin.exr")
    given = {("illuminant" if k == "light" else k): v for k, v in values.items()}
    face = package.read("face.png")
    skin = package.estimate(face, package.read_mask("mask.png", face.shape), **given)
    np.testing.assert_array_equal(stored.parameters(), skin.parameters())
    assert stored.calibration == skin.calibration
    assert set(stored.sigmas) == set(skin.sigmas)


def test_estimate_under_a_lamp(work, cutis):
    """The seen drift: the light of a file, by the command line and in memory."""
    (work / "lamp.csv").write_text(LAMP, encoding="utf-8")
    assert cutis("estimate", "face.png", "--illuminant", "lamp.csv", "-o", "cli", "-q").code == 0
    stored = load_maps(work / "cli" / "face.skin.exr")
    skin = package.estimate("face.png", illuminant="lamp.csv")
    np.testing.assert_array_equal(stored.parameters(), skin.parameters())
    loaded = package.load(work / "cli" / "face.skin.exr")
    face = package.read("face.png").linear()
    np.testing.assert_allclose(loaded.relit("lamp.csv"), face, atol=1e-5)


@pytest.fixture
def out(work):
    EstimateJob((CaptureFiles(Path("face.png")),), Path("out")).run()
    return work / "out"


@pytest.mark.parametrize("name", EDIT)
def test_edit(name, out, cutis):
    values, flags = EDIT[name]
    edits = {"edits": (Edit("blood", "multiply", 0.5),)} | values
    by_flag = () if name == "edits" else ("--blood", "x0.5")
    assert cutis("edit", "out/face.skin.exr", "-o", "cli.png", "-q", *by_flag, *flags).code == 0
    kept = Path("kept.skin.exr")
    if kept.exists():
        kept.rename("cli.skin.exr")
    EditJob(Path("out/face.skin.exr"), Path("job.png"), **resolved(edits)).run()
    assert Path("cli.png").read_bytes() == Path("job.png").read_bytes()
    if kept.exists():
        mine, theirs = load_maps(kept), load_maps("cli.skin.exr")
        np.testing.assert_array_equal(mine.parameters(), theirs.parameters())
        assert mine.edits == theirs.edits


@pytest.mark.parametrize("name", EXPORT)
@pytest.mark.parametrize("kind", ["cube", "clf"])
def test_export(name, kind, out, cutis):
    values, flags = EXPORT[name]
    edits = {"edits": (Edit("melanin", "multiply", 2.0),), "size": 9} | values
    by_flag = () if name == "edits" else ("--melanin", "x2")
    size = () if name == "size" else ("--size", "9")
    assert cutis("export", f"cli.{kind}", "-q", *by_flag, *size, *flags).code == 0
    ExportJob(Path(f"job.{kind}"), **resolved(edits)).run()
    assert Path(f"cli.{kind}").read_bytes() == Path(f"job.{kind}").read_bytes()


@pytest.mark.parametrize("name", [name for name, line in FIT.items() if line is not None])
def test_fit(name, work, cutis):
    values, flags = FIT[name]
    space = package.albedo_space()
    bands = np.arange(400, 701, 20)
    skins = np.array([[0.03, 0.02, 80, 0.6, 0.7], [0.1, 0.03, 90, 0.7, 0.6]])
    spectra = space.reflectance(skins)[:, 2:33:2]
    rows = [",".join(["skin", *map(str, bands)])]
    rows += [",".join([str(i), *(f"{v:.6f}" for v in row)]) for i, row in enumerate(spectra)]
    Path("spectra.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    assert cutis("fit", "spectra.csv", "-o", "cli.csv", "-q", *flags).code == 0
    FitJob(Path("spectra.csv"), Path("job.csv"), **values).run()
    assert Path("cli.csv").read_bytes() == Path("job.csv").read_bytes()


def test_fit_and_the_library_agree_on_the_tissue(work):
    """Whoever names none gets that of the default model, everywhere."""
    assert FitJob(Path("a.csv")).tissue == load_model().tissue == package.albedo_space().tissue


def test_digests_follow_contents(out, work):
    """The same fields, another content: another digest; another output: the same."""
    job = EditJob(Path("out/face.skin.exr"), Path("a.png"), mask=Path("mask.png"))
    before = job.digest()
    assert dataclasses.replace(job, output=Path("b.png")).digest() == before
    assert dataclasses.replace(job, amount=0.5).digest() != before
    Path("mask.png").write_bytes(Path("face.png").read_bytes())
    assert job.digest() != before
    assert json.loads(json.dumps(before)) == before


def test_what_renders_see(out, work):
    """The skin of a render is the calibrated albedo of the same edits."""
    edits = (Edit("melanin", "multiply", 1.5),)
    with Subject(Path("out/face.skin.exr"), edits=edits, mask=Path("mask.png")).opened() as (
        skin, changes,
    ):  # fmt: skip
        seen = skin.rows(slice(None), changes).albedo
    known = package.load("out/face.skin.exr")
    where = package.read_mask("mask.png", known.shape)
    edited = known.apply(list(edits), where)
    expected = np.clip(edited.calibration.apply(edited.albedo()), 0, 1)
    np.testing.assert_array_equal(seen, expected)
