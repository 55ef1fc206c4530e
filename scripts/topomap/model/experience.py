"""Experiences: what an agent does and sees during an exploration."""

from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any, TypeVar

from topomap.model.terms import spelt
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime.checks import collection, integer, shown, whole, whole_if_given
from topomap.runtime.errors import printable
from topomap.runtime.limits import DRIFT, STRETCH

DState = tuple[int, int]
Misread = tuple[int, int | str]  # a step, and a gateway or a landmark that was missed or imagined
MOST_SLOTS = 10**6  # sums of slots then stay below clingo's largest number
MARKER = ("drop", "pick", "marker")
Shift = tuple[int, int]  # how far a step moved the agent, in one fixed frame
Thing = tuple[str, int, str]  # one of MARKER, a step, and the name of a marker
Visits = tuple[int, int]  # two visits, each named by its step, the earlier one first
Slots = tuple[int, int]  # the slots of two gateways of one visit, the lower one first


@dataclass(frozen=True)
class Step:
    """What is known of one step, which may be incomplete while its facts arrive.

    ``turn`` is None for step 0, where the exploration begins, and for a step that is not a travel:
    the beginning of a new log (``start``), or a second look (``look``). ``marks`` are those of
    MARKER that hold after the step, and ``things`` is what is done with markers that have names.
    ``same`` and ``apart`` are the earlier steps after which the agent was at this place, or at
    another one. The other attributes are as in ``Experience``.
    """

    turn: int | None = None
    view: frozenset[int] = frozenset()
    landmarks: frozenset[str] = frozenset()
    marks: frozenset[str] = frozenset()
    compass: int | None = None
    shift: Shift | None = None
    length: int | None = None
    same: frozenset[int] = frozenset()
    apart: frozenset[int] = frozenset()
    start: bool = False
    look: bool = False
    things: frozenset[tuple[str, str]] = frozenset()  # one of MARKER, and the name
    straight: frozenset[Slots] | None = None  # None if no pairs of gateways are given


