import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutis.errors import CutisError
from cutis.textures import read_channels, write_channels


def refused(path, one_line, match, *args, **kwargs):
    with pytest.raises(CutisError, match=match) as caught:
        write_channels(path, *args, **kwargs)
    one_line(caught, path)
    assert not list(path.parent.iterdir())


@pytest.mark.parametrize(("dtype", "exact"), [("float", np.float32), ("half", np.float16)])
def test_channels_come_back_by_name(tmp_path, make, random, dtype, exact):
    names = ("thickness", "melanin", "blood", "R", "A", "layer.Z")  # not in OpenEXR's order
    channels = {name: random.random((5, 7)) for name in names}
    metadata = {"cutis:model": "aliaga2022", "exposure": 0.1, "steps": 41, "note": "µm\nλ"}
    path = tmp_path / "maps.exr"
    write_channels(path, channels, dtype, metadata)
    got, header = read_channels(path)
    assert set(got) == set(names)
    for name, array in channels.items():
        assert got[name].dtype == np.float32
        assert np.array_equal(got[name], array.astype(exact).astype(np.float32))
    assert header == metadata
    _, spec = make.read(path)
    assert spec.getattribute("compression") == "zip"
    assert spec.tile_width == 0


@given(
    metadata=st.dictionaries(
        st.from_regex(r"\Ac:[a-zA-Z]{1,20}\Z"),
        st.integers(-(2**31), 2**31 - 1)
        | st.decimals(-10, 10, places=5).map(float)
        | st.text(st.characters(codec="utf-8", exclude_characters="\0"), min_size=1),
        max_size=5,
    ).filter(lambda found: len({name.lower() for name in found}) == len(found))
)
@settings(max_examples=50, deadline=None)
def test_metadata_comes_back(tmp_path_factory, metadata):
    path = tmp_path_factory.getbasetemp() / "metadata.exr"
    write_channels(path, {"x": np.zeros((1, 1))}, metadata=metadata)
    assert read_channels(path)[1] == metadata


def test_nan_is_a_value(tmp_path):
    path = tmp_path / "a.exr"
    write_channels(path, {"error": np.array([[np.nan, np.inf]])}, "half")
    assert np.isnan(read_channels(path)[0]["error"][0, 0])


def test_refusals(tmp_path, one_line):
    path, one = tmp_path / "a.exr", np.zeros((2, 2))
    refused(tmp_path / "a.png", one_line, "OpenEXR", {"a": one})
    refused(path, one_line, "one size", {"a": one, "b": np.zeros((2, 3))})
    refused(path, one_line, "one size", {"a": np.zeros((2, 2, 3))})
    refused(path, one_line, "one size", {})
    refused(path, one_line, "too large for half", {"a": one + 1e6}, "half")
    refused(path, one_line, "float or half", {"a": one}, "double")
    refused(path, one_line, "32 bits", {"a": one}, metadata={"n": 2**31})
    refused(path, one_line, "upper and lower", {"a": one}, metadata={"n": 1, "N": 2})
    refused(path, one_line, "OpenEXR uses it", {"a": one}, metadata={"compression": "none"})


def test_only_openexr_is_read(tmp_path, make, one_line):
    path = make.image(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    with pytest.raises(CutisError, match="PNG") as caught:
        read_channels(path)
    one_line(caught, path)
