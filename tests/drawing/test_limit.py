"""The time limit of drawings: what is late is drawn plainly, and says so; and a map is shown before
all maps are found. What is late is determined by counting, not by a clock."""

import json
import random
import signal
import subprocess
import time
from itertools import combinations, pairwise

import numpy as np
import pytest
from conftest import BIN, ROOT
from test_terminal import linked, walk
from topomap.api import scenes as choice
from topomap.api.draw import characters, save, svg
from topomap.api.scenes import scenes_under
from topomap.cli.scene import SEARCH
from topomap.documents.answers import map_json
from topomap.drawing import shapes
from topomap.drawing.clearance import under
from topomap.drawing.layout import layout, straight
from topomap.drawing.plain import MOST_PLACES, NEAREST, NOTE, UNDER, plain
from topomap.drawing.planarize import LINK_ORDERS, Walks, left_out, planar_part, routed
from topomap.model.query import Query
from topomap.model.topology import TopologicalMap
from topomap.page import chapter
from topomap.runtime.limits import DRAWING
from topomap.runtime.watch import Stopped, Watch
from topomap.worlds.environment import grid, lattice

GRID, PAPER = "instances/grid-3x3-snake.lp", "instances/grid-3x4-paper.lp"


def always():
    return True


class After:
    """It is late after some questions whether it is. How often that was asked then is counted."""

    def __init__(self, questions):
        self.left, self.again = questions, 0

    def __call__(self):
        self.left -= 1
        self.again += self.left < 0
        return self.left < 0