@dataclass(frozen=True, init=False)
class Experience:
    """An exploration of ``len(turns)`` steps (semantics: "Experience"; the paper, section II).

    ``views[t]`` and ``landmarks[t]``, for t = 0..n, are what is seen after step t: slots, counted
    clockwise from the gateway where the agent stands, and landmarks as terms of clingo, such as
    ``"pub"``. ``turns[t - 1]`` is the turn of step t, in slots clockwise. ``drops``, ``picks`` and
    ``markers`` are the steps after which the marker is put down, taken up and seen. Lists are
    accepted, too: ``Experience(4, [[0], [0, 1], [0]], [0, 1])``. What is kept is plain: numbers are
    ``int``, and landmarks are spelt as clingo spells them.

    More can be known besides views (semantics: "A compass", "Odometry", "Asserted, and ruled out").
    ``compass[t]`` is the compass slot to which the gateway points where the agent stands after step
    t. ``shifts[t - 1]`` is how far step t moved the agent, and ``lengths[t - 1]`` is how long it
    was. An entry is None for a step without such a value, and the whole is empty if no step has
    one. ``same`` and ``apart`` are pairs of visits that are known to be of one place, or of
    two. Shifts may be wrong by ``drift`` percent of the way, and lengths by ``stretch`` percent.
    ``assumed`` is what else is taken for granted (``topomap.assume``): the terms of statements,
    each with whether it holds.

    Not every step is a travel (semantics: "Several logs, a second look"). A new log of the same
    world begins at the steps ``starts``, and the agent looks a second time at the steps ``looks``;
    the turn of both is None. ``things`` is what is done with markers that have names, besides the
    marker that has none: ``("drop", 4, "coin")``.

    ``straight[t]`` has the pairs of gateways, as slots of ``views[t]``, that are on one path
    (semantics: "Which gateways are on one path"). A gateway that is in no pair ends its path. If
    ``straight`` is empty, opposite gateways are on one path. Bearings may be wrong by ``tolerance``
    slots (semantics: "Bearings that are not exact").
    """

    slots: int
    views: tuple[frozenset[int], ...]
    turns: tuple[int | None, ...]
    landmarks: tuple[frozenset[str], ...]
    drops: frozenset[int]
    picks: frozenset[int]
    markers: frozenset[int]
    compass: tuple[int | None, ...]
    shifts: tuple[Shift | None, ...]
    lengths: tuple[int | None, ...]
    same: frozenset[Visits]
    apart: frozenset[Visits]
    drift: int
    stretch: int
    assumed: frozenset[tuple[str, bool]]
    starts: frozenset[int]
    looks: frozenset[int]
    things: frozenset[Thing]
    straight: tuple[frozenset[Slots], ...]
    tolerance: int

    def __init__(
        self,
        slots: int,
        views: Iterable[Iterable[int]],
        turns: Iterable[int | None],
        landmarks: Iterable[Iterable[str]] | None = None,
        drops: Iterable[int | tuple[int, str]] = (),
        picks: Iterable[int | tuple[int, str]] = (),
        markers: Iterable[int | tuple[int, str]] = (),
        *,
        compass: Iterable[int | None] = (),
        shifts: Iterable[Shift | None] = (),
        lengths: Iterable[int | None] = (),
        same: Iterable[Visits] = (),
        apart: Iterable[Visits] = (),
        drift: int = DRIFT,
        stretch: int = STRETCH,
        assumed: Iterable[tuple[str, bool]] = (),
        starts: Iterable[int] = (),
        looks: Iterable[int] = (),
        things: Iterable[Thing] = (),
        straight: Iterable[Iterable[Slots]] = (),
        tolerance: int = 0,
    ):
        """Note what was seen and done.

        Whether it is possible is checked when the experience is first used. An InputError then
        names the step, as it does for a file.

        Parameters:
            slots: The number of directions at each place.
            views: The slots that are seen after each step, from 0.
            turns: The turn of each step, from 1, in slots clockwise.
            landmarks: The landmarks that are seen after each step, from 0; none by default.
            drops: The steps after which the marker is put down; for a marker that has a name, pairs
                such as ``(4, "coin")`` of the step and the name.
            picks: The steps after which the marker is taken up, or such pairs.
            markers: The steps after which the marker is seen, or such pairs.
            compass: The compass slot of the gateway where the agent stands after each step, from 0,
                or None; by default no step has one.
            shifts: How far each step, from 1, moved the agent, as (x, y) in whole numbers of any
                unit, or None; by default no step has one.
            lengths: How long each step was, in whole numbers of any unit, or None; by default no
                step has one.
            same: Pairs of steps after which the agent was at one place.
            apart: Pairs of steps after which the agent was at two places.
            drift: By how many percent of the way shifts may be wrong.
            stretch: By how many percent lengths of one way may differ.
            assumed: What ``topomap.assume`` has added: statements, as terms that
                ``encodings/query.lp`` knows, each with whether it holds.
            starts: The steps, from 1, at which a new log of the same world begins. Their turn is
                None.
            looks: The steps, from 1, that are not a travel but a second look. Their turn is None.
            things: What is done with markers that have names, in the form in which it is kept:
                ``("drop", step, name)``, or ``"pick"`` or ``"marker"``; a name is a term of clingo.
            straight: The pairs of slots whose gateways are on one path, for each visit, from 0; by
                default those of opposite gateways.
            tolerance: By how many slots bearings may be wrong.

        Raises:
            ValueError: The number of views is not one more than that of turns, or that of the sets
                of landmarks is another one; a slot or a step is not a whole number; there is no
                such step; or a landmark is not a ground term of clingo.
            TypeError: Something else, such as a text, is given where a collection is wanted.
        """
        seen = tuple(
            frozenset(view if _is_plain(view, int) else _slots(f"views[{step}]", view))
            for step, view in enumerate(collection("views", views))
        )
        done = _turns(turns)
        signs = (frozenset[str](),) * len(seen)
        if landmarks is not None:
            signs = tuple(
                frozenset(of) if _is_plain(of) else _terms(f"landmarks[{step}]", of)
                for step, of in enumerate(collection("landmarks", landmarks))
            )
        if not len(done) + 1 == len(seen) == len(signs):
            told = f"{len(seen)} views, {len(done)} turns, landmarks after {len(signs)} steps"
            raise ValueError(f"{told}: n turns need n + 1 views")
        marks: list[frozenset[int]] = []
        named: list[Any] = []
        for kind, name, of in zip(
            MARKER, ("drops", "picks", "markers"), (drops, picks, markers), strict=True
        ):
            alone = []
            for mark in collection(name, of):
                if isinstance(mark, tuple | list):
                    named.append((kind, *mark))
                else:
                    alone.append(whole(f"{name}: step", mark, 0, len(done)))
            marks.append(frozenset(alone))
        many = len(seen)
        rests = [
            frozenset(whole(f"{name}: step", step, 1, len(done)) for step in collection(name, of))
            for name, of in (("starts", starts), ("looks", looks))
        ]
        still = {step for step, turn in enumerate(done, 1) if turn is None}
        if rests[0] & rests[1] or rests[0] | rests[1] != still:
            raise ValueError(
                "turns: the turn is None at the steps of starts and looks, and only there"
            )
        north = _each("compass", compass, many, integer)
        moved = _each("shifts", shifts, many - 1, _shift)
        measured = _each("lengths", lengths, many - 1, integer)
        pairs = [_pairs(name, of, len(done)) for name, of in (("same", same), ("apart", apart))]
        percents = whole("drift", drift, 0), whole("stretch", stretch, 0)
        every = [_thing(thing, len(done)) for thing in [*named, *collection("things", things)]]
        values = (
            *(integer("slots", slots), seen, done, signs, *marks),
            *(north, moved, measured, *pairs, *percents, _assumed(assumed)),
            *(
                *rests,
                frozenset(every),
                _straight(straight, many),
                whole("tolerance", tolerance, 0),
            ),
        )
        for one, value in zip(fields(self), values, strict=True):
            object.__setattr__(self, one.name, value)

    @property
    def steps(self) -> int:
        """The number of steps.

        At step 0, where the exploration starts, the agent has seen the first view but has not
        moved.
        """
        return len(self.turns)

    def cut(self, horizon: int) -> "Experience":
        """Cut the experience after a step.

        Parameters:
            horizon: The last step to keep.

        Returns:
            The beginning of the experience.
        """
        marks = {
            name: frozenset(step for step in getattr(self, name) if step <= horizon)
            for name in ("drops", "picks", "markers", "starts", "looks")
        }
        things = frozenset(thing for thing in self.things if thing[1] <= horizon)
        pairs = {
            name: frozenset(pair for pair in getattr(self, name) if max(pair) <= horizon)
            for name in ("same", "apart")
        }
        return self._but(
            views=self.views[: horizon + 1],
            turns=self.turns[:horizon],
            landmarks=self.landmarks[: horizon + 1],
            compass=_told(self.compass[: horizon + 1]),
            shifts=_told(self.shifts[:horizon]),
            lengths=_told(self.lengths[:horizon]),
            things=things,
            straight=self.straight[: horizon + 1],
            **marks,
            **pairs,
        )

    def within(
        self,
        drift: int | None = None,
        stretch: int | None = None,
        tolerance: int | None = None,
    ) -> "Experience":
        """Say by how much what was measured may be wrong.

        Parameters:
            drift: By how many percent of the way shifts may be wrong; None to leave it as it is.
            stretch: By how many percent lengths of one way may differ; None to leave it as it is.
            tolerance: By how many slots bearings may be wrong; None to leave it as it is.

        Returns:
            The same experience with these limits.
        """
        changed = {
            "drift": whole_if_given("drift", drift, 0),
            "stretch": whole_if_given("stretch", stretch, 0),
            "tolerance": whole_if_given("tolerance", tolerance, 0),
        }
        return self._but(**{key: value for key, value in changed.items() if value is not None})

    def knowing(self, same: Iterable[Visits] = (), apart: Iterable[Visits] = ()) -> "Experience":
        """Add pairs of visits that are known to be of one place, or of two.

        Parameters:
            same: Pairs of steps after which the agent was at one place.
            apart: Pairs of steps after which the agent was at two places.

        Returns:
            The same experience with what is known.
        """
        return self._but(
            same=self.same | _pairs("same", same, self.steps),
            apart=self.apart | _pairs("apart", apart, self.steps),
        )

    def granted(self, term: str, holds: bool) -> "Experience":
        """Take a statement for granted, or its opposite.

        Parameters:
            term: The statement, as a term of ``encodings/query.lp``.
            holds: Whether it holds.

        Returns:
            The same experience with the assumption.
        """
        return self._but(assumed=self.assumed | {(term, holds)})

    def assumptions(self, as_reasons: bool = False) -> str:
        """The assumptions as facts and rules, to be used with ``encodings/query.lp``.

        Parameters:
            as_reasons: Whether the assumptions are reasons that may be given up;
                ``broken(assumed(N))`` then stands for statement N of ``sorted(assumed)``.

        Returns:
            The text of the rules.
        """
        return "".join(
            f"ask({term}). {f'broken(assumed({number})) ' * as_reasons}"
            f":- {'not ' * holds}holds({term}).\n"
            for number, (term, holds) in enumerate(sorted(self.assumed))
        )

    def constants(self) -> list[str]:
        """Tell how far shifts, lengths and bearings may be wrong.

        Returns:
            The options of clingo that say so.
        """
        told = [f"drift={self.drift}"] * bool(self.shifts)
        told += [f"stretch={self.stretch}"] * bool(self.lengths)
        # Two slots cannot be further apart than the number of slots.
        told += [f"tolerance={min(self.tolerance, self.slots)}"] * bool(self.tolerance)
        return [option for one in told for option in ("-c", one)]

    def compass_told(self) -> int:
        """Count the visits at which the compass is known.

        Returns:
            Their number.
        """
        return sum(slot is not None for slot in self.compass)

    def then(self, step: Step) -> "Experience":
        """Add a step, whose possibility the caller has checked.

        Parameters:
            step: The step.

        Returns:
            The experience with one more step.
        """
        last = self.steps + 1
        drops, picks, markers = (
            steps | {last} if name in step.marks else steps
            for name, steps in zip(MARKER, (self.drops, self.picks, self.markers), strict=True)
        )
        return self._but(
            views=(*self.views, step.view),
            turns=(*self.turns, step.turn),
            landmarks=(*self.landmarks, step.landmarks),
            drops=drops,
            picks=picks,
            markers=markers,
            compass=_longer(self.compass, last, step.compass),
            shifts=_longer(self.shifts, last - 1, step.shift),
            lengths=_longer(self.lengths, last - 1, step.length),
            same=self.same | {(earlier, last) for earlier in step.same},
            apart=self.apart | {(earlier, last) for earlier in step.apart},
            starts=self.starts | {last} if step.start else self.starts,
            looks=self.looks | {last} if step.look else self.looks,
            things=self.things | {(kind, last, name) for kind, name in step.things},
            straight=(*self.straight, step.straight or frozenset()) if self.straight else (),
        )

    def _but(self, **changed: object) -> "Experience":
        """Copy the experience with changes that are known to be plain.

        They are not checked again, because this is done for each map that is written.
        """
        made = object.__new__(Experience)
        for one in fields(self):
            object.__setattr__(made, one.name, changed.get(one.name, getattr(self, one.name)))
        return made

    @property
    def parted(self) -> bool:
        """Whether there are steps that are not a travel."""
        return bool(self.starts or self.looks)

    def names(self) -> list[str | None]:
        """List the markers.

        Returns:
            None for the marker that has no name, and the names of the others.
        """
        alone: list[str | None] = [None] * bool(self.drops or self.picks or self.markers)
        return alone + sorted({name for _, _, name in self.things})

    def marks_of(self, name: str | None) -> tuple[frozenset[int], ...]:
        """The steps after which a marker is put down, taken up and seen.

        Parameters:
            name: The name of the marker; None for the one that has none.

        Returns:
            Three sets of steps, in this order.
        """
        if name is None:
            return self.drops, self.picks, self.markers
        return tuple(
            frozenset(step for kind, step, other in self.things if (kind, other) == (mark, name))
            for mark in MARKER
        )

    def put_down(self) -> dict[str | None, int]:
        """Find the markers that lie somewhere after the last step.

        (After one step, a marker is taken up before it is put down.)

        Returns:
            For each of these markers the step after which it was put down.
        """
        told = {}
        for name in self.names():
            drops, picks, _ = self.marks_of(name)
            down = max(drops, default=-1)
            if down >= max(picks, default=0):
                told[name] = down
        return told

    def marker(self, name: str | None = None) -> tuple[tuple[int, bool] | None, ...]:
        """Tell what is known of a marker after each step.

        (An agent that takes a marker up sees it. After one step, a marker is taken up before it is
        put down.)

        Parameters:
            name: The name of the marker; None for the one that has none.

        Returns:
            For each step after which the marker lies somewhere, the step after which it was put
            down, and whether it is seen; None for the other steps.
        """
        drops, picks, markers = self.marks_of(name)
        told: list[tuple[int, bool] | None] = []
        down = None
        for step in range(self.steps + 1):
            seen = step in markers or step in picks
            told.append(None if down is None else (down, seen))
            down = None if step in picks else down
            down = step if step in drops else down
        return tuple(told)

    def lying(self) -> tuple[tuple[int, int, bool, str | None], ...]:
        """Tell what is known of markers that lie somewhere.

        Returns:
            For each marker and step, the step, the one after which it was put down, whether it is
            seen, and its name.
        """
        return tuple(
            (step, down, seen, name)
            for name in self.names()
            for step, told in enumerate(self.marker(name))
            if told
            for down, seen in [told]
        )

    def corrected(self, misread: Iterable[Misread]) -> "Experience":
        """Take back misreadings.

        Parameters:
            misread: The misreadings.

        Returns:
            The experience in which what was missed is seen, and what was imagined is not.
        """
        views, landmarks = list(self.views), list(self.landmarks)
        for step, what in misread:
            if isinstance(what, int):
                views[step] ^= {what}
            else:
                landmarks[step] ^= {what}
        return self._but(views=tuple(views), landmarks=tuple(landmarks))

    def misled(self) -> list[int]:
        """Find the steps that contradict the view.

        After these steps the agent stands at no gateway, or leaves by none, according to what it
        sees.

        Returns:
            The steps.
        """
        needs = [{0} if turn is None else {0, turn} for turn in self.turns] + [{0}]
        return [step for step, need in enumerate(needs) if not need <= self.views[step]]

    def facts(self) -> str:
        """Write the experience as facts of an instance.

        Returns:
            The facts, with one line for each step.
        """
        pairs: dict[int, list[tuple[str, int]]] = {}
        for name in ("same", "apart"):
            for one, other in sorted(getattr(self, name)):
                pairs.setdefault(other, []).append((name, one))
        lines = [f"slots({self.slots})."]
        for step in range(self.steps + 1):
            line = self.facts_of(step)
            line += [f"{name}({one},{step})." for name, one in pairs.get(step, ())]
            lines.append(" ".join(line))
        return "\n".join(lines) + "\n"

    def facts_of(self, step: int, number: int | None = None) -> list[str]:
        """The facts about a step, apart from pairs of steps.

        Parameters:
            step: The step.
            number: The number of the step in the facts, if it is another one.

        Returns:
            The facts, as texts.
        """
        named = step if number is None else number
        line = []
        if step:
            turn = self.turns[step - 1]
            rest = f"start({named})." if step in self.starts else f"look({named})."
            line.append(rest if turn is None else f"turn({named},{turn}).")
        line += [f"view({named},{slot})." for slot in sorted(self.views[step])]
        line += [f"landmark({named},{term})." for term in sorted(self.landmarks[step])]
        line += [f"marker({named})."] * (step in self.markers)
        line += [f"pick({named})."] * (step in self.picks)
        line += [f"drop({named})."] * (step in self.drops)
        line += sorted(f"{kind}({named},{name})." for kind, at, name in self.things if at == step)
        for name, numbers in self.measured(step):
            line.append(f"{name}({','.join(map(str, (named, *numbers)))}).")
        line += [f"straight({named},{one},{other})." for one, other in self._pairs_told(step)]
        return line

    def _pairs_told(self, step: int) -> list[Slots]:
        """The facts about the pairs of gateways of a visit.

        If no gateways are on one path at any visit, one fact says of a gateway of step 0 that it
        ends its path. Without this fact, opposite gateways would be taken to be on one path.
        """
        if not self.straight or step or any(self.straight):
            return sorted(self.straight[step]) if self.straight else []
        return [(slot, slot) for slot in sorted(self.views[0])[:1]]

    def measured(self, step: int) -> Iterator[tuple[str, tuple[int, ...]]]:
        """What is measured of a step.

        Parameters:
            step: The step.

        Returns:
            For each measurement the name of the fact, and its numbers without the step.
        """
        if self.compass and (slot := self.compass[step]) is not None:
            yield "compass", (slot,)
        if step and self.shifts and (shift := self.shifts[step - 1]) is not None:
            yield "shift", shift
        if step and self.lengths and (length := self.lengths[step - 1]) is not None:
            yield "length", (length,)

    def map_of(self, at: tuple[DState, ...]) -> TopologicalMap:
        """Make the map of a hypothesis.

        Parameters:
            at: The dstate after each step (``at/3``).

        Returns:
            The map.
        """
        stars = {place: self.views[place] for place, _ in at}
        links: dict[Gateway, Gateway] = {}
        for step, (before, arrival) in enumerate(pairwise(at), 1):
            if self.turns[step - 1] is not None:
                out = self.way_out(step, before)
                links[out], links[arrival] = arrival, out
        landmarks = {place: self.landmarks[place] for place in stars}
        return TopologicalMap(self.slots, stars, links, landmarks, self.across(stars))

    def across(self, places: Iterable[int]) -> dict[Gateway, Gateway] | None:
        """Tell for gateways which other gateway of their place is on the same path.

        Parameters:
            places: The places, each as the step of its first visit.

        Returns:
            The other gateway of each gateway that does not end its path; None if opposite gateways
            are on one path.
        """
        if not self.straight:
            return None
        return {
            (place, one): (place, other)
            for place in places
            for pair in self.straight[place]
            for one, other in (pair, pair[::-1])
        }

    def goes_straight(self, step: int) -> bool:
        """Tell whether a travel leaves on the path on which the agent arrived.

        Parameters:
            step: The step of the travel.

        Returns:
            Whether the gateway by which it leaves and that of the arrival are on one path.
        """
        turn = self.turns[step - 1]
        if not self.straight:
            return turn == self.slots // 2
        return bool(turn) and (0, turn) in self.straight[step - 1]

    def way_out(self, step: int, before: DState) -> DState:
        """The gateway by which a travel leaves.

        Parameters:
            step: The step of the travel.
            before: The dstate of the agent before the step.

        Returns:
            The gateway.
        """
        turn, (place, slot) = self.turns[step - 1], before
        assert turn is not None
        return place, self.slot_at(place, slot, step - 1, turn)

    def slot_at(self, place: int, slot: int, visit: int, seen: int) -> int:
        """Translate a slot of a visit into a slot of its place.

        Parameters:
            place: The place, or any other visit of it; slots are then those of that visit.
            slot: The slot of the place's gateway where the visit stands.
            visit: The visit, as its step.
            seen: The slot of a gateway, as the visit sees it.

        Returns:
            The slot of that gateway at the place. If bearings are not exact, the gateways of both
            are numbered clockwise, and correspond by these numbers.
        """
        if not self.tolerance:
            return (slot + seen) % self.slots
        star, view = sorted(self.views[place]), sorted(self.views[visit])
        return star[(star.index(slot) + view.index(seen)) % len(star)]

    def alike(self, place: int, slot: int, visit: int) -> bool:
        """Tell whether a visit sees what is seen from a gateway of a place.

        It sees as many gateways, within the tolerance, with the same pairs on one path, and the
        same landmarks.

        Parameters:
            place: The place.
            slot: The slot of the gateway.
            visit: The visit, as its step.

        Returns:
            Whether the visit can be of that place, standing at that gateway.
        """
        same = self.landmarks[place] == self.landmarks[visit]
        return same and self.looks_alike(place, slot, visit)

    def looks_alike(self, place: int, slot: int, visit: int) -> bool:
        """Tell the same as ``alike``, whatever the landmarks are.

        Parameters:
            place: The place.
            slot: The slot of the gateway.
            visit: The visit, as its step.

        Returns:
            Whether the gateways of the visit can be those of the place.
        """
        star, view = self.views[place], self.views[visit]
        if len(star) != len(view):
            return False
        there = {seen: self.slot_at(place, slot, visit, seen) for seen in view}
        if any(other not in star for other in there.values()):
            return False
        off = ((other - slot - seen) % self.slots for seen, other in there.items())
        if any(min(wrong, self.slots - wrong) > self.tolerance for wrong in off):
            return False
        here = {frozenset(there[seen] for seen in pair) for pair in self.pairs(visit)}
        return here == {*map(frozenset, self.pairs(place))}

    def pairs(self, visit: int) -> Iterable[Slots]:
        """The pairs of gateways of a visit that are on one path.

        Parameters:
            visit: The visit, as its step.

        Returns:
            The pairs of slots.
        """
        if self.straight:
            return self.straight[visit]
        half, view = self.slots // 2, self.views[visit]
        return [(slot, slot + half) for slot in view if slot + half in view]


