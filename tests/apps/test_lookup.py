"""`--method lookup` in estimate and edit."""

import numpy as np
import pytest

import cutis as package
from cutis.maps import load_maps, load_model


def test_estimate_by_lookup(write_face, cutis, tmp_path):
    face = write_face(tmp_path)
    ended = cutis("estimate", face, "--method", "lookup-55k", "-o", tmp_path)
    assert (ended.code, ended.err) == (0, "")
    skin = load_maps(tmp_path / "face.skin.exr")
    assert skin.model == "lookup-55k"
    colours = package.read(face).linear().reshape(-1, 3)
    nodes = load_model("lookup-55k").encode(colours)
    np.testing.assert_allclose(skin.parameters().reshape(-1, 5), nodes, rtol=1e-6)
    assert len(np.unique(skin.thickness)) <= 3


def test_edit_by_lookup_is_quantised(maps, cutis, tmp_path):
    """Whatever the maps were estimated with, the edit goes through the tensor."""
    out = tmp_path / "dark.png"
    ended = cutis("edit", maps, "--melanin", "x3", "--method", "lookup", "-o", out)
    assert (ended.code, ended.err) == (0, "")
    face = package.read(maps.parents[1] / "face.png")
    edited = load_maps(maps).multiply(melanin=3.0)
    by_tensor = edited.by_model(load_model("lookup")).retouch(face)
    np.testing.assert_array_equal(package.read(out).pixels, by_tensor.pixels)
    assert (by_tensor.pixels != edited.retouch(face).pixels).any()
    inside = edited.mask > 0
    shades = load_model("lookup").decode(edited.parameters()[inside])
    assert len(np.unique(shades, axis=0)) < 0.5 * inside.sum()


@pytest.mark.parametrize(
    "flags", [("--method", "tree"), ("--method", "lookup", "--model", "aliaga2022")]
)
def test_bad_methods_are_one_line(flags, write_face, cutis, tmp_path):
    ended = cutis("estimate", write_face(tmp_path), *flags, "-o", tmp_path)
    assert ended.code == 1
    assert "--method" in ended.err
    assert ended.err.count("\n") == 1
