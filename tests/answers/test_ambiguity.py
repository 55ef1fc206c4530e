"""How ambiguous walks are: counts against the slow search, further walks against all walks, and
what a learner of automata comes to."""

import itertools
import random
from dataclasses import replace

import pytest
from conftest import TRIED, Truth, plain
from oracles.brute_force import Hypothesis, tree
from oracles.worlds import random_world
from topomap.model.experience import Experience
from topomap.questions import ambiguity, peers, refuting
from topomap.questions.ambiguity import Walk
from topomap.questions.machine import Work
from topomap.questions.refuting import Lineage, difference, refute
from topomap.questions.robot import reached
from topomap.questions.standings import standing
from topomap.runtime.watch import Watch
from topomap.worlds import route
from topomap.worlds.environment import Environment, environment, grid, lattice, maze, world

MOST, LONG = 1000, 60.0
FURTHER = 3  # all further walks of so many steps are tried


def walk_of(made, steps, seed=0, start=None):
    """A random walk in a world."""
    made = made if isinstance(made, Environment) else Environment("test", (), made)
    start = start or min(made.map.links)
    slots = route.walk(made.map, start[0], seed)
    return Walk(made, start, [next(slots) for _ in range(steps)])


WALKS = [
    walk_of(grid(2, 2), 9),
    walk_of(grid(2, 3), 10, 2),
    walk_of(grid(3, 3), 12, 1),
    walk_of(maze(3, 3, 0.5, 1), 12),
    walk_of(lattice("hexagons", 1, 2), 12),
    walk_of(lattice("triangles", 2, 2), 9),
    walk_of(grid(2, 3, "torus"), 8),
    walk_of(grid(2, 3).signed(0.5, 0), 10, 3),
]


def random_walks(number, seed, most):
    """Random walks in random worlds."""
    draw = random.Random(seed)
    while number:
        made = random_world(draw)
        start = draw.choice(sorted(made.links))
        made = reached(made, start[0])
        number -= 1
        yield walk_of(made, draw.randint(0, most), draw.random(), start)


def counted(walk, kind, most=MOST):
    experience, _ = walk.seen(kind == "compass")
    return ambiguity.counted(experience, kind == "planar", most, LONG, Watch())


def levels_of(experience, kind):
    """The maps after each step, by the slow search."""
    levels = tree(plain(experience))
    if kind == "planar":
        return [[at for at in level if hypothesis(experience, at).genus() == 0] for level in levels]
    return levels


def hypothesis(experience, at):
    return Hypothesis(plain(experience), at)


def counts_are_right(walk, kind):
    experience, _ = walk.seen(kind == "compass")
    levels = levels_of(experience, kind)
    found = counted(walk, kind)
    whole = next((n for n, level in enumerate(levels) if len(level) > MOST), len(levels))
    # The planar ones are fewer than those that are looked through: so nothing is cut too soon.
    assert len(found.maps) == whole
    assert found.why == (None if whole == len(levels) else "maps")
    assert [*found.maps] == [len(level) for level in levels[:whole]]
    closed = [sum(hypothesis(experience, at).closed() for at in level) for level in levels[:whole]]
    assert [*found.closed] == closed
    return found


@pytest.mark.parametrize("kind", ambiguity.KNOWLEDGE)
@pytest.mark.parametrize("walk", WALKS, ids=lambda walk: walk.environment.name)
def test_the_maps_after_each_step_are_those_of_the_slow_search(walk, kind):
    found = counts_are_right(walk, kind)
    assert len(found.maps) > 8


@pytest.mark.parametrize(
    ("number", "seed"), [(40, 1), pytest.param(1000, 2, marks=pytest.mark.long)]
)
def test_the_maps_of_random_walks(number, seed):
    for walk in random_walks(number, seed, 8):
        for kind in ambiguity.KNOWLEDGE:
            counts_are_right(walk, kind)
            TRIED["walks of which the maps were counted step by step"] += 1


