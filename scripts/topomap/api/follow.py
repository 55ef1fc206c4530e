"""Following an exploration as it happens."""

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
        """How many hypotheses there are; None if they were not counted.

        If ``exact`` is false, there are more than this number.
        """
        return self.answer.status.hypotheses

    @property
    def exact(self) -> bool:
        """Whether ``hypotheses`` is the exact number."""
        return self.answer.status.exact

    @property
    def none_since(self) -> int | None:
        """The first step after which there is no hypothesis; None if there still are some."""
        return self.answer.status.none_since

    @cached_property
    def best(self) -> list[Map]:
        """The best maps.

        They are the closed maps with the fewest exceptions to consistent boundaries, then the
        fewest paths, then the fewest places. If no map is closed, they are those that are best so
        far, which may have pending gateways. ``all_best`` says whether they are proved to be all.
        """
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
        """What the best maps are.

        It is "optimal" or "best so far"; "not proved to be best", if only some of the hypotheses
        are kept because there are too many; "no map", if it is proved that there is none; otherwise
        "not settled".
        """
        status = self.answer.status
        return status.kind or ("no map" if status.all_best else "not settled")

    @property
    def cost(self) -> tuple[int, ...]:
        """The cost of each best map: its exceptions, paths and places; empty if there is no map."""
        return self.answer.status.cost

    @property
    def certain(self) -> Certain:
        """What is certain by now: it holds in all hypotheses (it is a cautious consequence).

        ``same`` has pairs of steps after which the agent was at one place. ``new`` has steps that
        came to a place for the first time. ``linked`` has gateways (T, S, U, R) that are joined:
        slot S of the place after step T to slot R of the place after step U, counted clockwise from
        the gateway where the agent stood.
        """
        return self.answer.certain

    @property
    def new(self) -> Certain:
        """The part of ``certain`` that was not certain before this step."""
        return self.answer.new

    @property
    def next(self) -> Plan | None:
        """What to do next: what ``explore`` says of the best maps.

        It has ``kind``, ``turns``, ``drop``, ``left`` and ``proved``. It is None if no walk was
        found; whether there is one is then open.
        """
        return self.answer.plan

    @property
    def fault(self) -> str | None:
        """Why something is missing; None if nothing is missing."""
        return self.answer.fault

    @property
    def complete(self) -> bool:
        """Whether nothing is missing."""
        return self.fault is None

    def lines(self, seconds: float) -> Iterator[str]:
        """What is known as the lines that ``topomap follow`` prints.

        Parameters:
            seconds: The number of seconds that it took, which the first line reports.

        Returns:
            The lines.
        """
        return self.answer.lines(seconds)

    def document(self) -> dict[str, Any]:
        """What is known as ``topomap follow --json`` writes it.

        The seconds, and the keys that all answers have (``docs/formats.md``), are not in it.
        """
        return self.answer.document()

    def __repr__(self) -> str:
        many = "hypotheses not counted"
        if self.hypotheses is not None:
            more = "" if self.exact else "more than "
            many = more + number(self.hypotheses, "hypothesis", "hypotheses")
        return f"<step {self.step}: {many}{f', partial: {self.fault}' if self.fault else ''}>"


class Follower:
    """An exploration that goes on step by step; the last steps can be taken back."""

    def __init__(self, following: Following, timeout: float | None = None):
        self._following, self._timeout = following, timeout

    @property
    def record(self) -> Record:
        """The steps that were given so far."""
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
        """Give the next step, and find out what is known after it.

        Parameters:
            view: The slots of the gateways that are seen, from 0 to slots - 1, counted clockwise
                from the gateway where the agent stands, which has slot 0.
            turn: The slot of the gateway by which the agent left the place before, counted
                clockwise from the one where it stood; None for the first view, where the
                exploration starts.
            landmarks: The landmarks that are seen, as terms of clingo, such as ``"a"``.
            drop: Whether the marker is put down here; for a marker that has a name, the name.
            pick: Whether the marker is taken up here, or its name.
            marker: Whether the marker is seen here, or its name.
            compass: The compass slot to which the gateway points where the agent stands.
            shift: How far this step moved the agent, as (x, y), in whole numbers of any unit.
            length: How long this step was, in whole numbers of any unit.
            same: Earlier steps after which the agent was at this place.
            apart: Earlier steps after which the agent was at another place.
            straight: The pairs of slots of the view whose gateways are on one path. Either the
                first view and the later ones have them, or none has; None for a later view means
                that no two gateways are on one path.
            start: Whether a new log of the same world begins here. Then there is no turn.
            look: Whether this step is not a travel but a second look. Then there is no turn.
            watch: The watch of a command; then the time limit of the follower is not used.

        Returns:
            What is known after the step.

        Raises:
            ValueError: Such a step is impossible. Nothing has changed.
            TypeError: ``view`` or ``landmarks`` is not a collection. Nothing has changed.
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
        """Take the last steps back.

        Parameters:
            steps: How many steps to take back. The first view cannot be taken back.
            watch: The watch of a command; then the time limit of the follower is not used.

        Returns:
            What is known then.

        Raises:
            ValueError: There are not as many steps.
        """
        for _ in self.take(self.record.undone(integer("steps", steps))):
            pass
        return self.status(watch)

    def take(self, record: Record) -> Iterator[int]:
        """Go to the steps of a record.

        Parameters:
            record: The steps.

        Yields:
            The number of each step on the way at which it stops; ``status`` tells what is known
            there.
        """
        return self._following.take(record)

    def status(self, watch: Watch | None = None) -> FollowerStatus:
        """Tell what is known now.

        Parameters:
            watch: The watch of a command; then the time limit of the follower is not used.

        Returns:
            What is known.

        Raises:
            ValueError: There is no step yet.
        """
        if self._following.solver is None:
            raise ValueError("no step yet")
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
    """Follow an exploration as it happens (its hypotheses are those of the paper, section II).

    Parameters:
        slots: The number of directions at each place, an even number; None if a line will give it.
        bound: The largest number of places that a map may have.
        marker: Whether the agent carries a marker, which the next steps may use.
        count_limit: The largest number of hypotheses that is counted. If there are more, only that
            is reported.
        timeout: The number of seconds that the answer to a step may take.
        drift: By how many percent of the way shifts may be wrong; 10 by default.
        stretch: By how many percent lengths of one way may differ; 10 by default.
        tolerance: By how many slots bearings may be wrong; 0 by default.
        parts: The demands on the maps: ``planar``; and ``no_path_axiom``, by which a path may
            contain a place twice, and may be circular.

    Returns:
        A follower. Its ``step(view)`` takes the first view, and ``step(view, turn)`` each later
        one.

    Raises:
        ValueError: A part is not known, or a number is out of its range.
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
