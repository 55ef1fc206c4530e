"""What is known besides views -- compass, odometry, lengths, known closures -- in every way to an
answer: the encodings, the statement, step by step, the phases, the search with and without looking
ahead, brute force, and both checkers."""

import random
from collections import Counter
from dataclasses import replace
from itertools import islice

import clingo
import pytest
import topomap
from bench.knowledge import ASKED, WORLDS, counted, experience
from conftest import ENCODINGS, PARTS, ROOT, TRIED, Truth, answers, forms
from oracles.brute_force import certain
from oracles.worlds import informed, logs, told
from topomap.documents.check import by_definition, by_rules
from topomap.model.experience import Experience, observe
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search.descent import Descent
from topomap.search.traversal import depth_first, root
from topomap.solver import phases
from topomap.solver.online import OnlineSolver
from topomap.solver.stepwise import Asked
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance
from topomap.worlds.senses import Senses

MOST = 5_000  # maps of a random experience


def searched(experience, **asked):
    """The hypotheses of the tree that is only pruned by what is asked after each step."""
    node = root(experience, Query(**asked))
    return {n.dstates for n in depth_first(node) if n.steps == experience.steps}


def ahead(experience, *parts):
    """The same of the search that looks ahead."""
    found = Descent(experience, Query(frozenset(parts))).found(Watch(None))
    return {one.at for one in found if one is not None}


def small(experience, most=MOST, *parts):
    """Whether there are at most so many maps: all ways to all of more take too long."""
    nodes = depth_first(root(experience, Query(frozenset(parts))))
    whole = (node for node in nodes if node.steps == experience.steps)
    return sum(1 for _ in islice(whole, most + 1)) <= most


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


def followed(draw, seen, follower, levels):
    """Follow an experience, and take steps back now and then: after each step the hypotheses, and
    what is certain, are those of the beginning so far. Gives the steps, and what is known."""
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
        known = certain(levels[step]) if levels[step] else (set(), set())
        assert (status.certain.same, status.certain.new) == known, seen.facts()
        yield step, status


@pytest.mark.parametrize("block", range(3))
def test_step_by_step(block):
    """After each step what is known is right; what is taken back leaves no trace."""
    for number in range(30):
        draw = random.Random(f"informed online {block}/{number}")
        seen = informed(draw, 7) if number % 2 else logs(draw, 6)
        levels = Truth(seen).levels
        asked = Asked(drift=seen.drift, stretch=seen.stretch)
        follower = OnlineSolver(seen.slots, told(seen, 0), asked)
        assert len([*followed(draw, seen, follower, levels)]) >= seen.steps
        TRIED["explorations with more than views, step by step"] += 1


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("block", range(4))
def test_random_worlds(block):
    found = [agree(informed(random.Random(f"informed {block}/{n}"), 9)).final for n in range(60)]
    assert sum(len(maps) > 1 for maps in found) > 5


@pytest.mark.slow
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
    for number in range(60):
        for seen in (
            informed(random.Random(f"many informed {block}/{number}"), 10),
            logs(random.Random(f"many logs {block}/{number}"), 8),
        ):
            if small(seen):
                agree(seen)
            else:
                TRIED[f"experiences left out that have more than {MOST} maps"] += 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", [informed, logs])
def test_why(kind):
    """Verdicts are those of brute force, and reasons are verified by the explainer itself."""
    for number in range(20):
        draw = random.Random(f"why {number}")
        seen = kind(draw, 6)
        maps = [h.at for h in Truth(seen).final.values()]
        t, u = draw.randrange(seen.steps + 1), draw.randrange(seen.steps + 1)
        same = {at[t][0] == at[u][0] for at in maps}
        found = topomap.explain(seen, f"same({t},{u})")
        wanted = "no map"
        if maps:
            wanted = "open" if len(same) == 2 else "certain" if True in same else "impossible"
        assert (found.verdict, found.complete) == (wanted, True), seen.facts()
        for reason in found.explanation.reasons:
            TRIED[f"reasons given: {reason.kind}"] += 1


