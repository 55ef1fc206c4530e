"""What is known besides views -- compass, odometry, lengths, known closures -- in every way to an
answer: the encodings, the statement, step by step, the phases, the search with and without looking
ahead, brute force, and both checkers."""

import random
from collections import Counter
from dataclasses import replace

import clingo
import pytest
from conftest import ENCODINGS, PARTS, TRIED, Truth, answers, forms
from oracles.brute_force import certain
from oracles.worlds import informed, logs, told
from topomap.documents.check import by_definition, by_rules
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search.descent import Descent
from topomap.search.traversal import depth_first, root
from topomap.solver import phases
from topomap.solver.online import OnlineSolver


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
    for parts in ((), *((part,) for part in PARTS)):
        for form in forms(*parts):
            found = answers(parts, facts, *constants, encoding=form)
            assert found == truth.having(*parts), (form, parts, facts)
    if truth.final:
        fewest = answers(("minimal",), facts, *constants)
        assert fewest == truth.least(lambda h: h.cost(), truth.final), facts
        least = answers(("genus",), facts, *constants)
        assert least == truth.least(lambda h: (h.genus(),), truth.final), facts
    assert searched(experience) == {*truth.final}, facts
    for parts in ((), ("closed",), ("planar", "closed"), ("boundary", "closed")):
        assert ahead(experience, *parts) == truth.having(*parts), (parts, facts)
    checked(experience, truth)
    TRIED["explorations with compass, odometry, lengths or known closures"] += 1
    return truth


def checked(experience, truth):
    """Both checkers pass the hypotheses, and say the same of what is one without that knowledge;
    a hypothesis of this is one with that knowledge if and only if nothing is violated."""
    bare = replace(experience, compass=(), shifts=(), lengths=(), same=(), apart=(), things=())
    for at in sorted(Truth(bare).final)[:30]:
        told = [(step, place, slot) for step, (place, slot) in enumerate(at)]
        for demands in ((), ("planar", "closed", "boundary")):
            found = by_rules(experience, told, demands)
            assert found == by_definition(experience, told, demands), (at, experience.facts())
        found = by_rules(experience, told)
        assert (not found) == (at in truth.final), (at, found, experience.facts())
        for rule, _ in found:
            TRIED[f"maps that violate {rule}"] += 1


@pytest.mark.parametrize("block", range(3))
def test_step_by_step(block):
    """After each step the hypotheses are those of the beginning so far; what is taken back leaves
    no trace."""
    for number in range(30):
        draw = random.Random(f"informed online {block}/{number}")
        seen = informed(draw, 7) if number % 2 else logs(draw, 6)
        levels = Truth(seen).levels
        follower = OnlineSolver(seen.slots, told(seen, 0), drift=seen.drift, stretch=seen.stretch)
        step = 0
        while step < seen.steps:
            if step and draw.random() < 0.2:
                follower.undo()
                step -= 1
                continue
            step += 1
            follower.step(told(seen, step))
            assert follower.experience == seen.cut(step)
            status = follower.status(Watch(None))
            assert status.hypotheses == len(levels[step]), seen.facts()
            certain_ = certain(levels[step]) if levels[step] else (set(), set())
            assert (status.certain.same, status.certain.new) == certain_
        TRIED["explorations with more than views, step by step"] += 1


@pytest.mark.parametrize("block", range(2))
def test_phases(block):
    """What the phases leave has the maps of the whole theory."""
    for number in range(60):
        seen = informed(random.Random(f"informed phases {block}/{number}"), 9)
        work = phases._Phases(seen.facts(), ENCODINGS, lambda _: None, seen.constants())
        work.visits()
        control = clingo.Control(["0", *seen.constants()])
        control.load(str(ENCODINGS / "phases/topomap.lp"))
        control.add("base", [], seen.facts() + work.facts())
        control.ground()
        maps = set()
        with control.solve(yield_=True) as models:
            for model in models:
                at = sorted([a.number for a in s.arguments] for s in model.symbols(shown=True))
                maps.add(tuple((place, slot) for _, place, slot in at))
        assert maps == {*Truth(seen).final}, seen.facts()


@pytest.mark.parametrize("block", range(4))
def test_random_worlds(block):
    found = [agree(informed(random.Random(f"informed {block}/{n}"), 9)).final for n in range(60)]
    assert sum(len(maps) > 1 for maps in found) > 5


@pytest.mark.parametrize("block", range(4))
def test_several_logs(block):
    """And second looks, and markers with names."""
    kinds = Counter()
    for number in range(60):
        seen = logs(random.Random(f"logs {block}/{number}"), 7)
        truth = agree(seen)
        parts = {len(h.parts()) for h in truth.final.values()}
        kinds.update({"starts": bool(seen.starts), "looks": bool(seen.looks)})
        kinds.update({"things": bool(seen.things), "components": max(parts, default=1) > 1})
        kinds["joined"] += bool(seen.starts) and 1 in parts
    assert min(kinds.values()) > 5, kinds


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many_random_worlds(block):
    for number in range(300):
        agree(informed(random.Random(f"many informed {block}/{number}"), 10))
        agree(logs(random.Random(f"many logs {block}/{number}"), 8))
