"""Exceptions to consistent boundaries, and maps without the path axiom: the figures of the small
cases, and rules, statement, search and oracle against each other on random explorations."""

import random
from collections import Counter

import clingo
import pytest
import topomap
from conftest import ENCODINGS, ROOT, TRIED, Truth, plain
from oracles import brute_force
from oracles.worlds import random_experience
from topomap.model.experience import observe
from topomap.model.facts import parse
from topomap.model.query import Query
from topomap.model.topology import TopologicalMap
from topomap.runtime.watch import Watch
from topomap.search.hypothesis import Hypothesis
from topomap.search.traversal import depth_first
from topomap.solver.solving import count

CASES = ROOT / "tests/cases"
KINDS = ("meet_twice", "place_twice", "both_sides")
NORTH, EAST, SOUTH, WEST = range(4)
MOST = 600  # maps of one exploration


def maps(facts, *files, optimal=False):
    """Each map by its dstates, with its exceptions by kind and what it costs; None of very many."""
    control = clingo.Control(["0", f"--opt-mode={'optN' if optimal else 'ignore'}"])
    for file in files:
        control.load(str(ENCODINGS / f"{file}.lp"))
    control.add("base", [], facts)
    control.ground()
    found = {}
    with control.solve(yield_=True) as models:
        for model in models:
            if optimal and not model.optimality_proven:
                continue
            atoms = model.symbols(atoms=True)
            steps = sorted([a.number for a in one.arguments] for one in atoms if one.name == "at")
            kinds = Counter(one.arguments[0].name for one in atoms if one.name == "exception")
            at = tuple((place, slot) for _, place, slot in steps)
            found[at] = tuple(kinds[kind] for kind in KINDS), tuple(model.cost)
            if len(found) > MOST:
                return None
    return found


def crescent():
    """A street with a crescent to the north of it, and a loop back to it in the east: the walk
    E N N S E W, as in the page."""
    pairs = [
        (("a", EAST), ("b", WEST)),
        (("a", NORTH), ("b", NORTH)),
        (("b", EAST), ("c", WEST)),
        (("b", SOUTH), ("d", NORTH)),
        (("c", EAST), ("d", EAST)),
    ]
    links = {one: other for pair in pairs for one, other in (pair, pair[::-1])}
    stars = {"a": {NORTH, EAST}, "b": {*range(4)}, "c": {EAST, WEST}, "d": {NORTH, EAST}}
    world = TopologicalMap(4, {place: frozenset(star) for place, star in stars.items()}, links, {})
    seen, _ = observe(world, ("a", EAST), [EAST, NORTH, NORTH, SOUTH, EAST, WEST])
    return seen.facts()


def test_the_real_map_is_preferred_though_it_has_exceptions():
    """semantics.md, "What is preferred": the oxbow has 5, in a closed map; the crescent 8."""
    facts = (CASES / "oxbow.lp").read_text()
    every = maps(facts, "topomap", "exceptions", "planar")
    assert sorted(sum(kinds) for kinds, _ in every.values()) == [0, 5]
    best = maps(facts, "topomap", "planar", "closed", "exceptions", "minimal", optimal=True)
    assert [*best.values()] == [((1, 0, 4), (5, 4, 6))]
    best = maps(facts, "topomap", "planar", "exceptions", "minimal", optimal=True)
    assert [*best.values()] == [((0, 0, 0), (0, 7, 7))]
    best = maps(crescent(), "topomap", "closed", "exceptions", "minimal", optimal=True)
    assert [*best.values()] == [((1, 0, 7), (8, 2, 4))]


@pytest.mark.slow
def test_the_path_axiom_can_be_taken_away():
    """semantics.md, "Without the path axiom"; a way that comes back to its own place."""
    snake = (ROOT / "instances/grid-3x3-snake.lp").read_text()
    for parts, many in {
        (): 129,
        ("planar",): 97,
        ("closed",): 6,
        ("closed", "planar"): 5,
        ("closed", "perpendicular"): 2,
        ("closed", "perpendicular", "planar"): 1,
    }.items():
        assert len(maps(snake, "topomap", "no_path_axiom", *parts)) == many
        if "perpendicular" not in parts:  # it rests on the axiom in the statement
            stated = (f"paper/{part}" for part in parts)
            assert len(maps(snake, "paper/topomap", "no_path_axiom", *stated)) == many
    loop = (CASES / "loop.lp").read_text()
    for form in ("", "paper/"):
        assert len(maps(loop, f"{form}topomap")) == 1
        assert len(maps(loop, f"{form}topomap", "no_path_axiom")) == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parts", "final", "closed"),
    [
        ((), 17_416, 0),
        (("planar",), 36, 0),
        (("no_path_axiom", "planar"), 162, 0),
        pytest.param(("no_path_axiom",), 424_639, 8_728, marks=pytest.mark.long),
    ],
)
def test_a_torus(parts, final, closed):
    """semantics.md, "Without the path axiom": with a compass, at most 9 places."""
    route = "0,0,0,1,0,0,0,1,0,0,0,1,0,1,1,1,0,1,1,1"
    seen = topomap.generate("torus", 3, 3, route=route, compass=True).experience
    asked = Query(frozenset(parts), 9)
    for query, number in (asked, final), (asked.having("closed"), closed):
        assert count(seen, query, grown=False)[0] == number


