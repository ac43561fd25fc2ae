import base64
import contextlib
import os
import struct
import sys

import handmade as hand
import numpy as np
import OpenImageIO as oiio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutis.colour import LINEAR, SRGB
from cutis.errors import CutisError
from cutis.textures import read_channels, read_mask, read_texture, write_texture

CMYK_JPEG = base64.b85decode(
    "|JeWT01iQ9Z(?NtWB>pF0095n07C!}3k(hn3J?wr4iXU%6BsBO7#0>7F(V}%C^|DeJUKHsH$X^SPC!IgMK?H5ZBbWW"
    "VrOV)K233XaAbH~WoKjmzyK5o00;mG1Va%3O%VWD5dcdO0RO}Q6aWDL000000000000000000L6!~hf!0RR9100000"
    "00000000000RP$m4g^C0O#oQ{O8@{r0CqHDSpV4"
)
CASES = [("png", "uint8"), ("jpg", "uint8"), ("tif", "uint8"), ("exr", "float16")]


def pixels_of(random, dtype, shape=(12, 17, 3)):
    scale = np.iinfo(dtype).max if dtype.startswith("u") else 1
    return (random.random(shape) * scale).astype(dtype)


def attempt(path):
    try:
        return None, read_texture(path)
    except CutisError as error:
        return str(error), None


def refused(path, one_line, match):
    with pytest.raises(CutisError, match=match) as caught:
        read_texture(path)
    return one_line(caught, path)


@pytest.mark.parametrize(
    ("extension", "dtype", "encoding"),
    [
        ("png", "uint8", SRGB),
        ("png", "uint16", SRGB),
        ("tif", "uint8", SRGB),
        ("tif", "uint16", SRGB),
        ("tif", "float32", LINEAR),
        ("exr", "float16", LINEAR),
        ("exr", "float32", LINEAR),
    ],
)
@pytest.mark.parametrize("count", [3, 4])
def test_stored_values_and_types_come_as_they_are(
    tmp_path, make, random, extension, dtype, encoding, count
):
    pixels = pixels_of(random, dtype, (12, 17, count))
    straight = {"oiio:UnassociatedAlpha": 1} if count == 4 and extension != "exr" else None
    path = make.image(tmp_path / f"a.{extension}", pixels, attributes=straight)
    one = read_texture(path)
    assert one.pixels.dtype == dtype
    assert np.array_equal(one.pixels, pixels)
    assert one.space == encoding
    assert one.shape == (12, 17)
    assert one.path == path
    assert one.associated == (extension == "exr" and count == 4)
    assert read_texture(path, "linear").space == LINEAR
    assert read_texture(path, "srgb").space == SRGB


def test_jpeg_reads_with_its_orientation(tmp_path, make):
    grey = np.full((16, 24, 3), 130, np.uint8)
    one = read_texture(make.image(tmp_path / "a.jpg", grey, attributes={"Orientation": 6}))
    assert abs(one.pixels.astype(int) - 130).max() <= 1
    assert one.spec.getattribute("Orientation") == 6


def test_content_counts_rather_than_extension(tmp_path, make, random):
    pixels = pixels_of(random, "uint8")
    path = make.image(tmp_path / "a.png", pixels).rename(tmp_path / "b#1?x=2 é.jpg")
    assert np.array_equal(read_texture(path).pixels, pixels)


@pytest.mark.parametrize("bits", [10, 12])
def test_odd_depths_come_as_uint16(tmp_path, make, random, bits):
    pixels = pixels_of(random, "uint16")
    path = make.image(tmp_path / "a.tif", pixels, attributes={"oiio:BitsPerSample": bits})
    one = read_texture(path)
    assert one.pixels.dtype == np.uint16
    assert abs(one.pixels.astype(int) - pixels).max() <= 65536 / 2**bits


def test_double_comes_as_float32(tmp_path, make, random):
    pixels = random.random((4, 5, 3))
    one = read_texture(make.image(tmp_path / "a.tif", pixels))
    assert np.array_equal(one.pixels, pixels.astype(np.float32))


def test_half_tiff(tmp_path, make):
    one = read_texture(make.tiff(tmp_path / "a.tif", 4, 3, 3, bits=16, kind=3))
    assert one.pixels.dtype == np.float16


