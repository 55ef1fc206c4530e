"""The hypotheses of an experience that goes on, by clingo.

It tells how many there are, the best maps, and what is certain. clingo keeps its program
(``encodings/online.lp``), and each step grounds only its own part. A step that is taken back is
switched off, and the step that replaces it has a number of its own in the program. The search finds
the number of hypotheses from the hypotheses of the step before.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import clingo

from topomap.model.experience import MARKER, DState, Experience, Step
from topomap.model.query import Query
from topomap.runtime.folders import ENCODINGS
from topomap.runtime.limits import DRIFT, MOST_COUNTED, STRETCH
from topomap.runtime.watch import Watch
from topomap.search.certainty import Certain, Linked
from topomap.search.hypothesis import OFTEN, Hypothesis
from topomap.search.traversal import root
from topomap.solver.boundaries import Boundaries
from topomap.solver.solving import best

TRIED = 10  # so many times as many nodes are visited to find that there are more
MAPS = 100  # the number of best maps that are kept


@dataclass(frozen=True)
class Asked:
    """Which hypotheses are asked for, and how exact measurements are.

    ``most`` is the largest number of hypotheses that is counted. ``drift`` and ``stretch`` tell, in
    percent, how wrong shifts and lengths may be, and ``tolerance``, in slots, how wrong bearings
    may be.
    """

    planar: bool = False
    bound: int | None = None
    most: int = MOST_COUNTED
    drift: int = DRIFT
    stretch: int = STRETCH
    tolerance: int = 0
    path_axiom: bool = True


class Stepwise:
    """An exploration that goes on from its start; steps can be taken back."""

    def __init__(self, slots: int, first: Step, asked: Asked):
        """Begin at the start, where the first view was seen.

        Without the path axiom, or if it is known which gateways are on one path, the best maps are
        found anew after each step, because the program does not know the number of paths then, or
        what is left and right of them. If bearings are not exact, there is no program, and the
        hypotheses are those of the search.
        """
        marked = ([0] * (name in first.marks) for name in MARKER)
        self.experience = Experience(
            slots,
            (first.view,),
            (),
            (first.landmarks,),
            *marked,
            compass=[first.compass],
            things=[(kind, 0, name) for kind, name in first.things],
            drift=asked.drift,
            stretch=asked.stretch,
            tolerance=asked.tolerance,
            straight=[] if first.straight is None else [first.straight],
        )
        self.most = asked.most
        parts = {"planar": asked.planar, "no_path_axiom": not asked.path_axiom}
        self._query = Query(
            frozenset(part for part, wanted in parts.items() if wanted), asked.bound
        )
        self._parts = ["step", *(["planar"] if asked.planar else [])]
        arguments = [
            "0",
            "--project",
            "-c",
            f"drift={asked.drift}",
            "-c",
            f"stretch={asked.stretch}",
        ]
        if asked.bound is not None:
            self._parts.append("bound")
            arguments += ["-c", f"places={asked.bound}"]
        self._control = clingo.Control(arguments)
        self._control.load(str(ENCODINGS / "online.lp"))
        self._control.load(str(ENCODINGS / "online/certain.lp"))
        self._boundaries = Boundaries(self)
        self._control.register_propagator(self._boundaries)
        # no_path_axiom.lp needs topomap.lp, so it is not loaded.
        told = "straight_told. " * bool(self.experience.straight)
        told += "no_path_axiom. " * (not asked.path_axiom)
        self._control.add("base", [], f"online. slots({slots}). {told}#external consistent.")
        self.visits: list[int] = []  # the number of each step in the program
        self._numbered = 0
        self._level: list[tuple[int, ...]] = [(0,)]  # the hypotheses after some step
        self._wide = False  # whether a later step has too many of them
        self._none: int | None = None
        self._ground([], ("base", []))

    @property
    def rules(self) -> int:
        """The number of ground rules so far."""
        return int(self._control.statistics["problem"]["lp"]["rules"])

    @property
    def size(self) -> int:
        """The size of the program: the number of ground atoms so far."""
        return len(self._control.symbolic_atoms)

    def step(self, step: Step) -> None:
        """Go a step on.

        The caller has checked that the turn leads to a gateway, and that the marker is not put down
        twice.
        """
        self.experience = self.experience.then(step)
        pairs = {"same": step.same, "apart": step.apart}
        told = [
            f"{name}({self.visits[earlier]},{self._numbered})."
            for name, steps in pairs.items()
            for earlier in steps
            if earlier < self.experience.steps
        ]
        self._ground(told)

    def _ground(self, told: Sequence[str], *parts: tuple[str, list[clingo.Symbol]]) -> None:
        visit, step = self._numbered, self.experience.steps
        if self.experience.tolerance:
            self.visits.append(visit)
            self._numbered += 1
            return
        facts = [*self.experience.facts_of(step, visit), *told]
        if step:
            facts.append(f"after({visit},{self.visits[-1]}).")
        self._control.add(f"facts{visit}", [], " ".join(facts))
        mine = [(part, [clingo.Number(visit)]) for part in self._parts]
        self._control.ground([*parts, (f"facts{visit}", []), *mine])
        self.visits.append(visit)
        self._numbered += 1

    def undo(self, steps: int = 1) -> None:
        """Take the last steps back; there must be as many."""
        left = self.experience.steps - steps
        self.experience = self.experience.cut(left)
        for visit in self.visits[left + 1 :] if not self.experience.tolerance else ():
            self._control.release_external(_atom("active", visit))
        del self.visits[left + 1 :]
        if len(self._level[0]) > left + 1:
            self._level = [(0,)]
        self._wide = False
        if self._none is not None and self._none > left:
            self._none = None

    def begin(self, level: Sequence[tuple[int, ...]]) -> None:
        """Learn the hypotheses after some step."""
        self._level, self._wide = [*level], False

    @property
    def level(self) -> list[tuple[int, ...]] | None:
        """All hypotheses after the last step, as gateways, if they have been counted."""
        known = self._none is None and len(self._level[0]) == self.experience.steps + 1
        return self._level if known else None

    def number(self, certain: Certain | None, watch: Watch) -> tuple[int, bool, int | None]:
        """Count the hypotheses, for which what is certain may be of use.

        Returns:
            What ``count`` returns, and the first step after which there is no hypothesis.
        """
        number, exact = self.count(watch)
        if certain and not certain.new and self._none is None:  # the first place is always new
            self._none, number, exact = self.experience.steps, 0, True
        return number, exact, self._none

    def count(self, watch: Watch) -> tuple[int, bool]:
        """Count the hypotheses.

        Returns:
            Their number and True; or False and a number that they exceed (-1 if none has been
            found).
        """
        if self._none is not None:
            return 0, True
        node = root(self.experience, self._query)
        while len(self._level[0]) <= self.experience.steps:
            level = None if self._wide else self._next(node, watch)
            if level is None:
                self._wide = True
                return self._more(node, watch)
            if not level:
                self._none = len(self._level[0])
                return 0, True
            self._level = level
        return len(self._level), True

    def _next(self, node: Hypothesis, watch: Watch) -> list[tuple[int, ...]] | None:
        """Find the next level of the tree, if it is not too large."""
        level: list[tuple[int, ...]] = []
        before = tuple(node.at)
        for number, at in enumerate(self._level):
            _go(node, before, at)
            before = at
            level += [(*at, arrival) for arrival in node.children()]
            if len(level) > self.most:
                return None
            if number % OFTEN == 0:
                watch.tick()
        return level

    def _more(self, node: Hypothesis, watch: Watch) -> tuple[int, bool]:
        """Count the next level depth-first, if a level in between is too large to be kept."""
        leaves = nodes = deepest = 0
        last = self.experience.steps
        kept = []
        before = tuple(node.at)
        for top in self._level:
            border = [top]
            while border:
                _go(node, before, at := border.pop())
                before = at
                nodes += 1
                if nodes % OFTEN == 0:
                    watch.tick()
                for arrival in node.children():
                    if len(at) < last:
                        border.append((*at, arrival))
                    else:
                        leaves += 1
                        kept.append((*at, arrival))
                if leaves > self.most or nodes > TRIED * self.most:
                    return min(leaves - 1, self.most), False
                deepest = max(deepest, len(at))
        if kept:
            self._level, self._wide = sorted(kept), False
        else:
            self._none = deepest
        return leaves, True

    def best(self, watch: Watch) -> tuple[str | None, tuple[int, ...], list[tuple[DState, ...]]]:
        """Find the best maps, at most one more than ``MAPS``: their kind and their cost.

        Maps without exceptions to consistent boundaries are looked for step by step. If all closed
        maps have some, or all maps, the best ones are found anew, from the whole.
        """
        seen = self.experience
        if "no_path_axiom" in self._query.parts or seen.straight or seen.tolerance:
            return self._anew(watch)
        closed = [(_atom("closed", self.visits[-1]), True)]
        for kind, assumed in (("optimal", closed), ("best so far", [])):
            cost, found = self._best(watch, assumed, consistent=True)
            if found:
                return kind, (0, *cost), sorted(found)
            if self._best(watch, assumed, consistent=False, most=1)[1]:
                return self._anew(watch)
        return None, (), []

    def _anew(self, watch: Watch) -> tuple[str | None, tuple[int, ...], list[tuple[DState, ...]]]:
        """Find the best maps from scratch."""
        proved = (one for one in best(self.experience, self._query, watch) if one and one.proved)
        maps = [*islice(proved, MAPS + 1)]
        if not maps:
            return None, (), []
        return maps[0].kind, maps[0].cost, sorted(one.at for one in maps)

    def _best(
        self,
        watch: Watch,
        assumed: Sequence[tuple[clingo.Symbol, bool]],
        consistent: bool,
        most: int = MAPS + 1,
    ) -> tuple[tuple[int, ...], list[tuple[DState, ...]]]:
        """Find maps with the fewest paths, then the fewest places, and their cost.

        They have ``consistent`` boundaries, or may have any; at most ``most`` are found.
        """
        found: list[tuple[DState, ...]] = []
        cost: list[int] = []

        def take(model: clingo.Model) -> bool:
            """Note a map."""
            if model.optimality_proven or not consistent:
                cost[:] = model.cost
                found.append(self._dstates(model))
            return len(found) < most

        self._configure("auto", "optN" if consistent else "ignore")
        self._control.assign_external(_atom("consistent"), consistent)
        try:
            self._solve(watch, assumed, take)
        finally:
            self._control.assign_external(_atom("consistent"), False)
        return tuple(cost), found

    def certain(self, watch: Watch) -> Certain | None:
        """Find what holds in all hypotheses (the cautious consequences); nothing, if there is none.

        It is None if there is no program and the search has not found all hypotheses because they
        are too many.
        """
        if self.experience.tolerance:
            _, exact = self.count(watch)
            return self._certain_of(self._level) if exact else None
        atoms: list[clingo.Symbol] = []

        def take(model: clingo.Model) -> bool:
            """Note the consequences so far."""
            atoms[:] = model.symbols(shown=True)
            return True

        self._configure("cautious", "ignore")
        self._solve(watch, [], take)
        step = {visit: number for number, visit in enumerate(self.visits)}
        same, new = set(), set()
        first: dict[int, tuple[int, int]] = {}
        for atom in atoms:
            numbers = [argument.number for argument in atom.arguments]
            if atom.name == "at" or any(number not in step for number in numbers[:2]):
                continue
            if atom.name == "new":
                new.add(step[numbers[0]])
            elif atom.name == "together":
                same.add((step[numbers[0]], step[numbers[1]]))
            elif atom.name == "one_place":
                here, there = step[numbers[0]], step[numbers[1]]
                first[there] = min(first.get(there, (here, numbers[2])), (here, numbers[2]))
        return Certain(frozenset(same), frozenset(new), frozenset(self._linked(first)))

    def _certain_of(self, hypotheses: Sequence[tuple[int, ...]]) -> Certain:
        """What holds in all of these hypotheses."""
        seen = self.experience
        if self._none is not None or not hypotheses:
            return Certain(frozenset(), frozenset(), frozenset())
        slots = seen.slots
        stars = [sorted(view) for view in seen.views]
        places = [tuple(gateway // slots for gateway in at) for at in hypotheses]
        steps = range(seen.steps + 1)
        same, new = set(), set()
        first: dict[int, tuple[int, int]] = {}
        for later in steps:
            if all(at[later] == later for at in places):
                new.add(later)
            for earlier in range(later):
                if any(at[earlier] != at[later] for at in places):
                    continue
                same.add((earlier, later))
                # The gateway of the earlier visit that has this number there.
                turned = {
                    (star.index(at[later] % slots) - star.index(at[earlier] % slots)) % len(star)
                    for at in hypotheses
                    for star in [stars[at[later] // slots]]
                }
                if len(turned) == 1:
                    first.setdefault(later, (earlier, stars[earlier][turned.pop()]))
        return Certain(frozenset(same), frozenset(new), frozenset(self._linked(first)))

    def _linked(self, first: dict[int, tuple[int, int]]) -> Iterator[Linked]:
        """The links of steps that certainly ended at places seen before.

        They are stated of the first visits there.
        """
        for step, turn in enumerate(self.experience.turns, 1):
            if turn is None:
                continue
            if step - 1 in first or step in first:
                here, shift = first.get(step - 1, (step - 1, 0))
                there, slot = first.get(step, (step, 0))
                yield here, self.experience.slot_at(here, shift, step - 1, turn), there, slot

    def _dstates(self, model: clingo.Model) -> tuple[DState, ...]:
        step = {visit: number for number, visit in enumerate(self.visits)}
        facts = [
            [argument.number for argument in atom.arguments]
            for atom in model.symbols(shown=True)
            if atom.name == "at"
        ]
        at = {step[visit]: (step[place], slot) for visit, place, slot in facts if visit in step}
        return tuple(at[number] for number in range(len(self.visits)))

    def _configure(self, enumerate_by: str, optimize_by: str) -> None:
        configuration: Any = self._control.configuration.solve
        configuration.enum_mode, configuration.opt_mode = enumerate_by, optimize_by

    def _solve(
        self,
        watch: Watch,
        assumed: Sequence[tuple[clingo.Symbol, bool]],
        take: Callable[[clingo.Model], bool],
    ) -> None:
        with self._control.solve(assumed, on_model=take, async_=True) as handle:
            while not handle.wait(0.1):
                watch.tick()  # an error in it ends the call
            handle.get()


def _atom(name: str, *numbers: int) -> clingo.Symbol:
    return clingo.Function(name, [clingo.Number(number) for number in numbers])


def _go(node: Hypothesis, before: tuple[int, ...], at: tuple[int, ...]) -> None:
    """Go from the current node of the tree to another one."""
    common = min(len(before), len(at))
    while before[:common] != at[:common]:
        common -= 1
    for _ in range(common, len(node.at)):
        node.undo()
    for arrival in at[common:]:
        node.enter(arrival)
