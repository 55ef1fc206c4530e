"""Reasons in words: what would be wrong in a map that breaks one rule, described from that map.

The map may break other rules, too; a gateway of it may have two links. So the words are about the
visits, as the rules in ``encodings/theory/`` are, and not about the links.
"""

import re
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from topomap.model.experience import DState, Experience
from topomap.model.topology import TopologicalMap, gid
from topomap.model.words import number, plural
from topomap.questions.statements import statement_text
from topomap.runtime.errors import printable

RULES = {
    "view": "views",
    "marker": "marker",
    "compass": "compass",
    "odometry": "odometry",
    "length": "lengths",
    "look": "second look",
    "same": "known closures",
    "apart": "known closures",
    "assumed": "taken for granted",
    "unification": "gateway unification",
    "schema": "schema",
    "itself": "schema",
    "twice": "path axiom",
    "crossed": "path axiom",
    "circular": "path axiom",
    "bound": "bound",
    "planar": "planarity",
    "euler": "planarity",
    "boundary": "boundary",
    "place_twice": "boundary",
    "sides": "boundary",
    "perpendicular": "perpendicularity",
    "triangle": "perpendicularity",
    "travelled": "travelled",
    "closed": "closed",
}
RULE_NAMES = tuple(RULES)  # explanations prefer the rules that come first
KNOWN = ("compass", "odometry", "length", "same", "apart")  # what is known besides views
FIRST = RULE_NAMES.index("bound")  # the rules before it hold of every map; the others are demands
# The full sentence of a whole rule, by its text in RULES.
WHOLE = {
    "odometry": "two visits that are too far apart by odometry are at different places",
    "gateway unification": (
        "a step that leaves by the gateway at which an earlier step arrived goes back "
        "along its link"
    ),
    "schema": "a gateway has only one link, and is not linked to itself",
    "path axiom": "no place is on a path twice, and no path is circular",
    "bound": "there are not too many places",
    "planarity": "the map can be drawn without crossings",
    "boundary": (
        "two paths meet at most once, no path contains a place twice, and no place is on both "
        "sides of a path"
    ),
    "perpendicularity": "two paths meet at most once, and no three paths make a triangle",
    "travelled": "each path contains at least two places",
    "closed": "each gateway has a link",
}
BY_STEP = ("view", "compass", "length")  # what is compared between two steps
Node = tuple[int, int]  # a run, and a visit on it


@dataclass(frozen=True)
class Told:
    """A reason in words, and the steps that it names.

    If it is about a walk along a path or round a cycle, it has the visits of the walk and their
    places.
    """

    words: str
    steps: tuple[int, ...]
    walk: tuple[int, ...] = ()
    places: tuple[int, ...] = ()


