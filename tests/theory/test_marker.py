"""The portable marker: it is seen exactly where it lies, so that maps come apart which are alike
in all else."""

import json
from dataclasses import replace

import pytest
from conftest import ROOT, answers
from topomap.documents.check import by_definition, by_rules
from topomap.model.experience import Experience, observe
from topomap.model.facts import parse, read
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import solving
from topomap.solver.programs import FORMS
from topomap.worlds.environment import EAST, grid
from topomap.worlds.route import snake

QUIET = Watch()
# Turns after the snake, and how many places the false one of two maps has that look alike: the
# paper's Figure 1 c, which is as large as the grid, and Figure 5 d.
PAIRS = [(3, [0, 1, 1, 1], 9), (4, [0, 1, 2, 3, 2, 3, 2], 12)]
NONE = frozenset()


def continued(size: int, turns: list[int], drops=(), picks=()):
    """The snake of a square grid and some more turns; and the real map, as at/3 has it."""
    made = grid(size, size)
    route = snake(made)
    place, slot = (0, 0), EAST
    for leaves in route:
        place, slot = made.map.links[place, leaves]
    for turn in turns:
        route.append((slot + turn) % 4)
        place, slot = made.map.links[place, route[-1]]
    return observe(made.map, ((0, 0), EAST), route, drops, picks)


def fates(experience: Experience, at) -> list[str | None]:
    """What becomes of a closed map from its last step on: after each step None, or the rule
    that refuses it."""
    node = traversal.root(experience, Query())
    node.goto(at)
    found: list[str | None] = []
    while node.steps < experience.steps:
        ((arrival, rule),) = node.tried()  # each link is known
        found.append(rule)
        if rule:
            break
        node.enter(arrival)
    return found


@pytest.mark.parametrize(("size", "turns", "places"), PAIRS)
def test_two_maps_that_look_alike_come_apart(size, turns, places):
    bare, truth = continued(size, turns)
    last = bare.steps - len(turns)
    marked, _ = continued(size, turns, drops=[last])
    assert (marked.drops, marked.picks) == ({last}, NONE)
    snake_alone = read(ROOT / f"instances/grid-{size}x{size}-snake.lp")
    assert bare.cut(last) == snake_alone
    best = [f.at for f in solving.best(snake_alone, Query(places=16), QUIET) if f.proved]
    real = snake_alone.map_of(truth[: last + 1])
    others = [at for at in best if not snake_alone.map_of(at).isomorphic(real)]
    # Another walk tells the other of 12 places (Figure 5 c) from the real map.
    alike = [
        at for at in others if None in fates(bare, at)[-1:] and len(fates(bare, at)) == len(turns)
    ]
    assert {len({place for place, _ in at}) for at in alike} == {places}
    assert all("marker" in fates(marked, at) for at in alike)
    assert fates(bare, truth[: last + 1]) == [None] * len(turns)
    assert fates(marked, truth[: last + 1]) == [None] * len(turns)


@pytest.mark.parametrize("form", FORMS)
def test_of_the_3x3_grid_one_optimal_map_is_left(form):
    size, turns, _ = PAIRS[0]
    bare, truth = continued(size, turns)
    marked, _ = continued(size, turns, drops=[bare.steps - len(turns)])
    parts = ("closed", "boundary", "minimal")
    assert len(answers(parts, bare.facts(), encoding=form)) == 2
    assert answers(parts, marked.facts(), encoding=form) == {truth}


MOVES = [  # put down, taken up after these steps; and what then is: put down, taken up, seen
    ([0], [], [0], [], [4]),
    ([0], [4], [0], [4], [4]),
    ([0, 4], [4], [0, 4], [4], [4]),
    ([0, 2], [3], [0], [], [4]),
    ([1, 2], [1], [1], [], []),
    ([], [2], [], [], []),
    ([0], [0], [0], [], [4]),
]


@pytest.mark.parametrize(("drops", "picks", "put", "taken", "seen"), MOVES)
def test_what_an_exploration_sees_of_it(drops, picks, put, taken, seen):
    made = grid(2, 2).map
    experience, truth = observe(made, ((0, 0), EAST), [1, 2, 3, 0], drops, picks)
    assert (experience.drops, experience.picks, experience.markers) == (
        set(put),
        set(taken),
        set(seen),
    )
    assert parse(experience.facts(), "made") == experience
    at = [(step, *dstate) for step, dstate in enumerate(truth)]
    assert by_rules(experience, at) == by_definition(experience, at) == set()
    for horizon in range(experience.steps + 1):
        cut = experience.cut(horizon)
        assert parse(cut.facts(), "made") == cut
        assert cut.marker() == experience.marker()[: horizon + 1]


