import struct

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour import LINEAR, SRGB
from cutis.errors import CutisError
from cutis.textures import Texture, read_texture, write_texture

STORED = [
    ("png", "uint8"),
    ("png", "uint16"),
    ("tif", "uint8"),
    ("tif", "uint16"),
    ("tif", "float32"),
    ("exr", "float16"),
    ("exr", "float32"),
]
STRAIGHT = {"oiio:UnassociatedAlpha": 1}


def pixels_of(random, dtype, count=3, size=(33, 21)):
    scale = np.iinfo(dtype).max + 1 if dtype.startswith("u") else 1
    pixels = (random.random((*size, count)) * scale).astype(dtype)
    if count == 4:  # colour under transparency must survive
        pixels[:9, :, 3] = 0
        pixels[9:20, :, 3] = scale - 1 if dtype.startswith("u") else 1
    return pixels


def rewritten(path, where, suffix=None):
    one = read_texture(path)
    new = one.with_linear(one.linear(), np.full(one.shape, where))
    out = path.with_name("out").with_suffix(suffix or path.suffix)
    write_texture(new, out)
    assert [p.name for p in path.parent.iterdir() if p.name.startswith(".")] == []
    return out


@pytest.mark.parametrize(("extension", "dtype"), STORED)
@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("where", [False, True])
def test_identity_keeps_every_bit(tmp_path, make, random, extension, dtype, count, where):
    pixels = pixels_of(random, dtype, count)
    straight = STRAIGHT if count == 4 and extension != "exr" else None
    path = make.image(tmp_path / f"a.{extension}", pixels, attributes=straight)
    before, spec = make.read(path)
    after, again = make.read(rewritten(path, where))
    assert before.tobytes() == pixels.tobytes()
    assert (after.dtype, again.channelnames) == (before.dtype, spec.channelnames)
    same = after == before
    if extension == "exr" and count == 4 and where:
        assert same[before[..., 3] == 1].all()
        assert same[before[..., 3] == 0].all()
        np.testing.assert_allclose(after, before, rtol=2e-3)
    else:
        assert same.all()


@pytest.mark.parametrize("where", [False, True])
def test_identity_of_an_associated_integer_tiff(tmp_path, make, random, where):
    pixels = np.sort(pixels_of(random, "uint8", 4), axis=-1)  # colour never exceeds alpha
    path = make.image(tmp_path / "a.tif", pixels)
    assert read_texture(path).associated
    after, spec = make.read(rewritten(path, where))
    assert not spec.getattribute("oiio:UnassociatedAlpha")
    assert np.array_equal(after, pixels)


@pytest.mark.parametrize("extension", ["png", "tif", "exr", "jpg"])
def test_metadata_survives(tmp_path, make, random, extension):
    header = struct.pack(">I4s4s12s12s4s", 428, b"", b"\2\x10", b"mntrRGB XYZ ", b"", b"acsp")
    illuminant = struct.pack(">III", 0xF6D6, 0x10000, 0xD32D)  # libpng checks that it is D50
    content = header.ljust(68, b"\0") + illuminant
    profile = np.frombuffer(content.ljust(132, b"\0") + random.bytes(296), np.uint8)
    given = {
        "Artist": "an artist",
        "ImageDescription": "left cheek, µ",
        "Copyright": "someone",
        "XResolution": 300.0,
        "YResolution": 300.0,
        "ResolutionUnit": "in",
        "Orientation": 6,
    }
    icc = {"ICCProfile": (oiio.TypeDesc(f"uint8[{len(profile)}]"), profile)}
    dtype = "float16" if extension == "exr" else "uint8"
    pixels = pixels_of(random, dtype)
    with_icc = given if extension == "exr" else given | icc  # OpenEXR holds no profile
    path = make.image(tmp_path / f"a.{extension}", pixels, attributes=with_icc)
    before, after = (make.read(p)[1] for p in (path, rewritten(path, True)))
    for name in given:
        assert before.getattribute(name) is not None, name
        assert after.getattribute(name) == before.getattribute(name), name
    if extension != "exr":
        assert np.array_equal(after.getattribute("ICCProfile"), profile)


