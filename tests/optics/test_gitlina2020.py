"""The tissue of Gitlina et al. 2020: printed constants, its parameters, what it holds fixed."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, EPIDERMAL_BLOOD, GITLINA2020, PARAMETERS


def test_constants_of_donner_and_jensen():
    """In mm⁻¹ as printed [donner2006]: scattering, half of it in the dermis, melanins, baseline."""
    at = np.array([450.0, 550.0, 650.0])
    reduced = 14.74 * at**-0.22 + 2.2e11 * at**-4.0
    np.testing.assert_allclose(GITLINA2020.reduced_scattering(at) / 10, reduced, rtol=1e-12)
    assert GITLINA2020.dermis_scattering == 0.5
    np.testing.assert_allclose(GITLINA2020.eumelanin(at) / 10, 6.6e10 * at**-3.33, rtol=1e-12)
    np.testing.assert_allclose(GITLINA2020.pheomelanin(at) / 10, 2.9e14 * at**-4.75, rtol=1e-12)
    baseline = 0.0244 + 8.53 * np.exp(-(at - 154) / 66.2)
    np.testing.assert_allclose(GITLINA2020.baseline(at) / 10, baseline, rtol=1e-12)
    assert GITLINA2020.baseline(550.0) == pytest.approx(0.4593, abs=1e-4)  # cm⁻¹


def test_what_is_free_and_what_is_held():
    assert ALIAGA2022.parameters == PARAMETERS
    names = [p.name for p in GITLINA2020.parameters]
    assert names == ["melanin", "blood", "eumelanin", "epidermal_blood"]
    assert GITLINA2020.parameters[-1] is EPIDERMAL_BLOOD
    assert dict(GITLINA2020.fixed) == {"thickness": 250.0, "oxygenation": 0.75}


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"fixed": (("thickness", 900.0),)}, "range"),
        ({"fixed": (("width", 1.0),)}, "unknown parameter"),
        ({"dermis_scattering": 0.0}, "dermis_scattering"),
    ],
)
def test_tissues_that_cannot_be(change, what):
    with pytest.raises(CutisError, match=what):
        replace(ALIAGA2022, **change)
