"""Queries: which hypotheses of an experience are asked for."""

from dataclasses import dataclass, replace

from topomap.model.vocabulary import OPTIMIZING


@dataclass(frozen=True)
class Query:
    """Which hypotheses are asked for.

    It has the parts of the theory that must hold, the largest number of places, and the last step
    that counts; the encoding that is used; and how many views may be wrong.
    """

    parts: frozenset[str] = frozenset()
    places: int | None = None
    horizon: int | None = None
    encoding: str = "work"
    noise: int | None = None

    @property
    def optimizes(self) -> bool:
        """Whether something is minimised."""
        return bool(self.parts & OPTIMIZING) or self.noise is not None

    @property
    def kind(self) -> str:
        """What the answers are."""
        return "best" if self.parts & OPTIMIZING else "consistent"

    def having(self, *parts: str) -> "Query":
        """The query with more parts."""
        return replace(self, parts=self.parts | set(parts))