def test_known_counts():
    """The numbers of the paper's table, after its walks."""
    made = grid(3, 3)
    walk = Walk(made, ((0, 0), 1), route.snake(made))
    assert (counted(walk, "all").maps[-1], counted(walk, "planar").maps[-1]) == (88, 62)
    assert (counted(walk, "all").closed[-1], counted(walk, "planar").closed[-1]) == (4, 3)


def test_a_count_stops_where_maps_are_more_than_asked_for():
    walk = WALKS[2]
    whole = counted(walk, "all").maps
    most = whole[-1] - 1
    first = next(step for step, number in enumerate(whole) if number > most)
    found = counted(walk, "all", most)
    assert (found.maps, found.why, found.living) == (whole[:first], "maps", None)
    told = found.document()
    assert (told["stopped"], told["more_than"], told["one_since"]) == (first, most, None)
    assert counted(walk, "all", max(whole)).document()["stopped"] is None


def test_a_count_stops_when_its_time_is_over():
    made = grid(5, 5)
    walk = walk_of(made, 200)
    experience, _ = walk.seen(False)
    found = ambiguity.counted(experience, False, 10**6, 0.05, Watch())
    told = found.document()
    assert found.why == told["why"] == "timeout"
    assert told["more_than"] is None
    assert told["stopped"] == len(found.maps) < 200


def test_one_since():
    assert ambiguity.one_since([1, 1, 2, 1, 1]) == 3
    assert ambiguity.one_since([1, 1]) == 0
    assert ambiguity.one_since([1, 2]) is None
    assert ambiguity.one_since([0, 0, 1]) == 2


def extended(walk, turns):
    """The walk, and these turns after it."""
    links, (place, slot) = walk.environment.map.links, walk.start
    for out in walk.route:
        place, slot = links[place, out]
    more = []
    for turn in turns:
        more.append((slot + turn) % walk.environment.map.slots)
        place, slot = links[place, more[-1]]
    return Walk(walk.environment, walk.start, [*walk.route, *more])


def further(walk, length):
    """All further walks of that many steps, as turns."""
    made = walk.environment.map
    walks = [()]
    for _ in range(length):
        walks = [
            (*turns, turn)
            for turns in walks
            for turn in sorted(made.view(extended(walk, turns).stands(False).dstate))
        ]
    return walks


def left(walk, kind, turns):
    """Of which maps after a walk some live after it goes on, by the slow search."""
    experience, _ = extended(walk, turns).seen(kind == "compass")
    levels = levels_of(experience, kind)
    return {at[: len(walk.route) + 1] for at in levels[-1]}


def further_walk_is_right(walk, kind):
    """What is reported of the further walk, compared with all walks of a few steps."""
    experience, truth = walk.seen(kind == "compass")
    told = ambiguity.settled(walk, kind, counted(walk, kind), LONG, Watch())
    living = {*levels_of(experience, kind)[-1]}
    if kind == "closed":
        living = {at for at in living if hypothesis(experience, at).closed()}
    if told.living is not None:
        assert told.living == len(living)
    others = living - {truth}
    if truth not in living:
        assert told.kind == ("others" if living else "no map")
        return told
    assert told.others == len(others)
    if not others:
        assert told.kind == "one"
        return told
    if len(others) > ambiguity.MOST_LIVING:
        return told
    assert told.tried == len(others)
    survivors = {*others}
    for length in range(1, FURTHER + 1):
        for turns in further(walk, length):
            after = left(walk, kind, turns) & others
            survivors &= after
            if told.kind == "walk" and length < told.refuted.at_least:
                assert after
    # What no walk refutes is refuted by none of these, and what some walk does, by that.
    standings = {at: standing(experience, at) for at in others}
    real, work = walk.stands(kind == "compass"), Work(Watch(), 10**7)
    never = {at for at, one in standings.items() if refute(real, [one], work).never}
    assert never <= survivors
    assert told.refuted.never == len(never)
    for at in others - never:
        single = refute(real, [standings[at]], work)
        assert single.shortest
        assert at not in left(walk, kind, single.walk)
        if len(single.walk) > 1 and len(single.walk) <= FURTHER + 1:
            walks = further(walk, len(single.walk) - 1)
            assert all(at in left(walk, kind, turns) for turns in walks)
    assert told.kind == ("never" if never else "walk")
    if told.kind == "walk":
        assert len(told.refuted.walk) >= told.refuted.at_least
        assert not left(walk, kind, told.refuted.walk) & others
    return told


