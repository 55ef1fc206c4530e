"""Worlds from files of several formats, and worlds and maps written for other tools."""

import json
import random
import resource
from dataclasses import replace

import pytest
import topomap
import yaml
from conftest import ROOT, run
from oracles.worlds import random_world
from topomap.documents import maps
from topomap.drawing.layout import layout
from topomap.drawing.scenes import of_document
from topomap.exchange import exports
from topomap.exchange.worlds import FORMS, WRITERS, points_of, world_text
from topomap.model.facts import parse
from topomap.model.topology import TopologicalMap, label
from topomap.runtime.errors import InputError
from topomap.worlds import readers
from topomap.worlds.courses import layout as slots_of
from topomap.worlds.courses import world_of
from topomap.worlds.environment import Environment, grid, lattice
from topomap.worlds.files import load
from topomap.worlds.plan import Reading

FILES = ROOT / "tests/files"
FORMATS = {
    "museum.world": "facts",
    "ring.json": "nodelink",
    "greenhouse.yaml": "tmap2",
    "manor.trizbort": "trizbort",
    "bend.maps.json": "mapjson",
}
NAMES = ["a\"b'c", "é 東", "back\\slash", " x ", "<&>", "{{x}}", "- a: b", "#", "yes", "%", "[1]"]


def read(tmp_path, text, reading=None, name="w.x"):
    """The plan in a file of this text."""
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return readers.read(file, reading or Reading())


def world(plan):
    """The world of a plan by the slots that its file tells."""
    return world_of(plan, slots_of("w", plan))


def refused(tmp_path, text):
    """The one line by which a file is refused."""
    with pytest.raises(InputError) as caught:
        load(tmp_path / "w.x", Reading()) if read(tmp_path, text) else None
    said = str(caught.value)
    assert "\n" not in said
    assert str(tmp_path) in said
    return said.split("w.x", 1)[1]


def relabelled(made):
    """A world whose places are their labels, as texts."""
    return TopologicalMap(
        made.slots,
        {label(place): star for place, star in made.stars.items()},
        {(label(p), s): (label(q), r) for (p, s), (q, r) in made.links.items()},
        {label(place): signs for place, signs in made.landmarks.items() if signs},
        None
        if made.across is None
        else {(label(p), s): (label(q), r) for (p, s), (q, r) in made.across.items()},
    )


# What the files say.


@pytest.mark.parametrize(("file", "form"), FORMATS.items())
def test_each_format_is_known_by_its_content(tmp_path, file, form, monkeypatch):
    content = (FILES / file).read_bytes()
    for name in FORMATS | {"x": 0, "x.lp": 0, "x.graphml": 0}:
        for before in b"", b"\xef\xbb\xbf", b"" if content[:1] == b"<" else b"\n \n":
            fits = [
                known
                for known in readers.FORMATS
                if __import__(f"topomap.worlds.readers.{known}", fromlist="x").fits(
                    name, before + content
                )
            ]
            assert fits == [form], (name, before)


def test_facts_keep_the_exact_slots():
    loaded = load(FILES / "museum.world", Reading())
    made = loaded.environment
    assert made.map.slots == 8
    assert made.map.links == {
        ("hall", 2): ("east", 6),
        ("east", 6): ("hall", 2),
        ("hall", 0): ("north", 4),
        ("north", 4): ("hall", 0),
        ("east", 0): ("north", 2),
        ("north", 2): ("east", 0),
    }
    assert made.map.landmarks == {"hall": {"fountain"}}
    assert made.moves["hall", 0] == (0, 15.5)
    assert made.moves["north", 4] == (0, -15.5)
    assert loaded.plan.names == {"hall": "Hall", "east": "Vases", "north": "Coins"}
    named = load(FILES / "museum.world", Reading(landmarks=True)).environment.map
    assert named.landmarks == {
        "hall": {"fountain", '"Hall"'},
        "east": {'"Vases"'},
        "north": {'"Coins"'},
    }


def test_facts_tell_what_is_on_one_path(tmp_path):
    facts = 'slots(4). link("a b",0,"c",1). link("c",0,"d",2).'
    assert world(read(tmp_path, facts)).across is None
    made = world(read(tmp_path, f'{facts} straight("c",1,0). straight("d",2,2).'))
    assert made.across == {("c", 1): ("c", 0), ("c", 0): ("c", 1)}
    assert {*made.stars} == {"a b", "c", "d"}
    numbers = world(read(tmp_path, "slots(4). link(2,0,10,1)."))
    assert [*numbers.stars] == [2, 10]


