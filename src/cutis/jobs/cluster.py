"""Work on a Dask cluster, whose workers see the same files."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cutis.errors import CutisError

PATIENCE = 10
"""Seconds that a scheduler has to answer."""
RETRIES = 10
"""How often an item may be taken away from a worker that died."""


def on_cluster(
    address: str, function: Callable[..., Any], items: Sequence[Any], *arguments: Any
) -> Iterator[tuple[Any, Any]]:
    """(item, function(item, *arguments)) as workers at the scheduler `address` finish them.

    An item whose worker died goes to another one. Where the function failed, its exception takes
    the place of the result. Raises CutisError when the scheduler does not answer within PATIENCE or
    has no workers.
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
            client.submit(function, item, *arguments, retries=RETRIES, pure=False): number
            for number, item in enumerate(items)
        }
        try:
            for future in as_completed(futures):
                good = future.status == "finished"
                yield items[futures[future]], future.result() if good else future.exception()
        finally:
            client.cancel(list(futures))