def quick(walk):
    """Whether the slow search is done with it soon, and with what comes next."""
    return len(levels_of(walk.seen(False)[0], "all")[-1]) < 30


@pytest.mark.parametrize(
    ("number", "seed"), [(80, 9), pytest.param(400, 4, marks=pytest.mark.long)]
)
def test_further_walks_against_all_walks(number, seed):
    kinds = set()
    for walk in random_walks(number, seed, 16):
        made = walk.environment.map
        if made.path_axiom_fault() or max(map(len, made.stars.values())) > 4 or not quick(walk):
            continue
        for kind in ambiguity.KINDS:
            kinds.add(further_walk_is_right(walk, kind).kind)
            TRIED["further walks held against all walks"] += 1
    assert kinds == {"one", "walk", "never", "others", "no map"}


def refuted_by(real, other, turns):
    """Whether a map predicts something else than a walk sees, step by step."""
    at, there = real.start, other.start
    for turn in turns:
        at, there = real.after(at, turn), other.after(there, turn)
        predicted = other.look(there)
        if predicted is not None and predicted != real.look(at):
            return True
    return False


def there_and_back(walk, draw, steps):
    """A further walk that often goes back."""
    turns = []
    for _ in range(steps):
        stands = extended(walk, turns).stands(False)
        view = sorted(stands.world.view(stands.dstate))
        turns.append(0 if turns and draw.random() < 0.4 else draw.choice(view))
    return tuple(turns)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "seed"), [(1200, 5), pytest.param(10_000, 6, marks=pytest.mark.long)]
)
def test_a_map_is_refuted_if_and_only_if_none_comes_of_it(number, seed):
    """Also where the walk goes through its pending gateways, and comes back."""
    draw = random.Random(seed)
    beyond = both = away = 0
    for walk in random_walks(number, seed, 9):
        if walk.environment.map.path_axiom_fault() or not quick(walk):
            continue
        for kind in ambiguity.KNOWLEDGE:
            experience, _ = walk.seen(kind == "compass")
            real = Lineage(walk.stands(kind == "compass"))
            turns = there_and_back(walk, draw, 8)
            lives = left(walk, kind, turns)
            for at in levels_of(experience, kind)[-1]:
                other = Lineage(standing(experience, at))
                refuted = refuted_by(real, other, turns)
                assert refuted == (at not in lives)
                states, state = [], other.start
                for turn in turns:
                    state = other.after(state, turn)
                    states.append(bool(state[1]))
                back = any(one and not two for one, two in itertools.pairwise(states))
                beyond += back
                both += back and refuted
                if not refuted and state[1]:
                    away += still_refutable(real, other, turns)
    assert beyond > 500
    assert both > 5
    assert away > 10


def still_refutable(real, other, turns):
    """Beyond a pending gateway a map is refuted by some walk if it was before; what it is."""
    at, there = real.start, other.start
    for turn in turns:
        at, there = real.after(at, turn), other.after(there, turn)
    work = Work(Watch(), 10**6)
    before = difference(real, real.start, other, other.start, work)
    after = difference(real, at, other, there, work)
    assert (before is None) == (after is None)
    if after is None:
        return False
    assert after[0] == there[1][-1]
    assert refuted_by(real, other, (*turns, *after))
    assert not refuted_by(real, other, (*turns, *after[:-1]))
    return True


