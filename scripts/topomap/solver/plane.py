"""Planarity for ``lines.lp``, as clauses that are added when the search violates it.

In a planar map two closed walks cross an even number of times. If the current map of the search is
not planar, this looks for two short circuits of it that cross an odd number of times, and forbids
the literals that make them cross so:

- a circuit goes by links, and so by steps; where it changes from one step to another, the two are
  at one place: ``one_place(P,T,S)`` holds;
- where the two circuits cross, so do the visits that they share there;
- they cross nowhere else: no ``one_place(P,T,S)`` holds that would make them cross.

Each such clause holds in every planar map, whatever else is seen. Not every map that is not planar
is refused, because only short circuits are considered; ``planar.lp`` refuses the others.
"""

from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from itertools import combinations

import clingo

EVERY = 20  # fixpoints of the search between two looks at its map
FAR = 7  # links: the largest distance from a place of the circuits through it
CIRCUITS = 80  # the number of circuits that are compared, the shortest ones
CLAUSES = 10  # the largest number from one look

Dart = tuple[int, int]  # a place, known by its first visit, and a gateway of it
Link = tuple[Dart, Dart]  # a link in one direction
Step = tuple[int, bool]  # a step, and whether it is taken backwards


class Planarity(clingo.Propagator):
    """A propagator that refuses maps that are not planar."""

    def __init__(self, slots: int):
        self._slots = slots
        self._move: list[int] = [0]  # for each step
        # For two visits: the slots by which one can be turned against the other, with the
        # literals that say so.
        self._same: dict[tuple[int, int], dict[int, int]] = defaultdict(dict)
        self._due: list[list[int]] = []  # clauses, as the literals that they forbid
        self._fixpoints = 0

    def init(self, init: clingo.PropagateInit) -> None:
        """Learn the steps, and the literals of ``one_place/3``."""
        atoms = init.symbolic_atoms
        moves = sorted(_numbers(atom) for atom in atoms.by_signature("move", 2))
        self._move += [slot for _, slot in moves]
        for atom in atoms.by_signature("one_place", 3):
            visit, later, slot = _numbers(atom)
            if visit < later:
                literal = init.solver_literal(atom.literal)
                self._same[visit, later][slot] = literal
                self._same[later, visit][-slot % self._slots] = literal
        init.check_mode = clingo.PropagatorCheckMode.Both

    def check(self, control: clingo.PropagateControl) -> None:
        """Examine the map, but not at each fixpoint of the search."""
        assignment = control.assignment
        self._fixpoints += 1
        if not self._add(control):
            return
        if assignment.is_total or self._fixpoints % EVERY == 0:
            for forbidden in _Look(self._slots, self._move, self._same, assignment).forbidden():
                # If another literal is open, the clause has no effect yet.
                if sum(not assignment.is_true(literal) for literal in forbidden) <= 1:
                    self._due.append(forbidden)
            self._add(control)

    def _add(self, control: clingo.PropagateControl) -> bool:
        """Add the clauses that are due, and tell whether the search can go on unchanged."""
        due = bool(self._due)
        while self._due:
            if not control.add_nogood(self._due.pop()):
                return False
        return not due or control.propagate()


