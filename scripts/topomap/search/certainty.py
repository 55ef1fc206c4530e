"""What holds in all hypotheses of an experience that goes on, kept from step to step.

Two visits are certainly of one place if they are of one place in each hypothesis. So visits are
divided into classes, by the tuple of the places that the hypotheses give them. A step adds its
visit to a class. Classes are made anew only if hypotheses have died or have more than one child,
and only for the visits after the last one that all hypotheses have in common.
"""

import heapq
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, islice
from typing import Any

from topomap.search.living import Living, Told, Visit

Same = tuple[int, int]  # two steps after which the agent was at one place
Linked = tuple[int, int, int, int]  # T S U R: two gateways, as slots after T and U
Part = tuple[list[int], int]  # visits in ascending order, and how many of the first ones count


class Certain:
    """What holds in all hypotheses, in terms of steps.

    ``same`` has pairs of steps after which the agent was at one place, ``new`` steps that came to a
    place for the first time, and ``linked`` gateways that are joined.
    """

    def __init__(
        self, same: Iterable[Same] = (), new: Iterable[int] = (), linked: Iterable[Linked] = ()
    ):
        self._sets = frozenset(same), frozenset(new), frozenset(linked)

    @property
    def same(self) -> frozenset[Same]:
        """Pairs of steps after which the agent was at one place."""
        return self._sets[0]

    @property
    def new(self) -> frozenset[int]:
        """Steps that came to a place for the first time."""
        return self._sets[1]

    @property
    def linked(self) -> frozenset[Linked]:
        """Gateways that are joined."""
        return self._sets[2]

    def since(self, before: "Certain") -> "Certain":
        """What was not certain before."""
        return Certain(self.same - before.same, self.new - before.new, self.linked - before.linked)

    def pairs(self, most: int) -> tuple[list[Same], int]:
        """The first pairs of ``same``, at most so many, and their number in all."""
        return sorted(self.same)[:most], len(self.same)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Certain):
            return NotImplemented
        return (self.same, self.new, self.linked) == (other.same, other.new, other.linked)

    def __hash__(self) -> int:
        return hash((self.same, self.new, self.linked))

    def __repr__(self) -> str:
        return f"Certain({sorted(self.same)}, {sorted(self.new)}, {sorted(self.linked)})"


@dataclass(frozen=True)
class Change:
    """What a step made certain.

    Two visits of ``joined`` are now of one place if they are of different parts of one group; if a
    group has one part only, all its visits are of one place. ``gone`` is what is now stated of
    other steps.
    """

    joined: tuple[tuple[Part, ...], ...] = ()
    new: tuple[int, ...] = ()
    linked: tuple[Linked, ...] = ()
    gone: tuple[Linked, ...] = ()

    def number(self) -> int:
        """The number of pairs that are joined."""
        found = 0
        for parts in self.joined:
            sizes = [size for _, size in parts]
            if len(sizes) == 1:
                found += sizes[0] * (sizes[0] - 1) // 2
            else:
                found += (sum(sizes) ** 2 - sum(size**2 for size in sizes)) // 2
        return found

    def pairs(self) -> Iterator[Iterator[Same]]:
        """The pairs of each group in order."""
        return map(_pairs, self.joined)


def _pairs(parts: Sequence[Part]) -> Iterator[Same]:
    if len(parts) == 1:
        visits, size = parts[0]
        yield from combinations(visits[:size], 2)
        return
    (visits, size), *rest = parts
    # This is the usual case.
    if len(rest) == 1 and rest[0][1] == 1 and visits[size - 1] < rest[0][0][0]:
        last = rest[0][0][0]
        for visit in islice(visits, size):
            yield visit, last
        return
    numbered = enumerate(parts)
    each = heapq.merge(
        *([(v, number) for v in visits[:size]] for number, (visits, size) in numbered)
    )
    for visit, mine in each:
        later = [
            islice(visits, bisect_right(visits, visit, 0, size), size)
            for number, (visits, size) in enumerate(parts)
            if number != mine
        ]
        for other in heapq.merge(*later):
            yield visit, other


