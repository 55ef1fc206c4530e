"""Where to go next: the further walk that tells maps apart, or sees what none predicts.

clingo chooses the walk, over all the maps at once (``encodings/explore.lp``, ``unseen.lp``),
and finds the proofs that none can be chosen (``bisimilar.lp``). How long a walk is worth asking
for is found before that by a search of what the maps can predict together.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import clingo

from topomap.documents import bisimulation
from topomap.documents.bisimulation import Chart
from topomap.model.experience import DState, Experience
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime.folders import ENCODINGS
from topomap.runtime.limits import LONGEST_WALK
from topomap.runtime.watch import Attempt, Watch
from topomap.solver import solving

LIMITS = ("steps", "effort", "maps")  # why a plan may not be the best one, but for lack of time
MOST_CLASSES = 60  # that are told apart at once
MOST_STATES = 150_000  # of all the maps together
MOST_WORK = 400_000  # moves of the search for the length, and of that for pairs
CONFLICTS = 3000  # after which clingo is asked no longer; a tenth, if the answer is known
MORE = 4  # steps by which clingo is given more, where that search does not end
TOGETHER = 100  # proofs found at once
_NUMBER = re.compile(r"\d+|nowhere")


@dataclass(frozen=True)
class Standing:
    """A map, the dstate where the agent stands in it, and the place where the marker lies, if
    it is out."""

    world: TopologicalMap
    dstate: Gateway
    marker: Place | None = None

    def chart(self) -> Chart:
        """The same as plain data, for the checker."""
        world = self.world
        rest = world.landmarks, self.marker
        return Chart(world.slots, world.stars, world.links, self.dstate, *rest)


def standing(experience: Experience, at: tuple[DState, ...]) -> Standing:
    """The map of a hypothesis, and where the agent stands in it; the marker lies where it was
    put down last, if it was not taken up since."""
    down = None
    for step in range(experience.steps + 1):
        down = None if step in experience.picks else down
        down = step if step in experience.drops else down
    return Standing(experience.map_of(at), at[-1], None if down is None else at[down][0])


@dataclass(frozen=True)
class Prediction:
    """What a map says will be seen: gateways clockwise of the one arrived at, landmarks, and
    whether the marker."""

    view: frozenset[int]
    landmarks: frozenset[str] = frozenset()
    marker: bool = False

    @property
    def signs(self) -> tuple[tuple[str, ...], bool]:
        """What there is but gateways."""
        return tuple(sorted(self.landmarks)), self.marker


@dataclass(frozen=True)
class Untold:
    """Two maps, by number, that the walk does not tell apart, each standing for its class; and
    why.

    ``why``: ``bisimilar``, no walk tells them, for ever; ``pending``, none does by what both
    predict, but some come to the gateways ``open`` (of the one map, of the other); ``walk``,
    another walk does. ``related`` is the relation that proves the first two.
    """

    one: int
    other: int
    why: str
    related: tuple[bisimulation.Pair, ...] = ()
    open: tuple[tuple[Gateway, ...], tuple[Gateway, ...]] = ((), ())


@dataclass(frozen=True)
class Plan:
    """The next walk, and what comes of it.

    ``kind``: ``apart``, the walk refutes maps whichever is the real one; ``pending``, it leads
    to a pending gateway, as no walk does that; ``settled``, there is one map, and it is closed;
    ``bisimilar``, there are several, which no walk tells apart, and no pending gateway.

    ``turns`` are those of the walk; after step ``drop`` of it (0: now) the marker is put down.
    ``left`` maps are left in the worst case. ``proved``: no walk leaves fewer (``pending``: none
    leads to one in more maps), and none that does as well is shorter; ``fault`` says why not.
    ``predictions`` are, of each map, those of each step, None where it predicts nothing;
    ``classes`` the maps, by number from 0, that predict the same of every walk.
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


Action = tuple[bool, int]  # whether to drop the marker first, and the turn
Walk = tuple[Action, ...]
Key = Any  # hashable: what of a state of a search decides how it goes on


@dataclass
class _Machine:
    """What maps predict: states, how each looks, and where each action leads (None: to what is
    not predicted). An action that is not there cannot be taken."""

    looks: list[int] = field(default_factory=list)
    moves: list[dict[Action, int | None]] = field(default_factory=list)
    seen: dict[Prediction, int] = field(default_factory=dict)

    def add(self, standing: Standing, carried: bool) -> int:
        """Have the states of a map, too; returns the one where the agent stands."""
        world, slots = standing.world, standing.world.slots
        start = standing.dstate, standing.marker, carried
        numbers = {start: len(self.looks)}
        for dstate, lies, carries in (waiting := [start]):
            look = _look(world, dstate, lies)
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

    def merged(self, starts: Sequence[int], watch: Watch) -> tuple["_Machine", list[int]]:
        """The same with states as one that predict the same of every walk, and the starts."""
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
        made = _Machine([0] * number, [{}] * number)
        for name, state in first.items():
            made.looks[name] = self.looks[state]
            moves = self.moves[state]
            made.moves[name] = {a: to if to is None else block[to] for a, to in moves.items()}
        return made, [block[start] for start in starts]


