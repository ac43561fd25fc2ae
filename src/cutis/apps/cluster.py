"""Batches of a simulation on a Dask cluster."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.apps.journal import Simulation

PATIENCE = 10
"""Seconds that a scheduler has to answer."""
RETRIES = 10
"""How often a batch may be taken away from a worker that died."""


def computed(
    simulation: "Simulation", batches: list[int], address: str, device: str
) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """(number, result) of batches as workers at the scheduler `address` finish them.

    A batch whose worker died goes to another one. Raises CutisError when the scheduler does not
    answer within PATIENCE, has no workers, or a batch fails.
    """
    try:
        from distributed import Client, as_completed
    except ModuleNotFoundError:
        raise CutisError("clusters need Dask; pip install 'cutis[cluster]'") from None
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise CutisError(
            f"no Dask scheduler answers at {address}; start one with: dask scheduler"
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise CutisError(
                f"the scheduler at {address} has no workers; start some with: dask worker {address}"
            ) from error
        futures: dict[Any, int] = {
            client.submit(simulation.compute, number, device, retries=RETRIES, pure=False): number
            for number in batches
        }
        try:
            for future in as_completed(futures):
                if future.status != "finished":
                    raise CutisError(f"batch {futures[future]} failed: {future.exception()}")
                yield futures[future], future.result()
        finally:
            client.cancel(list(futures))
