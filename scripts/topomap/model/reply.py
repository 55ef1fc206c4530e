"""What a public function replies, whatever it was asked."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

from topomap.model.words import short
from topomap.runtime.errors import printable

MOST_SHOWN = 80  # letters of what a reply comes to, in the text that Python shows of it


class Reply(ABC):
    """An answer, in lines to read and as JSON, and whether it is whole."""

    def __init__(self, fault: str | None = None):
        self._fault = fault

    @property
    def fault(self) -> str | None:
        """Why the answer is not whole: a time limit, a signal, want of memory; None if it is."""
        return self._fault

    @property
    def complete(self) -> bool:
        """Whether the answer is whole; if not, ``fault`` says why."""
        return self.fault is None

    @abstractmethod
    def lines(self) -> Iterator[str]:
        """The answer to read, as the command of this name prints it."""

    @abstractmethod
    def document(self) -> dict[str, Any]:
        """The answer as the command of this name writes it as JSON, but for the name of the
        instance and the keys that all answers have (``docs/formats.md``)."""

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def __repr__(self) -> str:
        partial = f", partial: {self.fault}" if self.fault else ""
        return f"<{type(self).__name__}: {short(printable(self._gist()), MOST_SHOWN)}{partial}>"

    def _gist(self) -> str:
        """What the reply comes to, in one line: by itself its first line."""
        return next(iter(self.lines()), "")
