import struct

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour import LINEAR, SRGB, rgb_space
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


def with_icc(profile, **more):
    return {
        "ICCProfile": (oiio.TypeDesc(f"uint8[{len(profile)}]"), np.frombuffer(profile, np.uint8))
    } | more


def levels(path):
    """Pixels of each MIP level, by OpenImageIO alone."""
    source = oiio.ImageInput.open(str(path))
    found = []
    while source.seek_subimage(0, len(found)):
        spec = source.spec_dimensions(0, len(found))
        found.append(source.read_image(0, len(found), 0, spec.nchannels, "float"))
    source.close()
    return found


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
@pytest.mark.parametrize("size", [(64, 128), (100, 75), (1, 5)])
def test_tx_has_tiles_and_all_levels(tmp_path, make, random, dtype, size):
    path = make.image(tmp_path / "a.tif", pixels_of(random, dtype, 3, size))
    out = rewritten(path, False, ".tx")
    first, spec = make.read(out)
    assert (spec.tile_width, spec.tile_height) == (64, 64)
    assert spec.getattribute("textureformat") == "Plain Texture"
    assert np.array_equal(first, pixels_of(np.random.default_rng(20), dtype, 3, size))
    found = levels(out)
    sizes = [level.shape[:2] for level in found]
    expected = [size]
    while expected[-1] != (1, 1):
        expected.append(tuple(max(1, n // 2) for n in expected[-1]))
    assert sizes == expected
    for level in found if size != (1, 5) else []:  # of so few texels a filter keeps no mean
        np.testing.assert_allclose(level.mean(axis=(0, 1)), found[0].mean(axis=(0, 1)), atol=0.02)
    if size == (64, 128):
        quarter = found[0].reshape(32, 2, 64, 2, 3).mean(axis=(1, 3))
        np.testing.assert_allclose(found[1], quarter, atol=0.003)


def test_tx_keeps_what_the_file_says(tmp_path, make, random, icc):
    given = {"Artist": "me", "XResolution": 300.0, "YResolution": 300.0, "ResolutionUnit": "in"}
    attributes = with_icc(icc.profile(icc.ADOBE), **given)
    path = make.image(tmp_path / "a.tif", pixels_of(random, "uint8"), attributes=attributes)
    out = rewritten(path, False, ".tx")
    _, spec = make.read(out)
    assert {name: spec.getattribute(name) for name in given} == given
    assert bytes(bytearray(spec.getattribute("ICCProfile"))) == icc.profile(icc.ADOBE)
    assert read_texture(out).space.name == "by hand"


def test_tx_multiplies_by_alpha_and_comes_back_as_it_is(tmp_path, make, random):
    pixels = pixels_of(random, "uint16", 4, (80, 70))
    path = make.image(tmp_path / "a.tif", pixels, attributes=STRAIGHT)
    straight, tx = read_texture(path), read_texture(rewritten(path, False, ".tx"))
    assert tx.associated
    assert np.array_equal(tx.pixels[..., 3], pixels[..., 3])
    opaque = pixels[..., 3] > 60000
    np.testing.assert_allclose(tx.linear()[opaque], straight.linear()[opaque], atol=1e-4)
    path = tx.path.rename(tmp_path / "b.tx")
    again = read_texture(rewritten(path, False, ".tx"))
    assert np.array_equal(again.pixels, tx.pixels)
    assert len(levels(again.path)) == len(levels(path))


@pytest.mark.parametrize(("maker", "suffix"), [("tiff", ".tif"), ("openexr", ".exr")])
def test_editing_what_a_texture_maker_made(tmp_path, make, random, maker, suffix):
    """One level comes back, in tiles, without what was true of the texture that it was."""
    image = oiio.ImageBuf(oiio.ImageSpec(100, 70, 3, "float"))
    assert image.set_pixels(oiio.ROI(), random.random((70, 100, 3)).astype(np.float32))
    how = oiio.ImageSpec()
    for name, value in {"fileformatname": maker, "hash": 1, "constant_color_detect": 1}.items():
        how.attribute(f"maketx:{name}", value)
    path = tmp_path / "a.tx"
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, image, str(path), how)
    before, spec = make.read(path)
    assert spec.getattribute("oiio:AverageColor")
    for where in (True, False):
        after, again = make.read(rewritten(path, where, suffix))
        assert np.array_equal(after, before)
        assert again.tile_width == 64
        told = {attribute.name.lower() for attribute in again.extra_attribs}
        assert not told & {"textureformat", "oiio:averagecolor", "oiio:sha-1", "oiio:miplevels"}
    assert len(levels(rewritten(path, False, suffix))) == 1


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
@pytest.mark.parametrize("count", [3, 4])
def test_identity_of_dpx(tmp_path, make, random, bits, count):
    codes = random.integers(0, 2**bits, (33, 21, count))
    kind = "uint8" if bits == 8 else "uint16"
    pixels = np.rint(codes * (np.iinfo(kind).max / (2**bits - 1))).astype(kind)
    attributes = {"oiio:BitsPerSample": bits, "Artist": "me"}
    path = make.image(tmp_path / "a.dpx", pixels, attributes=attributes)
    before, spec = make.read(path)
    assert abs(before.astype(int) - pixels).max() <= 32  # bits repeat to fill up sixteen
    one = read_texture(path)
    assert (one.pixels.dtype, one.space, one.associated) == (kind, SRGB, count == 4)
    after, again = make.read(rewritten(path, count == 3))
    assert np.array_equal(after, before)
    assert again.getattribute("oiio:BitsPerSample") == bits
    assert again.getattribute("Artist") == spec.getattribute("Artist")


@pytest.mark.parametrize("bits", [10, 12])
def test_identity_of_odd_depths_in_tiff(tmp_path, make, random, bits):
    path = make.image(
        tmp_path / "a.tif", pixels_of(random, "uint16"), attributes={"oiio:BitsPerSample": bits}
    )
    before, _ = make.read(path)
    after, spec = make.read(rewritten(path, True))
    assert np.array_equal(after, before)
    assert spec.getattribute("oiio:BitsPerSample") == bits


def test_identity_of_a_half_tiff(tmp_path, make, random):
    data = random.random((3, 4, 3)).astype("<f2")
    path = make.tiff(tmp_path / "a.tif", 4, 3, 3, bits=16, kind=3, data=data.tobytes())
    after, spec = make.read(rewritten(path, True))
    assert str(spec.format) == "half"
    assert np.array_equal(after, data)


@pytest.mark.parametrize("layout", [{"tile": 32}, {"attributes": {"tiff:RowsPerStrip": 7}}])
@pytest.mark.parametrize(("extension", "dtype"), [("tif", "uint8"), ("exr", "float16")])
def test_layout_of_rows_and_tiles_survives(tmp_path, make, random, layout, extension, dtype):
    path = make.image(tmp_path / f"a.{extension}", pixels_of(random, dtype, 3, (70, 90)), **layout)
    before, spec = make.read(path)
    after, again = make.read(rewritten(path, True))
    assert np.array_equal(after, before)
    assert (again.tile_width, again.tile_height) == (spec.tile_width, spec.tile_height)
    rows = "tiff:RowsPerStrip"
    assert again.getattribute(rows) == spec.getattribute(rows)


def test_half_with_extra_channels(tmp_path, make, random):
    pixels = random.random((9, 8, 6)).astype(np.float16)
    names = ["id.x", "B", "G", "R", "A", "matte"]
    path = make.image(tmp_path / "a.exr", pixels, names)
    one = read_texture(path)
    inside = np.zeros(one.shape, bool)
    inside[2:5] = True
    write_texture(one.with_linear(one.linear() * 0.5, inside), tmp_path / "b.exr")
    before, after = (dict(zip(t.channels, np.moveaxis(t.pixels, -1, 0), strict=True))
                     for t in (one, read_texture(tmp_path / "b.exr")))  # fmt: skip
    assert before.keys() == after.keys() == set(names)
    for name in names:
        changed = before[name] != after[name]
        assert changed[~inside].sum() == 0
        assert changed.any() == (name in "RGB")


def test_density_goes_with_the_texture(tmp_path, make, random):
    given = {"XResolution": 300.0, "YResolution": 300.0, "ResolutionUnit": "in"}
    path = make.image(tmp_path / "a.tif", pixels_of(random, "uint8"), attributes=given)
    for suffix in (".png", ".jpg", ".tif", ".tx"):
        _, spec = make.read(rewritten(path, False, suffix))
        per_inch = 1.0 if spec.getattribute("ResolutionUnit") in ("in", "inch") else 2.54
        assert spec.getattribute("XResolution") * per_inch == pytest.approx(300, abs=0.1), suffix


def test_chromaticities_in_and_out(tmp_path, make, random):
    acescg = rgb_space("ACEScg")
    numbers = (oiio.TypeDesc("float[8]"), acescg.chromaticities)
    pixels = pixels_of(random, "float16")
    path = make.image(tmp_path / "a.exr", pixels, attributes={"chromaticities": numbers})
    one = read_texture(path)
    assert (one.space, one.origin) == (acescg, "its chromaticities")
    np.testing.assert_allclose(
        one.linear(), acescg.to_linear_srgb(pixels.astype(np.float32)), atol=1e-6
    )
    after, spec = make.read(rewritten(path, False))
    assert np.array_equal(after, pixels)
    np.testing.assert_allclose(spec.getattribute("chromaticities"), numbers[1], atol=1e-6)
    for space in (LINEAR, rgb_space("Rec.2020")):
        write_texture(one, tmp_path / "b.exr", space)
        two = read_texture(tmp_path / "b.exr")
        assert two.space == space
        np.testing.assert_allclose(two.linear(), one.linear(), atol=2e-3)
    write_texture(one, tmp_path / "b.exr", SRGB)  # they would say that it is linear
    assert make.read(tmp_path / "b.exr")[1].getattribute("chromaticities") is None


def test_an_exr_that_said_nothing_says_nothing(tmp_path, make, random):
    path = make.image(tmp_path / "a.exr", pixels_of(random, "float16"))
    assert make.read(rewritten(path, True))[1].getattribute("chromaticities") is None
    given = read_texture(path, "ACEScg")
    write_texture(given, tmp_path / "b.exr")
    assert read_texture(tmp_path / "b.exr").space == rgb_space("ACEScg")


def test_profiles_follow_the_space(tmp_path, make, random, icc):
    """Kept with the values; replaced by one of ours, or none for sRGB, with other values."""
    p3 = rgb_space("Display P3")
    adobe = icc.profile(icc.ADOBE)
    pixels = random.integers(100, 160, (9, 8, 3)).astype(np.uint8)  # inside all these gamuts
    for suffix in (".png", ".tif", ".jpg"):
        path = make.image(tmp_path / f"a{suffix}", pixels, attributes=with_icc(adobe))
        one = read_texture(path)
        assert (one.space.name, one.origin) == ("by hand", "its ICC profile")
        for other in (".png", ".tif", ".jpg"):
            write_texture(one, tmp_path / f"b{other}")
            profile = make.read(tmp_path / f"b{other}")[1].getattribute("ICCProfile")
            assert bytes(bytearray(profile)) == adobe
        for space, origin in ((p3, "its ICC profile"), (SRGB, "assumed, the file says nothing")):
            write_texture(one, tmp_path / "c.tif", space)
            two = read_texture(tmp_path / "c.tif")
            assert (two.space, two.origin) == (space, origin)
            np.testing.assert_allclose(two.linear(), one.linear(), atol=6e-3)
        for unprofiled in (".exr", ".dpx"):
            write_texture(one, tmp_path / f"d{unprofiled}")
            two = read_texture(tmp_path / f"d{unprofiled}")
            assert two.space == (LINEAR if unprofiled == ".exr" else SRGB)
            np.testing.assert_allclose(two.linear(), one.linear(), atol=6e-3)


@pytest.mark.parametrize("suffix", [".png", ".tif", ".tx", ".exr", ".dpx"])
def test_linear_values_of_8_bits_get_more(tmp_path, make, random, suffix):
    path = make.image(tmp_path / "a.png", random.integers(1, 256, (9, 8, 3)).astype(np.uint8))
    one = read_texture(path)
    write_texture(one, tmp_path / f"b{suffix}", LINEAR)
    two = read_texture(tmp_path / f"b{suffix}")
    assert two.space == LINEAR
    assert not two.origin.startswith("assumed")
    back = two.linear() if suffix != ".exr" else two.pixels.astype(np.float32)
    codes = one.with_linear(back, np.ones(one.shape, bool)).pixels
    assert np.array_equal(codes, one.pixels)


@pytest.mark.parametrize("chunk", ["gAMA", "cICP"])
def test_identity_of_a_png_that_says_its_space(tmp_path, make, random, chunk):
    says = {"oiio:ColorSpace": "lin_rec709_scene"}
    if chunk == "cICP":
        says = {"CICP": (oiio.TypeDesc("int[4]"), (12, 13, 0, 1))}
    path = make.image(tmp_path / "a.png", pixels_of(random, "uint16"), attributes=says)
    one = read_texture(path)
    assert one.origin == f"its {chunk}"
    out = read_texture(rewritten(path, True))
    assert np.array_equal(out.pixels, one.pixels)
    assert (out.space, out.origin) == (one.space, one.origin)
    write_texture(one, tmp_path / "b.png", SRGB)
    assert read_texture(tmp_path / "b.png").space == SRGB
    write_texture(one, tmp_path / "b.tif")
    assert read_texture(tmp_path / "b.tif").space == one.space


def test_an_array_is_no_texture(tmp_path):
    with pytest.raises(CutisError, match="with_linear"):
        write_texture(np.zeros((4, 4, 3), np.float32), tmp_path / "out.png")
    assert not list(tmp_path.iterdir())
