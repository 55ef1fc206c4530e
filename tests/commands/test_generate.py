"""Worlds, explorations of them, and the instances that come out."""

import json
import random

import networkx as nx
import pytest
from conftest import ROOT, SHARED, answers, run
from topomap.model.facts import parse
from topomap.runtime.errors import InputError
from topomap.worlds.environment import environment, grid, lattice, maze
from topomap.worlds.instance import instance
from topomap.worlds.route import COMPASS, letters, snake
from topomap.worlds.senses import Senses
from topomap.worlds.tours import tour


def compass(route):
    return "".join(COMPASS[4][slot] for slot in route)


def test_snakes_are_the_papers():
    assert compass(snake(grid(3, 3))) == "EESWWSEENNWSSWNN"
    assert len(snake(grid(4, 4))) == 30
    assert compass(snake(grid(4, 4)))[:15] == "EEESWWWSEEESWWW"
    assert len(snake(grid(3, 4))) == 22


@pytest.mark.parametrize(
    ("text", "slots", "route"),
    [
        ("ESSENN", 4, [1, 2, 2, 1, 0, 0]),
        ("ESSENN", 8, [2, 4, 4, 2, 0, 0]),
        ("N,NE,E,SW", 8, [0, 1, 2, 5]),
        ("NE", 4, [0, 1]),
        ("NE", 8, [1]),
        ("0,3,1", 6, [0, 3, 1]),
        ("2", 4, [2]),
    ],
)
def test_routes_as_text(text, slots, route):
    assert letters(text, slots) == route


@pytest.mark.parametrize(("text", "slots"), [("EXN", 4), ("ES", 6), ("", 4), ("1,,2", 4), ("e", 4)])
def test_routes_refused(text, slots):
    with pytest.raises(InputError, match="route"):
        letters(text, slots)


@pytest.mark.parametrize(
    "made",
    [
        grid(3, 4),
        grid(2, 3, "cylinder"),
        grid(2, 3, "crescents"),
        grid(3, 3, "torus"),
        maze(4, 4, 0.5, 3),
        lattice("hexagons", 2, 2),
        lattice("triangles", 2, 3),
    ],
    ids=lambda made: made.name,
)
def test_a_tour_takes_every_way_and_returns(made):
    start = place = min(made.map.stars)
    taken = set()
    for slot in tour(made.map, start):
        taken |= {(place, slot), made.map.links[place, slot]}
        place = made.map.links[place, slot][0]
    assert taken == set(made.map.links)
    assert place == start


def test_mazes_are_connected_and_thinned():
    whole = len(grid(5, 5).map.edges())
    made = maze(5, 5, 0.25, 7).map
    assert len(made.edges()) == whole - round(0.25 * whole)
    assert nx.is_connected(nx.Graph((a[0], b[0]) for a, b in made.edges()))
    tree = maze(5, 5, 1.0, 7).map
    assert len(tree.edges()) == len(tree.stars) - 1
    assert maze(5, 5, 0.25, 7).map == made != maze(5, 5, 0.25, 8).map


def test_lattices_have_their_degrees():
    assert {len(star) for star in lattice("hexagons", 3, 3).map.stars.values()} == {2, 3}
    assert max(len(star) for star in lattice("triangles", 3, 5).map.stars.values()) == 6


def test_signs_are_drawn_as_promised():
    made = grid(5, 5).signed(0.3, 4)
    drawn = random.Random(4).sample(sorted(made.map.stars), round(0.3 * 25))
    assert set(made.map.landmarks) == set(drawn)
    assert made.map.landmarks[drawn[0]] == {f"({drawn[0][0]},{drawn[0][1]})"}


@pytest.mark.parametrize("seed", range(30))
def test_a_tour_is_that_of_networkx(seed):
    """Its own way to double ways, which can be ended, doubles the same ones."""
    draw = random.Random(seed)
    kind = draw.choice(["grid", "torus", "cylinder", "crescents", "maze", "hexagons", "triangles"])
    size = draw.randint(2, 6), draw.randint(2, 6)
    made = environment(kind, *size, thin=draw.random(), seed=seed).map
    graph = nx.MultiGraph()
    graph.add_nodes_from(made.stars)
    for a, b in sorted(made.edges()):
        graph.add_edge(a[0], b[0], key=a)
    start = draw.choice(sorted(made.stars))
    places = [start]
    for slot in tour(made, start):
        places.append(made.links[places[-1], slot][0])
    circuit = nx.eulerian_circuit(nx.eulerize(graph), source=start)
    assert [start, *(there for _, there in circuit)] == places


@pytest.mark.parametrize(
    ("made", "route", "options"),
    [
        (grid(3, 3), "walk", {"steps": 9, "seed": 1, "signs": 0.5}),
        (lattice("hexagons", 1, 2), "walk", {"steps": 9, "start": "0,1", "facing": None}),
        (grid(2, 3), "snake", {"facing": 2}),
        (maze(3, 3, 0.4, 1), "tour", {"start": "1,1", "steps": 8}),
    ],
    ids=["grid", "hexagons", "facing", "maze"],
)
def test_the_truth_is_among_the_maps(made, route, options):
    record = instance(made, route, **options)
    assert record.truth in answers((), record.experience.facts())
    assert parse(record.text(), "text") == record.experience
    assert record.text() == instance(made, route, **options).text()


