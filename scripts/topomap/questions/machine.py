"""What maps predict of every walk at once, as an automaton.

It also tells which states some walk tells apart, and which are bisimilar.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

from topomap.questions.standings import Prediction, Standing, sight
from topomap.runtime.watch import Watch

Action = tuple[bool, int]  # whether the marker is put down first, and the turn


@dataclass
class Machine:
    """An automaton of what maps predict.

    It has states, how each looks, and where each action leads (None: to what is not predicted). An
    action that is not there is impossible.
    """

    looks: list[int] = field(default_factory=list)
    moves: list[dict[Action, int | None]] = field(default_factory=list)
    seen: dict[Prediction, int] = field(default_factory=dict)

    def add(self, standing: Standing, carried: bool) -> int:
        """Add the states of a map, and return the state of the agent."""
        world, slots = standing.world, standing.world.slots
        start = standing.dstate, standing.marker, carried
        numbers = {start: len(self.looks)}
        for dstate, lies, carries in (waiting := [start]):
            look = sight(standing, dstate, lies)
            self.looks.append(self.seen.setdefault(look, len(self.seen)))
            moves: dict[Action, int | None] = {}
            for turn in sorted(look.view):
                end = world.links.get((dstate[0], (dstate[1] + turn) % slots))
                for drops in (False, True) if carries else (False,):
                    if end is None:
                        moves[drops, turn] = None
                        continue
                    state = end, dstate[0] if drops else lies, carries and not drops
                    if state not in numbers:
                        numbers[state] = numbers[start] + len(numbers)
                        waiting.append(state)
                    moves[drops, turn] = numbers[state]
            self.moves.append(moves)
        return numbers[start]

    def merged(self, starts: Sequence[int], watch: Watch) -> tuple["Machine", list[int]]:
        """Merge states that predict the same of every walk.

        Returns:
            The smaller automaton, and the starts in it.
        """
        block, number = self.looks, len(set(self.looks))
        while True:
            watch.tick()
            names: dict[Any, int] = {}
            finer = [
                names.setdefault((here, *_ends(block, moves)), len(names))
                for here, moves in zip(block, self.moves, strict=True)
            ]
            if len(names) == number:
                break
            block, number = finer, len(names)
        first = {block[state]: state for state in reversed(range(len(block)))}
        made = Machine([0] * number, [{}] * number)
        for name, state in first.items():
            made.looks[name] = self.looks[state]
            moves = self.moves[state]
            made.moves[name] = {a: to if to is None else block[to] for a, to in moves.items()}
        return made, [block[start] for start in starts]


def _ends(block: Sequence[int], moves: dict[Action, int | None]) -> Iterator[int | None]:
    return (end if end is None else block[end] for end in moves.values())


class Spent(Exception):
    """A search has used up its work."""


class Work:
    """How much work a search may still do."""

    def __init__(self, watch: Watch, left: int):
        self.watch, self.left = watch, left

    def take(self, much: int = 1) -> None:
        """Count work that is done."""
        if self.left // 4096 != (self.left - much) // 4096:
            self.watch.tick()
        self.left -= much
        if self.left < 0:
            raise Spent


def pairs_apart(machine: Machine, starts: Sequence[int], work: Work) -> set[tuple[int, int]] | None:
    """Find the pairs of states, to which walks lead at once, that some walk tells apart.

    It is None if that takes too much work.
    """
    pairs = list(combinations(sorted(set(starts)), 2))
    before: dict[tuple[int, int], list[tuple[int, int]]] = {pair: [] for pair in pairs}
    apart = []
    try:
        for pair in pairs:
            one, other = pair
            if machine.looks[one] != machine.looks[other]:
                apart.append(pair)
                continue
            work.take(len(machine.moves[one]))
            for action, end in machine.moves[one].items():
                to = machine.moves[other].get(action)
                if end is None or to is None or end == to:
                    continue
                following = min(end, to), max(end, to)
                if following not in before:
                    before[following] = []
                    pairs.append(following)
                before[following].append(pair)
    except Spent:
        return None
    found = set(apart)
    for pair in apart:
        for earlier in before[pair]:
            if earlier not in found:
                found.add(earlier)
                apart.append(earlier)
    return found
