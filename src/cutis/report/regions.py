"""Statistics by region: where a picture says which texels belong together."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import delta_e, ita
from cutis.errors import CutisError
from cutis.maps.skin_maps import SkinMaps
from cutis.maps.statistics import Histogram, MapStatistics
from cutis.report.numbers import Percentiles, RegionNumbers
from cutis.textures import TextureFile

MOST = 32
"""Regions that a picture may have."""


class Regions:
    """Statistics of the texels of each colour of a picture; black is no region.

    The picture is an RGB image of 8 or 16 bit of the size of the capture, painted in flat colours.
    Raises CutisError for other pictures and for more than MOST colours (soft edges make many).
    """

    def __init__(self, path: str | os.PathLike[str], shape: tuple[int, int]) -> None:
        self._path = Path(path)
        self._found: dict[int, tuple[MapStatistics, Histogram, Histogram]] = {}
        with TextureFile(self._path, "linear") as file:
            if file.shape != shape:
                raise CutisError(
                    f"{self._path}: the regions have {file.shape[1]} × {file.shape[0]} texels, the "
                    f"texture {shape[1]} × {shape[0]}; resize them without smoothing"
                )

    def add(self, skin: SkinMaps, rows: slice) -> None:
        """Some rows of an estimate, with their capture."""
        assert skin.source is not None
        with TextureFile(self._path, "linear") as file:
            labels = _labels(file.rows(rows).linear())
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


def _labels(rgb: NDArray[np.float32]) -> NDArray[np.int32]:
    """0xRRGGBB of each texel; 0 for nearly black, which JPEG-like noise may make of black."""
    bytes_ = np.rint(np.clip(rgb, 0, 1) * 255).astype(np.int32)
    labels = (bytes_[..., 0] << 16) | (bytes_[..., 1] << 8) | bytes_[..., 2]
    return np.where(bytes_.max(axis=-1) < 4, 0, labels).astype(np.int32)
