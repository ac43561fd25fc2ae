"""Old names work for one version, with a word."""

import pytest

import cutis.luts
import cutis.maps
import cutis.report
import cutis.spectra
import cutis.textures


@pytest.mark.parametrize(
    ("old", "name", "new"),
    [
        (cutis.maps, "Regions", cutis.report),
        (cutis.maps, "report", cutis.report),
        (cutis.maps, "export_lut", cutis.luts),
        (cutis.textures, "SpectralCube", cutis.spectra),
        (cutis.textures, "open_cube", cutis.spectra),
        (cutis.textures, "write_clf", cutis.luts),
        (cutis.textures, "write_cube", cutis.luts),
    ],
)
def test_old_names_warn(old, name, new):
    with pytest.warns(DeprecationWarning, match=f"{name} is {new.__name__}.{name} now"):
        assert getattr(old, name) is getattr(new, name)


def test_other_names_are_not_there():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = cutis.maps.nothing
