"""Stock clingo on the encodings against the independent search, on random experiences."""

import os
import random

import pytest
from conftest import PARTS, Truth, answers
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worlds import random_experience

settings.register_profile("quick", max_examples=60, derandomize=True)
settings.register_profile("long", max_examples=1500)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "quick"))
LIMITS = {"deadline": None, "suppress_health_check": list(HealthCheck)}


@st.composite
def experiences(draw):
    """Experiences whose trees the independent search can list."""
    experience = random_experience(draw(st.randoms(use_true_random=False)), 10)
    for horizon in range(experience.steps + 1):
        truth = Truth(experience.cut(horizon))
        if len(truth.final) > 150:
            break
    return experience.cut(horizon), truth


@settings(**LIMITS)
@given(experiences(), st.data())
def test_each_part_alone_and_some_together(case, data):
    experience, truth = case
    facts = experience.facts()
    assert answers((), facts) == set(truth.final)
    for part in PARTS:
        assert answers((part,), facts) == truth.having(part), part
    together = data.draw(st.sets(st.sampled_from(PARTS)))
    bound = data.draw(st.integers(1, experience.steps + 1))
    parts = (*sorted(together), "bound")
    assert answers(parts, facts, "-c", f"places={bound}") == truth.having(*together, bound=bound)


@settings(**LIMITS)
@given(experiences())
def test_planarity_three_ways(case):
    experience, truth = case
    pruned = set(truth.planar_levels()[-1])
    assert pruned == truth.having("planar")
    assert answers(("planar",), experience.facts()) == pruned
    assert answers(("euler",), experience.facts()) == pruned


@settings(**LIMITS)
@given(experiences())
def test_preferences(case):
    experience, truth = case
    facts = experience.facts()
    least = truth.least
    assert answers(("minimal",), facts) == least(lambda h: h.cost(), truth.final)
    assert answers(("genus",), facts) == least(lambda h: h.genus(), truth.final)
    assert answers(("genus", "minimal"), facts) == least(
        lambda h: (h.genus(), *h.cost()), truth.final
    )
    assert answers(("closed", "boundary", "minimal"), facts) == truth.best(closed=True)
    assert answers(("boundary", "minimal"), facts) == truth.best(closed=False)


@settings(**LIMITS)
@given(experiences())
def test_horizons_are_the_levels_of_the_tree(case):
    experience, truth = case
    for step, level in enumerate(truth.levels):
        assert answers((), experience.facts(), "-c", f"horizon={step}") == set(level)


@pytest.mark.parametrize("seed", range(3))
def test_the_generator_makes_what_it_promises(seed):
    made = [random_experience(random.Random(f"{seed}.{n}"), 10) for n in range(200)]
    assert {e.slots for e in made} >= {2, 4, 6, 8, 12}
    assert {len(view) for e in made for view in e.views} == set(range(1, 7))
    assert any(0 in e.turns[1:] for e in made)
    assert any(any(e.landmarks) for e in made)