@pytest.mark.slow
@pytest.mark.parametrize("axiom", [True, False])
@pytest.mark.parametrize("seeds", [range(n, n + 15) for n in range(0, 60, 15)])
def test_all_ways_agree(axiom, seeds):
    """On exceptions and, without the path axiom, on which maps there are, and on each property."""
    for seed in seeds:
        draw = random.Random(f"exceptions {seed}")
        seen = random_experience(draw, draw.choice([4, 6, 7, 8]))
        facts, world = seen.facts(), plain(seen)
        taken = [] if axiom else ["no_path_axiom"]
        found = maps(facts, "topomap", "exceptions", *taken)
        if found is None:
            continue
        stated = maps(facts, "paper/topomap", "paper/minimal", "paper/beyond/exceptions", *taken)
        told = {at: kinds for at, (kinds, _) in found.items()}
        assert {at: kinds for at, (kinds, _) in stated.items()} == told
        assert {*brute_force.tree(world, axiom=axiom)[-1]} == told.keys()
        for at, kinds in told.items():
            whole = brute_force.Hypothesis(world, at)
            assert whole.exceptions() == kinds
            named = seen.map_of(at)
            many = Counter(one.kind.replace(" ", "_") for one in named.exceptions())
            assert tuple(many[kind] for kind in KINDS) == kinds
            assert len(named.paths()) == len(whole.paths())
            TRIED["maps with exceptions"] += any(kinds)
        node = Hypothesis(seen, path_axiom=axiom)
        searched = {}
        for _ in depth_first(node, Watch()):
            if node.steps == seen.steps:
                searched[node.dstates] = node.closed(), node.travelled(), node.square()
        assert searched.keys() == told.keys()
        for number, part in enumerate(("closed", "travelled", "perpendicular")):
            having = {at for at, has in searched.items() if has[number]}
            assert having == maps(facts, "topomap", part, *taken).keys()
            assert having == {
                at for at in told if getattr(brute_force.Hypothesis(world, at), part)()
            }
        consistent = maps(facts, "topomap", "boundary", *taken).keys()
        assert consistent == {at for at, kinds in told.items() if not any(kinds)}


PARTS = ("planar", "closed", "perpendicular", "travelled", "boundary")
WISHES = ("no_path_axiom", "exceptions", "minimal", "genus")


@pytest.mark.parametrize("seed", range(40))
def test_the_search_gives_what_clingo_gives(seed):
    """With any parts, and what is minimised costs as much."""
    draw = random.Random(f"parts {seed}")
    seen = random_experience(draw, draw.choice([4, 6, 7, 8]))
    asked = {part: True for part in (*PARTS, *WISHES) if draw.random() < 0.35}
    found = {
        by: {(one.at, one.cost) for one in topomap.solve(seen, by=by, **asked)}
        for by in ("clingo", "search", "auto")
    }
    assert found["clingo"] == found["search"] == found["auto"], asked


@pytest.mark.parametrize("seed", range(40))
def test_the_best_maps_are_those_that_are_preferred(seed):
    """Closed, then fewest exceptions, then fewest paths, then fewest places: of all maps by the
    oracle; and given the steps one by one, the follower has the same."""
    draw = random.Random(f"best {seed}")
    seen = random_experience(draw, draw.choice([4, 6, 7, 8, 9]))
    if seed == 0:
        seen = parse(crescent(), "crescent")
    every = Truth(seen).final

    def worth(one):
        return not one.closed(), *one.worth()

    first = min(map(worth, every.values()))
    best = {at for at, one in every.items() if worth(one) == first}
    for by in ("auto", "clingo", "search"):
        answer = topomap.solve(seen, optimal=True, by=by)
        assert {one.at for one in answer} == best
        assert (answer.kind, answer.cost) == ("best so far" if first[0] else "optimal", first[1:])
    follower = topomap.follow(seen.slots)
    for step, view in enumerate(seen.views):
        turn = seen.turns[step - 1] if step else None
        status = follower.step(sorted(view), turn, sorted(seen.landmarks[step]))
    assert {one.at for one in status.best} == best
    assert status.cost == first[1:]


def test_exceptions_are_named():
    """By the first step along each path, in words and as JSON."""
    oxbow = topomap.read(CASES / "oxbow.lp")
    (one,) = topomap.solve(oxbow, planar=True, optimal=True)
    assert [each.words for each in one.exceptions] == [
        "paths 2 and 6 meet twice, at places 1 and 3",
        "place 3 is left and right of path 1",
        "place 6 is left and right of path 2",
        "place 2 is left and right of path 6",
        "place 1 is left and right of path 4",
    ]
    assert one.exceptions[0].document() == {
        "kind": "meet twice",
        "paths": (2, 6),
        "places": (1, 3),
    }
