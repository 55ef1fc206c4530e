"""Worlds from street networks in GraphML."""

import os

import networkx as nx
import pytest
from conftest import SHARED, run
from topomap.model.facts import parse
from topomap.runtime.errors import InputError
from topomap.worlds.environment import grid
from topomap.worlds.files import load


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
        graph.add_edge(one, two)
    return graph


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
    graph.add_edge("b", "a")
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


def test_without_a_crs_the_guess_is_told(tmp_path):
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
    graph.add_edge("a", "b")
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


def test_parallel_ways_and_parts_are_told(tmp_path):
    graph = square()
    graph.add_edge("a", "b")
    with pytest.raises(InputError, match=r"place a: the ways to b and b .* straight"):
        load(write(tmp_path, graph), None, 4, 0)
    apart = nx.disjoint_union(square(), square(scale=70))
    assert "not connected" in load(write(tmp_path, apart), None, 4, 0)[1][0]


def test_degrees_are_scaled_by_the_latitude(tmp_path):
    """At 60 degrees north a degree of longitude is half one of latitude: what looks like
    a bearing of 63 degrees is one of 45."""
    graph = nx.DiGraph(crs="epsg:4326")
    graph.add_node("a", x=20.0, y=60.0)
    graph.add_node("b", x=20.01, y=60.005)
    graph.add_edge("a", "b")
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {2}
    graph.graph["crs"] = "+proj=utm +zone=34"
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {3}
    graph.graph.clear()
    assert load(write(tmp_path, graph), None, 16, 0)[0].map.stars["a"] == {2}
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
        (broken(d={"x": 1.0, "y": 200.0}), "fall into one slot"),
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
    graph.add_edge("a", "e")
    with pytest.raises(
        InputError, match=r"place a: the ways to b and e fall into one slot, 0 of 4"
    ):
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
    made, warnings, *_ = load(file, None, 4, 29)
    assert not warnings
    assert (len(made.map.stars), len(made.map.edges()), made.map.genus()) == (46, 73, 0)
    assert made.map.path_axiom_fault() is None
