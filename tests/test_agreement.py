"""Stock clingo on the encodings against the independent search, on random experiences."""

import random
from itertools import combinations

import pytest
from conftest import PARTS, Truth, answers
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worlds import random_experience

QUICK = settings(
    max_examples=60,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)


def listed(experience, most=150):
    """The experience, cut where its tree has grown to ``most`` hypotheses, and what the
    independent search says of it."""
    for horizon in range(experience.steps + 1):
        cut = experience.cut(horizon)
        truth = Truth(cut)
        if len(truth.final) > most:
            break
    return cut, truth


@st.composite
def experiences(draw):
    return listed(random_experience(draw(st.randoms(use_true_random=False)), 10))


def agree_on_parts(experience, truth):
    facts = experience.facts()
    assert answers((), facts) == set(truth.final)
    for number in (1, 2, len(PARTS)):
        for parts in combinations(PARTS, number):
            assert answers(parts, facts) == truth.having(*parts), parts


def agree_on_planarity(experience, truth):
    pruned = set(truth.planar_levels()[-1])
    assert pruned == truth.having("planar")
    assert answers(("planar",), experience.facts()) == pruned
    assert answers(("euler",), experience.facts()) == pruned


def agree_on_preferences(experience, truth):
    facts, final = experience.facts(), truth.final
    fewest = truth.least(lambda h: h.cost(), final)
    flattest = truth.least(lambda h: h.genus(), final)
    both = truth.least(lambda h: (h.genus(), *h.cost()), final)
    assert answers(("minimal",), facts) == fewest
    assert answers(("genus",), facts) == flattest
    assert answers(("genus", "minimal"), facts) == both
    assert answers(("closed", "boundary", "minimal"), facts) == truth.best(closed=True)
    assert answers(("boundary", "minimal"), facts) == truth.best(closed=False)


@QUICK
@given(experiences())
def test_parts(case):
    agree_on_parts(*case)


@QUICK
@given(experiences(), st.data())
def test_bounds(case, data):
    experience, truth = case
    bound = data.draw(st.integers(1, experience.steps + 1))
    found = answers(("bound",), experience.facts(), "-c", f"places={bound}")
    assert found == truth.having(bound=bound)


@QUICK
@given(experiences())
def test_planarity_three_ways(case):
    agree_on_planarity(*case)


@QUICK
@given(experiences())
def test_preferences(case):
    agree_on_preferences(*case)


@QUICK
@given(experiences())
def test_horizons_are_the_levels_of_the_tree(case):
    experience, truth = case
    for step, level in enumerate(truth.levels):
        assert answers((), experience.facts(), "-c", f"horizon={step}") == set(level)


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many(block):
    """A thousand longer experiences, at random but the same each time."""
    for number in range(100):
        case = listed(random_experience(random.Random(f"{block}.{number}"), 13), 300)
        agree_on_parts(*case)
        agree_on_planarity(*case)
        agree_on_preferences(*case)


def test_the_generator_makes_what_it_promises():
    made = [random_experience(random.Random(n), 10) for n in range(300)]
    assert {e.slots for e in made} >= {2, 4, 6, 8, 12}
    assert {len(view) for e in made for view in e.views} == set(range(1, 7))
    assert any(0 in e.turns[1:] for e in made)
    assert any(any(e.landmarks) for e in made)