def _ends(block: Sequence[int], moves: dict[Action, int | None]) -> Iterator[int | None]:
    return (end if end is None else block[end] for end in moves.values())


def _look(world: TopologicalMap, dstate: Gateway, marker: Place | None) -> Prediction:
    place = dstate[0]
    landmarks = world.landmarks.get(place, frozenset())
    return Prediction(world.view(dstate), landmarks, marker is not None and marker == place)


def _name(standing: Standing) -> Key:
    """What maps have in common that are the same but for the names of places, with the agent at
    the same dstate."""
    world, slots = standing.world, standing.world.slots
    first = {standing.dstate[0]: (0, standing.dstate[1])}
    form = []
    for place in (waiting := [standing.dstate[0]]):
        _, base = first[place]
        ends: list[tuple[int, ...]] = []
        for turn in sorted(world.view((place, base))):
            end = world.links.get((place, (base + turn) % slots))
            if end is None:
                ends.append((turn,))
                continue
            if end[0] not in first:
                first[end[0]] = len(first), end[1]
                waiting.append(end[0])
            number, slot = first[end[0]]
            ends.append((turn, number, (end[1] - slot) % slots))
        form.append((tuple(ends), *_look(world, (place, base), standing.marker).signs))
    return slots, tuple(form)


class _Spent(Exception):
    """A search has taken more work than it may."""


class _Work:
    """What a search may still do."""

    def __init__(self, watch: Watch, left: int):
        self.watch, self.left = watch, left

    def take(self, much: int = 1) -> None:
        """Note that something was done."""
        if self.left // 4096 != (self.left - much) // 4096:
            self.watch.tick()
        self.left -= much
        if self.left < 0:
            raise _Spent


def _apart(machine: _Machine, starts: Sequence[int], work: _Work) -> set[tuple[int, int]] | None:
    """The pairs of states, of those that walks lead to at once, that some walk tells apart; None
    if it takes too much work."""
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
    except _Spent:
        return None
    found = set(apart)
    for pair in apart:
        for earlier in before[pair]:
            if earlier not in found:
                found.add(earlier)
                apart.append(earlier)
    return found


Weighed = tuple[tuple[int, int], ...]  # states, each with how many maps it stands for
Group = tuple[int, Weighed]  # maps seen alike so far, and how many more are not told from them


class _Game:
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


