"""An exploration that is followed as it happens."""

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import OnlineParts, asked_of
from topomap.model.experience import MOST_SLOTS
from topomap.model.found import Found
from topomap.model.words import number
from topomap.questions.explore import Plan
from topomap.questions.follow import Following, StepAnswer
from topomap.questions.records import Record
from topomap.runtime.checks import collection, flag, integer, seconds, whole, whole_if_given
from topomap.runtime.limits import DRIFT, MOST_COUNTED, STRETCH
from topomap.runtime.watch import Watch
from topomap.search.certainty import Certain


class FollowerStatus:
    """What is known after a step."""

    def __init__(self, answer: StepAnswer):
        self.answer = answer

    @property
    def step(self) -> int:
        """How many steps there are; 0 after the first view."""
        return self.answer.status.step

    @property
    def hypotheses(self) -> int | None:
        """How many hypotheses there are: all of them if ``exact``, else there are more than that.
        None if they were not counted."""
        return self.answer.status.hypotheses

    @property
    def exact(self) -> bool:
        """Whether ``hypotheses`` is their number."""
        return self.answer.status.exact

    @property
    def none_since(self) -> int | None:
        """The first step after which there is no hypothesis; None if none is known."""
        return self.answer.status.none_since

    @cached_property
    def best(self) -> list[Map]:
        """The best maps: the closed ones with the fewest exceptions to consistent boundaries, then
        the fewest paths, then the fewest places; if no map is closed, the best so far, pending
        gateways allowed. See ``all_best``."""
        status = self.answer.status
        return [
            Map(
                self.answer.experience,
                Found(at, status.kind or "", status.cost),
                which,
                len(status.best),
                status.all_best,
            )
            for which, at in enumerate(status.best, 1)
        ]

    @property
    def all_best(self) -> bool:
        """Whether ``best`` are proved to be all the best maps."""
        return self.answer.status.all_best

    @property
    def kind(self) -> str:
        """What the best maps are: "optimal" or "best so far"; "not proved to be best", where only
        some of the hypotheses are kept, because they are too many; "no map", if it is proved that
        there is none; else "not settled"."""
        status = self.answer.status
        return status.kind or ("no map" if status.all_best else "not settled")

    @property
    def cost(self) -> tuple[int, ...]:
        """What each of the best maps costs: its exceptions, paths and places; empty if there is
        none."""
        return self.answer.status.cost

    @property
    def certain(self) -> Certain:
        """What is certain by now: ``same``, pairs of steps after which the agent was at one place;
        ``new``, steps that came to a place for the first time; ``linked``, gateways (T, S, U, R)
        that are joined, slot S of where it was after step T to slot R of where it was after U,
        counted clockwise of the gateway stood at then."""
        return self.answer.certain

    @property
    def new(self) -> Certain:
        """What of that was not certain before this step."""
        return self.answer.new

    @property
    def next(self) -> Plan | None:
        """What to do next: what ``explore`` says of the best maps (``kind``, ``turns``, ``drop``,
        ``left`` and ``proved``). None if no walk was found; whether there is one is then open."""
        return self.answer.plan

    @property
    def fault(self) -> str | None:
        """Why something is missing; None if nothing is."""
        return self.answer.fault

    @property
    def complete(self) -> bool:
        """Whether nothing is missing."""
        return self.fault is None

    def lines(self, seconds: float) -> Iterator[str]:
        """What is known, to read, as ``topomap follow`` prints it; it took so many seconds."""
        return self.answer.lines(seconds)

    def document(self) -> dict[str, Any]:
        """What is known as ``topomap follow --json`` writes it, but for the seconds that it took
        and the keys that all answers have (``docs/formats.md``)."""
        return self.answer.document()

    def __repr__(self) -> str:
        many = "hypotheses not counted"
        if self.hypotheses is not None:
            more = "" if self.exact else "more than "
            many = more + number(self.hypotheses, "hypothesis", "hypotheses")
        return f"<step {self.step}: {many}{f', partial: {self.fault}' if self.fault else ''}>"


