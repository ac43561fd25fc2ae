"""Statistics by region: where a picture says which texels belong together."""

import os
from pathlib import Path

import numpy as np

from cutis.colour import delta_e, ita
from cutis.errors import CutisError
from cutis.maps.skin_maps import SkinMaps
from cutis.maps.statistics import Histogram, MapStatistics
from cutis.report.numbers import Percentiles, RegionNumbers
from cutis.textures import Frame, LabelFile, Orientation
from cutis.textures.closing import Closing

MOST = 32
"""Regions that a picture may have."""
CRUMB = 0.002
"""Share of all texels in regions below which one is hardly meant."""


class Regions(Closing):
    """Statistics of the texels of each colour of a picture; black is no region.

    The picture is painted in flat colours, of the size of the capture's picture: `like` is the
    frame of the capture, or its shape (H, W). `notes` say what was chosen in it, and which colours
    are hardly anywhere. Raises CutisError for other pictures (`textures.LabelFile`) and for more
    than MOST colours (soft edges make many). Close it, or use it in a with block.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        like: tuple[int, int] | Frame,
        orientation: Orientation = "auto",
    ) -> None:
        self._path = Path(path)
        self._found: dict[int, tuple[MapStatistics, Histogram, Histogram]] = {}
        self._file = LabelFile(path, like, orientation)
        self.notes = list(self._file.notes)

    def close(self) -> None:
        """Lets go of the picture."""
        self._file.close()

    def add(self, skin: SkinMaps, rows: slice) -> None:
        """Some rows of an estimate, with their capture."""
        assert skin.source is not None
        labels = self._file.rows(rows)
        inside = (skin.mask > 0) & (labels > 0)
        truth = skin.calibration.apply(skin.source[inside])
        model = skin.calibration.apply(skin.model_albedo[inside])
        errors, angles, u = delta_e(model, truth), ita(truth), skin.coordinates()
        for label in np.unique(labels[inside]):
            if label not in self._found and len(self._found) == MOST:
                raise CutisError(
                    f"{self._path}: more than {MOST} colours, each of which is a region; "
                    "paint flat colours without soft edges"
                )
            maps, differences, typology = self._found.setdefault(
                int(label),
                (MapStatistics(), Histogram(0.0, 100.0), Histogram(-180.0, 180.0)),
            )
            here = labels[inside] == label
            maps.add(u, inside & (labels == label))
            differences.add(errors[here])
            typology.add(angles[here])

    def finish(self) -> tuple[RegionNumbers, ...]:
        """The regions, named by their colour as #rrggbb."""
        counts = {label: found[1].count for label, found in self._found.items()}
        crumbs = [n for label, n in counts.items() if n < CRUMB * sum(counts.values())]
        if crumbs:
            self.notes.append(
                f"{len(crumbs)} of {len(counts)} regions have less than {100 * CRUMB:g} % of the "
                "texels: edges that were smoothed? paint flat colours"
            )
        return tuple(
            RegionNumbers(
                name=f"#{label:06x}",
                texels=differences.count,
                ita_median=typology.percentile(0.5),
                delta_e_mean=differences.mean(),
                maps={name: Percentiles(*values) for name, values in maps.percentiles().items()},
            )
            for label, (maps, differences, typology) in sorted(self._found.items())
        )