def test_a_walk_is_reported_where_the_shortest_takes_too_long(monkeypatch):
    """It refutes all maps, one after the other, and no walk has fewer steps than is reported."""
    longer = 0
    for walk in [tour_of(lattice("hexagons", 2, 2)), *random_walks(120, 9, 16)]:
        made = walk.environment.map
        if made.path_axiom_fault() or len(counted(walk, "all").level) > 300:
            continue
        for kind in ("all", "closed"):
            told = ambiguity.settled(walk, kind, counted(walk, kind), LONG, Watch())
            if told.kind != "walk":
                continue
            experience, truth = walk.seen(False)
            level = counted(walk, "all").level
            others = [tuple(divmod(g, made.slots) for g in one.visit.gateways()) for one in level]
            others = [
                at
                for at in others
                if at != truth and (kind == "all" or hypothesis(experience, at).closed())
            ]
            real = Lineage(walk.stands(False))
            for most in (0, 10, 30, 100, 300, 1000):
                with monkeypatch.context() as patch:
                    patch.setattr(refuting, "MOST_WORK", most)
                    other = ambiguity.settled(walk, kind, counted(walk, kind), LONG, Watch())
                assert other.kind == "walk"
                assert other.refuted.at_least <= len(told.refuted.walk) <= len(other.refuted.walk)
                longer += not other.refuted.shortest
                for at in others:
                    lineage = Lineage(standing(experience, at))
                    assert refuted_by(real, lineage, other.refuted.walk)
    assert longer


def test_a_world_that_is_not_planar_is_not_a_planar_map():
    """Two places with three ways in one order at both: a torus is needed to draw them."""
    ways = {(0, slot): (1, slot) for slot in (0, 2, 4)}
    made = world(6, ways | {end: out for out, end in ways.items()})
    assert made.genus() == 1
    walk = walk_of(made, 9, 2)
    assert walk.whole()
    kinds = {
        kind: ambiguity.settled(walk, kind, counted(walk, kind, most), LONG, Watch()).kind
        for kind in ("all", "planar")
        for most in (1, MOST)
    }
    assert kinds == {"all": "never", "planar": "others"}


def tour_of(made):
    from topomap.worlds.tours import tour

    start = min(made.map.links)
    return Walk(made, start, tour(made.map, start[0]))


def test_a_further_walk_that_is_known():
    """After the tour of two hexagons by two, fourteen maps are closed, and five steps leave one."""
    walk = tour_of(lattice("hexagons", 2, 2))
    told = ambiguity.settled(walk, "closed", counted(walk, "all"), LONG, Watch())
    assert (told.kind, told.living, told.tried) == ("walk", 14, 13)
    assert told.refuted.shortest
    experience, truth = extended(walk, told.refuted.walk).seen(False)
    after = ambiguity.counted(experience, False, 10**5, LONG, Watch())
    before = {at.visit.gateways()[len(walk.route)] for at in after.level}
    assert before
    closed = [
        one for one in after.level if one.form.closed and max(one.form.number) <= len(walk.route)
    ]
    alive = {tuple(divmod(g, 6) for g in one.visit.gateways()) for one in closed}
    assert truth in alive
    begun = {at[: len(walk.route) + 1] for at in alive}
    was_closed = {
        tuple(divmod(g, 6) for g in one.visit.gateways())
        for one in counted(walk, "all").level
        if one.form.closed
    }
    assert begun & was_closed == {truth[: len(walk.route) + 1]}


