"""The queries that the encodings are tried with, each with its right answers: what
make mutate runs on every mutant of an encoding.

A suite is a function that yields queries; an encoding is tried with those that load it.
"""

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

from conftest import PARTS, THEORY, Truth
from flawed import DEMANDS, INSTANCES, by_hand, drawn
from topomap.check import by_definition
from topomap.experience import Experience
from worlds import random_experience


def seen(*steps, slots=4):
    """An experience from one text a step: "turn: gateways"."""
    views = tuple(frozenset(map(int, step.split(":")[-1].split())) for step in steps)
    turns = tuple(int(step.split(":")[0]) for step in steps[1:])
    return Experience(slots, views, turns, (frozenset(),) * len(steps))


def marked(experience, *steps):
    """The same with a landmark recognised after these steps."""
    marks = [frozenset("a" if step in steps else "") for step in range(experience.steps + 1)]
    return replace(experience, landmarks=tuple(marks))


CORRIDOR = seen("0", "0: 0 2", "2: 0", "0: 0 2")
EXPERIENCES = {
    "corridor": CORRIDOR,
    "same": marked(CORRIDOR, 1, 3),
    "lost": marked(CORRIDOR, 1),
    "added": marked(CORRIDOR, 3),
    "branch": seen("0 1", "0: 0"),
    "end": seen("0 2", "0: 0"),
    "loop": seen("0 1", "0: 0 3"),
    "corners": seen("0 1", "0: 0 1", "1: 0 3"),
    "mirrored": seen("0 1", "0: 0 1", "1: 0 1"),
    "ahead": seen("0 1 2 3", "0: 0 2", "2: 0 1 2 3"),
    "square": seen("0 3", "0: 0 3", "3: 0 3", "3: 0 3", "3: 0 1"),
    "round": seen("0 3", "0: 0 3", "3: 0 3", "3: 0 3", "3: 0 1", "1: 0 3"),
    "lasso": seen("0 1 2", "0: 0 1 2 3", "0: 0 1 2", "1: 0", "0: 0 1 3", "1: 0 1 2 3"),
    "ears": seen("0 1 2 3", "0: 0 1", "1: 0 1", "1: 0 1 2 3", "1: 0 1", "1: 0 1", "1: 0 1 2 3"),
    "triangle": seen("0 3", "0: 0 1", "1: 0 1", "1: 0 1"),
    "twisted": seen("0 1", "0: 0 1", "1: 0 3", "3: 0 3"),
    "stages": seen(
        "0 1 3",
        "3: 0 3",
        "3: 0 2 3",
        "3: 0",
        "0: 0 1 3",
        "3: 0 1",
        "1: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
    ),
    "meeting": seen(
        "0 2 3",
        "0: 0 1",
        "1: 0 1 2",
        "0: 0 3",
        "3: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "3: 0",
    ),
    "turning off": seen(
        "0 1 3",
        "3: 0 3",
        "3: 0 2 3",
        "2: 0 1",
        "1: 0 2 3",
        "3: 0",
        "0: 0 1 3",
        "3: 0 1",
        "1: 0 2 3",
    ),
    "star": seen("0 1 2", "0: 0", "0: 0 1 2", "1: 0", "0: 0 1 5", "1: 0", "0: 0 4 5", slots=6),
}


# The random ones: seed, most steps, and how many of them are after the horizon. The last two
# were found by a search for experiences that kill a mutant which the others do not.
DRAWN = [*((seed, 8, seed % 3) for seed in range(100)), (602, 14, 0), (2408, 12, 0)]


@dataclass(frozen=True)
class Query:
    """Encodings, by their names under encodings/, loaded with facts and arguments of
    clingo; and the answers, each the set of the atoms that it shows. Of a query with a
    cost, these are the optimal ones."""

    files: tuple[str, ...]
    facts: str
    answers: frozenset[frozenset[str]]
    arguments: tuple[str, ...] = ()
    cost: tuple[int, ...] = ()


