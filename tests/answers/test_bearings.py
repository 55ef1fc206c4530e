"""Which gateways are on one path, and bearings that are not exact: all ways to an answer agree."""

import random
from collections import Counter

import clingo
import pytest
import topomap
from answers.test_knowledge import ahead, followed, searched, small
from conftest import ENCODINGS, PARTS, ROOT, TRIED, Truth, answers, forms
from oracles.brute_force import Hypothesis, tree
from oracles.worlds import bent, told, wavering
from topomap.model.experience import Experience
from topomap.model.facts import parse
from topomap.runtime.errors import InputError
from topomap.solver.online import OnlineSolver
from topomap.solver.stepwise import Asked

MOST = 500  # maps of a random experience


def agree(seen):
    """The answers of each way, of an experience; returns those of brute force."""
    truth, facts, constants = Truth(seen), seen.facts(), seen.constants()
    assert parse(facts, "its facts", tolerance=seen.tolerance) == seen
    for parts in ((), *((part,) for part in PARTS)):
        for form in forms(*parts):
            # The statement has no left and right of paths whose gateways are given.
            if (form, bool(seen.straight), *parts) != ("paper", True, "boundary"):
                found = answers(parts, facts, *constants, encoding=form)
                assert found == truth.having(*parts), (form, parts, facts)
    assert searched(seen) == {*truth.final}, facts
    for parts in ((), ("closed",), ("planar", "closed"), ("boundary", "closed")):
        assert ahead(seen, *parts) == truth.having(*parts), (parts, facts)
    if not truth.final:
        return truth
    for form in ("work", "paper"):
        found = answers(("minimal",), facts, *constants, encoding=form)
        assert found == truth.least(Hypothesis.cost, truth.final), (form, facts)
    found = answers(("exceptions",), facts, *constants)
    assert found == truth.least(lambda h: sum(h.exceptions()), truth.final), facts
    for at, one in [*truth.final.items()][:30]:
        world = seen.map_of(at)
        kinds = Counter(exception.kind for exception in world.exceptions())
        assert (kinds["meet twice"], kinds["place twice"], kinds["both sides"]) == one.exceptions()
        assert (len(world.paths()), world.genus()) == (len(one.paths()), one.genus())
        assert (world.path_axiom_fault() is not None) == one.breaks_path_axiom()
    return truth


def agree_without_axiom(seen):
    """The same where the path axiom is taken away."""
    facts, constants = seen.facts(), seen.constants()
    maps = [
        Hypothesis(Truth(seen).experience, at)
        for at in tree(Truth(seen).experience, axiom=False)[-1]
    ]
    tests = {
        (): lambda h: True,
        ("planar",): lambda h: h.genus() == 0,
        ("closed",): Hypothesis.closed,
        ("boundary",): Hypothesis.boundary,
        ("perpendicular",): Hypothesis.perpendicular,
        ("travelled",): Hypothesis.travelled,
    }
    for parts, test in tests.items():
        wanted = {h.at for h in maps if test(h)}
        found = answers((*parts, "no_path_axiom"), facts, *constants)
        assert found == wanted, (parts, facts)
        assert ahead(seen, *parts, "no_path_axiom") == wanted, (parts, facts)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(3))
def test_random_worlds(block):
    kinds = Counter()
    for number in range(25):
        seen = bent(random.Random(f"bent {block}/{number}"), 7)
        if not small(seen, MOST):
            continue
        maps = len(agree(seen).final)
        kinds.update({"pairs": bool(seen.straight), "errors": bool(seen.tolerance)})
        kinds["both"] += bool(seen.straight and seen.tolerance and maps > 1)
        TRIED["experiences with pairs of gateways, or bearings that are not exact"] += 1
    assert min(kinds.values()) > 1, kinds


@pytest.mark.slow
def test_without_the_path_axiom():
    for number in range(25):
        seen = bent(random.Random(f"bent without the axiom {number}"), 6)
        if small(seen, MOST, "no_path_axiom"):
            agree_without_axiom(seen)


@pytest.mark.long
@pytest.mark.parametrize("block", range(5))
def test_many_random_worlds(block):
    left_out = 0
    for number in range(60):
        seen = bent(random.Random(f"many bent {block}/{number}"), 9)
        free = bent(random.Random(f"many bent freely {block}/{number}"), 7)
        if small(seen, MOST):
            agree(seen)
        if small(free, MOST, "no_path_axiom"):
            agree_without_axiom(free)
        left_out += not small(seen, MOST)
    assert left_out < 20


