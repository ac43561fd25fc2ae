"""The paper's figures from this project's own systems, side by side with what the paper says."""

from collections.abc import Callable

from studies.figures.baselines import draw_gitlina, draw_kubelka_munk
from studies.figures.edits import draw_further, draw_grid
from studies.figures.estimated_maps import draw as draw_maps
from studies.figures.lights import draw_illuminants, draw_metamers
from studies.figures.page import write_page
from studies.figures.palettes import draw as draw_palettes
from studies.figures.quantisation import draw as draw_quantisation
from studies.figures.reconstruction import draw as draw_reconstruction
from studies.figures.reflectance_series import draw as draw_reflectance
from studies.figures.section import Section
from studies.figures.subjects import Cast, cast

FIGURES: dict[str, Callable[[Cast], Section]] = {
    "reflectance-series": draw_reflectance,
    "palettes": draw_palettes,
    "quantisation": draw_quantisation,
    "reconstruction": draw_reconstruction,
    "estimated-maps": draw_maps,
    "editing-grid": draw_grid,
    "further-edits": draw_further,
    "kubelka-munk": draw_kubelka_munk,
    "gitlina": draw_gitlina,
    "illuminants": draw_illuminants,
    "metamers": draw_metamers,
}
"""What `python -m studies.figures` draws, in the order of its page."""

__all__ = ["FIGURES", "Cast", "Section", "cast", "write_page"]
