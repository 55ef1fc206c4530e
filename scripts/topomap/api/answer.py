"""The maps that are found, as they are found."""

import contextlib
import operator
import threading
from collections.abc import Generator, Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import islice
from typing import SupportsIndex, overload

from topomap.api.maps import Map
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.words import number
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Attempt, Stopped, Watch
from topomap.solver.defaults import in_the_way
from topomap.solver.enumeration import proved_or_last

CLOSED = "closed"  # why an answer is partial that was not wanted any more
UNFINISHED = "not finished"


class _Known:
    """What is known by now. It is apart from the answer, so that the search does not hold the
    answer, and ends when nobody does any more."""

    def __init__(self, experience: Experience, query: Query):
        self._experience, self._noisy = experience, query.noise is not None
        self.keeps = True
        self.maps: list[Map] = []
        self.count = 0
        self.last: Found | None = None
        self.begun = False
        self.fault: str | None = UNFINISHED

    def add(self, found: Found) -> Map:
        """One more map; how many there will be is not known."""
        self.count += 1
        self.last = found
        made = Map(self._experience, found, self.count, 0, noisy=self._noisy)
        if self.keeps:
            self.maps.append(made)
        return made


class Answer(Sequence[Map]):
    """The maps that were asked for, as they are found.

    To iterate over it goes on while they come; its length, ``complete``, ``kind``, ``cost`` and
    ``fault`` wait for the last one. Maps are kept, so that it can be gone through again, also by
    several threads. The search begins with the first map that is asked for; it ends with the
    answer, by ``close``, or at the end of a ``with`` statement.
    """

    def __init__(
        self,
        experience: Experience,
        query: Query,
        coming: Generator[Found, None, None],
        limit: int | None = None,
        watch: Watch | None = None,
        waits: bool = True,
        optimal: bool = False,
    ):
        """The maps that are ``coming``, at most ``limit`` of them, found under a ``watch``. Its
        time limit ``waits`` while the caller has control; that of a command does not. They are
        the ``optimal`` ones, or all."""
        self.experience, self.query, self._optimal = experience, query, optimal
        self._watch = watch or Watch()
        self._known = _Known(experience, query)
        self._search = _search(self._known, coming, limit, self._watch if waits else None)
        self._one_at_a_time = threading.RLock()

    def stream(self) -> Iterator[Map]:
        """The maps, each as it is found, for more of them than memory holds: they are not kept.
        From then on the answer has no length and no maps of its own, and ``complete``, ``kind``,
        ``cost`` and ``fault`` say what is known by now. Raises ValueError if maps were asked for
        before."""
        if self._known.begun or not self._known.keeps:
            raise ValueError("a stream begins before maps are asked for")
        self._known.keeps = False
        return self._each()

    def _each(self) -> Iterator[Map]:
        with self:
            while (one := self._next()) is not None:
                yield one

    def _next(self) -> Map | None:
        with self._one_at_a_time:
            return next(self._search, None)

    def close(self) -> None:
        """End the search, also when another thread waits for it. The maps that were found until
        then are kept; ``fault`` says "closed" if there may be others."""
        self._watch.ended = CLOSED
        with self._one_at_a_time:
            self._search.close()
            if self._known.fault == UNFINISHED:
                self._known.fault = CLOSED

    def __enter__(self) -> "Answer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _at(self, place: int) -> Map | None:
        """The map at a place, from 0, as soon as it is found; None if there are not as many."""
        known = self._known
        if not known.keeps:
            raise ValueError("the maps go to a stream, and are not kept")
        with self._one_at_a_time:
            while len(known.maps) <= place:
                if next(self._search, None) is None:
                    return None
        return known.maps[place]

    def _all(self) -> list[Map]:
        for _ in self:
            pass
        return self._known.maps

    def __iter__(self) -> Iterator[Map]:
        place = 0
        while (one := self._at(place)) is not None:
            yield one
            place += 1

    @overload
    def __getitem__(self, index: SupportsIndex) -> Map: ...
    @overload
    def __getitem__(self, index: slice) -> list[Map]: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Map | list[Map]:
        """A map, or those of a slice. Where the first ones are enough, no others are looked for."""
        if isinstance(index, slice):
            enough = _enough(index)
            return (self._all() if enough is None else [*islice(self, enough)])[index]
        place = operator.index(index)
        one = self._at(place) if place >= 0 else None
        return self._all()[place] if one is None else one

    def __len__(self) -> int:
        return len(self._all())

    def __bool__(self) -> bool:
        """Whether there is a map; none but the first is looked for."""
        return self._at(0) is not None

    def _settled(self) -> _Known:
        if self._known.keeps:
            self._all()
        return self._known

    @property
    def fault(self) -> str | None:
        """Why these may not be all the maps that were asked for, or None if they are all:
        "limit", "timeout", "out of memory", "closed", "interrupted", or the text of an error."""
        return self._settled().fault

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no others."""
        return self.fault is None

    @property
    def kind(self) -> str:
        """What the maps are: consistent, best, optimal, best so far, circumscribed, circumscribed
        so far; or not proved to be best.
        "no map" if it is proved that there is none, "not settled" if none was found as yet."""
        known = self._settled()
        if known.last is None:
            return "no map" if known.fault is None else "not settled"
        return known.last.kind

    @property
    def proved(self) -> bool:
        """Whether no map is better, if something was minimised."""
        known = self._settled()
        return known.fault is None if known.last is None else known.last.proved

    @property
    def cost(self) -> tuple[int, ...]:
        """What was minimised, most important first; empty if nothing was, or there is no map."""
        last = self._settled().last
        return () if last is None else last.cost

    def in_the_way(self) -> list[str] | None:
        """Where it is proved that there is no closed map, and closed or optimal ones were asked
        for: what, if it alone is taken away, lets one through, ``path_axiom``, ``boundary``,
        ``perpendicular``, ``planar``, ``euler`` or ``bound``. It is found by trying, within a small
        budget of counted work; what is not named is open. None where the question does not
        arise. Raises Stopped if a command or its time limit ends that."""
        kind = self.kind
        none = kind == "no map" and (self._optimal or "closed" in self.query.parts)
        if self.fault is not None or not (none or kind == "best so far"):
            return None
        self._watch.ended = None  # the search itself has come to its end
        return in_the_way(self.experience, self.query, self._watch)

    @property
    def by(self) -> str | None:
        """Which way gave the maps: "clingo", or "search"; None as long as none has begun."""
        self._settled()
        return self._watch.by

    @property
    def least(self) -> tuple[int, ...] | None:
        """What each map costs at least, as far as it is proved, if something was minimised; or
        None, also where the map that is given is not closed, but may not be the optimal one."""
        known = self._settled()
        if known.last and known.last.open:
            return None
        least = self.cost if known.last and known.last.proved else self._watch.least
        return least or None

    def __repr__(self) -> str:
        """What is known by now; nothing is looked for."""
        known = self._known
        if known.fault == UNFINISHED:
            many = number(known.count, "map", "maps")
            told = f"{many} so far, not finished" if known.begun else "not begun"
        elif known.last:
            told = f"{known.count} {known.last.kind}"
        else:
            told = "no map" if known.fault is None else "no map found"
        partial = known.fault not in (None, UNFINISHED)
        return f"<Answer: {told}{f', partial: {known.fault}' if partial else ''}>"


def _search(
    known: _Known,
    coming: Generator[Found, None, None],
    limit: int | None,
    watch: Watch | None,
) -> Generator[Map, None, None]:
    """The maps as they come; what is known of them is noted before each one is handed out. It
    is complete only if it came to its end by itself."""
    known.begun = True
    try:
        with contextlib.closing(coming), Attempt() as attempt:
            for found in proved_or_last(coming):
                if known.count == limit:
                    raise Stopped("limit")
                one = known.add(found)
                with _at_rest(watch):
                    yield one
        known.fault = attempt.fault
    except GeneratorExit:
        known.fault = CLOSED if known.fault == UNFINISHED else known.fault
        raise
    except KeyboardInterrupt:
        known.fault = INTERRUPT
        raise
    except BaseException as error:
        known.fault = str(error) or type(error).__name__
        raise


def _at_rest(watch: Watch | None) -> AbstractContextManager[None]:
    """While the caller has control, the time limit waits."""
    return watch.deadline.waiting() if watch else contextlib.nullcontext()


def _enough(part: slice) -> int | None:
    """How many of the first maps have all those of a slice; None if only all have them."""
    ends = [None if end is None else operator.index(end) for end in (part.start, part.stop)]
    if any(end is not None and end < 0 for end in ends):
        return None
    start, stop = ends
    if part.step is None or operator.index(part.step) > 0:
        return stop
    return None if start is None else start + 1
