"""Boundary consistency while an experience goes on (semantics: "Boundary consistency").

It finds which links make a place lie on both sides of a path.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

import clingo

from topomap.model.experience import DState, Experience
from topomap.model.topology import Gateway


class Followed(Protocol):
    """What is followed: the steps so far, and the number of each in the program."""

    experience: Experience
    visits: list[int]


class Boundaries(clingo.Propagator):
    """A propagator that refuses maps with inconsistent boundaries, where ``consistent`` holds.

    In such a map a place is both left and right of a path, or both on it and beside it (semantics:
    "Boundary consistency"). The clause names the steps that make it so. As further links do not
    change this, a clause holds for all later steps.
    """

    def __init__(self, follower: Followed):
        self._of = follower
        self._at: list[list[tuple[int, int, int]]] = []  # for each step: place, slot, literal
        self._asked = 0

    def init(self, init: clingo.PropagateInit) -> None:
        """Learn the literals of ``at/3``."""
        step = {visit: number for number, visit in enumerate(self._of.visits)}
        self._at = [[] for _ in step]
        for atom in init.symbolic_atoms.by_signature("at", 3):
            visit, place, slot = (argument.number for argument in atom.symbol.arguments)
            if visit in step:
                literal = init.solver_literal(atom.literal)
                self._at[step[visit]].append((place, slot, literal))
        asked = init.symbolic_atoms[clingo.Function("consistent")]
        self._asked = init.solver_literal(asked.literal) if asked else -1
        init.check_mode = clingo.PropagatorCheckMode.Total

    def check(self, control: clingo.PropagateControl) -> None:
        """Forbid what is wrong with the map that was found."""
        true = control.assignment.is_true
        if not true(self._asked):
            return
        where = [next(one for one in of if true(one[2])) for of in self._at]
        at = [(place, slot) for place, slot, _ in where]
        seen = self._of.experience
        for steps in crossed(seen.slots, seen.turns, at):
            visits = {visit for step in steps for visit in (step - 1, step)}
            nogood = [self._asked, *(where[visit][2] for visit in sorted(visits))]
            if not control.add_nogood(nogood):
                return


def crossed(slots: int, turns: Sequence[int | None], at: Sequence[DState]) -> list[set[int]]:
    """Find why the boundaries of a map are not consistent.

    Returns:
        Sets of steps whose links make it so, the smallest first.
    """
    links: dict[Gateway, tuple[Gateway, int]] = {}
    for step, (turn, (place, slot), arrival) in enumerate(zip(turns, at, at[1:], strict=False), 1):
        if turn is None:
            continue
        out = place, (slot + turn) % slots
        if out not in links:
            links[out], links[arrival] = (arrival, step), (out, step)

    def ray(gateway: Gateway) -> Iterator[tuple[Gateway, int]]:
        """The arrivals of a walk straight on, each with the step that made the link."""
        while gateway in links:
            arrival, step = links[gateway]
            yield arrival, step
            gateway = arrival[0], (arrival[1] + slots // 2) % slots

    found: list[set[int]] = []
    for end, slot in links:
        # Each path is taken once, from its end.
        if (end, (slot + slots // 2) % slots) in links:
            continue
        path, by = [(end, slot)], []
        for (place, entry), link in ray((end, slot)):
            path.append((place, (entry + slots // 2) % slots))
            by.append(link)
        if path[-1] < path[0]:
            continue
        found += _sides(slots, path, by, ray)
    return sorted(found, key=len)[:10]


def _sides(
    slots: int,
    path: Sequence[Gateway],
    by: Sequence[int],
    ray: Callable[[Gateway], Iterator[tuple[Gateway, int]]],
) -> Iterator[set[int]]:
    """Find why a place is on both sides of a path, or both on it and beside it."""
    on = {place: number for number, (place, _) in enumerate(path)}
    beside: dict[Any, tuple[bool, int, list[int]]] = {}
    for number, (place, heading) in enumerate(path):
        for turn in range(1, slots):
            if turn == slots // 2:
                continue
            used: list[int] = []
            for (met, _), step in ray((place, (heading + turn) % slots)):
                used.append(step)
                right = turn < slots // 2
                side, other, rest = beside.get(met, (right, number, []))
                if met in on:
                    other = on[met]
                elif met not in beside:
                    beside[met] = right, number, list(used)
                    continue
                elif side == right:
                    continue
                yield {*used, *rest, *by[min(number, other) : max(number, other)]}
