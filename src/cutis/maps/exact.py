"""Maps in the exact albedo space of their tissue, for spectra and other lights."""

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.maps.plain import Map, Maps
from cutis.optics import Tissue, with_rare_chromophores


def exact(tissue: Tissue, maps: Maps) -> tuple[AlbedoSpace, Map]:
    """The exact albedo space, and the skins (n, 5 or 8) of the texels of the mask."""
    skins = maps.parameters(maps.names)[maps.mask > 0]
    return albedo_space(with_rare_chromophores(tissue) if maps.rare else tissue), skins