T = TypeVar("T")


def _told(values: tuple[T | None, ...]) -> tuple[T | None, ...]:
    """Keep the values, or nothing if all of them are None."""
    return values if any(value is not None for value in values) else ()


def _longer(values: tuple[T | None, ...], many: int, more: T | None) -> tuple[T | None, ...]:
    """Extend values, which are empty if all are None, to a number of steps and one value more."""
    if not values and more is None:
        return ()
    return (*(values or (None,) * many), more)


def _each(
    name: str, given: Iterable[T | None], many: int, plain: Callable[[str, T], T]
) -> tuple[T | None, ...]:
    """Check that there is a value or None for each step; return nothing if all are None."""
    values = tuple(
        None if value is None else plain(f"{name}[{number}]", value)
        for number, value in enumerate(collection(name, given))
    )
    if values and len(values) != many:
        raise ValueError(f"{name}: {len(values)} are given, {many} are wanted")
    return _told(values)


def _shift(name: str, given: Shift) -> Shift:
    x, y = _two(name, given, "(x, y)")
    return integer(name, x), integer(name, y)


def _pairs(name: str, given: Iterable[Visits], last: int) -> frozenset[Visits]:
    """Check pairs of visits, and leave out pairs of a visit and itself."""
    pairs = {_visits(name, pair, last) for pair in collection(name, given)}
    alone = {pair for pair in pairs if pair[0] == pair[1]}
    if alone and name == "apart":
        raise ValueError(f"apart: {min(alone)}: a visit is of one place with itself")
    return frozenset(pairs - alone)


