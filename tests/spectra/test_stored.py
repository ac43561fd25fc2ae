"""Arrays in files, read and not mapped."""

import io
import struct

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.spectra import open_cube
from cutis.spectra.stored import StoredArray, load_numbers, npy_header

LAM = np.array([450.0, 500.0, 550.0, 600.0])
VALUES = np.arange(5 * 3 * 4, dtype=np.float32).reshape(5, 3, 4) / 64


def npy(path, values, wavelengths=LAM):
    np.save(path, values)
    np.save(path.with_suffix(".wavelengths.npy"), wavelengths)
    return path


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", ["<f4", ">f8", "<f2", "<u2", ">i4", "u1"])
@pytest.mark.parametrize("first", [False, True])
def test_npy_cubes_of_every_order(tmp_path, order, dtype, first):
    values = (VALUES * 64).astype(dtype)
    stored = np.asarray(np.moveaxis(values, 2, 0) if first else values, order=order)
    with open_cube(npy(tmp_path / "a.npy", stored)) as cube:
        assert cube.shape == (5, 3)
        for rows in (slice(0, 5), slice(1, 3), slice(4, 5), slice(2, 2)):
            np.testing.assert_array_equal(cube.rows(rows), values[rows].astype(np.float32))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_rows_along_each_axis(tmp_path, axis):
    path = tmp_path / "a.bin"
    values = np.arange(4 * 100 * 7, dtype=">i4").reshape(4, 100, 7)
    path.write_bytes(b"12345" + values.tobytes())
    with StoredArray(path, values.dtype, 5, values.shape, axis) as file:
        for rows in (slice(None), slice(1, 3), slice(0, 1)):
            wanted = np.moveaxis(np.moveaxis(values, axis, 0)[rows], 0, axis)
            np.testing.assert_array_equal(file.rows(rows), wanted)


def test_a_file_that_shrinks_while_it_is_read_is_an_error(tmp_path, write_envi):
    """Mapped memory would end the process by a signal."""
    long = np.full((400, 50, 4), 0.5, np.float32)
    one = npy(tmp_path / "a.npy", long)
    wavelengths = "{450, 500, 550, 600}"
    other = write_envi(tmp_path / "b.hdr", long, wavelength=wavelengths)
    for path, data in ((one, one), (other, other.with_suffix(".img"))):
        with open_cube(path) as cube:
            cube.rows(slice(0, 10))
            with data.open("r+b") as file:
                file.truncate(2000)
            with pytest.raises(CutisError, match="became shorter while it was read") as caught:
                cube.rows(slice(300, 310))
            assert str(data) in str(caught.value)


def header(text):
    """A .npy file by its header."""
    data = text.encode()
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(data)) + data


HEADERS = {
    "negative": "{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 8, 16)}",
    "huge": "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999, 16)}",
    "huger": f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({'9' * 300},)}}",
    "empty": "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3, 4)}",
    "scalar": "{'descr': '<f4', 'fortran_order': False, 'shape': ()}",
    "signs": "{'descr': '" + "-" * 4000 + "1', 'fortran_order': False, 'shape': (3,)}",
    "signs outside": "{'descr': " + "-" * 4000 + "1, 'fortran_order': False, 'shape': (3,)}",
    "brackets": "[" * 3000,
    "unclosed": "{'descr': '<f4', 'fortran_order': False, 'shape': (3, ",
    "objects": "{'descr': '|O', 'fortran_order': False, 'shape': (3,)}",
    "structure": "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,)}",
    "texts": "{'descr': '<U4', 'fortran_order': False, 'shape': (3,)}",
    "complex": "{'descr': '<c8', 'fortran_order': False, 'shape': (3,)}",
    "truths": "{'descr': '|b1', 'fortran_order': False, 'shape': (3, 3, 4)}",
    "floats": "{'descr': '<f4', 'fortran_order': False, 'shape': (3.0, 4)}",
    "code": "__import__('os').abort()",
    "nothing": "",
    "not a dictionary": "()",
    "other keys": "{'a': 1}",
}


@pytest.mark.parametrize("name", HEADERS)
def test_headers_that_claim_anything_are_one_line(tmp_path, name):
    path = tmp_path / "a.npy"
    path.write_bytes(header(HEADERS[name]) + bytes(100))
    np.save(tmp_path / "a.wavelengths.npy", LAM)
    for action in (open_cube, load_numbers):
        with pytest.raises(CutisError) as caught:
            action(path)
        assert str(path) in str(caught.value)
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_versions_of_the_format(tmp_path, version):
    held = io.BytesIO()
    np.lib.format.write_array(held, VALUES, version)
    (tmp_path / "a.npy").write_bytes(held.getvalue())
    dtype, shape, fortran, _ = npy_header(tmp_path / "a.npy")
    assert (dtype, shape, fortran) == (np.float32, VALUES.shape, False)


@pytest.mark.parametrize(
    "content", [b"", b"\x93NUMPY", b"\x93NUMPY\x09\x00", b"PK\3\4", b"\x80\4."]
)
def test_what_is_no_npy(tmp_path, content):
    path = tmp_path / "a.npy"
    path.write_bytes(content)
    with pytest.raises(CutisError, match=r"no NumPy array of real numbers; save it again"):
        npy_header(path)


def test_a_device_is_never_read(tmp_path):
    (tmp_path / "a.npy").symlink_to("/dev/zero")
    with pytest.raises(CutisError, match="is a device"):
        open_cube(tmp_path / "a.npy")


def test_lists_are_short(tmp_path):
    np.save(tmp_path / "w.npy", np.zeros(10))
    assert load_numbers(tmp_path / "w.npy").shape == (10,)
    with pytest.raises(CutisError, match="holds 10 numbers"):
        load_numbers(tmp_path / "w.npy", 9)