@pytest.mark.parametrize("seed", range(20))
def test_a_junction_seen_from_its_gateways(seed):
    """Each bearing is as far off as it may be; two visits from different gateways, both later than
    the first one, may differ by three times as much."""
    agree(wavering(random.Random(f"seen from its gateways {seed}")))


DRIFT = ROOT / "tests/cases/drift.lp"


@pytest.mark.parametrize(("tolerance", "maps"), [(0, 0), (1, 1), (2, 1)])
def test_a_bearing_that_is_one_off(tolerance, maps):
    assert len([*topomap.solve(topomap.read(DRIFT, tolerance=tolerance))]) == maps


@pytest.mark.slow
def test_opposite_gateways_are_on_one_path_unless_pairs_are_given():
    """Telling of each visit that opposite gateways are on one path changes nothing."""
    seen = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    pairs = [[*seen.pairs(visit)] for visit in range(seen.steps + 1)]
    told = Experience(4, seen.views, seen.turns, straight=pairs)
    assert answers((), told.facts()) == answers((), seen.facts())
    assert {one.at for one in topomap.solve(told)} == answers((), seen.facts())
    # And where no gateway goes on, a path ends at each.
    ends = Experience(4, seen.views, seen.turns, straight=[[] for _ in seen.views])
    assert parse(ends.facts(), "its facts") == ends
    assert agree(ends).final.keys() > agree(told).final.keys()


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        ("straight(0,0,2).", "straight(0,0,2): no gateway in slot 2"),
        ("straight(1,0,2). straight(1,2,1).", "gateway 2 is in more than one pair"),
        ("straight(1,0,9).", "slot 9 is not in 0..3"),
        ("straight(7,0,1).", "it has no turn"),
    ],
)
def test_pairs_that_cannot_be(facts, said):
    text = "slots(4). view(0,0). turn(1,0). view(1,0). view(1,1). view(1,2). "
    with pytest.raises(InputError) as told:
        parse(text + facts, "name")
    assert str(told.value).startswith("name:1: step")
    assert said in str(told.value)


@pytest.mark.parametrize("block", range(2))
def test_step_by_step(block):
    """After each step what is known is right, and so are the best maps."""
    compared = 0
    for number in range(20):
        draw = random.Random(f"bent online {block}/{number}")
        seen = bent(draw, 6)
        measured = seen.drift, seen.stretch, seen.tolerance
        follower = OnlineSolver(seen.slots, told(seen, 0), Asked(False, None, 10_000, *measured))
        for step, status in followed(draw, seen, follower, Truth(seen).levels):
            truth = Truth(seen.cut(step))
            wanted = truth.best(True) or truth.best(False)
            if status.all_best:  # else only some of them are shown
                assert {*status.best} == wanted, seen.facts()
                compared += 1
            else:
                assert {*status.best} < wanted, seen.facts()
    assert compared > 40


def test_lines_of_a_follower():
    """Pairs of gateways are given in facts or in JSON, from the first view on or not at all."""
    follower = topomap.follow(6, tolerance=1)
    follower.step([0, 2], straight=[(0, 2)])
    status = follower.step([0, 3], 2, straight=[(0, 3)])
    assert follower.record.steps[1].straight == {(0, 3)}
    assert status.hypotheses == 1
    assert follower.step([0, 2], 0, straight=[]).hypotheses == 0  # no gateway goes on there
    with pytest.raises(ValueError, match="gateway 0 is in more than one pair"):
        follower.step([0, 1, 2], 2, straight=[(0, 1), (2, 0)])
    other = topomap.follow(4)
    other.step([0, 1])
    with pytest.raises(ValueError, match="from step 0 on, or not at all"):
        other.step([0, 1], 0, straight=[(0, 1)])


def test_the_statement_says_when_it_has_no_left_and_right():
    """With pairs of gateways, what needs left and right of paths has no model, and a message."""
    seen = bent(random.Random("bent sides"), 5)
    told = Experience(seen.slots, seen.views, seen.turns, straight=[[] for _ in seen.views])
    for part in ("boundary", "beyond/exceptions"):
        messages = []
        control = clingo.Control(logger=lambda _, text, told=messages: told.append(text))
        for file in ("topomap", "beyond/straight", part):
            control.load(str(ENCODINGS / f"paper/{file}.lp"))
        control.add("base", [], told.facts())
        control.ground()
        assert not control.solve().satisfiable
        assert any("with_sides" in text for text in messages)
