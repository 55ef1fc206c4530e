"""Counting the search tree of an experience."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal, Unpack, overload

from topomap.api.parts import Parts, begin, demand_pairs, query_of
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.model.reply import Reply
from topomap.model.vocabulary import DEMANDS, RELAXING
from topomap.paper import statistics
from topomap.runtime.checks import flag, whole
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Attempt, Watch
from topomap.solver.crews import crew as crew_of
from topomap.solver.share import Crew

Figure = int | list[int] | str | None
Number = Literal[
    "nodes",
    "maps_built",
    "final",
    "closed",
    "closed_text",
    "optimal",
    "perpendicular",
    "circumscribed",
]


class Counts(Reply, Mapping[str, Figure]):
    """The figures of a search tree, by name.

    They are ``per_step`` (the number of hypotheses after each step, from 0), ``nodes``,
    ``maps_built``, ``final``, ``closed``, ``closed_text``, ``optimal`` and ``perpendicular``; if
    they were asked for, ``circumscribed`` and ``circumscribed_kind``; and ``way``, which is
    "merging", where maps were counted by merging. What was not counted is None.
    """

    def __init__(self, figures: Mapping[str, Any], fault: str | None):
        super().__init__(fault)
        self._figures = dict(figures)

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

    def lines(self) -> Iterator[str]:
        """The figures as the lines that ``topomap count`` prints."""
        return iter(statistics.figures_text(self, self.fault).splitlines())

    def document(self) -> dict[str, Any]:
        """The figures as ``topomap count --json`` writes them."""
        return dict(self._figures)

    def __repr__(self) -> str:
        told = f", partial: {self.fault}" if self.fault else ""
        return f"Counts({self._figures}{told})"


def count(
    experience: Experience,
    *,
    bound: int | None = None,
    horizon: int | None = None,
    circumscribe: bool = False,
    merging: bool = False,
    timeout: float | None = None,
    jobs: int = 1,
    **parts: Unpack[Parts],
) -> Counts:
    """Count the search tree of an experience (the paper, section IV, Figure 4).

    clingo counts, or hypotheses that have the same future are merged, which counts maps that are
    too many to be listed.

    Parameters:
        experience: What the agent saw and did.
        bound: The largest number of places that a map may have.
        horizon: The last step that counts. By default all steps count.
        circumscribe: Whether to count the circumscribed maps, too, as ``solve`` gives them: the
            figure ``circumscribed``, and ``circumscribed_kind``, which says of which kind they are.
        merging: Whether to count by merging. It counts all final maps, the closed ones, and those
            that are also perpendicular: ``final``, ``closed_text`` and ``perpendicular``. The other
            figures are None, and ``per_step`` is empty.
        timeout: The number of seconds after which the work stops.
        jobs: The number of processes that share the work.
        parts: The demands on the maps, as for ``solve``; not ``genus``, ``exceptions`` and
            ``minimal``.

    Returns:
        The figures.

    Raises:
        TypeError: ``experience`` is not an Experience.
        ValueError: A part is not known, or a number is out of its range.
        InputError: The experience is impossible, or, with ``merging``, cannot be merged. The
            message is one line that names the step and the fault.
    """
    query = query_of(parts, bound=bound, horizon=horizon, allowed=(*DEMANDS, *RELAXING))
    circumscribe = flag("circumscribe", circumscribe)
    jobs = whole("jobs", jobs, 1)
    demand_pairs(experience, "count")
    watch = begin(experience, timeout)
    if flag("merging", merging):
        if circumscribe or jobs > 1:
            raise ValueError("merging cannot be combined with circumscribe or jobs")
        return merged_under(watch, experience, query)
    with crew_of(jobs) as crew:
        return count_under(watch, experience, query, Journal(), crew, circumscribe)


def merged_under(watch: Watch, experience: Experience, query: Query) -> Counts:
    """Count all maps, and the closed ones, by merging, under the watch of a command.

    The figures come in the order in which they are found soonest.
    """
    figures: dict[str, Any] = {**dict.fromkeys(statistics.KEYS), "per_step": [], "way": "merging"}
    with Attempt() as attempt:
        for key, number in statistics.merged(experience, query, watch):
            figures[key] = number
    return Counts(figures, attempt.fault)


def count_under(
    watch: Watch,
    experience: Experience,
    query: Query,
    journal: Journal,
    crew: Crew,
    circumscribe: bool = False,
) -> Counts:
    """Count the search tree of a query under the watch of a command.

    The command has a journal of the work, and a crew that shares it.
    """
    figures: dict[str, Any] = {}
    with Attempt() as attempt:
        statistics.tree(experience, query, watch, journal, figures, crew, circumscribe)
    return Counts(figures, attempt.fault)
