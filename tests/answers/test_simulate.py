"""Robots: they map by what they see alone, stop where they may, and what is said of them is so."""

import json
import random

import pytest
from conftest import ROOT, TRIED
from oracles.worlds import random_world
from topomap.model.experience import observe
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.questions import robot
from topomap.questions.robot import Robot, random_walk, reached
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import solving
from topomap.worlds.environment import Environment, grid, lattice, world
from topomap.worlds.family import expand
from topomap.worlds.senses import Senses

ALL = Query(frozenset())


MOST = 16


def explored(made, start, query=ALL, most=MOST, marker=False):
    made = Environment("test", (), made)
    return robot.simulate(made, start, query, Watch(), most, marker)


def worlds(number, seed):
    """Random worlds that a robot can find, and where it starts."""
    draw = random.Random(seed)
    while number:
        made = random_world(draw)
        start = draw.choice(sorted(made.links))
        made = reached(made, start[0])
        if made.path_axiom_fault():
            continue
        if not made.boundaries_consistent() and draw.random() < 0.8:
            continue  # its own map is rarely optimal
        number -= 1
        yield made, start


def ended_as_it_says(made, start, outcome):
    """What the outcome says, compared with the search and the world."""
    experience, truth = observe(made, start, routed(made, start, outcome.experience))
    assert experience == outcome.experience
    found = solving.best(experience, ALL, Watch(), traversal.hypotheses)
    found = {one.at: one.cost for one in found if one.proved}
    best = sorted(found)
    assert [one.at for one in outcome.maps] == best[: robot.MOST_MAPS]
    maps = [experience.map_of(at) for at in best]
    closed = not any(one.pending() for one in maps)
    if outcome.end == "settled":
        assert len(best) == 1
        assert closed
        ((exceptions, _, places),) = found.values()
        assert not exceptions or not consistent(experience, places * 3 // 2)
    elif outcome.end == "bisimilar":
        assert len(best) > 1
        assert closed
        for at, one in zip(best, maps, strict=True):
            assert maps[0].indistinguishable(best[0][-1], one, at[-1])
    else:
        assert outcome.end == "steps"
        assert outcome.steps == MOST
    true = truth in best and not experience.map_of(truth).pending()
    is_open = outcome.end == "steps" or len(outcome.maps) == robot.MOST_MAPS
    assert outcome.truth == (true or (None if is_open else False))


def consistent(experience, most):
    """The maps without exceptions of that many places at most, by the search without any
    preference."""
    every = traversal.hypotheses(experience, Query(places=most), Watch())
    maps = (experience.map_of(one.at) for one in every)
    return [one for one in maps if one.boundaries_consistent()]


def routed(made, start, experience):
    """The slots by which a robot that did this left the places of the world."""
    place, slot = start
    for turn in experience.turns:
        out = (slot + turn) % made.slots
        yield out
        place, slot = made.links[place, out]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "seed"), [(10, 1), pytest.param(300, 2, marks=pytest.mark.long)]
)
def test_robots_in_random_worlds_end_as_they_say(number, seed):
    for made, start in worlds(number, seed):
        outcome = explored(made, start)
        ended_as_it_says(made, start, outcome)
        TRIED[f"robots that ended: {outcome.end}"] += 1
        TRIED["robots"] += 1


def test_a_robot_knows_nothing_but_what_it_saw():
    """In two worlds that no walk distinguishes it goes the same ways."""
    experience = read(ROOT / "instances/grid-3x3-snake.lp")
    best = solving.best(experience, ALL, Watch())
    first, second = (experience.map_of(one.at) for one in best if one.proved)
    assert not first.isomorphic(second)
    one, other = explored(first, (0, 0)), explored(second, (0, 0))
    assert one.experience == other.experience
    assert [found.at for found in one.maps] == [found.at for found in other.maps]


def test_a_robot_goes_where_it_turns():
    made = grid(2, 2).map
    robot = Robot(Environment("test", (), made), ((0, 0), 1), Senses())
    for turn in (0, 3, 3, 3):
        robot.step(turn)
    assert robot.dstate == ((0, 0), 2)
    assert robot.experience().turns == (0, 3, 3, 3)