@dataclass(frozen=True)
class Broken:
    """A map that breaks a rule, as dstates by step.

    ``euler`` is |V| - |E| + faces, which tells how many faces are missing.
    """

    experience: Experience
    at: tuple[DState, ...]
    euler: int | None = None

    @property
    def slots(self) -> int:
        """The number of slots."""
        return self.experience.slots

    def place(self, step: int) -> int:
        """The place of a visit."""
        return self.at[step][0]

    def left_by(self, step: int) -> DState:
        """The gateway by which a step leaves."""
        return self.experience.way_out(step, self.at[step - 1])

    def opposite(self, heading: DState) -> int:
        """The slot opposite to a gateway, or from such a slot the gateway again.

        Where it is known which gateways are on one path, it is -1 - S for a path that ends at
        gateway S.
        """
        return self._world.opposite(heading)[1]

    @cached_property
    def _world(self) -> TopologicalMap:
        return self.experience.map_of(self.at)

    @cached_property
    def runs(self) -> dict[int, dict[int, int]]:
        """For each run its visits, each with the slot to which the run heads there."""
        runs: dict[int, dict[int, int]] = {}
        rested = True
        for step, turn in enumerate(self.experience.turns, 1):
            if turn is None:
                rested = True
                continue
            if rested or not self.experience.goes_straight(step):
                rested = False
                run = runs[step] = {step - 1: self.left_by(step)[1]}
            run[step] = self.opposite(self.at[step])
        return runs

    def touching(self, node: Node) -> Iterator[Node]:
        """The visits of the same place on the same path, on any run."""
        _, step = node
        for other, visits in self.runs.items():
            for visit, heading in visits.items():
                if self.place(visit) == self.place(step) and self._on_one(node, heading):
                    yield other, visit

    def _on_one(self, node: Node, heading: int) -> bool:
        """Tell whether a heading at the place of a visit is on the path of its run."""
        run, step = node
        ahead = self.runs[run][step]
        return heading in (ahead, self.opposite((self.place(step), ahead)))

    def crossing(self, node: Node, other: int) -> Iterator[Node]:
        """The visits of the same place on another run that has another heading there."""
        _, step = node
        for visit, heading in self.runs[other].items():
            if self.place(visit) == self.place(step) and not self._on_one(node, heading):
                yield other, visit

    def along(self, start: Node, goals: set[Node], straight: bool) -> list[int] | None:
        """The visits of a shortest walk along a path.

        If it need not go straight on, it may also go from one link of a gateway to another link.
        """
        before: dict[tuple[Node, int], tuple[Node, int, bool]] = {}
        waiting = deque((start, sign, (start, sign, False)) for sign in (1, -1))
        while waiting:
            node, sign, last = waiting.popleft()
            if (node, sign) in before:
                continue
            before[node, sign] = last
            if node in goals:
                walk = []
                while before[node, sign][:2] != (node, sign):
                    walk += [node[1]] * before[node, sign][2]
                    node, sign, _ = before[node, sign]
                walk.append(start[1])
                return walk[::-1]
            run, step = node
            for other in self.touching(node):
                with_it = self.runs[other[0]][other[1]] == self.runs[run][step]
                ways = {sign if with_it else -sign} if straight else {1, -1}
                waiting.extendleft((other, way, (node, sign, False)) for way in sorted(ways))
            if step + sign in self.runs[run]:
                waiting.append(((run, step + sign), sign, (node, sign, True)))
        return None

    def crossed(self, a: int, b: int) -> list[int] | None:
        """A shortest walk along the path of two runs, from a place until it comes there again."""
        for straight in (True, False):
            walks = [
                walk
                for visit in self.runs[a]
                if (goals := set(self.crossing((a, visit), b)))
                and (walk := self.along((a, visit), goals, straight))
            ]
            if walks:
                return min(walks, key=len)
        return None

    def crossed_by_itself(self, a: int) -> list[int] | None:
        """A shortest walk along the path of a run, from a place until it comes there again."""
        path, waiting = {a}, [a]
        for run in waiting:
            met = {other for step in self.runs[run] for other, _ in self.touching((run, step))}
            waiting += sorted(met - path)
            path |= met
        walks = [walk for one in path for other in path if (walk := self.crossed(one, other))]
        return min(walks, key=len, default=None)

    def round(self, a: int) -> list[int] | None:
        """A shortest walk round the circular path of a run."""
        walks = []
        for first in self.runs[a]:
            walk, node, sign = [first], (a, first), 1
            here = self.place(first), self.runs[a][first]
            while len(walk) <= 2 * len(self.at) and (on := self._next(node, sign)):
                node, sign = on
                walk.append(node[1])
                heading = self.runs[node[0]][node[1]]
                if sign == -1:
                    heading = self.opposite((self.place(node[1]), heading))
                if (self.place(node[1]), heading) == here:
                    walks.append(walk)
                    break
        return min(walks, key=len, default=None)

    def _next(self, node: Node, sign: int) -> tuple[Node, int] | None:
        """The next visits straight on, and whether they follow the direction of their run."""
        for run, step in [node, *self.touching(node)]:
            with_it = self.runs[run][step] == self.runs[node[0]][node[1]]
            way = sign if with_it else -sign
            if step + way in self.runs[run]:
                return (run, step + way), way
        return None

    def cycle(self, chord: int) -> tuple[list[int], list[int]]:
        """The cycle that a chord closes in the tree of links by which places were first reached.

        Returns:
            The steps of its links, the chord last, and its places, from the one where the chord
            ends.
        """
        ends = []
        for place in (self.place(chord), self.place(chord - 1)):
            line = [place]
            while line[-1]:
                line.append(self.place(line[-1] - 1))
            ends.append(line)
        there, here = ends
        while len(there) > 1 and len(here) > 1 and there[-2] == here[-2]:
            there.pop()
            here.pop()
        return [*there[:-1], *here[-2::-1], chord], [*there, *here[-2::-1], there[0]]

    def tell(self, kind: str, arguments: Sequence[int], common: Sequence[Sequence[int]]) -> Told:
        """Put a reason that this map breaks into words; ``common`` has places where paths meet."""
        if kind == "view":
            return told_views(self.experience, arguments, self.at)
        if kind in ("schema", "unification"):
            return self._links(kind, *arguments)
        if kind in ("twice", "crossed", "circular", "place_twice"):
            return self._path(kind, arguments)
        if kind == "itself":
            step = arguments[0]
            gateway = gid(self.at[step])
            words = f"step {step} would arrive at the gateway by which it left, {gateway}"
            return Told(words, (step,))
        if kind in KNOWN:
            return told_known(self.experience, kind, arguments, self.at)
        if kind == "assumed":
            return told_assumed(self.experience, arguments[0])
        if kind == "look":
            words = (
                f"after the second look of step {arguments[0]} the agent would not stand where it "
                "stood before"
            )
            return Told(words, (arguments[0] - 1, arguments[0]))
        if kind == "planar":
            steps, places = self.cycle(arguments[0])
            words = (
                f"the link of step {arguments[1]} would join a gateway inside the cycle of "
                f"{_named('step', steps)}, which passes {_named('place', places)}, "
                "to a gateway outside it"
            )
            return Told(words, (arguments[1], *steps), tuple(steps), tuple(places))
        if kind == "euler":
            total = "another number" if self.euler is None else self.euler
            return Told(f"|V| - |E| + faces would be {total}, not 2", ())
        if kind == "bound":
            places = sorted({place for place, _ in self.at})
            words = f"there would be {number(len(places), 'place')}, first visited after "
            return Told(words + _named("step", places), tuple(places))
        if kind in ("closed", "travelled"):
            return told_gateway(kind, *arguments)
        if kind == "marker":
            return told_marker(self.experience, arguments[0], self.at)
        if kind == "sides":
            *path, place = arguments
            named = "of step {}" if len(path) == 1 else "through slot {1} of place {0}"
            words = (
                f"place {place} would be both to the right and to the left of the path "
                f"{named.format(*path)}"
            )
            return Told(words, (path[0], place))
        meets = [_named("place", sorted({p for a, b, p in common if {a, b} == {c, d}}))
                 for c, d in _pairs(arguments)]  # fmt: skip
        paths = _named("step", arguments)
        if kind == "triangle":
            words = f"the paths of {paths} would meet pairwise, at {'; '.join(meets)}"
        else:
            words = f"the paths of {paths} would meet more than once, at {meets[0]}"
        return Told(words, tuple(arguments))

    def _links(self, kind: str, first: int, second: int) -> Told:
        out, other = self.left_by(first), self.left_by(second)
        end, arrival = self.at[first], self.at[second]
        if kind == "schema" and out == other:
            words = (
                f"steps {first} and {second} would leave by the same gateway, {gid(out)}, and "
                f"arrive at two gateways, {gid(end)} and {gid(arrival)}"
            )
        elif kind == "schema":
            words = (
                f"steps {first} and {second} would arrive at the same gateway, {gid(end)}, "
                f"from two gateways, {gid(out)} and {gid(other)}"
            )
        elif other == end:
            words = (
                f"step {second} would leave by the gateway where step {first} arrived, {gid(end)}, "
                f"and arrive at {gid(arrival)}, not at {gid(out)}, by which step {first} left"
            )
        else:
            words = (
                f"step {second} would arrive at the gateway by which step {first} left, "
                f"{gid(out)}, from {gid(other)}, not from {gid(end)}, where step {first} arrived"
            )
        return Told(words, (first, second))

    def _path(self, kind: str, arguments: Sequence[int]) -> Told:
        walk: list[int] | None
        if kind == "twice":
            walk = list(range(arguments[0], arguments[1] + 1))
        elif kind == "crossed":
            walk = self.crossed(*arguments)
        elif kind == "place_twice":
            walk = self.crossed_by_itself(arguments[0])
        else:
            walk = self.round(arguments[0])
        if not walk:
            return told_plainly(kind, arguments)
        places = [self.place(step) for step in walk]
        if kind == "circular":
            end = "be circular"
        elif kind == "twice":
            end = f"contain place {places[0]} twice, after steps {walk[0]} and {walk[-1]}"
        elif kind == "place_twice":
            end = f"contain place {places[0]} twice"
        else:
            end = f"cross itself at place {places[0]}"
        words = f"the path through {_named('place', places)} ({_named('step', walk)}) would {end}"
        return Told(words, tuple(walk), tuple(walk), tuple(places))


