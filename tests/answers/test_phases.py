"""Large closed perpendicular maps in phases: the answers are those of the plain encoding and of
the search, and what each phase finds is true of every map."""

import json
import random
from dataclasses import replace
from itertools import combinations, combinations_with_replacement, pairwise

import clingo
import pytest
from conftest import ENCODINGS, TRIED, answers
from oracles import phase_answers as phased
from oracles.worlds import WORLDS, random_experience, random_world, with_marker
from topomap.documents.check import by_definition
from topomap.model.experience import Experience, observe
from topomap.model.query import Query
from topomap.model.topology import TopologicalMap
from topomap.runtime.watch import Stopped, Watch
from topomap.search import traversal
from topomap.solver import phases, plane, solving
from topomap.solver.programs import Program, forget
from topomap.worlds.environment import grid, maze, world
from topomap.worlds.instance import instance

QUIET = Watch()
SQUARE = ("closed", "perpendicular")
MORE = [
    (),
    ("planar",),
    ("planar", "boundary"),
    ("minimal",),
    ("boundary", "minimal", "planar"),
    ("genus",),
    ("euler",),
    ("planar", "travelled"),
    ("planar", "euler", "genus", "minimal"),
]


@pytest.fixture(autouse=True)
def always(monkeypatch):
    """Have short explorations done in phases too."""
    monkeypatch.setattr(phases, "LEAST", 0)
    monkeypatch.setattr(phases, "STRIDE", 3)


