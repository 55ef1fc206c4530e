"""Processes of this machine that share work.

A worker is a Python process of its own. Through a pipe it learns where to find modules, and then
what to do. multiprocessing would run the script of the user once more, and would start a process of
its own besides, which lets Ctrl-C through.
"""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from multiprocessing.spawn import get_executable
from typing import Any

from topomap.runtime.watch import MEMORY, Stopped, Watch
from topomap.solver.share import AHEAD, LOST, Result, Unit, Work

TRIES = 3  # a unit is given up after so many lost workers
WORKER = """\
import sys
from multiprocessing.connection import Connection
pipe = Connection(int(sys.argv[1]))
sys.path[:] = pipe.recv()
from topomap.solver.processes import serve
serve(pipe)
"""


class Processes:
    """Processes of this machine, which end with this process, however it ends."""

    def __init__(self, jobs: int):
        self._jobs = jobs
        self._workers: dict[Connection, subprocess.Popen[bytes]] = {}

    def each(
        self, work: Work[Unit, Result], units: Sequence[Unit], watch: Watch
    ) -> Iterator[Result]:
        """The result of each unit, in order."""
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
                            # The worker is lost, which is noticed below.
                            with contextlib.suppress(OSError):
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
        ours, theirs = Pipe()
        # -P: the files in this folder are not modules, unless they are for this process, too.
        call = [get_executable(), "-P", "-c", WORKER, str(theirs.fileno())]
        # From the start of the worker, Ctrl-C in the terminal reaches this process alone.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            process = subprocess.Popen(call, stdin=subprocess.PIPE, pass_fds=[theirs.fileno()])
        except OSError:
            raise Stopped(MEMORY) from None
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            theirs.close()  # so that the pipe ends when the worker ends
        self._workers[ours] = process
        # The worker is lost, which is noticed when it should work.
        with contextlib.suppress(OSError):
            ours.send([folder for folder in sys.path if isinstance(folder, str)])

    def _fire(self, pipe: Connection) -> None:
        if process := self._workers.pop(pipe, None):
            process.kill()
            process.communicate()
            pipe.close()

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *_: object) -> None:
        for pipe in list(self._workers):
            self._fire(pipe)


def serve(pipe: Connection) -> None:
    """Work as a worker: do what comes, until nobody needs it any more."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_the_other, daemon=True).start()
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


def _end_with_the_other() -> None:
    """End this worker, whatever it does, when the process that began it is gone.

    That process holds the other end of standard input, to which nothing is ever written.
    """
    os.read(0, 1)
    os._exit(0)
