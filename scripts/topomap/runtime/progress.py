"""A progress line on stderr, for what takes longer than a moment."""

import contextlib
import sys
import threading
import time
from typing import Any

SOON, OFTEN = 2.0, 0.2  # seconds until it is shown, and from then on, on a terminal
SELDOM = 10.0  # the same elsewhere, where each line stays


class Progress:
    """How many maps were found, and what is being done. tqdm, which draws the line, is loaded
    when the line is first shown: most runs end before that, and it takes longer to load than
    they take."""

    def __init__(self, quiet: bool = False):
        self._quiet = quiet
        self._interval = OFTEN if sys.stderr.isatty() else SELDOM
        self._first = time.monotonic() + max(SOON, self._interval)
        self._bar: Any = None
        self._title = self._phase = ""

    def title(self, text: str) -> None:
        """Say what is being done."""
        self._title, self._phase = text, ""

    def phase(self, text: str) -> None:
        """Say which part of that is being done; with an empty text, that none is."""
        self._phase = text

    def show(self, found: int) -> None:
        """Show how many maps were found, if it is time for that."""
        if self._quiet or (self._bar is None and time.monotonic() < self._first):
            return
        with contextlib.suppress(OSError):  # stderr cannot be written
            if self._bar is None:
                self._bar = _bar(self._interval)
            words = ": ".join(filter(None, [self._title, self._phase]))
            self._bar.set_description_str(words, refresh=False)
            self._bar.update(found - self._bar.n)

    def close(self) -> None:
        """Take the line away."""
        if self._bar is not None:
            with contextlib.suppress(OSError):
                self._bar.close()


def _bar(interval: float) -> Any:
    from tqdm import tqdm

    tqdm.monitor_interval = 0  # a thread that may never begin
    # tqdm's own lock is made for processes, and may be left behind by one that is killed.
    tqdm.set_lock(threading.RLock())
    return tqdm(unit=" maps", mininterval=interval, miniters=0, leave=False)