FAULTS = {
    "slots(4).\nlink(a,0,b,1).\nlink(a,0,c,1).": ":3: link(a,0,c,1): gateway 0 of place a has two",
    "slots(4).\nlink(a,0,b,4).": ":2: slot 4 of place b is not in 0..3",
    "slots(4).\nlink(a,0,b,-1).": ":2: slot -1 of place b is not in 0..3",
    "slots(5). link(a,0,b,1).": ":1: slots(5): K must be even",
    "slots(4).\nslots(6).": ":2: slots(6): line 1 has slots(4)",
    "link(a,0,b,1).": ": no fact slots(K)",
    "slots(4).": ": no ways in it",
    "slots(4). link(a,0,a,0).": ":1: link(a,0,a,0): it links a gateway to itself",
    'slots(4). link(a,"0",b,0).': "slots are whole numbers",
    "slots(4).\nlink(a,0,b,1).\nview(0,0).": ":3: view(0,0) is not a fact over slots(K), link(P,S",
    "slots(4). link(a,0,b).": ":1: link(a,0,b) is not a fact over",
    "slots(4). link(a,0,b,1": "does not end",
    "slots(4). link(X,0,b,1).": "is not a ground fact",
    "slots(4). link(a,0,b,1..2).": "is not a ground fact",
    "slots(4). link(a,0,b,99999999999).": "is not a plain fact",
    'slots(4). link(a,0,b,1).\nlink("a",2,b,3).': ':2: link("a",2,b,3): "a" and a are two places',
    "slots(4). link(a,0,b,1).\nname(c,x).": ":2: place c has no link",
    "slots(4). link(a,0,b,1).\nname(a,x). name(a,y).": ":2: name(a,y): the place has another name",
    'slots(4). link(a,0,b,1). coordinates(a,"x",1).': "coordinates are whole numbers",
    'slots(4). link(a,0,b,1). coordinates(a,"1e99",1).': "coordinates are whole numbers",
    "slots(4). link(a,0,b,1).\nstraight(a,0,1).": ":2: straight: gateway 1 of place a has no link",
    "slots(4). link(a,0,b,1). link(a,1,c,1). link(a,2,d,1).\nstraight(a,0,1). straight(a,0,2).": (
        ":2: straight(a,0,2): gateway 0 is in another pair"
    ),
    "#script (python) import os #end. link(a,0,b,1).": "is not a ground fact",
    '#include "/etc/passwd". link(a,0,b,1).': "is not a ground fact",
    f"slots(4). link({'f(' * 10000}a{')' * 10000},0,b,1).": "nested deeper",
}


@pytest.mark.parametrize(("facts", "said"), FAULTS.items())
def test_faults_of_facts_are_reported_with_their_line(tmp_path, facts, said):
    assert said in refused(tmp_path, facts)


def test_a_link_may_be_given_from_both_ends(tmp_path):
    once = world(read(tmp_path, "slots(4). link(a,0,b,1)."))
    twice = world(read(tmp_path, "slots(4). link(a,0,b,1). link(b,1,a,0). link(a,0,b,1)."))
    assert once == twice


def test_node_link_by_index_and_with_a_course():
    made = load(FILES / "ring.json", Reading(), 4, 0.0).environment
    assert made.map.links[0, 0] == (1, 2)
    assert made.map.links[1, 0] == (2, 0)
    assert made.map.links[2, 2] == (3, 0)
    assert made.map.links[3, 3] == (0, 1)
    assert made.moves[0, 0] == (0, 100)


@pytest.mark.parametrize("directed", [True, False])
@pytest.mark.parametrize("key", ["links", "edges"])
@pytest.mark.parametrize("where", ["xy", "pos", "list", "position"])
def test_node_link_of_networkx_and_of_others(tmp_path, directed, key, where):
    def place(x, y):
        return {
            "xy": {"x": x, "y": y},
            "pos": {"pos": [x, y]},
            "list": {"position": [x, y, 0]},
            "position": {"position": {"x": x, "y": y}},
        }[where]

    nodes = [{"id": [0, 0], **place(0, 0)}, {"id": "q", **place(0, 9)}, {"id": 7, **place(9, 9)}]
    ways = [([0, 0], "q"), ("q", 7)]
    ways += [("q", [0, 0]), (7, "q")] if directed else []
    told = {
        "directed": directed,
        "multigraph": False,
        "graph": {"crs": "plane"},
        "nodes": nodes,
        key: [{"source": a, "target": b, "weight": 1, "key": 0} for a, b in ways],
    }
    made = load_of(tmp_path, json.dumps(told)).environment
    assert made.map.links == {
        ("0,0", 0): ("q", 2),
        ("q", 2): ("0,0", 0),
        ("q", 1): ("7", 3),
        ("7", 3): ("q", 1),
    }