def test_closed_maps_are_found_where_the_count_was_cut(monkeypatch):
    walk = tour_of(lattice("hexagons", 2, 2))
    cut = counted(walk, "all", 5)
    assert cut.why == "maps"
    cut = replace(cut, most=MOST)
    told = ambiguity.settled(walk, "closed", cut, LONG, Watch())
    assert (told.kind, told.living, told.tried) == ("walk", 14, 13)
    monkeypatch.setattr(ambiguity, "MOST_LIVING", 6)
    told = ambiguity.settled(walk, "closed", cut, LONG, Watch())
    assert (told.met, told.living, told.others) == (14, 14, 13)
    assert told.tried in (5, 6)
    assert told.document()["shortest"] is False
    told = ambiguity.settled(walk, "closed", replace(cut, most=8), LONG, Watch())
    assert (told.met, told.living, told.others) == (9, None, None)


def test_no_walk_leaves_one_map_of_a_world_with_a_cycle():
    """By the map in which each new way came to a new place."""
    for made in (grid(2, 2), lattice("hexagons", 1, 1), grid(2, 3)):
        walk = tour_of(made)
        for kind in ambiguity.KNOWLEDGE:
            experience, truth = walk.seen(kind == "compass")
            tree_like = ambiguity.unfolding(experience)
            assert tree_like != truth
            assert tree_like in levels_of(experience, kind)[-1]
            told = ambiguity.settled(walk, kind, counted(walk, kind), LONG, Watch())
            assert told.kind == "never"
            # Where maps are more than are counted, it is the one that is known.
            few = ambiguity.settled(walk, kind, counted(walk, kind, 1), LONG, Watch())
            assert (few.kind, few.living, few.tried) == ("never", None, 1)


def test_a_tree_is_all_that_is_left():
    made = maze(3, 3, 0.5, 1)
    walk = tour_of(made)
    experience, truth = walk.seen(False)
    assert ambiguity.unfolding(experience) == truth
    for kind in ambiguity.KINDS:
        told = ambiguity.settled(walk, kind, counted(walk, kind), LONG, Watch())
        assert (told.kind, told.living) == ("one", 1)


def test_a_world_that_breaks_the_path_axiom_is_not_one_of_its_maps():
    walk = tour_of(grid(3, 3, "torus"))
    told = ambiguity.settled(walk, "all", counted(walk, "all", 1), LONG, Watch())
    assert told.kind == "others"
    best = ambiguity.preferred(WALKS[6], "all", LONG, Watch())
    assert (best.truth, best.true_cost) == (False, None)


@pytest.mark.parametrize("knowledge", ambiguity.KNOWLEDGE)
@pytest.mark.parametrize("walk", WALKS[:6], ids=lambda walk: walk.environment.name)
def test_what_is_preferred(walk, knowledge):
    experience, truth = walk.seen(knowledge == "compass")
    oracle = Truth(experience)
    if knowledge == "planar":
        planar = oracle.having("planar")
        oracle.final = {at: one for at, one in oracle.final.items() if at in planar}
    best = oracle.best(True) or oracle.best(False)
    told = ambiguity.preferred(walk, knowledge, LONG, Watch())
    assert told.kind == ("optimal" if oracle.best(True) else "best so far")
    assert (told.maps, told.more) == (len(best), False)
    assert told.truth == (truth in best)
    worth = {one: Hypothesis(plain(experience), one).worth() for one in (truth, *best)}
    assert {told.cost} == {worth[one] for one in best}
    assert told.true_cost == worth[truth]


def test_a_random_walk_ends_when_it_has_gone_every_way():
    made = grid(2, 3).map
    taken = ambiguity.until_all(made, (0, 0), 0, 1000)
    walk = Walk(Environment("test", (), made), ((0, 0), 1), taken)
    assert walk.whole()
    assert not Walk(walk.environment, walk.start, taken[:-1]).whole()
    assert ambiguity.until_all(made, (0, 0), 0, 5) == taken[:5]


def test_what_ends_the_whole_work_ends_it_in_a_part_too():
    from topomap.runtime.watch import Stopped

    watch = Watch()
    with ambiguity.within(watch, 0.0) as attempt:
        while True:
            watch.tick()
    assert attempt.fault == "timeout"
    watch.ended = "interrupted"
    with pytest.raises(Stopped, match="interrupted"), ambiguity.within(watch, LONG):
        watch.tick()


