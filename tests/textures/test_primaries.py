"""Files that say their RGB is not sRGB's are refused unless the encoding is given."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.errors import CutisError
from cutis.textures import read_texture

ACES_AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)


def _exr(path, chromaticities):
    spec = oiio.ImageSpec(2, 2, 3, "half")
    spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), chromaticities)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    assert out.write_image(np.full((2, 2, 3), 0.25, np.float16))
    assert out.close()


def test_other_primaries_are_refused_in_one_line(tmp_path):
    path = tmp_path / "acescg.exr"
    _exr(path, ACES_AP1)
    with pytest.raises(CutisError) as error:
        read_texture(path)
    assert "acescg.exr" in str(error.value)
    assert "\n" not in str(error.value)
    assert read_texture(path, "linear").encoding == "linear"


def test_srgb_primaries_pass(tmp_path):
    path = tmp_path / "rec709.exr"
    _exr(path, REC709)
    assert np.allclose(read_texture(path).linear(), 0.25)
