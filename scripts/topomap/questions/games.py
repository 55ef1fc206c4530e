"""How long a walk is worth asking clingo for: a search, breadth first, of what maps can predict
together."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from topomap.questions.machine import Action, Machine, Spent, Work

Walk = tuple[Action, ...]
Key = Any  # hashable: what of a state of a search decides how it goes on
Weighed = tuple[tuple[int, int], ...]  # states, each with how many maps it stands for
Group = tuple[int, Weighed]  # maps seen alike so far, and how many more are not told from them


class Game:
    """What a search goes by: a state is a key and a score, and the less the score the better."""

    root: tuple[Key, int]

    def after(self, key: Key, score: int) -> Iterator[tuple[Action, Key, int]]:
        """Where each action leads."""
        raise NotImplementedError

    def value(self, key: Key, score: int) -> int:
        """What the walk so far comes to."""
        raise NotImplementedError

    def bound(self, key: Key, score: int) -> int:
        """No walk that goes on from here comes to less."""
        raise NotImplementedError


class Telling(Game):
    """How many maps are left in the worst case. A key is the groups of maps that what is seen
    may still part; the score is how many are left of a map whose part is settled."""

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
                    least = max(least, every)  # they predict nothing from here on
                groups += self._parts(more + lost, known)
            yield action, *self._state(groups, least)

    def value(self, key: frozenset[Group], score: int) -> int:
        return max([score, *(more + sum(w for _, w in weighed) for more, weighed in key)])

    def bound(self, key: frozenset[Group], score: int) -> int:
        return max([score, *(more + self._alike(weighed) for more, weighed in key)])

    def _alike(self, weighed: Weighed) -> int:
        """How many of the group no walk tells from one of them, at the most."""
        if self.apart is None:
            return max(weight for _, weight in weighed)
        return max(
            sum(w for other, w in weighed if (min(one, other), max(one, other)) not in self.apart)
            for one, _ in weighed
        )


class Seeking(Game):
    """How many maps predict all of the walk. A key is where the agent may be in those of which
    the walk goes on; the score is how many have not come to a pending gateway."""

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
        return score

    def bound(self, key: Weighed, score: int) -> int:
        return score - sum(weight for _, weight in key)


@dataclass
class Best:
    """The best walk known, what it comes to, and that no walk of up to ``length`` steps (any, if
    None) does better or does it sooner; ``least`` bounds what any comes to."""

    value: int
    walk: Walk
    least: int
    length: int | None = 0


def breadth_first(game: Game, steps: int, work: Work, best: Best) -> None:
    """Search breadth-first; what is known is kept in ``best`` also if it is stopped."""
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
        if best.value <= best.least:  # it is one step longer than those of which all are known
            best.length = None