def kind_of(name: str) -> str:
    """The kind of a reason: its name without its steps."""
    return name.partition("(")[0]


def numbers_of(name: str) -> tuple[int, ...]:
    """The numbers in the name of a reason; most of them are steps."""
    return tuple(map(int, re.findall(r"\d+", name)))


def gathered(name: str) -> tuple[str, ...]:
    """The gathered reasons of which a single one is a part; it needs all of them.

    They are all that is known of a step, or a whole rule; or the reason itself, if it is about a
    single fact.
    """
    kind = kind_of(name)
    if kind in BY_STEP:
        return tuple(f"{kind}({step})" for step in numbers_of(name))
    return (RULES[kind],) if RULES[kind] in WHOLE else (name,)


def is_gathered(name: str) -> bool:
    """Tell whether a reason of a gathered answer is gathered, and not a single one."""
    return name in WHOLE or of_one_step(name)


def of_one_step(name: str) -> bool:
    """Tell whether a reason is gathered from all that is known of one step."""
    return kind_of(name) in BY_STEP and len(numbers_of(name)) == 1


def told_gathered(experience: Experience, name: str, bound: int | None) -> Told:
    """Put a gathered reason into words."""
    kind, steps = kind_of(name), numbers_of(name)
    if name == "bound":
        return Told(f"there are at most {number(bound or 0, 'place')}", ())
    if name in WHOLE:
        return Told(WHOLE[name], ())
    if kind == "view":
        words = f"after step {steps[0]} the agent sees the gateways {_seen(experience, steps[0])}"
    elif kind == "compass":
        slot = experience.compass[steps[0]]
        words = f"the agent's gateway points to compass slot {slot} after step {steps[0]}"
    else:
        words = f"step {steps[0]} is {experience.lengths[steps[0] - 1]} long"
    return Told(words, steps)