@pytest.mark.slow
def test_words():
    """What is said of each kind of reason."""
    ring = Experience(4, [[0, 1], [0, 3], [0, 3], [0, 3], [0, 3]], [0, 3, 3, 3])
    for changed, statement, words in (
        (
            {"compass": [0, 1, 0, 3, 0]},
            "same(0,4)",
            "points to compass slot 0 after step 0, and to 0",
        ),
        (
            {"shifts": [(10, 0), (0, 10), (-3, 0), (0, -10)]},
            "same(0,4)",
            "step 4 is at least 3.7 units from step 0 by its odometry: 7 were measured on a way "
            "of 33, wrong by 10 % at most",
        ),
        ({"apart": [(0, 4)]}, "same(0,4)", "have been at two places after steps 0 and 4"),
        (
            {"same": [(0, 4)]},
            "not same(0,4)",
            "have been at one place after steps 0 and 4",
        ),
    ):
        found = topomap.explain(replace(ring, **changed), statement)
        assert any(words in line for line in found.lines()), [*found.lines()]
    back = Experience(4, [[0], [0, 2], [0]], [0, 0], lengths=[100, 50])
    told = [*topomap.explain(back).lines()]
    assert any("steps 1 and 2 would go along one link, and are 100 and 50" in one for one in told)
    looks = Experience(4, [[0], [0, 1], [0, 1, 2]], [0, None], looks=[2])
    told = [*topomap.explain(looks).lines()]
    assert any("the second look of step 2" in one for one in told), told
    coin = Experience(4, [[0], [0, 1], [0]], [0, 0], things=[("drop", 0, "coin")])
    told = [*topomap.explain(coin).lines()]
    assert any("does not see the marker coin, which lies at place 0" in one for one in told), told


@pytest.mark.slow
def test_what_is_assumed():
    """Only the maps in which a statement holds are left, in each way to ask for them."""
    seen = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    every = Truth(seen).final
    few = {at for at, h in every.items() if len(h.stars) < 9 and at[0][0] != at[8][0]}
    told = topomap.assume(seen, "places < 9", "not same(0,8)")
    assert (told.apart, told.assumed) == ({(0, 8)}, {("least(place,9)", False)})
    assert {one.at for one in topomap.solve(told)} == few
    assert {one.at for one in topomap.solve(told, jobs=2)} == few
    asked = topomap.ask(told, "places < 9", "same(0,8)", "planar")
    assert [one.holds for one in asked][:2] == ["all", "none"]
    assert topomap.explain(told, "same(0,8)").verdict == "impossible"
    assert topomap.explain(topomap.assume(seen, "places < 3")).verdict == "no map"
    best = topomap.solve(topomap.assume(seen, "not planar"), optimal=True)
    assert all(one.genus for one in best)
    with pytest.raises(topomap.InputError, match="slot 7"):
        topomap.assume(seen, "pending(0,7)")
    with pytest.raises(topomap.InputError, match="one place with itself"):
        topomap.assume(seen, "not same(3,3)")
    assert topomap.assume(seen, "same(3,3)") == seen


@pytest.mark.slow
def test_what_is_assumed_is_a_reason():
    """Without it there would be a map, so an explanation names it, in the words of a statement."""
    seen = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    for statement, words in {
        "places < 3": "taken for granted: places < 3",
        "not path(0,0,1,0)": "taken for granted: not path(0,0,1,0)",
        "pending != 3": None,
    }.items():
        told = topomap.explain(topomap.assume(seen, statement))
        assert (told.verdict == "no map") == (words is not None), statement
        assert words is None or [one for one in told.lines() if words in one], [*told.lines()]


def test_a_compass_that_is_known_of_some_visits_is_left_out_of_plans():
    """It is said, in the one line that begins with it."""
    seen = instance(grid(3, 3), "ESWN", senses=Senses(compass=True)).experience
    some = replace(seen, compass=(*seen.compass[:-1], None))
    for walk, said in ((seen, 0), (some, 1), (replace(seen, compass=()), 0)):
        lines = topomap.explore(walk).lines()
        assert sum("the compass is left out of the plan" in line for line in lines) == said


def test_who_does_not_ask_the_encodings_refuses_what_is_assumed():
    seen = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    told = topomap.assume(seen, "places < 9")
    maps = list(topomap.solve(told, limit=1))
    for call in (
        lambda: topomap.solve(told, by="search"),
        lambda: topomap.solve(told, encoding="paper"),
        lambda: topomap.count(told),
        lambda: topomap.check(told, maps),
    ):
        with pytest.raises(ValueError, match="taken for granted"):
            call()
    with pytest.raises(topomap.InputError, match="foo: no such word"):
        topomap.solve(Experience(4, [[0]], [], assumed=[("foo", True)]))
    with pytest.raises(ValueError, match="assumed"):
        Experience(4, [[0]], [], assumed=["planar"])
    with pytest.raises(ValueError, match="assumed"):
        Experience(4, [[0]], [], assumed=[("planar(", True)])


