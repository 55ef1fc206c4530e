"""Enumerating the maps of an experience."""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Unpack, overload

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, query_of
from topomap.model.experience import Experience
from topomap.model.found import UNPROVED, Found
from topomap.model.query import Query
from topomap.runtime.checks import flag, whole, whole_if_given
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Attempt, Stopped, Watch
from topomap.solver.crews import crew as crew_of
from topomap.solver.enumeration import WAYS, every
from topomap.solver.share import ALONE, Crew


class Answer(Sequence[Map]):
    """The maps that were asked for, as they are found.

    To iterate over it goes on while they come; its length, ``complete``, ``kind``, ``cost`` and
    ``fault`` wait for the last one. Maps are kept, so that it can be gone through again.
    """

    def __init__(
        self,
        experience: Experience,
        query: Query,
        kind: str,
        coming: Iterator[Found],
        limit: int | None,
    ):
        self.experience, self.query = experience, query
        self._coming, self._limit = coming, limit
        self._kept: list[Map] = []
        self._stream = self._maps()
        self._count = 0
        self._last = Found((), kind)
        self._fault: str | None = None

    def stream(self) -> Iterator[Map]:
        """The maps that are yet to come, each as it is found. They are not kept: this is for
        more maps than memory holds."""
        return self._stream

    def _maps(self) -> Iterator[Map]:
        candidate = None
        with Attempt() as attempt:
            for found in self._coming:
                if not found.proved:
                    candidate = found
                elif self._count == self._limit:
                    raise Stopped("limit")
                else:
                    self._count += 1
                    self._last = found
                    yield self._map(found)
        if attempt.fault and candidate and not self._count:
            self._count = 1
            self._last = replace(candidate, kind=UNPROVED)
            yield self._map(self._last)
        self._fault = attempt.fault

    def _map(self, found: Found) -> Map:
        """A map, the last one so far; how many there will be is not known."""
        noisy = self.query.noise is not None
        return Map(self.experience, found, self._count, 0, noisy=noisy)

    def _all(self) -> list[Map]:
        self._kept.extend(self._stream)
        return self._kept

    def __iter__(self) -> Iterator[Map]:
        number = 0
        while True:
            if number == len(self._kept):
                try:
                    self._kept.append(next(self._stream))
                except StopIteration:
                    return
            yield self._kept[number]
            number += 1

    @overload
    def __getitem__(self, index: int) -> Map: ...
    @overload
    def __getitem__(self, index: slice) -> list[Map]: ...
    def __getitem__(self, index: int | slice) -> Map | list[Map]:
        if isinstance(index, int) and index >= 0:
            for number, one in enumerate(self):
                if number == index:
                    return one
        return self._all()[index]

    def __len__(self) -> int:
        return len(self._all())

    @property
    def fault(self) -> str | None:
        """Why these may not be all the maps that were asked for, or None if they are all."""
        self._all()
        return self._fault

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no others."""
        return self.fault is None

    @property
    def kind(self) -> str:
        """What the maps are: consistent, best, optimal, best so far; or not proved to be best."""
        self._all()
        return self._last.kind

    @property
    def proved(self) -> bool:
        """Whether no map is better, if something was minimised."""
        self._all()
        return self._last.proved and (self._count > 0 or self._fault is None)

    @property
    def cost(self) -> tuple[int, ...]:
        """What was minimised, most important first; empty if nothing was."""
        self._all()
        return self._last.cost

    def __repr__(self) -> str:
        maps = self._all()
        more = f", partial: {self._fault}" if self._fault else ""
        return f"<Answer: {len(maps)} {self._last.kind}{more}>"


def solve(
    experience: Experience,
    *,
    optimal: bool = False,
    bound: int | None = None,
    horizon: int | None = None,
    noise: int | None = None,
    by: str = "clingo",
    encoding: str | None = None,
    limit: int | None = None,
    timeout: float | None = None,
    jobs: int = 1,
    watch: Watch | None = None,
    journal: Journal | None = None,
    crew: Crew | None = None,
    **parts: Unpack[Parts],
) -> Answer:
    """Enumerate the maps that are consistent with an experience (the paper, sections II, III).

    Parameters:
        experience: what was seen and done.
        optimal: closed maps with consistent boundaries, fewest paths, then fewest places; if
            there is none, the best so far, pending gateways allowed.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        noise: how many views may be wrong, as few as can be; by the plain encoding.
        by: ``clingo``, or ``search``, the paper's own search.
        encoding: ``fast``, or ``plain``, the rules that state the theory (with noise: plain).
        limit: stop after so many maps.
        timeout: seconds after which it stops; they begin now.
        jobs: how many processes do the work; not with what minimises.
        watch, journal, crew: those of a command; then ``timeout`` and ``jobs`` are not used.
        parts: what the maps are to have.

    Returns:
        The maps, as they are found.

    Raises:
        TypeError: no experience.
        ValueError: an unknown part, way or encoding, a number that cannot be, or what does not go
            together.
        InputError: an experience that cannot be, one line that names step and fault.
    """
    encoding = encoding or ("fast" if noise is None else "plain")
    query = query_of(parts, bound=bound, horizon=horizon, encoding=encoding, noise=noise)
    if not isinstance(by, str) or by not in WAYS:
        raise ValueError(f"{by!r} is not one of the ways {', '.join(WAYS)}")
    if noise is not None and encoding != "plain":
        raise ValueError(f"encoding={encoding!r}: with noise it is plain")
    limit, jobs = whole_if_given("limit", limit, 1), whole("jobs", jobs, 1)
    minimises = flag("optimal", optimal) or query.optimizes
    if minimises and (jobs > 1 or (crew not in (None, ALONE))):
        raise ValueError("jobs: all maps are shared out, not the best ones")
    if noise is not None and by == "search":
        raise ValueError("noise does not go with by='search'")
    begun = begin(experience, timeout, watch, noise is not None)

    def coming() -> Iterator[Found]:
        with contextlib.ExitStack() as stack:
            workers = crew or stack.enter_context(crew_of(jobs))
            yield from every(experience, query, begun, by, optimal, journal, workers)

    kind = "optimal" if optimal else query.kind
    return Answer(experience, query, kind, coming(), limit)
