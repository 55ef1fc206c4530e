"""Each rule of the theory: a case in which it holds and one in which it bites; and no
rule that could be taken away without an answer changing."""

import random
from dataclasses import replace
from functools import cache

import pytest
from clingo import ast
from clintest.assertion import SupersetOf
from clintest.quantifier import Any
from clintest.solver import Clingo
from clintest.test import Assert
from conftest import ENCODINGS, PARTS, THEORY, Truth, answers
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


def admits(parts, experience, at, *arguments):
    """Whether the hypothesis ``at``, written "place.gateway ...", is an answer."""
    dstates = [dstate.split(".") for dstate in at.split()]
    wanted = {f"at({step},{place},{slot})" for step, (place, slot) in enumerate(dstates)}
    files = [str(ENCODINGS / f"{part}.lp") for part in ("topomap", *parts)]
    test = Assert(Any(), SupersetOf(wanted))
    Clingo(["0", *arguments], experience.facts(), files).solve(test)
    return test.outcome().current_value()


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

# What is tested | the part | an experience and a hypothesis that hold | those that bite
CASES = """
the same gateways are seen       |               | corners: 0.0 1.0 0.1             | mirrored: 0.0 1.0 0.1
a landmark that was not there    |               | same: 0.0 1.0 2.0 1.2            | added: 0.0 1.0 2.0 1.2
a landmark that is gone          |               | same: 0.0 1.0 2.0 1.2            | lost: 0.0 1.0 2.0 1.2
names are of first visits        |               | round: 0.0 1.0 2.0 3.0 4.0 5.0   | round: 0.0 1.0 2.0 3.0 0.3 4.0
leaving by one gateway           |               | round: 0.0 1.0 2.0 3.0 0.3 1.0   | round: 0.0 1.0 2.0 3.0 0.3 5.0
arriving at one gateway          |               | round: 0.0 1.0 2.0 3.0 4.0 5.0   | round: 0.0 1.0 2.0 3.0 4.0 1.0
the way back leads back          |               | corridor: 0.0 1.0 2.0 1.2        | corridor: 0.0 1.0 2.0 3.0
no other way leads back          |               | corners: 0.0 1.0 0.1             | mirrored: 0.0 1.0 0.0
a run does not return            |               | ahead: 0.0 1.0 2.0               | ahead: 0.0 1.0 0.1
a place is once on a path        |               | lasso: 0.0 1.0 0.0 3.0 0.1 5.0   | lasso: 0.0 1.0 0.0 3.0 0.1 1.1
no path is circular              |               | lasso: 0.0 1.0 0.0 3.0 0.1 5.0   | lasso: 0.0 1.0 0.0 3.0 0.1 1.2
no loop at a place               |               | loop: 0.0 1.0                    | loop: 0.0 0.1
links are on one face            | planar        | ears: 0.0 1.0 2.0 0.2 4.0 5.0 6.0 | ears: 0.0 1.0 2.0 0.2 4.0 5.0 0.1
Euler's formula                  | euler         | ears: 0.0 1.0 2.0 0.2 4.0 5.0 6.0 | ears: 0.0 1.0 2.0 0.2 4.0 5.0 0.1
no gateway is pending            | closed        | square: 0.0 1.0 2.0 3.0 0.3      | square: 0.0 1.0 2.0 3.0 4.0
no path is untravelled           | travelled     | square: 0.0 1.0 2.0 3.0 0.3      | branch: 0.0 1.0
travelled, with a pending end    | travelled     | end: 0.0 1.0                     | branch: 0.0 1.0
at most three places             | bound         | triangle: 0.0 1.0 2.0 0.3        | square: 0.0 1.0 2.0 3.0 0.3
left or right of a path          | boundary      | triangle: 0.0 1.0 2.0 0.3        | twisted: 0.0 1.0 2.0 0.1
beside a path in two runs        | boundary      | triangle: 0.0 1.0 2.0 0.3        | stages: 0.0 1.0 2.0 3.0 2.3 5.0 6.0 7.0 0.1
beside a path in two directions  | boundary      | triangle: 0.0 1.0 2.0 0.3        | meeting: 0.0 1.0 2.0 1.1 0.0 5.0 6.0 7.0 2.2 9.0
met by a path in two runs        | boundary      | triangle: 0.0 1.0 2.0 0.3        | turning off: 0.0 1.0 2.0 3.0 4.0 5.0 4.3 7.0 0.1
on a path or beside it           | boundary      | corners: 0.0 1.0 2.0             | corners: 0.0 1.0 0.1
paths meet once                  | perpendicular | corners: 0.0 1.0 2.0             | corners: 0.0 1.0 0.1
paths make no triangle           | perpendicular | square: 0.0 1.0 2.0 3.0 0.3      | triangle: 0.0 1.0 2.0 0.3
but three may meet at a place    | perpendicular | star: 0.0 1.0 0.0 3.0 0.1 5.0 0.2 | triangle: 0.0 1.0 2.0 0.3
"""  # noqa: E501