def load_of(tmp_path, text, *rest, reading=None):
    file = tmp_path / "w.x"
    file.write_text(text, encoding="utf-8")
    return load(file, reading or Reading(), *(rest or (4, 0.0)))


def test_directed_edges_without_an_opposite_one_are_one_way(tmp_path):
    nodes = [{"id": "a", "lon": 10, "lat": 50}, {"id": "b", "lon": 10, "lat": 50.001}]
    told = {"directed": True, "nodes": nodes, "links": [{"source": "a", "target": "b"}]}
    (way,) = read(tmp_path, json.dumps(told)).ways
    assert way.one_way
    assert way.length == pytest.approx(111.195)


NODES = '{"nodes": [{"id": 1, "x": 0, "y": 0}, {"id": 2, "x": 1, "y": 0}], "links": [%s]}'
HOSTILE_JSON = {
    NODES % '{"source": 1, "target": 5}': "edge 0, from 0: 5 is not a node",
    NODES % '{"source": 1}': "edge 0, from 0: it has no source and target",
    NODES % '{"source": {"a": 1}, "target": 2}': "edge 0, from 0: its name is neither a text",
    NODES % '{"source": true, "target": 2}': "its name is neither a text nor a number",
    NODES % '{"source": 1, "target": 2, "geometry": [[0,0],[1%s,0]]}' % ("0" * 400): "its geometry",
    NODES % '{"source": 1, "target": 2, "geometry": {"coordinates": "x"}}': "geometry is neither",
    NODES % "1": "its edges are not a list of objects",
    NODES.replace('"x": 1', '"x": 1e999') % '{"source": 1, "target": 2}': "place 2 has no coord",
    NODES.replace('"x": 1', '"x": NaN') % '{"source": 1, "target": 2}': "place 2 has no coord",
    NODES.replace('"x": 1', f'"x": 1{"0" * 400}') % '{"source": 1, "target": 2}': "place 2 has no",
    NODES.replace('"x": 1', f'"x": 1{"0" * 9000}') % "": "a number that is too long",
    NODES.replace('"id": 2', '"id": 1') % "": "node 1 occurs twice",
    NODES.replace('"id": 2', '"ident": 1') % "": "node 1 of the list, from 0, has no id",
    NODES.replace('"id": 2', '"id": "\\ud800"') % "": "a name with a character that is not allowed",
    NODES.replace('"id": 2', '"id": "\\u0000"') % "": "a name with a character that is not allowed",
    NODES.replace('"id": 2', f'"id": "{"x" * 2000}"') % "": "more than 1000 letters",
    '{"format": 2, ' + (NODES % "")[1:]: "format 2 is not known",
    '{"nodes": 3, "links": []}': "its nodes are not a list of objects",
    '{"nodes": [], "edges": []}': "no ways in it",
    '{"nodes":\n[{"id": 1}], "links": [': ":2: not a whole JSON text",
    f'{{"nodes": {"[" * 10**5}1{"]" * 10**5}, "links": []}}': "nested too deep",
    '{"graph": {"slots": 5}, "nodes": [], "links": []}': "slots(5): K must be even",
    '{"graph": {"slots": "x"}, "nodes": [], "links": []}': "slots is not a whole number",
    '{"graph": {"slots": 4, "north": []}, "nodes": [], "links": []}': "north is not a number",
    '{"maps": [': ":1: not a whole JSON text",
    '{"maps": []}': "no maps in it",
    '{"maps": [{"at": [[0,0,0]]}]}': "slots, places and links are wanted",
    '[{"at": [[0,0,0]]}]': "no number of slots in it",
    '{"results": 3}': "results: not a list of answers",
}


@pytest.mark.parametrize(("text", "said"), HOSTILE_JSON.items())
def test_hostile_json_is_refused_in_one_line(tmp_path, text, said):
    assert said in refused(tmp_path, text)