class Changes(Certain):
    """What is certain after a step, or what became certain ``since`` an earlier one, by steps.

    Sets are made when they are asked for, because they grow with the square of the number of steps.
    """

    def __init__(self, origin: object, changes: Sequence[Change], first: int, step: int):
        self._origin, self._changes, self._first, self.step = origin, changes, first, step

    def _all(self) -> Iterable[Change]:
        return islice(self._changes, self._first, self.step + 1)

    @cached_property
    def same(self) -> frozenset[Same]:
        """Pairs of steps after which the agent was at one place."""
        return frozenset(
            chain.from_iterable(chain.from_iterable(change.pairs() for change in self._all()))
        )

    @cached_property
    def new(self) -> frozenset[int]:
        """Steps that came to a place for the first time."""
        return frozenset(step for change in self._all() for step in change.new)

    @cached_property
    def linked(self) -> frozenset[Linked]:
        """Gateways that are joined."""
        found: set[Linked] = set()
        for change in self._all():
            found.difference_update(change.gone)
            found.update(change.linked)
        return frozenset(found)

    def since(self, before: Certain) -> Certain:
        """What was not certain before."""
        if type(before) is Certain and not (before.same or before.new or before.linked):
            return self
        if isinstance(before, Changes) and before._origin is self._origin:
            return Changes(self._origin, self._changes, before.step + 1, self.step)
        return super().since(before)

    def pairs(self, most: int) -> tuple[list[Same], int]:
        """The first pairs of ``same``, at most so many, and their number in all."""
        each = [pairs for change in self._all() for pairs in change.pairs()]
        number = sum(change.number() for change in self._all())
        return [*islice(heapq.merge(*each), most)], number


