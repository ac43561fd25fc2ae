"""Every place where a format states colour: a test per row of the table in docs/textures.md.

Files are made byte by byte; the colours that they should mean come from matrices written out here.
"""

import re
import struct
from pathlib import Path

import colour
import handmade as hand
import numpy as np
import pytest

from cutis.colour import LINEAR, SRGB, rgb_space
from cutis.colour.spaces import ACES2065_1
from cutis.errors import CutisError
from cutis.textures import read_texture, write_texture

P3 = rgb_space("Display P3")
ACESCG = rgb_space("ACEScg")
XY_P3 = (0.68, 0.32, 0.265, 0.69, 0.15, 0.06)
XY_ADOBE = (0.64, 0.33, 0.21, 0.71, 0.15, 0.06)
XY_709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06)
D65 = (0.3127, 0.3290)
NOTHING = "assumed, the file says nothing"


def expected(stored, space, power):
    """Linear sRGB of stored fractions by colour-science's matrices and an exponent of ours."""
    theirs = colour.RGB_COLOURSPACES[space]
    srgb = colour.RGB_COLOURSPACES["sRGB"]
    return stored**power @ colour.matrix_RGB_to_RGB(theirs, srgb, "Bradford").T


def chrm(white=D65, primaries=XY_P3):
    return b"cHRM", struct.pack(">8I", *(round(v * 1e5) for v in (*white, *primaries)))


def gama(exponent):
    return b"gAMA", struct.pack(">I", round(1e5 / exponent))


def exif_tags(colour_space=None, index=None, **more):
    inner = {}
    if colour_space is not None:
        inner[0xA001] = ("H", [colour_space])
    if index is not None:
        inner[0xA005] = {1: ("s", index + b"\0")}
    return {0x8769: inner | more} if inner or more else {}


def chromatic(primaries=XY_P3, white=D65):
    return {318: ("R", white), 319: ("R", primaries)}


def table(power, count=256):
    return {301: ("H", np.rint(np.linspace(0, 1, count) ** power * 65535).astype(int).tolist())}


def cicp(*code):
    return b"cICP", bytes(code)


def text(key, value):
    return b"tEXt", key + b"\0" + value


def png(*chunks):
    return lambda folder: hand.png(folder / "a.png", *chunks)


def jpeg(*segments):
    return lambda folder: hand.jpeg(folder / "a.jpg", *segments)


def tiff(tags, kind="uint8"):
    return lambda folder: hand.tiff(folder / "a.tif", tags, hand.texels(kind))


def exr(*attributes):
    return lambda folder: hand.exr(folder / "a.exr", *attributes)


def profiled(icc):
    """An ICC profile of Display P3."""
    return icc.profile(icc.P3, icc.para(3, 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045))