def crossing_streets(draw: random.Random) -> TopologicalMap:
    """Streets, some of which cross, but no three pairwise: where two cross there is a place, in
    the middle of a street or at its end. As a rule it has no plane drawing."""
    while True:
        number = draw.randint(2, 6)
        crossings: set[tuple[int, int]] = set()
        rate = draw.choice([0.7, 0.9, 1])
        for pair in draw.sample(sorted(combinations(range(number), 2)), number * (number - 1) // 2):
            near = [{a for other in crossings if b in other for a in other} for b in pair]
            if draw.random() < rate and not near[0] & near[1]:
                crossings.add(pair)
        turned = {place: draw.randint(0, 3) for place in crossings}
        full = draw.random() < 0.5  # all streets end at dead ends
        links = {}
        for street in range(number):
            places = [place for place in sorted(crossings) if street in place]
            lone = [(street, street, n) for n in range(draw.choice([0, 0, 1, 2]))]
            places = draw.sample([*places, *lone], len(places) + len(lone))
            if full:
                places = [(street, street, 3), *places, (street, street, 4)]
            ahead = draw.choice([0, 2])
            for here, there in pairwise(places):
                side = [(turned.get(p, 0) + p.index(street)) % 4 for p in (here, there)]
                out, back = (here, (side[0] + ahead) % 4), (there, (side[1] + ahead + 2) % 4)
                links |= {out: back, back: out}
        if links:
            return world(4, links)


def square_world(draw: random.Random) -> TopologicalMap:
    """A closed world which is as a rule perpendicular: a grid with ways missing, a maze, or
    streets; or any one; with signs or without."""
    rows, columns = draw.randint(2, 3), draw.randint(2, 4)
    kind = draw.choice(["grid", "maze", "streets", "streets", "any"])
    if kind == "grid":
        kept = [edge for edge in grid(rows, columns).map.edges() if draw.random() < 0.9]
        made = world(4, dict(kept) | {b: a for a, b in kept}) if kept else grid(2, 2).map
    elif kind == "maze":
        made = maze(rows, columns, draw.choice([0, 0.3, 1]), draw.randint(0, 10**6)).map
    elif kind == "streets":
        made = crossing_streets(draw)
    else:
        made = random_world(draw)
        while made.slots != 4:
            made = random_world(draw)
    marked = [place for place in made.stars if draw.random() < draw.choice([0, 0, 0.3])]
    signs = {place: frozenset(draw.choice("ab")) for place in marked}
    return TopologicalMap(4, made.stars, made.links, signs)


def toured(draw: random.Random, most: int, make=square_world) -> tuple[Experience, int | None]:
    """A walk on which, as a rule, all ways of a square world are taken, most of them but
    once, at times with a marker; and a horizon, as a rule none."""
    while True:
        made = make(draw)
        start = place, slot = draw.choice(sorted(made.links))
        route, taken = [], set()
        waste = draw.choice([0, 0.1, 0.3])
        while len(route) < most:
            left = [s for s in sorted(made.stars[place]) if (place, s) not in taken]
            straight = (slot + 2) % 4
            if left and draw.random() >= waste:
                slot = straight if straight in left and draw.random() < 0.7 else draw.choice(left)
            elif (way := way_to_new(made, place, taken)) is not None:
                slot = way if draw.random() >= waste else draw.choice(sorted(made.stars[place]))
            else:
                break
            route.append(slot)
            there = made.links[place, slot]
            taken |= {(place, slot), there}
            place, slot = there
        if len(route) < most:
            marker = with_marker(route) if len(route) % 3 == 2 else ()
            experience = observe(made, start, route, *marker)[0]
            cut = experience.steps + draw.randint(-3, 1)
            return experience, max(cut, 0) if draw.random() < 0.2 else None


def way_to_new(made: TopologicalMap, place, taken) -> int | None:
    """The slot by which the nearest place with a way not taken is reached."""
    first = {place: None}
    for here in (reached := [place]):
        for slot in sorted(made.stars[here]):
            if (here, slot) not in taken and first[here] is not None:
                return first[here]
            there = made.links[here, slot][0]
            if there not in first:
                first[there] = slot if first[here] is None else first[here]
                reached.append(there)
    return None


def found(way, experience, parts, phased=True, horizon=None, places=None):
    """The hypotheses of a query, in phases or in one call; of the least cost, if it minimises."""
    query = Query(frozenset(parts), places, horizon)
    assert not phased or phases.serve(experience, query)
    with pytest.MonkeyPatch.context() as patched:
        if not phased:
            forget()
            patched.setattr(phases, "serve", lambda *_: False)
        return listed(way, experience, query)


def listed(way, experience, query):
    answers = [each.at for each in way(experience, query, QUIET) if each.proved]
    assert len(answers) == len(set(answers))
    return set(answers)


def agree(experience, horizon=None, more=MORE, searched=True, places=None, common=SQUARE):
    """Demand the same answers of the phases, of a single call and of the search."""
    for parts in more:
        asked = experience, (*common, *parts)
        single = found(solving.hypotheses, *asked, False, horizon, places)
        forget()
        TRIED["queries in phases"] += 1
        TRIED["queries in phases that had an answer"] += bool(single)
        assert found(solving.hypotheses, *asked, True, horizon, places) == single, (
            experience.facts(),
            parts,
            horizon,
            places,
        )
        if searched:
            assert found(traversal.hypotheses, *asked, True, horizon, places) == single
    return single


def squared(draw, most):
    """The case, and how it is asked for: some of the parts, and as a rule no bound."""
    return (*toured(draw, most), draw.sample(MORE, 3), draw.choice([None] * 5 + [4, 6]))


@pytest.mark.slow
@pytest.mark.parametrize("block", range(3))
def test_random_worlds(block):
    """A third of the queries, and more, have an answer."""
    answered = TRIED["queries in phases that had an answer"]
    for number in range(6):
        experience, horizon, more, places = squared(random.Random(f"{block}/{number}"), 20)
        small = experience.steps < 12
        agree(experience, horizon, more, searched=small, places=places)
    assert TRIED["queries in phases that had an answer"] >= answered + 6


@pytest.mark.slow
def test_streets():
    for number in range(10):
        experience, _ = toured(random.Random(f"streets {number}"), 18, crossing_streets)
        agree(experience, None, MORE[:2], searched=False)


def test_what_is_asked_up_to_a_step_does_not_depend_on_later_ones():
    route = ["NESW".index(way) for way in "ESSENNESSWWWNEEENWWWS" + "NEEESWSENNWWWSSE"]
    experience = observe(grid(3, 4).map, ((0, 0), 1), route)[0]
    assert len(agree(experience, 21, MORE[:1], searched=False)) == 8
    assert len(agree(experience, None, MORE[:1], searched=False)) < 8


@pytest.mark.parametrize("tries", [1, 5, 20])
def test_a_question_that_is_given_up_tells_nothing(monkeypatch, tries):
    monkeypatch.setattr(phases, "TRY_HARD", tries)
    made = instance(grid(5, 5), "snake")
    _, known = claims(made.experience, ("beginnings",))
    judge = Map(made.experience, made.truth)
    certain = [f for f in known if f.name != "rare"]
    assert all(judge.accepts(f.name, *(a.number for a in f.arguments)) for f in certain)


BOUNDED = [(), ("planar",), ("perpendicular",), ("minimal",), ("boundary", "planar")]


def agree_on_bounds(number, most):
    """Closed maps with the least number of places, the next one, and one place less."""
    experience, horizon = toured(random.Random(f"bounds {number}"), most, random_world)
    maps = found(solving.hypotheses, experience, ("closed",), False, horizon)
    sizes = sorted({len({place for place, _ in at}) for at in maps})
    for places in {size - less for size in sizes[:2] for less in (0, 1)} or {3}:
        agree(experience, horizon, BOUNDED, False, places, ("closed",))


@pytest.mark.slow
@pytest.mark.parametrize("block", [0, pytest.param(1, marks=pytest.mark.long)])
def test_bounds(block):
    for number in range(5):
        agree_on_bounds(f"{block}/{number}", 14)


@pytest.mark.long
def test_many_bounds():
    for number in range(150):
        agree_on_bounds(f"long {number}", 20)


def test_what_is_rare_is_not_lost(monkeypatch):
    """Maps that lines.lp has not come to are found later."""
    by_lines(monkeypatch)
    snake = instance(grid(4, 4), "snake").experience
    settled = found(solving.hypotheses, snake, SQUARE)
    monkeypatch.setattr(phases, "TRY_HARD", 15)
    known = claims(snake, ("lines",))[1]
    assert {fact.name for fact in known} == {"rare"}
    assert any(is_rare(fact, at) for fact in known for at in settled)
    assert found(solving.hypotheses, snake, SQUARE) == settled
    assert len(settled) == 256


def is_rare(fact, at):
    """Whether a map has it."""
    old, step, slot = (argument.number for argument in fact.arguments)
    return at[step][0] == at[old][0] and (at[step][1] - at[old][1]) % 4 == slot


def by_lines(monkeypatch):
    """Have the counting argument never apply, so that lines.lp is asked."""
    visits = phases._Phases.visits
    monkeypatch.setattr(phases._Phases, "visits", lambda work: visits(work) and False)


@pytest.mark.slow
@pytest.mark.parametrize("tries", [2, phases.TRY_HARD])
def test_lines(monkeypatch, tries):
    """Settled or given up."""
    by_lines(monkeypatch)
    monkeypatch.setattr(phases, "TRY_HARD", tries)
    for number in range(8):
        experience, horizon = toured(random.Random(f"lines {number}"), 20)
        agree(experience, horizon, MORE[:2], searched=False)


def planar_lines(experience):
    """The maps that lines.lp has with the clauses of planarity, and without, all listed."""
    work = phases._Phases(experience.facts(), ENCODINGS, lambda _: None)
    work.visits()
    answers = []
    for clauses in (True, False):
        control = work._grounded("phases/lines", arguments=["0", "--project"])
        if clauses:
            control.register_propagator(plane.Planarity(4))
        with control.solve(yield_=True) as models:
            answers.append([frozenset(map(str, m.symbols(shown=True))) for m in models])
        assert len(answers[-1]) == len(set(answers[-1]))
    return [set(maps) for maps in answers]


def refuses_what_is_not_planar(draw, most):
    """How many maps, at most, were refused: all that are not planar, and no other."""
    experience, _ = toured(draw, most, draw.choice([square_world, crossing_streets]))
    left, every = planar_lines(experience)
    planar = found(solving.hypotheses, experience, (*SQUARE, "planar"), False)
    assert left == {shown for _, shown in phased.lines(experience, planar)}, experience.facts()
    return len(every - left)


@pytest.mark.slow
@pytest.mark.parametrize("often", [1, pytest.param(plane.EVERY, marks=pytest.mark.long)])
def test_planarity_by_clauses(monkeypatch, often):
    monkeypatch.setattr(plane, "EVERY", often)
    refused = [
        refuses_what_is_not_planar(random.Random(f"plane {number}"), 24) for number in range(60)
    ]
    assert sum(map(bool, refused)) >= 5


def test_planarity_by_clauses_on_the_paper():
    """Of 256 closed perpendicular maps of the 4x4 snake one is planar."""
    left, every = planar_lines(instance(grid(4, 4), "snake").experience)
    assert (len(left), len(every)) == (1, 256)


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_planarity_by_clauses_of_many(monkeypatch, block):
    monkeypatch.setattr(plane, "EVERY", 1 + block)
    for number in range(60):
        refuses_what_is_not_planar(random.Random(f"plane {block}/{number}"), 26)


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many_lines(monkeypatch, block):
    by_lines(monkeypatch)
    for number in range(40):
        draw = random.Random(f"many lines {block}/{number}")
        experience, horizon = toured(draw, 28, draw.choice([square_world, crossing_streets]))
        agree(experience, horizon, MORE[:2], searched=False)


@pytest.mark.long
@pytest.mark.parametrize("block", range(10))
def test_many_random_worlds(block):
    for number in range(100):
        experience, horizon, more, places = squared(random.Random(f"long {block}/{number}"), 32)
        agree(experience, horizon, more, searched=experience.steps < 14, places=places)


SQUARES = {name: world for name, world in WORLDS.items() if world.slots == 4}
TOLD = {
    "a square": observe(grid(2, 2).map, ((0, 0), 2), [1, 2, 3, 0, 1])[0],
    "a corridor, three times": observe(grid(1, 4).map, ((0, 1), 1), [3, 1, 1, 1, 3, 3, 3, 1, 1, 1])[
        0
    ],
    "a start that is not left by": observe(grid(2, 3).map, ((0, 1), 2), [1, 2, 3, 3, 0, 1, 2])[0],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", [*SQUARES, *TOLD])
def test_named_worlds(name):
    """At any horizon near the end. Those of ``TOLD`` have a closed perpendicular map."""
    experience = (SQUARES | TOLD)[name]
    for less in range(min(3, experience.steps + 1) if experience.steps < 12 else 1):
        answers = agree(experience, experience.steps - less, MORE[:2], experience.steps < 12)
        assert answers or less or name in SQUARES


@pytest.mark.long
@pytest.mark.parametrize("name", [*SQUARES, *TOLD])
def test_named_worlds_in_every_way(name):
    experience = (SQUARES | TOLD)[name]
    for horizon in range(experience.steps + 1):
        agree(experience, horizon)
    for places in range(1, experience.steps + 2):
        agree(experience, places=places, more=MORE[:2])


def claims(experience, names):
    """What these phases find, and those that all begin with."""
    work = phases._Phases(experience.facts(), ENCODINGS, lambda _: None)
    for name in ("visits", *names):
        getattr(work, name)(*[experience] * (name == "beginnings"))
    return work._pairs, work._found


class Map:
    """A map, for asking whether a claim is true of it."""

    def __init__(self, experience, at):
        self.at, made = at, experience.map_of(at)
        runs = [step for step, turn in enumerate(experience.turns, 1) if step == 1 or turn != 2]
        paths = [{(place, slot % 2) for place, slot in path} for path in made.paths()]
        of = {line: number for number, path in enumerate(paths) for line in path}
        self.path = {run: of[at[run][0], at[run][1] % 2] for run in runs}
        full = [place for place, star in made.stars.items() if len(star) == 4]
        self.crossing = {frozenset((of[place, 0], of[place, 1])) for place in full}

    def same(self, old, step, slot):
        (one, before), (other, after) = self.at[old], self.at[step]
        return one == other and (after - before) % 4 == slot

    def accepts(self, name, *numbers):
        """Whether what was found is true."""
        step = numbers[0]
        if name == "never":
            one, other, crossing = self.path[step], self.path[numbers[1]], numbers[2]
            return frozenset((one, other)) not in self.crossing if crossing else one != other
        if name == "apart":
            return not self.same(*numbers)
        if name == "out":
            return self.at[step] != tuple(numbers[1:])
        return (self.at[step][0] == step) == {"new": True, "old": False}[name]


CHAINS = [
    ("lines",),
    ("runs",),
    ("new",),
    ("beginnings",),
    ("runs", "new"),
    ("runs", "new", "beginnings"),
]


def are_true(experience, chain):
    """Demand that what these phases find is true of every map for which it is said."""
    parts = {*SQUARE, *(["planar"] if "beginnings" in chain else [])}
    maps = found(solving.hypotheses, experience, parts, False)
    pairs, known = claims(experience, chain)
    fits = {tuple(a.number for a in pair.arguments) for pair in pairs if pair.name == "comparable"}
    for at in maps:
        judge = Map(experience, at)
        for old, step in combinations_with_replacement(range(len(at)), 2):
            slots = [slot for slot in range(4) if judge.same(old, step, slot)]
            assert {(old, step, slot) for slot in slots} <= fits, experience.facts()
        for pair in pairs:
            if pair.name == "iff":
                numbers = [a.number for a in pair.arguments]
                there = judge.same(*numbers[3:])
                assert judge.same(*numbers[:3]) == there, (str(pair), experience.facts())
        for fact in known:
            TRIED[f"claims of the phases: {fact.name}"] += 1
            assert judge.accepts(fact.name, *(a.number for a in fact.arguments)), (
                str(fact),
                experience.facts(),
            )


@pytest.mark.slow
@pytest.mark.parametrize("chain", CHAINS, ids="-".join)
def test_what_a_phase_finds_is_true(chain):
    for number in range(6):
        are_true(toured(random.Random(f"claims {number}"), 20)[0], chain)
        are_true(toured(random.Random(f"many claims {number}"), 32)[0], chain)


@pytest.mark.long
@pytest.mark.parametrize("chain", CHAINS, ids="-".join)
def test_what_a_phase_finds_is_often_true(chain):
    for number in range(150):
        are_true(toured(random.Random(f"many claims {number}"), 32)[0], chain)


@pytest.mark.slow
def test_what_contradicts_itself_has_no_map():
    """Steps that go straight back and see something else: what the phases leave of that has the
    maps of the whole theory, most often none."""
    few = 0
    for seed in range(150):
        draw = random.Random(f"contradicts {seed}")
        seen = random_experience(draw, 10)
        if seen.slots != 4 or seen.steps < 2:
            continue
        back = draw.randrange(1, seen.steps)
        turns = [*seen.turns[:back], 0, *seen.turns[back + 1 :]]
        views = [{0, turn} | view for turn, view in zip(turns, seen.views, strict=False)]
        seen = Experience(4, [*views, seen.views[-1]], turns)
        work = phases._Phases(seen.facts(), ENCODINGS, lambda _: None)
        work.visits()
        control = clingo.Control(["0"])
        control.load(str(ENCODINGS / "phases/topomap.lp"))
        control.add("base", [], seen.facts() + work.facts())
        control.ground()
        maps = set()
        with control.solve(yield_=True) as models:
            for model in models:
                at = sorted([a.number for a in s.arguments] for s in model.symbols(shown=True))
                maps.add(tuple((place, slot) for _, place, slot in at))
        assert maps == answers((), seen.facts()), seen.facts()
        few += not maps
    assert few > 10


def test_each_phase_finds_something():
    """And all that is found of a snake is true of its real map."""
    made = instance(grid(5, 5), "snake")
    pairs, known = claims(made.experience, ("runs", "new", "beginnings", "lines"))
    judge = Map(made.experience, made.truth)
    assert all(judge.accepts(f.name, *(a.number for a in f.arguments)) for f in known)
    assert {fact.name for fact in known} == {"never", "new", "old", "out", "apart"}
    assert {fact.arguments[2].number for fact in known if fact.name == "never"} == {0, 1}
    assert {pair.name for pair in pairs} == {"comparable", "iff"}


@pytest.mark.slow
def test_the_snake_of_6x6():
    made = instance(grid(6, 6), "snake")
    assert found(solving.hypotheses, made.experience, (*SQUARE, "planar")) == {made.truth}


def test_the_snake_of_5x5_has_no_closed_map_of_fewer_places():
    """That is settled by the counting alone, and of the real map all is possible."""
    made = instance(grid(5, 5), "snake")
    for places in 24, 25:
        work = phases._Phases(made.experience.facts(), ENCODINGS, lambda _: None)
        work.visits()
        possible = {pair for pair in work._pairs if pair.name == "comparable"}
        work.bounded(places)
        judge = Map(made.experience, made.truth)
        numbers = [[a.number for a in fact.arguments] for fact in work._found]
        if places == 25:
            assert 0 < len(numbers) < len(possible)
            assert all(judge.accepts("out", *each) for each in numbers)
        else:
            assert len(numbers) == len(possible)


@pytest.mark.long
@pytest.mark.parametrize(("size", "places", "number"), [(5, 25, 1525), (6, 18, 212)])
def test_closed_planar_maps_of_fewest_places(size, places, number):
    """And each is sound by definition."""
    experience = instance(grid(size, size), "snake").experience
    fewer = found(solving.hypotheses, experience, ("closed", "planar"), places=places - 1)
    maps = found(solving.hypotheses, experience, ("closed", "planar"), places=places)
    assert (len(fewer), len(maps)) == (0, number)
    for at in maps:
        facts = [(step, *dstate) for step, dstate in enumerate(at)]
        assert not by_definition(experience, facts, ["planar", "closed", f"bound({places})"])


@pytest.mark.long
def test_the_snake_of_8x8(topomap, tmp_path):
    topomap("generate", "grid", "8", "8", "--route", "snake", "-o", tmp_path)
    file = tmp_path / "grid-8x8-snake.lp"
    done = topomap("solve", file, "--closed", "--perpendicular", "--planar", "--json")
    answer = json.loads(done.stdout)
    truth = instance(grid(8, 8), "snake").truth
    assert answer["complete"] is True
    assert [[tuple(dstate) for _, *dstate in each["at"]] for each in answer["maps"]] == [[*truth]]


@pytest.mark.slow
@pytest.mark.parametrize("late", [False, True])
def test_phases_end_when_they_are_stopped(monkeypatch, late):
    """Before a call of clingo or in its midst, at whichever call: the next is not begun."""
    small = instance(grid(4, 4), "snake").experience
    query, heed, asked, end = Query(frozenset(SQUARE)).having("planar"), Program._heed, [], 0

    def tell(program, _):
        if len(asked) == end:
            program.interrupt()

    def note(program, control):
        asked.append(control)
        for act in (heed, tell) if late else (tell, heed):
            act(program, control)

    monkeypatch.setattr(Program, "_heed", note)
    Program(small, query).solve(())
    calls = len(asked)
    for end in range(1, calls, max(1, calls // 8)):
        asked.clear()
        with pytest.raises(Stopped, match="interrupted"):
            Program(small, query).solve(())
        assert len(asked) == end + late


def test_phases_that_run_out_of_memory_say_so(monkeypatch):
    def full(*_):
        raise MemoryError

    monkeypatch.setattr(phases, "found", full)
    query = Query(frozenset(SQUARE))
    with pytest.raises(Stopped, match="out of memory"):
        list(solving.hypotheses(WORLDS["to and fro"], query, QUIET))
    with pytest.raises(Stopped, match="out of memory"):
        solving.count(WORLDS["to and fro"], query)


def test_there_are_no_phases_where_views_may_be_wrong():
    """All that they find rests on what is seen."""
    snake = instance(grid(5, 5), "snake").experience
    asked = Query(frozenset(["closed", "perpendicular"]))
    assert phases.serve(snake, asked)
    assert not phases.serve(snake, replace(asked, noise=1))


def test_phases_are_silent(topomap):
    """Clingo has nothing to say of the program of a phase, such as of a constant of no value."""
    asked = "solve", "instances/grid-4x4-snake.lp", "--closed", "--perpendicular", "--by"
    found = {by: topomap(*asked, by) for by in ("clingo", "search")}
    assert [one.stderr for one in found.values()] == ["", ""]
    assert {one.stdout.count("map ") for one in found.values()} == {256}
