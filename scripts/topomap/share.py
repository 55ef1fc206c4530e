"""Work in units, shared out among processes or the workers of a Dask cluster: results come in
the order of the units, whoever has done them."""

import contextlib
import logging
import os
import signal
import socket
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Protocol, TypeVar

from topomap import solver
from topomap.errors import InputError
from topomap.solver import INTERRUPT, MEMORY, Stopped, Watch

Unit = TypeVar("Unit")
Result = TypeVar("Result")
Work = Callable[[Unit, Watch | None], Result]  # a function of a module, or partial of one
AHEAD = 8  # units for each worker that may be done before the one that is next
TRIES = 3  # workers that a unit may cost
PATIENCE = 10  # seconds that a cluster has to answer
LOST = "workers were lost"


class Crew(Protocol):
    """Whoever works. As a context it sends its workers home."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order. Raises Stopped as the watch does, and where
        workers are lost again and again."""

    def __enter__(self) -> "Crew": ...

    def __exit__(self, *_: object) -> None: ...


def crew(jobs: int = 1, dask: str | None = None) -> Crew:
    """The workers of the Dask cluster at that address, or so many processes."""
    if dask is not None:
        return Cluster(dask)
    return Processes(jobs) if jobs > 1 else ALONE


class Alone:
    """This process does all itself."""

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        return (work(unit, watch) for unit in units)

    def __enter__(self) -> "Alone":
        return self

    def __exit__(self, *_: object) -> None:
        pass


ALONE = Alone()


class Processes:
    """Processes of this machine. They end with this one, however it ends."""

    def __init__(self, jobs: int):
        self._jobs = jobs
        self._workers: dict[Connection, BaseProcess] = {}

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        while len(self._workers) < min(self._jobs, len(units)):
            self._hire()
        todo = deque(range(len(units)))
        busy: dict[Connection, int] = {}
        done: dict[int, tuple[bool, Any]] = {}
        lost: Counter[int] = Counter()
        try:
            for number in range(len(units)):
                while number not in done:
                    for pipe in [pipe for pipe in self._workers if pipe not in busy]:
                        if todo and todo[0] < number + AHEAD * self._jobs:
                            busy[pipe] = todo.popleft()
                            with contextlib.suppress(OSError):  # it is lost, as is seen below
                                pipe.send((work, units[busy[pipe]]))
                    ready = set(wait(list(busy), timeout=0.1))
                    for pipe in [pipe for pipe in busy if pipe in ready]:
                        unit = busy.pop(pipe)
                        try:
                            done[unit] = pipe.recv()
                        except (EOFError, OSError):
                            lost[unit] += 1
                            if lost[unit] == TRIES:
                                raise Stopped(LOST) from None
                            todo.appendleft(unit)
                            self._fire(pipe)
                            self._hire()
                    watch.tick()
                well, value = done.pop(number)
                if not well:
                    raise value
                yield value
        finally:
            for pipe in busy:
                self._fire(pipe)

    def _hire(self) -> None:
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs,), daemon=True)
        # Ctrl-C in the terminal is for this process alone, from the worker's first moment.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            process.start()
        except OSError:
            raise Stopped(MEMORY) from None
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()  # so that the pipe is at its end when the worker is
        self._workers[ours] = process

    def _fire(self, pipe: Connection) -> None:
        if process := self._workers.pop(pipe, None):
            process.kill()
            process.join()
            pipe.close()

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *_: object) -> None:
        for pipe in list(self._workers):
            self._fire(pipe)


def _serve(pipe: Connection) -> None:
    """In a worker: do what comes, until there is nobody to do it for."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with contextlib.suppress(EOFError, OSError):
        while True:
            work, unit = pipe.recv()
            try:
                answer = True, work(unit, None)
            except MemoryError:
                answer = False, Stopped(MEMORY)
            except Exception as error:
                answer = False, error
            pipe.send(answer)


class Cluster:
    """A running Dask cluster. It does the units of lost workers again."""

    def __init__(self, address: str):
        if not address.strip():  # of which Dask would make a cluster of its own
            raise InputError("--dask: an empty address")
        try:
            import distributed
        except ImportError:
            raise InputError(
                "--dask: not installed; pip install '.[dask]' in topomap's folder, "
                "or the wheel's file with [dask] after it"
            ) from None
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
        given: deque[Any] = deque()
        try:
            for number in range(len(units)):
                ahead = AHEAD * max(1, sum(self._client.nthreads().values()))
                for unit in units[number + len(given) : number + ahead]:
                    call = _at_worker, solver.digest(), work, unit
                    given.append(self._client.submit(*call, pure=False))
                result = self._result(given[0], watch)
                given.popleft()
                yield result
        except self._dask.comm.core.CommClosedError:
            raise Stopped(LOST) from None
        finally:
            with contextlib.suppress(Exception):  # there may be no cluster any more
                self._client.cancel(given)

    def _result(self, future: Any, watch: Watch) -> Any:
        from asyncio import run_coroutine_threadsafe  # takes as long to load as all else here

        # Asked for once: where Dask's own timeout ends, so does what is on its way.
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
    """A client of that cluster. One that finds none is closed here: left to Python's collector
    it may be closed while another one starts, which then waits for a lock of its own."""
    client = kind.__new__(kind)
    try:
        client.__init__(address, timeout=PATIENCE, set_as_default=False)
    except BaseException:
        with contextlib.suppress(Exception):
            client.close(timeout=1)
        raise
    return client


class _Wanted(Watch):
    """In a worker of a cluster: an end to what nobody waits for any more."""

    def __init__(self) -> None:
        from distributed import get_worker

        super().__init__(quiet=True)
        self._tasks = get_worker().state.tasks
        self._key = get_worker().get_current_task()

    def tick(self) -> None:
        task = self._tasks.get(self._key)
        if task is None or task.state == "cancelled":
            raise Stopped(INTERRUPT)


def _at_worker(digest: str, work: Work[Unit, Result], unit: Unit) -> Result:
    """Do a unit, if it is done here as it would be at home."""
    if digest != solver.digest():
        where = f"{socket.gethostname()}, process {os.getpid()}"
        raise InputError(f"--dask: a worker ({where}) has another topomap")
    return work(unit, _Wanted())
