"""Cubes in spectral EXR and NPY files."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.spectra import open_cube
from cutis.spectra.cube_files import channel_wavelength
from cutis.textures import write_channels

LAM = np.array([405.0, 500.0, 550.0, 612.5, 700.0])


def values(shape=(3, 4)):
    """(H, W, 5) values, no two alike."""
    return (np.arange(np.prod(shape) * len(LAM)).reshape(*shape, len(LAM)) + 1) / 128


def channel(lam, kind="T"):
    """The name of a band in the layout of Fichet et al. 2021."""
    return f"{kind}.{lam:.6f}nm".replace(".", ",").replace(f"{kind},", f"{kind}.")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("T.550,000000nm", ("T", 550.0)),
        ("S0.550,5nm", ("S0", 550.5)),
        ("T.550nm", ("T", 550.0)),
        ("T.5,5e2nm", ("T", 550.0)),
        ("T.0,55um", ("T", 550.0)),
        ("T.550.25nm", ("T", 550.25)),
        ("S0.500THz", ("S0", 599.584916)),
        ("S1.550,000000nm", None),
        ("T.550,000000nm.600,000000nm", None),
        ("R", None),
        ("T.nm", None),
        ("T.0nm", None),
        ("T.550", None),
    ],
)
def test_names_of_channels(name, found):
    assert channel_wavelength(name) == found


@pytest.mark.parametrize("dtype", ["float", "half"])
def test_spectral_exr(tmp_path, dtype):
    path = tmp_path / "face.exr"
    channels = {channel(lam): values()[..., i] for i, lam in enumerate(LAM)}
    channels |= {channel(lam, "S0"): 9 * values()[..., i] for i, lam in enumerate(LAM)}
    channels |= {name: np.zeros((3, 4)) for name in "RGB"}
    write_channels(path, channels, dtype, {"spectralLayoutVersion": "1.0"})
    with open_cube(path) as cube:
        np.testing.assert_array_equal(cube.wavelengths, LAM)
        np.testing.assert_array_equal(cube.rows(slice(0, 3)), values().astype(np.float32))
        np.testing.assert_array_equal(cube.rows(slice(1, 2)), values()[1:2].astype(np.float32))
        assert cube.shape == (3, 4)
        assert not cube.notes


def test_radiance_is_taken_for_reflectance_with_a_note(tmp_path):
    path = tmp_path / "face.exr"
    write_channels(path, {channel(lam, "S0"): values()[..., i] for i, lam in enumerate(LAM)})
    with open_cube(path) as cube:
        np.testing.assert_array_equal(cube.rows(slice(0, 3)), values().astype(np.float32))
        assert "S0" in cube.notes[0]


def test_colours_are_no_spectra(tmp_path):
    path = tmp_path / "face.exr"
    write_channels(path, {name: np.zeros((3, 4)) for name in "RGB"})
    with pytest.raises(CutisError, match="no spectral channels"):
        open_cube(path)


@pytest.mark.parametrize("first", [False, True])
@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.float16])
def test_npy(tmp_path, first, dtype):
    path = tmp_path / "face.npy"
    np.save(path, (np.moveaxis(values(), 2, 0) if first else values()).astype(dtype))
    np.save(tmp_path / "face.wavelengths.npy", LAM)
    with open_cube(path) as cube:
        np.testing.assert_array_equal(cube.rows(slice(0, 3)), values().astype(np.float32))
        assert bool(cube.notes) == first


def test_npy_of_a_list_of_spectra(tmp_path):
    np.save(tmp_path / "a.npy", values()[0])
    np.savetxt(tmp_path / "w.csv", LAM)
    with open_cube(tmp_path / "a.npy", tmp_path / "w.csv") as cube:
        assert cube.shape == (4, 1)
        np.testing.assert_array_equal(cube.rows(slice(0, 4))[:, 0], values()[0].astype(np.float32))


def test_npy_that_is_none(tmp_path):
    np.save(tmp_path / "a.npy", values())
    with pytest.raises(CutisError, match="--wavelengths"):
        open_cube(tmp_path / "a.npy")
    np.save(tmp_path / "w.npy", LAM[:-1])
    with pytest.raises(CutisError, match="does not fit 4 wavelengths"):
        open_cube(tmp_path / "a.npy", tmp_path / "w.npy")
    np.save(tmp_path / "w.npy", LAM)
    for name, wrong in (("o", np.array([{}], dtype=object)), ("s", np.array(["a"]))):
        np.save(tmp_path / f"{name}.npy", wrong, allow_pickle=True)
        with pytest.raises(CutisError, match="no NumPy array"):
            open_cube(tmp_path / f"{name}.npy", tmp_path / "w.npy")
    (tmp_path / "b.npy").write_bytes(b"\x93NUMPY")
    with pytest.raises(CutisError, match="no NumPy array"):
        open_cube(tmp_path / "b.npy", tmp_path / "w.npy")
    with pytest.raises(CutisError, match="no such file"):
        open_cube(tmp_path / "absent.npy")
