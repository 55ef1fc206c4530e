"""What is known besides views -- compass, odometry, lengths, known closures -- in every way to an
answer: the encodings, the statement, step by step, the phases, the search with and without looking
ahead, brute force, and both checkers."""

import random

import pytest
from conftest import ENCODINGS, TRIED, Truth, answers
from oracles.worlds import informed
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search.descent import Descent
from topomap.search.traversal import depth_first, root


def searched(experience, **asked):
    """The hypotheses of the tree that is only pruned by what is asked after each step."""
    node = root(experience, Query(**asked))
    return {n.dstates for n in depth_first(node) if n.steps == experience.steps}


def ahead(experience, *parts):
    """The same of the search that looks ahead."""
    found = Descent(experience, Query(frozenset(parts))).found(Watch(None))
    return {one.at for one in found if one is not None}


def agree(experience):
    truth, constants = Truth(experience), experience.constants()
    facts = experience.facts()
    for form in ("work", "paper"):
        assert answers((), facts, *constants, encoding=form) == {*truth.final}, (form, facts)
        planar = answers(("planar",), facts, *constants, encoding=form)
        assert planar == truth.having("planar"), (form, facts)
    assert searched(experience) == {*truth.final}, facts
    for parts in ((), ("closed",), ("planar", "closed"), ("boundary", "closed")):
        assert ahead(experience, *parts) == truth.having(*parts), (parts, facts)
    TRIED["explorations with compass, odometry, lengths or known closures"] += 1
    return truth


@pytest.mark.parametrize("block", range(4))
def test_random_worlds(block):
    found = [agree(informed(random.Random(f"informed {block}/{n}"), 9)).final for n in range(60)]
    assert sum(len(maps) > 1 for maps in found) > 5


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many_random_worlds(block):
    for number in range(300):
        agree(informed(random.Random(f"many informed {block}/{number}"), 10))
