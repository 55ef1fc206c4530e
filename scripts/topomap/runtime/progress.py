"""A progress line on stderr, for work that takes longer than a moment."""

import contextlib
import sys
import threading
import time
from typing import Any

SOON, OFTEN = 2.0, 0.2  # seconds until the first line, and between later ones, in a terminal
SELDOM = 10.0  # seconds between lines elsewhere, where each line stays


class Progress:
    """How many maps were found, and what is being done.

    tqdm draws the line. It is loaded when the line is first shown: most runs end before that, and
    loading it takes longer than they do.
    """

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
        """Say which part of the work is being done; an empty text means that none is named."""
        self._phase = text

    def show(self, found: int) -> None:
        """Show how many maps were found, if it is time to show it again."""
        if self._quiet or (self._bar is None and time.monotonic() < self._first):
            return
        with contextlib.suppress(OSError):  # stderr may be closed
            if self._bar is None:
                self._bar = _bar(self._interval)
            words = ": ".join(filter(None, [self._title, self._phase]))
            self._bar.set_description_str(words, refresh=False)
            self._bar.update(found - self._bar.n)

    def close(self) -> None:
        """Remove the line."""
        if self._bar is not None:
            with contextlib.suppress(OSError):
                self._bar.close()


def _bar(interval: float) -> Any:
    from tqdm import tqdm

    tqdm.monitor_interval = 0  # its thread may never begin
    # tqdm's own lock is shared by processes, and a process that is killed may keep it for ever.
    tqdm.set_lock(threading.RLock())
    return tqdm(unit=" maps", mininterval=interval, miniters=0, leave=False)