def tangle(places, slots, seed):
    """A map with random links: some places have several between them, some have loops, and there
    may be several components."""
    draw = random.Random(seed)
    gateways = [(p, s) for p in range(places) for s in range(slots)]
    draw.shuffle(gateways)
    pairs = list(zip(gateways[::2], gateways[1::2], strict=False))[: places * slots // 3]
    links = {a: b for one, other in pairs for a, b in ((one, other), (other, one))}
    stars = {p: frozenset(range(slots)) for p in range(places)}
    return TopologicalMap(slots, stars, links)


WORLDS = {
    "a torus": grid(5, 5, "torus").map,
    "one place": TopologicalMap(4, {0: frozenset({0, 1})}, {}),
    "no gateway": TopologicalMap(4, {0: frozenset()}, {}),
    "loops": TopologicalMap(
        4, {0: frozenset(range(4))}, {(0, slot): (0, (slot + 2) % 4) for slot in range(4)}
    ),
    "two links": linked("a0 b1 b0 a1 a2 b3"),
    "a triangle": linked("a0 b1 b0 c1 c0 a1"),
    **{f"tangle {n}": tangle(3 + 4 * n, 4 + 2 * (n % 3), n) for n in range(8)},
}


@pytest.mark.parametrize("name", WORLDS)
def test_a_plain_drawing_has_every_gateway_in_its_order(name):
    world = WORLDS[name]
    laid = layout(world, late=always)
    assert set(laid.places) == set(world.stars)
    assert set(laid.lines) == set(world.gateways())
    for place, star in world.stars.items():
        slots = sorted(star)
        outs = [laid.lines[place, slot][1] - laid.lines[place, slot][0] for slot in slots]
        assert all(np.linalg.norm(out) > 0.16 for out in outs)
        angles = [-np.arctan2(*out[::-1]) for out in outs]
        turns = [(b - a) % (2 * np.pi) for a, b in pairwise([*angles, *angles[:1]])]
        if len(slots) > 1:
            assert min(turns) > 0.1
            assert np.isclose(sum(turns), 2 * np.pi)
    for gateway, end in world.links.items():
        line = laid.lines[gateway]
        assert np.allclose(line, laid.lines[end][::-1])
        assert np.allclose(line[0], laid.places[gateway[0]])
        assert len(np.unique(line[:-1].round(6), axis=0)) == len(line) - 1
    for p, q in combinations(laid.places.values(), 2):
        assert np.linalg.norm(p - q) > 0.99 * NEAREST
    met = under(world, laid.lines)
    assert laid.note in (("", NOTE) if not met else (f"{NOTE}, and {UNDER}",))
    assert len(met) <= 1
    if laid.note:  # then faces and crossings are not reported
        assert (laid.faces, laid.outer, laid.crossing) == ([], -1, [])


def test_which_of_these_are_plain():
    """What has a drawing by the compass is drawn by it, however little time there is."""
    notes = {name: layout(world, late=always).note for name, world in WORLDS.items()}
    assert notes["a torus"] == notes["loops"] == notes["a triangle"] == NOTE
    assert notes["one place"] == notes["no gateway"] == ""
    assert layout(grid(12, 12).map, late=always).note == ""


@pytest.mark.slow
@pytest.mark.parametrize("places", [MOST_PLACES // 2, MOST_PLACES + 1])
def test_a_large_map_is_drawn_plainly(places):
    """By counted work: that it ends is what is tested; places keep apart."""
    world = tangle(places, 4, 0)
    whole = max(world.parts(), key=lambda part: len(part.stars))
    lines = plain(whole, 0.36)
    assert set(lines) == set(whole.gateways())
    points = np.array(sorted({tuple(line[0]) for line in lines.values()}))
    assert len(points) == len(whole.stars)
    near = np.linalg.norm(points[:, None] - points[None], axis=-1) + np.eye(len(points))
    assert near.min() > 0.99 * NEAREST


@pytest.mark.parametrize("questions", [0, 1, 2, 5, 30, 60])
def test_a_drawing_ends_soon_after_it_is_late(questions):
    late = After(questions)
    laid = layout(grid(4, 4, "torus").map, late=late)
    assert laid.note == NOTE
    assert 1 <= late.again < 60


def test_a_drawing_that_is_done_in_time_says_nothing():
    late = After(10**9)
    laid = layout(linked("a0 b1 b0 c1 c0 a1"), late=late)
    assert laid.note == ""
    assert late.left < 10**9
    assert len(laid.faces) == 2


@pytest.mark.slow
def test_what_is_legible_when_it_is_late_is_taken():
    """Of a map with bends there are good drawings long before the best one."""
    world = linked("a0 b1 b0 c1 c0 a1")
    whole = After(10**9)
    layout(world, late=whole)
    asked = 10**9 - whole.left
    laid = layout(world, late=After(asked - 5))
    assert laid.note == ""
    assert len(laid.faces) == 2


def test_a_planar_part_is_found_in_less_time_if_it_is_late():
    world = grid(4, 4, "torus").map
    edges = len(world.edges())
    late = After(3 * edges)
    part = planar_part(world, late=late)
    assert part.genus() == 0
    assert 0 < late.again < LINK_ORDERS
    few, many = (len(routed(p, left_out(p, world))[1]) for p in (planar_part(world), part))
    assert few <= many


@pytest.mark.parametrize("number", range(10))
def test_walks_are_the_faces_however_links_come(number):
    """The planar part and its routes, found link by link, have the faces of the maps so made."""
    (world, *_) = tangle(8, 6, number).parts()
    walks = Walks(world, ())
    edges = world.edges()
    random.Random(number).shuffle(edges)
    kept = walks.planar(edges)
    rest = [link for link in edges if link not in kept]
    walks.route(rest)
    whole = walks.map()
    assert whole.genus() == 0
    assert len(whole.links) == len(world.links) + 4 * len(walks.crossings)
    of_faces = {frozenset(face) for face in whole.faces()}
    of_walks = {}
    for n, gateway in enumerate(walks.names):
        if walks.twin[n] >= 0:
            of_walks.setdefault(walks.face[n], set()).add(gateway)
    assert {frozenset(walk) for walk in of_walks.values()} == of_faces


# What commands say


def torus_file(folder):
    """A file of a map that is not planar, which has no drawing by the compass."""
    scene = walk(grid(4, 4, "torus").map, 400, random.Random(0))
    document = {"instance": "torus", "slots": 4, "complete": True, "fault": None}
    told = map_json(scene.world, tuple(scene.at))
    (folder / "torus.json").write_text(json.dumps({**document, "maps": [told]}))
    return folder / "torus.json"


@pytest.mark.slow
@pytest.mark.parametrize(
    "call", [("show",), ("draw", "-o", "map.svg"), ("export", "--format", "dot", "-o", "map.dot")]
)
def test_a_command_that_draws_plainly_says_so(topomap, tmp_path, call):
    command, *rest = call
    file = torus_file(tmp_path)
    rest = [tmp_path / one if one.startswith("map") else one for one in rest]
    done = topomap(command, file, "--timeout", "0.001", *rest)
    line = f"{file}: partial: {NOTE} (--timeout gives it more time)\n"
    assert (done.returncode, done.stderr) == (3, line)
    text = done.stdout if command == "show" else rest[-1].read_text()
    told = " ".join(text.split())
    assert "genus 1, drawn plainly" in told
    assert command != "draw" or text.endswith("</svg>\n")
    assert [one.name for one in tmp_path.iterdir() if one.name.startswith(".")] == []


@pytest.mark.parametrize("form", ["json", "graphml", "tmap2"])
def test_positions_of_a_plain_drawing_are_said_to_be_plain(inside, tmp_path, form):
    """These forms have positions too, which take a drawing."""
    file = torus_file(tmp_path)
    done = inside("export", file, "--timeout", "0.001", "--format", form)
    line = f"{file}: partial: {NOTE} (--timeout gives it more time)\n"
    assert (done.returncode, done.stderr) == (3, line)
    assert done.stdout.endswith("\n")


def test_what_ends_a_drawing_leaves_the_file_as_it_was(tmp_path):
    def stopped():
        raise Stopped("interrupted")

    scene = walk(grid(4, 4, "torus").map, 400, random.Random(0))
    file = tmp_path / "map.svg"
    file.write_text("before")
    with pytest.raises(Stopped):
        save(scene, file, stopped)
    with pytest.raises(Stopped):
        characters(scene, 80, False, late=stopped)
    assert file.read_text() == "before"
    assert [one.name for one in tmp_path.iterdir()] == ["map.svg"]


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_drawing_leaves_no_file(tmp_path, number):
    scene = walk(grid(8, 8, "torus").map, 2000, random.Random(0))
    told = map_json(scene.world, tuple(scene.at))
    file, picture = tmp_path / "torus.json", tmp_path / "map.svg"
    file.write_text(json.dumps({"instance": "torus", "slots": 4, "maps": [told]}))
    call = [BIN / "topomap", "draw", file, "--timeout", "600", "-o", picture]
    with subprocess.Popen(call, stderr=subprocess.PIPE, text=True) as process:
        while not [*tmp_path.glob(".topomap-*")] and process.poll() is None:
            time.sleep(0.02)
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (130, f"{file}: partial: interrupted\n")
    assert [one.name for one in tmp_path.iterdir()] == ["torus.json"]


def test_the_page_tells_the_limits():
    told = " ".join((ROOT / "docs/pictures.md").read_text().split())
    assert f"take {DRAWING:g} seconds at most" in told
    assert f"more than {choice.MANY}, they are not all looked for" in told
    assert (NOTE in told, SEARCH, "seven tenths" in told) == (True, 0.7, True)


@pytest.mark.slow
def test_pictures_and_characters_of_a_plain_drawing():
    scene = walk(grid(4, 4, "torus").map, 400, random.Random(0))
    assert "drawn plainly" in svg(scene, always)
    assert "drawn plainly" not in svg(walk(grid(3, 3).map, 99, random.Random(0)), always)
    text, note = characters(scene, 80, False, late=always)
    _, sizes, _, *rest = text.split("\n")
    assert (note, sizes) == (NOTE, f"{scene.title.split(chr(10))[1]}, {NOTE}")
    assert not [line for line in rest if line.startswith("links that cross")]
    assert [line for line in rest if line.startswith("the agent is at place")]
    drawn = shapes.drawing(scene.world, scene.ahead, late=always)
    assert (drawn.note, list(drawn.faces), list(drawn.crossing)) == (NOTE, [], [])
    assert shapes.part_of(drawn, scene.world) is None


def test_a_map_is_shown_before_all_are_found(monkeypatch):
    """There are eight optimal maps. If that were too many, those found first would be shown."""
    monkeypatch.setattr(choice, "MANY", 5)
    first = scenes_under(Watch(), str(ROOT / PAPER), Query())
    assert (len(first.scenes), first.fault) == (5, None)
    assert first.scenes[0].title.startswith("grid-3x4-paper: map 1 found, optimal\n")
    later = scenes_under(Watch(), str(ROOT / PAPER), Query(), number=7)
    assert [scene.at for scene in later.scenes[:5]] == [scene.at for scene in first.scenes]
    assert len(later.scenes) == 7
    monkeypatch.setattr(choice, "MANY", 8)
    whole = scenes_under(Watch(), str(ROOT / PAPER), Query())
    assert whole.scenes[7].title.startswith("grid-3x4-paper: map 8 of 8, optimal\n")
    assert [scene.at for scene in whole.scenes] == sorted(scene.at for scene in whole.scenes)
    assert {scene.at for scene in later.scenes} < {scene.at for scene in whole.scenes}


def test_where_no_optimal_map_is_found_in_time_some_map_is_shown(monkeypatch):
    monkeypatch.setattr(choice, "OPTIMAL", 0.0)
    found = scenes_under(Watch(600.0), str(ROOT / GRID), Query(frozenset({"planar"})))
    assert found.fault == "timeout"
    (scene,) = found.scenes
    assert not scene.world.pending()
    assert scene.title.startswith("grid-3x3-snake: map 1 of 1 found, not proved to be best\n")
    monkeypatch.setattr(choice, "CLOSED", 0.0)
    found = scenes_under(Watch(600.0), str(ROOT / GRID), Query(frozenset({"planar"})))
    assert [scene.kind for scene in found.scenes] == ["not proved to be best"]


@pytest.mark.slow
def test_the_page_says_which_pictures_are_plain(inside, tmp_path, monkeypatch):
    """One of the two best maps is not planar."""
    monkeypatch.setattr(chapter, "SHARE", 0.0)
    page = tmp_path / "page.html"
    done = inside("report", GRID, "-o", page)
    assert done.returncode == 3
    told = [line for line in done.stderr.splitlines() if NOTE in line]
    assert len(told) == 1
    assert told[0].startswith(f"{GRID}: partial: picture of map ")
    assert f"genus 1, {NOTE}" in " ".join(page.read_text().split())


@pytest.mark.slow
def test_from_python(tmp_path):
    import topomap

    maps = topomap.solve(topomap.read(ROOT / GRID), optimal=True)
    (one,) = [made for made in maps if made.genus]
    one.draw(tmp_path / "plain.svg", timeout=0)
    assert "drawn plainly" in (tmp_path / "plain.svg").read_text()
    one.draw(tmp_path / "well.svg", timeout=None)
    assert "drawn plainly" not in (tmp_path / "well.svg").read_text()
    with pytest.raises(ValueError, match="timeout"):
        one.draw(tmp_path / "no.svg", timeout=-1)
    assert not (tmp_path / "no.svg").exists()


def test_lattices_need_no_time():
    assert straight(lattice("triangles", 12, 12).map, late=always) is not None
