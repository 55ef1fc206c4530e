"""The workers of a Dask cluster."""

import contextlib
import logging
import os
import socket
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent import futures
from typing import Any

from topomap.runtime.errors import InputError
from topomap.runtime.extras import need
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import solving
from topomap.solver.share import AHEAD, LOST, Result, Unit, Work

PATIENCE = 10  # seconds within which a cluster must answer


class Cluster:
    """A running Dask cluster, which does the units of lost workers again."""

    def __init__(self, address: str):
        if not address.strip():  # with an empty one Dask would make a cluster of its own
            raise InputError("--dask: an empty address")
        need("dask", "--dask")
        import distributed

        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        self._address, self._dask = address, distributed
        try:
            self._client = _client(distributed.Client, address)
        except (OSError, ValueError, TypeError) as error:
            fault = str(error).partition("\n")[0] or f"no answer within {PATIENCE} seconds"
            raise InputError(f"--dask {address}: {fault}") from None

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order."""
        given: deque[Any] = deque()
        try:
            for number in range(len(units)):
                ahead = AHEAD * max(1, sum(self._client.nthreads().values()))
                for unit in units[number + len(given) : number + ahead]:
                    call = _at_worker, solving.digest(), work, unit
                    given.append(self._client.submit(*call, pure=False))
                result = self._result(given[0], watch)
                given.popleft()
                yield result
        except self._dask.comm.core.CommClosedError:
            raise Stopped(LOST) from None
        finally:
            with contextlib.suppress(Exception):  # the cluster may be gone
                self._client.cancel(given)

    def _result(self, future: Any, watch: Watch) -> Any:
        from asyncio import run_coroutine_threadsafe  # loading it takes as long as all else here

        # It is asked for once, because Dask's own timeout would also end what is on its way.
        asked = self._client.gather(future, asynchronous=True)
        coming = run_coroutine_threadsafe(asked, self._client.loop.asyncio_loop)
        try:
            watch.tick()
            while not futures.wait([coming], timeout=0.1).done:
                watch.tick()
            return coming.result()
        except (self._dask.KilledWorker, self._dask.CancelledError):
            raise Stopped(LOST) from None
        except ImportError as error:
            raise InputError(f"--dask {self._address}: a worker: {error}") from None
        finally:
            coming.cancel()

    def __enter__(self) -> "Cluster":
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(Exception):
            self._client.close(timeout=1)


def _client(kind: Any, address: str) -> Any:
    """Make a client of that cluster.

    A client that finds no cluster is closed here. If that were left to Python's garbage collector,
    it might be closed while another one starts, which then waits for a lock of its own.
    """
    client = kind.__new__(kind)
    try:
        client.__init__(address, timeout=PATIENCE, set_as_default=False)
    except BaseException:
        with contextlib.suppress(Exception):
            client.close(timeout=1)
        raise
    return client


class _Wanted(Watch):
    """In a worker of a cluster, a watch that ends work whose result nobody waits for any more."""

    def __init__(self) -> None:
        from distributed import get_worker

        super().__init__()
        self._tasks = get_worker().state.tasks
        self._key = get_worker().get_current_task()

    def tick(self) -> None:
        """End the work if nobody waits for it."""
        task = self._tasks.get(self._key)
        if task is None or task.state == "cancelled":
            raise Stopped(INTERRUPT)


def _at_worker(digest: str, work: Work[Unit, Result], unit: Unit) -> Result:
    """Do a unit, if the worker has the same program as the caller."""
    if digest != solving.digest():
        where = f"{socket.gethostname()}, process {os.getpid()}"
        raise InputError(f"--dask: a worker ({where}) has another topomap")
    return work(unit, _Wanted())