def test_only_simple_experiences_are_stepped():
    """A step has all that an experience of a walk tells."""
    for walk in WALKS:
        for compass in (False, True):
            experience, _ = walk.seen(compass)
            steps = [*ambiguity.steps_of(experience)]
            assert [step.view for step in steps] == [*experience.views]
            assert [step.turn for step in steps[1:]] == [*experience.turns]
            assert [step.landmarks for step in steps] == [*experience.landmarks]
            assert [step.compass for step in steps] == (
                [*experience.compass] if compass else [None] * len(steps)
            )
            assert isinstance(experience, Experience)


def learned(made, compass, seed=0):
    pytest.importorskip("aalpy")
    return peers.learned(made.map, min(made.map.links), compass, seed, LONG, Watch())


@pytest.mark.parametrize(("side", "states"), [(3, 24), (4, 48)])
def test_a_learner_ends_at_a_quarter_of_a_square_grid(side, states):
    """Its dstates form groups of four within which no walk distinguishes any; a compass does."""
    for seed in range(3):
        turns, compass = (learned(grid(side, side), how, seed) for how in (False, True))
        assert (turns.dstates, turns.least, turns.states) == (states, states // 4, states // 4)
        assert (compass.least, compass.states) == (states, states)
        assert turns.right
        assert compass.right
        assert 0 < turns.moves < turns.inputs


def test_a_learner_is_ended_by_its_limits(monkeypatch):
    monkeypatch.setattr(peers, "MOST_INPUTS", 50)
    told = learned(grid(3, 3), True)
    assert (told.inputs, told.states, told.right, told.why) == (50, None, None, "inputs")
    monkeypatch.undo()
    pytest.importorskip("aalpy")
    made = environment("grid", 6, 6)
    told = peers.learned(made.map, ((0, 0), 1), True, 0, 0.001, Watch())
    assert (told.states, told.why) == (None, "timeout")


def test_a_learner_does_not_begin_where_all_looks_alike():
    told = learned(grid(1, 2), False)
    assert (told.least, told.states, told.right, told.why) == (1, None, None, "all alike")
    assert told.tests == peers.TESTED
    assert told.inputs == peers.TESTED + 4  # each turn once


def test_a_learner_that_sees_no_difference_in_time(monkeypatch):
    """Where there is one, but far away."""
    monkeypatch.setattr(peers, "TESTED", 1)
    told = learned(grid(1, 9), True)
    assert told.least > 1
    assert (told.states, told.why) == (None, "all alike")


class State:
    """A state of an automaton, as AALpy has it."""

    def __init__(self, view, turns):
        self.output_fun = {turn: view if turn in turns else peers.BLOCKED for turn in range(4)}
        self.transitions = dict.fromkeys(range(4), self)


def test_a_wrong_automaton_is_reported():
    """In a ring of four places all dstates look the same, and one state predicts them all."""
    ring = grid(2, 2).map
    looks = dict.fromkeys(ring.gateways(), "a corner")
    right = State("a corner", (0, 1, 3))

    class Automaton:
        current_state = right

    start = min(ring.links)
    assert not peers._right(ring, looks, start, Automaton)
    # There is one gateway besides the one stood at, on the one side or on the other.
    one, other = State("a corner", (0, 1)), State("a corner", (0, 3))
    one.transitions |= {0: other, 1: one}
    other.transitions |= {0: one, 3: other}
    verdicts = set()
    for Automaton.current_state in (one, other):
        verdicts.add(peers._right(ring, looks, start, Automaton))
    assert verdicts == {False, True}


def test_a_learner_leaves_random_numbers_as_they_were():
    random.seed(1)
    expected = random.random()
    random.seed(1)
    learned(grid(2, 2), True)
    assert random.random() == expected
