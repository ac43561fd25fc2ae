"""Strokes of a brush against rasters that other libraries draw, in bands and on tiles."""

import itertools
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageDraw
from scipy.ndimage import distance_transform_edt

from cutis.errors import CutisError
from cutis.looks import Layer, Look, Multiply, Stroke, StrokesPart
from cutis.looks.folder import Folder
from cutis.looks.strokes import MOST
from cutis.maps import Face, Maps, Tile, estimate
from cutis.maps.face import Held
from cutis.maps.plain import Place
from cutis.optics import NAMES

ZIGZAG = ((0.2, 0.2), (0.7, 0.35), (0.3, 0.7), (0.31, 0.72), (0.9, 0.95))
SHAPE = (96, 160)
FINE = 8


@pytest.fixture(scope="module")
def skin():
    return estimate(np.full((*SHAPE, 3), (0.5, 0.33, 0.25), dtype=np.float32))


def drawn(strokes, shape=SHAPE, rows=slice(None), number=1001):
    """The mask of strokes on rows of a texture."""

    class AnyFace:
        pass

    face = AnyFace()
    face.shape, face.number = shape, number
    start, stop, _ = rows.indices(shape[0])
    zero = np.zeros((stop - start, shape[1]), np.float32)
    maps = Maps(dict.fromkeys(NAMES, zero), zero + 1, Place(start, shape))
    return StrokesPart(strokes=tuple(strokes)).on_face(face, Folder())(Tile(maps))


def pillow(points, radius, shape=SHAPE):
    """What Pillow draws of a hard stroke, as means over FINE x FINE texels."""
    height, width = shape
    picture = Image.new("L", (width * FINE, height * FINE))
    pen = ImageDraw.Draw(picture)
    at = [(x * width * FINE, y * height * FINE) for x, y in points]
    r = radius * max(shape) * FINE
    for x, y in at:
        pen.ellipse((x - r, y - r, x + r, y + r), fill=255)
    for (ax, ay), (bx, by) in itertools.pairwise(at):
        length = math.hypot(bx - ax, by - ay)
        nx, ny = -(by - ay) / length * r, (bx - ax) / length * r
        corners = (ax + nx, ay + ny, bx + nx, by + ny, bx - nx, by - ny, ax - nx, ay - ny)
        pen.polygon(corners, fill=255)
    fine = np.asarray(picture, dtype=np.float64) / 255
    return fine.reshape(height, FINE, width, FINE).mean((1, 3))


@pytest.mark.parametrize("radius", [0.004, 0.02, 0.07])
@pytest.mark.parametrize("points", [ZIGZAG, ZIGZAG[:1], ((-0.1, 0.5), (1.2, 0.4))])
def test_hard_strokes_are_those_of_pillow(points, radius):
    found = drawn([Stroke(points=points, radius=radius, hardness=1)])
    expected = pillow(points, radius)
    assert np.abs(found - expected).max() < 0.3  # in corners, of single texels
    assert np.sqrt(np.mean((found - expected)[expected > 0] ** 2)) < 0.05
    np.testing.assert_allclose(found.sum(), expected.sum(), rtol=0.05)


@pytest.mark.parametrize("radius", [0.0008, 0.0016])
def test_lines_thinner_than_a_texel_are_faint(radius):
    found = drawn([Stroke(points=((0.1, 0.13), (0.9, 0.8)), radius=radius, hardness=1)])
    length = math.hypot(0.8 * SHAPE[1], 0.67 * SHAPE[0])
    np.testing.assert_allclose(found.sum(), length * 2 * radius * SHAPE[1], rtol=0.2)


