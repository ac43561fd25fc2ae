"""Another tone: the median is hit, what is no skin stays, and the same comes of any way there."""

import numpy as np
import pytest

import cutis
from cutis.colour import delta_e, encode_srgb, ita, lab
from cutis.colour.spaces import LINEAR
from cutis.colour.swatches import MONK, swatch
from cutis.errors import CutisError
from cutis.looks import Look, tone_look
from cutis.looks.tone import nearest_tone
from cutis.looks.tone_fit import monge
from cutis.looks.tone_path import tone_path
from cutis.maps import Face, MapsFile, bound
from cutis.textures import Texture
from tests.conftest import ROOT

EXAMPLES = ROOT / "examples"


@pytest.fixture(scope="module")
def capture():
    """The bundled capture at a sixth: colours and mask."""
    face = cutis.read(EXAMPLES / "bioskin_capture1.jpg")
    mask = cutis.read_mask(EXAMPLES / "bioskin_capture1_mask.jpg", face.shape)
    high, wide = (side // 6 * 6 for side in face.shape)
    colours = face.linear()[:high, :wide].reshape(high // 6, 6, wide // 6, 6, 3).mean((1, 3))
    return colours.astype(np.float32), np.ascontiguousarray(mask[3:high:6, 3:wide:6])


@pytest.fixture(scope="module")
def skin(capture):
    return cutis.estimate(*capture, white="auto")


@pytest.fixture(scope="module")
def sure(skin):
    return (skin.mask > 0) & (skin.confidence >= 0.5)


def calibrated(skin, colours):
    return skin.calibration.apply(colours)


@pytest.mark.parametrize("tone", [55, 0, -40])
def test_the_asked_ita_is_hit(skin, sure, tone):
    found = calibrated(skin, skin.to_tone(f"ita:{tone}").albedo()[sure])
    assert float(np.median(ita(found))) == pytest.approx(tone, abs=0.2)


def test_a_colour_is_the_median_of_the_file(skin, sure):
    found = np.median(skin.to_tone("#8d5524").albedo()[sure], axis=0)
    assert delta_e(found, swatch("8d5524")) < 0.5
    np.testing.assert_allclose(encode_srgb(swatch("8d5524")) * 255, [0x8D, 0x55, 0x24], atol=1e-3)


def test_a_swatch_is_the_nearest_measured_tone(skin, sure):
    path = tone_path()
    wanted = [nearest_tone(path, swatch(one)) for one in MONK]
    assert (np.diff(wanted) <= 0).all()
    assert (np.diff(wanted[4:9]) < -5).all()  # lighter and darker ones are no tones of skin
    found = calibrated(skin, skin.to_tone("monk:7").albedo()[sure])
    assert float(np.median(ita(found))) == pytest.approx(wanted[6], abs=0.2)


def test_all_five_maps_move_as_people_differ(skin, sure):
    dark = skin.to_tone("ita:-30")
    before, after = (np.median(one.parameters()[sure], axis=0) for one in (skin, dark))
    model = skin.model
    path = tone_path()
    there = model.encode(np.exp(path.colour(-30))[None].astype(np.float32))[0]
    assert after[0] > 2.5 * before[0]
    # melanin and thickness are those of measured skin of that tone, within what people differ by
    assert after[0] == pytest.approx(there[0], rel=0.35)
    assert (after != before).all()


def test_what_is_no_skin_stays(skin, capture):
    colours, _ = capture
    dark = skin.to_tone("ita:-40").albedo()
    off = skin.mask == 0
    assert (dark[off] == colours[off]).all()
    hair = (skin.mask > 0) & (calibrated(skin, colours).max(axis=-1) < 0.03)
    assert hair.sum() > 20
    assert (dark[hair] == colours[hair]).mean() > 0.9


def test_redness_stays_redness(skin, sure, capture):
    """The nose is redder than the forehead before and after."""
    colours, _ = capture
    a = lab(calibrated(skin, colours))[..., 1]
    red = sure & (a > np.percentile(a[sure], 97))
    plain = sure & (a < np.percentile(a[sure], 60))
    after = lab(calibrated(skin, skin.to_tone("ita:0").albedo()))[..., 1]
    assert np.median(a[red]) - np.median(a[plain]) > 5
    assert np.median(after[red]) - np.median(after[plain]) > 2


def test_contrast_becomes_that_of_the_tone(skin, sure):
    path = tone_path()
    before, after = (
        np.log(np.maximum(calibrated(skin, one.albedo()[sure]), 1e-3))
        for one in (skin, skin.to_tone("ita:-20"))
    )
    ratio = np.sqrt(after.var(axis=0).sum() / before.var(axis=0).sum())
    assert 1 < ratio < 1.3 * path.contrast(-20) / path.contrast(33)


def test_there_and_back(skin, sure, capture):
    """Back from darker skin the face is near what it was."""
    colours, mask = capture
    start = float(np.median(ita(calibrated(skin, colours[sure]))))
    dark = skin.to_tone("ita:0").albedo()
    again = cutis.estimate(dark, mask, white=skin.calibration.gains)
    back = again.to_tone(f"ita:{start}").albedo()
    apart = delta_e(calibrated(skin, back[sure]), calibrated(skin, colours[sure]))
    assert np.median(apart) < 3


def test_like_another_face(skin, sure, capture):
    _, mask = capture
    other = skin.to_tone("ita:-10").albedo()
    other = cutis.estimate(other, mask, white=skin.calibration.gains)
    found = skin.to_tone(other).albedo()
    wanted = np.median(calibrated(skin, other.source[sure]), axis=0)
    assert delta_e(np.median(calibrated(skin, found[sure]), axis=0), wanted) < 0.7


def test_half_of_a_tone_is_between(skin, sure):
    whole = skin.apply(tone_look("ita:-20")).albedo()[sure]
    half = skin.apply(tone_look("ita:-20"), amount=0.5).albedo()[sure]
    none = skin.albedo()[sure]
    assert np.median(whole[:, 0]) < np.median(half[:, 0]) < np.median(none[:, 0])


@pytest.mark.parametrize("large", [False, True])
def test_bands_make_no_difference(skin, tmp_path, large):
    """Large textures are looked at in squares first, small ones are folded."""
    part = skin
    if large:
        some = np.s_[:500, 130:210]
        grown = [np.repeat(np.repeat(one[some], 4, 0), 4, 1) for one in (skin.source, skin.mask)]
        part = cutis.estimate(*grown, white=skin.calibration.gains)
    path = tmp_path / "face.skin.exr"
    part.save(path)
    look = tone_look("ita:-20")
    loaded = cutis.load(path, None)
    whole = loaded.apply(look)
    with MapsFile(path) as file:
        changes = bound([look], Face(file))
        for start in range(0, part.shape[0], 97):
            rows = slice(start, min(start + 97, part.shape[0]))
            banded = file.edited(rows, changes)
            for name in ("melanin", "blood", "eumelanin"):
                assert (banded.map(name) == whole.map(name)[rows]).all()
            assert (banded.sigma("blood") == whole.sigma("blood")[rows]).all()


def test_a_set_is_one_face(skin, capture, tmp_path):
    """Two tiles get the numbers of both, whichever is at hand."""
    from cutis.jobs.edit import EditJob
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.outcome import CaptureFiles

    colours, _ = capture
    middle = colours.shape[1] // 2
    for number, part in ((1001, colours[:, :middle]), (1002, colours[:, middle:])):
        texture = Texture(np.ascontiguousarray(part), ("R", "G", "B"), LINEAR)
        cutis.write(texture, tmp_path / f"face.{number}.exr")
    tiles = tuple(CaptureFiles(tmp_path / f"face.{n}.exr") for n in (1001, 1002))
    job = EstimateJob(tiles, tmp_path, white=skin.calibration.gains)
    maps = [job.stem(tile).with_name(job.stem(tile).name + ".skin.exr") for tile in tiles]
    job.run()
    pattern = maps[0].with_name(maps[0].name.replace("1001", "<UDIM>"))
    EditJob(pattern, tmp_path / "dark.<UDIM>.exr", tone_look("ita:-20")).run()
    found = np.concatenate(
        [cutis.read(tmp_path / f"dark.{n}.exr").linear() for n in (1001, 1002)], axis=1
    )
    loaded = [cutis.load(path) for path in maps]
    sure = np.concatenate([(m.mask > 0) & (m.confidence >= 0.5) for m in loaded], axis=1)
    assert float(np.median(ita(calibrated(skin, found[sure])))) == pytest.approx(-20, abs=0.4)
    for number, tile in zip((1001, 1002), loaded, strict=True):
        with_files = tile.to_tone("ita:-20").albedo()
        written = cutis.read(tmp_path / f"dark.{number}.exr").linear()
        np.testing.assert_array_equal(with_files, written)


def test_documents(tmp_path):
    look = tone_look("#8D5524").then(tone_look("ita:-20")).then(tone_look("monk:3"))
    look.save(tmp_path / "a.look.json")
    again = Look.load(tmp_path / "a.look.json")
    assert again.layers == look.layers
    assert again.words() == ("tone #8d5524", "tone ita:-20", "tone monk:3")
    with pytest.raises(CutisError, match=r"layer 1: it depends on the place"):
        look.check_everywhere()


@pytest.mark.parametrize(
    "wanted",
    ["ita:99", "ita:x", "ita:nan", "monk:0", "monk:11", "monk:1.5", "#12", "red", "", "a:b"],
)
def test_no_tone(wanted):
    with pytest.raises(CutisError, match="is no tone; use ita:-65"):
        tone_look(wanted)


def test_no_skin_has_it(skin):
    with pytest.raises(CutisError, match="layer 1, edit 1: tone #00ff00: no skin has this colour"):
        skin.to_tone("#00ff00")


def test_no_skin_to_start_from(capture):
    colours = np.full((8, 8, 3), (0.0, 0.2, 0.9), np.float32)
    with pytest.raises(CutisError, match="no tone to start from"):
        cutis.estimate(colours).to_tone("ita:0")


def test_paths_are_those_of_their_tones():
    path = tone_path()
    for tone in range(-56, 52, 4):
        assert float(ita(np.exp(path.colour(tone)))) == pytest.approx(tone, abs=2)
    # palms differ less between people than faces do
    ends = [
        np.ptp([float(ita(np.exp(tone_path(p).colour(t)))) for t in (50, -50)])
        for p in ("face", "palm")
    ]
    assert ends[1] < 0.7 * ends[0]
    assert path.contrast(-20) > 1.5 * path.contrast(40)


def test_monge_gives_the_other_covariance():
    rng = np.random.default_rng(5)
    a, b = (np.cov(rng.normal(size=(3, 20))) for _ in range(2))
    matrix = monge(a, b)
    np.testing.assert_allclose(matrix @ a @ matrix, b, rtol=1e-6)
