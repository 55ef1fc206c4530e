"""The search that looks ahead: what it leaves out is in no answer, and it leaves out much; what it
knows of a map to come, and how large it says that its tree is."""

import random
from collections import Counter
from copy import copy
from itertools import combinations

import pytest
from conftest import TRIED
from oracles.worlds import random_experience
from topomap.model.experience import Experience
from topomap.model.found import OPTIMAL
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search import descent, traversal
from topomap.search import future as of_steps
from topomap.search.descent import Descent, TooLarge, holds
from topomap.search.future import Future
from topomap.search.hypothesis import Hypothesis
from topomap.search.lookahead import LookAhead
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance
from topomap.worlds.senses import Senses

QUERIES = (
    *([], ["planar"], ["closed"], ["boundary"], ["perpendicular"], ["euler", "closed"]),
    *(["closed", "planar"], ["closed", "planar", "perpendicular"], ["closed", "boundary"]),
    ["travelled", "planar"],
)


def tour(rows: int, columns: int, signs: float = 0, **options) -> Experience:
    """The tour of a grid."""
    return instance(grid(rows, columns), "tour", signs=signs, **options).experience


def plain(experience, query):
    """The maps of a query, in order, by the paper's tree as it is; and how many nodes that has."""
    nodes, maps = 0, []
    for node in traversal.depth_first(traversal.root(experience, query)):
        nodes += 1
        if node.steps == experience.steps and holds(node, query.parts):
            maps.append((node.dstates, node.cost))
    return nodes, maps


@pytest.fixture
def few_pairs(monkeypatch):
    """As of a long exploration, pairs of visits are looked at of the beginning only."""
    monkeypatch.setattr(of_steps, "MOST_PAIRS", 8)
    of_steps.future_of.cache_clear()
    yield
    of_steps.future_of.cache_clear()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_of_a_beginning_alone_nothing_more_is_left_out(seed, few_pairs):
    """The same as the next one, where only the pairs of a beginning are looked at."""
    test_what_is_left_out_is_in_no_answer(f"few {seed}")


def test_long_walks_have_the_maps_of_the_plain_tree(few_pairs):
    """Walks of 300 steps through small worlds; most of these steps are over known links."""
    maps = 0
    for seed, signs, compass in ((0, 0, False), (1, 0, True), (2, 0.3, False), (3, 0.3, True)):
        for rows, parts in ((2, []), (2, ["closed"]), (3, ["planar"]), (3, ["perpendicular"])):
            world = grid(rows, 3)
            walk = instance(
                world, "walk", steps=300, seed=seed, signs=signs, senses=Senses(compass=compass)
            )
            query = Query(frozenset(parts), 3 * rows)
            nodes, expected = plain(walk.experience, query)
            search = Descent(walk.experience, query)
            found = [one.at for one in search.found()]
            assert found == [at for at, _ in expected]
            assert walk.truth in found or "closed" in parts
            assert search.nodes < nodes
            maps += len(found)
    assert maps > 16


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_what_is_left_out_is_in_no_answer(seed):
    """The same maps in the same order as the tree has that is not cut, on random worlds."""
    whole = cut = maps = 0
    for number in range(150):
        draw = random.Random(f"look ahead {seed} {number}")
        experience = random_experience(draw, 11, marker=draw.random() < 0.2)
        for parts in QUERIES:
            query = Query(frozenset(parts), draw.choice([None, None, 3, 5]))
            nodes, expected = plain(experience, query)
            search = Descent(experience, query)
            found = [one.at for one in search.found(Watch())]
            assert found == [at for at, _ in expected], (experience.facts(), query)
            assert search.nodes < nodes
            assert search.maps == len(found)
            assert search.nodes == 0 or search.passed == pytest.approx(1)
            whole, cut, maps = whole + nodes, cut + search.nodes, maps + len(found)
    TRIED["maps found by the search that looks ahead and by the plain one"] += maps
    assert maps > 1_000
    assert cut < 0.7 * whole


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_the_best_maps_are_those_of_the_plain_tree(seed, large, monkeypatch):
    """And no map below a node costs less than the node says, at each node on the way to a map.
    From its fourth node on, the search looks for good maps elsewhere: greedily, or, as if its tree
    were too large to be searched, for maps of few places."""
    monkeypatch.setattr(descent, "OFTEN", 4)
    monkeypatch.setattr(descent, "GREEDY_AFTER", 4)
    monkeypatch.setattr(descent, "MANY_PAIRS", -1 if large else 5_000)
    monkeypatch.setattr(descent, "DEEPEN_LONG", 20)
    elsewhere = Counter()

    def counted(name):
        method = getattr(Descent, name)

        def made(self, *arguments):
            elsewhere[name, "begun"] += 1
            for found in method(self, *arguments):
                elsewhere[name, "found"] += 1
                assert not found.proved
                yield found

        monkeypatch.setattr(Descent, name, made)

    for name in ("_greedily", "_deepen", "_open_ones"):
        counted(name)
    checked = 0
    for number in range(120):
        draw = random.Random(f"best {seed} {number}")
        experience = random_experience(draw, 11)
        for parts in (["minimal"], ["minimal", "planar"], ["minimal", "closed"]):
            query = Query(frozenset(parts))
            _, maps = plain(experience, query)
            least = min((cost for _, cost in maps), default=None)
            # Open maps are given only where the best so far are wanted if none is closed.
            kind = OPTIMAL if "closed" in parts else None
            found = [one for one in Descent(experience, query, kind).found(Watch()) if one.proved]
            assert {one.at for one in found} == {at for at, cost in maps if cost == least}
            assert len({one.at for one in found}) == len(found)
            assert {one.cost for one in found} <= {least}
            for at, cost in maps[:50]:
                node = LookAhead(experience, query)
                for step in range(1, len(at)):
                    assert node.least() <= cost
                    node.goto(at[: step + 1])
                    checked += 1
                assert node.least() == node.cost == cost
    assert checked > 3_000
    used = "_deepen" if large else "_greedily"
    assert min(elsewhere[used, what] for what in ("begun", "found")) > 100
    assert min(elsewhere["_open_ones", what] for what in ("begun", "found")) > 3


