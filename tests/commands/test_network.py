"""Worlds from street networks in GraphML."""

import json
import math
import os
import random

import networkx as nx
import pytest
import topomap
from conftest import SHARED, TRIED, run
from oracles.worlds import random_world
from topomap.model.facts import parse
from topomap.runtime.errors import InputError
from topomap.worlds.census import census, classes, look
from topomap.worlds.courses import Layout, clashes, exit_towards, exits_of, layout, links_of
from topomap.worlds.environment import grid
from topomap.worlds.files import load
from topomap.worlds.plan import Exit, Plan, Reading, Way


def write(tmp_path, graph):
    file = tmp_path / "net.graphml"
    nx.write_graphml(graph, file)
    return file


def square(kind=nx.MultiDiGraph, scale=100.0, x="x", y="y", **attributes):
    """Four crossings in a square, a (south-west) b c d clockwise."""
    graph = kind(**{"crs": "+proj=utm +zone=18", **attributes})
    for name, east, north in (("a", 0, 0), ("b", 0, 1), ("c", 1, 1), ("d", 1, 0)):
        graph.add_node(name, **{x: east * scale, y: north * scale})
    for one, two in ("ab", "bc", "cd", "da"):
        join(graph, one, two)
    return graph


def join(graph, one, two, **data):
    """A way that can be gone in both directions."""
    graph.add_edge(one, two, **data)
    if graph.is_directed():
        graph.add_edge(two, one, **data)


def test_bearings_become_slots(tmp_path):
    made, warnings, *_ = load(write(tmp_path, square()), None, 4, 0)
    assert made.map.links["a", 0] == ("b", 2)
    assert made.map.links["b", 1] == ("c", 3)
    assert not warnings
    assert made.map.isomorphic(grid(2, 2).map)
    turned, *_ = load(write(tmp_path, square()), None, 4, 90)
    assert turned.map.links["a", 3] == ("b", 1)
    eight, *_ = load(write(tmp_path, square()), None, 8, 0)
    assert eight.map.links["a", 0] == ("b", 4)


def test_a_two_way_pair_is_one_way_and_loops_go(tmp_path):
    graph = square()
    graph.add_edge("a", "a")
    graph.add_node("z", x=5.0, y=5.0)
    made, warnings, *_ = load(write(tmp_path, graph), None, 4, 0)
    assert len(made.map.edges()) == 4
    assert "z" not in made.map.stars
    assert [warning.partition(": ")[2] for warning in warnings] == [
        "loops left out: 1",
        "places without a way left out: 1",
    ]
    undirected = write(tmp_path, square(nx.Graph))
    assert load(undirected, None, 4, 0)[0].map == made.map


def test_without_a_crs_the_guess_is_reported(tmp_path):
    file = write(tmp_path, square(crs=""))
    graph = nx.read_graphml(file)
    del graph.graph["crs"]
    (warning,) = load(write(tmp_path, graph), None, 4, 0)[1]
    assert "no crs" in warning


@pytest.mark.parametrize("crs", ["epsg:4269", "EPSG:4326", "+proj=longlat +datum=WGS84"])
def test_geographic_coordinates_are_known_by_their_crs(tmp_path, crs):
    graph = nx.DiGraph(crs=crs)
    graph.add_node("a", x=20.0, y=60.0)
    graph.add_node("b", x=20.01, y=60.005)
    join(graph, "a", "b")
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {2}