def test_windows_tiles_mixed_types_and_extras_of_an_exr(tmp_path, make, random):
    pixels = random.random((64, 32, 5)).astype(np.float16).astype(np.float32)
    pixels[..., 4] = np.inf
    names, formats = ("R", "G", "B", "A", "Z"), ("half",) * 4 + ("float",)
    attributes = {"myNumber": 7, "compression": "piz"}
    path = make.image(tmp_path / "a.exr", pixels, names, attributes, formats, tile=16)
    after, spec = make.read(rewritten(path, False))
    assert np.array_equal(after, pixels)
    assert [str(t) for t in spec.channelformats] == list(formats)
    assert spec.tile_width == 16
    assert spec.getattribute("myNumber") == 7
    assert spec.getattribute("compression") == "piz"


def test_data_window_of_an_exr(tmp_path):
    path = str(tmp_path / "a.exr")
    spec = oiio.ImageSpec(8, 6, 3, "half")
    spec.x, spec.y, spec.full_width, spec.full_height = 3, 4, 100, 50
    out = oiio.ImageOutput.create(path)
    assert out.open(path, spec)
    assert out.write_image(np.zeros((6, 8, 3), np.float16))
    assert out.close()
    write_texture(read_texture(path), path)
    after = oiio.ImageInput.open(path).spec()
    assert (after.x, after.y, after.full_width, after.full_height) == (3, 4, 100, 50)


@pytest.mark.parametrize("compression", ["dwaa", "b44", "pxr24"])
def test_lossy_compression_gives_way(tmp_path, make, random, compression):
    pixels = random.random((64, 64, 3)).astype(np.float32)
    path = make.image(tmp_path / "a.exr", pixels, attributes={"compression": compression})
    before, _ = make.read(path)
    after, spec = make.read(rewritten(path, False))
    assert np.array_equal(after, before)
    assert spec.getattribute("compression") == "zip"


def test_tiled_planar_tiff(tmp_path, make, random):
    pixels = pixels_of(random, "uint16", 3, (64, 64))
    attributes = {"planarconfig": "separate", "compression": "lzw"}
    path = make.image(tmp_path / "a.tif", pixels, attributes=attributes, tile=32)
    after, spec = make.read(rewritten(path, True))
    assert np.array_equal(after, pixels)
    assert (spec.tile_width, spec.getattribute("compression")) == (32, "lzw")
    for suffix in (".png", ".exr", ".jpg"):  # asked for tiles, PNG and JPEG crash
        make.read(rewritten(path, False, suffix))


def test_camera_data_survives_in_jpeg_and_png(tmp_path, make, random):
    for name in ("a.jpg", "a.png"):
        attributes = {"Make": "a camera", "Exif:PhotographicSensitivity": 200}
        path = make.image(tmp_path / name, pixels_of(random, "uint8"), attributes=attributes)
        _, spec = make.read(rewritten(path, True))
        assert {key: spec.getattribute(key) for key in attributes} == attributes


def test_tiff_with_spare_channels_and_alpha(tmp_path, make, random):
    path = make.tiff(tmp_path / "a.tif", 4, 3, 5, extra=[0, 2], data=random.bytes(60))
    before, spec = make.read(path)
    after, again = make.read(rewritten(path, True))
    assert np.array_equal(after, before)
    assert again.channelnames == spec.channelnames


@pytest.mark.parametrize("extension", ["tif", "dpx"])
@pytest.mark.parametrize("bits", [10, 12])
def test_ten_and_twelve_bits_survive(tmp_path, make, random, extension, bits):
    path = make.image(
        tmp_path / f"a.{extension}", pixels_of(random, "uint16"),
        attributes={"oiio:BitsPerSample": bits},
    )  # fmt: skip
    after, spec = make.read(rewritten(path, True))
    assert np.array_equal(after, make.read(path)[0])
    assert spec.getattribute("oiio:BitsPerSample") == bits