def test_undoing_leaves_what_was_before():
    """All that is kept of a node, after each way down from it."""
    for number in range(40):
        experience = random_experience(random.Random(f"undo {number}"), 9)
        node = LookAhead(experience, Query(frozenset(["closed", "planar", "minimal"])))
        known = _state(node)
        for at, _ in plain(experience, Query(frozenset(["planar"])))[1]:
            node.goto(at)
            node.goto(((0, 0),))
            assert _state(node) == known
            _run_along(node, [place * node.slots + slot for place, slot in at])
            assert _state(node) == known


def _run_along(node, at):
    """Go to a map by runs over known links, as far as its beginning allows a closed one, and back
    by undoing as many decisions."""
    decisions, alive = 0, True
    while alive and node.steps < len(at) - 1:
        node.enter(at[node.steps + 1])
        alive = node.run()
        decisions += 1
        assert node.at == at[: node.steps + 1]
    for _ in range(decisions):
        node.undo()


def _state(node):
    names = ("at", "links", "faces", "paths", "meets", "possible_at", "linked_by", "pending")
    numbers = ("steps", "path_ends", "in_time", "places", "matches", "places_of", "least_places")
    state = {name: getattr(node, name) for name in (*names, *numbers)}
    return {name: copy(value) for name, value in state.items()}


def futures(name):
    """Random experiences, the root of the tree of each, and what is known of its steps to come."""
    for number in range(150):
        experience = random_experience(random.Random(f"{name} {number}"), 9)
        node = Hypothesis(experience)
        yield experience, node, Future(experience, node.views)


def test_visits_that_are_of_one_place_in_some_map_are_a_pair():
    """Many pairs of visits that look alike are ruled out; each of these is in no map."""
    ruled_out = 0
    for experience, node, future in futures("pairs"):
        alike = {
            (one, other, gateway % node.slots)
            for one, other in combinations(range(experience.steps + 1), 2)
            for gateway in node.stars[one]
            if node.views[gateway] == node.views[other * node.slots]
        }
        met = set()
        for at, _ in plain(experience, Query())[1]:
            for (one, (place, slot)), (other, (there, at_slot)) in combinations(enumerate(at), 2):
                if place == there:
                    met.add((one, other, (at_slot - slot) % node.slots))
        possible = {
            (one, other, slot)
            for one, other, slot in alike
            if future.possible_visits(one, 0) >> (other * node.slots + slot) & 1
        }
        assert met <= possible <= alike
        assert len(possible) == future.pairs
        ruled_out += len(alike - possible)
    assert ruled_out > 500


