"""Maps and robots as Python has them: the same as the commands say, from any thread."""

import json
import threading
import time
from itertools import pairwise

import networkx as nx
import numpy
import pytest
import topomap
from conftest import ROOT
from defusedxml import ElementTree
from topomap.api.maps import Map
from topomap.api.simulate import simulate
from topomap.api.solve import solve
from topomap.documents.answers import map_line
from topomap.drawing import ready
from topomap.exchange.imports import import_map
from topomap.model.experience import Experience
from topomap.model.facts import read
from topomap.model.found import UNPROVED, Found
from topomap.model.query import Query
from topomap.questions.robot import Outcome, others
from topomap.runtime import extras
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import solving
from topomap.worlds.environment import environment

GRID = "instances/grid-3x3-snake.lp"
SEEN = read(ROOT / GRID)
CLOSED = Query(frozenset(["closed"]))


@pytest.fixture(scope="module")
def made():
    """All maps of the snake, in order."""
    found = solving.hypotheses(SEEN, Query(), Watch())
    some = sorted((one for one in found if one), key=lambda one: one.at)
    return [Map(SEEN, one, number, len(some), True) for number, one in enumerate(some, 1)]


def closed(number=0):
    """A closed map, of those in order."""
    found = sorted((one for one in solving.hypotheses(SEEN, CLOSED, Watch()) if one), key=by_at)
    return Map(SEEN, found[number], number + 1, len(found), True, name=GRID)


def by_at(found):
    return found.at


def plain(value):
    """What JSON makes of it."""
    return json.loads(json.dumps(value))


def elsewhere(work):
    """What comes of it in another thread than the first."""
    came = []

    def do():
        came.append(work())

    thread = threading.Thread(target=do)
    thread.start()
    thread.join()
    (result,) = came
    return result


def test_the_properties_are_what_solve_writes(made, topomap):
    answer = json.loads(topomap("solve", GRID, "--json").stdout)
    assert len(answer["maps"]) == len(made) > 1
    by_route = {json.dumps(entry["at"]): entry for entry in answer["maps"]}
    for one in made:
        told = one.document()
        entry = by_route.pop(json.dumps(told["at"]))
        assert told == entry
        assert [[t, *dstate] for t, dstate in enumerate(one.at)] == entry["at"]
        places = [
            {"place": place, "gateways": star, "landmarks": one.landmarks[place]}
            for place, star in one.places.items()
        ]
        assert places == entry["places"]
        for name in ("links", "paths", "faces", "genus", "pending"):
            assert plain(getattr(one, name)) == entry[name]
        assert list(one.at[-1]) == entry["dstate"]
        assert (one.kind, one.slots) == (answer["kind"], answer["slots"])
        assert (one.cost, one.proved, one.misread) == ((), True, ())
    assert not by_route


def test_a_map_reads_as_solve_prints_it(topomap):
    lines = topomap("solve", GRID, "--closed").stdout.splitlines()
    (found,) = [line for line in lines if line.endswith(str(closed()).partition(": ")[2])]
    assert found.partition(": ")[2] == map_line(SEEN, Found(closed().at, "consistent"))


def test_what_was_misread_is_reported():
    """The agent goes from one end of a way to the other, and back."""
    end = frozenset([0])
    seen = Experience(2, (end, end, end), (0, 0), (frozenset(),) * 3)
    at = ((0, 0), (1, 0), (0, 0))
    sure = Map(seen, Found(at, "consistent"), noisy=True)
    assert (sure.misread, sure.document()["misread"]) == ((), [])
    assert sure.places == {0: [0], 1: [0]}
    wrong = Map(seen, Found(at, "best", (1, 1), misread=((1, 1),)))
    assert wrong.document()["misread"] == [{"step": 1, "gateway": 1, "seen": False}]
    assert wrong.places == {0: [0], 1: [0, 1]}
    assert wrong.pending == [(1, 1)]
    assert "contradicts step 1 (gateway 1 missed); places 2" in str(wrong)
    assert wrong != sure


def test_maps_are_equal_by_where_the_agent_is(made):
    again = Map(SEEN, Found(made[0].at, "optimal", (0, 6, 9)), 7)
    assert made[0] == again
    assert hash(made[0]) == hash(again)
    assert len({*made, again}) == len(made)
    assert all(one != other for one, other in pairwise(made))
    assert made[0] != made[0].at


