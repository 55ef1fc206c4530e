"""Counting maps without listing them: hypotheses that have the same future are merged.

Two hypotheses have the same future if the steps to come can do the same in both. For a hypothesis
this depends on the dstate of the agent; on the gateways that a step to come can still link or leave
by; on the other ends of those that are linked; and on which of the paths on which they lie may be
joined. So hypotheses are counted by these, step by step: this is dynamic programming. Its keys are
exact; nothing is hashed to a number that could be the same for two of them.

Planar maps are hardly ever merged, because the gateways of each face have an order of their own.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Watch
from topomap.search.future import future_of
from topomap.search.hypothesis import OFTEN, Hypothesis, numbers

Key = tuple[Any, ...]
Counted = list[Any]  # a state, and the number of its hypotheses
PARTS = {"closed", "perpendicular"}  # the demands that this way of counting allows


class State(NamedTuple):
    """What hypotheses with one future have in common.

    ``pending`` has the pending gateways that a step to come can link, in order, and ``path`` the
    path of each: paths are numbered in the order of their first such gateway. ``links`` has the
    linked gateways by which a step to come can leave, each with the gateway at the other end.
    ``meets`` has for each path, as bits, the paths that share a place with it. If maps must be
    perpendicular, ``twice`` has those that meet a path which meets it, and ``thrice`` those from
    which two further paths lead to it. ``places`` is the number of places, if that matters.
    """

    here: int
    pending: tuple[int, ...]
    path: tuple[int, ...]
    links: tuple[tuple[int, int], ...]
    meets: tuple[int, ...]
    twice: tuple[int, ...]
    thrice: tuple[int, ...]
    places: int


def refusal(experience: Experience, query: Query) -> str | None:
    """Say why maps cannot be counted by merging, or None."""
    asked = query.parts - PARTS
    if asked:
        return f"{min(asked)} (only closed, perpendicular, a bound and a horizon may be asked for)"
    if experience.parted:
        return "several logs, or second looks"
    told = {
        "a marker": experience.names(),
        "odometry": experience.shifts,
        "lengths": experience.lengths,
        "visits said to be of one place (same/2, or assumed)": experience.same,
        "visits said to be of two places (apart/2, or assumed)": experience.apart,
        "statements that are taken for granted (assume)": experience.assumed,
        "bearings that are not exact": experience.tolerance,
    }
    for what, known in told.items():
        if known:
            return what
    if experience.compass_told() not in (0, experience.steps + 1):
        return "a compass that is not given at each visit"
    return None


class Merging:
    """The number of maps of an experience, or of those that are closed or perpendicular."""

    def __init__(self, experience: Experience, query: Query):
        """Prepare the count.

        Raises:
            InputError: Something keeps hypotheses from being merged. One line.
        """
        if query.horizon is not None:
            experience = experience.cut(query.horizon)
        if why := refusal(experience, query):
            raise InputError(f"maps cannot be counted by merging: {why}")
        self.experience, self.slots = experience, experience.slots
        self.closed = "closed" in query.parts
        self.perpendicular = "perpendicular" in query.parts
        self.bound = query.places
        whole = Hypothesis(experience)
        self.future = future_of(experience)
        self.kinds, self.stars, self._axes = whole.views, whole.stars, whole.axes
        self.largest = 0  # the largest number of states at one step
        self._visits_at: dict[int, int] = {}
        self._possible = [self.future.possible_visits(visit, 0) for visit in range(len(self.stars))]
        # For each turn, the steps that make it, as bits; and what is known of gateways, by number.
        turned: dict[int, int] = {}
        for step in range(1, experience.steps + 1):
            turn = self.future.turns[step]
            turned[turn] = turned.get(turn, 0) | 1 << step
        self._turned = [*turned.items()]
        self._named: dict[Any, int] = {}

    def counts(self, watch: Watch | None = None) -> Iterator[int]:
        """The number of hypotheses after each step, from 0.

        Hypotheses that are already known to lead to no map are left out; the last
        number is that of the maps.
        """
        level: dict[Key, Counted] = {}
        pending, relations = self._place(0, {}, [[], [], []])
        self._add(level, 1, 0, 0, pending, relations, {}, 1)
        yield sum(many for _, many in level.values())
        work = 0
        for step in range(1, self.experience.steps + 1):
            following: dict[Key, Counted] = {}
            self._named.clear()
            for state, many in level.values():
                work += 1
                if watch and work % OFTEN == 0:
                    watch.tick()
                self._go(state, step, many, following)
            level = following
            self.largest = max(self.largest, len(level))
            yield sum(many for _, many in level.values())

    def _go(self, state: State, step: int, many: int, level: dict[Key, Counted]) -> None:
        """Count the hypotheses that a step makes of those of a state."""
        place, slot = divmod(state.here, self.slots)
        out = place * self.slots + (slot + self.future.turns[step]) % self.slots
        links = dict(state.links)
        pending = dict(zip(state.pending, state.path, strict=True))
        relations = [[*state.meets], [*state.twice], [*state.thrice]]
        if out in links:
            if self._fits(links[out], step):
                self._add(level, many, step, links[out], pending, relations, links, state.places)
            return
        path = pending.pop(out, None)
        if path is None:  # no step can leave by it, so the agent is not there
            return
        barred = (1 << path) | state.meets[path]
        if self.perpendicular:
            barred |= state.twice[path] | state.thrice[path]
        for gateway, other in pending.items():
            if self._fits(gateway, step) and not barred >> other & 1:
                rest = {g: p for g, p in pending.items() if g != gateway}
                ends = {**links, out: gateway, gateway: out}
                one = [[*of] for of in relations]
                self._join(path, other, rest, one)
                self._add(level, many, step, gateway, rest, one, ends, state.places)
        if self.bound is None or state.places < self.bound:
            new = step * self.slots
            grown, one = self._place(step, pending, relations)
            other = grown.pop(new)
            self._join(path, other, grown, one)
            ends = {**links, out: new, new: out}
            self._add(level, many, step, new, grown, one, ends, state.places + 1)

    def _fits(self, gateway: int, step: int) -> bool:
        """Tell whether a step can arrive at a gateway of a known place."""
        place, slot = divmod(gateway, self.slots)
        if self.kinds[gateway] != self.future.arrival[step]:
            return False
        return bool(self._possible[place] >> (step * self.slots + slot) & 1)

    def _place(
        self, place: int, pending: dict[int, int], relations: list[list[int]]
    ) -> tuple[dict[int, int], list[list[int]]]:
        """Add a new place, at which its paths meet."""
        first = len(relations[0])
        axes = self._axes(place)
        number = {axis: first + n for n, axis in enumerate(dict.fromkeys(axes.values()))}
        every = sum(1 << path for path in number.values())
        meets, twice, thrice = ([*of] for of in relations)
        for path in number.values():
            meets.append(every & ~(1 << path))
            twice.append(0)  # paths that meet here are excluded by that
            thrice.append(0)
        return pending | {g: number[axis] for g, axis in axes.items()}, [meets, twice, thrice]

    def _join(
        self, path: int, other: int, pending: dict[int, int], relations: list[list[int]]
    ) -> None:
        """Join two paths; the result keeps the number of the first one."""
        meets, twice, thrice = relations
        for gateway, of in pending.items():
            if of == other:
                pending[gateway] = path
        both = (1 << path) | (1 << other)
        here, there = meets[path], meets[other]
        if self.perpendicular:
            # Through the new path, a path that meets the one is now two steps from each path that
            # meets the other, and three steps from each path that is two steps from it.
            near, far = twice[path], twice[other]
            for one in numbers((here | near | there | far) & ~both):
                meets_one, meets_other = here >> one & 1, there >> one & 1
                if meets_one:
                    twice[one] |= there & ~both
                    thrice[one] |= far & ~both
                if meets_other:
                    twice[one] |= here & ~both
                    thrice[one] |= near & ~both
                if near >> one & 1:
                    thrice[one] |= there & ~both
                if far >> one & 1:
                    thrice[one] |= here & ~both
            _rename(twice, path, other)
            _rename(thrice, path, other)
        _rename(meets, path, other)

    def _add(
        self,
        level: dict[Key, Counted],
        many: int,
        step: int,
        here: int,
        pending: dict[int, int],
        relations: list[list[int]],
        links: dict[int, int],
        places: int,
    ) -> None:
        """Count more hypotheses of a state.

        Of the state, only what the steps to come can use is kept.
        """
        uses = self._uses(step, here, pending, links)
        kept = [g for g in pending if g in uses]
        if self.closed and (len(kept) < len(pending) or (kept and step == self.experience.steps)):
            return
        ends = {g: end for g, end in links.items() if uses.get(g, (0, 0))[1]}
        order = self._ordered(here, kept, pending, relations[0], ends, uses)
        kept.sort(key=order.__getitem__)
        number: dict[int, int] = {}
        for gateway in kept:
            number.setdefault(pending[gateway], len(number))
        path = tuple(number[pending[gateway]] for gateway in kept)
        meets, *more = (
            self._renumbered(of, number) for of in relations[: 1 + 2 * self.perpendicular]
        )
        if more:
            more[0] = tuple(
                of & ~(mine | 1 << n)
                for n, (of, mine) in enumerate(zip(more[0], meets, strict=True))
            )
            more[1] = tuple(
                of & ~(mine | two | 1 << n)
                for n, (of, mine, two) in enumerate(zip(more[1], meets, more[0], strict=True))
            )
        twice, thrice = more or ((), ())
        out = sorted(ends, key=order.__getitem__)
        count = places if self.bound is not None else 0
        slots = self.slots
        ranked = sorted(order, key=order.__getitem__)
        key = (
            tuple([self._named.setdefault(uses[g], len(self._named)) for g in ranked]),
            # The number of slots between two gateways of one place.
            tuple(
                [
                    (g - before) % slots if g // slots == before // slots else -1
                    for before, g in pairwise(ranked)
                ]
            ),
            order[here],
            tuple([order[g] for g in kept]),
            path,
            tuple([(order[g], order.get(ends[g], -1)) for g in out]),
            *(meets, twice, thrice, count),
        )
        known = level.get(key)
        if known is None:
            state = State(
                here,
                tuple(kept),
                path,
                tuple([(g, ends[g]) for g in out]),
                meets,
                twice,
                thrice,
                places,
            )
            level[key] = [state, many]
        else:
            known[1] += many

    def _uses(
        self, step: int, here: int, pending: dict[int, int], links: dict[int, int]
    ) -> dict[int, tuple[int, int]]:
        """The gateways that the steps to come can use.

        Each comes with the visits that can stand there, and the steps that can leave by it, as
        bits.
        """
        slots, visits = self.slots, self._visits
        later = -1 << (step + 1)
        arrive: dict[int, int] = {here: 1 << step}
        leave: dict[int, int] = {}
        for gateway in pending:
            if possible := visits(gateway) & later:
                arrive[gateway] = arrive.get(gateway, 0) | possible
        waiting = [*arrive]
        while waiting:
            gateway = waiting.pop()
            slot, following = gateway % slots, arrive[gateway] << 1
            for turn, steps in self._turned:
                if possible := following & steps:
                    out = gateway - slot + (slot + turn) % slots
                    if out in pending:
                        leave[out] = leave.get(out, 0) | possible
                    elif out in links:
                        end = links[out]
                        if possible := possible & visits(end):
                            leave[out] = leave.get(out, 0) | possible
                            if possible & ~arrive.get(end, 0):
                                arrive[end] = arrive.get(end, 0) | possible
                                waiting.append(end)
        return {g: (arrive.get(g, 0), leave.get(g, 0)) for g in arrive.keys() | leave.keys()}

    def _visits(self, gateway: int) -> int:
        """The visits that can stand at a gateway, as bits."""
        known = self._visits_at.get(gateway)
        if known is None:
            place, slot = divmod(gateway, self.slots)
            possible = self._possible[place]
            known = 0
            for visit in range(place, self.experience.steps + 1):
                fits = self.kinds[gateway] == self.future.arrival[visit]
                if fits and (possible >> (visit * self.slots + slot)) & 1:
                    known |= 1 << visit
            self._visits_at[gateway] = known
        return known

    def _ordered(
        self,
        here: int,
        pending: list[int],
        paths: dict[int, int],
        meets: list[int],
        ends: dict[int, int],
        uses: dict[int, tuple[int, int]],
    ) -> dict[int, int]:
        """The gateways that the steps to come can use, each with its number.

        Their order does not depend on the names of places, as far as such an order is found soon.
        """
        slots, known = self.slots, self._named
        rings: dict[int, list[int]] = {}
        for gateway in sorted(uses):
            rings.setdefault(gateway // slots, []).append(gateway)
        waiting = {*pending}
        # What is known of each gateway, as a number; in all states of a step, equal numbers stand
        # for equal knowledge.
        colour: dict[int, int] = {}
        for ring in rings.values():
            before = ring[-1]
            for g in ring:
                told: Any = (uses[g], g == here, g in waiting, (before - g) % slots)
                colour[g] = known.setdefault(told, len(known))
                before = g
        turned: dict[int, int] = {}
        for again in (True, False):
            for place, ring in rings.items():
                seen = tuple([colour[gateway] for gateway in ring])
                if len(ring) > 1:
                    n, seen = _least_turn(seen)
                    if n:
                        ring[:] = ring[n:] + ring[:n]
                turned[place] = known.setdefault(seen, len(known))
            if not again or len({*turned.values()}) == len(rings):
                break
            spot = {
                g: (turned[place], n) for place, ring in rings.items() for n, g in enumerate(ring)
            }
            on: dict[int, list[tuple[int, int]]] = {}
            for gateway in pending:
                on.setdefault(paths[gateway], []).append(spot[gateway])
            form: dict[int, int] = {}
            for path, spots in on.items():
                spots.sort()
                form[path] = known.setdefault(tuple(spots), len(known))
            met: dict[int, int] = {}
            for path in form:
                others = sorted([form[other] for other in numbers(meets[path]) if other in form])
                met[path] = known.setdefault((form[path], *others), len(known))
            for g, at in spot.items():
                told = (
                    at,
                    met[paths[g]] if g in waiting else -1,
                    spot[ends[g]] if g in ends else -1,
                )
                colour[g] = known.setdefault(told, len(known))
        ranked = sorted(rings, key=lambda place: (turned[place], place))
        return {g: n for n, g in enumerate(g for place in ranked for g in rings[place])}

    def _renumbered(self, relation: list[int], number: dict[int, int]) -> tuple[int, ...]:
        """A relation of the paths that are kept, by their new numbers."""
        kept = sum(1 << path for path in number)
        return tuple(
            [sum([1 << number[one] for one in numbers(relation[path] & kept)]) for path in number]
        )


def _least_turn(ring: tuple[int, ...]) -> tuple[int, tuple[int, ...]]:
    """The smallest rotation of a tuple, and by how many places it is rotated."""
    least = min(ring)
    turns = [(ring[n:] + ring[:n], n) for n, one in enumerate(ring) if one == least]
    turned, n = min(turns)
    return n, turned


def _rename(relation: list[int], path: int, other: int) -> None:
    """Join a path to another one in a relation."""
    relation[path] |= relation[other]
    for one in numbers(relation[other]):
        relation[one] |= 1 << path
    both = ~((1 << path) | (1 << other))
    relation[path] &= both