def exact(**change):
    """A graph of two places and one link, as topomap writes it, with something changed."""
    told = {
        "graph": {"slots": 4},
        "nodes": [{"id": "a"}, {"id": "b"}],
        "edges": [{"source": "a", "target": "b", "ends": [["a", 0], ["b", 1]]}],
    }
    told["graph"].update(change.pop("graph", {}))
    told["edges"][0].update(change.pop("edge", {}))
    told["nodes"][0].update(change.pop("node", {}))
    assert not change
    return json.dumps(told)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"edge": {"ends": [["a", 0], ["a", 1]]}}, "its ends are not two gateways"),
        ({"edge": {"ends": [["a", 0], ["b", 4]]}}, "place b: slot 4 is not in 0..3"),
        ({"edge": {"ends": [["a", 0.5], ["b", 0]]}}, "its ends are not two gateways"),
        ({"edge": {"ends": "[" * 10**5}}, "its ends are not two gateways"),
        ({"edge": {"move": [1, 10**400]}}, "its move is not two numbers"),
        ({"node": {"landmarks": ["f(X)"]}}, "place a: landmark 'f(X)' is not a ground term"),
        ({"node": {"landmarks": "x"}}, "its landmarks are not a list"),
        ({"node": {"gateways": [0, "x"]}}, "its gateways are not a list of slots"),
        ({"graph": {"straight": [["a", 0, 1]]}}, "straight: gateway 1 has no link"),
        ({"graph": {"straight": 5}}, "straight is not a list"),
    ],
)
def test_exact_graphs_are_checked(tmp_path, change, said):
    assert world(read(tmp_path, exact())).links["a", 0] == ("b", 1)
    assert said in refused(tmp_path, exact(**change))


def test_own_maps_become_worlds():
    loaded = load(FILES / "bend.maps.json", Reading())
    made = loaded.environment.map
    assert made.slots == 8
    assert made.stars == {0: {0}, 1: {1, 4}, 2: {5}}
    assert made.landmarks == {2: {'"old oak"'}}
    assert made.across == {(1, 1): (1, 4), (1, 4): (1, 1)}
    assert loaded.warnings[:1] == [f"{FILES / 'bend.maps.json'}: pending gateways left out: 1"]


def test_a_map_of_pending_gateways_alone_is_refused(tmp_path):
    told = json.loads((FILES / "bend.maps.json").read_text())
    told["maps"][0] |= {"links": [], "paths": []}
    assert "all its gateways are pending" in refused(tmp_path, json.dumps(told))
    told["maps"][0]["links"] = [[[0, 3], [1, 4]]]
    assert "place 0 has no gateway 3" in refused(tmp_path, json.dumps(told))


@pytest.mark.parametrize("seed", range(150))
def test_paths_of_maps_tell_what_is_straight(tmp_path, seed):
    """What is on one path is recovered from the headings of the paths alone, for any pairs."""
    draw = random.Random(seed)
    made = random_world(draw)
    if draw.random() < 0.7:
        across = {}
        for place, star in made.stars.items():
            slots = draw.sample(sorted(star), len(star))
            pairs = zip(slots[::2], slots[1::2], strict=False)
            for one, other in pairs:
                if draw.random() < 0.7:
                    across |= {(place, one): (place, other), (place, other): (place, one)}
        made = replace(made, across=across)
    places = {place: number for number, place in enumerate(made.stars)}

    def of(gateway):
        return [places[gateway[0]], gateway[1]]

    entry = {
        "at": [],
        "places": [
            {"place": places[p], "gateways": sorted(star), "landmarks": []}
            for p, star in made.stars.items()
        ],
        "links": [[of(a), of(b)] for a, b in made.edges()],
        "paths": [[of(end) for end in path] for path in made.headings()],
    }
    given = world(read(tmp_path, json.dumps({"slots": made.slots, "maps": [entry]})))

    def pairs(made, name=lambda place: place):
        ends = {(p, s): made.opposite((p, s)) for p, s in made.links}
        return {
            frozenset(((name(p), s), (name(end[0]), end[1])))
            for (p, s), end in ends.items()
            if end in made.links
        }

    assert pairs(given) == pairs(made, places.get)


def test_tmap2_edges_and_their_opposites(tmp_path):
    content = (FILES / "greenhouse.yaml").read_text()
    plan = read(tmp_path, content)
    ends = {tuple(end.place for end in way.ends): way.one_way for way in plan.ways}
    assert ends == {("Dock", "Row1"): False, ("Row1", "Row2"): False, ("Row2", "Dock"): True}
    assert any("taken as one way: 1 more" in told for told in plan.told)
    old = yaml.safe_dump(yaml.safe_load(content)["nodes"])
    assert read(tmp_path, old).ways == plan.ways
    assert read(tmp_path, json.dumps(yaml.safe_load(content))).ways == plan.ways
    merged = content.replace("&level {w", "&level {<<: {q: 1}, w")
    assert read(tmp_path, merged).ways == plan.ways


