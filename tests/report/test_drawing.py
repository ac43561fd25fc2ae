"""Maps as pictures: their colours, their scale bar, and what is outside the mask."""

import numpy as np
import pytest
from PIL import Image

from cutis.report.appearance import COLOUR_MAPS, ERRORS, colour_map
from cutis.report.drawing import BAR, HEAD, MARGIN, OUTSIDE, Panel, drawn, font, in_a_row
from cutis.report.scale import Scale


@pytest.mark.parametrize("name", sorted({*COLOUR_MAPS.values(), ERRORS}))
def test_colours_are_those_of_matplotlib(name):
    colormaps = pytest.importorskip("matplotlib").colormaps
    expected = colormaps[name](np.arange(256), bytes=True)[:, :3]
    assert np.array_equal(colour_map(name), expected)
    few = colour_map(name, 48)
    assert np.array_equal(few[[0, -1]], expected[[0, -1]])
    assert len(few) == 48


def rgb(picture: Image.Image) -> np.ndarray:
    return np.asarray(picture.convert("RGB")).astype(int)


def test_a_map_is_drawn_in_the_colours_of_its_scale():
    values = np.linspace(0.1, 0.5, 300 * 250, dtype=np.float32).reshape(300, 250)
    values[:20, :30] = np.nan
    scale = Scale(0.1, 0.5, 3)
    shown = rgb(drawn(Panel(values, "viridis", scale, "a map")))
    cells = shown[HEAD : HEAD + 300, MARGIN : MARGIN + 250]
    assert np.all(cells[:20, :30] == 17 * OUTSIDE)
    known = np.isfinite(values)
    expected = colour_map("viridis")[np.rint(255 * scale.place(values[known])).astype(int)]
    assert np.abs(cells[known] - expected).max() <= 6  # of 240 levels instead of 256


def test_the_scale_bar_runs_from_low_to_high_with_numbers_beside_it():
    values = np.full((300, 250), 0.3, np.float32)
    shown = rgb(drawn(Panel(values, "magma", Scale(0.0, 2.0), "a map")))
    left = 2 * MARGIN + 250
    bar = shown[HEAD : HEAD + 300, left : left + BAR]
    table = colour_map("magma").astype(int)
    assert np.array_equal(bar[0, 0], table[-1])
    assert np.array_equal(bar[-1, 0], table[0])
    assert np.ptp(bar, axis=1).max() == 0
    text = shown[:, left + BAR + 10 :].min(axis=(1, 2)) < 100
    rows = np.flatnonzero(np.diff(text[HEAD - 8 : HEAD + 308].astype(int)) == 1)
    assert len(rows) >= 5  # 0, 0.4, … 2
    title = shown[:HEAD, :200]
    assert title.min() == 0


@pytest.mark.parametrize("shape", [(1, 1), (1, 900), (900, 1), (3, 4), (816, 512)])
def test_every_shape_can_be_drawn(shape):
    panel = Panel(np.full(shape, 0.02, np.float32), "Reds", Scale(0.01, 0.03, 4), "blood, dermis")
    picture = drawn(panel)
    longer = max(shape)
    factor = max(1, 240 // longer)
    assert picture.width >= shape[1] * factor + BAR
    assert picture.height >= max(shape[0] * factor, 120) + HEAD
    row = in_a_row([panel] * 5)
    assert row.width > 5 * shape[1] * factor
    middle = colour_map("Reds", 48)[round(47 * float(panel.scale.place(0.02)))].astype(int)
    red = (rgb(row) == middle).all(axis=2)
    assert red.sum() >= 5 * shape[0] * shape[1] * factor**2


def test_panels_of_a_row_have_their_own_colours():
    high = [Panel(np.ones((250, 100), np.float32), name, Scale(0, 1), name)
            for name in COLOUR_MAPS.values()]  # fmt: skip
    shown = rgb(in_a_row(high)).reshape(-1, 3)
    for name in COLOUR_MAPS.values():
        assert (shown == colour_map(name)[-1]).all(axis=1).sum() >= 250 * 100


def test_letters_of_labels_are_in_the_font():
    missing = font(15).getmask("\uffff").getbbox()
    for letter in "azAZ09µσΔφ°±−×₀[],.()":
        assert font(15).getmask(letter).getbbox() != missing, letter