def test_extra_samples_of_a_tiff(tmp_path, make):
    path = tmp_path / "a.tif"
    assert read_texture(make.tiff(path, 4, 3, 4, extra=[1])).associated
    straight = read_texture(make.tiff(path, 4, 3, 4, extra=[2]))
    assert straight.alpha() is not None
    assert not straight.associated
    unspecified = read_texture(make.tiff(path, 4, 3, 4, extra=[0]))  # Photoshop's spare channels
    assert unspecified.alpha() is None
    assert unspecified.pixels.shape == (3, 4, 4)


def test_layers_of_an_exr(tmp_path, make, random, one_line):
    pixels = pixels_of(random, "float16", (4, 5, 6))
    names = [f"spec.{c}" for c in "RGB"] + [f"diffuse.{c}" for c in "RGB"]
    path = make.image(tmp_path / "two.exr", pixels, names)
    assert "diffuse, spec" in refused(path, one_line, "several layers")
    one = read_texture(make.image(tmp_path / "one.exr", pixels[..., :4], ["Z", *names[3:]]))
    assert np.array_equal(one.linear(), pixels[..., 1:4].astype(np.float32))


def test_first_part_of_an_exr(tmp_path, random):
    path = str(tmp_path / "parts.exr")
    beauty, depth = oiio.ImageSpec(8, 6, 3, "half"), oiio.ImageSpec(8, 6, 1, "float")
    beauty.attribute("oiio:subimagename", "beauty")
    depth.attribute("oiio:subimagename", "depth")
    depth.channelnames = ("Z",)
    pixels = random.random((6, 8, 3)).astype(np.float16)
    out = oiio.ImageOutput.create(path)
    assert out.open(path, (beauty, depth))
    assert out.write_image(pixels)
    assert out.open(path, depth, "AppendSubimage")
    assert out.write_image(np.zeros((6, 8, 1), np.float32))
    assert out.close()
    assert np.array_equal(read_texture(path).pixels, pixels)


def test_depth_may_be_infinite(tmp_path, make, random):
    pixels = random.random((4, 5, 4)).astype(np.float32)
    pixels[..., 3] = np.inf
    one = read_texture(make.image(tmp_path / "a.exr", pixels, ["R", "G", "B", "Z"]))
    assert np.isinf(one.pixels[..., one.channels.index("Z")]).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("extension", ["exr", "tif"])
def test_nan_and_infinity_are_counted_and_placed(tmp_path, make, one_line, bad, extension):
    pixels = np.zeros((600, 7, 3), np.float32)
    pixels[[300, 310], [4, 2], 1] = bad
    path = make.image(tmp_path / f"a.{extension}", pixels)
    assert "row 300, column 4" in refused(path, one_line, "2 texels")


@pytest.mark.parametrize("extension", ["png", "jpg", "tif", "exr"])
@pytest.mark.parametrize("count", [1, 2])
def test_grey_is_refused(tmp_path, make, one_line, extension, count):
    if (extension, count) == ("jpg", 2):
        pytest.skip("JPEG has no two channels")
    dtype = np.float16 if extension == "exr" else np.uint8
    path = make.image(tmp_path / f"a.{extension}", np.zeros((4, 5, count), dtype))
    refused(path, one_line, "grey.*RGB")


def test_grey_tiff_with_spare_channels_is_refused(tmp_path, make, one_line):
    path = make.tiff(tmp_path / "a.tif", 4, 3, 4, photometric=1, extra=[0, 0, 0])
    refused(path, one_line, "grey")


def test_cmyk_is_refused(tmp_path, make, one_line):
    path = tmp_path / "a.jpg"
    path.write_bytes(CMYK_JPEG)
    refused(path, one_line, "CMYK")
    refused(make.tiff(tmp_path / "a.tif", 4, 3, 4, photometric=5), one_line, "CMYK")


def test_palettes_are_refused(tmp_path, make, one_line):
    rows = (b"\0" + bytes(4)) * 4
    refused(make.png(tmp_path / "a.png", 4, 4, colour=3, rows=rows), one_line, "palette")
    refused(make.tiff(tmp_path / "a.tif", 4, 3, 1, photometric=3), one_line, "palette")