# Row of the table, file, space (or its name), origin, words that a note or the origin has.
ROWS = [
    ("PNG cICP", png(cicp(12, 13, 0, 1)), P3, "its cICP", ""),
    ("PNG cICP", png(cicp(1, 13, 0, 1)), SRGB, "its cICP", ""),
    ("PNG cICP", png(cicp(9, 8, 0, 1)), rgb_space("Rec.2020"), "its cICP", ""),
    ("PNG cICP", png(cicp(12, 4, 0, 1)), "P3, gamma 2.2", "its cICP", ""),
    ("PNG cICP", png(cicp(1, 1, 0, 1)), SRGB, "its cICP (a curve of video", ""),
    ("PNG cICP", png(cicp(12, 13, 0, 1), (b"sRGB", b"\0")), P3, "its cICP", "sRGB chunk says sRGB"),
    ("PNG cICP", png(cicp(12, 13, 0, 0)), SRGB, "assumed, its cICP says 12-13-0-0", ""),
    ("PNG cICP", png(cicp(12, 13)), SRGB, "assumed, its cICP cannot be used", ""),
    ("PNG sRGB", png((b"sRGB", b"\0")), SRGB, "its sRGB chunk", ""),
    ("PNG sRGB", png((b"sRGB", b"\0"), gama(1.0)), SRGB, "its sRGB chunk", "gAMA says linear"),
    ("PNG sRGB", png((b"sRGB", b"\0"), gama(2.2), chrm(primaries=XY_709)), SRGB, "its sRGB", ""),
    ("PNG gAMA, cHRM", png(gama(2.2)), SRGB, "its gAMA", ""),
    ("PNG gAMA, cHRM", png(gama(1.0)), LINEAR, "its gAMA", ""),
    ("PNG gAMA, cHRM", png(gama(1.8)), "Rec.709, gamma 1.8", "its gAMA", ""),
    ("PNG gAMA, cHRM", png(gama(2.2), chrm()), "P3, gamma 2.2", "its gAMA and cHRM", ""),
    ("PNG gAMA, cHRM", png(gama(1.0), chrm()), P3.with_curve(False), "its gAMA and cHRM", ""),
    ("PNG gAMA, cHRM", png(chrm()), P3, "its cHRM", ""),
    ("PNG gAMA, cHRM", png(gama(2.2), chrm(primaries=XY_709)), SRGB, "its gAMA and cHRM", ""),
    ("PNG gAMA, cHRM", png(chrm((0.3, 0), XY_P3)), SRGB, "assumed, its cHRM cannot be used", ""),
    ("PNG gAMA, cHRM", png((b"gAMA", bytes(4))), SRGB, "assumed, its gAMA cannot be used", ""),
    ("PNG eXIf", png((b"eXIf", hand.exif(exif_tags(1)))), SRGB, "its EXIF", ""),
    ("PNG eXIf", png((b"eXIf", hand.exif(exif_tags(65535, b"R03")))), "Adobe RGB (1998)",
     "its EXIF", ""),
    ("PNG text", png(text(b"oiio:ColorSpace", b"ACEScg")), SRGB,
     "assumed, its text oiio:colorspace says 'ACEScg', which is no word of the format", ""),
    ("PNG text", png(text(b"Colorspace", b"\xe8\x03")), SRGB, "assumed, its text colorspace says",
     ""),
    ("JPEG EXIF", jpeg(hand.jpeg_exif(exif_tags(1))), SRGB, "its EXIF", ""),
    ("JPEG EXIF", jpeg(hand.jpeg_exif(exif_tags(65535, b"R03"), ">")), "Adobe RGB (1998)",
     "its EXIF", ""),
    ("JPEG EXIF", jpeg(hand.jpeg_exif(exif_tags(2))), "Adobe RGB (1998)", "its EXIF", ""),
    ("JPEG EXIF", jpeg(hand.jpeg_exif(exif_tags(65535, b"R98"))), SRGB,
     "assumed, its EXIF says uncalibrated", ""),
    ("JPEG EXIF", jpeg(hand.jpeg_exif(exif_tags(65533))), SRGB,
     "assumed, its EXIF says colour space 65533, which is not known", ""),
    ("JPEG EXIF numbers", jpeg(hand.jpeg_exif(chromatic() | exif_tags(65535))), "P3, gamma 2.2",
     "its WhitePoint and PrimaryChromaticities", ""),
    ("JPEG EXIF numbers",
     jpeg(hand.jpeg_exif(chromatic(XY_ADOBE) | {0x8769: {0xA500: ("R", [1.8])}})),
     "Adobe RGB, gamma 1.8", "its WhitePoint and PrimaryChromaticities and Gamma", ""),
    ("TIFF numbers", tiff(chromatic()), "P3, gamma 2.2", "its WhitePoint and PrimaryChr", ""),
    ("TIFF numbers", tiff(chromatic(), "float32"), P3.with_curve(False), "its WhitePoint", ""),
    ("TIFF numbers", tiff(chromatic() | table(1.8)), "P3, with a curve of its own",
     "its WhitePoint and PrimaryChromaticities and TransferFunction", ""),
    ("TIFF numbers", tiff(table(1.0)), LINEAR, "its TransferFunction", ""),
    ("TIFF numbers", tiff({318: ("R", D65)}), SRGB, "assumed, its WhitePoint is there alone", ""),
    ("TIFF numbers", tiff(chromatic((0.3,) * 6)), SRGB, "assumed, its WhitePoint and Prim", ""),
    ("TIFF EXIF", tiff(exif_tags(65535, b"R03")), "Adobe RGB (1998)", "its EXIF", ""),
    ("TIFF EXIF", tiff(exif_tags(1), "float32"), LINEAR, "assumed, its EXIF says a space of", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "lin_ap1_scene")), ACESCG,
     "its colorInteropID", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "g22_adobergb_scene")),
     "g22_adobergb_scene", "its colorInteropID", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "srgb_p3d65_display")), P3,
     "its colorInteropID", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "lin_moon")), LINEAR,
     "assumed, its colorInteropID says 'lin_moon', which is not known", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "data")), LINEAR,
     "assumed, its colorInteropID says 'data', which is no colour", ""),
    ("OpenEXR colorInteropID", exr(hand.exr_text("colorInteropID", "unknown")), LINEAR,
     NOTHING, ""),
    ("OpenEXR acesImageContainerFlag", exr(hand.exr_numbers("acesImageContainerFlag", "int", 1)),
     ACES2065_1, "its acesImageContainerFlag", ""),
    ("OpenEXR chromaticities",
     exr(hand.exr_numbers("chromaticities", "chromaticities", *XY_P3, *D65)),
     P3.with_curve(False), "its chromaticities", ""),
    ("OpenEXR chromaticities",
     exr(hand.exr_numbers("chromaticities", "chromaticities", *ACESCG.chromaticities),
         hand.exr_text("oiio:ColorSpace", "sRGB")),
     ACESCG, "its chromaticities", "oiio:ColorSpace says sRGB: overruled by its chromaticities"),
    ("OpenEXR names", exr(hand.exr_text("oiio:ColorSpace", "ACEScg")), ACESCG,
     "its oiio:ColorSpace", ""),
    ("OpenEXR names", exr(hand.exr_text("colorspace", "sRGB")), SRGB, "its colorspace", ""),
    ("OpenEXR names", exr(hand.exr_text("nuke/colorSpace", "ACEScg")), ACESCG,
     "its nuke/colorSpace", ""),
    ("OpenEXR names", exr(hand.exr_text("colorspace", "our show's")), LINEAR,
     "assumed, its colorspace says 'our show's', which is not known", ""),
    ("OpenEXR whiteLuminance", exr(hand.exr_numbers("whiteLuminance", "float", 100.0)), LINEAR,
     NOTHING, "whiteLuminance (100 cd/m²) is not used"),
    ("OpenEXR adoptedNeutral", exr(hand.exr_numbers("adoptedNeutral", "v2f", 0.34, 0.35)), LINEAR,
     NOTHING, "adoptedNeutral (0.34, 0.35) is not used"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("row", "make", "space", "origin", "word"),
    ROWS,
    ids=[f"{i} {r[0]}" for i, r in enumerate(ROWS)],
)
def test_what_a_file_says(tmp_path, row, make, space, origin, word):
    one = read_texture(make(tmp_path))
    assert space in (one.space, one.space.name)
    assert one.origin.startswith(origin)
    notes = notes_of(tmp_path)
    assert word in " ".join(notes)
    assert one.origin.isprintable()
    assert all(note.isprintable() for note in notes)


