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

    In an ``if`` it is true when the file is valid.
    """

    told: dict[str, Any]

    @property
    def valid(self) -> bool:
        """Whether every command accepts the file; warnings do not count."""
        return bool(self.told["valid"])

    @property
    def faults(self) -> list[dict[str, Any]]:
        """What is wrong: each fault with ``line``, ``step`` (or None) and ``fault``, in words."""
        return list(self.told["faults"])

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What is seldom meant: each with ``line``, ``step`` (or None) and ``warning`` in words."""
        return list(self.told["warnings"])

    def __bool__(self) -> bool:
        return self.valid

    def document(self) -> dict[str, Any]:
        """All that is known, as ``topomap validate --json`` writes it."""
        return dict(self.told)

    def lines(self) -> list[str]:
        """All that is known, as the lines that ``topomap validate`` prints."""
        return list(validation.lines(self.told))

    def __str__(self) -> str:
        return "\n".join(self.lines())


def validate(path: str | Path, *, drift: int = DRIFT, stretch: int = STRETCH) -> Validation:
    """Judge an instance file (the experience in it is that of the paper, section II).

    Parameters:
        path: The file; ``-`` is standard input.
        drift: By how many percent of the way shifts may be wrong. What is too large for clingo's
            numbers depends on it.
        stretch: By how many percent lengths of one way may differ. What is too large for clingo's
            numbers depends on it.

    Returns:
        What is wrong with the file, and warnings. A file that cannot be read has one fault.

    Raises:
        TypeError: ``path`` is not the path of a file.
        ValueError: ``drift`` or ``stretch`` is not a whole number of 0 or more.
    """
    percents = whole("drift", drift, 0), whole("stretch", stretch, 0)
    return Validation(validation.judged(path_of(path), *percents))
