"""Threads in which clingo works, while the caller watches the clock.

So a time limit and Ctrl-C end a call of clingo at any moment, even while it grounds, and what was
found until then is kept. No such thread may be at work when the interpreter ends, because a thread
that then calls Python would crash the whole process.
"""

import _thread
import atexit
import collections
import contextlib
import os
import queue
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Protocol

import clingo

from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import MEMORY, Stopped, Watch

AHEAD = 1000  # the largest number of answers that wait
# Seconds between two times that a thread wakes the one that waits for its items, and the longest
# time that the latter sleeps: if answers come fast, many are taken at a time.
WAKING, SLEEP, TURN = 0.002, 0.01, 0.1
PATIENCE = 1.0  # seconds within which a thread must end when the process ends

Put = Callable[[Any], bool]  # it hands an item over, and returns False if no more are wanted


class Called(Protocol):
    """Something that works in a thread."""

    say: Callable[[str], None]

    def interrupt(self) -> None:
        """End the call of another thread as soon as it has grounded."""

    def keep(self) -> None:
        """Keep it for the next call of this thread."""


def prepare() -> None:
    """Let C++ allocate what it needs to report an error in this thread.

    When it is out of memory, it cannot do that any more, and aborts.
    """
    with contextlib.suppress(RuntimeError):
        clingo.parse_term("", logger=lambda *_: None)


class _Worker:
    """A thread that does one job after another.

    It is started while there is memory, and has what it needs when there is none left. A
    threading.Thread that cannot begin would be waited for without end, and C++ would abort where it
    cannot report an error.
    """

    idle: ClassVar[list["_Worker"]] = []

    def __init__(self) -> None:
        self._jobs: queue.SimpleQueue[tuple[Callable[[], None], threading.Event]]
        self._jobs = queue.SimpleQueue()
        life = _Life()
        self._alive = weakref.ref(life)
        _thread.start_new_thread(self._run, (life,))

    @classmethod
    def hire(cls) -> "_Worker":
        """Find an idle worker, or make a new one.

        Raises:
            Stopped: There is not enough memory for it.
        """
        try:
            return cls.idle.pop()
        except IndexError:
            pass
        try:
            return cls()
        except RuntimeError:
            raise Stopped(MEMORY) from None

    def do(self, job: Callable[[], None], over: threading.Event) -> None:
        """Begin a job; the event is set when it is done."""
        self._jobs.put((job, over))

    def is_alive(self) -> bool:
        """Whether the thread runs."""
        return self._alive() is not None

    def _run(self, _: object) -> None:
        prepare()
        while True:
            job, over = self._jobs.get()
            job()
            del job  # this frees what the job holds
            self.idle.append(self)
            over.set()


class _Life:
    """An object to which only a running thread refers: when it is gone, the thread has ended."""


class _Run:
    """The work of a program in a thread, and the items that it hands over."""

    live: ClassVar[set["_Run"]] = set()  # the runs that have not ended
    leaving: ClassVar[bool] = False  # whether the process is ending, so that nothing may begin

    def __init__(self, program: Called, work: Callable[[Put], None]):
        if self.leaving:
            raise Stopped(INTERRUPT)
        self._program, self._work = program, work
        self._items: collections.deque[Any] = collections.deque()
        self._woken = 0.0
        self._some = threading.Event()
        self._room, self._stop = threading.Event(), threading.Event()
        self._over = threading.Event()
        self._worker = _Worker.hire()
        self.live.add(self)
        self._worker.do(self._run, self._over)

    def _run(self) -> None:
        end: Exception = StopIteration()
        try:
            try:
                self._work(self._put)
            except Exception as error:  # it is raised again in the thread that waits
                end = error
            # The job may have been stopped, and its errors hold what it worked with.
            self._items.append(Stopped(INTERRUPT) if self._stop.is_set() else end)
            self._some.set()
        finally:
            del end
            self.live.discard(self)

    def _put(self, item: Any) -> bool:
        """Hand an item over, once there is room for it."""
        if len(self._items) >= AHEAD:
            self._room.clear()
            self._some.set()
            # Only from here on is this thread woken by one that makes room or stops it.
            if len(self._items) >= AHEAD and not self._stop.is_set():
                self._room.wait()
        if self._stop.is_set():
            return False
        self._items.append(item)
        if (now := time.monotonic()) - self._woken > WAKING:
            self._woken = now
            self._some.set()
        return True

    def get(self) -> Any:
        """Take the next item.

        Raises:
            queue.Empty: There has been none for a while.
            Stopped: There will be none, because memory ran out.
        """
        items = self._items
        if not items:
            end = time.monotonic() + TURN
            while not items:
                # The event is cleared before the look, so it cannot be missed before the sleep.
                self._some.clear()
                if not items:
                    self._some.wait(SLEEP)
                if not items and time.monotonic() > end:
                    if not self._worker.is_alive() and not items:  # it could not even report why
                        raise Stopped(MEMORY)
                    raise queue.Empty
        item = items.popleft()
        if len(items) <= AHEAD // 2 and not self._room.is_set():
            self._room.set()
        return item

    def stop(self) -> None:
        """End the work as soon as clingo can be interrupted."""
        self._stop.set()
        self._room.set()
        self._program.interrupt()

    def wait(self, seconds: float | None) -> bool:
        """Wait until the work has ended, at most so long, and tell whether it has."""
        return self._over.wait(seconds) or not self._worker.is_alive()


def in_thread(program: Called, watch: Watch, work: Callable[[Put], None]) -> Iterator[Any]:
    """Give what ``work`` puts, in a thread of its own; ``put`` returns False to end the work.

    Raises:
        Stopped: The time limit has passed, or memory ran out.
    """
    program.say = watch.phase
    run = _Run(program, work)
    ended = False
    try:
        while True:
            try:
                item = run.get()
            except queue.Empty:
                watch.tick()
                continue
            if isinstance(item, StopIteration):
                ended = True
                return
            if isinstance(item, MemoryError):
                raise Stopped(MEMORY)
            if isinstance(item, Exception):
                raise item
            watch.tick()
            yield item
    finally:
        if ended:
            program.keep()
        else:
            run.stop()
        run.wait(0.5)


@atexit.register
def _leave() -> None:
    """End what is still at work before the interpreter ends."""
    _Run.leaving = True
    running = [*_Run.live]
    for run in running:
        run.stop()
    end = time.monotonic() + PATIENCE
    try:
        for run in running:
            run.wait(max(0.0, end - time.monotonic()))
    finally:  # this also happens after Ctrl-C
        if not all(run.wait(0) for run in running) and not _spare_destructors():
            for run in running:
                run.wait(None)


def _spare_destructors() -> bool:
    """Let the process end before C++ destroys what a thread that still grounds is using.

    It ends with its exit status, after Python has ended. Grounding cannot be interrupted.

    Returns:
        Whether this C library can do that.
    """
    try:
        import ctypes

        library = ctypes.CDLL(None)
        on_exit, steps = library.on_exit, (library._exit, library.fcloseall)
    except (ImportError, OSError, AttributeError):
        return False
    for step in steps:  # the last one is called first, which flushes the streams of C
        on_exit(step, None)
    return True


def _forget() -> None:
    """Forget all threads in a forked process, which has none of them."""
    _Worker.idle.clear()
    _Run.live.clear()


os.register_at_fork(after_in_child=_forget)