class Certainty:
    """What holds in all hypotheses, after each step."""

    def __init__(self, told: Told):
        self._told = told
        self.origin = object()  # objects of one origin agree about each step
        self._changes: list[Change] = []
        self._clear()

    def _clear(self) -> None:
        # Keys are places if all hypotheses agree, and otherwise what differs.
        self._together: dict[Any, list[int]] = {}
        # The first visit, by the gateway of the agent, too.
        self._turned: dict[Any, tuple[int, int]] = {}
        self._keys: list[tuple[Any, Any]] = []  # for each visit
        # For each visit, an earlier one of the same place, and the gateway of the agent there.
        self._first: list[tuple[int, int] | None] = []
        self._fact: list[Linked | None] = []  # for each step
        self._facts: Counter[Linked] = Counter()
        self._new: list[bool] = []
        self._plain: list[bool] = []  # whether each hypothesis before a step has one child
        self._agreed = -1  # up to this step all hypotheses are equal

    def after(self, step: int) -> Certain:
        """What is certain after this step, which must be the last one."""
        return Changes(self.origin, self._changes, 0, step)

    def step(self, level: Sequence[Living], plain: bool) -> None:
        """Go a step on, to these hypotheses.

        ``plain`` tells whether each hypothesis before the step has one child.
        """
        step = len(self._keys)
        if step and plain:
            at = [one.visit.gateway for one in level]
            joined = self._add(step, at)
            fact = self._fact[step]
            fresh = fact is not None and self._facts[fact] == 1
            self._changes.append(
                Change(
                    (joined,) if joined else (),
                    (step,) if self._new[step] else (),
                    (fact,) if fact is not None and fresh else (),
                )
            )
            self._plain.append(True)
            if len(level) == 1:
                self._agreed = step
        else:
            self._again(level, step)

    def begin(self, level: Sequence[Living], step: int) -> None:
        """Begin anew after this step, with these hypotheses."""
        self._clear()
        self.origin = object()
        self._changes = [Change()] * step
        self._restart(level, step)
        self._changes.append(
            Change(
                tuple(((visits, len(visits)),) for visits in self._together.values()),
                tuple(number for number, new in enumerate(self._new) if new),
                tuple(self._facts),
            )
        )

    def undo(self, level: Sequence[Living], last: int) -> None:
        """Take steps back until this one is the last, with these hypotheses."""
        begun = next((n for n, change in enumerate(self._changes) if change.new), 0)
        if last < begun:
            self.begin(level, last)
            return
        self._changes = self._changes[: last + 1]
        if not all(self._plain[last + 1 :]):
            self._clear()
            self._restart(level, last)
            return
        for step in reversed(range(last + 1, len(self._keys))):
            self._take_back(step)
        self._agreed = min(self._agreed, last)

    def _restart(self, level: Sequence[Living], step: int) -> None:
        self._join(level, step)
        self._plain = [False] * (step + 1)
        self._agreed = _agreed(level)

    def _take_back(self, step: int) -> None:
        """Take the last visit back."""
        place, standing = self._keys.pop()
        self._together[place] = self._together[place][:-1]
        if not self._together[place]:
            del self._together[place]
        if self._first.pop() is None:
            del self._turned[standing]
        if (fact := self._fact.pop()) is not None:
            self._facts[fact] -= 1
            if not self._facts[fact]:
                del self._facts[fact]
        self._new.pop()
        del self._plain[step:]

    def _again(self, level: Sequence[Living], step: int) -> None:
        """Go a step on when hypotheses have died or have several children."""
        since = self._agreed + 1
        before = {visit: self._keys[visit][0] for visit in range(since, step)}
        known = {visit for visit in range(since, step) if self._new[visit]}
        facts = {fact for fact in self._fact[since:] if fact is not None}
        for visit in reversed(range(since, step)):
            self._take_back(visit)
        self._join(level, step)
        self._plain += [False] * (step + 1 - len(self._plain))
        touched = {self._keys[visit][0] for visit in range(since, step + 1)}
        joined = []
        for place in touched:
            visits = self._together[place]
            settled = bisect_right(visits, since - 1)
            names: dict[Any, list[int]] = {}
            for visit in visits[settled:]:
                names.setdefault(before.get(visit, ()), []).append(visit)
            if settled:
                visits = visits[:settled] + names.pop(place, [])
            parts = [visits] * bool(settled) + [*names.values()]
            if len(parts) > 1:
                joined.append(tuple((part, len(part)) for part in parts))
        now = Counter(fact for fact in self._fact[since:] if fact is not None)
        self._changes.append(
            Change(
                tuple(joined),
                tuple(v for v in range(since, step + 1) if self._new[v] and v not in known),
                tuple(f for f in now if f not in facts and self._facts[f] == now[f]),
                tuple(fact for fact in facts if fact not in self._facts),
            )
        )
        self._agreed = _agreed(level)

    def _join(self, level: Sequence[Living], step: int) -> None:
        """Add the missing visits up to this step."""
        since = len(self._keys)
        ways = [one.visit.gateways(since) for one in level]
        for number, at in enumerate(zip(*ways, strict=True), since):
            self._add(number, at)

    def _add(self, step: int, at: Sequence[int]) -> tuple[Part, ...] | None:
        """Add a visit, which is at these gateways, and find the parts of its class.

        There are none if the visit is the only one of its class.
        """
        told = self._told
        slots, tolerance = told.slots, told.tolerance
        here = at[0] // slots
        places = tuple(gateway // slots for gateway in at)
        if tolerance:
            many = len(told.steps[step].view)
            ways = [told.star(gateway // slots).ranks[gateway] for gateway in at]
        else:
            many = slots
            ways = [gateway % slots for gateway in at]
        agree = all(place == here for place in places)
        key: Any = here if agree else places
        turns = tuple((way - ways[0]) % many for way in ways)
        standing: Any = key if not any(turns) else (key, turns)
        self._keys.append((key, standing))
        visits = self._together.setdefault(key, [])
        joined = ((visits, len(visits)), ([step], 1)) if visits else None
        visits.append(step)
        self._new.append(agree and here == step)
        first = self._turned.setdefault(standing, (step, ways[0]))
        if first[0] == step:
            self._first.append(None)
        else:
            turn = (ways[0] - first[1]) % many
            slot = sorted(told.steps[first[0]].view)[turn] if tolerance else turn
            self._first.append((first[0], slot))
        fact = self._linked(step)
        self._fact.append(fact)
        if fact is not None:
            self._facts[fact] += 1
        return joined

    def _linked(self, step: int) -> Linked | None:
        """The link of a travel, if one of its ends was certainly seen before.

        It is stated of the first visits there.
        """
        turn = self._told.steps[step].turn
        if turn is None:
            return None
        before, after = self._first[step - 1], self._first[step]
        if before is None and after is None:
            return None
        here, shift = before or (step - 1, 0)
        there, slot = after or (step, 0)
        return here, self._told.slot_at(here, shift, step - 1, turn), there, slot


def _agreed(level: Sequence[Living]) -> int:
    """The last step up to which all hypotheses are equal."""
    visits: set[Visit] = {one.visit for one in level}
    while len(visits) > 1:
        visits = {visit.before for visit in visits}
    return next(iter(visits)).step