def test_what_is_not_proved_is_not_said_to_be_best(made):
    at = made[0].at
    for kind in ("optimal", "best so far", "best"):
        assert Map(SEEN, Found(at, kind, (6, 9), proved=False)).kind == UNPROVED
        assert Map(SEEN, Found(at, kind, (6, 9))).kind == kind


@pytest.mark.slow
def test_the_graph_is_what_export_writes(topomap, tmp_path):
    maps, file = tmp_path / "maps.json", tmp_path / "map.json"
    topomap("solve", GRID, "--closed", "--json", "-o", maps)
    numbers = [entry["at"] for entry in json.loads(maps.read_text())["maps"]]
    for number in range(len(numbers)):
        one = closed(number)
        nth = numbers.index(one.document()["at"]) + 1
        done = topomap("export", maps, "--map", nth, "--format", "json", "-o", file)
        assert done.returncode == 0
        written = nx.node_link_graph(json.loads(file.read_text()), edges="edges")
        for _, attributes in written.nodes(data=True):  # where a drawing has the place
            assert {*map(type, (attributes.pop("x"), attributes.pop("y")))} == {float}
        ours = one.to_networkx()
        assert plain(dict(ours.graph)) == written.graph
        assert plain(list(ours.nodes(data=True))) == plain(list(written.nodes(data=True)))
        edges = [plain(list(graph.edges(keys=True, data=True))) for graph in (ours, written)]
        assert edges[0] == edges[1]
        assert json.loads(import_map(str(file)))["maps"] == [one.document()]


def test_a_map_that_was_found_does_not_say_how_many_there_are():
    """More of them may come: solve gives each as it is found."""
    answer = solve(SEEN, closed=True)
    drawn = answer[1]._repr_svg_()
    assert ">map 2 found, consistent<" in drawn
    assert str(answer[1]).startswith("map 2: ")


def test_maps_with_wrong_views_say_which(topomap):
    """Also where none is wrong."""
    told = json.loads(topomap("solve", GRID, "--noise", 0, "--closed", "--json").stdout)["maps"]
    made = solve(SEEN, noise=0, closed=True)
    assert [one.document() for one in sorted(made, key=by_at)] == sorted(
        told, key=lambda m: m["at"]
    )
    assert {"misread"} <= set(told[0])


SLOW = [pytest.param(form, marks=pytest.mark.long) for form in ("png", "pdf")]


@pytest.mark.slow
@pytest.mark.parametrize("form", ["svg", *SLOW])
def test_a_drawing_is_the_same_bytes_again(tmp_path, form):
    files = [tmp_path / f"{number}.{form}" for number in (1, 2)]
    closed().draw(files[0])
    elsewhere(lambda: closed().draw(str(files[1])))
    content = files[0].read_bytes()
    assert content == files[1].read_bytes()
    if form == "svg":
        root = ElementTree.fromstring(content)
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        drawn = {element.get("id") for element in root.iter()}
        assert {f"place-{place}" for place in closed().places} <= drawn
        assert closed()._repr_svg_() == content.decode()
    else:
        assert content.startswith({"png": b"\x89PNG", "pdf": b"%PDF"}[form])