def _visits(name: str, given: Visits, last: int) -> Visits:
    """Check two visits, and put the earlier one first."""
    one, other = (whole(f"{name}: step", step, 0, last) for step in _two(name, given, "two steps"))
    return min(one, other), max(one, other)


def _two(name: str, given: Iterable[int], what: str) -> tuple[int, int]:
    pair = tuple(collection(name, given))
    if len(pair) != 2:
        raise ValueError(f"{name}: {shown(given)} is not {what}")
    return pair[0], pair[1]


def _is_plain(given: object, *kinds: type) -> bool:
    """Tell whether something is already a frozen set of these types, as most things are."""
    return type(given) is frozenset and {*map(type, given)} <= {*kinds}


def _turns(given: Iterable[int | None]) -> tuple[int | None, ...]:
    """Convert turns of any type of whole number to int."""
    return tuple(
        turn if turn is None or type(turn) is int else integer("turns: slot", turn)
        for turn in collection("turns", given)
    )


def _assumed(given: Iterable[tuple[str, bool]]) -> frozenset[tuple[str, bool]]:
    """Check assumptions: each is a term, and whether it holds."""
    told = set()
    for one in collection("assumed", given):
        if isinstance(one, str) or len(one) != 2 or not isinstance(one[1], bool):
            raise ValueError(f"assumed: {shown(one)} is not such as ('same(3,12)', True)")
        (term,) = _terms("assumed", [one[0]])
        told.add((term, one[1]))
    return frozenset(told)