def test_a_tour_of_a_part_is_always_the_same(tmp_path):
    large = nx.convert_node_labels_to_integers(nx.grid_2d_graph(5, 8))
    for node, data in large.nodes.items():
        data.update(x=200.0 + 10 * (node % 8), y=10.0 * (node // 8))
    both = nx.disjoint_union(square(nx.Graph, scale=10.0), large)
    both.graph["crs"] = "+proj=utm +zone=18"
    file = write(tmp_path, both)
    outputs = {
        run(
            "topomap",
            "generate",
            "network",
            file,
            "--route",
            "tour",
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in "012"
    }
    assert len(outputs) == 1
    assert "steps 4" in outputs.pop()


def test_headers_hold_no_facts(tmp_path):
    graph = square(created_with="OSMnx 1\nslots(6).", created_date="2020\nview(0,5).")
    done = run("topomap", "generate", "network", write(tmp_path, graph), "--route", "tour")
    assert done.returncode == 0
    assert done.stdout.count("slots(") == 2
    parse(done.stdout, "made")
    done = run("topomap", "generate", "grid", "2", "2", "--route", "E", "--name", "a\nslots(6).")
    assert done.returncode == 2
    assert "letters, digits" in done.stderr


def test_parallel_ways_and_parts_are_reported(tmp_path):
    graph = square()
    join(graph, "a", "b")
    with pytest.raises(
        InputError, match=r"place a: the ways to b .* and b .* share slot 0; place b"
    ):
        load(write(tmp_path, graph), None, 4, 0)
    apart = nx.disjoint_union(square(), square(scale=70))
    assert "not connected" in load(write(tmp_path, apart), None, 4, 0).warnings[0]


def test_degrees_are_scaled_by_the_latitude(tmp_path):
    """At 60 degrees north a degree of longitude is half one of latitude: what looks like
    a bearing of 63 degrees is one of 45."""
    graph = nx.DiGraph(crs="epsg:4326")
    graph.add_node("a", x=20.0, y=60.0)
    graph.add_node("b", x=20.01, y=60.005)
    join(graph, "a", "b")
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {2}
    graph.graph["crs"] = "+proj=utm +zone=34"
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {3}
    graph.graph.clear()
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {3}
    degrees = load(write(tmp_path, graph), Reading(degrees=True), 16, 0)
    assert degrees.environment.map.stars["a"] == {2}
    assert not degrees.warnings
    lonlat = nx.relabel_nodes(graph, {})
    for node in lonlat.nodes.values():
        node["lon"], node["lat"] = node.pop("x"), node.pop("y")
    assert load(write(tmp_path, lonlat), None, 16, 0)[0].map.stars["a"] == {2}


def broken(**nodes):
    graph = square()
    for name, attributes in nodes.items():
        graph.nodes[name].clear()
        graph.nodes[name].update(attributes)
    return graph


@pytest.mark.parametrize(
    ("graph", "fault"),
    [
        (broken(a={}), "place a has no coordinates"),
        (broken(a={"x": "here", "y": 0.0}), "place a has no coordinates"),
        (broken(a={"x": float("nan"), "y": 0.0}), "place a has no coordinates"),
        (broken(d={"x": 1.0, "y": 200.0}), "share slot"),
        (broken(a={"x": 0.0, "y": 100.0}), "are at one point"),
        (nx.Graph(), "no ways"),
    ],
)
def test_networks_refused(tmp_path, graph, fault):
    file = write(tmp_path, graph)
    with pytest.raises(InputError, match=fault) as error:
        load(file, None, 4, 0)
    assert str(file) in str(error.value)


def test_two_ways_in_one_slot_name_the_place(tmp_path):
    graph = square()
    graph.add_node("e", x=10.0, y=90.0)
    join(graph, "a", "e")
    with pytest.raises(InputError, match=r"place a: the ways to b .* and e .* share slot 0"):
        load(write(tmp_path, graph), None, 4, 0)
    assert len(load(write(tmp_path, graph), None, 64, 0)[0].map.edges()) == 5


@pytest.mark.parametrize(
    "text",
    ["", "no xml", "<graphml/>", "<a>", '<!DOCTYPE a [<!ENTITY b "c">]><graphml/>', "\x00\xff"],
)
def test_files_that_are_no_network(tmp_path, text):
    file = tmp_path / "net.graphml"
    file.write_text(text, encoding="latin-1")
    done = run("topomap", "generate", "network", file, "--route", "tour")
    assert done.returncode == 2
    assert done.stderr.startswith(f"{file}: ")
    assert done.stderr.count("\n") == 1


def test_odd_slots_are_refused(tmp_path):
    done = run(
        "topomap",
        "generate",
        "network",
        write(tmp_path, square()),
        "--slots",
        "5",
        "--route",
        "tour",
    )
    assert done.returncode == 2
    assert "even" in done.stderr


def test_the_manhattan_piece():
    file = SHARED / "manhattan.graphml"
    if not file.exists():
        pytest.skip(f"the real map is not here: {file}")
    with pytest.raises(InputError, match="63 of 73 ways can be gone one way only"):
        load(file)
    made, warnings, *_ = load(file, None, 4, 29, two_way=True)
    assert warnings == [f"{file}: one-way ways taken as two-way: 63"]
    chosen = load(file, two_way=True)
    assert chosen.layout.slots == 4
    assert chosen.layout.margin > 30
    assert chosen.environment.map.isomorphic(made.map)
    assert (len(made.map.stars), len(made.map.edges()), made.map.genus()) == (46, 73, 0)
    assert made.map.path_axiom_fault() is None


CASES = SHARED.parent / "cases"


@pytest.mark.skipif(not CASES.exists(), reason=f"the small cases are not here: {CASES}")
def test_the_reported_files():
    crescent = CASES / "crescent.graphml"
    with pytest.raises(
        InputError, match=r"1 of 5 ways can be gone one way only \(a to b\); --two-way"
    ):
        load(crescent)
    world = load(crescent, two_way=True).environment.map
    assert (len(world.stars), len(world.edges()), world.slots) == (4, 5, 4)
    assert world.stars == {"a": {0, 1}, "b": {0, 1, 2, 3}, "c": {1, 3}, "d": {0, 1}}
    frame = load(CASES / "robot-frame.graphml", Reading(degrees=False), 16, 0)
    assert frame.environment.map.stars["dock"] == {2, 6}
    assert not frame.warnings
    loop = CASES / "selfloop.graphml"
    told = load(loop, two_way=True).warnings
    assert [line.partition(": ")[2] for line in told] == [
        "loops left out: 1",
        "one-way ways taken as two-way: 1",
    ]
    with pytest.raises(InputError, match="the way from place b back to itself has no course"):
        load(loop, Reading(loops=True), two_way=True)


def test_a_way_has_its_course(tmp_path):
    """A way that leaves to the south-east, and comes from there; as WKT, and as a list of points,
    also the other way round; and a loop with a course, which is kept only if that is asked for."""
    for course in (
        "LINESTRING (0 0, 50 -60, 60 50, 0 100)",
        "[[0, 100], [60, 50], [50, -60], [0, 0]]",
        "linestring(0 0,50 -60,60 50,0 100)",
    ):
        graph = square(nx.Graph)
        graph.remove_edge("a", "b")
        graph.add_edge("a", "b", geometry=course)
        world = load(write(tmp_path, graph), None, 8, 0).environment.map
        assert world.links["a", 3] == ("b", 3)
    looped = square(nx.MultiGraph)
    looped.add_edge("a", "a", geometry="LINESTRING (0 0, -40 0, -40 -40, 0 -40, 0 0)")
    file = write(tmp_path, looped)
    assert load(file).warnings == [f"{file}: loops left out: 1"]
    kept = load(file, Reading(loops=True)).environment.map
    assert kept.links["a", 3] == ("a", 2)
    for fault in (
        "LINESTRING (0 0)",
        "POINT (1 2)",
        "[[0, 0], [1]]",
        "LINESTRING (0 0, nan 1)",
        "[",
    ):
        graph = square(nx.Graph)
        graph.add_edge("a", "b", geometry=fault)
        with pytest.raises(InputError, match="the way from place a to b: its geometry"):
            load(write(tmp_path, graph))


def test_the_fewest_slots_and_the_best_turn_are_chosen():
    """Against trying: no fewer slots part the exits at any of many turns; the chosen turn does, and
    may be off by its margin, but by no more than twice the margin in one of both directions."""
    for number in range(150):
        draw = random.Random(f"slots {number}")
        ways = tuple(
            Way((Exit(f"p{draw.randrange(4)}", draw.uniform(-360, 720)), Exit(f"q{n}", 0.0)))
            for n in range(draw.randint(1, 9))
        )
        plan, exits = Plan("drawn", ways), exits_of(ways)
        at = layout("drawn", plan)
        for off in (-0.999, -0.5, 0, 0.5, 0.999):
            turn = at.north + off * min(at.margin, 180)
            assert not clashes(ways, exits, at._replace(north=turn))
        whole = math.isinf(at.margin)
        turned = [] if whole else [at.north + sign * (at.margin + 1e-6) for sign in (1, -1)]
        assert whole or any(clashes(ways, exits, at._replace(north=turn)) for turn in turned)
        for fewer in range(4, at.slots, 2):
            turns = (n * 360 / fewer / 500 for n in range(500))
            free = [turn for turn in turns if not clashes(ways, exits, Layout(fewer, turn, 0))]
            assert not free
        TRIED["layouts of slots compared with trying"] += 1


def test_exits_on_the_border_of_two_slots_are_never_one():
    """Bearings of whole coordinates lie on borders of slots, where rounding might decide."""
    for number in range(3_000):
        draw = random.Random(f"borders {number}")
        spots = draw.sample([(x, y) for x in range(-2, 3) for y in range(-2, 3) if x or y], 5)
        ways = tuple(
            Way((exit_towards("p", (0, 0), spot), exit_towards(f"q{n}", spot, (0, 0))))
            for n, spot in enumerate(spots[: draw.randint(2, 5)])
        )
        asked = draw.choice([(None, None), (8, None), (4, draw.choice([0, 45])), (28, None)])
        try:
            at = layout("drawn", Plan("drawn", ways), *asked)
        except InputError:
            continue
        assert len(links_of(ways, at)) == 2 * len(ways)
        assert not clashes(ways, exits_of(ways), at)
        TRIED["layouts of exits on borders"] += 1
    split = [("a", 45.0, "b", 225.0), ("a", 135.0, "b", 315 - 1e-13), ("a", 270.0, "c", 90.0)]
    ways = tuple(Way((Exit(one, out), Exit(two, back))) for one, out, two, back in split)
    assert len(links_of(ways, layout("split", Plan("split", ways)))) == 6
    with pytest.raises(RuntimeError, match="share a slot"):
        links_of(ways, Layout(2, 0.0, 0.0))


def test_two_short_ways_between_two_places_part(tmp_path):
    """Though both are shorter than the part of them by which directions are taken."""
    graph = nx.MultiGraph(crs="plane")
    for name, x in (("a", 0), ("b", 6), ("c", 300)):
        graph.add_node(name, x=float(x), y=0.0)
    graph.add_edge("a", "b", geometry="LINESTRING (0 0, 3 2, 6 0)")
    graph.add_edge("a", "b", geometry="LINESTRING (0 0, 3 -2, 6 0)")
    graph.add_edge("b", "c")
    loaded = load(write(tmp_path, graph))
    assert (loaded.layout.slots, len(loaded.environment.map.links)) == (4, 6)


@pytest.mark.parametrize("kind", [nx.MultiDiGraph, nx.MultiGraph])
@pytest.mark.parametrize(
    "fault",
    ["None", "LINESTRING EMPTY", "POINT (0 0)", "[5]", "[[0,0],[1]]", "LINESTRING (0 0, x y)"],
)
def test_a_bad_course_is_named_in_any_graph(tmp_path, kind, fault):
    graph = square(kind)
    join(graph, "a", "c", geometry=fault)
    with pytest.raises(InputError, match="the way from place a to c: its geometry"):
        load(write(tmp_path, graph))


def test_a_course_may_be_written_from_either_end_of_both_edges(tmp_path):
    """As networkx writes it that makes a graph directed."""
    graph = square()
    join(graph, "a", "c", geometry="LINESTRING (0 0, 60 30, 100 100)")
    loaded = load(write(tmp_path, graph), two_way=False)
    assert len(loaded.plan.ways) == 5
    graph.add_edge("b", "d", geometry="LINESTRING (400 400, 500 500)")
    said = load(write(tmp_path, graph), two_way=True).warnings
    assert [line.partition(": ")[2] for line in said] == [
        "ways whose course does not end at their places: b to d",
        "one-way ways taken as two-way: 1",
    ]


@pytest.mark.parametrize(
    ("crs", "scale", "degrees"),
    [
        ("EPSG:4326", 0.001, True),
        ("epsg:4283", 0.001, True),
        ("urn:ogc:def:crs:EPSG::4258", 0.001, True),
        ("OGC:CRS84", 0.001, True),
        ("+proj=longlat +datum=WGS84", 0.001, True),
        ("EPSG:32633", 1000, False),
        ("EPSG:4978", 1000, False),
        ('PROJCRS["WGS 84 / UTM zone 33N",BASEGEOGCRS["WGS 84",ID["EPSG",4326]]]', 1000, False),
        ('PROJCS["UTM",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]]', 1000, False),
        ('GEOGCRS["WGS 84",ID["EPSG",4326]]', 0.001, True),
    ],
)
def test_the_crs_says_what_the_coordinates_are(tmp_path, crs, scale, degrees):
    loaded = load(write(tmp_path, square(scale=scale, crs=crs)))
    wanted = "longitude and latitude" if degrees else "plane"
    assert f"coordinates: {wanted}" in loaded.plan.notes
    assert not loaded.warnings


def test_coordinates_that_cannot_be_what_they_are_taken_for(tmp_path):
    with pytest.raises(InputError, match=r"not longitude and latitude \(--plane\)"):
        load(write(tmp_path, square(scale=1000, crs="EPSG:4326")))
    (said,) = load(write(tmp_path, square(scale=0.1, crs="EPSG:9999"))).warnings
    assert "crs epsg:9999 is not known, and is taken to be of a plane (--degrees)" in said.lower()


@pytest.mark.slow
def test_ten_thousand_places_come_to_an_end(tmp_path):
    """A street, where each dstate differs from the others in how far it is to the ends, and a
    star: what is asked of each place must not ask all others, which would take hours."""
    street, star = nx.Graph(crs="plane"), nx.Graph(crs="plane")
    for number in range(10_000):
        street.add_node(number, x=10.0 * number, y=0.0)
        angle = math.radians(2 * number)
        star.add_node(number, x=100 * math.cos(angle), y=100 * math.sin(angle))
    street.add_edges_from((n, n + 1) for n in range(9_999))
    star.add_node("middle", x=0.0, y=0.0)
    star.add_edges_from((n, "middle") for n in range(180))
    world = load(write(tmp_path, street)).environment.map
    known = census(world)
    assert (known.places, known.dead_ends, known.dstates) == (10_000, 2, 19_998)
    assert (known.classes, known.with_compass) == (9_999, 19_998)
    assert load(write(tmp_path, star)).plan.points.keys() == {*map(str, range(180)), "middle"}


def test_what_nothing_parts_is_listed():
    ways = tuple(Way((Exit("p", 90.0), Exit(f"q{n}", 0.0))) for n in range(3))
    with pytest.raises(InputError) as error:
        layout("drawn", Plan("drawn", ways))
    assert str(error.value) == (
        "drawn: up to 360 slots do not separate all ways, however they are turned: place p: the "
        "ways to q0 (90.0 degrees) and q1 (90.0) share slot 90; place p: the ways to q0 (90.0 "
        "degrees) and q2 (90.0) share slot 90"
    )


def test_exits_are_paired_where_that_is_asked_for(tmp_path):
    """Three ways of a place: the two that are most nearly straight are on one path."""
    graph = nx.Graph(crs="plane")
    for name, x, y in (("m", 0, 0), ("n", 5, 100), ("s", 10, -100), ("w", -100, -40)):
        graph.add_node(name, x=float(x), y=float(y))
    graph.add_edges_from([("m", "n"), ("m", "s"), ("m", "w")])
    file = write(tmp_path, graph)
    world = load(file, None, 8, 0, straight=20).environment.map
    assert {(one[1], two[1]) for one, two in world.across.items()} == {(0, 4), (4, 0)}
    assert load(file, None, 8, 0, straight=5).environment.map.across == {}
    made = run(
        "topomap", "generate", "world", file, "--straight", "20", "--slots", "8", "--route", "tour"
    )
    assert "straight(" in made.stdout
    assert parse(made.stdout, "made").straight


def test_a_census_says_what_a_world_is(tmp_path):
    """Its classes of dstates are those of the pairwise definition; and it is printed."""
    for number in range(40):
        world = random_world(random.Random(f"census {number}"))
        every = [*world.gateways()]
        if len(every) != len(world.links):
            continue
        of = classes(world, {gateway: look(world, gateway) for gateway in every})
        for one in every:
            for other in every:
                same = world.indistinguishable(one, world, other)
                assert (of[one] == of[other]) is same
                TRIED["pairs of dstates compared with the definition"] += 1
    told = census(grid(3, 3).map)
    assert (
        told.document() | {"dstates": 24, "classes": 6, "with_compass": 24, "views": 6}
        == told.document()
    )
    assert (told.planar, told.path_axiom, told.exceptions, told.perpendicular) == (
        True,
        None,
        0,
        True,
    )
    file = write(tmp_path, square())
    made = run("topomap", "generate", "world", file, "--route", "tour", "--json")
    assert json.loads(made.stdout)["world"]["places"] == 4
    assert "4 places, 4 ways" in run("topomap", "generate", "world", file, "--route", "tour").stderr


def test_worlds_are_read_in_python_too(tmp_path):
    file = write(tmp_path, square())
    made = topomap.world(file, slots=8, north=45)
    assert made.map.stars["a"] == {1, 7}
    assert topomap.generate(made, route="tour").experience.steps == 4
    with pytest.raises(ValueError, match="north='up'"):
        topomap.world(file, north="up")
    with pytest.raises(TypeError, match="path"):
        topomap.world(7)