def theory() -> Iterator[Query]:
    """Experiences, with the answers that the independent search gives."""
    for experience in EXPERIENCES.values():
        yield from hypotheses(experience.facts(), (), Truth(experience))
    for seed, most, after in DRAWN:
        experience = random_experience(random.Random(f"corpus {seed}"), most)
        horizon = max(0, experience.steps - after)
        cut = ("-c", f"horizon={horizon}")
        yield from hypotheses(experience.facts(), cut, Truth(experience.cut(horizon)))


def hypotheses(facts: str, arguments: tuple[str, ...], truth: Truth) -> Iterator[Query]:
    """What is asked of one experience: all hypotheses, those of each part, and the best."""

    def query(parts, found, *more, added="", atoms=None, cost=()):
        files = ("topomap", *(f"theory/{name}" for name in THEORY), *parts)
        answers = [
            frozenset(f"at({t},{p},{s})" for t, (p, s) in enumerate(at))
            | (atoms(truth.final[at]) if atoms else frozenset())
            for at in found
        ]
        return Query(files, facts + added, frozenset(answers), (*arguments, *more), cost)

    def least(parts, key, found):
        costs = {key(truth.final[at]) for at in found}
        best = truth.least(key, found)
        return query(parts, best, "--opt-mode=optN", cost=min(costs, default=()))

    yield query((), truth.final)
    for part in PARTS:
        yield query((part,), truth.having(part))
    yield query(("bound",), truth.having(bound=3), "-c", "places=3")
    yield query(
        ("genus",),
        truth.final,
        "--opt-mode=ignore",
        added="#show euler/1. #show genus/1.",
        atoms=lambda h: {f"euler({h.euler()})", f"genus({h.genus()})"},
    )
    yield least(("minimal",), lambda h: h.cost(), truth.final)
    yield least(("boundary", "minimal"), lambda h: h.cost(), truth.having("boundary"))
    yield least(("genus",), lambda h: (h.genus(),), truth.final)
    yield least(("genus", "minimal"), lambda h: (h.genus(), *h.cost()), truth.final)


def check() -> Iterator[Query]:
    """Maps, sound and with errors, with the violations that are there by definition. Of a map
    with two links at a gateway paths are not defined, so of the random ones these are left
    out."""
    hand = list(by_hand())
    for number, (experience, at) in enumerate([*hand, *drawn(120)]):
        for demands in (DEMANDS, ()):
            violations = by_definition(experience, at, demands)
            if "schema" in dict(violations) and number >= len(hand):
                continue
            facts = [f"at({step},{place},{slot})." for step, place, slot in at]
            facts += [f"demand({demand})." for demand in demands]
            shown = frozenset(f"violation({rule},{step})" for rule, step in violations)
            yield Query(("check",), experience.facts() + "".join(facts), frozenset({shown}))


def demands() -> Iterator[Query]:
    """Demands that are known, and others."""
    facts = "slots(4). view(0,0). view(1,0). turn(1,0). at(0,0,0). at(1,1,0). "
    for demand in ("planar", "closed", "travelled", "boundary", "perpendicular", "bound(2)"):
        yield Query(("check",), f"{facts} demand({demand}).", frozenset({frozenset()}))
    for demand in ("plannar", "bound", "bound(a)", "bound(#inf)", '"closed"', "2"):
        shown = frozenset({f"violation({demand},1)"})
        yield Query(("check",), f"{facts} demand({demand}).", frozenset({shown}))


def faults() -> Iterator[Query]:
    """Instances with faults."""
    for facts, errors in INSTANCES.items():
        shown = frozenset(f"error({error})" for error in errors.split())
        yield Query(("input",), facts, frozenset({shown}))


SUITES = (theory, check, demands, faults)


@cache
def queries() -> list[Query]:
    return [query for suite in SUITES for query in suite()]