def _straight(given: Iterable[Iterable[Slots]], many: int) -> tuple[frozenset[Slots], ...]:
    """Check the pairs of slots on one path of each visit, and put the lower slot first."""
    told = []
    for step, of in enumerate(collection("straight", given)):
        name = f"straight[{step}]"
        pairs = set()
        for pair in collection(name, of):
            one, other = (integer(f"{name}: slot", slot) for slot in _two(name, pair, "two slots"))
            if one != other:  # an equal pair says that the gateway ends its path
                pairs.add((min(one, other), max(one, other)))
        told.append(frozenset(pairs))
    if told and len(told) != many:
        raise ValueError(f"straight: {len(told)} are given, {many} are wanted")
    return tuple(told)


def _thing(given: Thing, last: int) -> Thing:
    """Check what is done with a marker that has a name."""
    if isinstance(given, str) or len(given) != 3 or given[0] not in MARKER:
        raise ValueError(f"things: {shown(given)} is not such as ('drop', 4, 'coin')")
    kind, step, name = given
    (term,) = _terms("things", [name])
    return kind, whole("things: step", step, 0, last), term


def _slots(name: str, given: Iterable[int]) -> list[int]:
    """Convert slots of any type of whole number to int."""
    return [
        slot if type(slot) is int else integer(f"{name}: slot", slot)
        for slot in collection(name, given)
    ]