def test_headers_and_names_tell_how():
    record = instance(grid(3, 4), "walk", steps=5, seed=2, signs=0.25)
    assert record.name == "grid-3x4-walk5-signs25-seed2"
    assert record.header[-1] == (
        "made by: topomap generate grid 3 4 --route walk --steps 5 --signs 0.25 --seed 2"
    )
    assert "breaks" not in record.text()
    assert "breaks the path axiom" in instance(grid(3, 3, "torus"), "N").text()


def test_which_option_keeps_the_real_map_is_said(topomap):
    done = topomap("generate", "torus", 3, 3, "--route", "NN")
    assert done.returncode == 0
    assert done.stderr == (
        "torus-3x3-NN: the environment's own map breaks the path axiom; "
        "only --no-path-axiom finds it\n"
    )
    assert topomap("generate", "crescents", 1, 2, "--route", "E").stderr == ""


def test_crescents_join_columns():
    """Of three columns the first two are one path, which meets both rows twice; once round a
    crescent the moves sum to nothing."""
    made = grid(2, 3, "crescents")
    assert made.map.path_axiom_fault() is None
    twice = [one for one in made.map.exceptions() if one.kind == "meet twice"]
    assert sorted(one.places for one in twice) == [((row, 0), (row, 1)) for row in range(2)]
    assert made.map.genus() == 0
    record = instance(made, "0,3", senses=Senses(odometry=0))
    assert record.experience.map_of(record.truth).links == {(0, 0): (1, 0), (1, 0): (0, 0)} | {
        (1, 3): (0, 1),
        (0, 1): (1, 3),
    }
    assert [sum(one) for one in zip(*record.experience.shifts, strict=True)] == [0, 0]


def test_the_call_in_a_header_makes_the_same_bytes(tmp_path):
    made = run(
        "topomap",
        *["generate", "maze", "4", "3", "--thin", "0.4", "--route", "tour", "--seed", "5"],
    )
    call = made.stdout.partition("made by: topomap ")[2].partition("\n")[0]
    file = tmp_path / "again.lp"
    assert run("topomap", *call.split(), "-o", file).returncode == 0
    assert file.read_text() == made.stdout
    folder = run("topomap", *call.split(), "-o", tmp_path, "--json")
    summary = json.loads(folder.stdout)
    assert summary["complete"] is True
    assert (tmp_path / f"{summary['name']}.lp").read_text() == made.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        "grid 3 3 --route snake",
        "grid 3 4 --route ESSENNESSWWWNEEENWWWS --name grid-3x4-paper",
        "grid 4 4 --route snake",
        "world MAP --slots 4 --north 29 --two-way --route tour --steps 20",
        "world MAP --slots 4 --north 29 --two-way --route tour --steps 40 --signs 0.3",
        "world MAP --slots 4 --north 29 --two-way --route tour --signs 0.3",
    ],
)
def test_committed_instances_are_as_generated(arguments):
    file = SHARED / "manhattan.graphml"
    if "MAP" in arguments and not file.exists():
        pytest.skip(f"the real map is not here: {file}")
    words = [str(file) if word == "MAP" else word for word in arguments.split()]
    made = run("topomap", "generate", *words)
    name = made.stdout.split()[1]
    assert (ROOT / "instances" / f"{name}.lp").read_text() == made.stdout


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ("grid 1 1 --route N", "a way between two places"),
        ("grid 2 2 --route EE", "step 2: no way E from place 0,1"),
        ("grid 2 2 --route 7", "step 1: no way slot 7 from place 0,0"),
        ("grid 2 2 --route snake --start 5,5", "no place '5,5'"),
        ("grid 2 2 --route snake --facing 0", "place 0,0 has no gateway 0"),
        ("grid 2 2 --route snake --steps 99", "ends after 6 steps"),
        ("grid 2 2 --route walk", "needs --steps"),
        ("hexagons 1 1 --route snake", "rows and columns"),
        ("grid 0 2 --route snake", "1 or more"),
        ("grid 2 2 --route snake --signs 2", "from 0 to 1"),
        ("maze 3 3 --route E --thin x", "--thin"),
        ("castle 3 3 --route E", "castle"),
        ("grid 2 2", "--route"),
        ("grid 2 2 --route E -o /no/such/folder/x.lp", "/no/such/folder/x.lp: no such file"),
    ],
)
def test_generate_refuses_in_one_line(topomap, arguments, fault):
    done = topomap("generate", *arguments.split())
    assert (done.returncode, done.stdout) == (2, "")
    assert fault in done.stderr
    assert done.stderr.count("\n") == 1
