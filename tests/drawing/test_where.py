"""Where places are drawn, if it is known where they are: by a compass, lengths or odometry, or as
in a file of a world. And no line passes under a place that is not one of its ends."""

import math
import random
import re
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from conftest import run
from scipy.spatial import Delaunay
from test_draw import check, clockwise, some_map
from topomap.api.scenes import drawn_like
from topomap.drawing import panel
from topomap.drawing.clearance import CLEAR, under
from topomap.drawing.layout import ELSEWHERE, layout, straight
from topomap.drawing.likeness import likeness
from topomap.drawing.placed import difference, targets
from topomap.drawing.plain import UNDER
from topomap.drawing.scenes import Scene
from topomap.drawing.where import measured
from topomap.model.experience import Experience
from topomap.model.topology import label
from topomap.runtime.errors import InputError
from topomap.worlds.environment import Environment, by_bearing, flat_bearing, grid, moves_of
from topomap.worlds.files import load
from topomap.worlds.instance import instance
from topomap.worlds.plan import Reading
from topomap.worlds.senses import Senses
from topomap.worlds.tours import tour

COMPASS, LENGTHS = Senses(compass=True), Senses(compass=True, lengths=True)
SHIFTS, BOTH = Senses(odometry=5), Senses(compass=True, odometry=5)


