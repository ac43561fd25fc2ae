"""What skin is made of: chromophores, tissue layers, parameters."""

from cutis.optics.absorbers import Absorber
from cutis.optics.parameters import (
    EPIDERMAL_BLOOD,
    NAMES,
    PARAMETERS,
    RARE,
    RARE_NAMES,
    TYPICAL,
    Parameter,
    axes,
    from_coordinates,
    parameter,
    skin,
    to_coordinates,
)
from cutis.optics.tissue import (
    ALIAGA2022,
    GITLINA2020,
    MEASURED2026,
    MEASURED2026B,
    TISSUES,
    WAVELENGTHS,
    Tissue,
    tissue_named,
    with_rare_chromophores,
)

__all__ = [
    "ALIAGA2022",
    "EPIDERMAL_BLOOD",
    "GITLINA2020",
    "MEASURED2026",
    "MEASURED2026B",
    "NAMES",
    "PARAMETERS",
    "RARE",
    "RARE_NAMES",
    "TISSUES",
    "TYPICAL",
    "WAVELENGTHS",
    "Absorber",
    "Parameter",
    "Tissue",
    "axes",
    "from_coordinates",
    "parameter",
    "skin",
    "tissue_named",
    "to_coordinates",
    "with_rare_chromophores",
]
