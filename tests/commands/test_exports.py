"""Maps for other tools: each format is read by the tool that it is for, and what can be read
back is the same map."""

import functools
import itertools
import json
import os
import random
import resource
import shutil
import subprocess
from collections import Counter
from dataclasses import replace

import clingo
import networkx as nx
import numpy as np
import pydot
import pytest
import topomap.drawing.layout
from conftest import ROOT, TRIED, lacking, run
from oracles.worlds import WORLDS, random_experience, random_world
from topomap.documents import maps
from topomap.documents.answers import map_json
from topomap.documents.verdicts import verdicts
from topomap.drawing.scenes import Scene
from topomap.exchange import exports, imports
from topomap.model.experience import Experience, observe
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.model.topology import gid
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Watch
from topomap.search.traversal import hypotheses
from topomap.solver import solving

# pydot calls pyparsing by names of old.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:pydot")
PAPER = "grid-3x3-snake", "grid-3x4-paper", "grid-4x4-snake", "manhattan-tour20"
SIGNS = ("a", '"b c"', '"<&\\"\\\\{{x}}{%\\n"', 'f("é",-1)', '"\\\\"')
READ_BACK = {"graphml": exports.graphml, "json": exports.node_link}


@functools.cache
def optimal(name):
    """The best maps of an instance."""
    seen = read(ROOT / "instances" / f"{name}.lp")
    found = solving.best(seen, Query(frozenset()), Watch(), solving.hypotheses)
    last = {}
    for one in filter(None, found):
        last = {**last, one.at: one} if one.proved else {one.at: one}
    return seen, [Scene(seen.map_of(one.at), one.at, name, kind=one.kind) for one in last.values()]


def scene_of(seen, draw):
    """One of the maps of an experience, as a rule one of few places: with loops and parallel
    links, and links that cross."""
    found = hypotheses(seen, Query(frozenset()), Watch())
    found = [one.at for one in itertools.islice(found, 300)]
    places = min(len({place for place, _ in at}) for at in found)
    few = [at for at in found if len({place for place, _ in at}) == places]
    at = draw.choice(few if draw.random() < 0.8 else found)
    return Scene(seen.map_of(at), at, "made.lp")


def signed(seen, draw):
    """The experience with other signs where it has some."""
    marks = {mark: draw.sample(SIGNS, draw.randint(1, 3)) for mark in {*seen.landmarks} if mark}
    landmarks = tuple(frozenset(marks.get(mark, ())) for mark in seen.landmarks)
    return Experience(seen.slots, seen.views, seen.turns, landmarks)


def returned(tmp_path, scene, form):
    """What import makes of an export."""
    file = tmp_path / f"map.{form}"
    file.write_text(READ_BACK[form](scene), encoding="utf-8")
    return json.loads(imports.import_map(str(file)))


def agrees(tmp_path, seen, scene):
    """Export and import give the same map; returns whether it is sound."""
    for form in READ_BACK:
        document = returned(tmp_path, scene, form)
        (entry,) = document["maps"]
        assert entry == json.loads(json.dumps(map_json(scene.world, scene.at)))
        assert document["slots"] == seen.slots
        assert document["instance"] == scene.name
    (verdict,) = verdicts(seen, [maps.document("made", document)], [], None)
    original = json.loads(json.dumps({"maps": [map_json(scene.world, scene.at)]}))
    (other,) = verdicts(seen, [maps.document("made", original)], [], None)
    # Where maps are said to be the best ones, their exceptions are reported, too.
    assert replace(verdict, exceptions=None) == other
    assert not verdict.short
    return verdict.sound


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPER)
def test_best_maps_of_the_instances_return(tmp_path, name):
    seen, scenes = optimal(name)
    for scene in scenes[:3]:
        assert agrees(tmp_path, seen, scene)
        assert returned(tmp_path, scene, "graphml")["kind"] == scene.kind


@pytest.mark.parametrize("name", [name for name in WORLDS if "torus" not in name])
def test_named_worlds_return(tmp_path, name):
    assert agrees(tmp_path, WORLDS[name], scene_of(WORLDS[name], random.Random(name)))


