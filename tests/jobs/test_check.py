"""A check as a job: exit codes, seams of sets, copies that are mended."""

from dataclasses import replace

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

from cutis.checks import Finding, examine, gather
from cutis.colour import LINEAR, SRGB, encode_srgb
from cutis.jobs.check import Checked, CheckJob, code_of
from cutis.jobs.estimate import EstimateJob
from cutis.jobs.outcome import CaptureFiles
from cutis.maps import FileCapture
from cutis.textures import Texture, TextureFile, read_mask, read_texture, write_texture

NOTE, FINDING = Finding("a", "note", "a note."), Finding("b", "finding", "a finding.")


@pytest.fixture(scope="module")
def face(capture1):
    """A part of the example capture, without anything but skin."""
    return read_texture(capture1[0]).linear()[1000:1640, 700:1340]


def written(path, rgb, space=SRGB, dtype=np.uint8):
    blank = Texture(np.zeros(rgb.shape, dtype), ("R", "G", "B"), space)
    everywhere = np.ones(rgb.shape[:2], bool)
    write_texture(blank.with_linear(rgb, everywhere), path, space)
    return path


def kinds(checked):
    return {one.kind for one in checked.findings if one.level == "finding"}


@pytest.mark.parametrize(
    ("findings", "failure", "codes"),
    [((), None, (0, 0)), ((NOTE,), None, (0, 1)), ((NOTE, FINDING), None, (1, 1)),
     ((), "gone", (2, 2)), ((FINDING,), "gone", (2, 2))],
)  # fmt: skip
def test_exit_codes(tmp_path, findings, failure, codes):
    found = [Checked(tmp_path, findings, failure=failure), Checked(tmp_path)]
    assert (code_of(found, False), code_of(found, True)) == codes


def test_one_that_is_gone_leaves_the_others_alone(tmp_path, face):
    good = written(tmp_path / "good.png", face)
    job = CheckJob((CaptureFiles(tmp_path / "gone.png"), CaptureFiles(good)))
    gone, found = job.run()
    assert "no such file" in gone.failure
    assert found.failure is None
    assert found.tone is not None


def test_a_mask_of_another_size_is_found_and_left_out(tmp_path, face):
    path = written(tmp_path / "face.png", face)
    mask = written(tmp_path / "mask.png", np.ones((10, 10, 3), np.float32))
    (found,) = CheckJob((CaptureFiles(path, mask),)).run()
    assert "mask-size" in kinds(found)


def test_a_seam_between_tiles(tmp_path, face):
    left, right = face[:, :320], face[:, 320:]
    files = [written(tmp_path / "f.1001.png", left), written(tmp_path / "f.1002.png", right)]
    job = CheckJob(tuple(CaptureFiles(path) for path in files))
    assert not any("seam" in kinds(one) for one in job.run())
    written(files[1], 1.15 * right)
    first, second = job.run()
    assert "seam" in kinds(first)
    assert "seam" not in kinds(second)


def test_codes_in_floats_are_mended(tmp_path, face):
    codes = np.rint(255 * encode_srgb(face)).astype(np.float32)
    for name, values in (("wide", codes), ("unit", codes / 255)):
        path = written(tmp_path / f"{name}.exr", values, LINEAR, np.float32)
        before = path.read_bytes()
        (found,) = CheckJob((CaptureFiles(path),), fix=True).run()
        assert kinds(found) & {"scale", "colour-space"}
        assert found.mended == (tmp_path / f"{name}.fixed.exr",)
        assert path.read_bytes() == before
        again = read_texture(found.mended[0])
        assert again.space == LINEAR
        np.testing.assert_allclose(again.linear(), face, atol=2e-3)
        (mended,) = CheckJob((CaptureFiles(found.mended[0]),)).run()
        assert not kinds(mended) & {"scale", "colour-space"}


def test_a_turned_picture_is_stored_upright(tmp_path, face):
    texture = read_texture(written(tmp_path / "plain.tif", face[:400]))
    spec = oiio.ImageSpec(texture.spec)
    spec.attribute("Orientation", 6)
    path = tmp_path / "turned.tif"
    write_texture(replace(texture, spec=spec, turned=1), path)
    turned = read_texture(path)
    assert turned.turned == 6
    (found,) = CheckJob((CaptureFiles(path),), fix=True).run()
    assert "orientation" in {one.kind for one in found.findings}
    upright = read_texture(found.mended[0])
    assert upright.turned == 1
    np.testing.assert_array_equal(upright.pixels, turned.pixels)


def test_an_inverted_mask_is_mended(tmp_path, capture1):
    path, mask = capture1
    texture = read_texture(path)
    half = texture.linear()[::4, ::4]
    cover = read_mask(mask, texture.frame)[::4, ::4]
    face = written(tmp_path / "face.png", half)
    wrong = written(
        tmp_path / "mask.png",
        np.repeat(1 - (cover > 0.5).astype(np.float32)[..., None], 3, axis=-1),
    )
    (found,) = CheckJob((CaptureFiles(face, wrong),), fix=True).run()
    assert kinds(found) == {"mask-inverted"}
    mended = read_mask(found.mended[0], read_texture(face).frame)
    np.testing.assert_array_equal(mended > 0.5, cover > 0.5)


def test_the_digest_is_that_of_contents(tmp_path, face):
    path = written(tmp_path / "face.png", face)
    job = CheckJob((CaptureFiles(path),))
    assert job.digest() == replace(job, fix=True).digest()
    before = job.digest()
    written(path, 0.9 * face)
    assert job.digest() != before


@pytest.mark.parametrize("steady", [False, True])
def test_estimate_doubts_what_a_look_of_its_own_finds(steady, tmp_path):
    """Estimating gathers while it reads, also where models see bands again and again."""
    codes = np.random.default_rng(1).integers(0, 255, (70, 9000, 3), np.uint8)
    Image.fromarray(codes).save(tmp_path / "noise.png")
    files = CaptureFiles(tmp_path / "noise.png")
    (done,) = EstimateJob((files,), tmp_path / "out", steady=steady).run()
    with TextureFile(files.face) as texture:
        assert len(list(texture.bands())) > 1
        found = examine(gather(FileCapture(texture))).findings
    wanted = [(one.kind, one.sentence) for one in found if one.level == "finding"]
    assert wanted
    assert [(one.kind, one.sentence) for one in done.report.doubts] == wanted