class Follower:
    """An exploration that goes on, step by step; the last steps can be taken back."""

    def __init__(self, following: Following, timeout: float | None = None):
        self._following, self._timeout = following, timeout

    @property
    def record(self) -> Record:
        """What is known of the steps."""
        return self._following.record

    def step(
        self,
        view: Iterable[int],
        turn: int | None = None,
        landmarks: Iterable[str] = (),
        *,
        drop: bool | str = False,
        pick: bool | str = False,
        marker: bool | str = False,
        compass: int | None = None,
        shift: tuple[int, int] | None = None,
        length: int | None = None,
        same: Iterable[int] = (),
        apart: Iterable[int] = (),
        straight: Iterable[tuple[int, int]] | None = None,
        start: bool = False,
        look: bool = False,
        watch: Watch | None = None,
    ) -> FollowerStatus:
        """Go a step on.

        Parameters:
            view: the slots of the gateways that are seen, clockwise of the one stood at, which is
                0, from 0 to slots - 1.
            turn: the slot of the gateway by which the agent left where it was before, clockwise
                of the one where it stood; None for the first view, where the exploration starts.
            landmarks: the landmarks that are seen, as terms of clingo, such as ``"a"``.
            drop: whether the marker is put down here; of a marker that has a name, the name.
            pick: whether the marker is taken up here, or the name.
            marker: whether the marker is seen here, or the name.
            compass: the compass slot to which the gateway stood at points.
            shift: how far this step moved the agent, as (x, y), in whole numbers of any unit.
            length: how long this step was, in whole units.
            same: earlier steps after which the agent was at this place.
            apart: earlier steps after which it was at another place.
            straight: the pairs of slots of the view whose gateways are on one path. The
                first view tells them, or no view does; None of a later view: there are none.
            start: whether a new log of the same world begins here; then there is no turn.
            look: whether it is no travel but a second look; then there is no turn.
            watch: that of a command; then the time limit is not used.

        Returns:
            What is known now.

        Raises:
            ValueError: there can be no such step.
            TypeError: a view, or landmarks, that are no collection. With either error nothing
                has changed.
        """
        data: dict[str, Any] = {
            "view": [integer("view: slot", slot) for slot in collection("view", view)],
            "landmarks": list(collection("landmarks", landmarks)),
        }
        data |= {"drop": drop, "pick": pick, "marker": marker}
        known = {"compass": compass, "length": length}
        data |= {name: integer(name, one) for name, one in known.items() if one is not None}
        if shift is not None:
            data["shift"] = [integer("shift", one) for one in collection("shift", shift)]
        if straight is not None:
            pairs = [collection("straight", pair) for pair in collection("straight", straight)]
            data["straight"] = [[integer("straight", slot) for slot in pair] for pair in pairs]
        lists = {"same": same, "apart": apart}
        data |= {
            name: [integer(name, one) for one in given]
            for name, of in lists.items()
            if (given := [*collection(name, of)])
        }
        data |= {
            name: True for name, told in (("start", start), ("look", look)) if flag(name, told)
        }
        data |= {} if turn is None else {"turn": integer("turn", turn)}
        for _ in self.take(self.record.with_object(data)):
            pass
        return self.status(watch)

    def undo(self, steps: int = 1, *, watch: Watch | None = None) -> FollowerStatus:
        """Take the last steps back, and return what is known then. Raises ValueError if there are
        not as many; the first view cannot be taken back."""
        for _ in self.take(self.record.undone(integer("steps", steps))):
            pass
        return self.status(watch)

    def take(self, record: Record) -> Iterator[int]:
        """Go to what a record says; the steps at which it stands on the way, of each of which
        ``status`` tells."""
        return self._following.take(record)

    def status(self, watch: Watch | None = None) -> FollowerStatus:
        """What is known now. Raises ValueError before the first step."""
        if self._following.solver is None:
            raise ValueError("no step as yet")
        return FollowerStatus(self._following.answer(watch or Watch(self._timeout)))


def follow(
    slots: int | None = None,
    *,
    bound: int | None = None,
    marker: bool = False,
    count_limit: int = MOST_COUNTED,
    timeout: float | None = None,
    drift: int | None = None,
    stretch: int | None = None,
    tolerance: int | None = None,
    **parts: Unpack[OnlineParts],
) -> Follower:
    """Follow an exploration as it happens (the hypotheses and the best maps are those of the
    paper, sections II and III).

    Parameters:
        slots: the number of directions at each place, even; None if a line will tell it.
        bound: the most places that a map may have.
        marker: whether the agent carries a marker, for what to do next.
        count_limit: of more hypotheses it is only told that they are more.
        timeout: seconds that the answer to a step may take.
        drift: how far shifts may be wrong, in percent of the way; 10 by default.
        stretch: how far lengths of one way may differ, in percent; 10 by default.
        tolerance: by how many slots bearings may be wrong; 0 by default.
        parts: what the maps are to have: ``planar``; and ``no_path_axiom``, that a path may hold a
            place twice, and may be circular.

    Returns:
        A follower, to which the first view is told by ``step(view)``, the next ones by
        ``step(view, turn)``.

    Raises:
        ValueError: an unknown part, or a number that cannot be.
    """
    asked = asked_of(parts, OnlineParts.__annotations__)
    planar, path_axiom = "planar" in asked, "no_path_axiom" not in asked
    bound, count_limit = whole_if_given("bound", bound, 1), whole("count_limit", count_limit, 1)
    following = Following(planar, bound, flag("marker", marker), count_limit, path_axiom)
    following.record = Record(
        drift=DRIFT if drift is None else whole("drift", drift, 0),
        stretch=STRETCH if stretch is None else whole("stretch", stretch, 0),
        tolerance=0 if tolerance is None else whole("tolerance", tolerance, 0),
        one_log=planar,
    )
    if slots is not None:
        following.record = following.record.with_slots(whole("slots", slots, 2, MOST_SLOTS))
    return Follower(following, seconds("timeout", timeout))
