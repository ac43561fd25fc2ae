"""Data and display windows of OpenEXR, against arrays cut and padded by NumPy."""

import handmade as hand
import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.errors import CutisError
from cutis.textures import (
    ChannelFile,
    Frame,
    LabelFile,
    channel_writer,
    read_mask,
    read_texture,
    write_texture,
)
from cutis.textures.frame import placed, whole_frame

SHOWN = (10, 12)
# Corner (x, y), rows and columns of a data window about a display window of SHOWN at 0, 0.
WINDOWS = {
    "overscan": ((-3, -2), (15, 19)),
    "cropped": ((4, 3), (5, 6)),
    "shifted": ((2, -4), (10, 12)),
    "beside and below": ((-5, 6), (9, 30)),
    "whole": ((0, 0), (10, 12)),
}


def window(name, kind="float32"):
    (x, y), size = WINDOWS[name]
    return (x, y), hand.texels(kind, size)


def on_display(values, x, y, shown=SHOWN):
    """What is seen: the stored values on black."""
    seen = np.zeros((*shown, *values.shape[2:]), values.dtype)
    for row in range(shown[0]):
        for column in range(shown[1]):
            if 0 <= row - y < values.shape[0] and 0 <= column - x < values.shape[1]:
                seen[row, column] = values[row - y, column - x]
    return seen


def stored_about(values, x, y, size):
    """The inverse: values of the display cut to the stored window, black elsewhere."""
    return on_display(values, -x, -y, size)


def cropped(folder, name, origin=(0, 0), **more):
    (x, y), values = window(name)
    corner = (x + origin[0], y + origin[1])
    display = (*origin, SHOWN[1], SHOWN[0])
    return hand.exr(folder / "a.exr", *more.get("attributes", ()), pixels=values, data=corner,
                    display=display)  # fmt: skip


def windows(path):
    spec = oiio.ImageInput.open(str(path)).spec()
    return (spec.x, spec.y, spec.width, spec.height,
            spec.full_x, spec.full_y, spec.full_width, spec.full_height)  # fmt: skip


@pytest.mark.parametrize("name", WINDOWS)
@pytest.mark.parametrize("origin", [(0, 0), (100, -7)])
def test_the_frame_is_that_of_the_header(tmp_path, name, origin):
    (x, y), values = window(name)
    one = read_texture(cropped(tmp_path, name, origin))
    assert one.frame == Frame(values.shape[:2], SHOWN, y, x)
    assert np.array_equal(one.pixels, values)


@pytest.mark.parametrize("name", WINDOWS)
@pytest.mark.parametrize("kind", ["png", "tif", "tx", "dpx", "jpg"])
def test_formats_without_windows_hold_the_display_window(tmp_path, make, name, kind):
    (x, y), values = window(name)
    path = tmp_path / f"b.{kind}"
    write_texture(read_texture(cropped(tmp_path, name)), path)
    stored, spec = make.read(path)
    size = (spec.x, spec.y, spec.full_width, spec.full_height)
    assert (size, stored.shape[:2]) == ((0, 0, SHOWN[1], SHOWN[0]), SHOWN)
    seen = on_display(np.ones(values.shape[:2]), x, y) > 0
    if kind != "jpg":
        assert np.array_equal(stored.any(-1), seen)
    if kind in ("tif", "tx"):
        assert np.array_equal(stored, on_display(values, x, y))


def test_what_is_not_stored_is_transparent(tmp_path, make):
    (x, y), values = window("cropped")
    pixels = np.concatenate([values, np.ones((*values.shape[:2], 1), np.float32)], -1)
    path = hand.exr(tmp_path / "a.exr", pixels=pixels, names="RGBA", data=(x, y),
                    display=(0, 0, SHOWN[1], SHOWN[0]))  # fmt: skip
    write_texture(read_texture(path), tmp_path / "b.png")
    stored, _ = make.read(tmp_path / "b.png")
    seen = on_display(np.ones(values.shape[:2]), x, y)
    assert np.array_equal(stored[..., 3] / 65535, seen)


@pytest.mark.parametrize("name", WINDOWS)
def test_openexr_keeps_its_windows(tmp_path, name):
    path = cropped(tmp_path, name, (5, -6))
    write_texture(read_texture(path), tmp_path / "b.exr")
    assert windows(tmp_path / "b.exr") == windows(path)


@pytest.mark.parametrize("name", WINDOWS)
def test_rows_come_in_bands(tmp_path, make, name, monkeypatch):
    (x, y), values = window(name)
    monkeypatch.setattr("cutis.textures.texture._BAND", 40)
    write_texture(read_texture(cropped(tmp_path, name)), tmp_path / "b.tif")
    assert np.array_equal(make.read(tmp_path / "b.tif")[0], on_display(values, x, y))


