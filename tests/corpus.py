"""The queries that the encodings are tried with, each with its right answers: what
make mutate runs on every mutant of an encoding.

A suite is a function that yields queries; an encoding is tried with those that load it.
"""

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, partial

from conftest import PARTS, THEORY, Truth
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


@dataclass(frozen=True)
class Query:
    """Encodings, by their names under encodings/, loaded with facts and arguments of
    clingo; and the answers, each the set of the atoms that it shows."""

    files: tuple[str, ...]
    facts: str
    answers: frozenset[frozenset[str]]
    arguments: tuple[str, ...] = ()


def hypotheses(facts, parts, expected, *arguments) -> Query:
    """A query for the hypotheses that are expected of the theory with some parts."""
    files = ("topomap", *(f"theory/{name}" for name in THEORY), *parts)
    atoms = ((f"at({t},{p},{s})" for t, (p, s) in enumerate(at)) for at in expected)
    return Query(files, facts, frozenset(map(frozenset, atoms)), arguments)


def theory() -> Iterator[Query]:
    """Experiences, with the answers that the independent search gives."""
    drawn = [random_experience(random.Random(f"corpus {n}"), 8) for n in range(100)]
    for experience in [*EXPERIENCES.values(), *drawn]:
        truth = Truth(experience)

        query = partial(hypotheses, experience.facts())
        final, half = truth.final, experience.steps // 2
        yield query((), final)
        for part in PARTS:
            yield query((part,), truth.having(part))
        yield query((), truth.levels[half], "-c", f"horizon={half}")
        yield query(("bound",), truth.having(bound=3), "-c", "places=3")
        fewest = truth.least(lambda h: h.cost(), final)
        yield query(("minimal",), fewest, "--opt-mode=optN")
        yield query(("boundary", "minimal"), truth.best(closed=False), "--opt-mode=optN")
        flattest = truth.least(lambda h: h.genus(), final)
        yield query(("genus",), flattest, "--opt-mode=optN")
        both = truth.least(lambda h: (h.genus(), *h.cost()), final)
        yield query(("genus", "minimal"), both, "--opt-mode=optN")


SUITES = (theory,)


@cache
def queries() -> list[Query]:
    return [query for suite in SUITES for query in suite()]
