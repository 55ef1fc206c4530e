"""What each public function replies."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

from topomap.model.words import short
from topomap.runtime.errors import printable

MOST_SHOWN = 80  # letters of the gist in ``repr``


class Reply(ABC):
    """An answer, as lines to read and as JSON, and whether it is whole."""

    def __init__(self, fault: str | None = None):
        self._fault = fault

    @property
    def fault(self) -> str | None:
        """Why the answer is not whole; None if it is.

        The reason is a time limit, a signal or lack of memory.
        """
        return self._fault

    @property
    def complete(self) -> bool:
        """Whether the answer is whole; if it is not, ``fault`` says why."""
        return self.fault is None

    @abstractmethod
    def lines(self) -> Iterator[str]:
        """The answer as the lines that the command of this name prints."""

    @abstractmethod
    def document(self) -> dict[str, Any]:
        """The answer as the command of this name writes it as JSON.

        The name of the instance, and the keys that all answers have (``docs/formats.md``), are not
        in it.
        """

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def __repr__(self) -> str:
        partial = f", partial: {self.fault}" if self.fault else ""
        return f"<{type(self).__name__}: {short(printable(self._gist()), MOST_SHOWN)}{partial}>"

    def _gist(self) -> str:
        """The answer in one line, which is its first line unless a class says more."""
        return next(iter(self.lines()), "")
