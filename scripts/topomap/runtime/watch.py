"""What may end a search before it is complete: a time limit, a signal, or lack of memory."""

import contextlib
import functools
import signal
import time
from collections.abc import Callable, Iterator
from typing import Generic, ParamSpec, Self, TypeVar

from topomap.runtime.progress import Progress
from topomap.runtime.status import INTERRUPT

MEMORY = "out of memory"
P = ParamSpec("P")
T = TypeVar("T")
SIGNALS = (signal.SIGINT, signal.SIGTERM)


Late = Callable[[], bool]  # whether the time is over


def never() -> bool:
    """The time limit that never ends."""
    return False


class Stopped(Exception):
    """The search ended before everything was found; the message says why."""


STOPS = Stopped, MemoryError  # the exceptions that leave a partial answer


class Attempt:
    """A context for work that may be cut short, after which ``fault`` says why, or is None.

    So what was found until then can be reported.
    """

    fault: str | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, STOPS):
            return False
        self.fault = str(error) if isinstance(error, Stopped) else MEMORY
        return True


class _Spared(Generic[T]):
    """An iterator that frees what it holds when memory runs out, and then reports that.

    The order matters, because even reporting it takes some memory.
    """

    def __init__(self, items: Iterator[T]):
        self._items: Iterator[T] = items

    def __iter__(self) -> Iterator[T]:
        return self

    def __next__(self) -> T:
        try:
            return next(self._items)
        except MemoryError:
            pass
        # Only here has the error been freed, and with it all that the generator held.
        self._items = iter(())
        raise Stopped(MEMORY)


def spared(function: Callable[P, Iterator[T]]) -> Callable[P, Iterator[T]]:
    """Decorate a generator function that may hold much memory.

    When memory runs out, it frees what it holds and raises Stopped.
    """

    @functools.wraps(function)
    def made(*args: P.args, **options: P.kwargs) -> Iterator[T]:
        """Make the iterator of a call."""
        return _Spared(function(*args, **options))

    return made


class Deadline:
    """A time limit: ``at`` is its end on the monotonic clock, or None if there is none."""

    def __init__(self, seconds: float | None = None):
        self.at = None if seconds is None else time.monotonic() + seconds

    @property
    def passed(self) -> bool:
        """Whether the time is over."""
        return self.at is not None and time.monotonic() > self.at

    @contextlib.contextmanager
    def waiting(self) -> Iterator[None]:
        """Stop the clock of the time limit until something else is done."""
        begun = time.monotonic()
        at, self.at = self.at, None
        try:
            yield
        finally:
            self.at = None if at is None else at + time.monotonic() - begun

    @contextlib.contextmanager
    def earlier(self, seconds: float) -> Iterator[None]:
        """Limit a part of the work to a number of seconds."""
        at, end = self.at, time.monotonic() + seconds
        self.at = end if at is None else min(at, end)
        try:
            yield
        finally:
            self.at = at

    @contextlib.contextmanager
    def sooner(self, share: float) -> Iterator[None]:
        """Limit a part of the work to a share of the time that is left."""
        at, now = self.at, time.monotonic()
        self.at = None if at is None else now + share * max(0.0, at - now)
        try:
            yield
        finally:
            self.at = at


class Signals:
    """A context that catches SIGINT and SIGTERM, and notes that one came."""

    came = False

    def __enter__(self) -> "Signals":
        def note(*_: object) -> None:
            """Note the signal."""
            self.came = True

        heeded = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
        self._handlers = [(number, signal.signal(number, note)) for number in heeded]
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers:
            signal.signal(number, handler)


class Watch:
    """What the search and clingo look at while they work.

    It has the deadline, and the signals and the progress line of the command that began the work,
    if a command did. ``found`` counts the maps. ``by`` is the way that finds them, and ``least`` is
    a proved lower bound on their cost.

    Without signals and a progress line it changes nothing in the process, so that it can be used in
    any thread. Another thread ends the work by setting ``ended`` to the reason.
    """

    def __init__(
        self,
        timeout: float | None = None,
        progress: Progress | None = None,
        signals: Signals | None = None,
    ):
        self.found = 0
        self.by: str | None = None
        self.least: tuple[int, ...] | None = None
        self.ended: str | None = None
        self.deadline = Deadline(timeout)
        self._progress = progress or Progress(quiet=True)
        self._signals = signals
        self.title, self.phase = self._progress.title, self._progress.phase

    def tick(self) -> None:
        """Show progress.

        Raises:
            Stopped: The time limit has passed, a signal came, or another thread has ended the work.
        """
        if self.late():
            raise Stopped("timeout")

    def late(self) -> bool:
        """Tell whether the time limit has passed, for work that then takes a shorter way.

        It shows progress, too.

        Raises:
            Stopped: A signal came, or another thread has ended the work.
        """
        self._progress.show(self.found)
        if self._signals and self._signals.came:
            raise Stopped(INTERRUPT)
        if self.ended is not None:
            raise Stopped(self.ended)
        return self.deadline.passed


@contextlib.contextmanager
def heeding(timeout: float | None = None, quiet: bool = False) -> Iterator[Watch]:
    """Make the watch of a command.

    It has a time limit in seconds, shows a progress line on stderr when the work takes long, and
    ends the work with Stopped after SIGINT or SIGTERM.
    """
    progress = Progress(quiet)
    with Signals() as signals:
        try:
            yield Watch(timeout, progress, signals)
        finally:
            progress.close()
