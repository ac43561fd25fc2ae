"""`cutis render`: small real pictures, looked at by numbers; sequences; what goes wrong."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

import cutis as package
from cutis.colour import lab
from cutis.textures import read_texture

pytestmark = pytest.mark.slow

MAIN = "from cutis.apps.main import main; main()"
SMALL = ("--size", "40", "--samples", "8", "--device", "cpu")


def middle(path):
    """Mean L*a*b* of the middle of a picture."""
    light = read_texture(path).linear()
    height, width = light.shape[:2]
    return lab(light[height // 3 : -height // 3, width // 3 : -width // 3].mean(axis=(0, 1)))


@pytest.fixture(scope="module")
def maps(face_rgb, tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    from cutis.colour import LINEAR
    from cutis.textures import Texture, write_texture

    write_texture(Texture(face_rgb, ("R", "G", "B"), LINEAR), folder / "face.exr")
    package.estimate(package.read(folder / "face.exr")).save(folder / "face.skin.exr")
    return folder / "face.skin.exr"


def test_a_picture_of_maps(blender, cutis, maps, tmp_path):
    out = tmp_path / "face.png"
    ended = cutis("render", maps, *SMALL, "-o", out)
    assert (ended.code, ended.err) == (0, "")
    picture = read_texture(out)
    assert picture.shape == (40, 40)
    assert picture.pixels.dtype == np.uint8
    assert "face.skin.exr" in picture.spec.getattribute("ImageDescription")
    lightness, a, b = middle(out)
    assert 40 < lightness < 90
    assert a > 5
    assert b > 5
    # the same again, with the light itself
    assert cutis("render", maps, *SMALL, "-o", tmp_path / "face.exr").code == 0
    light = read_texture(tmp_path / "face.exr").linear()
    assert np.abs(np.clip(light, 0, 1) - picture.linear()).max() < 0.01


def test_a_bundled_head_and_its_credit(blender, cutis, tmp_path):
    out = tmp_path / "head.png"
    ended = cutis("render", "--mesh", "leeperrysmith", *SMALL, "-o", out)
    assert (ended.code, ended.err) == (0, "")
    assert "Lee Perry-Smith" in ended.out
    assert "CC BY 3.0" in read_texture(out).spec.getattribute("Copyright")
    lightness, a, _ = middle(out)
    assert 40 < lightness < 90
    assert a > 5


def test_maps_of_a_bundled_head_keep_its_credit(blender, cutis, tmp_path):
    from cutis.render.heads import head
    from cutis.render.skin import Skin

    skin = package.estimate(package.read(head("leeperrysmith").albedo))
    skin.save(tmp_path / "scan.skin.exr")
    with Skin(tmp_path / "scan.skin.exr", model_only=True) as opened:
        assert head("leeperrysmith").albedo.resolve() in [p.resolve() for p in opened.origins()]
    out = tmp_path / "ball.png"
    ended = cutis("render", tmp_path / "scan.skin.exr", "--model-only", *SMALL, "-o", out)
    assert ended.code == 0
    assert "Lee Perry-Smith" in ended.out
    assert "CC BY 3.0" in read_texture(out).spec.getattribute("Copyright")


def test_more_melanin_is_darker(blender, cutis, maps, tmp_path):
    ended = cutis(
        "render", maps, *SMALL, "--mesh", "patch", "--edit-sweep", "melanin", "0.5..8",
        "--frames", 4, "-o", tmp_path / "tan.png",
    )  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    lightness = [middle(tmp_path / f"tan.{k:04d}.png")[0] for k in range(1, 5)]
    assert lightness == sorted(lightness, reverse=True)
    assert lightness[0] - lightness[-1] > 15
    with Image.open(tmp_path / "tan.webp") as film:
        assert film.n_frames == 4


@pytest.mark.parametrize("light", ["studio", "sun", "interior"])
def test_more_blood_is_redder(blender, cutis, maps, tmp_path, light):
    seen = []
    for factor in ("x0.25", "x3"):
        out = tmp_path / f"{factor}.png"
        how = ("--light", light, "--mesh", "patch", "--blood", factor)
        assert cutis("render", maps, *SMALL, *how, "-o", out).code == 0
        seen.append(middle(out))
    assert seen[1][1] - seen[0][1] > 3
    assert seen[1][0] < seen[0][0]


def test_a_sequence_goes_on_where_it_stopped(blender, cutis, maps, tmp_path):
    out = tmp_path / "turn.png"
    names = [f"turn.{k:04d}.png" for k in range(1, 7)]
    arguments = ["render", str(maps), *SMALL, "--turntable", "6", "-o", str(out)]
    with subprocess.Popen([sys.executable, "-c", MAIN, *arguments], env={**os.environ}) as run:
        end = time.monotonic() + 90
        while not (tmp_path / names[1]).is_file():
            assert run.poll() is None
            assert time.monotonic() < end
            time.sleep(0.01)
        run.send_signal(signal.SIGKILL)
    before = {name: (tmp_path / name).read_bytes() for name in names if (tmp_path / name).is_file()}
    for content in before.values():
        assert content.endswith(b"\xaeB`\x82")  # the end of a PNG
    ended = cutis(*arguments)
    assert (ended.code, ended.err) == (0, "")
    there = len(before) - (f"{len(before)} pictures were there" not in ended.out)
    assert f"{there} pictures were there already" in ended.out
    assert f"wrote {6 - there} pictures" in ended.out
    for name, content in before.items():
        assert (tmp_path / name).read_bytes() == content
    whole = sorted([*names, "turn.frames.json", "turn.webp"])
    assert sorted(path.name for path in tmp_path.iterdir()) == whole
    film = (tmp_path / "turn.webp").read_bytes()
    assert "6 pictures were there already" in cutis(*arguments).out
    assert (tmp_path / "turn.webp").read_bytes() == film
    (tmp_path / "turn.webp").write_bytes(b"old")  # of a run that was stopped before it
    log = tmp_path / "turn.frames.json"
    log.write_text(log.read_text().replace("turn.webp", "other.webp"))
    assert "6 pictures were there already" in cutis(*arguments).out
    assert (tmp_path / "turn.webp").read_bytes() == film
    assert "6 pictures" not in cutis(*arguments, "--seed", "4").out.partition("wrote")[0]


def test_what_cannot_be_rendered(cutis, maps, tmp_path):
    bare = tmp_path / "bare.obj"
    bare.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for arguments, what in (
        ((maps, "--mesh", tmp_path / "no.obj"), "there is no such file"),
        ((maps, "--mesh", "head.fbx"), "not a mesh that can be read"),
        ((maps, "--mesh", "makehuman"), "belong to another mesh"),
        ((maps, "--radius", "much"), "--radius must be"),
        ((maps, "--light", "moon"), "one of studio, sun, interior"),
        ((maps, "--turntable", 3, "--edit-sweep", "melanin", "1..2"), "one at a time"),
        ((maps, "--edit-sweep", "melanin", "lots"), "factors like 0.5..3"),
        ((maps, "--blender", tmp_path / "none"), "cutis render --install"),
        ((maps, "--turntable", 1), "2 to"),
        ((maps, "-o", tmp_path / "face.gif"), "extension"),
        ((tmp_path / "no.skin.exr",), "no.skin.exr"),
        ((), "--mesh makehuman"),
    ):
        ended = cutis(
            "render", *arguments, *(() if "-o" in arguments else ("-o", tmp_path / "a.png"))
        )
        assert ended.code == 1, arguments
        assert what in ended.err, ended.err
        assert ended.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bare.obj"]


def test_meshes_that_cannot_be_rendered(blender, cutis, maps, tmp_path):
    for name, text, what in (
        ("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "UVs"),
        ("empty.obj", "", "no faces"),
        ("broken.glb", "glTF nonsense", "broken.glb"),
    ):
        (tmp_path / name).write_text(text)
        ended = cutis("render", maps, *SMALL, "--mesh", tmp_path / name, "-o", tmp_path / "a.png")
        assert ended.code == 1, name
        assert what in ended.err, ended.err
        assert ended.err.count("\n") == 1
        assert not (tmp_path / "a.png").exists()


def test_edits_of_a_texture_need_maps(blender, cutis, maps, tmp_path):
    face = maps.with_name("face.exr")
    ended = cutis("render", face, "--melanin", "x2", *SMALL, "-o", tmp_path / "a.png")
    assert ended.code == 1
    assert "cutis estimate" in ended.err


def test_a_bundled_head_gets_maps_for_edits(blender, cutis, tmp_path):
    for flags, name in (((), "a.png"), (("--melanin", "x3"), "b.png")):
        ended = cutis("render", "--mesh", "makehuman", *flags, *SMALL, "-o", tmp_path / name)
        assert (ended.code, ended.err) == (0, "")
        assert "credit: head by the MakeHuman team" in ended.out
    assert middle(tmp_path / "b.png")[0] < middle(tmp_path / "a.png")[0] - 3
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.png"]


def test_a_set_of_tiles(blender, cutis, maps, tmp_path):
    mesh = tmp_path / "two.obj"
    mesh.write_text(
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
        "vt 0 0\nvt 1 0\nvt 2 0\nvt 0 1\nvt 1 1\nvt 2 1\nf 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\n"
    )
    face = read_texture(maps.with_name("face.exr"))
    for number, dark in ((1001, 1.0), (1002, 0.6)):
        tile = face.with_linear(face.linear() * np.float32(dark), np.ones(face.shape, bool))
        package.write(tile, tmp_path / f"t.{number}.exr")
    assert cutis("estimate", tmp_path / "t.<UDIM>.exr", "-o", tmp_path).code == 0
    out = tmp_path / "set.exr"
    ended = cutis(
        "render", tmp_path / "t.<UDIM>.skin.exr", "--mesh", mesh, *SMALL, "--light", "furnace",
        "--melanin", "x1.2", "-o", out,
    )  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    assert "outside the texture" not in ended.out
    light = read_texture(out).linear()[20]
    left, right = light[8:18].mean(), light[22:32].mean()
    assert right < 0.8 * left
    ended = cutis("render", tmp_path / "t.<UDIM>.skin.exr", "--export", tmp_path / "material")
    assert ended.code == 1
    assert "one tile" in ended.err