HEAD = "nodes:\n- node: {name: a, edges: [], pose: {position: {x: 0, y: 0}}}\n"
TO_B = HEAD.replace("[]", "[{node: b}]")
BOMB = "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9) if n else 'x'}]\n" for n in range(12))
MERGES = "a0: &a0 {x: 1}\n" + "".join(
    f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}\n" for n in range(1, 12)
)
HOSTILE_YAML = {
    f"{HEAD}{BOMB}": "counting what aliases stand for",
    f"{HEAD}{MERGES}": "counting what aliases stand for",
    f"{HEAD}b: &b [*b]": ":3: it contains itself by an alias",
    f"{HEAD}b: !!python/object/apply:os.system ['mkdir made']": ":3: the tag tag:yaml.org,2002:pyt",
    f"{HEAD}b: !!int 3": ":3: the tag",
    f"{HEAD}b: {'[' * 60}{']' * 60}": ":3: nested deeper than 50",
    f"{HEAD}b: {'[' * 10**6}": ":3: not YAML: exceeded maximum nesting depth",
    f"{HEAD}b: *c": ":3: not YAML: found undefined alias",
    f"{HEAD}b: [1": "not YAML",
    f"{HEAD}? [a]\n: 1": "not YAML",
    f"{HEAD}b: \x01": "not YAML",
    f"{HEAD}--- {{}}": "not YAML: but found another document",
    HEAD: "no ways in it",
    HEAD.replace("[]", "[{node: b}]"): "edge 0 of node a: no node b",
    HEAD.replace("[]", "5"): "node a: its edges are not a list",
    HEAD.replace("[]", "[5]"): "edge 0, from 0, of node a: it does not tell its node",
    HEAD.replace("[]", "[{node: [x]}]"): "its name is neither a text nor a number",
    HEAD.replace("name", "nom"): "node 0 of the list, from 0, has no name",
    HEAD + HEAD[7:]: "two nodes are called a",
    f"{TO_B}- node: {{name: b, edges: [], pose: 4}}": "place b has no coordinates",
    f"{TO_B}- node: {{name: b, pose: {{position: {{x: .inf, y: 1}}}}}}": "place b has no coord",
}


@pytest.mark.parametrize(("text", "said"), HOSTILE_YAML.items())
def test_hostile_yaml_is_refused_in_one_line(tmp_path, text, said):
    assert said in refused(tmp_path, text)
    assert not (tmp_path / "made").exists()


def test_trizbort_rooms_and_lines():
    loaded = load(FILES / "manor.trizbort", Reading(landmarks=True), two_way=True)
    made = loaded.environment
    assert made.map.slots == 16
    assert made.map.links == {
        (1, 4): (2, 12),
        (2, 12): (1, 4),
        (2, 1): (3, 8),
        (3, 8): (2, 1),
        (3, 11): (1, 0),
        (1, 0): (3, 11),
    }
    assert made.map.landmarks == {1: {'"Hall"'}, 2: {'"Library"'}, 3: {'"Garden"'}}
    assert [way.one_way for way in loaded.plan.ways] == [False, False, True]
    assert made.moves[2, 1] == (0, 128)
    said = [warning.split(": ", 1)[1] for warning in loaded.warnings]
    assert said[:4] == [
        "lines that lead nowhere left out: 1",
        "lines up, down, in, out or without a port left out: 1 (Hall to Attic)",
        "loops left out: 1 (Hall to Hall)",
        "rooms without a way left out: 1 (Attic)",
    ]
    with_loops = load(FILES / "manor.trizbort", Reading(loops=True), two_way=True)
    assert with_loops.environment.map.links[1, 8] == (1, 10)
    with pytest.raises(InputError, match="1 of 3 ways can be gone one way only"):
        load(FILES / "manor.trizbort", Reading())


def trizbort(inside):
    rooms = '<room id="1" name="a" x="0" y="0"/><room id="2" name="b" x="9" y="0"/>'
    return f'<?xml version="1.0"?><trizbort><map>{rooms}{inside}</map></trizbort>'


def line(one="e", other="w", more=""):
    return (
        f'<line id="3" {more}><dock index="0" id="1" port="{one}"/>'
        f'<dock index="1" id="2" port="{other}"/></line>'
    )


