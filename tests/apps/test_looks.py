"""Looks on the command line: the same bytes as anywhere else, and what goes wrong in one line."""

import json
import re
import shutil

import numpy as np
import pytest
from PIL import Image

import cutis as package
from cutis.colour import LINEAR
from cutis.jobs import EditJob
from cutis.jobs.runners import cluster
from cutis.looks import Look, presets
from cutis.maps import MapsFile, load_maps
from cutis.textures import Texture, read_channels, write_texture

NUMBERS = (1001, 1002, 1011)
LOOK = {
    "cutis_look": 1,
    "name": "spring",
    "layers": [
        {"name": "even", "edits": [
            {"do": "contrast", "map": "melanin", "by": 0.5},
            {"do": "contrast", "map": "blood", "by": 1.7, "about": "local", "radius": 0.1},
            {"do": "blur", "map": "thickness", "radius": "9px"},
        ]},
        {"name": "brush", "amount": 0.8, "edits": [{"do": "multiply", "map": "melanin", "by": 2}],
         "mask": [{"part": "strokes", "strokes": [
             {"points": [[0.1, 0.1], [0.8, 0.9]], "radius": 0.2},
             {"points": [[0.9, 0.1], [0.2, 0.9]], "radius": 0.1, "tile": 1002},
         ]}]},
        {"name": "freckles", "edits": [{"do": "offset", "map": "melanin", "by": 0.02}],
         "mask": [{"part": "freckles", "size": 0.03, "density": 0.3},
                  {"part": "range", "how": "intersect", "map": "blood", "above": ["p20", "p60"]}]},
        {"name": "paint", "edits": [{"do": "multiply", "map": "blood", "by": 1.6, "areas": "large",
                                     "radius": "3px"}],
         "mask": [{"part": "picture", "path": "paint.<UDIM>.png", "feather": "1.5px"}]},
        {"name": "ill", "amount": 0.3, "edits": [{"do": "set", "map": "bilirubin", "to": 0.05}]},
    ],
}  # fmt: skip


@pytest.fixture
def set_of_maps(face_rgb, cutis, tmp_path):
    """face.<UDIM>.skin.exr of three tiles, its captures, spring.look.json and what it names."""
    for i, number in enumerate(NUMBERS):
        pixels = face_rgb[:, i * 5 : i * 5 + 20].astype(np.float16)
        write_texture(Texture(pixels, ("R", "G", "B"), LINEAR), tmp_path / f"face.{number}.exr")
        Image.linear_gradient("L").rotate(90 * i).resize((20, 24)).save(
            tmp_path / f"paint.{number}.png"
        )
    ended = cutis("estimate", tmp_path / "face.<UDIM>.exr", "-o", tmp_path, "-q")
    assert (ended.code, ended.err) == (0, "")
    (tmp_path / "spring.look.json").write_text(json.dumps(LOOK))
    return tmp_path / "face.<UDIM>.skin.exr"


def contents(folder):
    """Bytes of files by name, without the second in which they were written."""
    written = re.compile(rb"capDate\0string\0.{4}\d{4}:\d\d:\d\d \d\d:\d\d:\d\d", re.DOTALL)
    return {path.name: written.sub(b"", path.read_bytes()) for path in sorted(folder.iterdir())}


def test_the_same_bytes_wherever_it_is_applied(
    set_of_maps, cutis, scheduler, worker, tmp_path, monkeypatch
):
    worker()
    names = {}
    for how in ("cli", "job", "bands", "dask"):
        (tmp_path / how).mkdir()
        names[how] = (tmp_path / how / "a.<UDIM>.exr", tmp_path / how / "a.<UDIM>.skin.exr")
    ended = cutis("edit", set_of_maps, "--look", tmp_path / "spring.look.json", "-q",
                  "-o", names["cli"][0], "--save-maps", names["cli"][1])  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    look = Look.load(tmp_path / "spring.look.json")
    jobs = {
        how: EditJob(set_of_maps, output, look, save_maps=maps)
        for how, (output, maps) in names.items()
    }
    jobs["job"].run()
    (_, result) = next(cluster(scheduler)(lambda job, progress: job.run(), [jobs["dask"]], idle))
    assert [len(one.edits) for one in result] == [7, 7, 7]
    with monkeypatch.context() as patch:
        patch.setattr("cutis.textures.texture._BAND", 5 * 20)  # five rows
        jobs["bands"].run()
    expected = contents(tmp_path / "cli")
    assert len(expected) == 2 * len(NUMBERS)
    for how in ("job", "bands", "dask"):
        assert contents(tmp_path / how) == expected, how

    (tmp_path / "library").mkdir()
    for number in NUMBERS:
        skin = package.load(tmp_path / f"face.{number}.skin.exr").apply(look)
        texture = package.read(tmp_path / f"face.{number}.exr")
        out = skin.retouch(texture)
        write_texture(out, tmp_path / "library" / f"a.{number}.exr")
        theirs = read_channels(tmp_path / "cli" / f"a.{number}.skin.exr")[0]
        for name in ("melanin", "blood", "thickness", "bilirubin"):
            np.testing.assert_array_equal(skin.maps[name], theirs[name], name)
        assert (out.pixels != texture.pixels).any()
    for name, content in contents(tmp_path / "library").items():
        assert content == expected[name]


