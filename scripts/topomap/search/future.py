"""What the steps to come can still do.

It tells when a gateway of a kind can last be linked, and which visits can be of one place. It is
computed once for each exploration. These conditions are necessary, but not sufficient: what they
exclude is in no map, and what they allow need not be in any map either.
"""

import operator
from bisect import bisect_left
from collections import Counter, defaultdict
from functools import lru_cache

from topomap.model.experience import Experience
from topomap.search.evidence import Evidence
from topomap.search.hypothesis import Hypothesis

# Visits T < U of one place, and how many slots clockwise from T's gateway U's gateway is.
Pair = tuple[int, int, int]
MOST_FACES = 100_000  # the number of faces that are remembered
MOST_BITS = 50_000  # the size of a set of visits with slots
MOST_PAIRS = 100_000  # after so many pairs of visits that look alike, no further pairs are examined


@lru_cache(maxsize=4)
def future_of(experience: Experience) -> "Future":
    """The future of an exploration whose steps are all travels."""
    return Future(experience, Hypothesis(experience).views)


class Future:
    """What is to come in an exploration.

    A gateway is the number ``step * slots + slot``, as if each step had made a new place; its
    ``kind`` is what is seen from it. Step T leaves by a gateway of kind ``out[T]`` and arrives at
    one of kind ``arrival[T]``.
    """

    def __init__(self, experience: Experience, kinds: dict[int, int]):
        self.experience, self.slots, self.kinds = experience, experience.slots, kinds
        self.evidence = Evidence(experience)
        turns = [turn for turn in experience.turns if turn is not None]
        assert len(turns) == experience.steps, "each step is a travel"
        self.turns = [0, *(turn % self.slots for turn in turns)]
        steps = range(1, experience.steps + 1)
        self.out = [0] + [kinds[(t - 1) * self.slots + self.turns[t]] for t in steps]
        self.arrival = [kinds[t * self.slots] for t in range(experience.steps + 1)]
        known = self._retraced()
        number = max(kinds.values()) + 1
        # For each kind: the steps that have an end at a gateway of this kind, from the last step to
        # the first; a step with both ends at such gateways is listed twice. (A step has two ends:
        # the gateway by which it leaves, and the one at which it arrives.) And the steps that leave
        # by such a gateway.
        self.ends: list[list[int]] = [[] for _ in range(number)]
        self.leaving: list[list[int]] = [[] for _ in range(number)]
        for step in reversed(steps):
            if step not in known:
                self.ends[self.out[step]].append(step)
                self.ends[self.arrival[step]].append(step)
                self.leaving[self.out[step]].append(step)
        # For the place that a step may make: the number of its gateways of each kind, except the
        # one of arrival. (The kind of that one is listed even with 0, because the step uses up one
        # end of it.) And the last step after which all these gateways can still be linked.
        self.kinds_of: list[list[tuple[int, int]]] = []
        self.place_by: list[int] = []
        self._in_time: dict[tuple[int, ...], int] = {}
        # The last visit whose pairs are examined; in a long exploration only the beginning is.
        self.paired = 0
        pairs = self._pairs()
        self.pairs = len(pairs) if self.paired == experience.steps else None
        # For each of these visits, the other ones that can be of one place with it, and how many
        # slots clockwise from its gateway theirs are.
        self._others: list[list[tuple[int, int]]] = [[] for _ in range(self.paired + 1)]
        for one, other, apart in pairs:
            self._others[one].append((other, apart))
            self._others[other].append((one, -apart))
        # For each visit the kind of its place, named by the least kind of its gateways; for each
        # such kind, the least number of places of a map.
        self.place_kind = [
            min(kinds[step * self.slots + slot] for slot in view)
            for step, view in enumerate(experience.views)
        ]
        self.needed = self._needed()
        self._possible: dict[tuple[int, int], int] = {}
        self._visits_by: dict[int, tuple[int, int]] = {}
        for step, view in enumerate(experience.views):
            others = [step * self.slots + slot for slot in sorted(view) if slot]
            many = Counter(kinds[gateway] for gateway in others)
            many[self.arrival[step]] += 0
            self.kinds_of.append([*many.items()])
            possible = self.possible_visits(step, 0)
            ends = (self.last_at(gateway, possible) for gateway in others)
            self.place_by.append(min(ends, default=experience.steps))

    def last(self, kind: int, many: int) -> int:
        """The last step after which this many gateways of a kind can still be linked.

        The steps to come must have enough ends of this kind. It is -1 if there is no such step.
        """
        ends = self.ends[kind]
        return ends[many - 1] - 1 if many <= len(ends) else -1

    def left(self, kind: int, step: int) -> int:
        """The number of ends of a kind that are still to come after a step."""
        return bisect_left(self.ends[kind], -step, key=operator.neg)

    def last_of_face(self, face: tuple[int, ...]) -> int:
        """The last step after which all pending gateways of a face of a planar map can be linked.

        There must be at least one such gateway. It is -1 if there is no such step. A link joins two
        gateways of one face, so a step to come must leave by one of them, and from that step on
        there must be enough ends of each kind.
        """
        known = self._in_time.get(face)
        if known is None:
            many: dict[int, int] = defaultdict(int)
            for gateway in face:
                many[self.kinds[gateway]] += 1
            enter = min(self.last(kind, number) + 1 for kind, number in many.items())
            if len(self._in_time) > MOST_FACES:
                self._in_time.clear()
            entries = (next((s for s in self.leaving[kind] if s <= enter), 0) for kind in many)
            known = self._in_time[face] = max(entries) - 1
        return known

    def possible_visits(self, step: int, slot: int) -> int:
        """The visits that can be of one place with the visit after ``step``.

        That visit stands at ``slot`` of the place. Bit ``T * slots + S`` is set if visit T can be
        there and stand at slot S. For the visits after ``paired``, whose pairs are not examined,
        all bits are set.
        """
        if step > self.paired:
            return -1
        known = self._possible.get((step, slot))
        if known is None:
            known = 1 << (step * self.slots + slot)
            if self.paired < self.experience.steps:
                known |= -1 << ((self.paired + 1) * self.slots)
            for other, apart in self._others[step]:
                known |= 1 << (other * self.slots + (slot + apart) % self.slots)
            self._possible[step, slot] = known
        return known

    def last_at(self, gateway: int, possible: int) -> int:
        """The last step after which a pending gateway can still be linked.

        Only visits of the bits ``possible`` can be at its place. It is -1 if there is no such step.
        """
        if possible < 0:
            return self.experience.steps - 1
        slot = gateway % self.slots
        if slot not in self._visits_by:
            self._visits_by[slot] = self._mask(slot)
        arrive, leave = self._visits_by[slot]
        arrival = ((possible & arrive).bit_length() - 1) // self.slots
        before = ((possible & leave).bit_length() - 1) // self.slots
        return max(arrival - 1, before)

    def _mask(self, slot: int) -> tuple[int, int]:
        """The visits that arrive by a slot, and those after which a step leaves by it."""
        arrive = leave = 0
        for step in range(1, self.experience.steps + 1):
            arrive |= 1 << (step * self.slots + slot)
            leave |= 1 << ((step - 1) * self.slots + (slot - self.turns[step]) % self.slots)
        return arrive, leave

    def _needed(self) -> list[int]:
        """A lower bound on the number of places of each kind in a map.

        It is the number of visits to such places no two of which can be of one place. They are
        found greedily, among those of one straight run, and among those whose pairs are examined.
        """
        needed = [0] * (max(self.place_kind) + 1)
        visits: list[list[int]] = [[] for _ in needed]
        for visit, kind in enumerate(self.place_kind[: self.paired + 1]):
            visits[kind].append(visit)
        for kind, of in enumerate(visits):
            others = {visit: {other for other, _ in self._others[visit]} for visit in of}
            left, many = {*of}, 0
            while left:
                chosen = min(left, key=lambda visit: (len(others[visit] & left), visit))
                left -= others[chosen]
                left.discard(chosen)
                many += 1
            needed[kind] = many
        on_run: Counter[int] = Counter()
        for visit, kind in enumerate(self.place_kind):
            if visit < 2 or not self.experience.goes_straight(visit):
                on_run = Counter(self.place_kind[max(0, visit - 1) : visit])
            on_run[kind] += 1
            needed[kind] = max(needed[kind], on_run[kind])
        return needed

    def _retraced(self) -> set[int]:
        """The steps that only go back over links of earlier steps, so add no link in any map."""
        known = set()
        # For each step that has not been retraced yet: its turn, and the turn that would have
        # retraced the step before it instead.
        ways: list[tuple[int, int]] = []
        back = -1
        for step, turn in enumerate(self.turns[1:], 1):
            if ways and turn == back:
                known.add(step)
                before, back = ways.pop()
                back = (back - before) % self.slots if ways else -1
            else:
                ways.append((turn, back))
                back = 0
        return known

    def _pairs(self) -> set[Pair]:
        """The pairs of visits that can be of one place.

        They are found up to the last visit at which not too many visits look alike (``paired``).
        Both visits of such a pair see the same, and they are not on one straight run of steps (the
        path axiom). What follows from the pair must be possible, too: if both visits leave by one
        gateway, or arrived by one, or if one leaves by the gateway by which the other arrived, then
        the visits at the other ends of these links are of one place, and the two steps along the
        link have like lengths. And the pair agrees with compass and odometry.
        """
        told = self.evidence
        slots, turns = self.slots, self.turns
        by_kind: dict[int, list[int]] = defaultdict(list)  # the gateways of the visits so far
        looks: list[list[int]] = []
        many = 0
        for visit, view in enumerate(self.experience.views[: MOST_BITS // slots]):
            looks.append([*by_kind[self.arrival[visit]]])
            many += len(looks[-1])
            if many > MOST_PAIRS:
                break
            self.paired = visit
            for gateway in (visit * slots + slot for slot in view):
                by_kind[self.kinds[gateway]].append(gateway)
        run, runs = [0], 0
        for step in range(2, len(turns)):
            runs += not self.experience.goes_straight(step)
            run.append(runs)
        # A visit is on two runs: the one by which it was reached, and the one by which it was left.
        of = [{*run[max(0, visit - 1) : visit + 1]} for visit in range(self.paired + 1)]
        pairs: set[Pair] = set()
        for visit, gateways in enumerate(looks[: self.paired + 1]):
            for gateway in gateways:
                before, slot = divmod(gateway, slots)
                if of[before] & of[visit]:
                    continue
                if not (told and told.refuses(before, visit, slot)):
                    pairs.add((before, visit, slot))
        asked_by: dict[Pair, list[Pair]] = defaultdict(list)
        wrong = []
        for pair in pairs:
            for (one, other, apart), steps in self._following(*pair):
                if told.lengths and told.unequal(*steps):
                    wrong.append(pair)
                    break
                if one == other:
                    following = None if apart % slots else pair
                else:
                    following = (one, other, apart % slots)
                    if one > other:
                        following = (other, one, -apart % slots)
                if following == pair or max(one, other) > self.paired:
                    continue
                if following not in pairs:
                    wrong.append(pair)
                    break
                asked_by[following].append(pair)
        while wrong:
            pair = wrong.pop()
            if pair in pairs:
                pairs.remove(pair)
                wrong += asked_by[pair]
        return pairs

    def _following(self, one: int, other: int, apart: int) -> list[tuple[Pair, tuple[int, int]]]:
        """What follows if two visits are of one place.

        It gives further such pairs of visits, in any order, each with the two steps along one link
        from which it follows.
        """
        turns, slots, last = self.turns, self.slots, self.experience.steps
        pairs = []
        if other < last and turns[one + 1] == (apart + turns[other + 1]) % slots:
            pairs.append(((one + 1, other + 1, 0), (one + 1, other + 1)))
        if one > 0 and apart == 0:
            pairs.append(((one - 1, other - 1, turns[one] - turns[other]), (one, other)))
        if turns[one + 1] == apart:
            pairs.append(((one + 1, other - 1, -turns[other]), (one + 1, other)))
        if one > 0 and other < last and (apart + turns[other + 1]) % slots == 0:
            pairs.append(((one - 1, other + 1, turns[one]), (one, other + 1)))
        return pairs