def told_plainly(kind: str, arguments: Sequence[int]) -> Told:
    """Put a reason into words without a map that breaks it."""
    steps = _named("step", arguments)
    words = {
        "unification": f"{steps} go along one link, there and back",
        "schema": f"{steps} go along one link",
        "itself": f"{steps} does not arrive at the gateway by which it left",
        "place_twice": f"the path of {steps} contains no place twice",
        "twice": f"{steps} end at different places, as they are on one path",
        "crossed": f"the path of {steps} does not cross itself",
        "circular": f"the path of {steps} is not circular",
        "planar": f"the links of {steps} do not cross",
        "euler": "|V| - |E| + faces is 2",
        "bound": "there are not too many places",
        "look": f"the second look of {steps} is from where the agent stands",
        "boundary": f"the paths of {steps} meet at most once",
        "perpendicular": f"the paths of {steps} meet at most once",
        "triangle": f"the paths of {steps} do not meet pairwise",
    }
    return Told(words.get(kind, kind), tuple(arguments))


def told_gateway(kind: str, place: int, slot: int) -> Told:
    """Describe a gateway that has no link."""
    if kind == "closed":
        return Told(f"gateway {place}.{slot} would be pending", (place,))
    words = f"the path through slot {slot} of place {place} would contain no other place"
    return Told(words, (place,))


def told_views(
    experience: Experience, steps: Sequence[int], at: Sequence[DState] | None = None
) -> Told:
    """Describe two views that differ."""
    slots, (step, visit) = experience.slots, steps
    view, other = experience.views[step], experience.views[visit]
    signs = experience.landmarks[step], experience.landmarks[visit]
    turns = [turn for turn in range(slots) if {(slot + turn) % slots for slot in view} == other]
    if experience.straight or experience.tolerance:
        turns = [turn for turn in sorted(other) if experience.looks_alike(visit, turn, step)]
    if signs[0] != signs[1]:
        fault = "the landmarks are not the same"
    elif not turns and experience.straight:
        fault = "no turn of one view gives the other, with the same gateways on one path"
    elif not turns:
        fault = "no turn of one view gives the other"
        fault += f", within {number(experience.tolerance, 'slot')}" * bool(experience.tolerance)
    elif at is None:
        fault = f"one view gives the other only if turned by {' or '.join(map(str, turns))}"
    else:
        turn = (at[step][1] - at[visit][1]) % slots
        fault = (
            f"the first view, turned by {turn} as it would be, does not give the second "
            f"(it does if turned by {' or '.join(map(str, turns))})"
        )
    texts = [_seen(experience, one, any(signs)) for one in (step, visit)]
    words = (
        f"after step {step} the agent sees the gateways {texts[0]}, after step {visit} {texts[1]}: "
        f"{fault}"
    )
    return Told(words, (step, visit))