def idle(done, total, doing):
    """Progress that nobody sees."""


def test_saved_maps_keep_the_look_and_can_do_it_again(set_of_maps, cutis, tmp_path):
    kept = tmp_path / "kept.<UDIM>.skin.exr"
    ended = cutis("edit", set_of_maps, "--look", tmp_path / "spring.look.json", "-q",
                  "-o", tmp_path / "a.<UDIM>.exr", "--save-maps", kept)  # fmt: skip
    assert ended.code == 0, ended.err
    with MapsFile(tmp_path / "kept.1001.skin.exr") as file:
        (document,) = file.header.looks
    again = Look.of_text(document, "header")
    assert again.name == "spring"
    assert again.layers == Look.load(tmp_path / "spring.look.json").layers


def test_flags_looks_and_presets_in_the_order_typed(maps, cutis, tmp_path):
    Look.of([package.Edit("melanin", "offset", 0.01)], "lift").save(tmp_path / "lift.look.json")
    orders = {
        "a": ["--melanin", "x2", "--look", tmp_path / "lift.look.json", "--melanin", "x1.5"],
        "b": ["--look", tmp_path / "lift.look.json", "--melanin", "x2", "--melanin", "x1.5"],
    }
    face = package.read(maps.parents[1] / "face.png")
    skin = package.estimate(face)
    expected = {
        "a": skin.multiply(melanin=2).offset(melanin=0.01).multiply(melanin=1.5),
        "b": skin.offset(melanin=0.01).multiply(melanin=2).multiply(melanin=1.5),
    }
    for name, flags in orders.items():
        out = tmp_path / f"{name}.png"
        ended = cutis("edit", maps, *flags, "-o", out)
        assert (ended.code, ended.err) == (0, "")
        np.testing.assert_array_equal(package.read(out).pixels, expected[name].retouch(face).pixels)
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()


def test_what_was_typed_is_saved_as_a_look(maps, cutis, tmp_path):
    Image.linear_gradient("L").resize((32, 24)).save(tmp_path / "paint.png")
    saved, out = tmp_path / "all.look.json", tmp_path / "a.png"
    flags = ["--preset", "tanning", "--thickness", "-10", "--blood", "0.03", "--amount", "0.6",
             "--mask", tmp_path / "paint.png"]  # fmt: skip
    ended = cutis("edit", maps, *flags, "-o", out, "--save-look", saved)
    assert (ended.code, ended.err) == (0, "")
    look = Look.load(saved)
    assert look.tissue == load_maps(maps).made_by.load().tissue.name
    assert {part.path for layer in look.layers for part in layer.mask} == {"paint.png"}
    again = tmp_path / "b.png"
    ended = cutis("edit", maps, "--look", saved, "-o", again)
    assert (ended.code, ended.err) == (0, "")
    assert again.read_bytes() == out.read_bytes()
    ended = cutis("edit", maps, *look.as_flags(), "-o", again)
    assert (ended.code, ended.err) == (0, "")
    assert again.read_bytes() == out.read_bytes()


def test_a_mask_outside_the_folder_needs_leave(maps, cutis, one_line, tmp_path):
    (tmp_path / "in").mkdir()
    Image.new("L", (32, 24), 255).save(tmp_path / "paint.png")
    look = {"cutis_look": 1, "layers": [{"edits": [{"do": "multiply", "map": "blood", "by": 2}],
            "mask": [{"part": "picture", "path": "../paint.png"}]}]}  # fmt: skip
    (tmp_path / "in/a.look.json").write_text(json.dumps(look))
    flags = ["--look", tmp_path / "in/a.look.json", "-o", tmp_path / "a.png"]
    said = one_line(cutis("edit", maps, *flags))
    assert "layer 1: '../paint.png' is outside the folder of the look" in said
    assert cutis("edit", maps, *flags, "--allow-outside").code == 0