def test_steps_that_go_back_link_nothing():
    """And they are no ends by which a pending gateway could be linked."""
    back = 0
    for experience, node, future in futures("back"):
        known = {step for of in future.ends for step in of}
        retraced = set(range(1, experience.steps + 1)) - known
        back += len(retraced)
        for at, _ in plain(experience, Query())[1]:
            node.goto(((0, 0),))
            for step in range(1, len(at)):
                node.goto(at[: step + 1])
                assert not (node.grown and step in retraced)
    assert back > 100


def test_ends_of_steps_are_counted_by_kind():
    """Out and back along a corridor: 0 -> 1 -> 2 and back again, where both ends are dead ends.
    The steps back link nothing; so the gateway ahead at place 1 can be linked by step 2 only."""
    corridor = Experience(2, [[0], [0, 1], [0], [0, 1], [0]], [0, 1, 0, 1])
    node = Hypothesis(corridor)
    future = Future(corridor, node.views)
    dead_end, middle = node.views[0], node.views[2]
    assert (future.out[1:], future.arrival) == (
        [dead_end, middle, dead_end, middle],
        [dead_end, middle, dead_end, middle, dead_end],
    )
    assert future.ends[middle] == [2, 1]
    assert [future.last(middle, many) for many in (1, 2, 3)] == [1, 0, -1]
    # A face with one such gateway is entered by step 2. With two of them it would have to be
    # entered by step 1, which leaves by a dead end: it can be if the face has a dead end, too.
    assert future.last_of_face((3,)) == 1
    assert future.last_of_face((3, 2)) == -1
    assert future.last_of_face((3, 2, 0)) == 0


def test_a_search_tells_how_large_its_tree_is():
    """More than two thirds of the estimates that are made after the first fifth of the tree are
    within a factor of three of its real size."""
    near = told = 0
    for signs in (0, 0.1, 0.2, 0.3):
        estimates = []
        experience = tour(4, 5, signs)
        query = Query(frozenset(["closed", "planar"]))
        search = Descent(
            experience, query, heed=lambda one, known=estimates: known.append((one.nodes, one.size))
        )
        assert list(search.found())
        for nodes, size in estimates:
            if nodes > search.nodes / 5:
                told += 1
                near += search.nodes / 3 < size < 3 * search.nodes
    assert told >= 3
    assert near > 2 * told / 3


def test_many_slots_take_little_memory():
    """Of 50,000 slots four are seen: no set of visits has a bit for each slot."""
    far = Experience(50_000, [[0, 7], [0, 9], [0, 7], [0, 9]], [0, 9, 7])
    assert Future(far, Hypothesis(far).views).possible_visits(1, 0) == -1
    found = [one.at for one in Descent(far, Query(frozenset(["closed"]))).found()]
    assert found == [at for at, _ in plain(far, Query(frozenset(["closed"])))[1]]


def test_a_search_ends_when_it_is_stopped():
    def heed(search):
        if search.nodes >= 1_000:
            raise TooLarge

    search = Descent(tour(5, 5), Query(frozenset(["closed", "planar"])), heed=heed)
    with pytest.raises(TooLarge):
        list(search.found())
    assert 1_000 <= search.nodes < 1_100


def test_a_walk_of_240_steps_gives_the_true_map_soon():
    """The map of the 4x4 grid, which is optimal, in a few thousand nodes."""
    walk = instance(grid(4, 4), "walk", steps=240, seed=1)
    parts = frozenset(["closed", "boundary", "planar", "perpendicular", "minimal"])
    search = Descent(walk.experience, Query(parts))
    assert [one.at for one in search.found() if one.proved] == [walk.truth]
    assert search.nodes < 5_000
