"""Real pictures, small, measured by numbers."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from render_files import (
    CUBE,
    QUARTERS,
    SQUARE,
    UVS,
    read_exr,
    write_exr,
    write_glb,
    write_obj,
    write_usda,
)

from cutis.errors import CutisError
from cutis.render.blender import find_blender
from cutis.render.cycles_process import render
from cutis.render.scene import Scene

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
QUICK = {"width": 48, "height": 48, "samples": 8, "denoise": False}
PLAIN = QUICK | {"method": "diffuse", "specular": 0.0}
"""A Lambertian surface: what comes back is known."""
ORDER = {"upper left": (12, 12), "upper right": (12, 36), "lower left": (36, 12)}


@pytest.fixture
def picture(blender, tmp_path):
    """`picture(scene, ...)` renders scenes in one go; returns their pixels."""

    def run(*scenes):
        files = [(scene, tmp_path / f"{i}.exr") for i, scene in enumerate(scenes)]
        render(files, blender)
        pixels = [read_exr(path) for _, path in files]
        return pixels if len(scenes) > 1 else pixels[0]

    return run


def test_a_uniform_light_gives_back_a_lambertian_colour(picture):
    """In the middle of samples exactly; 5.2 ends a few paths early and others count for them."""
    colour = (0.8, 0.5, 0.2)
    pixels = picture(Scene(base_colour=colour, mesh="patch", light="furnace", **PLAIN))
    assert pixels.shape == (48, 48, 3)
    np.testing.assert_allclose(np.median(pixels, axis=(0, 1)), colour, atol=1e-4)
    np.testing.assert_allclose(pixels.mean((0, 1)), colour, rtol=1e-3)


def test_a_white_card_is_as_bright_under_every_light(picture):
    """Luminance 0.8 within 2 %; two seeds tell that the mean's own error is far below."""
    white = PLAIN | {"width": 64, "height": 64, "samples": 64, "base_colour": (1.0, 1.0, 1.0)}
    lights = ("studio", "sun", "interior")
    scenes = [
        Scene(mesh="patch", tilt=0.0, light=light, seed=seed, **white)
        for light in lights
        for seed in (0, 1)
    ]
    cards = [pixels[16:48, 16:48] @ LUMINANCE for pixels in picture(*scenes)]
    for one, two in zip(cards[::2], cards[1::2], strict=True):
        error = (one - two).std() / 2 / np.sqrt(one.size)
        assert error < 2e-3
        assert (one + two).mean() / 2 == pytest.approx(0.8, rel=0.02)


def test_lights_have_their_colours(picture):
    """The studio is neutral, the interior warm, the sun's sky not far from neutral."""
    white = PLAIN | {"base_colour": (1.0, 1.0, 1.0), "samples": 64, "mesh": "patch", "tilt": 0.0}
    studio, sun, interior = (
        pixels[16:32, 16:32].mean((0, 1))
        for pixels in picture(
            *(Scene(light=light, **white) for light in ("studio", "sun", "interior"))
        )
    )
    assert np.ptp(studio) < 1e-3
    assert interior[0] > 1.2 * interior[1] > 1.2 * interior[2]
    assert np.ptp(sun) < 0.1 * sun.mean()


def test_pictures_are_filled_and_nothing_is_cut_at_any_turn(picture, tmp_path):
    corners, uvs, faces = CUBE
    box = [(x, 1.5 * y, z) for x, y, z in corners]
    mesh = write_obj(tmp_path / "box.obj", box, uvs, faces)
    quick = QUICK | {"transparent": True, "subdivision": 0, "samples": 4}
    wide = quick | {"width": 96}
    turns = [Scene(mesh=mesh, turn=turn, **quick) for turn in (0.0, 45.0, 90.0, 200.0)]
    others = [Scene(mesh="sphere", **quick), Scene(mesh="sphere", **wide)]
    heights = []
    for pixels in picture(*turns, *others):
        alpha = pixels[..., 3]
        assert alpha.max() == pytest.approx(1.0, abs=1e-4)
        frame = np.concatenate([alpha[0], alpha[-1], alpha[:, 0], alpha[:, -1]])
        assert frame.max() == 0.0
        heights.append(np.count_nonzero(alpha.max(1) > 0.5) / 48)
    assert min(heights) > 0.7
    # The corners that come nearest, at 45°, reach to the margin; so does the sphere.
    assert heights[1] > 0.88
    assert min(heights[4:]) > 0.88


