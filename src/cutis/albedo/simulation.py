"""Skins simulated by Monte Carlo walks: reflectance with its standard error.

A simulation is made of independent batches. Which random numbers a photon draws depends on the
number of its skin, on the band and on the seed, not on the batch, so a simulation may be cut up,
stopped, continued and spread over machines without changing a bit of its result.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.optics import PARAMETERS, WAVELENGTHS, Tissue, from_coordinates
from cutis.optics.absorbers import LAYERS
from cutis.transport import walk_absorptions, walk_stacks
from cutis.transport.monte_carlo import PHOTONS, check_photons

Array = NDArray[np.float64]
BANDS = len(WAVELENGTHS)
BATCH_PHOTONS = 20_000_000
"""About how many photons one batch walks: seconds to a minute."""


@dataclass(frozen=True)
class Walks:
    """How skins are walked through; `tissue` says in which dimension and with which boundary."""

    tissue: Tissue
    photons: int = PHOTONS
    seed: int = 0
    incidence: float | str = "lambertian"

    def __post_init__(self) -> None:
        check_photons(self.photons, self.seed)
        self.tissue.check()
        if self.tissue.parameters[: len(PARAMETERS)] != PARAMETERS:
            raise CutisError(
                f"only tissues with the five free parameters are simulated, not {self.tissue.name}"
            )


@dataclass(frozen=True, eq=False)
class SkinSimulation:
    """(n, 5) skins, or (n, p) in the parameters of the tissue, at the 41 bands, a few a batch."""

    skins: Array
    walks: Walks

    def __post_init__(self) -> None:
        every = self.walks.tissue.parameters
        if self.skins.ndim != 2 or self.skins.shape[1] != len(every) or not len(self.skins):
            raise CutisError(f"skins must be (n, {len(every)}), not {self.skins.shape}")
        for known, values in zip(every, self.skins.T, strict=True):
            known.check(float(values.min()))
            known.check(float(values.max()))

    @property
    def size(self) -> int:
        """Skins of a batch."""
        return max(BATCH_PHOTONS // (self.walks.photons * BANDS), 1)

    @property
    def batches(self) -> int:
        """How many batches there are."""
        return -(-len(self.skins) // self.size)

    def compute(
        self,
        batch: int,
        device: str = "cpu",
        progress: Callable[[int, int], None] | None = None,
    ) -> Array:
        """(2, skins of the batch, 41) reflectance and its standard error."""
        first = batch * self.size
        skins = self.skins[first : first + self.size]
        tissue, lam = self.walks.tissue, WAVELENGTHS
        values = {p.name: skins[:, i] for i, p in enumerate(tissue.parameters)}
        absorption = np.stack(
            [tissue.absorption(layer, values, lam) for layer in LAYERS], axis=-1
        ).reshape(-1, 2)
        above = np.tile(tissue.scattering(lam), len(skins))
        below = np.broadcast_to(
            tissue.scattering_below(lam, values["eumelanin"]), (len(skins), BANDS)
        )
        depth = np.repeat(values["thickness"] * 1e-4, BANDS)
        found = walk_stacks(
            absorption,
            np.stack([above, below.ravel()], axis=-1),
            np.tile(tissue.anisotropy(lam), len(skins))[:, None],
            np.stack([depth, np.full(len(depth), np.inf)], axis=-1),
            photons=self.walks.photons,
            seed=self.walks.seed,
            streams=first * BANDS + np.arange(len(depth)),
            dimension=tissue.dimension,
            refractive_index=tissue.outer_index,
            incidence=self.walks.incidence,
            device=device,
            progress=progress,
        )
        shape = (len(skins), BANDS)
        return np.stack([found.reflected.reshape(shape), found.reflected_error.reshape(shape)])

    def assemble(self, parts: Sequence[Array]) -> tuple[Array, Array]:
        """Results of all batches, in order → reflectance and standard error (n, 41)."""
        whole = np.concatenate(parts, axis=1)
        return whole[0], whole[1]


@dataclass(frozen=True, eq=False)
class TensorSimulation:
    """A grid of skins over the five parameters, a batch per band.

    All absorptions of one band and thickness come from one set of paths (`walk_absorptions`), so
    their errors are alike: differences between skins are more precise than the skins.
    """

    shape: tuple[int, ...]
    walks: Walks

    def __post_init__(self) -> None:
        grid_axes(self.shape)
        tissue = self.walks.tissue
        one = tissue.dermis_scattering == 1 and not tissue.dermis_by_type
        if tissue.boundary != "matched" or not one:
            raise CutisError("a tensor is simulated with the matched boundary only")

    @property
    def skins(self) -> Array:
        """(n, 5) skins, the last parameter fastest."""
        return grid_skins(self.shape)

    @property
    def batches(self) -> int:
        """How many batches there are."""
        return BANDS

    def compute(
        self,
        batch: int,
        device: str = "cpu",
        progress: Callable[[int, int], None] | None = None,
    ) -> Array:
        """(2, thicknesses, melanin · eumelanin, blood · oxygenation) of band number `batch`."""
        tissue, walks = self.walks.tissue, self.walks
        lam = WAVELENGTHS[batch : batch + 1]
        axes = [
            p.from_coordinate(u) for p, u in zip(PARAMETERS, grid_axes(self.shape), strict=True)
        ]
        melanin, eumelanin = np.meshgrid(axes[0], axes[3], indexing="ij")
        blood, oxygenation = np.meshgrid(axes[1], axes[4], indexing="ij")
        found = [
            walk_absorptions(
                tissue.epidermis_absorption(melanin, eumelanin, lam).ravel(),
                tissue.dermis_absorption(blood, oxygenation, lam).ravel(),
                float(thickness),
                float(tissue.scattering(lam)[0]),
                float(tissue.anisotropy(lam)[0]),
                photons=walks.photons,
                seed=walks.seed,
                stream=number * BANDS + batch,
                dimension=tissue.dimension,
                incidence=walks.incidence,
            )
            for number, thickness in enumerate(axes[2])
        ]
        if progress:
            progress(1, 1)
        return np.stack(found, axis=1)

    def assemble(self, parts: Sequence[Array]) -> tuple[Array, Array]:
        """Results of all bands, in order → reflectance and standard error (n, 41)."""
        melanin, blood, thickness, eumelanin, oxygenation = self.shape
        whole = np.stack(parts, axis=-1).reshape(
            2, thickness, melanin, eumelanin, blood, oxygenation, BANDS
        )
        whole = whole.transpose(0, 2, 4, 1, 3, 5, 6).reshape(2, -1, BANDS)
        return whole[0], whole[1]


def grid_axes(shape: Sequence[int]) -> list[Array]:
    """Network coordinates of the nodes of a grid along each parameter, ends included.

    An axis of one node takes the middle. Raises CutisError unless there are five sizes above zero.
    """
    sizes = tuple(shape)
    if len(sizes) != len(PARAMETERS) or any(int(n) != n or n < 1 for n in sizes):
        raise CutisError(
            f"a grid needs {len(PARAMETERS)} sizes above zero, such as 64,32,5,5,5, not "
            f"{','.join(str(n) for n in sizes) or 'none'}"
        )
    return [np.linspace(0.0, 1.0, int(n)) if n > 1 else np.array([0.5]) for n in sizes]


def grid_skins(shape: Sequence[int]) -> Array:
    """(n, 5) parameters of the nodes of a grid, the last parameter fastest; see `grid_axes`."""
    nodes = np.stack(np.meshgrid(*grid_axes(shape), indexing="ij"), axis=-1)
    return np.asarray(from_coordinates(nodes.reshape(-1, len(PARAMETERS))), dtype=np.float64)