def test_other_colour_models_are_refused(tmp_path, make, one_line):
    refused(make.tiff(tmp_path / "a.tif", 4, 3, 3, photometric=8), one_line, "CIELAB")


def test_other_sample_types_are_refused(tmp_path, make, one_line):
    path = tmp_path / "a.tif"
    refused(make.tiff(path, 4, 3, 3, bits=32), one_line, "type uint")
    refused(make.tiff(path, 4, 3, 3, bits=16, kind=2), one_line, "type int16")


def test_deep_is_refused(tmp_path, one_line):
    path = tmp_path / "deep.exr"
    spec = oiio.ImageSpec(8, 6, 4, "half")
    spec.deep = True
    samples = oiio.DeepData()
    samples.init(spec)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    assert out.write_deep_image(samples)
    assert out.close()
    refused(path, one_line, "deep.*flatten")


def test_missing_folder_empty_and_other_files(tmp_path, one_line):
    refused(tmp_path / "none.png", one_line, "no such file")
    refused(tmp_path, one_line, "is a folder")
    for name, content in [("a.png", b""), ("b.exr", b"")]:
        (tmp_path / name).write_bytes(content)
        refused(tmp_path / name, one_line, "empty")
    for name, content in [("t.png", b"hello"), ("x.null", b"x" * 99), ("g.gif", b"GIF89a" * 9)]:
        (tmp_path / name).write_bytes(content)
        refused(tmp_path / name, one_line, "not a PNG, JPEG, TIFF, OpenEXR, DPX or PSD")
    refused(tmp_path / "g.gif" / "x.png", one_line, "cannot be read")


