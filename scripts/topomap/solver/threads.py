"""Threads in which clingo works, while whoever waits for it looks at the clock.

So a time limit and Ctrl-C end a call of clingo at any moment, while it grounds too, and what was
found until then is kept. No such thread is at work when the interpreter is torn down: one that
then wants to call Python would take the whole process with it.
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

AHEAD = 1000  # answers that wait to be taken, at most
# Seconds between two times that a thread wakes the one that waits for what it hands over, and that
# this one sleeps at most: where answers come fast, many are taken at a time.
WAKING, SLEEP, TURN = 0.002, 0.01, 0.1
PATIENCE = 1.0  # seconds that a thread has to end when the process does

Put = Callable[[Any], bool]  # hands an item over; False if no more of them are wanted


class Called(Protocol):
    """What works in a thread."""

    say: Callable[[str], None]

    def interrupt(self) -> None:
        """End the call of another thread, as soon as it has grounded."""

    def keep(self) -> None:
        """Have it at hand, if this thread asks for it again."""


def prepare() -> None:
    """Have C++ allocate what it needs to report an error in this thread: when it is out of
    memory it cannot, and aborts."""
    with contextlib.suppress(RuntimeError):
        clingo.parse_term("", logger=lambda *_: None)


class _Worker:
    """A thread that does one job after another. It is started while there is memory, and has
    what it needs when there is none left: a threading.Thread that cannot begin is waited for
    without end, and C++ aborts where it cannot report an error."""

    idle: ClassVar[list["_Worker"]] = []

    def __init__(self) -> None:
        self._jobs: queue.SimpleQueue[tuple[Callable[[], None], threading.Event]]
        self._jobs = queue.SimpleQueue()
        life = _Life()
        self._alive = weakref.ref(life)
        _thread.start_new_thread(self._run, (life,))

    @classmethod
    def hire(cls) -> "_Worker":
        """An idle one, or a new one. Raises Stopped if there is no room for it."""
        try:
            return cls.idle.pop()
        except IndexError:
            pass
        try:
            return cls()
        except RuntimeError:
            raise Stopped(MEMORY) from None

    def do(self, job: Callable[[], None], over: threading.Event) -> None:
        """Begin with a job; the event is set when it is done."""
        self._jobs.put((job, over))

    def is_alive(self) -> bool:
        return self._alive() is not None

    def _run(self, _: object) -> None:
        prepare()
        while True:
            job, over = self._jobs.get()
            job()
            del job  # and what it holds
            self.idle.append(self)
            over.set()


class _Life:
    """An object to which only a running thread refers: once it is gone, the thread has ended."""


class _Run:
    """The work of a program in a thread, and what is handed over by it."""

    live: ClassVar[set["_Run"]] = set()  # those that have not ended
    leaving: ClassVar[bool] = False  # the process ends: nothing is begun any more

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
            except Exception as error:  # raised again in the thread that waits
                end = error
            # What was stopped may have ended early, and its errors hold what it worked with.
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
            # Only now it is sure that whoever makes room, or stops this, wakes it.
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
        """The next item. Raises queue.Empty if there is none for a while, and Stopped if there
        will be none as memory ran out."""
        items = self._items
        if not items:
            end = time.monotonic() + TURN
            while not items:
                # Nobody sets it between the look and the sleep: it is cleared before the look.
                self._some.clear()
                if not items:
                    self._some.wait(SLEEP)
                if not items and time.monotonic() > end:
                    if not self._worker.is_alive() and not items:  # it could not even say why
                        raise Stopped(MEMORY)
                    raise queue.Empty
        item = items.popleft()
        if len(items) <= AHEAD // 2 and not self._room.is_set():
            self._room.set()
        return item

    def stop(self) -> None:
        """Have it end, as soon as clingo can be interrupted."""
        self._stop.set()
        self._room.set()
        self._program.interrupt()

    def wait(self, seconds: float | None) -> bool:
        """Wait until it has ended, so long at most; whether it has."""
        return self._over.wait(seconds) or not self._worker.is_alive()


def in_thread(program: Called, watch: Watch, work: Callable[[Put], None]) -> Iterator[Any]:
    """What ``work`` puts, in a thread of its own; what it puts last is False if it is to
    end. Raises Stopped at the time limit, or out of memory."""
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
    """End what is still at work before the interpreter is torn down."""
    _Run.leaving = True
    running = [*_Run.live]
    for run in running:
        run.stop()
    end = time.monotonic() + PATIENCE
    try:
        for run in running:
            run.wait(max(0.0, end - time.monotonic()))
    finally:  # also when Ctrl-C comes
        if not all(run.wait(0) for run in running) and not _spare_destructors():
            for run in running:
                run.wait(None)


def _spare_destructors() -> bool:
    """Have the process end, with the exit status that it is to have, once Python has ended and
    before C++ tears down what a thread that still grounds is using: grounding cannot be
    interrupted. Returns whether this C library can do it."""
    try:
        import ctypes

        library = ctypes.CDLL(None)
        on_exit, steps = library.on_exit, (library._exit, library.fcloseall)
    except (ImportError, OSError, AttributeError):
        return False
    for step in steps:  # the last one is called first: streams of C are written out
        on_exit(step, None)
    return True


def _forget() -> None:
    """In a forked process: it has none of these threads."""
    _Worker.idle.clear()
    _Run.live.clear()


os.register_at_fork(after_in_child=_forget)
