"""Bundled heads: UVs, textures, sizes, credits."""

import numpy as np
import pytest

import cutis
from cutis.colour import ita
from cutis.render.heads import credits_of, head, heads

HEADS = pytest.mark.parametrize("one", heads(), ids=lambda one: one.name)


def vertices(one):
    lines = one.mesh.read_text("utf-8").splitlines()
    return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)


def texture_coordinates(one):
    """(F·n, 2) UVs of the corners of faces that are textured."""
    uvs, corners, skipped = [], [], False
    for line in one.mesh.read_text("utf-8").splitlines():
        kind, *rest = line.split()
        if kind == "vt":
            uvs.append([float(value) for value in rest[:2]])
        elif kind == "g":
            skipped = rest[0] in one.untextured
        elif kind == "f" and not skipped:
            corners += [int(corner.split("/")[1]) - 1 for corner in rest]
    return np.array(uvs)[corners]


@HEADS
def test_uvs_lie_in_the_texture_and_on_the_head(one):
    uv = texture_coordinates(one)
    assert len(uv) > 10_000
    assert uv.min() >= 0
    assert uv.max() <= 1
    assert np.ptp(uv, axis=0).min() > 0.9  # they use the texture


@HEADS
def test_the_head_lies_where_the_mask_is_white(one):
    if one.mask is None:
        return
    shape = cutis.read(one.albedo).shape
    mask = cutis.read_mask(one.mask, shape)
    columns, rows = (texture_coordinates(one) * (shape[1], -shape[0]) + (0, shape[0])).T
    inside = mask[np.minimum(rows.astype(int), shape[0] - 1), columns.astype(int)] > 0.5
    assert inside.mean() > 0.9  # corners on the edge fall to either side


@HEADS
def test_every_albedo_reads_and_fits_the_others(one):
    sizes = {cutis.read(path).shape for path in one.albedos.values()}
    assert len(sizes) == 1
    assert one.albedo == next(iter(one.albedos.values()))


def test_albedos_come_light_to_dark():
    made = head("makehuman")
    height, width = cutis.read(made.albedo).shape
    rows = slice(int(0.55 * height), int(0.65 * height))
    columns = slice(int(0.4 * width), int(0.6 * width))
    faces = [cutis.read(path).linear()[rows, columns] for path in made.albedos.values()]
    angles = [float(np.median(ita(face))) for face in faces]
    assert angles == sorted(angles, reverse=True)
    assert angles[0] > 41  # light
    assert angles[-1] < -30  # dark


@HEADS
def test_heads_have_the_size_of_heads(one):
    """Breadth above the ears and length from brow to back, within five deviations of the mean."""
    points = vertices(one) * one.millimetres
    top = points[:, 1].max()
    skull = points[points[:, 1] > top - 95]
    breadth, length = np.ptp(skull[:, 0]), np.ptp(skull[:, 2])
    assert 154 - 5 * 5.5 < breadth < 154 + 5 * 5.5
    assert 199 - 5 * 7.2 < length < 199 + 5 * 7.2


def test_whole_folder_stays_small():
    folder = heads()[0].mesh.parent
    assert sum(path.stat().st_size for path in folder.iterdir()) < 4_000_000


@HEADS
def test_files_and_licences_are_listed_beside_them(one):
    folder = one.mesh.parent
    listed = (folder / "README.md").read_text("utf-8")
    for path in (one.mesh, one.mask, *one.albedos.values()):
        if path is not None:
            assert f"`{path.name}`" in listed
    assert one.licence in listed
    assert one.licence in one.credit


def test_credit_is_due_for_mesh_or_texture(tmp_path):
    scan, made = head("leeperrysmith"), head("makehuman")
    assert "Lee Perry-Smith" in scan.credit  # CC BY asks for the name
    assert credits_of(scan.mesh) == credits_of(scan.albedo) == (scan.credit,)
    assert credits_of(made.mesh, scan.albedo) == (scan.credit, made.credit)
    assert credits_of(tmp_path / "leeperrysmith_head.obj") == ()


def test_unknown_head_is_one_clear_line():
    with pytest.raises(cutis.CutisError, match="no head called bust; choose from leeperrysmith, "):
        head("bust")
