"""`cutis info`: what is in a file of skin maps."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from cutis.inverse import Model
    from cutis.maps import MapsFile


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
        ends = {name: (np.inf, -np.inf) for name in file.header.rare}
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
    header = file.header
    cover = inside / (height * width)
    out.say(f"{maps.name}: {width} × {height} texels, {100 * cover:.1f} % skin")
    gains = ", ".join(f"{g:.4f}" for g in header.calibration.gains)
    for note in file.notes:
        out.say(note)
    out.say(f"model {header.model}; gains {gains} ({header.calibration.origin})")
    if header.calibration.conversion is not None:
        out.say(f"captured under {header.calibration.light}, converted to D65")
    for key, value in header.provenance.items():
        out.say(f"{key.replace('_', ' ')}: {value}")
    for change in header.edits:
        out.say(f"edit: {change}")
    percentiles, known = found.percentiles(), trust.finish(_loaded(file))
    print_statistics(
        (name, parameter(name).unit, low, median, high)
        for name, (low, median, high) in percentiles.items()
    )
    for name, (low, high) in ends.items():
        unit = parameter(name).unit.replace("1", "").strip()
        span = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
        out.say(f"{name}: {span} {unit}".rstrip())
    told = {
        name: known_map(parameter(name).unit, percentiles[name], row) for name, row in known.items()
    }
    for line in lines(told, trust.low_confidence()):
        out.say(line)


def _loaded(file: "MapsFile") -> "Model | None":
    """The model of maps; None where it is not here any more."""
    from cutis.errors import CutisError

    try:
        return file.made_by.load()
    except CutisError:
        return None