@pytest.mark.slow
def test_a_marker_may_have_any_name():
    """The marker that has no name is not one of those that have one, whatever they are called."""
    for name in ("()", "unnamed", "none", "named(x)", '"a b"', "0"):
        seen = Experience(4, [[0, 1]] * 5, [1] * 4, drops=[1, (0, name)], markers=[(4, name)])
        found = Truth(seen).final.keys()
        assert {at[4][0] for at in found} == {0}
        for by in ("clingo", "search"):
            assert {one.at for one in topomap.solve(seen, by=by)} == found, (name, by)
        follower = topomap.follow(4)
        for step, view in enumerate(seen.views):
            drop = {0: name, 1: True}.get(step, False)
            marker = name if step == 4 else False
            turn = None if step == 0 else 1
            status = follower.step(sorted(view), turn, drop=drop, marker=marker)
        assert status.hypotheses == len(found)


PAGE = {  # semantics.md, "A compass" and "Odometry": all maps, planar ones, closed, both
    "3x3 a compass": (16, 12, 1, 1),
    "3x3 odometry, drift 5": (24, 14, 2, 1),
    "3x3 odometry, drift 10": (24, 14, 2, 1),
    "3x3 odometry, drift 20": (39, 29, 2, 1),
    "3x3 drift 10 and a compass": (16, 12, 1, 1),
    "3x4 a compass": (112, 54, 2, 1),
    "3x4 odometry, drift 5": (180, 58, 4, 1),
    "3x4 odometry, drift 10": (264, 87, 4, 1),
    "3x4 odometry, drift 20": (459, 138, 8, 1),
    "3x4 drift 10 and a compass": (80, 43, 1, 1),
    "4x4 a compass": (6688, 661, 24, 1),
    "4x4 odometry, drift 5": (2592, 237, 16, 1),
    "4x4 odometry, drift 10": (58920, 3303, 384, 1),
    "4x4 odometry, drift 20": (105228, 5878, 416, 1),
    "4x4 drift 10 and a compass": (6688, 661, 24, 1),
}


@pytest.mark.slow
@pytest.mark.parametrize("row", PAGE)
def test_the_figures_of_the_page(row):
    """By clingo, and where they are few by the search, too (``counted`` demands it)."""
    name, _, known = row.partition(" ")
    ((_, size, route),) = [world for world in WORLDS if world[0] == name]
    seen = experience(size, route, known)
    found = tuple(counted(seen, parts, 300) for parts in ASKED.values())
    assert found == PAGE[row]


def test_the_table_of_the_page():
    """docs/knowledge.md has these figures."""
    text = (ROOT / "docs/knowledge.md").read_text(encoding="utf-8")
    for row, (every, planar, closed, both) in PAGE.items():
        name, _, known = row.partition(" ")
        assert f"| {name} | {known} | {every:,} ({closed:,}) | {planar:,} ({both:,}) |" in text
    for row in ("| 5x5 | a compass | not settled (362,880) |",):
        assert row in text


@pytest.mark.slow
def test_two_logs_of_the_3x3_grid():
    """And two halves of the 4x4 snake, cut at step 15: by brute force."""
    world = grid(3, 3).map
    one, _ = observe(world, ((0, 0), 1), [1, 1, 2, 2])
    other, _ = observe(world, ((2, 0), 1), [1, 0, 0, 3])
    both = Experience(
        4, [*one.views, *other.views], [*one.turns, None, *other.turns], starts=[one.steps + 1]
    )
    truth = Truth(both)
    assert {found.at for found in topomap.solve(both)} == {*truth.final}
    for parts in (("planar",), ("closed",), ("planar", "perpendicular")):
        answer = topomap.solve(both, **dict.fromkeys(parts, True))
        assert {found.at for found in answer} == truth.having(*parts)
    assert any(len(h.parts()) > 1 for h in truth.final.values())
    assert any(len(h.parts()) == 1 for h in truth.final.values())


@pytest.mark.long
def test_two_halves_of_the_4x4_snake():
    whole = instance(grid(4, 4), "snake").experience
    views = [*whole.views[:16], *whole.views[15:]]  # the second log begins where the first ends
    turns = [*whole.turns[:15], None, *whole.turns[15:]]
    north = instance(grid(4, 4), "snake", senses=Senses(compass=True)).experience.compass
    north = [*north[:16], *north[15:]]
    halves = Experience(4, views, turns, starts=[16], compass=north)
    truth = Truth(halves)
    assert {found.at for found in topomap.solve(halves)} == {*truth.final}
    planar = topomap.solve(halves, planar=True)
    assert {found.at for found in planar} == truth.having("planar")
