"""Maps on disk: exact, self-describing, and able to find their capture again."""

import dataclasses
import hashlib
import json
import shutil

import numpy as np
import pytest

import cutis
from cutis.errors import CutisError
from cutis.looks import presets
from cutis.maps import (
    DEFAULT,
    estimate,
    find_source,
    load_maps,
    load_model,
    save_maps,
    source_note,
)
from cutis.optics import ALIAGA2022, NAMES, PARAMETERS
from cutis.textures import read_channels, read_texture, write_channels

CONVERTED = '{"gains": [1, 1, 1], "origin": "none", "light": "A", "conversion": %s}'


@pytest.fixture
def made(write_face, face_mask, tmp_path):
    """(capture, maps file, maps) as `cutis estimate` leaves them: out/face.skin.exr."""
    capture = write_face(tmp_path)
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / "face.skin.exr"
    skin = estimate(cutis.read(capture), face_mask, white=(1.1, 1.0, 0.93))
    skin = dataclasses.replace(skin, notes=source_note(read_texture(capture)))
    skin.save(path)
    return capture, path, skin


def test_float_round_trip_is_exact(made):
    _, path, skin = made
    again = load_maps(path)
    for name in (*NAMES, "mask"):
        np.testing.assert_array_equal(getattr(again, name), getattr(skin, name))
    assert again.calibration == skin.calibration
    assert again.model == skin.model
    assert again.provenance == {**skin.provenance, "source": "../face.png"}
    assert again.source is None
    assert again.original is None
    assert (again.edits, again.clamped) == ((), ())


def test_half_round_trip_is_within_half_precision(made, tmp_path):
    _, _, skin = made
    skin.save(tmp_path / "half.exr", "half")
    again = load_maps(tmp_path / "half.exr")
    for known in PARAMETERS:
        new, old = getattr(again, known.name), getattr(skin, known.name)
        np.testing.assert_allclose(new, old, rtol=2**-11, atol=1e-7)
    ends = skin.replace(melanin=0.001, oxygenation=0.999, thickness=250, eumelanin=0.001)
    ends.save(tmp_path / "ends.exr", "half")
    load_maps(tmp_path / "ends.exr")


def test_header_says_what_is_in_the_file(made):
    capture, path, _ = made
    channels, header = read_channels(path)
    trust = [*(f"{name}.sigma" for name in NAMES), "confidence"]
    assert set(channels) == {*NAMES, "mask", *(trust if load_model().to_trust else [])}
    for known in PARAMETERS:
        assert f"[{known.unit}]" in header[f"cutis:{known.name}"]
        assert f"{known.low:g} to {known.high:g}" in header[f"cutis:{known.name}"]
    assert header["cutis:model"] == DEFAULT
    assert json.loads(header["cutis:calibration"])["gains"] == [1.1, 1.0, 0.93]
    assert header["cutis:source"] == "../face.png"
    assert header["cutis:source_sha256"] == hashlib.sha256(capture.read_bytes()).hexdigest()
    assert header["cutis:source_colorspace"] == "auto"


@pytest.mark.parametrize("header", [{"cutis:model": "default"}, {}], ids=["default", "none"])
def test_files_from_before_the_measured_model_are_of_the_exact_one(made, header, tmp_path):
    channels, notes = read_channels(made[1])
    notes = {key: value for key, value in notes.items() if key.startswith("cutis:")}
    del notes["cutis:model"]
    write_channels(tmp_path / "old.skin.exr", channels, "float", notes | header)
    old = load_maps(tmp_path / "old.skin.exr")
    assert old.model == "aliaga2022-exact"
    assert old.tissue is ALIAGA2022


def test_edited_maps_edited_again_are_as_if_edited_at_once(made, tmp_path):
    """The file keeps what the maps were before, so that the ratio is against the capture."""
    capture, _, skin = made
    face = cutis.read(capture)
    once = skin.apply(presets.tanning).multiply(blood=1.7)
    skin.apply(presets.tanning).save(tmp_path / "tanned.exr")
    twice = load_maps(tmp_path / "tanned.exr").multiply(blood=1.7)
    assert twice.edits == once.edits
    assert twice.clamped == once.clamped
    np.testing.assert_array_equal(twice.retouch(face).pixels, once.retouch(face).pixels)
    np.testing.assert_array_equal(twice.original.parameters(), skin.parameters())
    channels, _ = read_channels(tmp_path / "tanned.exr")
    assert {name for name in channels if name.startswith("original.")} == {
        "original.melanin",
        "original.eumelanin",
    }


def test_edited_half_maps_change_only_what_was_edited(made, tmp_path):
    capture, _, skin = made
    face = cutis.read(capture)
    paint = np.zeros(skin.shape)
    paint[:, :16] = 1
    skin.multiply(melanin=2, where=paint).save(tmp_path / "half.exr", "half")
    retouched = load_maps(tmp_path / "half.exr").retouch(face)
    np.testing.assert_array_equal(retouched.pixels[:, 16:], face.pixels[:, 16:])
    assert np.any(retouched.pixels[:, :16] != face.pixels[:, :16])


def test_source_is_found_where_the_header_says(made):
    capture, path, _ = made
    assert find_source(load_maps(path).provenance, path).samefile(capture)


