"""Where pieces of work are done: here, in processes of this machine, on a Dask cluster.

A runner takes a function and items and yields each item with its result, or with the exception that
it ended in, in any order, every item once. Whatever an item ends in, the others go on.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cutis.errors import CutisError
from cutis.jobs.job import Cancelled, part
from cutis.maps.estimating import Progress, nobody

Work = Callable[[Any, Progress], Any]
Runner = Callable[[Work, Sequence[Any], Progress], Iterator[tuple[Any, Any]]]
PATIENCE = 10
"""Seconds that a scheduler has to answer."""
PR_SET_PDEATHSIG = 1
"""Linux: the signal that a process gets when its parent ends."""
RETRIES = 10
"""How often an item may be taken away from a worker that died."""


def here(work: Work, items: Sequence[Any], progress: Progress) -> Iterator[tuple[Any, Any]]:
    """A `Runner` that works in this process, one item after the other."""
    for number, item in enumerate(items):
        try:
            result = work(item, part(progress, number, len(items)))
        except Cancelled:
            raise
        except Exception as error:
            result = in_one_line(error)
        yield item, result


def processes(jobs: int) -> Runner:
    """A `Runner` of so many processes, each with its share of the cores.

    They end when this process does, however it ends.
    """

    def run(work: Work, items: Sequence[Any], progress: Progress) -> Iterator[tuple[Any, Any]]:
        from concurrent.futures import ProcessPoolExecutor, as_completed
        from concurrent.futures.process import BrokenProcessPool
        from multiprocessing import get_context

        count = min(jobs, max(1, len(items)))
        with ProcessPoolExecutor(count, get_context("spawn"), _begin, (count,)) as pool:
            futures = {pool.submit(quietly, item, work): item for item in items}
            try:
                for done, future in enumerate(as_completed(futures)):
                    progress(done + 1, len(items), "estimating")
                    try:
                        yield futures[future], future.result()
                    except BrokenProcessPool:
                        died = "its process died, maybe for want of memory; try fewer --jobs"
                        yield futures[future], CutisError(died)
                    except Exception as error:  # what could not be sent, there or back
                        yield futures[future], in_one_line(error)
            except BaseException:
                for process in list((pool._processes or {}).values()):
                    process.terminate()
                raise
            finally:
                pool.shutdown(cancel_futures=True)

    return run


def cluster(address: str) -> Runner:
    """A `Runner` of the workers of a Dask scheduler, who see the same files under the same names.

    An item whose worker died goes to another one. Raises CutisError when the scheduler does not
    answer within PATIENCE or has no workers; when it goes away later, what is not done is said so.
    """

    def run(work: Work, items: Sequence[Any], progress: Progress) -> Iterator[tuple[Any, Any]]:
        client = _client(address)
        left = dict(enumerate(items))
        try:
            from distributed import as_completed

            futures = {
                client.submit(quietly, item, work, retries=RETRIES, pure=False): number
                for number, item in left.items()
            }
            try:
                for future in as_completed(list(futures)):
                    number = futures[future]
                    result = _outcome(future)
                    item = left.pop(number)
                    progress(len(items) - len(left), len(items), "estimating")
                    yield item, result
            except (OSError, RuntimeError) as error:
                if not left:
                    raise
                _ = error
            finally:
                if client.status == "running":
                    client.cancel(list(futures))
        finally:
            client.close(timeout=1)
        for item in left.values():
            yield item, _gone(address)

    def _outcome(future: Any) -> Any:
        if future.status == "finished":
            try:
                return future.result(timeout=PATIENCE)
            except Exception as error:
                return in_one_line(error)
        if future.status == "error":
            return in_one_line(future.exception(timeout=PATIENCE))
        return _gone(address)

    return run


def _gone(address: str) -> CutisError:
    return CutisError(f"not done: the scheduler at {address} went away; run the same command again")


def _client(address: str) -> Any:
    try:
        import logging

        from distributed import Client
    except ModuleNotFoundError:
        raise CutisError("clusters need Dask; pip install 'cutis[cluster]'") from None
    for name in ("distributed", "tornado", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado"):
            # what they have to say is said in one line of ours
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise CutisError(
            f"no Dask scheduler answers at {address}; start one with: dask scheduler --host "
            "127.0.0.1 --dashboard-address 127.0.0.1:8787 (others: docs/batch.md)"
        ) from error
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError as error:
        client.close(timeout=1)
        raise CutisError(
            f"the scheduler at {address} has no workers; start some with: dask worker {address} "
            "--host 127.0.0.1 --dashboard-address 127.0.0.1:0 (others: docs/batch.md)"
        ) from error
    return client


def quietly(item: Any, work: Work) -> Any:
    """The result of work, or the exception that it ended in, in another process."""
    try:
        return work(item, nobody)
    except Exception as error:
        return CutisError(str(in_one_line(error)))  # a new one, which holds on to nothing


def in_one_line(error: BaseException) -> CutisError:
    """Any exception as one line for people."""
    if isinstance(error, CutisError):
        return error
    if isinstance(error, MemoryError):
        return CutisError("not enough memory; try fewer --jobs")
    if isinstance(error, OSError):
        return CutisError(f"{error.filename or 'file system'}: {error.strerror or error}")
    return CutisError(f"internal error, {type(error).__name__}: {error}")


def _begin(count: int) -> None:
    """Called in a new process before its first item."""
    _end_with_parent()
    import OpenImageIO as oiio

    from cutis.kernels import threads, use_threads

    share = max(1, threads() // count)
    use_threads(share)
    oiio.attribute("threads", share)


def _end_with_parent() -> None:
    """Sees to it that this process ends when its parent does, by whatever means."""
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is None:
        return
    if sys.platform == "linux":  # the kernel sees to it, without a thread
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent.pid:  # it has ended meanwhile
            os._exit(1)
        return
    threading.Thread(target=_wait_for, args=(parent.sentinel,), daemon=True).start()


def _wait_for(sentinel: int) -> None:
    from multiprocessing.connection import wait

    wait([sentinel])
    os._exit(1)
