"""cutis: from an RGB albedo of skin to maps of what it is made of, and back.

face = cutis.read("face.png")
skin = cutis.estimate(face)
tan = skin.multiply(melanin=1.4).replace(eumelanin=0.001)
cutis.write(tan.retouch(face), "tan.png")

Whoever names no model gets `cutis.DEFAULT`, and whoever names no tissue the tissue of that model.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from cutis.errors import CutisError
    from cutis.inverse import Calibration, Model, register
    from cutis.looks import Look, presets
    from cutis.maps import DEFAULT, Edit, SkinMaps, estimate, load_model
    from cutis.maps import load_skin as load
    from cutis.maps.by_default import albedo_space, explain, fit_spectra, metamers
    from cutis.optics import Tissue
    from cutis.report import report
    from cutis.textures import Texture, read_mask
    from cutis.textures import read_texture as read
    from cutis.textures import write_texture as write

_WHERE = {
    "DEFAULT": "cutis.maps",
    "Calibration": "cutis.inverse",
    "CutisError": "cutis.errors",
    "Edit": "cutis.maps",
    "Look": "cutis.looks",
    "Model": "cutis.inverse",
    "SkinMaps": "cutis.maps",
    "Texture": "cutis.textures",
    "Tissue": "cutis.optics",
    "albedo_space": "cutis.maps.by_default",
    "estimate": "cutis.maps",
    "explain": "cutis.maps.by_default",
    "fit_spectra": "cutis.maps.by_default",
    "load": "cutis.maps:load_skin",
    "load_model": "cutis.maps",
    "metamers": "cutis.maps.by_default",
    "presets": "cutis.looks.presets:",
    "read": "cutis.textures:read_texture",
    "read_mask": "cutis.textures",
    "register": "cutis.inverse",
    "report": "cutis.report:report",
    "write": "cutis.textures:write_texture",
}
"""Where each public name lives: a module, and after a colon the name there, if another."""

__all__ = [
    "DEFAULT",
    "Calibration",
    "CutisError",
    "Edit",
    "Look",
    "Model",
    "SkinMaps",
    "Texture",
    "Tissue",
    "__version__",
    "albedo_space",
    "estimate",
    "explain",
    "fit_spectra",
    "load",
    "load_model",
    "metamers",
    "presets",
    "read",
    "read_mask",
    "register",
    "report",
    "write",
]


def __getattr__(name: str) -> Any:
    """Public names are imported when they are first used: `import cutis` itself takes no time."""
    if name not in _WHERE:
        raise AttributeError(f"module 'cutis' has no attribute {name!r}")
    module, _, other = _WHERE[name].partition(":")
    found = import_module(module)
    if not _WHERE[name].endswith(":"):
        found = getattr(found, other or name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