class _Telling(_Game):
    """How many maps are left in the worst case. A key is the groups of maps that what is seen
    may still part; the score is how many are left of a map whose part is settled."""

    def __init__(
        self,
        machine: _Machine,
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


class _Seeking(_Game):
    """How many maps predict all of the walk. A key is where the agent may be in those of which
    the walk goes on; the score is how many have not come to a pending gateway."""

    def __init__(self, machine: _Machine, starts: Sequence[tuple[int, int]]):
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
class _Best:
    """The best walk known, what it comes to, and that no walk of up to ``length`` steps (any, if
    None) does better or does it sooner; ``least`` bounds what any comes to."""

    value: int
    walk: Walk
    least: int
    length: int | None = 0


def _search(game: _Game, steps: int, work: _Work, best: _Best) -> None:
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
    except _Spent:
        if best.value <= best.least:  # it is one step longer than those of which all are known
            best.length = None


class _Call(solving.Program):
    """A program on facts about maps, to be solved in a thread of its own."""

    def __init__(self, file: str, facts: str, options: Sequence[str]):
        path = ENCODINGS / f"{file}.lp"
        self.control = self._solved = clingo.Control(list(options))
        self.control.load(str(path))
        self.control.add("base", [], facts)
        self._interrupted = False
        self.whole = False

    def keep(self) -> None:
        """There is nothing to keep."""

    def answers(self, watch: Watch) -> Iterator[tuple[list[int], list[str]]]:
        """Better and better answers, each with what it costs; the last one is a best one, if
        the search is ``whole`` and was not ended by the limit."""

        def work(put: Callable[[Any], bool]) -> None:
            def take(model: clingo.Model) -> bool:
                return put((list(model.cost), list(map(str, model.symbols(shown=True)))))

            self.control.ground()
            if not self._interrupted:
                self.whole = bool(self.control.solve(on_model=take).exhausted)

        return solving._in_thread(self, watch, work)


def facts(maps: Iterable[tuple[int, Standing]]) -> str:
    """Maps as facts for ``explore.lp`` and its like, places numbered in their order."""
    lines: list[str] = []
    for number, standing in maps:
        world = standing.world
        if not lines:
            lines.append(f"slots({world.slots}).")
        index = {place: count for count, place in enumerate(world.stars)}
        lines += [f"gateway({number},{index[place]},{slot})." for place, slot in world.gateways()]
        lines += [
            f"link({number},{index[a[0]]},{a[1]},{index[b[0]]},{b[1]})."
            for a, b in world.links.items()
        ]
        lines += [
            f"sign({number},{index[place]},{term})."
            for place in world.stars
            for term in sorted(world.landmarks.get(place, ()))
        ]
        place, slot = standing.dstate
        lines.append(f"stands({number},{index[place]},{slot}).")
        if standing.marker is not None:
            lines.append(f"lies({number},{index[standing.marker]}).")
    return "\n".join(lines) + "\n"


def predict(
    standing: Standing, turns: Sequence[int], drop: int | None = None
) -> tuple[Prediction | None, ...]:
    """What a map says will be seen after each step of a walk; None once the walk goes through a
    pending gateway, or cannot go on."""
    world, dstate, marker = standing.world, standing.dstate, standing.marker
    found: list[Prediction | None] = []
    for step, turn in enumerate(turns):
        if drop == step:
            marker = dstate[0]
        out = dstate[0], (dstate[1] + turn) % world.slots
        if out not in world.links:
            break
        dstate = world.links[out]
        found.append(_look(world, dstate, marker))
    return (*found, *[None] * (len(turns) - len(found)))


def tells(one: Sequence[Prediction | None], other: Sequence[Prediction | None]) -> bool:
    """Whether a walk tells maps apart, by what they predict of it."""
    return any(a and b and a != b for a, b in zip(one, other, strict=True))


def plan(
    slots: int,
    among: Sequence[Standing],
    watch: Watch,
    *,
    marker: bool = False,
    steps: int = LONGEST_WALK,
    proofs: bool = True,
) -> Plan:
    """The next walk, of ``steps`` steps at most, for an agent to whom each of these maps is
    possible. With ``marker`` it carries one, which it may drop once. Without ``proofs`` the plan
    does not say why maps are not told apart.

    What was found is kept when the time is over; ``fault`` says so."""
    if any(standing.world.slots != slots for standing in among):
        raise ValueError("maps of other slots")
    if len({_look(one.world, one.dstate, one.marker) for one in among}) != 1:
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
    """What is known of a plan, as it is made."""

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
        self.names: dict[Key, list[int]] = {}
        self.untold: list[Untold] = []
        self.apart: set[tuple[int, int]] | None = None

    def part(self) -> None:
        """Part the maps into classes that predict the same of every walk, the largest first."""
        for number, standing in enumerate(self.among):
            self.watch.tick()
            self.names.setdefault(_name(standing), []).append(number)
        names = list(self.names.values())
        whole = _Machine()
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
        self.apart = _apart(self.machine, starts, _Work(self.watch, MOST_WORK))
        weighed = list(zip(starts, map(len, classes), strict=True))
        if self._best("explore", _Telling(self.machine, weighed, self.apart), total) < total:
            return
        proved = self.proved
        machine = _Machine()
        starts = [machine.add(standing, False) for _, standing in self.maps]
        seeking = _Seeking(machine, list(zip(starts, map(len, classes), strict=True)))
        if seeking.root[0]:
            self.kind = "pending"
            self._best("unseen", seeking, total)
            self.proved &= proved
        elif len(self.names) == 1:
            self.kind = "settled"
        elif self.proved:
            self.kind = "bisimilar"

    def _best(self, file: str, game: _Game, total: int) -> int:
        """What the best walk of a game comes to; an encoding chooses it."""
        best = _Best(total, (), game.bound(*game.root))
        try:
            _search(game, self.steps, _Work(self.watch, MOST_WORK), best)
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

    def _ask(self, file: str, length: int, best: _Best, known: tuple[int, int] | None) -> bool:
        """Ask an encoding for the best walk of some length; whether it has found it. What that
        comes to, and how many steps it has, may be known."""
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
        if known and not call.whole:  # the search's walk is of the least turns, this may not be
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
        """Why no walk tells these pairs apart, by ``bisimilar.lp``; each proof is checked."""
        numbers = sorted({number for pair in pairs for number in pair})
        text = facts((number, self.among[number]) for number in numbers)
        text += "".join(f"ask({one},{other}). " for one, other in pairs)
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
    """The numbers in an atom, in their order; None for nowhere."""
    return [None if n == "nowhere" else int(n) for n in _NUMBER.findall(atom)]


def _walk(atoms: Iterable[str]) -> Walk:
    """The walk of an answer."""
    turns = dict(_numbers(atom) for atom in atoms if atom.startswith("go"))
    drops = [_numbers(atom)[0] for atom in atoms if atom.startswith("drop")]
    return tuple((step - 1 in drops, turn) for step, turn in sorted(turns.items()))


def _told(walk: Walk) -> tuple[tuple[int, ...], int | None]:
    """The turns of a walk, and the step after which it drops the marker."""
    drops = [step for step, (drop, _) in enumerate(walk) if drop]
    return tuple(turn for _, turn in walk), drops[0] if drops else None