def test_what_may_be_left_out_says_nothing():
    """That it is seen where it is taken up, or where it was just put down."""
    made = grid(2, 2).map
    experience, _ = observe(made, ((0, 0), EAST), [1, 2, 3, 0, 1], [0, 4], [4])
    for markers in ({4}, {0, 4}, {0}, set()):
        same = parse(replace(experience, markers=frozenset(markers)).facts(), "made")
        for form in FORMS:
            assert answers((), same.facts(), encoding=form) == answers((), experience.facts())


def test_it_is_not_a_landmark():
    """Two visits of one place may differ in it, and the map knows nothing of it."""
    made = grid(2, 2).map
    experience, truth = observe(made, ((0, 0), EAST), [1, 2, 3, 0, 1, 2, 3, 0], [0], [4])
    assert truth in answers((), experience.facts())
    assert (experience.picks, experience.markers) == ({4}, {4})
    assert truth[4] == truth[8]
    bare = replace(experience, drops=NONE, picks=NONE, markers=NONE)
    assert experience.map_of(truth) == bare.map_of(truth)


@pytest.fixture
def instance(tmp_path):
    size, turns, _ = PAIRS[0]
    marked, _ = continued(size, turns, drops=[0, 16], picks=[4, 8, 16])
    file = tmp_path / "marked.lp"
    file.write_text(marked.facts())
    assert (marked.drops, marked.picks, marked.markers) == ({0, 16}, {16}, {16, 20})
    return file


@pytest.mark.slow
def test_the_commands_tell_of_it(topomap, instance, tmp_path):
    shown = topomap("show", instance).stdout
    assert "the marker: put down at place 0 after step 0; taken up, put down at place 0" in shown
    made = grid(2, 2).map
    small, page = tmp_path / "small.lp", tmp_path / "page.html"
    small.write_text(observe(made, ((0, 0), EAST), [1, 2, 3, 0, 1], [0, 4], [4])[0].facts())
    assert topomap("report", small, "-o", page).returncode == 0
    text = page.read_text()
    assert '<th scope="col">Marker</th>' in text
    assert "<td>taken up, put down</td>" in text
    assert "; the marker put down;" in text
    assert "the marker is seen elsewhere, or lies there and is not seen" in text


def test_maps_that_clash_with_it_are_not_sound(topomap, instance, tmp_path):
    bare = tmp_path / "bare.lp"
    experience = read(instance)
    bare.write_text(replace(experience, drops=NONE, picks=NONE, markers=NONE).facts())
    file = tmp_path / "maps.json"
    assert topomap("solve", bare, "--optimal", "--json", "-o", file).returncode == 0
    done = topomap("check", instance, file, "--json")
    assert done.returncode == 1
    (unsound,) = json.loads(done.stdout)["unsound"]
    assert {rule for rule, _ in unsound["violations"]} == {"marker"}


@pytest.mark.parametrize(
    ("facts", "fault"),
    [
        ("drop(1). drop(2).", "step 2: the marker is put down, but lies somewhere already"),
        ("pick(1).", "step 1: the marker is taken up, but lies nowhere"),
        ("drop(0). pick(1). marker(2).", "step 2: the marker is seen, but lies nowhere"),
        ("drop(3).", "step 3: it has no turn (the last one is 2)"),
        ("marker(-1).", "step -1: steps are numbered from 0"),
        ("pick(a).", "1: pick(a): a step is a whole number"),
        (
            "drop(0,1,2).",
            ":1: drop(0,1,2): drop has 1 argument, drop(T), or 2 with a name, drop(T,M)",
        ),
        ("drop(1,a). drop(2,a).", "step 2: the marker a is put down, but lies somewhere already"),
        ("drop(0,a). pick(1,b).", "step 1: the marker b is taken up, but lies nowhere"),
    ],
)
def test_what_cannot_be_is_refused(topomap, tmp_path, facts, fault):
    file = tmp_path / "bad.lp"
    file.write_text(f"slots(4). view(0,0). turn(1,0). view(1,0). turn(2,0). view(2,0). {facts}\n")
    done = topomap("solve", file)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith(f"{file}:")
    assert fault in done.stderr