def test_trizbort_lines_between_the_same_ports_are_one(tmp_path):
    """Two that lead in opposite directions make a way that can be gone both ways."""
    back = '<line id="4" flow="oneWay"><dock index="0" id="2" port="w"/>'
    back += '<dock index="1" id="1" port="e"/></line>'
    file = tmp_path / "two.trizbort"
    one_way = line(more='flow="oneWay"')
    for lines, refused in ((one_way + back, False), (one_way + one_way, True)):
        file.write_text(trizbort(lines))
        (way,) = load(file, two_way=True).plan.ways
        assert way.one_way == refused
        assert (
            f"{file}: second lines between the same two ports left out: 1"
            in load(file, two_way=True).warnings
        )


def test_trizbort_labels_that_lead_up_or_down_are_no_directions(tmp_path):
    file = tmp_path / "up.trizbort"
    for text, left in ("Go UP", 1), ("climb down the rope", 1), ("u", 1), ("upper hall", 0):
        more = f'startText="{text}"'
        file.write_text(trizbort(line() + line("n", "s", more)))
        assert len(load(file).plan.ways) == 2 - left


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"  \n", "it is empty"),
        (b"\x89PNG\r\n", "for a floor plan, give the YAML file that names it"),
        (b"P5 2 2 255\n", "for a floor plan, give the YAML file that names it"),
        (b"image: a.pgm\nfree_thresh: 0.2\n", "resolution is not given"),
    ],
)
def test_what_is_not_a_world_is_refused(tmp_path, content, said):
    (tmp_path / "x").write_bytes(content)
    with pytest.raises(InputError, match=said):
        load(tmp_path / "x")


def test_slots_of_a_file_are_kept_if_only_north_is_given():
    file = FILES / "museum.world"
    assert load(file, north=0).environment.map.links == load(file).environment.map.links
    assert load(file, north=45).environment.map.slots == 8


def test_nodes_themselves_as_the_ends_of_edges(tmp_path):
    """D3 puts them there once it has drawn a graph."""
    nodes = [{"id": "a", "x": 0, "y": 0, "index": 0}, {"id": "b", "x": 0, "y": 9, "index": 1}]
    (tmp_path / "d3.json").write_text(
        json.dumps({"nodes": nodes, "links": [{"source": nodes[0], "target": nodes[1]}]})
    )
    assert load(tmp_path / "d3.json").environment.map.links[("a", 0)] == ("b", 2)


def test_xml_in_utf_16(tmp_path):
    text = trizbort(line()).replace('version="1.0"', 'version="1.0" encoding="utf-16"')
    (tmp_path / "wide.trizbort").write_text(text, encoding="utf-16")
    assert len(load(tmp_path / "wide.trizbort").plan.ways) == 1


ENTITIES = '<!DOCTYPE x [<!ENTITY a "b"><!ENTITY c "&a;&a;&a;">]>'
HOSTILE_XML = {
    trizbort(line()).replace("<trizbort>", f"{ENTITIES}<trizbort>"): "document type or entities",
    trizbort(line()).replace(
        "<trizbort>", '<!DOCTYPE x SYSTEM "file:///etc/passwd"><trizbort>'
    ): "document type or entities",
    trizbort(line())[:-20]: ":1: not whole XML",
    trizbort(line("north")): "line 3: port north is not one of n, nne",
    trizbort(line() + line(other="e")): "room a: two lines end at its port e, to b and b",
    trizbort('<room id="1" x="0" y="0"/>'): "a room 1: its id occurs twice",
    trizbort('<room x="0" y="0"/>'): "a room has no id",
    trizbort('<room id="4" x="1e99" y="0"/>'): "room 4: its x, y, w and h are not finite numbers",
    trizbort('<room id="4" x="0"/>'): "room 4: its x, y, w and h are not finite numbers",
    trizbort(line("")): "no ways in it",
    trizbort(line(more='startText=" Up "')): "no ways in it",
    trizbort(line().replace('id="2"', 'id="9"')): "no ways in it",
    trizbort(line().replace('index="1"', 'index="x"')): "the index of one of its ends",
    "<trizbort/>": "no ways in it",
    "<x><trizbort/></x>": "its root is x",
    '<?xml version="1.0" encoding="nonsense"?><trizbort/>': "not",
}


@pytest.mark.parametrize(("text", "said"), HOSTILE_XML.items())
def test_hostile_trizbort_is_refused_in_one_line(tmp_path, text, said):
    assert said in refused(tmp_path, text)