def notes_of(folder):
    from cutis.textures import TextureFile

    (path,) = folder.iterdir()
    with TextureFile(path) as file:
        return file.notes


def test_each_row_of_the_table_has_a_test():
    """And no test is of a row that is not there."""
    page = (Path(__file__).parents[2] / "docs" / "textures.md").read_text("utf-8")
    start = page.index("| place |")
    table = page[start : page.index("\n\n", start)].splitlines()[2:]
    rows = {re.split(r"\s*\|\s*", line)[1].strip("`") for line in table}
    tested = {row[0] for row in ROWS} | {
        *("PNG iCCP", "JPEG ICC profile", "TIFF ICC profile", "PSD ICC profile", "XMP"),
        *("DPX transfer", "DPX colorimetric", "DPX gamma", "PSD EXIF"),
    }
    assert rows == tested


@pytest.mark.parametrize("kind", ["png", "jpg", "tif", "psd"])
def test_icc_profiles_come_first_but_for_cicp(tmp_path, make, icc, kind):
    import zlib

    profile = profiled(icc)
    path = tmp_path / f"a.{kind}"
    if kind == "png":
        chunk = (b"iCCP", b"p\0\0" + zlib.compress(profile))
        hand.png(path, chunk, gama(1.0), (b"sRGB", b"\0"))
    elif kind == "jpg":
        hand.jpeg(path, (0xE2, b"ICC_PROFILE\0\1\1" + profile), hand.jpeg_exif(exif_tags(1)))
    elif kind == "tif":
        hand.tiff(path, {34675: ("U", profile)} | chromatic(XY_ADOBE))
    else:
        blocks = make.psd_block(1039, profile) + make.psd_block(1058, hand.exif(exif_tags(1)))
        make.psd(path, hand.texels(), resources=blocks)
    one = read_texture(path)
    assert (one.space, one.origin) == (P3, "its ICC profile")
    assert "overruled by its ICC profile" in " ".join(notes_of(tmp_path))
    if kind == "png":
        hand.png(path, chunk, cicp(1, 13, 0, 1))
        assert read_texture(path).origin == "its cICP"