@pytest.mark.slow
def test_threads_that_draw_at_once_draw_the_same(made):
    alone = [one._repr_svg_() for one in made[:2]]
    came = [None] * len(alone)

    def do(number):
        came[number] = made[number]._repr_svg_()

    threads = [threading.Thread(target=do, args=[number]) for number in range(len(came))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert came == alone


def test_what_cannot_be_drawn_says_so_in_a_line(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"map\.gif: a picture is svg, png, pdf"):
        closed().draw(tmp_path / "map.gif")
    with pytest.raises(InputError, match="no such file or directory"):
        closed().draw(tmp_path / "none" / "map.svg")
    monkeypatch.setattr(extras, "find_spec", lambda module: module == "jinja2" or None)
    with pytest.raises(InputError, match=r"map\.svg: matplotlib is not installed; .* extra draw"):
        closed().draw(tmp_path / "map.svg")
    assert closed()._repr_svg_() is None
    assert not list(tmp_path.iterdir())


def test_no_memory_for_a_drawing_is_not_an_endless_wait(tmp_path, monkeypatch):
    monkeypatch.setattr(ready, "MEMORY", 1 << 60)
    with pytest.raises(MemoryError):
        closed().draw(tmp_path / "map.svg")
    assert not list(tmp_path.iterdir())


CALLS = [
    (("grid", 2, 3), {}, []),
    (("maze", 3, 3), {"seed": 1, "signs": 0.3}, ["--seed", "1", "--signs", "0.3"]),
    (("grid", 2, 3), {"planar": True, "marker": True}, ["--planar", "--marker"]),
    (("grid", 2, 3), {"steps": 2, "start": "0,1"}, ["--steps", "2", "--start", "0,1"]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("world", "asked", "options"), CALLS)
def test_a_robot_comes_to_what_the_command_writes(topomap, world, asked, options):
    made = elsewhere(lambda: simulate(*world, **asked))
    told = json.loads(topomap("simulate", *world, *options, "--json").stdout)
    assert told.pop("format") == 1
    assert told == {**made.document(), "complete": made.complete, "fault": made.fault}
    assert topomap("simulate", *world, *options).stdout == f"{made}\n"
    assert (made.end, made.steps, made.truth) == (told["end"], told["steps"], told["truth"])
    assert (made.tour, made.random) == (told["tour"], told["random"])
    assert len(made.maps) == (told["best_maps"] or 0)
    assert made.experience.steps == made.steps
    assert all(len(one.at) == made.steps + 1 for one in made.maps)


def test_a_robot_that_is_stopped_says_so():
    made = simulate("grid", 4, 4, timeout=1e-9)
    assert (made.complete, made.fault, made.truth) == (False, "timeout", None)


def test_a_time_limit_is_for_the_walks_of_others_too():
    """A tour of so many places, and random walks over them, take far longer than this."""
    begun = time.monotonic()
    made = simulate("grid", 60, 60, timeout=0.5)
    assert time.monotonic() - begun < 30  # without the limit: minutes
    assert (made.complete, made.fault, made.tour, made.random) == (False, "timeout", None, None)
    assert str(made).endswith(
        "a tour over every way, by one who knows the map: not known; partial: timeout\n"
        "a random walk over every way (median): not known; partial: timeout"
    )


class Ticks(Watch):
    """A watch that stops the work when it is looked at for the so many-th time."""

    def __init__(self, most):
        super().__init__()
        self.left = most

    def tick(self):
        self.left -= 1
        if self.left < 0:
            raise Stopped("timeout")


@pytest.mark.parametrize("most", [0, 1, 20, 40])
def test_others_that_are_cut_say_so(most):
    """At once, in the pairing of places, between two random walks, and in one."""
    world = environment("grid", 4, 4).map
    cut, whole = others(world, (0, 0), Ticks(most)), others(world, (0, 0), Watch())
    assert cut.fault == "timeout"
    assert cut.random is None
    assert cut.tour in (None, whole.tour)
    assert (most == 0) <= (cut.tour is None)
    assert (whole.fault, whole.tour) == (None, 28)
    made = Outcome(world, ((0, 0), 1), SEEN, (), "settled", True, cut, True, Query())
    assert made.fault == "timeout"
    assert made.document()["tour"] == cut.tour


def test_a_world_that_is_too_large():
    for make in (simulate, lambda *world: topomap.generate(*world, route="tour")):
        with pytest.raises(InputError, match="grid 400 x 400: more than 100000 places"):
            make("grid", 400, 400)
    with pytest.raises(InputError, match="a tour: 1798 places have an odd number of ways, more"):
        topomap.generate("hexagons", 30, 30, route="tour")
    assert others(environment("hexagons", 30, 30).map, (0, 0), Watch(0)).tour is None


def test_a_robot_is_not_sent_into_nothing():
    with pytest.raises(
        ValueError, match=r"'closed' is not one of the parts planar, .*no_path_axiom"
    ):
        simulate("grid", 2, 3, closed=True)
    with pytest.raises(ValueError, match="rows and columns are wanted, not 1 numbers"):
        simulate("grid", 2)
    with pytest.raises(ValueError, match="'gird' is not one of the environments grid"):
        simulate("gird", 2, 3)
    with pytest.raises(InputError, match="grid-2x3: there is no place '7,7'"):
        simulate("grid", 2, 3, start="7,7")


def test_an_experience_is_made_of_lists():
    lists = [sorted(view) for view in SEEN.views], [*SEEN.turns]
    assert topomap.Experience(4, *lists) == SEEN
    signed = topomap.Experience(4, [[0], [0, 1]], [0], [[], ["pub"]], drops=[0], markers=[0])
    assert signed.facts().splitlines()[1:] == [
        "view(0,0). marker(0). drop(0).",
        "turn(1,0). view(1,0). view(1,1). landmark(1,pub).",
    ]
    for views, turns, landmarks in ([[0]], [0], None), ([[0], [0]], [0], [[]]), ([], [], None):
        with pytest.raises(ValueError, match=r"n turns need n \+ 1 views"):
            topomap.Experience(4, views, turns, landmarks)


def test_an_experience_is_kept_plain():
    """Both ways to an answer see the same landmarks, and JSON can hold the numbers."""
    signs = [["f(1,2)"], ["b"], ["f(1, 2)"]]
    spelt = topomap.Experience(4, [[0], [0], [0]], [0, 0], signs)
    assert spelt.landmarks[0] == spelt.landmarks[2] == {"f(1,2)"}
    assert [len(topomap.solve(spelt, by=by)) for by in ("clingo", "search")] == [1, 1]
    numbers = topomap.Experience(
        numpy.int64(4), numpy.array([[0, 1], [0, 1]]), numpy.array([1]), drops=numpy.array([0])
    )
    assert numbers == topomap.Experience(4, [[0, 1], [0, 1]], [1], drops=[0])
    assert {type(slot) for view in numbers.views for slot in view} == {int}
    assert json.dumps(topomap.solve(numbers)[0].document())


@pytest.mark.parametrize(
    ("arguments", "error", "fault"),
    [
        (("4", [[0]], []), ValueError, "slots='4': a whole number is wanted"),
        ((4.0, [[0]], []), ValueError, r"slots=4\.0"),
        ((True, [[0]], []), ValueError, "slots=True"),
        ((4, [["0", "1"]], []), ValueError, r"views\[0\]: slot='0'"),
        ((4, ["01"], []), TypeError, r"views\[0\]: a collection is wanted, .*, not '01'"),
        ((4, [0, 0], [0]), TypeError, r"views\[0\]: a collection is wanted, .*, not 0"),
        ((4, [[0], [0]], None), TypeError, "turns: a collection is wanted, .*, not None"),
        ((4, [[0], [0]], [False]), ValueError, "turns: slot=False"),
        ((4, [[0], [0]], [0], ["pub", "bar"]), TypeError, r"landmarks\[0\]: .*, not 'pub'"),
        ((4, [[0]], [], [["The Pub"]]), ValueError, "'The Pub' is not a ground term"),
        ((4, [[0]], [], [["a). view(0,1"]]), ValueError, "is not a ground term"),
        ((4, [[0]], [], [["a,b"]]), ValueError, "is not a (plain|ground) term"),
        ((4, [[0]], [], [["1+1"]]), ValueError, "is not a plain term: clingo reads it as 2"),
        ((4, [[0]], [], [["(" * 9999]]), ValueError, "is nested deeper than 100"),
        ((4, [[0]], [], [["\ud800"]]), ValueError, "is not a ground term"),
        ((4, [[0]], [], [["a\0"]]), ValueError, "is not a (plain|ground) term"),
        ((4, [[0]], [], [[5]]), ValueError, r"landmarks\[0\]: 5 is not a text"),
        ((4, [[0], [0]], [0], None, [99]), ValueError, "drops: step=99: .* from 0 to 1"),
        ((4, [[0], [0]], [0], None, [], [], "1"), TypeError, "markers: a collection is wanted"),
    ],
)
def test_what_no_experience_is_made_of(arguments, error, fault):
    with pytest.raises(error, match=fault):
        topomap.Experience(*arguments)


@pytest.mark.parametrize(
    ("experience", "fault"),
    [
        (topomap.Experience(4, [[0], [0]], [1]), "step 1: turn 1: no gateway there"),
        (topomap.Experience(5, [[0]], []), r"slots\(5\): K must be even"),
        (topomap.Experience(4, [[0, 7]], []), r"step 0: slot 7 is not in 0\.\.3"),
        (topomap.Experience(4, [[0], [0]], [0], picks=[1]), "step 1: the marker is taken up, but"),
    ],
)
def test_an_experience_that_cannot_be_is_refused(experience, fault):
    calls = [
        topomap.solve,
        topomap.count,
        topomap.explain,
        topomap.explore,
        lambda seen: topomap.ask(seen, "planar"),
        lambda seen: topomap.check(seen, []),
    ]
    for call in calls:
        with pytest.raises(topomap.InputError, match=fault):
            call(experience)