def real(draw, steps):
    """A walk, and the real map, which may have loops; these break the path axiom."""
    world = random_world(draw)
    start = place, _ = draw.choice(sorted(world.links))
    route = []
    for _ in range(steps):
        route.append(draw.choice(sorted(world.stars[place])))
        place, _ = world.links[place, route[-1]]
    seen, at = observe(world, start, route)
    seen = signed(seen, draw)
    return seen, Scene(seen.map_of(at), at, "made.lp")


def kinds_of(scene):
    """What is special about a map."""
    world = scene.world
    pairs = Counter(frozenset([a[0], b[0]]) for a, b in world.edges())
    return {
        "loops": any(len(pair) == 1 for pair in pairs),
        "parallel links": any(number > 1 for pair, number in pairs.items() if len(pair) == 2),
        "signs": any(world.landmarks.values()),
        "many slots": world.slots > 6,
        "links that cross": world.genus() > 0,
        "pending gateways": bool(world.pending()),
    }


@pytest.mark.slow
@pytest.mark.parametrize("cases", [25, pytest.param(1500, marks=pytest.mark.long)])
def test_random_maps_return(tmp_path, cases):
    kinds = Counter()
    for seed in range(cases):
        draw = random.Random(f"exported {seed}")
        seen = signed(random_experience(draw, 9), draw)
        scene = scene_of(seen, draw)
        assert agrees(tmp_path, seen, scene)
        also, truth = real(draw, 12)
        assert agrees(tmp_path, also, truth) == (truth.world.path_axiom_fault() is None)
        kinds.update(kind for one in (scene, truth) for kind, so in kinds_of(one).items() if so)
    assert len(kinds) == 6
    assert min(kinds.values()) > cases / 20, kinds
    TRIED["maps exported and read back"] += 2 * cases


def tangled():
    """A map that is special in every way."""
    draw = random.Random(0)
    while True:
        _, scene = real(draw, 7)
        if all(kinds_of(scene).values()) and len(scene.world.stars) < 4:
            return scene


SCENES = {
    "tangled": tangled,
    "a grid": lambda: optimal("grid-3x4-paper")[1][0],
    "a start alone": lambda: scene_of(WORLDS["a start alone, of twelve"], random.Random(0)),
}


@pytest.fixture(params=list(SCENES))
def scene(request):
    return made(request.param)


LAID = {}
lay_out = topomap.drawing.layout.layout


def layout(world, ahead):
    """Where everything is, found once: it takes its time."""
    key = id(world), ahead
    if key not in LAID:
        LAID[key] = world, lay_out(world, ahead)
    return LAID[key][1]


def laid_out(scene):
    """Where everything of a scene is."""
    return layout(scene.world, scene.ahead)


@functools.cache
def made(name):
    return SCENES[name]()


def test_graphml_is_what_networkx_reads(tmp_path, scene):
    file = tmp_path / "map.graphml"
    file.write_text(exports.graphml(scene), encoding="utf-8")
    graph = nx.read_graphml(file, node_type=int, force_multigraph=True)
    lists(graph)
    is_the_graph(graph, scene)


def test_json_is_what_networkx_reads(scene):
    is_the_graph(nx.node_link_graph(json.loads(exports.node_link(scene)), edges="edges"), scene)


def lists(graph):
    for attributes in (graph.graph, *graph.nodes.values(), *graph.edges.values()):
        for key in {"at", "gateways", "landmarks", "ends", "steps", "back"} & set(attributes):
            attributes[key] = json.loads(attributes[key])


def is_the_graph(graph, scene):
    world = scene.world
    assert isinstance(graph, nx.MultiGraph)
    assert not graph.is_directed()
    assert {k: v for k, v in graph.graph.items() if not k.endswith("_default")} == {
        "name": scene.name,
        "kind": scene.kind,
        "slots": world.slots,
        "genus": world.genus(),
        "at": [[step, *dstate] for step, dstate in enumerate(scene.at)],
    }
    assert list(graph.nodes) == list(world.stars)
    for place, attributes in graph.nodes.items():
        assert attributes == {
            "gateways": sorted(world.stars[place]),
            "landmarks": sorted(world.landmarks[place]),
        }
    links, travelled = [], {}
    for one, other, told in graph.edges(data=True):
        a, b = map(tuple, told["ends"])
        links.append((a, b))
        assert {one, other} == {a[0], b[0]}
        travelled |= dict.fromkeys(told["steps"], (a, b))
        travelled |= dict.fromkeys(told["back"], (b, a))
    assert sorted(links) == sorted(world.edges())
    assert sorted(travelled) == list(range(1, len(scene.at)))
    for step, (out, arrival) in travelled.items():
        assert (out[0], arrival) == (scene.at[step - 1][0], scene.at[step])