def test_a_line_break_in_a_name_stays_out_of_the_message(tmp_path):
    with pytest.raises(CutisError) as caught:
        read_texture(tmp_path / "two\nlines.png")
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names are text elsewhere")
def test_a_name_that_is_not_text(tmp_path, make):
    whole = make.image(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    odd = tmp_path / os.fsdecode(b"\xff.png")
    for action in (lambda: read_texture(odd), lambda: write_texture(read_texture(whole), odd)):
        with pytest.raises(CutisError) as caught:
            action()
        assert b"dcff" in str(caught.value).encode()
    whole.rename(odd)
    with pytest.raises(CutisError, match="rename"):
        read_texture(odd)
    assert list(tmp_path.iterdir()) == [odd]


def test_no_texels(tmp_path, make, one_line):
    refused(make.png(tmp_path / "a.png", 0, 4), one_line, "no texels")
    refused(make.tiff(tmp_path / "a.tif", 0, 4, 3, data=b""), one_line, "damaged")


@pytest.mark.parametrize("size", [(100_000, 100_000), (40_000, 2), (2, 40_000)])
def test_absurd_sizes_are_refused_before_allocating(tmp_path, make, one_line, size):
    refused(make.png(tmp_path / "a.png", *size), one_line, "limit|exceeds")
    refused(make.tiff(tmp_path / "a.tif", *size, 3, data=b"a"), one_line, "limit|exceeds")
    spec = oiio.ImageSpec(*size, 3, "half")
    path = str(tmp_path / "a.exr")
    out = oiio.ImageOutput.create(path)
    assert out.open(path, spec)
    out.close()
    out.geterror()
    refused(path, one_line, "limit|exceeds|damaged")


def test_more_than_memory_holds_is_refused(tmp_path, make, one_line, monkeypatch):
    monkeypatch.setattr("cutis.textures.decoding.available_memory", lambda: 1000)
    path = make.image(tmp_path / "a.png", np.zeros((20, 20, 3), np.uint8))
    refused(path, one_line, "memory")


def test_a_wrong_checksum_is_damage(tmp_path, make, random, one_line, capfd):
    path = make.image(tmp_path / "a.png", pixels_of(random, "uint8"))
    content = bytearray(path.read_bytes())
    content[-40] ^= 1
    path.write_bytes(content)
    refused(path, one_line, "checksum")
    assert capfd.readouterr().err == ""


class Whole:
    """Small whole files: (path, bytes, texels) each. Hypothesis prints it, so it has no fields."""

    def __init__(self, folder, files):
        self.folder, self.files = folder, files


@pytest.fixture(scope="module")
def whole(tmp_path_factory, make):
    folder = tmp_path_factory.mktemp("whole")
    random = np.random.default_rng(7)
    paths = [
        make.image(folder / f"a.{extension}", pixels_of(random, dtype, (40, 30, 3)))
        for extension, dtype in CASES
    ]
    return Whole(folder, [(path, path.read_bytes(), make.read(path)[0]) for path in paths])


def test_text_that_is_not_utf8(tmp_path, make, random, one_line):
    pixels = pixels_of(random, "float16")
    attributes = {"Artist": "M__ller"}
    path = make.image(tmp_path / "a.exr", pixels, ["mmR", "mmG", "mmB"], attributes)
    path.write_bytes(path.read_bytes().replace(b"mm", b"\xfcm"))
    refused(path, one_line, "not text|damaged")
    path = make.image(tmp_path / "b.exr", pixels, attributes=attributes)
    path.write_bytes(path.read_bytes().replace(b"M__ller", b"M\xfc\xfcller"))
    one = read_texture(path)  # Latin-1 metadata is common, and carried as it is
    write_texture(one, tmp_path / "c.exr")
    assert b"M\xfc\xfcller" in (tmp_path / "c.exr").read_bytes()
    assert set(read_channels(path)[0]) == set("RGB")


@given(which=st.sampled_from(range(len(CASES))), at=st.floats(0, 1, exclude_max=True))
@settings(max_examples=150, deadline=None)
def test_truncation_is_an_error_or_changes_nothing(whole, which, at):
    path, content, pixels = whole.files[which]
    cut = whole.folder / f"cut{path.suffix}"
    cut.write_bytes(content[: int(at * len(content))])
    message, texture = attempt(cut)
    if texture is None:
        assert len(message.splitlines()) == 1
        assert str(cut) in message
    else:
        assert np.array_equal(texture.pixels, pixels)


@given(
    which=st.sampled_from(range(len(CASES))),
    flips=st.lists(
        st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), min_size=1, max_size=4
    ),
)
@settings(max_examples=150, deadline=None)
def test_flipped_bytes_never_raise_anything_else(whole, which, flips):
    path, content, _ = whole.files[which]
    flipped = bytearray(content)
    for at, bits in flips:
        flipped[int(at * len(content))] ^= bits
    cut = whole.folder / f"flip{path.suffix}"
    cut.write_bytes(flipped)
    with contextlib.suppress(CutisError):
        read_texture(cut).linear()


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_psd(tmp_path, make, random, icc, dtype):
    """The merged picture, its density and profile; spare channels (masks) are not colour."""
    pixels = pixels_of(random, dtype, (12, 17, 4))
    density = struct.pack(">IHHIHH", 300 << 16, 1, 1, 300 << 16, 1, 1)
    profile = icc.profile(icc.ADOBE)
    resources = make.psd_block(1005, density) + make.psd_block(1039, profile)
    path = make.psd(tmp_path / "a.psd", pixels, resources=resources)
    one = read_texture(path)
    assert np.array_equal(one.pixels, pixels[..., :3])
    assert (one.space.name, one.alpha()) == ("by hand", None)
    write_texture(one, tmp_path / "b.tif")
    back, spec = make.read(tmp_path / "b.tif")
    assert np.array_equal(back, pixels[..., :3])
    assert (spec.getattribute("XResolution"), spec.getattribute("ResolutionUnit")) == (300, "in")
    assert bytes(bytearray(spec.getattribute("ICCProfile"))) == profile


def test_psd_with_transparency(tmp_path, make):
    """Straight, without the white that the merged picture has under it."""
    stored = np.zeros((2, 3, 4), np.uint8)
    stored[..., :3], stored[..., 3] = (200, 230, 255), [255, 128, 0]
    one = read_texture(make.psd(tmp_path / "a.psd", stored, layer=make.psd_layer()))
    assert not one.associated
    assert one.pixels[0].tolist() == [[200, 230, 255, 255], [145, 205, 255, 128], [0, 0, 0, 0]]


@pytest.mark.parametrize(
    ("mode", "count", "match"), [(4, 4, "CMYK"), (1, 1, "grey"), (9, 3, "mode 9")]
)
def test_psd_of_other_colour(tmp_path, make, one_line, mode, count, match):
    path = make.psd(tmp_path / "a.psd", np.zeros((4, 4, count), np.uint8), mode)
    refused(path, one_line, match)


