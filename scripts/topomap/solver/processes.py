"""Processes of this machine that share work."""

import contextlib
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from topomap.runtime.watch import MEMORY, Stopped, Watch
from topomap.solver.share import AHEAD, LOST, Result, Unit, Work

TRIES = 3  # workers that a unit may cost


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