@pytest.mark.parametrize("mesh", ["patch", "sphere", "obj", "glb", "usda"])
def test_textures_are_upright_and_not_mirrored(picture, quarters, tmp_path, mesh):
    makers = {"obj": write_obj, "glb": write_glb, "usda": write_usda}
    if mesh in makers:
        mesh = makers[mesh](tmp_path / f"square.{mesh}")
    pixels = picture(Scene(base_colour=quarters, mesh=mesh, tilt=0.0, **PLAIN))
    for name, (row, column) in ORDER.items():
        seen = pixels[row - 3 : row + 3, column - 3 : column + 3].mean((0, 1))
        wanted = QUARTERS[row // 24, column // 24]
        cosines = [
            seen @ c / np.linalg.norm(seen) / np.linalg.norm(c) for c in QUARTERS.reshape(-1, 3)
        ]
        assert np.argmax(cosines) == np.argmax(QUARTERS.reshape(-1, 3) @ wanted), name


def test_a_turn_brings_what_was_on_the_left_to_the_middle(picture, quarters):
    for turn, channel in ((50.0, 0), (-50.0, 1)):
        pixels = picture(Scene(base_colour=quarters, mesh="sphere", turn=turn, **PLAIN))
        assert np.argmax(pixels[12:20, 22:26].mean((0, 1))) == channel


@pytest.mark.skipif(os.name == "nt", reason="the program made here is a shell script")
def test_a_program_is_run_as_blender_is(blender, picture, tmp_path):
    """What takes Blender's options and runs the script after --python gives the same picture."""
    if not blender.module:
        pytest.skip("the Blender here is a program already")
    (tmp_path / "blender.py").write_text(
        "import runpy, sys\n"
        "script = sys.argv[sys.argv.index('--python') + 1]\n"
        "assert '--' in sys.argv\n"
        "runpy.run_path(script, run_name='__main__')\n"
    )
    program = tmp_path / "blender"
    program.write_text(
        '#!/bin/sh\ncase "$*" in *--version*) echo Blender 4.2.0; exit;; esac\n'
        f'exec "{blender.executable}" "{tmp_path}/blender.py" "$@"\n'
    )
    program.chmod(0o755)
    found = find_blender(program)
    assert (found.module, found.version) == (False, (4, 2, 0))
    render([(Scene(**QUICK), tmp_path / "out.exr")], found)
    np.testing.assert_array_equal(read_exr(tmp_path / "out.exr"), picture(Scene(**QUICK)))


def test_a_seed_names_a_picture(picture):
    first, again, other = picture(
        Scene(seed=5, **QUICK), Scene(seed=5, **QUICK), Scene(seed=6, **QUICK)
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 1e-3


def test_an_exposure_is_in_stops(picture):
    dark, bright = picture(Scene(exposure=-1.0, **QUICK), Scene(exposure=1.0, **QUICK))
    np.testing.assert_allclose(bright, 4 * dark, rtol=1e-4, atol=1e-6)


def test_lengths_below_the_surface_are_millimetres_of_the_mesh(picture, tmp_path):
    """More light gets out of a cube that is less thick in mean free paths, by either way."""
    mesh = write_obj(tmp_path / "cube.obj", *CUBE)
    same = {"mesh": mesh, "light": "furnace", "specular": 0.0, "base_colour": (0.5,) * 3}
    same |= QUICK | {"samples": 32, "subdivision": 0}
    thick, thin, small = (
        pixels[18:30, 18:30].mean()
        for pixels in picture(
            Scene(radius=(0.5,) * 3, millimetres_per_unit=50.0, **same),
            Scene(radius=(200.0,) * 3, millimetres_per_unit=50.0, **same),
            Scene(radius=(20.0,) * 3, millimetres_per_unit=5.0, **same),
        )
    )
    assert thin > 1.1 * thick
    assert small == pytest.approx(thin, rel=0.02)


def test_brighter_skin_is_brighter_under_every_light(picture):
    skins = [(0.06, 0.03, 0.02), (0.3, 0.17, 0.1), (0.6, 0.4, 0.32)]
    lights = ("studio", "sun", "interior")
    quick = QUICK | {"radius": (0.5, 0.35, 0.25), "samples": 16}
    scenes = [Scene(base_colour=skin, light=light, **quick) for light in lights for skin in skins]
    means = np.array([pixels[12:36, 12:36].mean((0, 1)) for pixels in picture(*scenes)])
    means = means.reshape(len(lights), len(skins), 3)
    assert (np.diff(means, axis=1) > 0.01).all()
    assert 0.1 < means[:, 2].mean() < 1.0


def test_the_surface_reflects_and_roughness_spreads_it(picture, tmp_path):
    """A map of a roughness is that roughness; a smaller one has the brighter highlight."""
    dark = QUICK | {"base_colour": (0.02,) * 3, "radius": (0.1,) * 3, "samples": 32}
    map_of = write_exr(tmp_path / "rough.exr", np.full((4, 4, 3), 0.5))
    none, rough, mapped, smooth = picture(
        Scene(specular=0.0, **dark),
        Scene(roughness=0.5, **dark),
        Scene(roughness=map_of, **dark),
        Scene(roughness=0.2, **dark),
    )
    np.testing.assert_allclose(mapped, rough, atol=1e-4)
    assert rough[20:28, 20:28].mean() > none[20:28, 20:28].mean()
    centre = np.hypot(*np.mgrid[-23.5:24, -23.5:24]) < 15
    assert smooth[centre].max() > 1.3 * rough[centre].max()


def test_a_normal_map_bends_the_surface(picture, tmp_path):
    def leaning(x):
        n = np.array([x, 0.0, np.sqrt(1 - x * x)])
        return write_exr(tmp_path / f"n{x}.exr", np.broadcast_to(0.5 + 0.5 * n, (4, 4, 3)))

    same = PLAIN | {"base_colour": (0.5,) * 3, "mesh": "patch", "tilt": 0.0, "light": "sun"}
    left, flat, right = (
        pixels[16:32, 16:32].mean()
        for pixels in picture(
            *(Scene(normal=leaning(x), **same) for x in (-0.4, 0.0, 0.4)),
        )
    )
    assert left < 0.95 * flat < 0.9 * right  # the sun stands on the right


def test_parts_without_texture_coordinates_are_not_skin(picture, tmp_path):
    """Two squares side by side, one with all its coordinates at 0: ivory, not the texture's red."""
    left = [(x - 1.1, y, z) for x, y, z in SQUARE]
    right = [(x + 1.1, y, z) for x, y, z in SQUARE]
    uvs = UVS + [(0.0, 0.0)] * 4
    mesh = write_obj(tmp_path / "two.obj", left + right, uvs, [(1, 2, 3, 4), (5, 6, 7, 8)])
    red = QUICK | {"base_colour": (0.7, 0.02, 0.02), "radius": (0.1,) * 3, "tilt": 0.0}
    pixels = picture(Scene(mesh=mesh, **red | {"width": 96}))
    skin, ivory = pixels[20:28, 20:28].mean((0, 1)), pixels[20:28, 68:76].mean((0, 1))
    assert skin[0] > 3 * skin[1]
    assert ivory[1] > 0.7 * ivory[0]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "has no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "has no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no texture coordinates"),
        ("v 3 3 3\nv 3 3 3\nv 3 3 3\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "no size"),
        ("v 0 0 0\nv 1e20 0 0\nv 0 1e20 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", "units wide"),
    ],
)
def test_meshes_that_cannot_be_used_are_refused_in_one_line(blender, tmp_path, content, says):
    path = tmp_path / "head.obj"
    path.write_text(content)
    with pytest.raises(CutisError, match=says) as error:
        render([(Scene(mesh=path, **QUICK), tmp_path / "out.exr")], blender)
    assert str(path) in str(error.value)
    assert [p.name for p in tmp_path.iterdir()] == ["head.obj"]


@pytest.mark.parametrize("write", [write_obj, write_usda])
def test_vertices_that_are_not_numbers_are_refused(blender, tmp_path, write):
    path = write(tmp_path / f"head.{write.__name__[6:]}")
    path.write_text(path.read_text().replace("-1.0", "nan"))
    with pytest.raises(CutisError, match="vertices that are not numbers"):
        render([(Scene(mesh=path, **QUICK), tmp_path / "out.exr")], blender)


@pytest.mark.parametrize("name", ["head.glb", "head.usda", "head.usdc", "head.gltf"])
def test_files_that_are_no_meshes_are_refused(blender, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(bytes(range(256)))
    with pytest.raises(CutisError, match=r"cannot be read|has no faces"):
        render([(Scene(mesh=path, **QUICK), tmp_path / "out.exr")], blender)


def test_an_absurd_scale_is_refused(blender, tmp_path):
    scene = Scene(mesh=write_obj(tmp_path / "a.obj"), millimetres_per_unit=1e6, **QUICK)
    with pytest.raises(CutisError, match=r"2e\+06 mm wide.*give the millimetres per mesh unit"):
        render([(scene, tmp_path / "out.exr")], blender)


def test_a_broken_texture_ends_the_job_and_what_was_finished_stays(blender, tmp_path):
    broken = tmp_path / "broken.exr"
    broken.write_bytes(b"not an image")
    finished = []
    jobs = [
        (Scene(**QUICK), tmp_path / "good.exr"),
        (Scene(base_colour=broken, **QUICK), tmp_path / "bad.exr"),
    ]
    with pytest.raises(CutisError, match=r"broken\.exr cannot be read"):
        render(jobs, blender, finished=finished.append)
    assert finished == [tmp_path / "good.exr"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["broken.exr", "good.exr"]


def test_progress_counts_samples_up_to_all_of_them(blender, tmp_path):
    told = []
    files = [(Scene(**QUICK), tmp_path / name) for name in ("one.exr", "two.exr")]
    device = render(files, blender, lambda *at: told.append(at))
    assert device
    done = [at[0] for at in told]
    assert done == sorted(done)
    assert {at[1] for at in told} == {16}
    assert (done[0], done[-1]) == (0, 16)
    assert {"one", "two"} <= {at[2] for at in told}


def test_where_it_cannot_be_written_nothing_is_rendered(blender, tmp_path):
    with pytest.raises(CutisError, match="does not exist; create it first"):
        render([(Scene(), tmp_path / "nowhere" / "a.exr")], blender)
    with pytest.raises(CutisError, match=r"rendered into \.exr files"):
        render([(Scene(), tmp_path / "a.png")], blender)


def children(pid: int) -> list[int]:
    """Processes that a process started and that still are."""
    try:
        found = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    except FileNotFoundError:
        return []
    return [int(child) for child in found.split()]


TWO_TILES = """v 0 0 0
v 1 0 0
v 2 0 0
v 0 1 0
v 1 1 0
v 2 1 0
vt 0 0
vt 1 0
vt 2 0
vt 0 1
vt 1 1
vt 2 1
f 1/1 2/2 5/5 4/4
f 2/2 3/3 6/6 5/5
"""
"""Two squares side by side, the right one on tile 1002."""
RED, GREEN = (0.8, 0.1, 0.1), (0.1, 0.8, 0.1)


@pytest.fixture
def tiles(tmp_path):
    """NAME.<UDIM>.exr of two tiles, red and green."""
    for number, colour in ((1001, RED), (1002, GREEN)):
        write_exr(tmp_path / f"t.{number}.exr", np.tile(np.float32(colour), (16, 16, 1)))
    return tmp_path / "t.<UDIM>.exr"


def two(tmp_path, blender, colour, text=TWO_TILES):
    """The pixels of both squares, and what is said of them."""
    (tmp_path / "two.obj").write_text(text)
    scene = Scene(base_colour=colour, mesh=tmp_path / "two.obj", light="furnace", subdivision=0,
                  **PLAIN)  # fmt: skip
    said = []
    render([(scene, tmp_path / "out.exr")], blender, note=said.append)
    pixels = read_exr(tmp_path / "out.exr")
    return pixels[24, 16, :3], pixels[24, 32, :3], said


def test_tiles_of_a_set_are_where_the_mesh_has_them(blender, tiles, tmp_path):
    left, right, said = two(tmp_path, blender, tiles)
    np.testing.assert_allclose(left, RED, atol=1e-3)
    np.testing.assert_allclose(right, GREEN, atol=1e-3)
    assert said == []


def test_what_is_outside_a_texture_is_said(blender, tiles, tmp_path):
    _, right, said = two(tmp_path, blender, tmp_path / "t.1001.exr")
    np.testing.assert_allclose(right, RED, atol=1e-3)  # its edge
    assert len(said) == 1
    assert "50 % of the mesh" in said[0]
    assert "tile 1002" in said[0]
    assert "<UDIM>" in said[0]


def test_a_tile_that_is_not_there_is_said(blender, tiles, tmp_path):
    (tmp_path / "t.1002.exr").unlink()
    _, _, said = two(tmp_path, blender, tiles)
    assert ["tile 1002 is not there" in one for one in said] == [True]


def test_materials_that_are_dropped_are_named(blender, quarters, tmp_path):
    text = TWO_TILES.replace("f 1", "usemtl skin\nf 1").replace("f 2", "usemtl teeth\nf 2")
    text = text.replace("vt 2", "vt 0.5")
    _, _, said = two(tmp_path, blender, quarters, text)
    assert len(said) == 1
    assert "skin, teeth" in said[0]


def test_a_broken_mesh_is_one_line_without_a_traceback(blender, tmp_path):
    write_glb(tmp_path / "square.glb")
    content = (tmp_path / "square.glb").read_bytes()
    (tmp_path / "bad.glb").write_bytes(content.replace(b'"bufferView": 1', b'"bufferView": 9'))
    scene = Scene(mesh=tmp_path / "bad.glb", **PLAIN)
    with pytest.raises(CutisError, match=r"bad\.glb") as error:
        render([(scene, tmp_path / "out.exr")], blender)
    assert "Traceback" not in str(error.value)
    assert 'File "' not in str(error.value)


linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at /proc")
LONG = {"width": 512, "height": 512, "samples": 4096, "denoise": False}


@linux
@pytest.mark.parametrize(
    ("kind", "says"),
    [(signal.SIGSEGV, "SIGSEGV.*last words"), (signal.SIGKILL, "killed.*want of memory")],
)
def test_a_crash_becomes_one_line_and_a_log(blender, tmp_path, kind, says):
    before = set(children(os.getpid()))

    def strike(done, total, name):
        if done:
            for child in set(children(os.getpid())) - before:
                os.kill(child, kind)

    with pytest.raises(CutisError, match=says) as error:
        render([(Scene(**LONG), tmp_path / "out.exr")], blender, strike)
    log = Path(str(error.value).rpartition(": ")[2].rstrip(")"))
    assert log.is_file()
    log.unlink()
    assert not list(tmp_path.iterdir())


@linux
def test_an_interrupt_ends_blender_and_leaves_nothing(blender, tmp_path):
    script = f"""
from pathlib import Path
from cutis.render.blender import find_blender
from cutis.render.cycles_process import render
from cutis.render.scene import Scene
out = Path({str(tmp_path)!r})
say = lambda done, total, name: print(done, flush=True)
render([(Scene(**{LONG!r}), out / "out.exr")], find_blender({str(blender.executable)!r}), say)
"""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    process = subprocess.Popen(
        [sys.executable, "-c", script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    assert process.stdout is not None
    while int(process.stdout.readline()) == 0:  # until Cycles has begun
        pass
    below = children(process.pid)
    assert below
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert "KeyboardInterrupt" in said
    assert not any(Path(f"/proc/{child}").exists() for child in below)
    assert not list(tmp_path.iterdir())


@linux
def test_blender_ends_when_the_one_who_asked_is_killed(blender, tmp_path):
    script = f"""
from pathlib import Path
from cutis.render.blender import find_blender
from cutis.render.cycles_process import render
from cutis.render.scene import Scene
say = lambda done, total, name: print(done, flush=True)
out = Path({str(tmp_path)!r}) / "out.exr"
render([(Scene(**{LONG!r}), out)], find_blender({str(blender.executable)!r}), say)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", script],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=os.environ | {"TMPDIR": str(tmp_path)},
    )
    assert process.stdout is not None
    while int(process.stdout.readline()) == 0:
        pass
    below = children(process.pid)
    assert below
    process.kill()
    process.communicate()
    end = time.monotonic() + 60
    while any(Path(f"/proc/{child}").exists() for child in below):
        assert time.monotonic() < end, "Blender goes on without anybody to give pictures to"
        time.sleep(0.1)


def test_nothing_is_rendered_of_nothing():
    assert render([]) == ""