def streets(seed, slots=36):
    """A world of straight streets between random points, and the points."""
    draw = random.Random(f"streets {seed}")
    while True:
        points = []
        while len(points) < 12:
            point = draw.uniform(0, 400), draw.uniform(0, 400)
            if all(math.dist(point, other) > 60 for other in points):
                points.append(point)
        sides = Delaunay(np.array(points)).simplices.tolist()
        graph = nx.Graph((a, b) for side in sides for a, b in pairwise([*side, side[0]]))
        ways = sorted(tuple(sorted(way)) for way in graph.edges)
        for way in draw.sample(ways, len(ways) // 2):
            graph.remove_edge(*way)
            if not nx.is_connected(graph):
                graph.add_edge(*way)
        at = dict(enumerate(points))
        ways = sorted(tuple(sorted(way)) for way in graph.edges)
        try:
            made = by_bearing(ways, lambda a, b, at=at: flat_bearing(at[a], at[b]), slots, 0)
        except InputError:  # two ways in one slot
            continue
        moves = moves_of(made, lambda a, b, at=at: tuple(np.subtract(at[b], at[a])))
        return Environment("streets", ("streets",), made, None, (), moves), at


def explored(environment, at, senses, seed=0):
    """The true map of a tour, and where its places are in truth."""
    made = instance(environment, "tour", senses=senses, seed=seed)
    world = environment.map
    places = [min(world.stars)]
    for slot in tour(world, places[0]):
        places.append(world.links[places[-1], slot][0])
    scene = Scene(
        made.experience.map_of(made.truth), made.truth, environment.name, seen=made.experience
    )
    return scene, {place: at[places[place]] for place in scene.world.stars}


def squares(rows, columns):
    made = grid(rows, columns)
    return made, {(row, column): (column, -row) for row, column in made.map.stars}


def off(found, truth):
    """How much points differ from the true ones, moved and in another scale but not turned, as a
    share of the size."""
    one, other = (np.array([points[place] for place in truth], float) for points in (found, truth))
    one, other = one - one.mean(0), other - other.mean(0)
    scale = (one * other).sum() / (one**2).sum()
    assert scale > 0
    return np.linalg.norm(scale * one - other) / np.linalg.norm(other)


def in_order(world, laid):
    return all(clockwise(laid.lines, place) == sorted(star) for place, star in world.stars.items())


@pytest.mark.parametrize("senses", [COMPASS, LENGTHS, SHIFTS, BOTH], ids=str)
@pytest.mark.parametrize("shape", [(3, 3), (4, 5)])
def test_a_grid_is_where_it_is_with_north_up(shape, senses):
    scene, truth = explored(*squares(*shape), senses)
    exact = senses.odometry is None
    assert off(scene.where(), truth) < (1e-6 if exact else 0.03)
    laid = layout(scene.world, scene.ahead, where=scene.where())
    assert off(laid.places, truth) < (1e-6 if exact else 0.03)
    assert not laid.elsewhere
    assert in_order(scene.world, laid)
    check(scene)


@pytest.mark.parametrize("seed", range(8))
def test_streets_are_where_they_are(seed):
    environment, at = streets(seed)
    for senses, most in (LENGTHS, 0.12), (Senses(odometry=5, seed=seed), 0.08):
        scene, truth = explored(environment, at, senses, seed)
        assert off(scene.where(), truth) < most


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_streets_are_drawn_where_they_are(seed):
    """Exactly in their order, without crossings, not under places; where this lets them be."""
    environment, at = streets(seed)
    scene, truth = explored(environment, at, SHIFTS)
    laid = layout(scene.world, scene.ahead, where=scene.where())
    assert in_order(scene.world, laid)
    assert not under(scene.world, laid.lines)
    assert laid.elsewhere == (difference(laid.lines, targets(scene.world, scene.where())) > 0.2)
    assert (ELSEWHERE in panel.title(scene, laid)) == laid.elsewhere
    if not laid.elsewhere:
        assert off(laid.places, truth) < 0.3
    check(scene)


@pytest.mark.slow
def test_most_streets_are_drawn_where_they_are():
    """Three quarters of them at least, in a drawing of few steps."""
    drawn = []
    for seed in range(16):
        scene, _ = explored(*streets(seed), LENGTHS)
        drawn.append(layout(scene.world, where=scene.where(), steps=25).elsewhere)
    assert sum(drawn) <= len(drawn) / 4


def test_a_walk_that_drifts_comes_back():
    """Where loops close, errors are shared out."""
    scene, truth = explored(*squares(4, 4), Senses(odometry=20, seed=2))
    sums, at = {0: np.zeros(2)}, np.zeros(2)
    for step, shift in enumerate(scene.seen.shifts, 1):
        at = at + np.array(shift)
        sums.setdefault(scene.at[step][0], at)
    assert off(scene.where(), truth) < off(sums, truth)


def test_one_wrong_shift_does_not_bend_all():
    made = instance(grid(3, 3), "tour", senses=Senses(odometry=0))
    seen = made.experience
    wrong = [*seen.shifts]
    wrong[5] = (wrong[5][0] + 150, wrong[5][1] - 90)
    other = Experience(seen.slots, seen.views, seen.turns, shifts=wrong)
    one, two = (measured(some, made.truth) for some in (seen, other))
    assert off(two, one) < 0.05


def test_the_second_axis_of_odometry_may_lead_south():
    made = instance(grid(3, 4), "tour", senses=Senses(odometry=5))
    seen = made.experience
    south = [(x, -y) for x, y in seen.shifts]
    other = Experience(seen.slots, seen.views, seen.turns, shifts=south)
    assert off(measured(other, made.truth), measured(seen, made.truth)) < 1e-6


def test_the_compass_turns_the_odometry():
    made = instance(grid(3, 4), "tour", senses=BOTH)
    seen = made.experience
    turned = [(-y, x) for x, y in seen.shifts]
    other = Experience(seen.slots, seen.views, seen.turns, compass=seen.compass, shifts=turned)
    assert off(measured(other, made.truth), measured(seen, made.truth)) < 1e-6


def test_nothing_is_known_without_a_direction():
    made = instance(grid(2, 3), "tour", senses=Senses(lengths=True))
    assert measured(made.experience, made.truth) == {}
    scene = Scene(made.experience.map_of(made.truth), made.truth, "", seen=made.experience)
    assert targets(scene.world, scene.where()) is None


def test_characters_are_turned_by_quarters():
    scene, truth = explored(*squares(3, 4), COMPASS)
    laid = straight(scene.world, scene.ahead, where=scene.where())
    assert off(laid.places, truth) < 1e-6
    x, y = np.diff(straight(scene.world, scene.ahead).lines[scene.ahead], axis=0)[0]
    assert (round(x), round(y)) == (1, 0)  # else the first way leads to the right


@pytest.mark.slow
@pytest.mark.parametrize("block", range(4))
def test_no_line_passes_under_a_place(block):
    """Of pictures that have time; of plain ones it is said if a line does."""
    for number in range(25 * block, 25 * block + 25):
        scene = some_map(f"under {number}", *["planar"] * (number % 3 > 0))
        laid = layout(scene.world, scene.ahead)
        assert not laid.note
        assert under(scene.world, laid.lines) == []
        for gateway, line in laid.lines.items():  # once more, by points on the lines
            ends = {gateway[0], scene.world.links.get(gateway, gateway)[0]}
            dots = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(line)])
            for place, point in laid.places.items():
                assert place in ends or np.linalg.norm(dots - point, axis=1).min() > CLEAR - 1e-6
        hurried = layout(scene.world, scene.ahead, late=lambda: True)
        several = len(scene.world.parts()) > 1
        assert several or bool(under(scene.world, hurried.lines)) == (UNDER in hurried.note)