def test_the_part_that_can_be_walked_to_is_the_world():
    links = {("a", 0): ("b", 2), ("b", 2): ("a", 0), ("c", 0): ("c", 2), ("c", 2): ("c", 0)}
    assert set(reached(world(4, links), "a").stars) == {"a", "b"}
    assert set(reached(world(4, links), "c").stars) == {"c"}


def test_a_random_walk_is_as_long_as_another_way_says():
    """The ways of a line of three places, walked at random: the chance to have gone them all after
    a step follows from the states (place, ways gone), and the median is where it reaches a half."""
    made = grid(1, 3).map
    chances = {((0, 0), frozenset()): 1.0}
    ended, step = 0.0, 0
    while ended < 0.5:
        step += 1
        following = {}
        for (place, taken), chance in chances.items():
            for slot in made.stars[place]:
                there = made.links[place, slot][0]
                now = taken | {frozenset((place, there))}
                share = chance / len(made.stars[place])
                if len(now) == 2:
                    ended += share
                else:
                    following[there, now] = following.get((there, now), 0) + share
        chances = following
    assert abs(random_walk(made, (0, 0), 1001) - step) <= 2


def test_who_cannot_be_everywhere_in_time_says_so(monkeypatch):
    monkeypatch.setattr(robot, "PATIENCE", 1)
    assert random_walk(grid(3, 3).map, (0, 0)) is None


def test_a_world_whose_own_map_breaks_the_path_axiom_can_be_explored(topomap):
    """A ring of three places with signs: with the axiom its own map is none."""
    call = ["simulate", "cylinder", 1, 3, "--signs", 1, "--steps", 14]
    without = topomap(*call, "--no-path-axiom")
    assert (without.returncode, without.stderr) == (0, "")
    assert "the best map is the truth\n" in without.stdout
    assert "--no-path-axiom" not in without.stdout
    done = topomap(*call)
    assert done.returncode != 0
    assert "the truth breaks the path axiom, and so is not a map" in done.stdout
    assert "is circular; --no-path-axiom\n" in done.stdout


@pytest.mark.parametrize("size", [(1, 4), (2, 2), (2, 3)])
def test_a_crescent_is_found(size):
    """The true map has exceptions; the robot ends there, and not at a smaller closed map."""
    made = grid(*size, "crescents").map
    start = (0, 0), min(made.stars[0, 0])
    outcome = explored(made, start, most=100)
    assert (outcome.end, outcome.truth, len(outcome.maps)) == ("settled", True, 1)
    many = sum(1 for _ in made.exceptions())
    assert many > 0
    assert outcome.maps[0].cost == (many, len(made.paths()), len(made.stars))
    assert f"the truth has {many} exceptions to consistent boundaries" in outcome.lines("crescent")


def test_a_small_closed_map_with_exceptions_is_not_accepted():
    """The robot in a row of hexagons could stop earlier, at a map with exceptions."""
    made = lattice("hexagons", 1, 2)
    _, start = robot.start_of(made)
    outcome = explored(made.map, start, most=100)
    whole = outcome.experience
    early = [
        step
        for step in range(whole.steps)
        for best in [robot.best(whole.cut(step), ALL, Watch())]
        if len(best) == 1 and best[0].kind == "optimal"
    ]
    assert early
    for step in early:
        (best,) = robot.best(whole.cut(step), ALL, Watch())
        assert best.cost[0] > 0
        assert robot.rivals(whole.cut(step), ALL, [best], Watch())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("made", "parts"),
    [
        pytest.param(grid(3, 3), (), id="3x3"),
        pytest.param(grid(4, 4), ("perpendicular",), id="4x4", marks=pytest.mark.long),
    ],
)
def test_a_marker_settles_what_no_walk_can(made, parts):
    """The paper's Figures 1 and 5 (d), as a robot comes upon them."""
    query = Query(frozenset(parts))
    start = (0, 0), 1
    without = explored(made.map, start, query, 60)
    assert (without.end, len(without.maps), without.truth) == ("bisimilar", 2, True)
    settled = explored(made.map, start, query, 60, marker=True)
    assert (settled.end, len(settled.maps), settled.truth) == ("settled", 1, True)
    (dropped,) = settled.experience.drops
    assert dropped >= without.steps
    assert settled.experience.turns[: without.steps] == without.experience.turns