@pytest.mark.parametrize("hardness", [0.0, 0.3, 0.8])
def test_soft_edges_follow_the_distance_to_the_line(hardness):
    radius = 0.15 * SHAPE[1]
    found = drawn([Stroke(points=ZIGZAG, radius=0.15, hardness=hardness)])
    height, width = SHAPE
    picture = Image.new("L", (width * FINE, height * FINE), 255)
    at = [(x * width * FINE - 0.5, y * height * FINE - 0.5) for x, y in ZIGZAG]
    ImageDraw.Draw(picture).line(at, fill=0)
    distance = distance_transform_edt(np.asarray(picture)) / FINE
    centres = distance.reshape(height, FINE, width, FINE)[:, FINE // 2 - 1 : FINE // 2 + 1]
    distance = centres[..., FINE // 2 - 1 : FINE // 2 + 1].mean((1, 3))
    t = np.clip((distance - hardness * radius) / (radius * (1 - hardness)), 0, 1)
    assert np.abs(found - (1 - t**2 * (3 - 2 * t))).max() < 0.05
    assert found[distance < hardness * radius - 0.2].min(initial=1) > 0.999
    assert found[distance > radius + 0.2].max() == 0


def test_strokes_lie_on_each_other_and_erasers_take_away():
    one = Stroke(points=ZIGZAG, radius=0.05, opacity=0.6)
    two = Stroke(points=((0.1, 0.9), (0.9, 0.1)), radius=0.1, hardness=0.2)
    rubber = Stroke(points=((0.5, 0), (0.5, 1)), radius=0.08, opacity=0.7, erase=True)
    a, b = drawn([one]), drawn([two])
    e = drawn([rubber.model_copy(update={"erase": False})])
    expected = (1 - (1 - a.astype(float)) * (1 - b)) * (1 - e)
    np.testing.assert_allclose(drawn([one, two, rubber]), expected, atol=1e-6)
    assert drawn([one]).max() == np.float32(0.6)  # also where it crosses itself
    assert not drawn([rubber]).any()
    assert not drawn([]).any()


@given(
    first=st.integers(0, SHAPE[0] - 1),
    count=st.integers(1, 40),
    points=st.lists(st.tuples(st.floats(-1, 2), st.floats(-1, 2)), min_size=1, max_size=6),
    radius=st.floats(1e-4, 0.5),
    hardness=st.floats(0, 1),
)
def test_rows_are_those_of_the_whole(first, count, points, radius, hardness):
    strokes = [Stroke(points=tuple(points), radius=radius, hardness=hardness),
               Stroke(points=ZIGZAG, radius=0.03, erase=True)]  # fmt: skip
    whole = drawn(strokes)
    rows = slice(first, first + count)
    np.testing.assert_array_equal(drawn(strokes, rows=rows), whole[rows])
    assert whole.min() >= 0
    assert whole.max() <= 1


@pytest.mark.parametrize("hardness", [0, 0.5, 1])
def test_every_resolution_shows_the_same(hardness):
    stroke = Stroke(points=ZIGZAG, radius=0.05, hardness=hardness)
    large = drawn([stroke], (SHAPE[0] * 4, SHAPE[1] * 4))
    small = large.reshape(SHAPE[0], 4, SHAPE[1], 4).mean((1, 3))
    found = drawn([stroke])
    assert np.abs(found - small).max() < (0.3 if hardness == 1 else 0.1)
    np.testing.assert_allclose(found.sum(), small.sum(), rtol=0.01)


def test_a_stroke_is_on_its_tile():
    here = Stroke(points=ZIGZAG, radius=0.05)
    there = Stroke(points=ZIGZAG[::-2], radius=0.1, tile=1012)
    np.testing.assert_array_equal(drawn([here, there]), drawn([here]))
    other = drawn([here, there], number=1012)
    np.testing.assert_array_equal(other, drawn([there.model_copy(update={"tile": 1001})]))


def test_a_look_paints_with_them(skin, tmp_path):
    part = StrokesPart(strokes=(Stroke(points=ZIGZAG, radius=0.1, hardness=1),))
    look = Look(layers=(Layer(edits=(Multiply(map="melanin", by=2),), mask=(part,)),))
    look.save(tmp_path / "a.look.json")
    loaded = Look.load(tmp_path / "a.look.json")
    assert loaded.layers == look.layers
    found = skin.apply(loaded)
    weight = drawn(part.strokes)
    np.testing.assert_allclose(found.melanin, skin.melanin * (1 + weight), rtol=1e-5)
    face = Face(Held(skin))
    pieces = [
        skin.rows(slice(top, top + 17)).changed_by(look.for_face(face)).melanin
        for top in range(0, SHAPE[0], 17)
    ]
    np.testing.assert_array_equal(np.concatenate(pieces), found.melanin)


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("points", [[0.1, float("nan")]], "stroke 2, point 1, number 2: "),
        ("points", [[0.1, float("inf")]], "stroke 2, point 1, number 2: "),
        ("points", [[0.1]], "stroke 2, point 1: is missing"),
        ("points", [], "stroke 2, points: "),
        ("points", [[0.1, 7]], "point 1, number 2: must be less than or equal to 2, not 7"),
        ("points", [[0.5, 0.5]] * 1_000_000, "stroke 2, points: .*100000"),
        ("points", [[0.5, 0.5]] * MOST, "its strokes have 100,001 points together"),
        ("radius", 0, "stroke 2, radius: must be greater than 0"),
        ("opacity", 1.5, "stroke 2, opacity: must be less than or equal to 1"),
        ("tile", 3, "stroke 2, tile: "),
        ("pressure", 1, "stroke 2, pressure: unknown field"),
    ],
)
def test_bad_strokes_are_one_line(tmp_path, field, value, said):
    good = {"points": [[0.5, 0.5]], "radius": 0.1}
    part = {"part": "strokes", "strokes": [good, {**good, field: value}]}
    layers = [{"edits": []}, {"name": "rouge", "edits": [], "mask": [part]}]
    path = tmp_path / "a.look.json"
    path.write_text(json.dumps({"cutis_look": 1, "layers": layers}))
    with pytest.raises(CutisError, match=rf"layer 2 \(rouge\), mask part 1.*{said}") as caught:
        Look.load(path)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400