class _Look:
    """The map that an assignment makes: visits are of one place if that is decided."""

    def __init__(
        self,
        slots: int,
        move: Sequence[int],
        same: dict[tuple[int, int], dict[int, int]],
        assignment: clingo.Assignment,
    ):
        self._slots, self._move, self._same = slots, move, same
        self._assignment = assignment
        self._place: list[int] = []  # for each visit: the first visit of its place
        self._gate: list[int] = []  # and its gateway, as seen by the first visit
        firsts: list[int] = []
        for visit in range(len(move)):
            place, gate = self._known(visit, firsts)
            if place == visit:
                firsts.append(visit)
            self._place.append(place)
            self._gate.append(gate)
        self._links: dict[Dart, Dart] = {}
        self._steps: dict[Link, list[Step]] = defaultdict(list)
        for step in range(1, len(move)):
            out = self._place[step - 1], (self._gate[step - 1] + move[step]) % slots
            into = self._place[step], self._gate[step]
            self._links[out], self._links[into] = into, out
            self._steps[out, into].append((step, False))
            self._steps[into, out].append((step, True))
        self._from: dict[int, list[Link]] = defaultdict(list)
        for link in self._links.items():
            self._from[link[0][0]].append(link)

    def _known(self, visit: int, firsts: Sequence[int]) -> tuple[int, int]:
        for first in firsts:
            for slot, literal in self._same.get((first, visit), {}).items():
                if self._assignment.is_true(literal):
                    return first, slot
        return visit, 0

    def forbidden(self) -> list[list[int]]:
        """Sets of literals that exclude each other, the longest first; none for a planar map."""
        if self._planar():
            return []
        circuits = sorted(self._circuits(), key=len)[:CIRCUITS]
        corners = [self._corners(circuit) for circuit in circuits]
        odd = [
            pair
            for pair in combinations(range(len(circuits)), 2)
            if self._odd(*(corners[number] for number in pair))
        ]
        odd.sort(key=lambda pair: sum(len(circuits[number]) for number in pair))
        found = [self._why(*(circuits[number] for number in pair)) for pair in odd[:CLAUSES]]
        return sorted(found, key=len, reverse=True)

    def _planar(self) -> bool:
        """Tell whether the map is planar by Euler's formula, as it is connected."""
        faces, seen = 0, set()
        for start in self._links:
            faces += start not in seen
            dart = start
            while dart not in seen:
                seen.add(dart)
                place, slot = self._links[dart]
                slot = (slot + 1) % self._slots
                while (place, slot) not in self._links:
                    slot = (slot + 1) % self._slots
                dart = place, slot
        return len(self._from) - len(self._links) // 2 + faces == 2

    def _circuits(self) -> list[list[Link]]:
        """Find short circuits, each once.

        Each consists of two shortest ways from a place, and a link between their ends.
        """
        found: dict[frozenset[Dart], list[Link]] = {}
        for root in self._from:
            way: dict[int, list[Link]] = {root: []}
            queue = deque([root])
            while queue:
                place = queue.popleft()
                for link in self._from[place]:
                    end = link[1][0]
                    if end not in way:
                        if len(way[place]) < FAR:
                            way[end] = [*way[place], link]
                            queue.append(end)
                    elif link[0] < link[1]:
                        self._close(way[place], link, way[end], found)
        return list(found.values())

    @staticmethod
    def _close(
        way: list[Link], link: Link, other: list[Link], found: dict[frozenset[Dart], list[Link]]
    ) -> None:
        back = link[1], link[0]
        if link in other[-1:] or back in way[-1:] or (way and other and way[0] == other[0]):
            return  # a link of the two ways, or a circuit that does not pass the root
        circuit = [*way, link, *((end, start) for start, end in reversed(other))]
        found.setdefault(frozenset(dart for link in circuit for dart in link), circuit)

    @staticmethod
    def _corners(circuit: Sequence[Link]) -> dict[int, tuple[int, int]]:
        """The gateways by which a circuit comes and goes, by place."""
        return {
            into[0]: (into[1], out[1])
            for (_, into), (out, _) in zip(circuit, [*circuit[1:], circuit[0]], strict=True)
        }

    def _odd(self, one: dict[int, tuple[int, int]], two: dict[int, tuple[int, int]]) -> bool:
        return sum(self._cross(*one[p], *two[p]) for p in one.keys() & two.keys()) % 2 == 1

    def _cross(self, come: int, go: int, enter: int, leave: int) -> bool:
        """Tell whether a walk crosses, at one place, another one that comes and goes there.

        It keeps to the right of the links that they share.
        """
        turn = (go - come) % self._slots
        right = 0 < (enter - come) % self._slots <= turn
        return turn != 0 and right != ((leave - come) % self._slots < turn)

    def _why(self, one: Sequence[Link], two: Sequence[Link]) -> list[int]:
        """The literals that make these circuits cross an odd number of times."""
        literals: set[int] = set()
        seconds = list(self._passed(two, literals))
        for visits, come, go in self._passed(one, literals):
            for others, enter, leave in seconds:
                if visits.isdisjoint(others):
                    pair = min(visits), min(others)
                    literals.update(self._apart(pair, (come, go), (enter, leave)))
        fixed = self._assignment.is_fixed
        true = self._assignment.is_true
        return [literal for literal in literals if not (fixed(literal) and true(literal))]

    def _apart(
        self, pair: tuple[int, int], one: tuple[int, int], two: tuple[int, int]
    ) -> list[int]:
        """Why two circuits cross, or do not, where each passes one of these visits."""
        visit, other = pair
        crossing = []
        for slot, literal in self._same.get(pair, {}).items():
            # Gateways are numbered by their current places; the literal tells how they correspond.
            turn = slot - self._gate[other] + self._gate[visit]
            if self._cross(*one, *(gate + turn for gate in two)):
                crossing.append(literal)
        true = [literal for literal in crossing if self._assignment.is_true(literal)]
        return true or [-literal for literal in crossing]

    def _passed(
        self, circuit: Sequence[Link], literals: set[int]
    ) -> Iterator[tuple[set[int], int, int]]:
        """Go round a circuit by steps.

        Where one step ends and the next begins, the two visits are of one place, which the literals
        say.

        Returns:
            These visits, with the gateways.
        """
        steps = self._walk(circuit)
        ends = zip(circuit, steps, [*circuit[1:], circuit[0]], [*steps[1:], steps[0]], strict=True)
        for (_, into), (came, back), (out, _), (goes, against) in ends:
            come, go = came - back, goes - (not against)
            if come != go:
                turn = (self._gate[go] - self._gate[come]) % self._slots
                literals.add(self._same[come, go][turn])
            yield {come, go}, into[1], out[1]

    def _walk(self, circuit: Sequence[Link]) -> list[Step]:
        """For each link, choose a step along it, if possible one that continues the last step."""
        steps: list[Step] = []
        for link in circuit:
            along = self._steps[link]
            on = [(step - 1 if back else step + 1, back) for step, back in steps[-1:]]
            steps.append(next((step for step in on if step in along), along[0]))
        return steps


def _numbers(atom: clingo.SymbolicAtom) -> tuple[int, ...]:
    return tuple(argument.number for argument in atom.symbol.arguments)
