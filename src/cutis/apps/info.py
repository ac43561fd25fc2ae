"""`cutis info`: what is in a file of skin maps."""

from pathlib import Path
from typing import Annotated

import typer


def info(maps: Annotated[Path, typer.Argument(help="Maps, NAME.skin.exr.")]) -> None:
    """Say what is in a file of skin maps: model, calibration, edits, ranges.

    Example: cutis info out/face.skin.exr
    """
    from cutis.apps.console import out, print_statistics
    from cutis.maps import load_maps

    skin = load_maps(maps)
    height, width = skin.shape
    cover = float((skin.mask > 0).mean())
    out.print(f"{maps.name}: {width} × {height} texels, {100 * cover:.1f} % skin")
    gains = ", ".join(f"{g:.4f}" for g in skin.calibration.gains)
    out.print(f"model {skin.model}; gains {gains} ({skin.calibration.origin})")
    if skin.calibration.conversion is not None:
        out.print(f"captured under {skin.calibration.light}, converted to D65")
    for key, value in skin.provenance.items():
        out.print(f"{key.replace('_', ' ')}: {value}")
    for change in skin.edits:
        out.print(f"edit: {change}")
    print_statistics(skin.statistics())
