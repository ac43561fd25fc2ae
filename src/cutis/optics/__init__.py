"""What skin is made of: chromophores, tissue layers, parameters."""

from cutis.optics.parameters import (
    NAMES,
    PARAMETERS,
    TYPICAL,
    Parameter,
    from_coordinates,
    parameter,
    skin,
    to_coordinates,
)
from cutis.optics.tissue import ALIAGA2022, WAVELENGTHS, Tissue

__all__ = [
    "ALIAGA2022",
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
