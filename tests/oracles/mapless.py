"""Experiences without a map, and whether the reasons that ``explain`` tells of them are right, from
the definitions of the rules in ``broken_rules.py``, without clingo."""

import random
import re
from dataclasses import replace
from itertools import combinations

from conftest import plain
from topomap.model.experience import Experience, observe
from topomap.worlds.environment import grid

from oracles.broken_rules import Assignment
from oracles.brute_force import Hypothesis
from oracles.worlds import random_world, wandering

PARTS = [
    (), ("planar",), ("perpendicular",), ("planar", "perpendicular"), ("travelled",),
    ("planar", "perpendicular", "travelled"), ("planar", "closed"), ("closed", "perpendicular"),
    ("boundary",), ("planar", "boundary"),
]  # fmt: skip
LATE = {"closed", "travelled"}
LIMIT = 20_000  # reasons that are compared with beginnings of assignments, until it is left open


def candidate(draw: random.Random, most: int) -> tuple[Experience, tuple[str, ...], int | None]:
    """A walk of three steps or more, in which a view or two are misread; parts, and a bound. It may
    have a map."""
    while True:
        made = random_world(draw)
        if draw.random() < 0.5:
            kind = draw.choice(["grid", "grid", "cylinder"])
            made = grid(draw.choice([2, 3, 3, 4]), draw.choice([3, 4]), kind).map
        start = draw.choice(sorted(made.links))
        seen, _ = observe(made, start, wandering(draw, made, start, most)[0])
        for _ in range(draw.randint(1, 2)):
            seen = misread(draw, seen)
        bound = draw.randint(2, 6) if draw.random() < 0.2 else None
        if seen.steps >= 3:
            return seen, draw.choice(PARTS), bound


def misread(draw: random.Random, experience: Experience) -> Experience:
    """With a gateway seen after a step that is not there, or one missed; if there is room."""
    step, slot = draw.randint(0, experience.steps), draw.randrange(experience.slots)
    if slot in {0, *experience.turns[step : step + 1]}:
        return experience
    views = list(experience.views)
    views[step] = views[step] ^ {slot}
    return replace(experience, views=tuple(views))


class Held:
    """Reasons compared with assignments of dstates. The names are those of single reasons, of whole
    rules, and of what is seen after one step."""

    def __init__(self, experience: Experience, bound: int | None):
        self.experience, self.bound = experience, bound
        self.runs = sorted(Assignment(experience, [(t, 0) for t in self.steps(0)]).runs())

    def steps(self, first: int) -> range:
        return range(first, self.experience.steps + 1)

    def singles(self, name: str) -> list[str]:
        """What the name stands for, without views and boundaries; a single reason for itself."""
        pairs = [f"({t},{u})" for t, u in combinations(self.steps(1), 2)]
        runs = [f"({a},{b})" for a, b in combinations(self.runs, 2)]
        half = self.experience.slots // 2
        axes = [f"({p},{s})" for p in self.steps(0) for s in range(half)]
        slots = [(p, s) for p in self.steps(0) for s in sorted(self.experience.views[p])]
        whole = {
            "gateway unification": [f"unification{two}" for two in pairs],
            "schema": [f"schema{two}" for two in pairs] + [f"itself({t})" for t in self.steps(1)],
            "path axiom": [f"twice({t},{u})" for t, u in combinations(self.steps(0), 2)]
            + [f"crossed{two}" for two in runs]
            + [f"circular({a})" for a in self.runs],
            "planarity": [f"planar{two}" for two in pairs],
            "perpendicularity": [f"perpendicular{two}" for two in runs]
            + [f"triangle({a},{b},{c})" for a, b, c in combinations(self.runs, 3)],
            "boundary": [f"boundary{two}" for two in runs],
            "travelled": [f"travelled{axis}" for axis in axes],
            "closed": [f"closed({p},{s})" for p, s in slots],
        }
        return whole.get(name, [name])

    def all_singles(self, names: list[str]) -> list[str]:
        """The single reasons that are in force with these, except for those of boundaries."""
        seen = sorted(int(name[5:-1]) for name in names if re.fullmatch(r"view\(\d+\)", name))
        views = [f"view({u},{t})" for t, u in combinations(seen, 2)]
        rest = [name for name in names if not re.fullmatch(r"view\(\d+\)", name)]
        return [*views, *(single for name in rest for single in self.singles(name))]

    def broken(self, names: list[str], at: tuple) -> bool | None:
        """Whether dstates break one of these; None if that is not known: where a gateway has two
        links, it is not defined whether the map is planar, and what is on which side of a path."""
        one = Assignment(self.experience, at)
        forks = [*self.singles("schema"), *self.singles("gateway unification")]
        forked = any(map(one.broken, forks))
        unclear = "boundary", "sides", *["planar"] * forked
        seen = [int(name[5:-1]) for name in names if re.fullmatch(r"view\(\d+\)", name)]
        if any(one.view(u, t) for t, u in combinations(sorted(seen), 2)):
            return True
        for name in names:
            if name == "bound":
                if len(one.new) > self.bound:
                    return True
                continue
            of_step = re.fullmatch(r"view\(\d+\)", name)
            known = [] if of_step or name.startswith(unclear[1:]) else self.singles(name)
            if any(map(one.broken, known)):
                return True
        if not any(name.startswith(unclear) for name in names):
            return False
        if forked or any(name.startswith("sides") for name in names):
            return None
        sides = Hypothesis(plain(self.experience), at).sides()
        return "boundary" in names and any(right & left for _, right, left in sides)

    def suffice(self, names: list[str]) -> bool | None:
        """Whether all assignments break one of these; None where it is left open. Beginnings are
        left as soon as they break one that no later step can mend."""
        lasting = [name for name in names if name not in ("circular", "boundary", *LATE)]
        lasting = [name for name in lasting if not name.startswith(("sides", *LATE))]
        if "path axiom" not in names:  # paths may become one
            merging = ("perpendicular", "triangle", "circular")
            lasting = [name for name in lasting if not name.startswith(merging)]
        waiting, looked, open_ = [((0, 0),)], 0, False
        while waiting:
            at = waiting.pop()
            step = len(at) - 1
            looked += sum(len(self.singles(name)) for name in names)
            if looked > LIMIT:
                return None
            if step == self.experience.steps:
                verdict = self.broken(names, at)
                if verdict is False:
                    return False
                open_ = open_ or verdict is None
                continue
            cut = self.experience.cut(step)
            begun = Held(cut, self.bound)
            of_it = [n for n in lasting if max(map(int, re.findall(r"\d+", n)), default=0) <= step]
            if step and begun.broken(of_it, at):
                continue
            known = sorted({place for place, _ in at})
            slots = range(self.experience.slots)
            waiting += [(*at, (step + 1, 0)), *((*at, (p, s)) for p in known for s in slots)]
        return None if open_ else True


def wrong(experience: Experience, answer: dict, bound: int | None) -> str | None:
    """What is wrong with an answer about the beginning of an experience that it names: reasons
    that break in no map alone; None if nothing is, and "open" if that is not known of all."""
    held = Held(experience.cut(answer["horizon"]), bound)
    names = [reason["reason"] for reason in answer["reasons"]]
    left_open = None
    for reason in answer["reasons"]:
        at = tuple((place, slot) for _, place, slot in reason["without"])
        rest = [name for name in names if name != reason["reason"]]
        verdicts = held.broken(rest, at), held.broken(names, at)
        if verdicts[0] or verdicts[1] is False:
            return f"{reason['reason']}: {at} {verdicts}"
        left_open = "open" if None in verdicts else left_open
    return left_open