def test_source_is_found_beside_the_maps_after_both_moved(made, tmp_path):
    capture, path, _ = made
    (tmp_path / "elsewhere" / "deep").mkdir(parents=True)
    new = tmp_path / "elsewhere" / "deep"
    shutil.move(capture, new / "face.png")
    shutil.move(path, new / "face.skin.exr")
    moved = new / "face.skin.exr"
    assert find_source(load_maps(moved).provenance, moved) == new / "face.png"
    (new.parent / "face.png").write_bytes(b"another file of that name, where the header points")
    assert find_source(load_maps(moved).provenance, moved) == new / "face.png"


def test_source_may_be_given(made, tmp_path):
    capture, path, _ = made
    copy = tmp_path / "copy.png"
    shutil.move(capture, copy)
    assert find_source(load_maps(path).provenance, path, copy) == copy


def test_a_missing_source(made):
    capture, path, _ = made
    capture.unlink()
    with pytest.raises(CutisError, match=r"face\.png of face\.skin\.exr is missing; give it with"):
        find_source(load_maps(path).provenance, path)


def test_a_changed_source(made):
    capture, path, _ = made
    capture.write_bytes(capture.read_bytes() + b" ")
    with pytest.raises(CutisError, match=r"face\.png has changed since face\.skin\.exr"):
        find_source(load_maps(path).provenance, path)
    with pytest.raises(CutisError, match="has changed"):
        find_source(load_maps(path).provenance, path, capture)


def test_maps_without_a_source(made, tmp_path):
    _, _, skin = made
    dataclasses.replace(skin, notes={}).save(tmp_path / "bare.exr")
    with pytest.raises(CutisError, match="does not name its capture; give it with --source"):
        find_source(load_maps(tmp_path / "bare.exr").provenance, tmp_path / "bare.exr")


def spoiled(path, out, header=None, **changes):
    """A copy of a maps file with channels replaced (None: left out) and header entries changed."""
    channels, metadata = read_channels(path)
    channels = {k: v for k, v in {**channels, **changes}.items() if v is not None}
    write_channels(out, channels, "float", {**metadata, **(header or {})})
    return out


@pytest.mark.parametrize(
    ("changes", "header", "message"),
    [
        ({"blood": None}, {}, "not a file of skin maps .no channel blood"),
        ({"melanin": 2.0}, {}, r"texels of melanin are outside 0\.001 to 1"),
        ({"thickness": np.nan}, {}, "texels of thickness are outside"),
        ({"mask": 0.0}, {}, "mask is empty"),
        ({"mask": np.nan}, {}, "mask is empty or not within"),
        ({"mask": 3.0}, {}, "mask is empty or not within"),
        ({}, {"cutis:calibration": "gains"}, "header is damaged"),
        ({}, {"cutis:calibration": '{"gains": [1, 2]}'}, "header is damaged"),
        ({}, {"cutis:calibration": '{"gains": [0, 1, 1], "origin": ""}'}, "header is damaged"),
        ({}, {"cutis:calibration": CONVERTED % "[[1, 0], [0, 1]]"}, "header is damaged"),
        ({}, {"cutis:calibration": CONVERTED % "[[1,1,1], [1,1,1], [1,1,1]]"}, "header is damaged"),
        ({}, {"cutis:calibration": CONVERTED % "[[NaN,0,0], [0,1,0], [0,0,1]]"}, "is damaged"),
        ({}, {"cutis:calibration": CONVERTED % '"A"'}, "header is damaged"),
        ({}, {"cutis:edits": "[3]"}, "header is damaged"),
    ],
)
def test_damaged_maps_are_refused_in_one_line(made, tmp_path, changes, header, message):
    _, path, skin = made
    arrays = {
        name: None if value is None else np.full(skin.shape, value, np.float32)
        for name, value in changes.items()
    }
    bad = spoiled(path, tmp_path / "bad.exr", header, **arrays)
    with pytest.raises(CutisError, match=message) as caught:
        load_maps(bad)
    assert "bad.exr" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_maps_from_before_lights_were_known_are_of_d65(made, tmp_path):
    _, path, skin = made
    header = {"cutis:calibration": '{"gains": [1.1, 1.0, 0.93], "origin": "given"}'}
    again = load_maps(spoiled(path, tmp_path / "old.exr", header)).calibration
    assert (again.light, again.conversion, again.gains) == ("D65", None, skin.calibration.gains)


def test_a_file_without_a_mask_is_skin_all_over(made, tmp_path):
    _, path, skin = made
    whole = {name: np.maximum(getattr(skin, name), 0.1) for name in NAMES}
    whole["thickness"] = np.maximum(whole["thickness"], 10)
    out = spoiled(path, tmp_path / "whole.exr", mask=None, **whole)
    assert np.all(load_maps(out).mask == 1)


def test_maps_are_stored_as_float_or_half(made, tmp_path):
    _, _, skin = made
    with pytest.raises(CutisError, match="float or half, not uint8"):
        save_maps(skin, tmp_path / "maps.exr", "uint8")
    with pytest.raises(CutisError, match=r"end the name in \.exr"):
        save_maps(skin, tmp_path / "maps.png")
    assert not list(tmp_path.glob("maps*"))