def _seen(experience: Experience, step: int, signs: bool = False) -> str:
    """Describe the gateways seen after a step, and the landmarks if they matter."""
    names = sorted(experience.landmarks[step])
    text = " ".join(map(str, sorted(experience.views[step])))
    if not signs and not names:
        return text
    return text + f", with {', '.join(map(printable, names)) or 'no landmark'}"


def told_known(
    experience: Experience, kind: str, steps: Sequence[int], at: Sequence[DState] | None = None
) -> Told:
    """Describe what is known of two steps besides views."""
    one, other = steps
    if kind == "compass":
        slots = [experience.compass[step] for step in steps]
        words = (
            f"the agent's gateway points to compass slot {slots[0]} after step {one}, and to "
            f"{slots[1]} after step {other}"
        )
        if at is not None:
            turn = (at[other][1] - at[one][1]) % experience.slots
            words += f"; from the first to the second the agent would turn by {turn}"
    elif kind == "odometry":
        words = _far(experience, one, other)
    elif kind == "length":
        lengths = [experience.lengths[step - 1] for step in steps]
        words = (
            f"steps {one} and {other} would go along one link, and are {lengths[0]} and "
            f"{lengths[1]} long; lengths of one link differ by {experience.stretch} % at most"
        )
    else:
        places = "one place" if kind == "same" else "two places"
        words = f"the agent is known to have been at {places} after steps {one} and {other}"
        if at is not None:
            there = sorted({at[step][0] for step in steps})
            words += f"; it would have been at {_named('place', there)}"
    return Told(words, (one, other))


def told_assumed(experience: Experience, number: int) -> Told:
    """Describe the assumption that has this number."""
    term, holds = sorted(experience.assumed)[number]
    return Told(statement_text(term, holds), ())


def _far(experience: Experience, one: int, other: int) -> str:
    """Describe how far apart two visits are by odometry."""
    moved = [shift for shift in experience.shifts[one:other] if shift]
    apart = max(abs(sum(shift[axis] for shift in moved)) for axis in (0, 1))
    way = sum(abs(x) + abs(y) for x, y in moved)
    wrong = Fraction(experience.drift * way, 100)
    return (
        f"step {other} is at least {_decimal(apart - wrong)} units from step {one} by its "
        f"odometry: {apart} were measured on a way of {way}, wrong by {experience.drift} % at most"
    )


def _decimal(number: Fraction) -> str:
    """Write a number of hundredths as a decimal."""
    return f"{float(number):.2f}".rstrip("0").rstrip(".")


def told_marker(experience: Experience, step: int, at: Sequence[DState] | None = None) -> Told:
    """Describe what is seen of the marker, and where it lies."""
    lying = [(down, seen, name) for at_, down, seen, name in experience.lying() if at_ == step]
    wrong = [
        (down, seen, name)
        for down, seen, name in lying
        if at is None or seen != (at[step][0] == at[down][0])
    ]
    down, seen, name = (wrong or lying)[0]
    marker = "the marker" if name is None else f"the marker {printable(name)}"
    words = f"after step {step} the agent {'sees' if seen else 'does not see'} {marker}, "
    if at is None:
        words += f"which it put down after step {down}"
    else:
        place, there = at[step][0], at[down][0]
        words += f"which lies at place {there} (step {down}), and would be at place {place}"
    return Told(words, (down, step))


def _pairs(paths: Sequence[int]) -> list[tuple[int, int]]:
    return [(a, b) for i, a in enumerate(paths) for b in paths[i + 1 :]]


def _named(noun: str, numbers: Sequence[int]) -> str:
    """Name numbers with their noun, as in "steps 3 4 5"."""
    return f"{plural(len(numbers), noun)} {' '.join(map(str, numbers))}"