@pytest.mark.parametrize("name", WINDOWS)
def test_named_channels_keep_windows(tmp_path, name):
    (x, y), values = window(name)
    frame = Frame(values.shape[:2], SHOWN, y, x)
    path = tmp_path / "maps.exr"
    with channel_writer(path, "RGB", frame.shape, frame=frame) as put:
        put({channel: values[..., i] for i, channel in enumerate("RGB")})
    height, width = values.shape[:2]
    assert windows(path) == (x, y, width, height, 0, 0, SHOWN[1], SHOWN[0])
    with ChannelFile(path) as file:
        assert file.frame == frame
        assert np.array_equal(file.rows(slice(None))["G"], values[..., 1])


@pytest.mark.parametrize("name", WINDOWS)
def test_masks_painted_on_the_display_window_are_placed(tmp_path, make, name, random):
    (x, y), values = window(name)
    painted = random.integers(0, 256, (*SHOWN, 1)).astype(np.uint8)
    path = make.image(tmp_path / "m.png", painted)
    frame = read_texture(cropped(tmp_path, name)).frame
    wanted = stored_about(painted[..., 0] / 255, x, y, values.shape[:2])
    np.testing.assert_allclose(read_mask(path, frame), wanted, atol=1e-6)
    labels = np.repeat(painted, 3, axis=2)
    with LabelFile(make.image(tmp_path / "l.png", labels), frame) as file:
        found = file.rows(slice(None))
    assert np.array_equal(found & 255, stored_about(painted[..., 0], x, y, values.shape[:2]))


@pytest.mark.parametrize("name", WINDOWS)
def test_masks_of_what_is_stored_fit_too(tmp_path, make, name):
    """Such as a picture of the stored texels, unless it is as large as the display."""
    (x, y), values = window(name)
    frame = Frame(values.shape[:2], SHOWN, y, x)
    mask = make.image(tmp_path / "m.png", hand.texels(size=frame.shape)[..., :1])
    found = read_mask(mask, frame)
    if frame.shape != SHOWN:
        assert np.array_equal(np.rint(found * 255), hand.texels(size=frame.shape)[..., 0])


def test_masks_with_windows_of_their_own(tmp_path):
    """Cropped as programs crop: what is not stored is black."""
    values = np.ones((3, 4, 1), np.float32)
    path = hand.exr(tmp_path / "m.exr", pixels=values, names="Y", data=(5, 2),
                    display=(0, 0, SHOWN[1], SHOWN[0]))  # fmt: skip
    wanted = np.zeros(SHOWN)
    wanted[2:5, 5:9] = 1
    assert np.array_equal(read_mask(path, whole_frame(SHOWN)), wanted)
    (x, y), stored = window("overscan")
    frame = Frame(stored.shape[:2], SHOWN, y, x)
    assert np.array_equal(read_mask(path, frame), stored_about(wanted, x, y, frame.shape))


def test_refusals_name_both_sizes(tmp_path, make, one_line):
    frame = read_texture(cropped(tmp_path, "cropped")).frame
    path = make.image(tmp_path / "m.png", np.full((9, 9, 1), 255, np.uint8))
    with pytest.raises(CutisError, match="the texture 12 × 10") as caught:
        read_mask(path, frame)
    assert "of which 6 × 5 are stored" in one_line(caught, path)


def test_a_texture_outside_its_picture(tmp_path, one_line):
    path = hand.exr(tmp_path / "a.exr", data=(50, 50), display=(0, 0, 8, 6))
    out = tmp_path / "b.png"
    with pytest.raises(CutisError, match="outside its display window") as caught:
        write_texture(read_texture(path), out)
    one_line(caught, out)
    write_texture(read_texture(path), tmp_path / "b.exr")
    assert not out.exists()


def test_an_absurd_display_window(tmp_path, one_line):
    path = hand.exr(tmp_path / "a.exr", data=(50, 50), display=(0, 0, 100_000, 90))
    one = read_texture(path)
    with pytest.raises(CutisError, match="limit is 32768") as caught:
        write_texture(one, tmp_path / "b.png")
    one_line(caught, tmp_path / "b.png")


def test_placed_against_numpy(random):
    values = random.random((7, 5))
    for top, left in ((0, 0), (-3, 2), (4, -4), (30, 30), (-9, -9)):
        theirs = Frame((7, 5), SHOWN, top, left)
        ours = Frame((6, 4), SHOWN, 1, 2)
        found = placed(lambda rows: values[rows], theirs, ours, slice(1, 6))
        seen = on_display(values, left, top)
        assert np.array_equal(found, seen[2:7, 2:6])


@pytest.mark.parametrize("name", WINDOWS)
def test_what_is_shown_of_it(tmp_path, name):
    """All rows of the picture, as renderers see it."""
    from cutis.textures import TextureFile

    (x, y), values = window(name)
    path = cropped(tmp_path, name, (5, -6))
    seen = on_display(values, x, y)
    with TextureFile(path, shown=True) as file:
        assert file.frame == whole_frame(SHOWN)
        for rows in (slice(None), slice(2, 4), slice(9, 10), slice(3, 3)):
            assert np.array_equal(file.rows(rows).pixels, seen[rows])
    with ChannelFile(path, shown=True) as channels:
        assert channels.shape == SHOWN
        assert np.array_equal(channels.rows(slice(1, 8))["G"], seen[1:8, :, 1])
