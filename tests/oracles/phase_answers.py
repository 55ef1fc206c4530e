"""What the programs of encodings/phases/ are to answer, in Python: pairs of visits that
can be of one place, and which runs can lie on one path or cross in a closed and perpendicular
map of four slots."""

import random
from itertools import combinations, product

from conftest import known

from oracles.brute_force import contradicts

Pair = tuple[int, int, int]  # P, T, S: after step T the agent is at gateway S of P's place


class Pairs:
    """The pairs of visits of an experience, so far as what was found (see holds) leaves them."""

    def __init__(self, experience, found=()):
        self.experience, self.slots = experience, experience.slots
        slots, turns, last = self.slots, (None, *experience.turns), experience.steps
        self.runs, self.known = _runs(experience), known(experience)
        self.facts = [fact for fact in found if fact[0] in ("new", "never", "apart")]
        self.may = {
            (p, t, s)
            for t in range(last + 1)
            for p in range(t + 1)
            for s in range(slots)
            if self._alike(p, t, s)
        }
        # Two pairs, and the two steps that are along one link if either is so.
        along = [
            ((p, t, (turns[p + 1] - turns[t + 1]) % slots), (p + 1, t + 1, 0), (p + 1, t + 1))
            for t in range(last)
            for p in range(t)
        ]
        along += [
            ((p - 1, t + 1, turns[p]), (p, t, -turns[t + 1] % slots), (p, t + 1))
            for t in range(last)
            for p in range(1, t + 1)
        ]
        for one, other, steps in along:
            if self._unlike(*steps):
                self.may -= {one, other}
        ways = [(one, other) for one, other, _ in along]
        # A pair whose partner is none is none itself.
        while gone := {one for pair in ways if not self.may.issuperset(pair) for one in pair}:
            if gone.isdisjoint(self.may):
                break
            self.may -= gone
        self.ways = [(one, other) for one, other in ways if one in self.may]

    def _alike(self, p: int, t: int, s: int) -> bool:
        views, landmarks = self.experience.views, self.experience.landmarks
        if p == t:
            return s == 0
        return (
            views[p] == {(s + r) % self.slots for r in views[t]}
            and landmarks[p] == landmarks[t]
            and not any(p in run and t in run for run in self.runs.values())
            and not self._contradicts(p, t, s)
            and all(holds(fact, self.experience, [(p, t, s)]) for fact in self.facts)
        )

    def _contradicts(self, p: int, t: int, s: int) -> bool:
        """Whether compass, odometry, or what is stated about visits contradicts such a pair."""
        experience = self.experience
        at = [(step, 0) for step in range(experience.steps + 1)]
        at[t] = p, s
        known = [fact for fact in self.known if fact[0] not in ("same", "length")]
        turns = (None, *experience.turns)
        return contradicts((self.slots, None, turns, None, None, known), at)

    def _unlike(self, t: int, u: int) -> bool:
        """Whether two steps are too unlike in length to be along one link."""
        length = {fact[1]: fact[2] for fact in self.known if fact[0] == "length"}
        if not {t, u} <= length.keys():
            return False
        one, other = length[t], length[u]
        return 100 * abs(one - other) > self.experience.stretch * max(one, other)

    def shown(self) -> list[str]:
        """comparable/3, iff/6 and runs_bind/0."""
        atoms = ["comparable({},{},{})".format(*pair) for pair in self.may]
        crosses = {t for t, view in enumerate(self.experience.views) if {1, 2, 3} <= view}
        most = sorted(len(crosses & run.keys()) for run in self.runs.values())
        passing = [places for places in most if places]
        if len(passing) > 1 and sum(passing[-2:]) >= len(passing):
            atoms.append("runs_bind")
        return atoms + ["iff({},{},{},{},{},{})".format(*one, *two) for one, two in self.ways]

    def shared(self) -> set[tuple[int, int, int, int, int]]:
        """(A, B, P, T, X): visits P and T, of runs A and B, may be of one place, where these
        lie on one path (X = 0) or not."""
        return {
            (a, b, p, t, (s + heading - run[p]) % (self.slots // 2))
            for p, t, s in self.may
            for a, run in self.runs.items()
            for b, other in self.runs.items()
            if a < b and p in run and t in other
            for heading in [other[t]]
        }


def _runs(experience) -> dict[int, dict[int, int]]:
    """Runs by their first steps: the visits of each, and the slot that it heads for there, from
    the gateway stood at."""
    half, runs = experience.slots // 2, {}
    for step, turn in enumerate(experience.turns, 1):
        if step == 1 or turn != half:
            run = runs[step] = {step - 1: turn}
        run[step] = half
    return runs


def same(at, slots: int) -> list[Pair]:
    """Which visits a hypothesis takes to be of one place."""
    return [
        (u, t, (s - r) % slots)
        for t, (p, s) in enumerate(at)
        for u, (q, r) in enumerate(at[:t])
        if p == q
    ]


def holds(fact, experience, pairs: list[Pair]) -> bool:
    """Whether something found is so, where these visits are of one place: (new, T), (old, T),
    (never, A, B, X), with X as in Pairs.shared and, if 1, at a place of four gateways;
    (out, T, P, S), where P is the first visit of its place; or (apart, P, T, S)."""
    name, *numbers = fact
    if name == "apart":
        return tuple(numbers) not in pairs
    if name in ("new", "old"):
        return (name == "old") == any(t == numbers[0] for _, t, _ in pairs)
    if name == "out":
        step, place, slot = numbers
        if place == step:
            return any(t == step for _, t, _ in pairs)
        first = not any(t == place for _, t, _ in pairs)
        return not (first and (place, step, slot) in pairs)
    a, b, crossing = numbers
    one, other = _runs(experience)[a], _runs(experience)[b]
    pairs = [*pairs, *((t, t, 0) for t in one if t in other)]
    return not any(
        p in one
        and t in other
        and (s + other[t] - one[p]) % 2 == crossing
        and (not crossing or len(experience.views[p]) == 4)
        for p, t, s in pairs
    )


def candidates(experience) -> list[tuple]:
    """What could be found of an experience."""
    pairs = Pairs(experience)
    facts = [(name, t) for t in range(experience.steps + 1) for name in ("new", "old")]
    facts += [("out", t, p, s) for p, t, s in sorted(pairs.may) if p < t]
    facts += [("apart", *pair) for pair in sorted(pairs.may) if pair[0] < pair[1]]
    if experience.slots == 4:
        runs = combinations(pairs.runs, 2)
        facts += [("never", a, b, x) for (a, b), x in product(runs, (0, 1))]
    return facts


def text(found) -> str:
    """What was found, as facts."""
    return "".join(f"found({name}({','.join(map(str, ns))})).\n" for name, *ns in found)


def figures(experience, at) -> frozenset[str]:
    """What runs.lp would show of the map of a hypothesis."""
    pairs = Pairs(experience)
    here = {(u, u, 0) for u in range(len(at))} | set(same(at, experience.slots))
    links = {
        (("corner", "crossing")[len(experience.views[p]) == 4] if x else "touch", a, b)
        for a, b, p, t, x in pairs.shared()
        if any(one[:2] == (p, t) for one in here)
    }
    return _Runs(experience, pairs).shown(links)


def runs(experience, found=(), most=12) -> set[frozenset[str]] | None:
    """What runs.lp is to show: all ways in which the runs can be on one path or cross; none
    of this where more than ``most`` pairs of runs are left open."""
    pairs = Pairs(experience, found)
    check = _Runs(experience, pairs)
    every, sure = set(), set()
    for a, b, p, t, x in pairs.shared():
        kind = ("corner", "crossing")[p in check.crosses] if x else "touch"
        (sure if p == t else every).add((kind, a, b))
    open_ = sorted(every - sure)
    if len(open_) > most:
        return None
    answers = set()
    for chosen in product((False, True), repeat=len(open_)):
        links = sure | {link for link, is_so in zip(open_, chosen, strict=True) if is_so}
        if check.sound(links):
            answers.add(check.shown(links))
    return answers


class _Runs:
    """The rules of runs.lp, said of paths: sets of runs that touch."""

    def __init__(self, experience, pairs: Pairs):
        self.runs = pairs.runs
        self.crosses = {t for t, view in enumerate(experience.views) if len(view) == 4}
        self.places = {a: len(self.crosses & run.keys()) for a, run in self.runs.items()}
        self.through = {a for a, number in self.places.items() if number}
        self.rivals = {(a, t): set() for a in self.runs for t in self.runs[a]}
        for a, b, p, t, x in pairs.shared():
            if x:
                self.rivals[a, p].add(b)
                self.rivals[b, t].add(a)

    def paths(self, links) -> dict[int, int]:
        """The path of each run, by its first one."""
        path = {run: run for run in self.runs}
        for kind, a, b in links:
            if kind == "touch":
                one, other = sorted((path[a], path[b]))
                path = {run: one if name == other else name for run, name in path.items()}
        return path

    @staticmethod
    def met(links, path, kinds) -> set[tuple[int, int]]:
        """The pairs of paths with such links, both ways."""
        found = {(path[a], path[b]) for kind, a, b in links if kind in kinds}
        return found | {(b, a) for a, b in found}

    def sound(self, links) -> bool:
        path = self.paths(links)
        meets = self.met(links, path, ("corner", "crossing"))
        grid = self.met(links, path, ("crossing",))
        names = set(path.values())
        if any(a == b for a, b in meets) or any(
            {(a, b), (b, c), (a, c)} <= meets for a, b, c in combinations(sorted(names), 3)
        ):
            return False
        for (run, visit), rivals in self.rivals.items():
            if visit in self.crosses and not any((path[run], path[b]) in grid for b in rivals):
                return False
        paths = [path[run] for run in self.through]
        for a, b in combinations(sorted(self.through), 2):
            if (path[a], path[b]) not in grid:
                continue
            spare = len(self.through) - self.places[a] - self.places[b]
            if spare < 0:
                return False
            if spare == 0 and (
                len(set(paths)) < len(paths)
                or any((path[a], c) not in grid and (path[b], c) not in grid for c in paths)
            ):
                return False
        return True

    def shown(self, links) -> frozenset[str]:
        path = self.paths(links)
        grid = self.met(links, path, ("crossing",))
        atoms = {f"passes_four({a})" for a in self.through}
        for a, b in combinations(self.runs, 2):
            atoms |= {f"line({a},{b})"} if path[a] == path[b] else set()
            atoms |= {f"cross_at_four({a},{b})"} if (path[a], path[b]) in grid else set()
        return frozenset(atoms)


def lines(experience, maps) -> frozenset:
    """What lines.lp is to show of these hypotheses, the closed and perpendicular ones."""
    steps = range(experience.steps + 1)
    here = {f"one_place({t},{t},0)" for t in steps}
    return frozenset(
        (
            (),
            frozenset(
                here
                | {"one_place({},{},{})".format(*pair) for pair in same(at, experience.slots)}
                | {f"new({t})" for t in steps if at[t][0] == t}
            ),
        )
        for at in maps
    )


def drawn(draw: random.Random, experience, at, rate: float) -> list[tuple]:
    """Some of what could be found and is so in a hypothesis."""
    pairs = same(at, experience.slots)
    so = [fact for fact in candidates(experience) if holds(fact, experience, pairs)]
    return [fact for fact in so if draw.random() < rate]


def so(found, experience, at) -> bool:
    """Whether all this that was found is so in a hypothesis."""
    pairs = same(at, experience.slots)
    return all(holds(fact, experience, pairs) for fact in found)
