"""Which further walk in a known world refutes all remaining maps but the real one, if any does.

A further walk refutes a map if the map predicts something else than what is seen. Beyond a pending
gateway a map predicts no view, but not everything is possible there: an agent that goes back the
way by which it came is where it was before. So the agent is followed there, too (``Lineage``). A
map is refuted by a walk if, and only if, no map that extends it is consistent after the walk. The
reason is this: if all that the map predicts is seen, then that extension of it is consistent in
which each step beyond a pending gateway, except for steps back, came to a new place.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from topomap.model.topology import Gateway
from topomap.questions.machine import Spent, Work
from topomap.questions.standings import Prediction, Standing, sight

MOST_WORK = 300_000  # moves of maps, in the search for the shortest walk
# Where the agent is in a map: a dstate, and for each step beyond a pending gateway by how many
# slots the way back lies clockwise of where the agent stands, or stood when it went on.
State = tuple[Gateway, tuple[int, ...]]


class Lineage:
    """A map, and all maps that may extend it."""

    def __init__(self, standing: Standing):
        self.standing, self.world = standing, standing.world
        self.slots = standing.world.slots
        self.start: State = standing.dstate, ()
        self._looks: dict[Gateway, Prediction] = {}

    def look(self, state: State) -> Prediction | None:
        """What is seen there; None beyond a pending gateway, where nothing is predicted."""
        dstate, beyond = state
        if beyond:
            return None
        if dstate not in self._looks:
            self._looks[dstate] = sight(self.standing, dstate, None)
        return self._looks[dstate]

    def after(self, state: State, turn: int) -> State:
        """Where a step leads."""
        (place, slot), beyond = state
        if not beyond:
            out = place, (slot + turn) % self.slots
            end = self.world.links.get(out)
            return (out, (0,)) if end is None else (end, ())
        *before, back = beyond
        if turn == back:
            return (place, slot), tuple(before)
        return (place, slot), (*before, (back - turn) % self.slots, 0)


@dataclass(frozen=True)
class Refuted:
    """Which of some maps can be refuted.

    ``never`` is the number of those that no walk refutes. If it is 0, ``walk`` is a walk that
    refutes all of them, as turns, and each such walk has ``at_least`` so many steps. The walk is a
    shortest one if it has no more.
    """

    never: int
    walk: tuple[int, ...] | None = None
    at_least: int = 0

    @property
    def shortest(self) -> bool:
        """Whether it is proved that no shorter walk does."""
        return self.walk is not None and len(self.walk) == self.at_least


def refute(real: Standing, others: Iterable[Standing], work: Work) -> Refuted:
    """Find the shortest walk in the real world that refutes all of these maps, consistent so far.

    If it would take too much work to find it, some walk that refutes them is found.
    """
    world, lineages = Lineage(real), [Lineage(other) for other in others]
    never, farthest = 0, 0
    for lineage in lineages:
        walk = difference(world, world.start, lineage, lineage.start, work)
        if walk is None:
            never += 1
        else:
            farthest = max(farthest, len(walk))
    if never:
        return Refuted(never)
    try:
        walk, least = _shortest(world, lineages, Work(work.watch, MOST_WORK)), farthest
    except _SpentAt as spent:
        walk, least = _one_by_one(world, lineages, work), max(farthest, spent.length + 1)
        return Refuted(0, walk, least)
    return Refuted(0, walk, len(walk))


def difference(
    real: Lineage, here: State, other: Lineage, there: State, work: Work
) -> tuple[int, ...] | None:
    """Find the shortest walk that refutes one map; None if no walk does.

    The agent is ``there`` in the map, and ``here`` in the world. A walk through a pending gateway
    and back refutes nothing that is not refuted without it.
    """
    level: list[tuple[State, State, tuple[int, ...]]] = [(here, there, ())]
    met = {(here, there)}
    while level:
        following = []
        for at, in_other, walk in level:
            seen = real.look(at)
            assert seen is not None
            for turn in sorted(seen.view):
                beyond = in_other[1]
                if beyond and turn != beyond[-1]:
                    continue
                work.take()
                end, other_end = real.after(at, turn), other.after(in_other, turn)
                if len(other_end[1]) > len(beyond) or (end, other_end) in met:
                    continue
                met.add((end, other_end))
                predicted = other.look(other_end)
                if predicted is not None and predicted != real.look(end):
                    return (*walk, turn)
                following.append((end, other_end, (*walk, turn)))
        level = following
    return None


class _SpentAt(Exception):
    """Too much work; all walks up to some length were tried."""

    def __init__(self, length: int):
        super().__init__()
        self.length = length


def _alive(
    real: Lineage,
    end: State,
    others: Sequence[Lineage],
    states: Iterable[tuple[int, State]],
    turn: int,
) -> tuple[tuple[int, State], ...]:
    """Find the maps, by number, that a step to a dstate of the world leaves.

    With each comes the state to which the step leads in it.
    """
    seen = real.look(end)
    ends = ((number, others[number].after(state, turn)) for number, state in states)
    return tuple(
        (number, state)
        for number, state in ends
        if (predicted := others[number].look(state)) is None or predicted == seen
    )


def _shortest(real: Lineage, others: Sequence[Lineage], work: Work) -> tuple[int, ...]:
    """The shortest walk that refutes all of these; there is one. Raises _SpentAt."""
    start = tuple((number, other.start) for number, other in enumerate(others))
    level: list[tuple[State, tuple[tuple[int, State], ...], tuple[int, ...]]]
    level = [(real.start, start, ())]
    met = {(real.start, start)}
    length = 0
    if not start:
        return ()
    while True:
        following = []
        try:
            for at, states, walk in level:
                seen = real.look(at)
                assert seen is not None
                for turn in sorted(seen.view):
                    work.take(len(states))
                    end = real.after(at, turn)
                    left = _alive(real, end, others, states, turn)
                    if not left:
                        return (*walk, turn)
                    if (end, left) not in met:
                        met.add((end, left))
                        following.append((end, left, (*walk, turn)))
        except Spent:
            raise _SpentAt(length) from None
        level, length = following, length + 1


def _one_by_one(real: Lineage, others: Sequence[Lineage], work: Work) -> tuple[int, ...]:
    """A walk that refutes the maps one after the other, the next one first."""
    at, walk = real.start, []
    states = tuple((number, other.start) for number, other in enumerate(others))
    while states:
        ways = [difference(real, at, others[number], state, work) for number, state in states]
        for turn in min((way for way in ways if way is not None), key=len):
            at = real.after(at, turn)
            states = _alive(real, at, others, states, turn)
            walk.append(turn)
    return tuple(walk)
