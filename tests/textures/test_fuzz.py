"""Damaged, odd and absurd files, read in a process that may die of them.

`studies/fuzz.py` does the same to tens of thousands.
"""

import os
import signal
import struct
import threading
import zlib

import numpy as np
import pytest
from hostile.mutations import mutate
from hostile.reader import Outcome, Reader
from hostile.seeds import (
    icc_profile,
    pixels,
    png,
    png_chunk,
    profile_attribute,
    psd,
    seeds,
    tiff,
    write,
)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cutis.textures.icc import icc_space

FORMATS = ("png", "jpg", "tif", "tx", "exr", "dpx", "psd")
LITTLE = 400 << 20


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Whole files by format, and their contents."""
    paths = seeds(tmp_path_factory.mktemp("seeds"))
    return {kind: [p for p in paths if p.suffix == f".{kind}"] for kind in FORMATS}


@pytest.fixture(scope="module")
def reader():
    reader = Reader()
    yield reader
    reader.close()


@pytest.fixture
def read(reader, tmp_path):
    """Reads a content under a name; checks that it ends well, or in one line."""

    def read(name: str, content: bytes) -> Outcome:
        path = tmp_path / name
        path.write_bytes(content)
        outcome = reader.read(path)
        assert outcome.findings == []
        assert outcome.memory < LITTLE
        return outcome

    return read


def test_a_reader_that_dies_or_hangs_is_a_finding(whole, monkeypatch):
    reader, path = Reader(), whole["png"][2]
    assert reader.read(path).good["texture"]
    number = reader.pid
    os.kill(number, signal.SIGSTOP)
    death = threading.Timer(0.2, os.kill, (number, signal.SIGKILL))
    death.start()
    assert reader.read(path).findings == ["crash SIGKILL"]
    death.join()
    assert reader.read(path).findings == []
    monkeypatch.setattr("hostile.reader.SECONDS", 0.3)
    os.kill(reader.pid, signal.SIGSTOP)
    assert reader.read(path).findings == ["hang 0 s"]
    monkeypatch.undo()
    assert reader.read(path).good["texture"]
    reader.close()


@given(data=st.data())
@settings(
    max_examples=1000, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_damage_ends_in_a_result_or_one_line(data, whole, reader, tmp_path):
    random = data.draw(st.randoms(use_true_random=False))
    kind = random.choice(FORMATS)
    one, other = random.choice(whole[kind]), random.choice(whole[random.choice(FORMATS)])
    damage, content = mutate(one.read_bytes(), other.read_bytes(), random)
    path = tmp_path / one.name
    path.write_bytes(content)
    outcome = reader.read(path)
    assert outcome.findings == [], f"{damage} of {one.name}"
    if damage == "truncate":
        first = reader.read(one)
        for way, good in outcome.good.items():
            assert not good or outcome.results[way] == first.results[way]


def test_whole_files_are_read_or_refused_for_what_they_are(whole, reader):
    """Else the fuzzing would test how rubbish is refused."""
    odd = (
        "grey palette palette1 palette4 cmyk bit lab deep deep-tiled nan eleven log indexed layers"
    )
    odd += " uint8-1 uint8-2 uint16-1 uint16-2"
    for path in (path for paths in whole.values() for path in paths):
        outcome = reader.read(path)
        assert outcome.findings == []
        expected = "maps" if ".skin" in path.name else "texture"
        refused = path.stem in odd.split() and path.name != "layers.psd"
        assert outcome.good[expected] != refused, (path.name, outcome.results)


@pytest.mark.parametrize("kind", ["png", "jpg", "tif", "exr", "dpx"])
@pytest.mark.parametrize("size", [(1, 1), (1, 32768), (32768, 1), (1, 65535), (65535, 1)])
def test_thin_files(kind, size, read, tmp_path):
    if kind == "jpg" and max(size) > 65500:
        pytest.skip("libjpeg writes no more than 65500")
    dtype = {"exr": "float16"}.get(kind, "uint8")
    content = write(tmp_path / f"whole.{kind}", pixels(dtype, 3, size)).read_bytes()
    outcome = read(f"thin.{kind}", content)
    assert outcome.good["texture"] == (max(size) <= 32768)
    if max(size) > 32768:
        assert "the limit is 32768 × 32768" in outcome.results["texture"]


def claiming(kind: str, content: bytes, width: int, height: int) -> bytes:
    """The file with other sizes in its header."""
    out = bytearray(content)
    if kind == "png":
        return png(width, height, bytes(1000))
    if kind == "jpg":
        at = max(out.find(b"\xff\xc0\0"), out.find(b"\xff\xc2\0"))
        struct.pack_into(">HH", out, at + 5, min(height, 65535), min(width, 65535))
    elif kind == "tif":
        return tiff(width, height, 3, data=bytes(100))
    elif kind == "exr":
        for window in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
            at = out.find(window) + len(window) + 4
            struct.pack_into("<4i", out, at, 0, 0, width - 1, height - 1)
    elif kind == "dpx":
        struct.pack_into(">II", out, 772, width, height)
    else:
        struct.pack_into(">II", out, 14, height, width)
    return bytes(out)


@pytest.mark.parametrize("size", [(100_000, 100_000), (100_000, 4), (30_000, 30_000), (9000, 9000)])
@pytest.mark.parametrize("kind", ["png", "jpg", "tif", "exr", "dpx", "psd"])
def test_headers_that_claim_much_and_have_nothing(kind, size, whole, read):
    for path in whole[kind]:
        if path.name not in ("big.tif", "little.dpx"):
            outcome = read(path.name, claiming(kind, path.read_bytes(), *size))
            assert not any(outcome.good.values()), path.name
            assert outcome.seconds < 5


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("deep.exr", "deep image"),
        ("deep-tiled.exr", "deep image"),
        ("palette.png", "palette"),
        ("palette4.png", "palette"),
        ("palette.tif", "palette"),
        ("palette1.tif", "palette"),
        ("indexed.psd", "palette"),
        ("cmyk.jpg", "CMYK"),
        ("cmyk.tif", "CMYK"),
        ("cmyk.psd", "CMYK"),
        ("bit.png", "grey"),
        ("bit.tif", "grey"),
        ("bit.psd", "grey"),
        ("grey.jpg", "grey"),
        ("grey.exr", "grey"),
        ("grey.dpx", "grey"),
        ("lab.tif", "colour model"),
        ("lab.psd", "colour model"),
        ("nan.exr", "128 texels are NaN or infinite, the first at row 16, column 16"),
        ("nan.tif", "128 texels are NaN or infinite, the first at row 16, column 16"),
        ("layers.exr", "several layers"),
    ],
)
def test_what_is_no_rgb_texture(name, says, whole, read):
    path = next(p for p in whole[name.rsplit(".")[-1]] if p.name == name)
    outcome = read(name, path.read_bytes())
    assert says in outcome.results["texture"]


@pytest.mark.parametrize(
    "name",
    ["mip-uint8.tx", "mip-float32.tx", "mip.exr", "parts.exr", "tiled.tif", "planar-tiled.tif",
     "pages.tif", "10-packed.dpx", "12.dpx", "16.psd", "packed16.psd", "dwaa-tiled.exr"],
)  # fmt: skip
def test_what_is_a_texture(name, whole, read):
    path = next(p for p in whole[name.rsplit(".")[-1]] if p.name == name)
    assert read(name, path.read_bytes()).good["texture"]


@given(data=st.data())
@settings(max_examples=300, deadline=None)
def test_damaged_profiles_are_spaces_or_say_why_not(data):
    """A damaged ICC profile gives a space with finite colours, or ValueError."""
    profile = icc_profile(data.draw(st.sampled_from(["para", "curv"])))
    random = data.draw(st.randoms(use_true_random=False))
    _, content = mutate(profile, profile, random)
    colours = np.linspace(0, 1, 30).reshape(-1, 3)
    try:
        space = icc_space(content)
    except ValueError:
        return
    assert np.isfinite(space.to_linear_srgb(colours)).all()
    assert np.isfinite(space.from_linear_srgb(colours)).all()


@pytest.mark.parametrize("kind", ["png", "tif", "jpg"])
def test_damaged_profiles_in_files(kind, read, tmp_path):
    profile = bytearray(icc_profile())
    for at in range(0, len(profile), 37):
        damaged = profile.copy()
        damaged[at : at + 4] = b"\xff\xff\xff\xff"
        if kind == "png":
            chunk = png_chunk(b"iCCP", b"mine\0\0" + zlib.compress(damaged))
            content = png(4, 4, bytes(4 * 13), extra=chunk)
        else:
            attribute = profile_attribute(bytes(damaged))
            path = tmp_path / f"whole.{kind}"
            content = write(path, pixels("uint8", 3, (4, 4)), ICCProfile=attribute).read_bytes()
        assert read(f"profile.{kind}", content).good["texture"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"gains"', b'"gainz"'),
        (b"[1.1, 1.0, 0.9]", b"[1.1, 0.0, 0.9]"),
        (b"[1.1, 1.0, 0.9]", b"[1.1, NaN, 0.9]"),
        (b"[1.1, 1.0, 0.9]", b"{1.1, 1.0, 0.9}"),
        (b"[1.1, 1.0, 0.9]", b"[[1.1,1.0,0.9]]"[:15]),
        (b'{"gains"', b'["gains"'),
        (b"melanin\0", b"melanim\0"),
        (b"melanin x0.5", b"\x1b[2J\xff\xfe  x0.5"),
        (b"face.png", b"\xff\xfe.\x1b[2J\n"),
    ],
)
def test_maps_with_other_headers(old, new, whole, read):
    path = next(p for p in whole["exr"] if p.name == "edited.skin.exr")
    content = path.read_bytes()
    assert old in content
    assert len(old) == len(new)
    assert read("edited.skin.exr", content).good["maps"]
    read("edited.skin.exr", content.replace(old, new))


def test_psd_of_each_size_of_sample(read):
    for bits in (8, 16, 32):
        outcome = read("a.psd", psd((3, 5), bits=bits))
        assert outcome.good["texture"]
        assert not read("a.psd", psd((3, 5), bits=bits)[:-1]).good["texture"]


@pytest.mark.slow
def test_the_command_leaves_nothing_of_damaged_files(whole, tmp_path):
    reader = Reader("command")
    names = ("uint8-3.png", "444.jpg", "none.tif", "mip-float32.tx", "zip.exr", "8.dpx", "8.psd")
    for path in (path for paths in whole.values() for path in paths if path.name in names):
        content = path.read_bytes()
        cut = tmp_path / path.name
        cut.write_bytes(content[: len(content) // 3])
        outcome = reader.read(cut)
        assert outcome.findings == []
        assert not outcome.good["command"], path.name
    reader.close()