@pytest.mark.parametrize("file", FORMATS)
def test_damaged_files_are_read_or_refused_in_one_line(tmp_path, file):
    """Cut short anywhere, or with some bytes changed, doubled or taken away."""
    content = (FILES / file).read_bytes()
    draw = random.Random(file)
    damaged = [content[:end] for end in range(0, len(content), 7)]
    for _ in range(300):
        made = bytearray(content)
        for _ in range(draw.randint(1, 4)):
            at = draw.randrange(len(made))
            end = at + draw.randint(0, 9)
            put = draw.choice([b"", made[at:end] * 2, b"\xff", b"\0", b"9" * 9, b'"', b"[", b"-"])
            made[at:end] = put
        damaged.append(bytes(made))
    read_of, refused_of = 0, []
    for made in damaged:
        (tmp_path / "w").write_bytes(made)
        try:
            load(tmp_path / "w", Reading(), two_way=True)
            read_of += 1
        except InputError as error:
            refused_of.append(str(error))
    assert read_of > 4
    assert len(refused_of) > 50
    assert all(str(tmp_path / "w") in said and "\n" not in said for said in refused_of)


@pytest.mark.parametrize("text", [HEAD + BOMB, HEAD + MERGES, f"{HEAD}b: {'[' * 10**6}"])
def test_bombs_take_little_memory(tmp_path, text):
    (tmp_path / "bomb.yaml").write_text(text)
    limit = 1 << 30

    def small():
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    call = "topomap", "generate", "world", tmp_path / "bomb.yaml", "--route", "tour"
    done = run(*call, preexec_fn=small)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1


# What is written is read back.


def decorated(seed):
    """A random world with names, landmarks, pairs and moves, or a made one."""
    draw = random.Random(seed)
    if seed % 5 == 0:
        made = draw.choice([grid(2, 3), grid(3, 3, "torus"), grid(2, 4, "crescents")])
        return made if draw.random() < 0.5 else lattice("triangles", 2, 3)
    made = random_world(draw)
    names = draw.sample(NAMES, len(NAMES)) + [f"p{number}" for number in range(len(made.stars))]
    call = dict(zip(made.stars, sorted(names[: len(made.stars)]), strict=True))
    made = TopologicalMap(
        made.slots,
        {call[place]: star for place, star in made.stars.items()},
        {(call[p], s): (call[q], r) for (p, s), (q, r) in made.links.items()},
        {call[place]: signs | {'"<é\\"\\n>"'} for place, signs in made.landmarks.items()},
    )
    if draw.random() < 0.5:
        across = {}
        for place, star in made.stars.items():
            slots = draw.sample(sorted(star), len(star))
            for one, other in zip(slots[::2], slots[1::2], strict=False):
                across |= {(place, one): (place, other), (place, other): (place, one)}
        made = replace(made, across=across)
    moves = {}
    for one, other in made.edges():
        move = draw.uniform(-9, 9), draw.randint(-9, 9)
        moves |= {one: move, other: (-move[0], -move[1])}
    return Environment("w", (), made, None, (), moves)


@pytest.mark.parametrize("form", WRITERS)
@pytest.mark.parametrize("seed", range(60))
def test_a_world_is_read_back_as_it_was(tmp_path, form, seed):
    made = decorated(seed)
    north = random.Random(seed).choice([0, 30, -12.5, 359])
    places = [*made.map.stars]
    points = points_of(made)
    names = {places[0]: 'the "first" é'}
    made = replace(made, points=points, names=names, north=north)
    text = world_text(made, form)
    file = tmp_path / "back"
    file.write_text(text, encoding="utf-8")
    back = load(file, Reading())
    assert relabelled(back.environment.map) == relabelled(made.map)
    assert (back.layout.slots, back.layout.north) == (made.map.slots, north)
    moves = {(label(p), s): move for (p, s), move in made.moves.items()}
    assert {(label(p), s): m for (p, s), m in back.environment.moves.items()} == moves
    assert {label(p): at for p, at in back.plan.points.items()} == {
        label(p): at for p, at in points.items()
    }
    assert back.plan.names == {label(places[0]): names[places[0]]}
    assert world_text(replace(back.environment, name=made.name), form) == text