def _terms(name: str, given: Iterable[str]) -> frozenset[str]:
    """Spell landmarks as clingo spells them."""
    terms = set()
    for term in collection(name, given):
        if not isinstance(term, str):
            raise ValueError(f"{name}: {shown(term)} is not a text, such as 'pub' or 'f(1,2)'")
        try:
            terms.add(spelt(term))
        except ValueError as fault:
            raise ValueError(f"{name}: {fault}") from None
    return frozenset(terms)


def observe(
    world: TopologicalMap,
    start: Gateway,
    route: Iterable[int],
    drops: Iterable[int] = (),
    picks: Iterable[int] = (),
) -> tuple[Experience, tuple[DState, ...]]:
    """Explore a world: find out what is seen along a route, and the true hypothesis.

    The agent starts at the gateway ``start``. The route has the absolute slots by which it leaves
    the places. The hypothesis is what ``at/3`` would name. The marker is put down after the steps
    ``drops`` if the agent has it, and taken up after the steps ``picks`` if the agent sees it.
    """
    dstates = [start]
    turns = []
    for slot in route:
        place, stood_at = dstates[-1]
        turns.append((slot - stood_at) % world.slots)
        dstates.append(world.links[place, slot])
    first: dict[Place, tuple[int, int]] = {}
    for step, (place, slot) in enumerate(dstates):
        first.setdefault(place, (step, slot))
    truth = [(first[place][0], (slot - first[place][1]) % world.slots) for place, slot in dstates]
    views = tuple(world.view(dstate) for dstate in dstates)
    landmarks = tuple(world.landmarks.get(place, frozenset()) for place, _ in dstates)
    marker = _marker(dstates, {*drops}, {*picks})
    straight = (
        [_pairs_seen(world, dstate) for dstate in dstates] if world.across is not None else ()
    )
    seen = Experience(world.slots, views, tuple(turns), landmarks, *marker, straight=straight)
    return seen, tuple(truth)