@pytest.mark.parametrize("kind", ["png", "jpg", "tif"])
def test_a_profile_that_cannot_be_used_lets_the_next_place_speak(tmp_path, icc, kind):
    import zlib

    path, cmyk = tmp_path / f"a.{kind}", icc.profile(space=b"CMYK")
    if kind == "png":
        hand.png(path, (b"iCCP", b"p\0\0" + zlib.compress(cmyk)), gama(1.0))
    elif kind == "jpg":
        hand.jpeg(
            path, (0xE2, b"ICC_PROFILE\0\1\1" + cmyk), hand.jpeg_exif(exif_tags(65535, b"R03"))
        )
    else:
        hand.tiff(path, {34675: ("U", cmyk)} | chromatic())
    one = read_texture(path)
    assert (
        one.space.name == {"png": "linear", "jpg": "Adobe RGB (1998)", "tif": "P3, gamma 2.2"}[kind]
    )
    told = f"{one.origin} {' '.join(notes_of(tmp_path))}"
    assert "ICC profile cannot be used: it is" in told


def test_exif_of_a_psd(tmp_path, make):
    blocks = make.psd_block(1058, hand.exif(exif_tags(65535, b"R03")))
    path = make.psd(tmp_path / "a.psd", hand.texels(), resources=blocks)
    assert read_texture(path).space.name == "Adobe RGB (1998)"


@pytest.mark.parametrize("kind", ["png", "jpg", "tif"])
def test_xmp_is_named_and_not_believed(tmp_path, kind):
    xmp = (
        b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF '
        b'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description '
        b'xmlns:photoshop="http://ns.adobe.com/photoshop/1.0/" '
        b'xmlns:tiff="http://ns.adobe.com/tiff/1.0/" tiff:Orientation="6" '
        b'photoshop:ICCProfile="Adobe RGB (1998)"/></rdf:RDF></x:xmpmeta>'
    )
    path = tmp_path / f"a.{kind}"
    if kind == "png":
        hand.png(path, (b"iTXt", b"XML:com.adobe.xmp\0\0\0\0\0" + xmp))
    elif kind == "jpg":
        hand.jpeg(path, (0xE1, b"http://ns.adobe.com/xap/1.0/\0" + xmp))
    else:
        hand.tiff(path, {700: ("B", list(xmp))})
    one = read_texture(path)
    assert one.shape == hand.SIZE
    assert one.space == SRGB
    assert "its XMP names the profile 'Adobe RGB (1998)'" in one.origin
    assert "its XMP says orientation 6: not applied" in " ".join(notes_of(tmp_path))


def dpx(path, make, transfer=0, colorimetric=0, gamma=None):
    """A DPX of OpenImageIO's with other bytes where the header says transfer and gamma."""
    content = bytearray(make.image(path, hand.texels("uint16")).read_bytes())
    content[801], content[802] = transfer, colorimetric
    if gamma is not None:
        order = ">" if content.startswith(b"SDPX") else "<"
        content[1948:1952] = struct.pack(f"{order}f", gamma)
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("transfer", "colorimetric", "gamma", "space", "origin"),
    [
        (2, 0, None, LINEAR, "its transfer characteristic"),
        (5, 0, None, SRGB, "its transfer characteristic (smpte 274m, taken for sRGB's)"),
        (6, 6, None, SRGB, "its transfer characteristic (itu-r 709-4, taken for sRGB's)"),
        (4, 0, None, SRGB, "assumed, its transfer characteristic says 'unspecified video'"),
        (0, 6, None, SRGB, "its colorimetric characteristic (itu-r 709-4"),
        (0, 8, None, SRGB, "assumed, its colorimetric characteristic says"),
        (0, 0, 1.8, "Rec.709, gamma 1.8", "its gamma"),
        (0, 0, float("nan"), SRGB, NOTHING),
    ],
)
def test_what_a_dpx_says(tmp_path, make, transfer, colorimetric, gamma, space, origin):
    one = read_texture(dpx(tmp_path / "a.dpx", make, transfer, colorimetric, gamma))
    assert space in (one.space, one.space.name)
    assert one.origin.startswith(origin)


