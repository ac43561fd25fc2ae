"""`cutis info`: what is in a file of skin maps."""

from pathlib import Path
from typing import Annotated

import typer


def info(maps: Annotated[Path, typer.Argument(help="Maps, NAME.skin.exr.")]) -> None:
    """Say what is in a file of skin maps: model, calibration, edits, ranges, what is known.

    Where the file holds standard deviations, it says which maps the colour of this face informs.

    Example: cutis info out/face.skin.exr
    """
    import numpy as np

    from cutis.apps.console import out, print_statistics
    from cutis.maps import MapsFile
    from cutis.maps.statistics import MapStatistics
    from cutis.maps.trust import TrustStatistics
    from cutis.optics import parameter
    from cutis.report.gathering import known_map
    from cutis.report.trust_words import lines

    with MapsFile(maps) as file:
        found, trust, inside = MapStatistics(), TrustStatistics(), 0
        ends = {name: (np.inf, -np.inf) for name in file.rare}
        for rows in file.bands():
            skin = file.rows(rows)
            u = skin.coordinates()
            found.add(u, skin.mask > 0)
            trust.add(skin.sigmas, skin.confidence, u, skin.mask > 0)
            inside += int((skin.mask > 0).sum())
            for name, (low, high) in ends.items():
                values = skin.map(name)[skin.mask > 0]
                ends[name] = (values.min(initial=low), values.max(initial=high))
        if not inside:
            raise file.no_mask()
    height, width = file.shape
    cover = inside / (height * width)
    out.print(f"{maps.name}: {width} × {height} texels, {100 * cover:.1f} % skin")
    gains = ", ".join(f"{g:.4f}" for g in file.calibration.gains)
    out.print(f"model {file.model}; gains {gains} ({file.calibration.origin})")
    if file.calibration.conversion is not None:
        out.print(f"captured under {file.calibration.light}, converted to D65")
    for key, value in file.provenance.items():
        out.print(f"{key.replace('_', ' ')}: {value}")
    for change in file.edits:
        out.print(f"edit: {change}")
    percentiles, known = found.percentiles(), trust.finish(file.model)
    print_statistics(
        (name, parameter(name).unit, low, median, high)
        for name, (low, median, high) in percentiles.items()
    )
    for name, (low, high) in ends.items():
        unit = parameter(name).unit.replace("1", "").strip()
        span = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
        out.print(f"{name}: {span} {unit}".rstrip())
    told = {
        name: known_map(parameter(name).unit, percentiles[name], row) for name, row in known.items()
    }
    for line in lines(told, trust.low_confidence()):
        out.print(line)
