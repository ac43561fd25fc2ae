"""LUT files as OpenColorIO reads them."""

from xml.etree import ElementTree

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour import decode_srgb
from cutis.errors import CutisError
from cutis.luts import lut_files, write_clf, write_cube


def applied(path, values):
    image = oiio.ImageBuf(oiio.ImageSpec(len(values), 1, 3, "float"))
    image.set_pixels(oiio.ROI(), np.ascontiguousarray(values, np.float32)[None])
    result = oiio.ImageBufAlgo.ociofiletransform(image, str(path))
    assert not result.has_error, result.geterror()
    return result.get_pixels(oiio.FLOAT)[0]


@pytest.fixture
def table():
    return np.random.default_rng(0).random((4, 4, 4, 3))


@pytest.fixture
def nodes():
    return np.indices((4, 4, 4)).reshape(3, -1).T / 3


@pytest.fixture
def some():
    return np.random.default_rng(1).random((200, 3))


def test_a_cube_has_its_nodes_where_they_belong(table, nodes, tmp_path):
    write_cube(tmp_path / "a.cube", table)
    np.testing.assert_allclose(applied(tmp_path / "a.cube", nodes), table.reshape(-1, 3), atol=1e-6)


def test_a_shaper_comes_first(table, nodes, tmp_path):
    write_cube(tmp_path / "a.cube", table, np.linspace(0, 1, 65537) ** 0.5, "melanin ×2")
    found = applied(tmp_path / "a.cube", nodes**2)
    np.testing.assert_allclose(found, table.reshape(-1, 3), atol=1e-4)
    text = (tmp_path / "a.cube").read_bytes()
    assert text.startswith(b"# melanin ?2\n")
    assert b"TITLE" not in text


def test_titles_stay_one_line(table, tmp_path):
    write_cube(tmp_path / "a.cube", table, title='a\nLUT_3D_SIZE 9 "')
    assert (tmp_path / "a.cube").read_text("ascii").splitlines()[1] == "LUT_3D_SIZE 4"
    write_clf(tmp_path / "a.clf", [lut_files.grid(table)], title='<a> & "b"')
    assert len(applied(tmp_path / "a.clf", np.zeros((1, 3)))) == 1


def test_a_clf_has_its_nodes_where_they_belong(table, nodes, tmp_path):
    write_clf(tmp_path / "a.clf", [lut_files.grid(table)])
    np.testing.assert_allclose(applied(tmp_path / "a.clf", nodes), table.reshape(-1, 3), atol=1e-6)


def test_a_clf_is_read_trilinearly(table, tmp_path):
    write_clf(tmp_path / "a.clf", [lut_files.grid(table)])
    middle = table[1:3, 1:3, 1:3].reshape(8, 3).mean(axis=0)
    np.testing.assert_allclose(applied(tmp_path / "a.clf", [[0.5] * 3])[0], middle, atol=1e-6)


def test_operators_are_what_they_say(some, tmp_path):
    steps = np.linspace(0, 1, 11)
    bent = np.stack([steps**2, steps, 1 - steps], axis=1)
    turn, shift = np.array([[0.5, 0.2, 0], [0, 1, 0.1], [0.3, 0, 0.4]]), np.array([0.1, 0, 0.2])
    wanted = {
        lut_files.srgb_curve(): decode_srgb(some),
        lut_files.logarithm(0.002): np.log(some + 0.002),
        lut_files.matrix(turn, shift): some @ turn.T + shift,
        lut_files.curves(bent): np.stack(
            [np.interp(some[:, i], steps, bent[:, i]) for i in range(3)], axis=1
        ),
    }
    for i, (operator, values) in enumerate(wanted.items()):
        write_clf(tmp_path / f"{i}.clf", [operator])
        np.testing.assert_allclose(applied(tmp_path / f"{i}.clf", some), values, atol=2e-5)


def test_inverses_undo(some, tmp_path):
    for i, (maker, how) in enumerate(((lut_files.srgb_curve, ()), (lut_files.logarithm, (0.01,)))):
        operators = [maker(*how), maker(*how, inverse=True)]
        write_clf(tmp_path / f"{i}.clf", operators)
        np.testing.assert_allclose(applied(tmp_path / f"{i}.clf", some), some, atol=1e-6)


def test_other_names_are_refused(table, tmp_path):
    with pytest.raises(CutisError, match=r"this LUT is a \.cube"):
        write_cube(tmp_path / "a.clf", table)
    with pytest.raises(CutisError, match=r"this LUT is a \.clf"):
        write_clf(tmp_path / "a.cube", [])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf, 1e39])
def test_what_is_not_finite_is_refused(odd, table, tmp_path):
    table[1, 2, 3, 0] = odd
    with pytest.raises(CutisError, match="no numbers"):
        write_cube(tmp_path / "a.cube", table)
    with pytest.raises(CutisError, match="no numbers"):
        write_cube(tmp_path / "a.cube", np.zeros((2, 2, 2, 3)), np.array([0, odd]))
    for operator, values in (
        (lut_files.grid, table),
        (lut_files.curves, np.array([[0, 0, 0], [1, odd, 1]])),
        (lambda v: lut_files.matrix(v, np.zeros(3)), np.diag([1, odd, 1])),
        (lambda v: lut_files.matrix(np.eye(3), v), np.array([0, 0, odd])),
    ):
        with pytest.raises(CutisError, match="no numbers"):
            operator(values)
    assert not list(tmp_path.iterdir())


def test_values_come_back_to_eight_digits(table, tmp_path):
    write_clf(tmp_path / "a.clf", [lut_files.grid(table)])
    tree = ElementTree.parse(tmp_path / "a.clf")
    [array] = [node for node in tree.iter() if node.tag.endswith("Array")]
    stored = np.array(array.text.split(), dtype=np.float64)
    np.testing.assert_allclose(stored, table.astype(np.float32).ravel(), rtol=1e-7)


def test_titles_are_in_the_file(table, tmp_path):
    write_clf(tmp_path / "a.clf", [lut_files.grid(table)], title='melanin ×2 <a> & "b"')
    root = ElementTree.parse(tmp_path / "a.clf").getroot()
    assert root.get("name") == 'melanin ×2 <a> & "b"'
    assert root.get("id") == "cutis"