@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_rule_holds_and_bites(case):
    _, part, holds, bites = (field.strip() for field in case.split("|"))
    parts, bound = [part] if part else [], ["-c", "places=3"] if part == "bound" else []

    def admitted(parts, case, *arguments):
        name, _, at = case.partition(": ")
        return admits(parts, EXPERIENCES[name], at, *arguments)

    assert admitted(parts, holds, *bound)
    assert not admitted(parts, bites, *bound)
    if part:
        assert admitted([], bites), "another rule bites too"


def test_the_fewest_paths_and_places_are_preferred():
    facts = EXPERIENCES["square"].facts()
    assert answers(("minimal",), facts) == {((0, 0), (1, 0), (2, 0), (3, 0), (0, 3))}


def test_the_least_genus_is_preferred_to_the_fewest_paths():
    """Of this experience, the one map with the fewest paths is not planar."""
    across = seen("0 1 3", "0: 0 1 3", "3: 0 1 2 3", "1: 0 1 2 3", "1: 0 2 3", "2: 0 1 2 3")
    across = replace(across, landmarks=tuple(map(frozenset, ["", "b", "a", "", "", "a"])))
    (fewest,) = answers(("minimal",), across.facts())
    planar = answers(("planar",), across.facts())
    assert fewest not in planar
    assert answers(("genus", "minimal"), across.facts()) < planar


def test_the_horizon_cuts_the_experience():
    square = EXPERIENCES["square"]
    for horizon in range(square.steps + 1):
        cut = answers((), square.cut(horizon).facts())
        assert answers((), square.facts(), "-c", f"horizon={horizon}") == cut


FILES = [*(f"theory/{name}" for name in THEORY), *PARTS, "bound", "minimal", "genus"]


@cache
def statements(file):
    """The statements of an encoding, without its includes."""
    text = (ENCODINGS / f"{file}.lp").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("#include")]
    found = []
    ast.parse_string("\n".join(lines), found.append)
    return found


def rules():
    return [
        pytest.param(file, number, id=f"{file}:{statement.location.begin.line}")
        for file in FILES
        for number, statement in enumerate(statements(file))
        if statement.ast_type in (ast.ASTType.Rule, ast.ASTType.Minimize)
    ]


@cache
def corpus():
    """Experiences, with the answers that the independent search gives for some queries."""
    queries = []
    drawn = [random_experience(random.Random(f"corpus {n}"), 8) for n in range(100)]
    for cut in [*EXPERIENCES.values(), *drawn]:
        truth = Truth(cut)
        least = truth.least(lambda h: h.genus(), truth.final)
        queries.append((cut, (), (), set(truth.final)))
        queries.append((cut, ("minimal",), (), truth.least(lambda h: h.cost(), truth.final)))
        queries += [(cut, (part,), (), truth.having(part)) for part in PARTS]
        queries += [
            (cut, ("bound",), ("-c", "places=3"), truth.having(bound=3)),
            (cut, ("boundary", "minimal"), (), truth.best(closed=False)),
            (cut, ("genus",), (), least),
        ]
    return queries


def needed(file):
    """The queries that load a file: a part's own, or all of them for the theory."""
    part = file.split("/")[-1]
    return [query for query in corpus() if part in (*THEORY, *query[1])]


@pytest.mark.parametrize(("file", "number"), rules())
def test_no_rule_can_be_removed(file, number):
    def program(name):
        kept = list(statements(name))
        if name == file:
            del kept[number]
        return "\n".join(map(str, kept))

    for experience, parts, arguments, expected in needed(file):
        programs = [program(name) for name in ("topomap", *map("theory/{}".format, THEORY), *parts)]
        if answers(parts, experience.facts(), *arguments, programs=programs) != expected:
            return
    pytest.fail("no answer changes without it")
