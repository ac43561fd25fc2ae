import pytest

from cutis.errors import CutisError
from cutis.textures.limits import LARGEST, check_claim, check_size, check_tile


@pytest.mark.parametrize("size", [(1, 1), (LARGEST, 1), (1, LARGEST), (LARGEST, LARGEST)])
def test_sizes_within_the_limit(size):
    check_size("a.png", *size)


@pytest.mark.parametrize("size", [(0, 4), (4, 0), (-3, 4), (1, 65535), (65535, 1), (2**31, 2**31)])
def test_other_sizes(size):
    with pytest.raises(CutisError, match=r"a\.png: .* × .*export it again"):
        check_size("a.png", *size)


def test_claims_are_weighed_by_the_length_of_the_file(tmp_path):
    path = tmp_path / "a.tif"
    path.write_bytes(bytes(100_000))
    check_claim(path, 8000, 8000, 3 * 8000**2)  # 1920 times
    with pytest.raises(CutisError, match="claims 9000 × 9000 texels, but is only 100000 bytes"):
        check_claim(path, 9000, 9000, 3 * 9000**2)
    path.write_bytes(b"x")
    check_claim(path, 4000, 4000, 3 * 4000**2)  # little, whatever the file


@pytest.mark.parametrize(("width", "height"), [(65535, 34464), (0, 16), (16, -16)])
def test_tiles(width, height):
    check_tile("a.tx", 8192, 8192, 3 * 8192**2)
    with pytest.raises(CutisError, match=f"a.tx: claims tiles of {width} × {height} texels"):
        check_tile("a.tx", width, height, 3 * width * height)