def _pairs_seen(world: TopologicalMap, stood: Gateway) -> set[Slots]:
    """Tell which gateways of a place are on one path, in slots clockwise of the agent's gateway."""
    place, at = stood
    pairs = set()
    for slot in world.stars[place]:
        if (place, slot) in (world.across or {}):
            other = (world.across or {})[place, slot][1]
            one, two = sorted(((slot - at) % world.slots, (other - at) % world.slots))
            pairs.add((one, two))
    return pairs


def _marker(
    dstates: Iterable[Gateway], drops: Container[int], picks: Container[int]
) -> list[frozenset[int]]:
    """The steps after which the marker is put down, taken up and seen."""
    put: set[int] = set()
    taken: set[int] = set()
    seen: set[int] = set()
    lies: list[Place] = []  # the place where the marker lies, if it does
    for step, (place, _) in enumerate(dstates):
        if place in lies:
            seen.add(step)
            if step in picks:
                taken.add(step)
                lies.clear()
        if not lies and step in drops:
            put.add(step)
            lies.append(place)
    return [frozenset(put), frozenset(taken), frozenset(seen)]


def marker_fault(marks: Container[str], out: bool, name: str | None = None) -> str | None:
    """Say what is impossible in what is done with a marker after a step.

    ``out`` tells whether the marker lies somewhere before that.
    """
    marker = "the marker" if name is None else f"the marker {printable(name)}"
    if "pick" in marks and not out:
        return f"{marker} is taken up, but lies nowhere"
    if "drop" in marks and out and "pick" not in marks:
        return f"{marker} is put down, but lies somewhere already"
    if "marker" in marks and not out and "drop" not in marks:
        return f"{marker} is seen, but lies nowhere"
    return None


def marker_out(marks: Container[str], out: bool) -> bool:
    """Tell whether the marker lies somewhere after what is done with it."""
    return "drop" in marks or (out and "pick" not in marks)