@pytest.mark.parametrize("suffix", [".cube", ".clf"])
def test_a_look_of_no_place_is_a_lut_and_another_is_refused(
    suffix, maps, cutis, one_line, tmp_path
):
    presets.tanning.save(tmp_path / "tan.look.json")
    one, other = tmp_path / f"one{suffix}", tmp_path / f"other{suffix}"
    size = ("--size", "17", "-q")
    assert cutis("export", one, "--look", tmp_path / "tan.look.json", *size).code == 0
    assert cutis("export", other, "--preset", "tanning", *size).code == 0
    assert one.read_bytes() == other.read_bytes()
    presets.vitiligo.save(tmp_path / "v.look.json")
    ended = cutis("export", tmp_path / f"no{suffix}", "--look", tmp_path / "v.look.json", *size)
    assert "look vitiligo, layer 1: it depends on the place" in one_line(ended)
    even = Look.of_text(json.dumps({"cutis_look": 1, "layers": [
        {"edits": [{"do": "contrast", "map": "melanin", "by": 0.5}]}]}), "even")  # fmt: skip
    even.save(tmp_path / "even.look.json")
    flags = ("--look", tmp_path / "even.look.json", *size)
    said = one_line(cutis("export", tmp_path / f"e{suffix}", *flags))
    assert "take the median of a face; give its maps, with --maps" in said
    assert cutis("export", tmp_path / f"e{suffix}", *flags, "--maps", maps).code == 0


def test_another_tissue_is_refused_where_numbers_are_amounts(maps, cutis, one_line, tmp_path):
    for name, edit in (("set", {"do": "set", "map": "melanin", "to": 0.05}),
                       ("times", {"do": "multiply", "map": "melanin", "by": 2})):  # fmt: skip
        look = {"cutis_look": 1, "tissue": "mars", "layers": [{"name": "one", "edits": [edit]}]}
        (tmp_path / f"{name}.look.json").write_text(json.dumps(look))
    out = tmp_path / "a.png"
    said = one_line(cutis("edit", maps, "--look", tmp_path / "set.look.json", "-o", out))
    assert "layer 1 (one): its numbers are of the tissue mars" in said
    assert not out.exists()
    assert cutis("edit", maps, "--look", tmp_path / "times.look.json", "-o", out).code == 0


def test_a_missing_tile_of_the_set_is_said(set_of_maps, cutis, one_line, tmp_path):
    (tmp_path / "alone").mkdir()
    shutil.copy(tmp_path / "face.1002.skin.exr", tmp_path / "alone")
    ended = cutis("edit", tmp_path / "alone" / "face.1002.skin.exr", "--source",
                  tmp_path / "face.1002.exr", "--look", tmp_path / "spring.look.json",
                  "-o", tmp_path / "a.exr")  # fmt: skip
    assert "is a tile of the same face and is not there" in one_line(ended)


def test_an_animation_is_of_edits_of_every_amount(maps, cutis, tmp_path):
    out = tmp_path / "flush.png"
    flags = ("--preset", "flushing", "--melanin", "x2", "-q")
    ended = cutis("edit", maps, *flags, "--amount", "0..0.8", "--frames", "5", "-o", out)
    assert (ended.code, ended.err, ended.out) == (0, "", "")
    frames = [tmp_path / f"flush.000{number}.png" for number in range(1, 6)]
    for amount, frame in zip(np.linspace(0, 0.8, 5), frames, strict=True):
        assert cutis("edit", maps, *flags, "--amount", amount, "-o", out).code == 0
        assert frame.read_bytes() == out.read_bytes()
    assert len({frame.read_bytes() for frame in frames}) == 5
    with Image.open(tmp_path / "flush.webp") as film:
        assert (film.n_frames, film.size) == (5, (32, 24))


def test_an_animation_of_a_set_has_no_film(set_of_maps, cutis, tmp_path):
    ended = cutis("edit", set_of_maps, "--melanin", "x2", "--amount", "1..0", "--frames", "2",
                  "-o", tmp_path / "fade.<UDIM>.exr")  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    assert "wrote 6 pictures\n" in ended.out
    assert (tmp_path / "fade.1011.0002.exr").is_file()
    assert not list(tmp_path.glob("*.webp"))


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (("--amount", "0..2"), "--amount is a number from 0 to 1, or a range such as 0..1"),
        (("--amount", "nan"), "--amount is a number from 0 to 1"),
        (("--amount", "a lot"), "not 'a lot'"),
        (("--amount", "0..1", "--frames", "1"), "2 to 10000 pictures, not 1"),
        (("--frames", "3"), "--frames is of a range of amounts"),
        (("--amount", "0..1", "--save-maps", "m.skin.exr"), "a sequence is of pictures"),
        (("--amount", "0..1", "--save-look", "a.look.json"), "a look has one amount"),
    ],
)
def test_bad_animations_are_one_line(flags, said, maps, cutis, one_line, tmp_path):
    out = tmp_path / "a.png"
    assert said in one_line(cutis("edit", maps, "--melanin", "x2", "-o", out, *flags))
    assert not list(tmp_path.glob("a.*"))