def test_what_cannot_be_written_is_refused():
    odd = decorated(1)
    place = next(iter(odd.map.stars))
    with pytest.raises(InputError, match="XML cannot hold the name"):
        world_text(replace(odd, names={place: "a\x01"}), "graphml")
    with pytest.raises(InputError, match="the position of place"):
        world_text(replace(odd, moves={}), "tmap2")
    with pytest.raises(ValueError, match="'dot' is not one of graphml, json, tmap2"):
        world_text(odd, "dot")


@pytest.mark.slow
@pytest.mark.parametrize("form", ["graphml", "json", "tmap2"])
def test_exported_maps_become_the_worlds_that_they_show(tmp_path, form):
    instance = ROOT / "instances/grid-3x3-snake.lp"
    solved = run("topomap", "solve", instance, "--optimal", "--json")
    told = json.loads(solved.stdout)
    (scene, *_) = of_document(maps.document("maps", told))
    text = exports.DRAWN[form](scene, layout(scene.world, scene.ahead))
    file = tmp_path / "map"
    file.write_text(text)
    back = load(file, Reading())
    assert back.environment.map.links == scene.world.links
    assert back.environment.map.stars == scene.world.stars
    assert {*back.plan.points} == {*scene.world.stars}
    (tmp_path / "maps.json").write_text(json.dumps({**told, "maps": told["maps"][:1]}))
    assert load(tmp_path / "maps.json", Reading()).environment.map.links == scene.world.links


def test_a_tmap2_is_what_the_schema_of_topological_navigation_demands():
    """What their schema requires, written down here: which keys there must be, and that these are
    texts."""
    told = yaml.safe_load(world_text(grid(2, 2), "tmap2"))
    assert {"meta", "metric_map", "name", "nodes", "pointset"} <= told.keys()
    day, clock = told["meta"]["last_updated"].split("_")
    assert [len(part) for part in (*day.split("-"), *clock.split("-"))] == [2, 2, 4, 2, 2, 2]
    names = {entry["node"]["name"] for entry in told["nodes"]}
    assert names == {"0,0", "0,1", "1,0", "1,1"}
    seen = set()
    for entry in told["nodes"]:
        assert {"map", "node", "pointset"} <= entry["meta"].keys()
        assert entry["meta"]["node"] == entry["node"]["name"]
        assert {*entry["node"]["pose"]["position"]} == {"x", "y", "z"}
        for edge in entry["node"]["edges"]:
            assert edge["node"] in names
            assert edge["edge_id"] not in seen
            seen.add(edge["edge_id"])
    assert len(seen) == 8


@pytest.mark.parametrize("file", FORMATS)
def test_the_command_explores_each_file(file):
    options = "--two-way", "--names", "--route", "tour"
    made = run("topomap", "generate", "world", FILES / file, *options)
    assert made.returncode == 0, made.stderr
    seen = parse(made.stdout, file)
    assert seen.steps >= 2
    assert any(seen.landmarks)


@pytest.mark.slow
@pytest.mark.parametrize("end", FORMS)
def test_the_world_that_is_explored_is_written(tmp_path, end):
    call = "topomap", "generate", "grid", "2", "3", "--route", "tour", "--signs", "1"
    file = tmp_path / f"world{end}"
    done = run(*call, "--world", file)
    assert done.returncode == 0
    assert done.stdout == run(*call).stdout
    back = topomap.world(file)
    world = topomap.world(file).map
    assert relabelled(world) == relabelled(grid(2, 3).signed(1, 0).map)
    topomap.write_world(back, tmp_path / f"again{end}")
    assert topomap.world(tmp_path / f"again{end}").points == back.points != {}


@pytest.mark.slow
def test_a_world_that_cannot_be_written_leaves_no_file(tmp_path):
    call = "topomap", "generate", "grid", "2", "2", "--route", "tour"
    for options, said in (
        (
            ("--world", tmp_path / "w.lp"),
            "a file with a world ends in .graphml, .json, .yaml, .yml",
        ),
        (("--world", tmp_path / "w.json", "-o", tmp_path / "w.json"), "both --output and --world"),
        (("--world", tmp_path / "w.json", "--truth", tmp_path / "w.json"), "--truth and --world"),
    ):
        done = run(*call, *options)
        assert (done.returncode, done.stdout) == (2, "")
        assert said in done.stderr
    assert not [*tmp_path.iterdir()]
    with pytest.raises(TypeError, match=r"what topomap\.world gives, not str"):
        topomap.write_world("world", tmp_path / "w.json")
    with pytest.raises(InputError, match="ends in"):
        topomap.write_world(grid(2, 2), tmp_path / "w")
