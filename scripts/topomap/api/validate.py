"""Judging instance files without solving anything."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from topomap.api.parts import path_of
from topomap.model import validation
from topomap.runtime.checks import whole
from topomap.runtime.limits import DRIFT, STRETCH


@dataclass(frozen=True)
class Validation:
    """What is wrong with an instance file, and what in it looks like a mistake.

    ``valid`` tells whether every command takes it. ``faults`` and ``warnings`` are dictionaries
    with the ``line`` and ``step``, or None, and the words under ``fault`` or ``warning``. In an
    ``if`` it is true when the file is valid.
    """

    told: dict[str, Any]

    @property
    def valid(self) -> bool:
        """Whether every command takes the file; warnings do not count."""
        return bool(self.told["valid"])

    @property
    def faults(self) -> list[dict[str, Any]]:
        """What is wrong: each fault with ``line``, ``step`` and ``fault``, in words."""
        return list(self.told["faults"])

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What is seldom meant: each with ``line``, ``step`` and ``warning``, in words."""
        return list(self.told["warnings"])

    def __bool__(self) -> bool:
        return self.valid

    def document(self) -> dict[str, Any]:
        """All that is known, as ``topomap validate --json`` writes it."""
        return dict(self.told)

    def lines(self) -> list[str]:
        """The same in lines to read."""
        return list(validation.lines(self.told))

    def __str__(self) -> str:
        return "\n".join(self.lines())


def validate(path: str | Path, *, drift: int = DRIFT, stretch: int = STRETCH) -> Validation:
    """Judge an instance file.

    Parameters:
        path: the file; ``-`` is standard input.
        drift: how far shifts may be wrong, in percent of the way: what is too large for clingo's
            numbers depends on it.
        stretch: how far lengths of one way may differ, in percent; the same depends on it.

    Returns:
        What is wrong with it, and warnings. A file that cannot be read has one fault.

    Raises:
        TypeError: no path.
        ValueError: a percent that is no whole number from 0.
    """
    percents = whole("drift", drift, 0), whole("stretch", stretch, 0)
    return Validation(validation.judged(path_of(path), *percents))