def test_the_command_says_what_came_of_it(topomap, tmp_path):
    instance = tmp_path / "walked.lp"
    done = topomap("simulate", "grid", 3, 3, "--planar", "--instance", instance, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    experience = read(instance)
    start = (0, 0), 1
    assert (
        observe(grid(3, 3).map, start, routed(grid(3, 3).map, start, experience))[0] == experience
    )
    assert answer == {
        "format": 1,
        "environment": "grid-3x3",
        "places": 9,
        "ways": 12,
        "signs": 0,
        "end": "settled",
        "steps": experience.steps,
        "best_maps": 1,
        "truth": True,
        "tour": 16,
        "random": random_walk(grid(3, 3).map, (0, 0)),
        "complete": True,
        "fault": None,
    }
    text = topomap("simulate", "grid", 3, 3, "--planar").stdout
    assert f"{experience.steps} steps walked: one closed map is optimal\n" in text
    assert "the best map is the truth\n" in text


@pytest.mark.parametrize(
    ("call", "status", "words"),
    [
        (["grid", 2, 3], 1, "the best map is not the truth"),
        (
            ["grid", 3, 3, "--steps", 5],
            3,
            "5 steps walked: as many steps as it may walk; partial: steps",
        ),
        (
            ["grid", 1, 5, "--steps", 0],
            3,
            "0 steps walked: as many steps as it may walk; partial: steps",
        ),
        (["triangles", 3, 3, "--bound", 2], 1, "no map is left that has what was asked for"),
        (["grid", 5, 5, "--timeout", 0.5], 3, "partial: timeout"),
    ],
)
def test_how_it_ends(topomap, call, status, words):
    done = topomap("simulate", *call)
    assert (done.returncode, done.stderr) == (status, "")
    assert words in done.stdout


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("grid 2", "topomap simulate grid: the following arguments are required: columns"),
        ("grid 2 3 --json", "list, -o, --instance and --json cannot be used in a list"),
        ("list other.txt", "list, -o, --instance and --json cannot be used in a list"),
        ("grid 2 3 --start 7,7", "grid-2x3: there is no place '7,7'"),
        ("grid 2 3 --facing 0", "grid-2x3: place 0,0 has no gateway 0"),
        ("grid --help", "--help cannot be used in a list"),
    ],
)
def test_a_bad_line_of_a_list_is_named(topomap, tmp_path, line, fault):
    file = tmp_path / "worlds.txt"
    file.write_text(f"# worlds\ngrid 1 3\n{line}\n")
    out = tmp_path / "out.json"
    done = topomap("simulate", "list", file, "-o", out)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{file}:3: ")
    assert fault in done.stderr
    assert done.stderr.count("\n") == 1
    assert not out.exists()


def calls():
    """The worlds of the list, one a case; those that take seconds are long."""
    quick = ("grid 1 5", "grid 2 3", "maze 3 3 --seed 1", "hexagons 1 2", "triangles 2 3")
    quick += ("crescents 2 4 --planar",)
    for _, call in expand(ROOT / "instances/worlds.txt"):
        name = " ".join(call)
        yield pytest.param(name, marks=[] if name in quick else pytest.mark.long)


@pytest.mark.parametrize("call", [*calls()])
def test_the_table_is_what_comes_out(topomap, tmp_path, call):
    """docs/simulations.json, and the table of docs/robots.md, have what the command gives now."""
    rows = json.loads((ROOT / "docs/simulations.json").read_text())["rows"]
    (row,) = (row for row in rows if row["environment"] == call)
    file = tmp_path / "worlds.txt"
    file.write_text(call)
    assert json.loads(topomap("simulate", "list", file, "--json").stdout)["rows"] == [row]


def test_the_page_has_the_table():
    rows = json.loads((ROOT / "docs/simulations.json").read_text())["rows"]
    assert f"```text\n{robot.table(rows)}```" in (ROOT / "docs/robots.md").read_text()
    listed = [" ".join(call) for _, call in expand(ROOT / "instances/worlds.txt")]
    assert [row["environment"] for row in rows] == listed
    assert len(rows) == 21