@pytest.mark.parametrize("transfer", [1, 3, 13])
def test_film_densities_need_a_name(tmp_path, make, one_line, transfer):
    path = dpx(tmp_path / "a.dpx", make, transfer)
    with pytest.raises(CutisError, match="--colorspace") as caught:
        read_texture(path)
    one_line(caught, path)
    assert read_texture(path, "ADX10").origin == "given"


@pytest.mark.parametrize(("transfer", "what"), [(16, "PQ"), (18, "HLG")])
def test_hdr_video_needs_a_name(tmp_path, one_line, transfer, what):
    path = hand.png(tmp_path / "a.png", cicp(9, transfer, 0, 1))
    with pytest.raises(CutisError, match=f"HDR video \\({what}") as caught:
        read_texture(path)
    one_line(caught, path)


@pytest.mark.parametrize("bad", [(0.3,) * 8, (0.0,) * 8, (float("nan"),) * 8, (*XY_709, 0.3, 0)])
def test_chromaticities_that_are_no_space_need_a_name(tmp_path, one_line, bad):
    path = hand.exr(tmp_path / "a.exr", hand.exr_numbers("chromaticities", "chromaticities", *bad))
    with pytest.raises(CutisError, match="no RGB space; name") as caught:
        read_texture(path)
    one_line(caught, path)


@pytest.mark.parametrize(
    ("file", "space", "power"),
    [
        (png(gama(2.2), chrm()), "P3-D65", 2.2),
        (png(gama(2.2), chrm(primaries=XY_ADOBE)), "Adobe RGB (1998)", 2.2),
        (jpeg(hand.jpeg_exif(exif_tags(65535, b"R03"))), "Adobe RGB (1998)", 563 / 256),
        (tiff(chromatic() | table(1.8)), "P3-D65", 1.8),
    ],
)
def test_colours_are_those_of_the_primaries_stated(tmp_path, file, space, power):
    one = read_texture(file(tmp_path))
    want = expected(one.pixels / 255, space, power)
    np.testing.assert_allclose(one.linear(), want, atol=3e-4)


@pytest.mark.parametrize(
    "file",
    [
        png(gama(2.2), chrm()),
        png(gama(1.8)),
        png(gama(1.0)),
        png(cicp(12, 13, 0, 1)),
        jpeg(hand.jpeg_exif(exif_tags(65535, b"R03"))),
        tiff(chromatic() | table(1.8)),
        tiff(chromatic(), "float32"),
        exr(hand.exr_text("oiio:ColorSpace", "ACEScg")),
        exr(hand.exr_numbers("acesImageContainerFlag", "int", 1)),
    ],
)
def test_what_is_written_back_means_the_same_colours(tmp_path, file):
    """The writer has no words for some of these places: then a profile says it."""
    path = file(tmp_path)
    one = read_texture(path)
    again = tmp_path / f"again{path.suffix}"
    write_texture(one, again)
    out = read_texture(again)
    if path.suffix != ".jpg":
        assert np.array_equal(out.pixels, one.pixels)
    assert "assumed" not in out.origin
    slack = 0.02 if path.suffix == ".jpg" else 1e-4
    np.testing.assert_allclose(out.linear(), one.linear(), atol=slack)


@pytest.mark.parametrize(
    "said", [b"\xe8\x03", b"ACEScg\0x", b"A" * 70_000, b"\x1b]0;x\x07", b"%s%n", "é\u202e".encode()]
)
@pytest.mark.parametrize("kind", ["tEXt", "zTXt", "iTXt", "exr"])
def test_text_of_a_header_may_hold_anything(tmp_path, kind, said):
    import zlib

    if kind == "exr":
        path = hand.exr(tmp_path / "a.exr", hand.exr_text("oiio:ColorSpace", said))
    else:
        data = {"tEXt": said, "zTXt": b"\0" + zlib.compress(said), "iTXt": b"\0\0\0\0" + said}[kind]
        path = hand.png(tmp_path / "a.png", (kind.encode(), b"oiio:ColorSpace\0" + data))
    one = read_texture(path)
    assert one.origin.startswith(("assumed", "its oiio:ColorSpace"))
    assert one.origin.isprintable()
    assert len(one.origin) < 400
