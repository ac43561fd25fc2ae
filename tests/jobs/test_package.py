"""A folder for a game: the packed texture decodes to what the maps give."""

import json

import numpy as np
import pytest

from cutis.albedo.colour_table import HALF
from cutis.colour import delta_e
from cutis.maps import load_maps
from cutis.textures import read_channels


def test_the_packed_texture_holds_the_maps(maps, cutis, tmp_path):
    folder = tmp_path / "game"
    ended = cutis("export", folder, "--for", "game", "--maps", maps)
    assert (ended.code, ended.err) == (0, "")
    assert {path.name for path in folder.iterdir()} == {
        "face.packed.exr", "face.json", "cutis.glsl", "cutis.table.f16", "README.md",
    }  # fmt: skip
    channels, _ = read_channels(folder / "face.packed.exr")
    told = json.loads((folder / "face.json").read_text("utf-8"))
    skin = load_maps(maps)
    thickness = HALF * channels["B"] / (1 - channels["B"])
    found = np.stack([channels["R"] ** 4, channels["G"] ** 4, thickness, channels["A"]], axis=-1)
    known = skin.parameters()
    for i in range(4):
        np.testing.assert_allclose(found[..., i], known[..., i], rtol=0.01)
    assert told["oxygenation"] == pytest.approx(float(np.median(known[..., 4])), abs=1e-3)
    assert told["gains"] == list(skin.calibration.gains)
    same = np.concatenate([found, known[..., 4:]], axis=-1).astype(np.float32)
    model = skin.made_by.load()
    apart = delta_e(model.decode(same), model.decode(known))
    assert apart.max() < 0.5
    glsl = (folder / "cutis.glsl").read_text("ascii")
    assert "vec3 cutis_packed(vec4 texel, float oxygenation)" in glsl


@pytest.mark.parametrize(
    ("flags", "what"),
    [
        (("--for", "unrael", "--maps", "MAPS"), "--for unrael is not known"),
        (("--for", "game"), "--for needs --maps"),
        (("--for", "game", "--maps", "MAPS", "--melanin", "x2"), "cutis edit"),
        (("--for", "game", "--maps", "gone.skin.exr"), "gone.skin.exr"),
    ],
)
def test_bad_flags_are_one_line(maps, flags, what, cutis, one_line, tmp_path):
    flags = [str(maps) if flag == "MAPS" else flag for flag in flags]
    assert what in one_line(cutis("export", tmp_path / "game", *flags))
    assert list(tmp_path.glob("*game*")) == []


def test_a_folder_that_is_there_is_left_alone(maps, cutis, one_line, tmp_path):
    (tmp_path / "game").mkdir()
    ended = cutis("export", tmp_path / "game", "--for", "game", "--maps", maps)
    assert "is there already" in one_line(ended)
    assert list((tmp_path / "game").iterdir()) == []