POINTS = {
    **{"dock": (0, 0), "church": (120, 10), "market": (230, -20), "bridge": (10, 90)},
    **{"mill": (130, 130), "gate": (240, 110), "farm": (60, 210), "wood": (200, 230)},
}
WAYS = (
    "dock church, church market, dock bridge, church mill, market gate, bridge mill, "
    "mill gate, bridge farm, farm mill, mill wood, gate wood, farm wood"
)


@pytest.fixture(name="town")
def town_of(tmp_path):
    """A small town in GraphML, and an exploration of it."""
    graph = nx.MultiGraph()
    for place, (x, y) in POINTS.items():
        graph.add_node(place, x=float(x), y=float(y))
    graph.add_edges_from(way.split() for way in WAYS.split(", "))
    file = tmp_path / "town.graphml"
    nx.write_graphml(graph, file)
    environment = load(file).environment
    scene, truth = explored(environment, POINTS, Senses())
    explored_file = tmp_path / "town.lp"
    explored_file.write_text(scene.seen.facts())
    return file, explored_file, scene, truth


def test_a_map_is_drawn_like_the_world(town):
    file, _, scene, truth = town
    loaded = load(file)
    found = likeness(scene.world, loaded.environment.map, loaded.plan)
    assert found.note == ""
    assert off(found.where, truth) < 1e-9
    laid = layout(scene.world, where=found.where)
    assert off(laid.places, truth) < 0.05
    assert in_order(scene.world, laid)
    turned = load(file, slots=12, north=11).environment.map  # other slots, in the same order
    assert likeness(scene.world, turned, loaded.plan).where == found.where


def test_a_part_of_the_world_is_found(town):
    file, _, scene, truth = town
    cut = scene.seen.cut(12)
    at = scene.at[:13]
    world = cut.map_of(at)
    assert world.pending()
    loaded = load(file)
    found = likeness(world, loaded.environment.map, loaded.plan)
    assert found.note == ""
    assert off(found.where, {place: truth[place] for place in world.stars}) < 1e-9


def test_what_is_not_like_the_world_is_said(town):
    file = town[0]
    loaded = load(file)
    other = grid(2, 3).map
    found = likeness(other, loaded.environment.map, loaded.plan)
    assert found.where is None
    assert "not a part of the world" in found.note
    names = {(0, 0): "dock", (0, 2): "market", (1, 0): "farm", (1, 1): "wood"}
    signed = type(other)(
        4, other.stars, other.links, {place: frozenset({f'"{n}"'}) for place, n in names.items()}
    )
    found = likeness(signed, loaded.environment.map, loaded.plan)
    assert "4 places are found by their names" in found.note
    assert all(found.where[place] == POINTS[name] for place, name in names.items())
    assert set(found.where) == set(other.stars)


