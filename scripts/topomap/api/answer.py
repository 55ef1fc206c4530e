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

CLOSED = "closed"  # why an answer is partial that the caller has closed
UNFINISHED = "not finished"


class _Known:
    """What is known of an answer by now.

    It is separate from the answer, so that the search does not hold a reference to the answer, and
    ends when nobody else holds one.
    """

    def __init__(self, experience: Experience, query: Query):
        self._experience, self._noisy = experience, query.noise is not None
        self.keeps = True
        self.maps: list[Map] = []
        self.count = 0
        self.last: Found | None = None
        self.begun = False
        self.fault: str | None = UNFINISHED

    def add(self, found: Found) -> Map:
        """Note one more map; how many there will be is not known."""
        self.count += 1
        self.last = found
        made = Map(self._experience, found, self.count, 0, noisy=self._noisy)
        if self.keeps:
            self.maps.append(made)
        return made


class Answer(Sequence[Map]):
    """The maps that were asked for, which can be read while further maps are being found.

    A loop over the answer goes on while maps are found. Its length, ``complete``, ``kind``,
    ``cost`` and ``fault`` wait for the last map. The maps are kept, so that the answer can be read
    again, also by several threads. The search begins with the first map that is asked for. It ends
    when the answer is no longer in use, at ``close``, or at the end of a ``with`` statement.
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
        """Make an answer of a search, which has not begun.

        Parameters:
            experience: What the agent saw and did.
            query: What is asked of the maps.
            coming: The maps as the search finds them.
            limit: The number of maps after which the search stops.
            watch: The watch under which the maps are found.
            waits: Whether the time limit of the watch stops while the caller has control. That of a
                command does not.
            optimal: Whether the optimal maps were asked for, and not all.
        """
        self.experience, self.query, self._optimal = experience, query, optimal
        self._watch = watch or Watch()
        self._known = _Known(experience, query)
        self._search = _search(self._known, coming, limit, self._watch if waits else None)
        self._one_at_a_time = threading.RLock()

    def stream(self) -> Iterator[Map]:
        """Give each map as it is found, without keeping it, where all maps need too much memory.

        From then on the answer has no length and no maps of its own, and ``complete``, ``kind``,
        ``cost`` and ``fault`` say what is known at that time.

        Returns:
            An iterator over the maps.

        Raises:
            ValueError: Maps were asked for before.
        """
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
        """End the search, even if another thread is waiting for it.

        The maps that were found until then are kept. If there may be others, ``fault`` is "closed".
        """
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
        """Find the map at a position, counted from 0; None if there are not as many."""
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
        """Find a map, or those of a slice; no map is looked for that these do not need."""
        if isinstance(index, slice):
            enough = _enough(index)
            return (self._all() if enough is None else [*islice(self, enough)])[index]
        place = operator.index(index)
        one = self._at(place) if place >= 0 else None
        return self._all()[place] if one is None else one

    def __len__(self) -> int:
        return len(self._all())

    def __bool__(self) -> bool:
        """Whether there is a map; only the first map is looked for."""
        return self._at(0) is not None

    def _settled(self) -> _Known:
        if self._known.keeps:
            self._all()
        return self._known

    @property
    def fault(self) -> str | None:
        """Why these may not be all the maps that were asked for; None if they are all.

        It is "limit", "timeout", "out of memory", "closed", "interrupted", or the text of an error.
        """
        return self._settled().fault

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no other maps."""
        return self.fault is None

    @property
    def kind(self) -> str:
        """What the maps are.

        They are "consistent", "best", "optimal", "best so far", "circumscribed", "circumscribed so
        far", or "not proved to be best". It is "no map" if it is proved that there is none, and
        "not settled" if none was found before the search was cut short.
        """
        known = self._settled()
        if known.last is None:
            return "no map" if known.fault is None else "not settled"
        return known.last.kind

    @property
    def proved(self) -> bool:
        """Whether it is proved that no map is better, if something was minimised."""
        known = self._settled()
        return known.fault is None if known.last is None else known.last.proved

    @property
    def cost(self) -> tuple[int, ...]:
        """What was minimised, the most important number first; empty if nothing was.

        It is empty, too, if there is no map.
        """
        last = self._settled().last
        return () if last is None else last.cost

    def in_the_way(self) -> list[str] | None:
        """Find out which default or part alone stands in the way of a closed map.

        The question arises if closed or optimal maps were asked for, and it is proved that there is
        no closed one. The answer is found by trying, within a small budget of counted work; what is
        not named is open.

        Returns:
            Those of ``path_axiom``, ``boundary``, ``perpendicular``, ``planar``, ``euler`` and
            ``bound`` without which there is a closed map; None if the question does not arise.

        Raises:
            Stopped: A command or its time limit ends the trying.
        """
        kind = self.kind
        none = kind == "no map" and (self._optimal or "closed" in self.query.parts)
        if self.fault is not None or not (none or kind == "best so far"):
            return None
        self._watch.ended = None  # the search itself has ended
        return in_the_way(self.experience, self.query, self._watch)

    @property
    def by(self) -> str | None:
        """Which way found the maps, "clingo" or "search"; None if neither has begun."""
        self._settled()
        return self._watch.by

    @property
    def least(self) -> tuple[int, ...] | None:
        """A proved lower bound on what each map costs, if something was minimised.

        It is None if no bound is proved, and where the map that was found is not closed and may not
        be optimal.
        """
        known = self._settled()
        if known.last and known.last.open:
            return None
        least = self.cost if known.last and known.last.proved else self._watch.least
        return least or None

    def __repr__(self) -> str:
        """What is known by now; no map is looked for."""
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
    """Give the maps as they are found.

    What is known of a map is noted before it is given. The answer is complete only if this
    generator came to its end by itself.
    """
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
    """Stop the clock of the time limit while the caller has control."""
    return watch.deadline.waiting() if watch else contextlib.nullcontext()


def _enough(part: slice) -> int | None:
    """How many of the first maps contain all those of a slice; None if all maps are needed."""
    ends = [None if end is None else operator.index(end) for end in (part.start, part.stop)]
    if any(end is not None and end < 0 for end in ends):
        return None
    start, stop = ends
    if part.step is None or operator.index(part.step) > 0:
        return stop
    return None if start is None else start + 1