def test_dpx_of_film_densities_needs_a_name(tmp_path, make, random, one_line):
    attributes = {"oiio:BitsPerSample": 10, "dpx:Transfer": "Printing density"}
    path = make.image(tmp_path / "a.dpx", pixels_of(random, "uint16"), attributes=attributes)
    refused(path, one_line, "--colorspace")
    assert read_texture(path, "ADX10").space.name == "ADX10"


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (50000, "Zstandard"),
        (50002, "JPEG XL"),
        (34925, "LZMA"),
        (34712, "JPEG 2000"),
        (34887, "LERC"),
    ],
)
def test_a_decoder_that_is_missing_is_no_damage(tmp_path, one_line, number, name):
    path = hand.tiff(tmp_path / "a.tif", {259: ("H", [number])})
    message = refused(path, one_line, f"is packed with {name}, which is not supported")
    assert "save it with LZW or ZIP" in message
    assert "damaged" not in message


def test_a_jpeg_of_a_rare_kind(tmp_path, one_line):
    path = hand.jpeg(tmp_path / "a.jpg")
    content = path.read_bytes()
    at = content.index(b"\xff\xc0")
    path.write_bytes(content[: at + 1] + b"\xc3" + content[at + 2 :])
    refused(path, one_line, "is packed with lossless JPEG, which is not supported; save it as")


@pytest.mark.parametrize(
    ("start", "what"),
    [
        (b"RIFF\0\0\0\0WEBPVP8 ", "a WebP image"),
        (b"\0\0\0\x1cftypavif", "an AVIF image"),
        (b"\0\0\0\x18ftypheic", "a HEIF image"),
        (b"\xff\x0a\xfa", "a JPEG XL image"),
        (b"\0\0\0\x0cJXL \r\n", "a JPEG XL image"),
        (b"#?RADIANCE\n", "a Radiance picture"),
        (b"%PDF-1.7", "a PDF document"),
        (b"\x93NUMPY\1\0", "a NumPy array"),
    ],
)
def test_files_of_other_kinds_are_called_what_they_are(tmp_path, one_line, start, what):
    path = tmp_path / "a.png"
    path.write_bytes(start + bytes(40))
    refused(path, one_line, f"is {what}, not a PNG, JPEG, TIFF")


def test_a_png_as_xcode_packs_it(tmp_path, one_line):
    content = hand.png(tmp_path / "a.png").read_bytes()
    (tmp_path / "a.png").write_bytes(content[:8] + hand.png_chunk(b"CgBI", bytes(4)) + content[8:])
    refused(tmp_path / "a.png", one_line, "as Xcode packs them")


def test_a_file_is_looked_through_once(tmp_path, monkeypatch):
    """However often it is opened, until it changes."""
    from cutis.textures import headers

    path, looks = hand.png(tmp_path / "a.png"), []
    real = headers.check_png
    monkeypatch.setattr(headers, "check_png", lambda *how: looks.append(1) or real(*how))
    for _ in range(3):
        read_texture(path)
        read_mask(path, hand.SIZE)
    assert len(looks) == 1
    hand.png(path, (b"sRGB", b"\0"))
    assert read_texture(path).origin == "its sRGB chunk"
    assert len(looks) == 2


def test_large_pngs_are_judged_by_checksums(tmp_path, random, one_line, monkeypatch):
    """Their rows are not unpacked twice; truncation and damage are found all the same."""
    monkeypatch.setattr("cutis.textures.png._INFLATED", 1000)
    pixels = random.integers(0, 65536, (40, 20, 3)).astype(np.uint16)
    path = hand.png(tmp_path / "a.png", pixels=pixels)
    content = path.read_bytes()
    assert len(content) > 1000
    assert np.array_equal(read_texture(path).pixels, pixels)
    (tmp_path / "b.png").write_bytes(content[:-50])
    refused(tmp_path / "b.png", one_line, "truncated")
    (tmp_path / "c.png").write_bytes(content[:600] + b"??" + content[602:])
    refused(tmp_path / "c.png", one_line, "checksum")
