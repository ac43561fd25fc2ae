"""Fits that look like no skin: absorbance and K/S are fitted too, but badly."""

from collections.abc import Collection

import numpy as np

from cutis.inverse import SpectralFit


class Doubts:
    """Counts fits with a large RMSE, or with most of their free parameters at an end.

    Of 400 measured skins and `measured2026` the mean RMSE is 0.004, and 9 % of parameters are at an
    end of their range; of their absorbance 0.26 and 94 %, of K/S in percent 0.02 and 79 %.
    """

    RMSE, ENDS, FEWEST = 0.07, 0.6, 3
    """A fit with more is doubtful, or with such a share of at least so many free parameters."""
    NEAR = 2e-3
    """Distance from an end, in coordinates, that is at it."""

    def __init__(self, held: Collection[str]) -> None:
        """`held` names the parameters that are not found but given."""
        self._held = held
        self.count = self.doubtful = 0
        self._rmse = self._ends = 0.0

    def add(self, found: SpectralFit) -> None:
        """Some more fits."""
        free = [(i, p) for i, p in enumerate(found.parameters) if p.name not in self._held]
        if not (len(found.rmse) and free):
            return
        places = np.stack([p.to_coordinate(found.values[:, i]) for i, p in free], axis=-1)
        at_end = ((places < self.NEAR) | (places > 1 - self.NEAR)).mean(axis=1)
        bad = found.rmse > self.RMSE
        bad |= (at_end >= self.ENDS) & (len(free) >= self.FEWEST)
        self.count += len(bad)
        self.doubtful += int(bad.sum())
        self._rmse += float(found.rmse.sum())
        self._ends += float(at_end.sum())

    def more_than(self, share: float) -> bool:
        """Whether more than a share of all fits are doubtful."""
        return self.doubtful > share * self.count

    def words(self) -> str:
        """What is doubtful."""
        rmse, ends = self._rmse / self.count, 100 * self._ends / self.count
        return (
            f"{self.doubtful} of {self.count} spectra look like no skin (mean RMSE {rmse:.2g}, "
            f"that of skin is 0.004; {ends:.0f} % of parameters at an end of their range)"
        )
