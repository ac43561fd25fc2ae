"""What skin is made of: chromophores, tissue layers, parameters."""

from cutis.optics.parameters import (
    EPIDERMAL_BLOOD,
    NAMES,
    PARAMETERS,
    TYPICAL,
    Parameter,
    from_coordinates,
    parameter,
    skin,
    to_coordinates,
)
from cutis.optics.tissue import ALIAGA2022, GITLINA2020, MEASURED2026, WAVELENGTHS, Tissue

__all__ = [
    "ALIAGA2022",
    "EPIDERMAL_BLOOD",
    "GITLINA2020",
    "MEASURED2026",
    "NAMES",
    "PARAMETERS",
    "TYPICAL",
    "WAVELENGTHS",
    "Parameter",
    "Tissue",
    "from_coordinates",
    "parameter",
    "skin",
    "to_coordinates",
]