def test_several_ways_are_said():
    made = grid(2, 3)
    plan = type("Plan", (), {"points": squares(2, 3)[1], "landmarks": {}, "names": {}})
    found = likeness(made.map, made.map, plan)
    assert "in several ways" in found.note
    assert found.where is not None


def test_of_several_ways_the_one_that_was_measured_is_taken():
    """A block looks the same from opposite corners, but not by the compass."""
    environment, at = squares(2, 3)
    plan = type("Plan", (), {"points": at, "landmarks": {}, "names": {}})
    for senses in COMPASS, SHIFTS:
        for start in [*environment.map.stars]:
            made = instance(environment, "tour", start=label(start), senses=senses)
            world = made.experience.map_of(made.truth)
            scene = Scene(world, made.truth, "block", seen=made.experience)
            found = likeness(world, environment.map, plan, scene.where())
            assert found.note == ""
            assert found.where[0] == at[start]


def test_a_world_with_loops_is_known_again(tmp_path):
    """However it was read for the exploration."""
    graph = nx.MultiGraph(crs="plane")
    for name, (x, y) in {"a": (0, 0), "b": (100, 0), "c": (100, 90)}.items():
        graph.add_node(name, x=float(x), y=float(y))
    graph.add_edges_from([("a", "b"), ("b", "c")])
    graph.add_edge("a", "a", geometry="LINESTRING (0 0, -40 0, -40 -40, 0 -40, 0 0)")
    nx.write_graphml(graph, tmp_path / "net.graphml")
    for loops in (False, True):
        environment = load(tmp_path / "net.graphml", Reading(loops=loops)).environment
        made = instance(environment, "tour")
        world = made.experience.map_of(made.truth)
        scene = Scene(world, made.truth, "loops", seen=made.experience)
        drawn, said = drawn_like(scene, str(tmp_path / "net.graphml"))
        assert {*drawn.like.values()} == {(0, 0), (100, 0), (100, 90)}
        assert "no part" not in said


@pytest.mark.slow
@pytest.mark.parametrize("command", ["draw", "show", "export"])
def test_like_on_the_command_line(town, tmp_path, command):
    file, explored_file, *_ = town
    rest = {
        "draw": ["-o", str(tmp_path / "town.svg")],
        "show": [],
        "export": ["--format", "dot", "-o", str(tmp_path / "town.dot")],
    }[command]
    done = run("topomap", command, explored_file, "--planar", "--like", file, *rest)
    assert (done.returncode, done.stderr) == (0, "")
    if command == "export":
        text = (tmp_path / "town.dot").read_text()
        places = {
            int(place): (float(x), float(y))
            for place, x, y in re.findall(r'"(\d+)" \[pos="([-\d.e]+),([-\d.e]+)!', text)
        }
        assert len(places) == len(POINTS)
        assert off(places, {place: town[3][place] for place in places}) < 0.05
    if command == "show":
        usual = run("topomap", command, explored_file, "--planar").stdout
        assert done.stdout != usual


@pytest.mark.slow
def test_a_world_that_is_another_is_said_in_one_line(town, tmp_path):
    picture = tmp_path / "a.svg"
    call = "topomap", "draw", "instances/grid-3x3-snake.lp", "--planar", "-o", picture
    assert run(*call).returncode == 0
    usual = picture.read_bytes()
    done = run(*call, "--like", town[0])
    assert done.returncode == 0
    assert len(done.stderr.splitlines()) == 1
    assert "drawn as usual" in done.stderr
    assert picture.read_bytes() == usual
    missing = run(*call, "--like", tmp_path / "missing.graphml")
    assert (missing.returncode, len(missing.stderr.splitlines())) == (2, 1)


def test_the_world_is_not_written_over(town):
    file, explored_file, *_ = town
    content = file.read_bytes()
    done = run("topomap", "export", explored_file, "--format", "dot", "--like", file, "-o", file)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert file.read_bytes() == content