def bare(text):
    """A name or a value as DOT says it, without its quotes."""
    return text[1:-1].replace('\\"', '"') if text[:1] == '"' else text


def numbers(text):
    return np.array([[float(n) for n in bit.split(",")] for bit in text.rstrip("!").split()])


def between_circles(line, ends):
    """A line without what is inside the circles of radius 0.15 at its first ends."""
    for _ in range(ends):
        length = np.linalg.norm(line[1] - line[0])
        start = line[0] + (line[1] - line[0]) * min(0.15 / length, 0.5)
        line = np.array([start, *line[1:]])[::-1]
    return line if ends == 2 else line[::-1]


def is_the_drawing(nodes, edges, scene, name, stub):
    """Nodes and edges of DOT, their attributes by name, are the map where layout has it.
    ``name`` names a place, ``stub`` the end of a stub."""
    world = scene.world
    laid = layout(world, world.links[scene.at[1]] if len(scene.at) > 1 else None)
    places = {name(place): point for place, point in laid.places.items()}
    stubs = {stub(gateway): laid.lines[gateway][-1] for gateway in world.pending()}
    assert set(nodes) == {*places, *stubs}
    for node, point in {**places, **stubs}.items():
        assert nodes[node]["pos"][-1] == "!"
        assert np.allclose(numbers(nodes[node]["pos"]), 72 * point, atol=0.02)
    crossing = {end for link in laid.crossing for end in link}
    wanted = Counter()
    for a, b in world.edges():
        wanted[name(a[0]), name(b[0]), str(a[1]), str(b[1])] += 1
    for a in world.pending():
        wanted[name(a[0]), stub(a), str(a[1]), None] += 1
    assert wanted == Counter(
        (a, b, told["taillabel"], told.get("headlabel")) for a, b, told in edges
    )
    gateways = {(name(place), str(slot)): (place, slot) for place, slot in world.gateways()}
    for a, _, told in edges:
        gateway = gateways[a, told["taillabel"]]
        assert (told.get("style") == "dashed") is (gateway in crossing)
        spline = numbers(told["pos"])
        line = between_circles(laid.lines[gateway], 2 if gateway in world.links else 1)
        assert np.allclose(spline[::3], 72 * line, atol=0.02)
        thirds = (2 * spline[:-1:3] + spline[3::3]) / 3
        assert np.allclose(spline[1::3], thirds, atol=0.02)
    steps = [
        step
        for _, _, told in edges
        for key in ("steps", "back")
        for step in told.get(key, "").split()
    ]
    assert sorted(map(int, steps)) == list(range(1, len(scene.at)))


def test_dot_is_what_pydot_reads(scene):
    (graph,) = pydot.graph_from_dot_data(exports.dot(scene, laid_out(scene)))
    assert graph.get_type() == "graph"
    nodes = {bare(node.get_name()): read_attributes(node) for node in graph.get_node_list()}
    default = nodes.pop("node")
    assert default["shape"] == "circle"
    (about,) = (read_attributes(node) for name, node in [("graph", graph.get_node("graph")[0])])
    nodes.pop("graph")
    assert about["inputscale"] == "72"
    assert about["label"].split("\\n")[0].startswith(scene.title.split("\n")[0])
    edges = [
        (bare(edge.get_source()), bare(edge.get_destination()), read_attributes(edge))
        for edge in graph.get_edge_list()
    ]
    is_the_drawing(nodes, edges, scene, str, gid)
    for place, signs in scene.world.landmarks.items():
        told = nodes[str(place)].get("xlabel", "").replace("\\\\", "\\")
        assert told == ", ".join(sorted(signs))


def read_attributes(element):
    return {key: bare(value) for key, value in element.get_attributes().items()}


