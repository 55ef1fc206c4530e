"""Where to go next: the walk that tells maps apart, or that leads to what no map predicts.

clingo chooses the walk, over all the maps at once (``encodings/explore.lp``, ``unseen.lp``), and
finds the bisimulations that prove that there is none (``bisimilar.lp``). Which lengths of the walk
are worth asking for is found before, by a search of what the maps can predict together.
"""

import re
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import clingo

from topomap.documents import bisimulation
from topomap.model.topology import Gateway
from topomap.questions.games import Best, Game, Seeking, Telling, Walk, breadth_first
from topomap.questions.machine import Machine, Work, pairs_apart
from topomap.questions.standings import Prediction, Standing, facts, predict, shape, sight, tells
from topomap.runtime.folders import ENCODINGS
from topomap.runtime.limits import LONGEST_WALK
from topomap.runtime.watch import Attempt, Watch
from topomap.solver.programs import Program
from topomap.solver.threads import Put, in_thread

# Reasons, besides lack of time, why a plan may not be the best.
LIMITS = ("steps", "effort", "maps")
MOST_CLASSES = 60  # the largest number of classes to be told apart at once
MOST_STATES = 150_000  # the largest number of states of all maps together
MOST_WORK = 400_000  # the largest number of moves of each search, for the length and for pairs
CONFLICTS = 3000  # the largest number for clingo; a tenth of it if the answer is known
MORE = 4  # additional steps for clingo if that search does not end
TOGETHER = 100  # the number of proofs that are found at once
_NUMBER = re.compile(r"\d+|nowhere")


@dataclass(frozen=True)
class Untold:
    """Two maps, by number, that the walk does not tell apart, and why.

    Each map stands for its class. ``why`` is ``bisimilar`` if no walk can ever tell them apart;
    ``pending`` if no walk tells them apart by what both predict, but some walks lead to the
    gateways ``open`` (of the one map, of the other); ``walk`` if another walk tells them apart.
    ``related`` is the bisimulation that proves the first two.
    """

    one: int
    other: int
    why: str
    related: tuple[bisimulation.Pair, ...] = ()
    open: tuple[tuple[Gateway, ...], tuple[Gateway, ...]] = ((), ())


@dataclass(frozen=True)
class Plan:
    """The next walk, and what it achieves.

    ``kind`` is ``apart`` if the walk refutes maps, whichever is the real one; ``pending`` if no
    walk does that, and this one leads to a pending gateway; ``settled`` if there is one map, and it
    is closed; ``bisimilar`` if there are several maps that no walk tells apart, and no pending
    gateway.

    ``turns`` are those of the walk; the marker is put down after its step ``drop`` (0: now).
    ``left`` maps are left in the worst case. ``proved`` tells that no walk leaves fewer (for
    ``pending``: none leads to one in more maps), and that none that does as well is shorter;
    ``fault`` says why this is not proved. ``predictions`` has for each map what it predicts of each
    step, or None from where it predicts nothing. ``classes`` has the maps, by number from 0, that
    predict the same of every walk.
    """

    kind: str
    turns: tuple[int, ...]
    drop: int | None
    left: int
    proved: bool
    fault: str | None
    predictions: tuple[tuple[Prediction | None, ...], ...]
    classes: tuple[tuple[int, ...], ...]
    untold: tuple[Untold, ...]


class _Call(Program):
    """A program with facts about maps, which is solved in a thread of its own."""

    def __init__(self, file: str, facts: str, options: Sequence[str]):
        path = ENCODINGS / f"{file}.lp"
        self.control = self._solved = clingo.Control(list(options))
        self.control.load(str(path))
        self.control.add("base", [], facts)
        self._interrupted = False
        self.whole = False

    def keep(self) -> None:
        """Keep nothing."""

    def answers(self, watch: Watch) -> Iterator[tuple[list[int], list[str]]]:
        """Give better and better answers, each with its cost.

        The last one is a best one, if the search is ``whole`` and was not ended by the limit.
        """

        def work(put: Put) -> None:
            """Solve the program, and put the answers."""

            def take(model: clingo.Model) -> bool:
                """Put an answer."""
                return put((list(model.cost), list(map(str, model.symbols(shown=True)))))

            self.control.ground()
            if not self._interrupted:
                self.whole = bool(self.control.solve(on_model=take).exhausted)

        return in_thread(self, watch, work)


def plan(
    slots: int,
    among: Sequence[Standing],
    watch: Watch,
    *,
    marker: bool = False,
    steps: int = LONGEST_WALK,
    proofs: bool = True,
) -> Plan:
    """Plan the next walk, of at most ``steps`` steps, among maps that are all possible.

    With ``marker`` the agent carries a marker, which it may put down once. Without ``proofs`` the
    plan does not say why maps are not told apart. What was found is kept when the time is over;
    ``fault`` says so.
    """
    if any(standing.world.slots != slots for standing in among):
        raise ValueError("maps with another number of slots")
    if len({sight(one, one.dstate, one.marker) for one in among}) != 1:
        raise ValueError("no maps, or what is seen now differs")
    planner = _Planner(slots, among, watch, marker, steps)
    with Attempt() as attempt:
        planner.part()
        planner.choose()
        if proofs:
            planner.prove()
    planner.fault = attempt.fault or planner.fault
    return planner.plan()