@pytest.mark.parametrize(("extension", "dtype"), STORED)
@pytest.mark.parametrize(
    ("suffix", "expected"),
    [
        (".png", {"uint8": "uint8"}),
        (".jpg", dict.fromkeys(("uint8", "uint16", "float16", "float32"), "uint8")),
        (".TIFF", {"uint8": "uint8", "uint16": "uint16", "float16": "float32"}),
        (".exr", {"uint8": "float16", "float16": "float16"}),
    ],
)
@pytest.mark.parametrize("count", [3, 4])
def test_every_format_to_every_other(
    tmp_path, make, random, extension, dtype, suffix, expected, count
):
    smooth = np.linspace(0.1, 0.9, 16 * 16).reshape(16, 16, 1) * np.ones(count)
    pixels = (smooth * (np.iinfo(dtype).max if dtype[0] == "u" else 1)).astype(dtype)
    if count == 4:
        pixels[..., 3] = 1 if dtype[0] == "f" else np.iinfo(dtype).max // 2
    straight = STRAIGHT if count == 4 and extension != "exr" else None
    path = make.image(tmp_path / f"a.{extension}", pixels, attributes=straight)
    one = read_texture(path)
    write_texture(one, tmp_path / f"out{suffix}")
    two = read_texture(tmp_path / f"out{suffix}")
    other = {".png": "uint16", ".TIFF": "float32", ".exr": "float32"}
    assert two.pixels.dtype == expected.get(dtype, other.get(suffix))
    assert len(two.channels) == (3 if suffix == ".jpg" else count)
    assert two.space == (LINEAR if two.pixels.dtype.kind == "f" else SRGB)
    np.testing.assert_allclose(two.linear(), one.linear(), atol=0.02 if suffix == ".jpg" else 2e-3)
    if two.alpha() is not None:
        np.testing.assert_allclose(two.alpha(), one.alpha(), atol=1e-3)
    if (dtype, suffix, count) == ("uint8", ".exr", 3):  # half holds 8 bit exactly
        write_texture(two, tmp_path / "back.png")
        back = read_texture(tmp_path / "back.png").with_linear(
            two.linear(), two.linear()[..., 0] > -1
        )
        assert abs(back.pixels.astype(int) // 257 - pixels).max() <= 1


def test_layered_exr_to_png_and_back_in_place(tmp_path, make, random):
    pixels = random.random((4, 5, 5)).astype(np.float16)
    names = ("Z", "skin.A", "skin.B", "skin.G", "skin.R")
    path = make.image(tmp_path / "a.exr", pixels, names)
    before, spec = make.read(path)
    write_texture(read_texture(path), path)
    after, again = make.read(path)
    assert again.channelnames == spec.channelnames
    assert np.array_equal(after, before)
    write_texture(read_texture(path), tmp_path / "out.png")
    out = read_texture(tmp_path / "out.png")
    assert out.channels == ("R", "G", "B", "A")
    np.testing.assert_allclose(
        out.linear(), read_texture(path).linear().clip(0, 1), atol=2e-4, rtol=0
    )


def test_a_texture_from_an_array(tmp_path):
    pixels = np.linspace(0, 1, 48, dtype=np.float32).reshape(4, 4, 3)
    one = Texture(pixels, ("R", "G", "B"), LINEAR)
    for name in ("a.exr", "a.tif"):
        write_texture(one, tmp_path / name)
        assert np.array_equal(read_texture(tmp_path / name).pixels, pixels)


def test_profile_goes_with_its_space(tmp_path, make, random):
    """A made-up profile cannot be used; it stays where the values stay, and goes with them."""
    profile = np.zeros(200, np.uint8)
    icc = {"ICCProfile": (oiio.TypeDesc("uint8[200]"), profile), "Artist": "me"}
    path = make.image(tmp_path / "a.tif", pixels_of(random, "float32"), attributes=icc)
    assert read_texture(path).origin.startswith("assumed, its ICC profile cannot be used")
    _, spec = make.read(rewritten(path, True))
    assert len(spec.getattribute("ICCProfile")) == 200
    _, spec = make.read(rewritten(path, False, ".png"))
    assert spec.getattribute("ICCProfile") is None
    assert spec.getattribute("Artist") == "me"


@pytest.mark.parametrize("name", ["a.gif", "a", "a.webp", "png"])
def test_unknown_extensions_are_refused(tmp_path, one_line, name):
    one = Texture(np.zeros((2, 2, 3), np.uint8), ("R", "G", "B"), SRGB)
    with pytest.raises(CutisError, match="extension") as caught:
        write_texture(one, tmp_path / name)
    one_line(caught, tmp_path / name)
    assert not list(tmp_path.iterdir())
