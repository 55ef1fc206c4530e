"""How long a walk is worth asking clingo for.

This is found by a breadth-first search of what the maps can predict together.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from topomap.questions.machine import Action, Machine, Spent, Work

Walk = tuple[Action, ...]
Key = Any  # it can be hashed; it determines how the search goes on
Weighed = tuple[tuple[int, int], ...]  # states, each with the number of its maps
# Maps with the same views so far, and how many others cannot be distinguished from them.
Group = tuple[int, Weighed]


class Game:
    """What a search goes by: a state is a key and a score, and a lower score is better."""

    root: tuple[Key, int]

    def after(self, key: Key, score: int) -> Iterator[tuple[Action, Key, int]]:
        """The states to which the actions lead."""
        raise NotImplementedError

    def value(self, key: Key, score: int) -> int:
        """The value of the walk so far."""
        raise NotImplementedError

    def bound(self, key: Key, score: int) -> int:
        """A lower bound on the value of each walk that goes on from here."""
        raise NotImplementedError


class Telling(Game):
    """The game of telling maps apart; its value is how many maps are left in the worst case.

    A key has the groups of maps that views may still tell apart. The score is how many maps are
    left in a group that is already settled.
    """

    def __init__(
        self,
        machine: Machine,
        starts: Iterable[tuple[int, int]],
        apart: set[tuple[int, int]] | None,
    ):
        self.machine, self.apart = machine, apart
        self.root = self._state(self._parts(0, starts), 0)

    def _parts(self, more: int, weighed: Iterable[tuple[int, int]]) -> Iterator[Group]:
        looks: dict[int, dict[int, int]] = {}
        for state, weight in weighed:
            part = looks.setdefault(self.machine.looks[state], {})
            part[state] = part.get(state, 0) + weight
        for part in looks.values():
            yield more, tuple(sorted(part.items()))

    def _state(self, groups: Iterable[Group], score: int) -> tuple[frozenset[Group], int]:
        kept = set()
        for more, weighed in groups:
            if len(weighed) > 1:
                kept.add((more, weighed))
            else:
                score = max(score, more + weighed[0][1])
        return frozenset(kept), score

    def after(self, key: frozenset[Group], score: int) -> Iterator[tuple[Action, Key, int]]:
        """The states to which the actions lead."""
        actions = {a for _, weighed in key for a in self.machine.moves[weighed[0][0]]}
        for action in sorted(actions):
            groups: list[Group] = []
            least = score
            for more, weighed in key:
                every = more + sum(weight for _, weight in weighed)
                if action not in self.machine.moves[weighed[0][0]]:
                    least = max(least, every)  # their walk has ended
                    continue
                ends = [(self.machine.moves[state][action], weight) for state, weight in weighed]
                known = [(end, weight) for end, weight in ends if end is not None]
                lost = every - more - sum(weight for _, weight in known)
                if lost:
                    least = max(least, every)  # they predict nothing any more
                groups += self._parts(more + lost, known)
            yield action, *self._state(groups, least)

    def value(self, key: frozenset[Group], score: int) -> int:
        """How many maps are left in the worst case."""
        return max([score, *(more + sum(w for _, w in weighed) for more, weighed in key)])

    def bound(self, key: frozenset[Group], score: int) -> int:
        """A lower bound on how many maps any walk from here leaves."""
        return max([score, *(more + self._alike(weighed) for more, weighed in key)])

    def _alike(self, weighed: Weighed) -> int:
        """An upper bound on how many maps of the group no walk distinguishes from one of them."""
        if self.apart is None:
            return max(weight for _, weight in weighed)
        return max(
            sum(w for other, w in weighed if (min(one, other), max(one, other)) not in self.apart)
            for one, _ in weighed
        )


class Seeking(Game):
    """The game of finding a pending gateway; its value is how many maps predict the whole walk.

    A key has the dstates of the agent in the maps in which the walk goes on. The score is how many
    maps have not come to a pending gateway.
    """

    def __init__(self, machine: Machine, starts: Sequence[tuple[int, int]]):
        self.machine = machine
        before: dict[int, list[int]] = {}
        for state, moves in enumerate(machine.moves):
            for end in moves.values():
                if end is not None:
                    before.setdefault(end, []).append(state)
        reached = [state for state, moves in enumerate(machine.moves) if None in moves.values()]
        self.open = set(reached)
        for state in reached:
            for earlier in before.get(state, ()):
                if earlier not in self.open:
                    self.open.add(earlier)
                    reached.append(earlier)
        self.root = self._state(starts), sum(weight for _, weight in starts)

    def _state(self, weighed: Iterable[tuple[int, int]]) -> Weighed:
        merged: dict[int, int] = {}
        for state, weight in weighed:
            if state in self.open:
                merged[state] = merged.get(state, 0) + weight
        return tuple(sorted(merged.items()))

    def after(self, key: Weighed, score: int) -> Iterator[tuple[Action, Key, int]]:
        """The states to which the actions lead."""
        for action in sorted({a for state, _ in key for a in self.machine.moves[state]}):
            ends = [
                (self.machine.moves[state][action], weight)
                for state, weight in key
                if action in self.machine.moves[state]
            ]
            lost = sum(weight for end, weight in ends if end is None)
            on = [(end, weight) for end, weight in ends if end is not None]
            yield action, self._state(on), score - lost

    def value(self, key: Weighed, score: int) -> int:
        """How many maps predict the whole walk."""
        return score

    def bound(self, key: Weighed, score: int) -> int:
        """A lower bound on how many maps predict the whole of any walk from here."""
        return score - sum(weight for _, weight in key)


@dataclass
class Best:
    """The best walk that is known, and its value.

    No walk of up to ``length`` steps (of any length, if it is None) has a better value, or the same
    one after fewer steps. ``least`` is a lower bound on the value of any walk.
    """

    value: int
    walk: Walk
    least: int
    length: int | None = 0


def breadth_first(game: Game, steps: int, work: Work, best: Best) -> None:
    """Search breadth-first; what is known is kept in ``best``, even if the search is stopped."""
    level: list[tuple[Key, int, Walk]] = [(*game.root, ())]
    known = {game.root[0]: game.root[1]}
    try:
        for length in range(steps + 1):
            best.length = length
            if best.value <= best.least or not level:
                best.length = None
                return
            if length == steps:
                return
            following = []
            for key, score, walk in level:
                if game.bound(key, score) >= best.value:
                    continue
                for action, there, less in game.after(key, score):
                    work.take(1 + sum(map(len, there)))
                    if known.get(there, less + 1) <= less:
                        continue
                    known[there] = less
                    if (value := game.value(there, less)) < best.value:
                        best.value, best.walk = value, (*walk, action)
                    if game.bound(there, less) < best.value:
                        following.append((there, less, (*walk, action)))
            level = following
    except Spent:
        if best.value <= best.least:  # all shorter walks are known
            best.length = None
