"""Each rule of the theory: a case in which it holds and one in which it bites."""

from dataclasses import replace

import pytest
from clintest.assertion import SupersetOf
from clintest.quantifier import Any
from clintest.solver import Clingo
from clintest.test import Assert
from conftest import answers, forms
from oracles.known_answers import EXPERIENCES, seen
from topomap.solver.programs import FORMS

in_every_form = pytest.mark.parametrize("form", FORMS)


def admits(form, parts, experience, at, *arguments):
    """Whether the hypothesis ``at``, written "place.gateway ...", is an answer."""
    dstates = [dstate.split(".") for dstate in at.split()]
    wanted = {f"at({step},{place},{slot})" for step, (place, slot) in enumerate(dstates)}
    marker = ["beyond/marker"] * (form == "paper" and bool(experience.drops))
    files = [str(FORMS[form] / f"{part}.lp") for part in ("topomap", *marker, *parts)]
    test = Assert(Any(), SupersetOf(wanted))
    Clingo(["0", *arguments], experience.facts(), files).solve(test)
    return test.outcome().current_value()


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
the marker is seen where it lies |               | marker: 0.0 1.0 0.1              | no marker: 0.0 1.0 0.1
and not elsewhere                |               | no marker: 0.0 1.0 2.0           | marker: 0.0 1.0 2.0
who takes it up sees it          |               | taken: 0.0 1.0 0.1               | taken: 0.0 1.0 2.0
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


@in_every_form
@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_rule_holds_and_bites(case, form):
    _, part, holds, bites = (field.strip() for field in case.split("|"))
    if form not in forms(*[part] * bool(part)):
        pytest.skip(f"the paper's statement does not have {part}.lp")
    parts, bound = [part] if part else [], ["-c", "places=3"] if part == "bound" else []

    def admitted(parts, case, *arguments):
        name, _, at = case.partition(": ")
        return admits(form, parts, EXPERIENCES[name], at, *arguments)

    assert admitted(parts, holds, *bound)
    assert not admitted(parts, bites, *bound)
    if part:
        assert admitted([], bites), "another rule bites too"


@in_every_form
def test_the_fewest_paths_and_places_are_preferred(form):
    facts = EXPERIENCES["square"].facts()
    best = {((0, 0), (1, 0), (2, 0), (3, 0), (0, 3))}
    assert answers(("minimal",), facts, encoding=form) == best


def test_the_least_genus_is_preferred_to_the_fewest_paths():
    """Of this experience, the one map with the fewest paths is not planar."""
    across = seen("0 1 3", "0: 0 1 3", "3: 0 1 2 3", "1: 0 1 2 3", "1: 0 2 3", "2: 0 1 2 3")
    across = replace(across, landmarks=tuple(map(frozenset, ["", "b", "a", "", "", "a"])))
    facts = across.facts()
    (fewest,) = answers(("minimal",), facts)
    planar = answers(("planar",), facts)
    assert fewest not in planar
    assert answers(("genus", "minimal"), facts) < planar


@in_every_form
def test_the_horizon_cuts_the_experience(form):
    square = EXPERIENCES["square"]
    for horizon in range(square.steps + 1):
        cut = answers((), square.cut(horizon).facts(), encoding=form)
        assert answers((), square.facts(), "-c", f"horizon={horizon}", encoding=form) == cut