def test_neato_draws_it_there(scene):
    if not shutil.which("neato"):
        lacking("GRAPHVIZ", "neato, of Graphviz, is not installed")
    plain = subprocess.run(
        ["neato", "-n2", "-Tplain"],
        input=exports.dot(scene, laid_out(scene)),
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    found = [line.split() for line in plain.splitlines() if line.startswith("node")]
    points = {name: np.array([float(x), float(y)]) for _, name, x, y, *_ in found}
    laid = layout(scene.world, scene.world.links[scene.at[1]] if len(scene.at) > 1 else None)
    first = next(iter(laid.places))
    for place, point in laid.places.items():
        moved = points[str(place)] - points[str(first)]
        assert np.allclose(moved, point - laid.places[first], atol=0.02)
    drawn = [line.split() for line in plain.splitlines() if line.startswith("edge ")]
    wanted = [gateway for gateway, _ in scene.world.edges()] + scene.world.pending()
    assert len(drawn) == len(wanted)
    crossing = [out for out, _ in laid.crossing]
    for gateway in wanted:  # in neato's order they are by their ends
        end = scene.world.links.get(gateway)
        ends = ["edge", str(gateway[0]), str(end[0]) if end else gid(gateway)]
        line = between_circles(laid.lines[gateway], 2 if end else 1)
        line += points[str(first)] - laid.places[first]
        style = "dashed" if gateway in crossing else "solid"
        assert any(
            edge[:3] == ends
            and edge[-2] == style
            and int(edge[3]) == 3 * len(line) - 2
            and np.allclose(np.array(edge[4:-2], float).reshape(-1, 2)[::3], line, atol=0.02)
            for edge in drawn
        )


@pytest.mark.slow
def test_facts_are_what_clingraph_reads(scene):
    from clingraph import Factbase, compute_graphs

    facts = exports.clingraph(scene, laid_out(scene))
    base = Factbase()
    base.add_fact_string(facts)
    (graph,) = compute_graphs(base).values()
    (parsed,) = pydot.graph_from_dot_data(graph.source)
    nodes = {bare(node.get_name()): read_attributes(node) for node in parsed.get_node_list()}
    assert nodes.pop("node")["shape"] == "circle"
    assert nodes.pop("graph")["inputscale"] == "72"
    edges = [
        (bare(edge.get_source()), bare(edge.get_destination()), read_attributes(edge))
        for edge in parsed.get_edge_list()
    ]
    is_the_drawing(nodes, edges, scene, str, lambda gateway: f"({gateway[0]},{gateway[1]})")
    for place, signs in scene.world.landmarks.items():
        told = nodes[str(place)].get("xlabel", "").replace("\\\\", "\\")
        assert told == ", ".join(sorted(signs))


def test_facts_are_of_the_predicates_of_clingraph(scene):
    control = clingo.Control(logger=lambda _, text: pytest.fail(text))
    control.add(exports.clingraph(scene, laid_out(scene)))
    control.ground()
    found = Counter(
        (atom.symbol.name, len(atom.symbol.arguments)) for atom in control.symbolic_atoms
    )
    assert set(found) <= {("node", 1), ("edge", 1), ("attr", 4)}
    assert found["node", 1] == len(scene.world.stars) + len(scene.world.pending())
    assert found["edge", 1] == len(scene.world.edges()) + len(scene.world.pending())


def spoilt(change):
    """A grid as node-link JSON, changed."""
    graph = json.loads(exports.node_link(optimal("grid-3x3-snake")[1][0]))
    change(graph)
    return json.dumps(graph)


FOREIGN = {
    "nothing": ("", "not a graph in JSON"),
    "a list": ("[]", "not a graph in JSON"),
    "no graph": ("{}", "not a graph in JSON"),
    "deep": ("[" * 10**5, "not a graph in JSON"),
    "maps": ('{"maps": []}', "not a graph in JSON"),
    "directed": (spoilt(lambda g: g.update(directed=True)), "not a map, as topomap export"),
    "a number for a graph": (spoilt(lambda g: g.update(graph=3)), "no slots, or no route"),
    "no slots": (spoilt(lambda g: g["graph"].pop("slots")), "no slots, or no route"),
    "no route": (spoilt(lambda g: g["graph"].pop("at")), "no slots, or no route"),
    "an empty route": (
        spoilt(
            lambda g: [g["graph"].update(at=[]), [e.update(steps=[], back=[]) for e in g["edges"]]]
        ),
        "no route in it",
    ),
    "another route": (spoilt(lambda g: g["graph"]["at"].pop()), "do not fit"),
    "a step left out": (spoilt(lambda g: g["graph"]["at"].pop(3)), "steps of at are not 0, 1, 2"),
    "a leap": (spoilt(lambda g: g["graph"]["at"][3].__setitem__(1, 0)), "links that are not there"),
    "odd slots": (spoilt(lambda g: g["graph"].update(slots=5)), "even number"),
    "slots of text": (spoilt(lambda g: g["graph"].update(slots="4")), "slots: not what"),
    "another genus": (spoilt(lambda g: g["graph"].update(genus=3)), "do not fit"),
    "a gateway less": (
        spoilt(lambda g: g["nodes"][4]["gateways"].pop()),
        "has two links, or does not exist",
    ),
    "no gateways": (spoilt(lambda g: g["nodes"][0].pop("gateways")), "not as solve --json"),
    "a link less": (spoilt(lambda g: g["edges"].pop()), "links that are not there"),
    "a link twice": (
        spoilt(lambda g: g["edges"].append({**g["edges"][0], "key": 99})),
        "two links",
    ),
    "other ends": (spoilt(lambda g: g["edges"][0].update(source=4)), "do not fit"),
    "other steps": (spoilt(lambda g: g["edges"][0].update(steps=[9])), "do not fit"),
    "a list of text": (spoilt(lambda g: g["edges"][0].update(ends="[")), "ends is not a list"),
    "a sign of text": (spoilt(lambda g: g["nodes"][0].update(landmarks="a")), "not a list"),
    "no xml": ("<", "not a GraphML file"),
    "an entity": (
        '<!DOCTYPE a [<!ENTITY b "c">]><graphml/>',
        "document type or entities",
    ),
    "a street network": (
        "\n".join(nx.generate_graphml(nx.path_graph(3, nx.MultiDiGraph))),
        "not a map, as topomap export",
    ),
    "names of nodes": (
        "\n".join(nx.generate_graphml(nx.Graph([("a", "b")], slots=4, at="[]"))),
        "not a GraphML file that networkx reads",
    ),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_foreign_and_broken_files_are_refused(tmp_path, name):
    text, fault = FOREIGN[name]
    file = tmp_path / "map"
    file.write_text(text)
    with pytest.raises(InputError, match=fault) as error:
        imports.import_map(str(file))
    assert str(error.value).startswith(f"{file}: ")
    assert "\n" not in str(error.value)


def test_what_other_tools_add_is_left_out(tmp_path):
    file = tmp_path / "map.json"
    (scene, *_) = optimal("grid-3x3-snake")[1]

    def painted(graph):
        graph["graph"]["colour"] = "red"
        for number, part in enumerate(graph["nodes"] + graph["edges"]):
            part.update(x=number, label="a")

    file.write_text(spoilt(painted))
    assert json.loads(imports.import_map(str(file))) == returned(tmp_path, scene, "json")


@pytest.mark.slow
def test_the_commands(topomap, tmp_path):
    instance = "instances/grid-3x4-paper.lp"
    for form in ("graphml", "json"):
        graph, made = tmp_path / f"map.{form}", tmp_path / f"{form}.json"
        call = "export", instance, "--map", "3", "--format", form, "-o", graph
        assert topomap(*call).returncode == 0
        assert topomap("import", graph, "-o", made).returncode == 0
    checked = topomap("check", instance, made)
    assert (checked.returncode, checked.stdout) == (0, "1 map, none unsound\n")
    again = topomap("export", made, "--format", form)
    assert (again.returncode, again.stdout) == (0, graph.read_text())
    assert (tmp_path / "graphml.json").read_text() == (tmp_path / "json.json").read_text()
    broken = tmp_path / "broken"
    broken.write_text("{}")
    done = topomap("import", broken, "-o", tmp_path / "none.json")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert not (tmp_path / "none.json").exists()


@pytest.mark.parametrize("form", ["graphml", "dot"])
def test_the_same_bytes(topomap, form):
    runs = [
        topomap(
            "export",
            "instances/grid-3x3-snake.lp",
            "--planar",
            "--format",
            form,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in "12"
    ]
    assert runs[0] == runs[1] != ""


def asked_of_maps(tmp_path, content, *arguments):
    """What ``show`` says of a text of maps."""
    file = tmp_path / "maps.json"
    file.write_text(json.dumps(content))
    return run("topomap", "show", file, *arguments)


def document(change=lambda document, entry: None):
    """A grid's best map as solve --json writes it, changed."""
    (scene, *_) = optimal("grid-3x3-snake")[1]
    entry = json.loads(json.dumps(map_json(scene.world, scene.at)))
    made = {"slots": 4, "maps": [entry], "kind": "optimal", "optimal": True, "complete": True}
    change(made, entry)
    return made


@pytest.mark.parametrize("part", [["--planar"], ["--bound", "3"], ["--horizon", "2"]])
def test_parts_of_maps_that_are_there_already_are_refused(tmp_path, part):
    done = asked_of_maps(tmp_path, document(), *part)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "these are maps" in done.stderr
    assert asked_of_maps(tmp_path, document(), "--timeout", "9").returncode == 0


@pytest.mark.parametrize(
    ("change", "title"),
    [
        (lambda made, _: None, "the only optimal map"),
        (lambda made, _: made.update(complete=False), "map 1 of 1 found, optimal"),
        (lambda made, _: made.pop("complete"), "map 1 of 1 found, optimal"),
        (
            lambda made, _: made.update(kind="closed, best-first", optimal=False),
            "map 1 of 1 found, closed, best-first",
        ),
        (lambda made, entry: made["maps"].append(entry), "map 1 of 2, optimal"),
    ],
)
def test_a_title_says_the_only_map_where_there_is_no_other(tmp_path, change, title):
    done = asked_of_maps(tmp_path, document(change))
    assert done.stdout.split("\n")[0] == f"maps: {title}"


def test_an_imported_map_is_not_said_to_be_the_only_one(tmp_path):
    (scene, *_) = optimal("grid-3x3-snake")[1]
    imported = returned(tmp_path, scene, "json")
    assert (imported["complete"], imported["fault"]) == (False, "a single map, imported")
    assert "map 1 of 1 found, optimal" in asked_of_maps(tmp_path, imported).stdout


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda _, entry: entry["places"].append(entry["places"][0]), "places or links are not"),
        (lambda _, entry: entry["at"].pop(3), "the steps of at are not"),
        (lambda _, entry: entry["at"].append(entry["at"][-1]), "the steps of at are not"),
        (lambda _, entry: entry["at"].append([99, *entry["at"][-1][1:]]), "the steps of at are"),
    ],
)
def test_maps_that_contradict_themselves_are_refused(tmp_path, change, fault):
    done = asked_of_maps(tmp_path, document(change))
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert fault in done.stderr


@pytest.mark.parametrize("megabytes", [170, 230, 300])
@pytest.mark.parametrize(
    "call", [("show",), ("export", "--format", "dot"), ("draw", "-o", "none.svg")]
)
def test_too_little_memory_is_said_at_once(tmp_path, call, megabytes):
    """Once libraries were loaded without room for them: OpenBLAS hung, or there was no symbol."""
    file = tmp_path / "maps.json"
    file.write_text(json.dumps(document()))
    limit = functools.partial(
        resource.setrlimit, resource.RLIMIT_AS, (megabytes << 20, megabytes << 20)
    )
    done = run("topomap", call[0], file, *call[1:], preexec_fn=limit, timeout=20)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == "topomap: out of memory\n"
    assert not (ROOT / "none.svg").exists()


@pytest.mark.parametrize(
    ("form", "title"),
    [("dot", r'"a\\nb: the only optimal map'), ("clingraph", r'"a\\\\nb: the only optimal map')],
)
def test_a_line_break_in_a_name_breaks_no_title(form, title):
    scene = replace(optimal("grid-3x3-snake")[1][0], name="a\nb", whole=True)
    assert exports.DRAWN[form](scene, laid_out(scene)).count(title) == 1
    assert scene.title.count("\n") == 1
