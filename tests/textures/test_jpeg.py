import struct

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.textures import read_texture
from cutis.textures.jpeg import check_jpeg


@pytest.fixture(params=["baseline", "progressive"])
def whole(request, tmp_path, make):
    attributes = {"jpeg:progressive": int(request.param == "progressive"), "Make": "\xff" * 40}
    return make.image(tmp_path / "a.jpg", np.full((32, 48, 3), 99, np.uint8), attributes=attributes)


def check(path):
    with open(path, "rb") as file:
        check_jpeg(path, file)


def frame(content):
    return max(content.find(b"\xff\xc0\0"), content.find(b"\xff\xc2\0"))


def test_whole_ones_pass(whole):
    check(whole)
    assert read_texture(whole).shape == (32, 48)


@pytest.mark.parametrize("size", [(65535, 1), (1, 65535), (20000, 20000)])
def test_frames_that_claim_too_much(whole, size):
    content = bytearray(whole.read_bytes())
    struct.pack_into(">HH", content, frame(content) + 5, *size)
    whole.write_bytes(content)
    with pytest.raises(CutisError, match=f"claims {size[1]} × {size[0]} texels"):
        check(whole)


def test_scans_without_end(whole):
    content = whole.read_bytes()
    last = content.rfind(b"\xff\xda")
    whole.write_bytes(content[:-2] + content[last:-2] * 200 + b"\xff\xd9")
    with pytest.raises(CutisError, match="scans"):
        check(whole)


def test_what_is_cut_off_is_left_to_the_decoder(whole):
    content = whole.read_bytes()
    for length in range(4, frame(content) + 12):
        whole.write_bytes(content[:length])
        check(whole)
        with pytest.raises(CutisError):
            read_texture(whole)