class _Planner:
    """What is known of a plan while it is made."""

    def __init__(
        self, slots: int, among: Sequence[Standing], watch: Watch, marker: bool, steps: int
    ):
        self.slots, self.among, self.watch = slots, among, watch
        self.marker = marker and all(standing.marker is None for standing in among)
        self.steps = steps
        self.kind = "apart"
        self.walk: Walk = ()
        self.proved = False
        self.fault: str | None = None
        self.classes = [[number] for number in range(len(among))]
        self.names: dict[Hashable, list[int]] = {}
        self.untold: list[Untold] = []
        self.apart: set[tuple[int, int]] | None = None

    def part(self) -> None:
        """Divide the maps into classes that predict the same of every walk, the largest first."""
        for number, standing in enumerate(self.among):
            self.watch.tick()
            self.names.setdefault(shape(standing), []).append(number)
        names = list(self.names.values())
        whole = Machine()
        starts: list[int] = []
        while len(starts) < len(names) and len(whole.looks) < MOST_STATES:
            self.watch.tick()
            starts.append(whole.add(self.among[names[len(starts)][0]], self.marker))
        self.machine = whole
        if len(names) > 1:
            self.machine, starts = whole.merged(starts, self.watch)
        classes: dict[int, list[int]] = {}
        for start, same in zip(starts, names, strict=False):
            classes.setdefault(start, []).extend(same)
        ordered = sorted(classes.items(), key=lambda one: (-len(one[1]), min(one[1])))
        self.starts = [start for start, _ in ordered][:MOST_CLASSES]
        self.classes = [sorted(same) for _, same in ordered] + names[len(starts) :]

    def choose(self) -> None:
        """Choose the walk."""
        starts, classes = self.starts, self.classes[: len(self.starts)]
        self.maps = [(number, self.among[same[0]]) for number, same in enumerate(classes)]
        self.facts = facts(self.maps)
        self.facts += "".join(f"size({n},{len(same)}). " for n, same in enumerate(classes))
        total = sum(map(len, classes))
        self.apart = pairs_apart(self.machine, starts, Work(self.watch, MOST_WORK))
        weighed = list(zip(starts, map(len, classes), strict=True))
        if self._best("explore", Telling(self.machine, weighed, self.apart), total) < total:
            return
        proved = self.proved
        machine = Machine()
        starts = [machine.add(standing, False) for _, standing in self.maps]
        seeking = Seeking(machine, list(zip(starts, map(len, classes), strict=True)))
        if seeking.root[0]:
            self.kind = "pending"
            self._best("unseen", seeking, total)
            self.proved &= proved
        elif len(self.names) == 1:
            self.kind = "settled"
        elif self.proved:
            self.kind = "bisimilar"

    def _best(self, file: str, game: Game, total: int) -> int:
        """Find how good the best walk of a game is; an encoding chooses the walk."""
        best = Best(total, (), game.bound(*game.root))
        try:
            breadth_first(game, self.steps, Work(self.watch, MOST_WORK), best)
        finally:
            self.walk = best.walk
        known = (best.value, len(best.walk)) if best.length is None else None
        length = len(best.walk) if best.walk else best.length or 0
        whole = self._ask(file, length, best, known) if best.walk else True
        while not known and whole and best.value > best.least and length < self.steps:
            length = min(self.steps, length + MORE)
            whole = self._ask(file, length, best, known)
        if len(self.classes) > len(self.starts):
            self.fault = "maps"
        elif not known and not whole:
            self.fault = "effort"
        elif not known and best.value > best.least:
            self.fault = "steps"
        self.proved = not self.fault
        return best.value

    def _ask(self, file: str, length: int, best: Best, known: tuple[int, int] | None) -> bool:
        """Ask an encoding for the best walk of a length, and tell whether it was found.

        How good it is, and how many steps it has, may be known.
        """
        limit = CONFLICTS // 10 if known else CONFLICTS
        carried = "carried." if self.marker and file == "explore" else ""
        call = _Call(file, self.facts + carried, [f"--const=n={length}", f"--solve-limit={limit}"])
        cost, before = None, best.walk
        for costs, atoms in call.answers(self.watch):
            cost = costs[0], costs[1]
            if cost <= (best.value, len(best.walk)):
                best.value, best.walk = cost[0], _walk(atoms)
                self.walk = best.walk
        if known and call.whole and cost != known:
            raise RuntimeError(f"{file}.lp and the search for the length differ: {cost}, {known}")
        if known and not call.whole:  # the walk of the search has the least turns; this one may not
            best.walk = self.walk = before
        return call.whole

    def prove(self) -> None:
        """Say why maps are not told apart."""
        classes = self.classes[: len(self.starts)]
        turns, drop = _told(self.walk)
        predicted = [predict(self.among[same[0]], turns, drop) for same in classes]
        pairs = [(same[0], other) for same in classes for other in same[1:]]
        for one, other in combinations(range(len(classes)), 2):
            if tells(predicted[one], predicted[other]):
                continue
            numbers = (
                min(classes[one][0], classes[other][0]),
                max(classes[one][0], classes[other][0]),
            )
            starts = sorted((self.starts[one], self.starts[other]))
            if self.apart is not None and tuple(starts) in self.apart:
                self.untold.append(Untold(*numbers, "walk"))
            else:
                pairs.append(numbers)
        for begin in range(0, len(pairs), TOGETHER):
            self.untold += self._proved(pairs[begin : begin + TOGETHER])
        self.untold.sort(key=lambda pair: (pair.one, pair.other))

    def _proved(self, pairs: Sequence[tuple[int, int]]) -> Iterator[Untold]:
        """Find why no walk tells these pairs apart, by ``bisimilar.lp``; each proof is checked."""
        numbers = sorted({number for pair in pairs for number in pair})
        text = facts((number, self.among[number]) for number in numbers)
        text += "".join(f"compare({one},{other}). " for one, other in pairs)
        text += "carried." * self.marker
        places = {number: list(self.among[number].world.stars) for number in numbers}
        related: dict[tuple[int, int], list[bisimulation.Pair]] = {pair: [] for pair in pairs}
        ends: dict[tuple[int, int], tuple[set[Gateway], set[Gateway]]] = {}
        ((_, atoms),) = _Call("bisimilar", text, []).answers(self.watch)
        for atom in atoms:
            numbers = _numbers(atom)
            if atom.startswith("related"):
                one, other, place, slot, image, at, a, b = numbers
                names, images = places[one], places[other]
                lies = a if a is None else names[a], b if b is None else images[b]
                related[one, other].append(((names[place], slot), (images[image], at), lies))
            elif atom.startswith("open"):
                one, other, side, place, slot = numbers
                which = ends.setdefault((one, other), (set(), set()))[side - 1]
                which.add((places[(one, other)[side - 1]][place], slot))
        for pair in pairs:
            if not related[pair]:
                yield Untold(*pair, "walk")
                continue
            ours, theirs = (self.among[number].chart() for number in pair)
            faults = list(bisimulation.faults(ours, theirs, related[pair], self.marker))
            found = ends.get(pair, (set(), set()))
            if faults or bisimulation.pending(ours, theirs, related[pair]) != found:
                raise RuntimeError(f"maps {pair}: no proof: {faults[:1]}")
            why = "pending" if any(found) else "bisimilar"
            gateways = tuple(sorted(found[0])), tuple(sorted(found[1]))
            yield Untold(*pair, why, tuple(related[pair]), gateways)

    def plan(self) -> Plan:
        """The plan, as far as it is known."""
        turns, drop = _told(self.walk)
        predictions: list[tuple[Prediction | None, ...]] = [()] * len(self.among)
        sizes: dict[tuple[Prediction | None, ...], int] = {}
        for same in self.classes:
            predicted = predict(self.among[same[0]], turns, drop)
            sizes[predicted] = sizes.get(predicted, 0) + len(same)
            for number in same:
                predictions[number] = predicted
        left = max(
            sum(size for other, size in sizes.items() if not tells(one, other)) for one in sizes
        )
        classes = sorted(map(tuple, self.classes))
        proved = self.proved and not self.fault
        return Plan(
            self.kind,
            turns,
            drop,
            left,
            proved,
            self.fault,
            tuple(predictions),
            tuple(classes),
            tuple(self.untold),
        )


def _numbers(atom: str) -> list[Any]:
    """The numbers in an atom in order; None stands for nowhere."""
    return [None if n == "nowhere" else int(n) for n in _NUMBER.findall(atom)]


def _walk(atoms: Iterable[str]) -> Walk:
    """The walk of an answer."""
    turns = dict(_numbers(atom) for atom in atoms if atom.startswith("go"))
    drops = [_numbers(atom)[0] for atom in atoms if atom.startswith("drop")]
    return tuple((step - 1 in drops, turn) for step, turn in sorted(turns.items()))


def _told(walk: Walk) -> tuple[tuple[int, ...], int | None]:
    """The turns of a walk, and the step after which it puts the marker down."""
    drops = [step for step, (drop, _) in enumerate(walk) if drop]
    return tuple(turn for _, turn in walk), drops[0] if drops else None
