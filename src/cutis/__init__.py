"""cutis: from an RGB albedo of skin to maps of what it is made of, and back.

face = cutis.read("face.png")
skin = cutis.estimate(face)
tan = skin.multiply(melanin=1.4).replace(eumelanin=0.001)
cutis.write(tan.retouch(face), "tan.png")
"""

from cutis.errors import CutisError
from cutis.maps import SkinMaps, estimate, load_skin, presets
from cutis.textures import read_mask, read_texture, write_texture

__version__ = "0.1.0"

read = read_texture
write = write_texture
load = load_skin

__all__ = [
    "CutisError",
    "SkinMaps",
    "__version__",
    "estimate",
    "load",
    "presets",
    "read",
    "read_mask",
    "write",
]
