"""Counting the search tree of an experience."""

import contextlib
from collections.abc import Iterator, Mapping
from typing import Any, Literal, Unpack, overload

from topomap.api.parts import Parts, begin, query_of
from topomap.model.experience import Experience
from topomap.model.vocabulary import DEMANDS
from topomap.paper.statistics import tree
from topomap.runtime.checks import whole
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Attempt, Watch
from topomap.solver.crews import crew as crew_of
from topomap.solver.share import Crew

Figure = int | list[int] | None
Number = Literal[
    "nodes", "maps_built", "final", "closed", "closed_text", "optimal", "perpendicular"
]


class Counts(Mapping[str, Figure]):
    """The figures of a search tree, by name: ``per_step`` (hypotheses after each step, from 0),
    ``nodes``, ``maps_built``, ``final``, ``closed``, ``closed_text``, ``optimal``,
    ``perpendicular``. What was not counted is None. ``fault`` says why not all was, if so."""

    def __init__(self, figures: Mapping[str, Any], fault: str | None):
        self._figures = dict(figures)
        self.fault = fault

    @property
    def complete(self) -> bool:
        """Whether all was counted."""
        return self.fault is None

    @overload
    def __getitem__(self, key: Literal["per_step"]) -> list[int]: ...
    @overload
    def __getitem__(self, key: Number) -> int | None: ...
    @overload
    def __getitem__(self, key: str) -> Figure: ...
    def __getitem__(self, key: str) -> Figure:
        figure: Figure = self._figures[key]
        return figure

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def __repr__(self) -> str:
        told = f", partial: {self.fault}" if self.fault else ""
        return f"Counts({self._figures}{told})"


def count(
    experience: Experience,
    *,
    bound: int | None = None,
    horizon: int | None = None,
    encoding: str = "fast",
    timeout: float | None = None,
    jobs: int = 1,
    watch: Watch | None = None,
    journal: Journal | None = None,
    crew: Crew | None = None,
    **parts: Unpack[Parts],
) -> Counts:
    """Count the search tree by clingo, as the paper's Figure 4 does.

    Parameters:
        experience: what was seen and done.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        encoding: ``fast``, or ``plain``, the rules that state the theory.
        timeout: seconds after which it stops.
        jobs: how many processes do the work.
        watch, journal, crew: those of a command; then ``timeout`` and ``jobs`` are not used.
        parts: what the maps are to have; not genus and minimal.

    Returns:
        The figures.

    Raises:
        TypeError: no experience.
        ValueError: an unknown part or encoding, or a number that cannot be.
        InputError: an experience that cannot be, one line that names step and fault.
    """
    query = query_of(parts, bound=bound, horizon=horizon, encoding=encoding, allowed=DEMANDS)
    jobs = whole("jobs", jobs, 1)
    watch = begin(experience, timeout, watch)
    figures: dict[str, Any] = {}
    with Attempt() as attempt, contextlib.ExitStack() as stack:
        workers = crew or stack.enter_context(crew_of(jobs))
        tree(experience, query, watch, journal or Journal(), figures, workers)
    return Counts(figures, attempt.fault)
