"""Maps in a terminal: what is printed is read back, character by character."""

import contextlib
import itertools
import json
import math
import os
import pty
import random
import re
import subprocess
from collections import Counter

import pytest
from conftest import BIN, ROOT, TRIED, run
from topomap.api.scenes import scenes_under
from topomap.drawing.layout import layout, straight
from topomap.drawing.scenes import Scene
from topomap.drawing.terminal import ARROWS, ASCII, BRAILLE, DOTS, LETTERS, drawn
from topomap.model.experience import observe
from topomap.model.query import Query
from topomap.model.topology import TopologicalMap
from topomap.runtime.watch import Watch
from topomap.worlds.environment import by_bearing, flat_bearing, grid, lattice, maze, world

RIGHT, DOWN, LEFT, UP = range(4)
STEPS = (0, 1), (1, 0), (0, -1), (-1, 0)
LINES = "─│─│"
AHEAD = "→↓←↑"
ENDS = "╴╵╶╷"
PLACE = re.compile(r"\[\d+\]|(?<![\d(])\d+(?![\d)])")
FACE = re.compile(r"\((\d+)\)")


def walk(world, steps, draw, start=None):
    """A map as a walk through a world finds it, and the walk in it."""
    place, slot = start or draw.choice(sorted(world.links))
    begin, route = (place, slot), []
    for _ in range(steps):
        slot = draw.choice([s for s in sorted(world.stars[place]) if (place, s) in world.links])
        route.append(slot)
        place, slot = world.links[place, slot]
    seen, at = observe(world, begin, route)
    return Scene(seen.map_of(at), at, "made")


def printed(scene, width=80, coloured=False):
    """The rows of the picture, and the lines of words after it."""
    lines = drawn(scene, width, coloured)[0].split("\n")
    assert lines[:3] == [*scene.title.split("\n"), ""]
    end = lines.index("", 3)
    return lines[3:end], lines[end + 1 :]


def is_dots(rows):
    return any(BRAILLE < ord(c) < BRAILLE + 256 for row in rows for c in row)


class Read:
    """A picture of lines, read: what each place has in each direction, and the faces' numbers."""

    def __init__(self, rows):
        self.rows = rows
        self.owner, self.places, self.faces, self.agent = {}, {}, {}, None
        for y, row in enumerate(rows):
            for found in PLACE.finditer(row):
                name = int(found[0].strip("[]"))
                assert name not in self.places, f"{name} occurs twice"
                self.places[name] = [(y, x) for x in range(*found.span())]
                self.owner |= dict.fromkeys(self.places[name], name)
                if found[0][0] == "[":
                    self.agent = name
            for found in FACE.finditer(row):
                self.faces[int(found[1])] = [(y, x) for x in range(*found.span())]
        self.used = set(self.owner) | {cell for face in self.faces.values() for cell in face}
        self.standing = None
        self.ways = {}
        for name, cells in self.places.items():
            for direction, (dy, dx) in enumerate(STEPS):
                sides = {RIGHT: cells[-1:], LEFT: cells[:1]}.get(direction, cells)
                begun = [(y + dy, x + dx) for y, x in sides]
                begun = [c for c in begun if self[c] in LINES[direction] + AHEAD[direction]]
                assert len(begun) <= 1
                for cell in begun:
                    self.ways[name, direction] = self.follow(name, direction, cell)
        rest = [
            (y, x)
            for y, row in enumerate(rows)
            for x, c in enumerate(row)
            if c != " " and (y, x) not in self.used
        ]
        assert not rest, "characters that are part of nothing"

    def __getitem__(self, cell):
        y, x = cell
        return self.rows[y][x] if 0 <= y < len(self.rows) and 0 <= x < len(self.rows[y]) else " "

    def follow(self, name, direction, cell):
        (dy, dx), line = STEPS[direction], LINES[direction]
        if self[cell] == AHEAD[direction]:
            assert self.standing is None
            self.standing = name, direction
        else:
            assert self[cell] == line
        while True:
            self.used.add(cell)
            cell = cell[0] + dy, cell[1] + dx
            if cell in self.owner:
                return self.owner[cell], (direction + 2) % 4
            character = self[cell]
            if character == ENDS[direction] or character in LETTERS:
                self.used.add(cell)
                return character
            assert character == line or character == AHEAD[(direction + 2) % 4], (cell, character)

    def around(self, number):
        """The places round a face's number."""
        cells = list(self.faces[number])
        inside, touched = set(cells), set()
        while cells:
            y, x = cells.pop()
            assert -1 <= y <= len(self.rows), "the face is open"
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    cell = y + dy, x + dx
                    if cell in self.owner:
                        touched.add(self.owner[cell])
                    elif not (dy and dx) and cell not in inside and self[cell] in " ()0123456789":
                        inside.add(cell)
                        cells.append(cell)
        return touched


def expected(scene):
    """What each place has in each direction, if the first way left by goes to the right and each
    link arrives as it leaves; letters by link."""
    world = scene.world
    scale = 4 / world.slots
    first = world.links[scene.at[1]] if len(scene.at) > 1 else next(world.gateways())
    laid = straight(world, first)
    letter = {g: LETTERS[n] for n, link in enumerate(laid.crossing) for g in link}
    north = {first[0]: -first[1] * scale}
    for place in (waiting := list(north)):
        for slot in sorted(world.stars[place]):
            if (place, slot) in world.links and (place, slot) not in letter:
                other, arrival = world.links[place, slot]
                direction = north[place] + slot * scale + 2
                if other not in north:
                    north[other] = direction - arrival * scale
                    waiting.append(other)
    ways = {}
    for place, slot in world.gateways():
        direction = (north[place] + slot * scale) % 4
        assert direction == int(direction)
        if (place, slot) in letter:
            ways[place, int(direction)] = letter[place, slot]
        elif (place, slot) in world.links:
            other, arrival = world.links[place, slot]
            ways[place, int(direction)] = other, int((north[other] + arrival * scale) % 4)
        else:
            ways[place, int(direction)] = ENDS[int(direction)]
    place, slot = scene.at[-1]
    return ways, (place, (north[place] + slot * scale) % 4), laid


def agrees(scene):
    """The picture in lines is the map's."""
    rows, _ = printed(scene)
    read = Read(rows)
    ways, standing, laid = expected(scene)
    assert set(read.places) == set(scene.world.stars)
    assert read.ways == ways
    assert read.agent == scene.at[-1][0]
    assert read.standing == standing
    for number in read.faces:
        assert number - 1 != laid.outer
        assert read.around(number) == {place for place, _ in laid.faces[number - 1]}
    return read, laid


@pytest.mark.parametrize(("rows", "columns"), [(1, 2), (1, 6), (2, 2), (3, 3), (4, 5), (8, 12)])
def test_grids_are_read_back(rows, columns):
    draw = random.Random(rows)
    world = grid(rows, columns).map
    read, laid = agrees(walk(world, 100 * rows * columns, draw))
    assert len(read.places) == rows * columns
    assert len(laid.faces) - 1 == (rows - 1) * (columns - 1)
    assert set(range(1, len(laid.faces) + 1)) - set(read.faces) == {laid.outer + 1}


def shortened(world, draw):
    """The world without some of the places that have only a way straight through."""
    stars, links = dict(world.stars), dict(world.links)
    for place, star in world.stars.items():
        if len(star) == 2 and draw.random() < 0.9:
            a, b = ((place, slot) for slot in sorted(star))
            if world.opposite(a) == b and {links[a][0], links[b][0]} != {place}:
                ends = links.pop(a), links.pop(b)
                links |= dict([ends, ends[::-1]])
                del stars[place]
    return TopologicalMap(world.slots, stars, links)


def straight_scenes(number):
    """Random maps of straight lines: parts of mazes, with pending gateways and uneven links."""
    for seed in range(number):
        draw = random.Random(f"straight {seed}")
        world = maze(draw.randint(2, 7), draw.randint(2, 7), draw.random() * 0.6, seed).map
        if draw.random() < 0.8:
            world = shortened(world, draw)
        scene = walk(world, draw.choice([1, 10, 60, 200, 500]), draw)
        scale = draw.choice([1, 1, 2])  # eight slots, four of them gateways
        yield Scene(
            TopologicalMap(
                4 * scale,
                {
                    place: frozenset(scale * s for s in star)
                    for place, star in scene.world.stars.items()
                },
                {(p, scale * s): (q, scale * r) for (p, s), (q, r) in scene.world.links.items()},
            ),
            [(place, scale * slot) for place, slot in scene.at],
            "made",
        )


@pytest.mark.parametrize("cases", [60, pytest.param(1500, marks=pytest.mark.long)])
def test_random_straight_maps_are_read_back(cases):
    kinds = Counter()
    for scene in straight_scenes(cases):
        if straight(scene.world) is None:
            continue  # a picture of dots, which takes its time
        read, _ = agrees(scene)
        kinds["straight"] += 1
        kinds["pending"] += any(way in list(ENDS) for way in read.ways.values())
        kinds["faces"] += bool(read.faces)
        lengths = {
            abs(read.places[place][0][0] - read.places[way[0]][0][0])
            for (place, direction), way in read.ways.items()
            if direction == DOWN and isinstance(way, tuple)
        }
        kinds["uneven"] += len(lengths) > 1
    least = {"straight": 0.8, "pending": 0.2, "faces": 0.2, "uneven": 0.05}
    assert all(kinds[kind] > share * cases for kind, share in least.items()), kinds
    TRIED["straight maps read back from characters"] += kinds["straight"]


def test_places_with_long_numbers_and_one_place_alone():
    scene = walk(grid(9, 9).map, 3000, random.Random(0))
    assert max(scene.world.stars) > 900
    agrees(scene)
    alone = Scene(TopologicalMap(4, {0: frozenset({0, 1})}, {}), [(0, 1)], "made")
    assert printed(alone)[0] == ["[0]─╴", " ↓", " ╵"]
    bare = Scene(TopologicalMap(4, {7: frozenset()}, {}), [], "made")
    assert printed(bare)[0] == ["7"]


def with_a_bridge():
    """A grid of 4 x 4 with a gap in the middle, and a link from there to the outside."""
    world = grid(4, 4).map
    number = {place: n for n, place in enumerate(sorted(world.stars))}
    gap = {((1, 1), 1), ((1, 2), 3)}
    links = {
        (number[p], s): (number[q], r)
        for (p, s), (q, r) in world.links.items()
        if (p, s) not in gap
    }
    links |= {(5, 1): (15, 2), (15, 2): (5, 1)}
    stars = {number[place]: set(star) for place, star in world.stars.items()}
    stars[15].add(2)
    last = sorted(stars, key=lambda place: (place in (5, 15), place))  # the bridge ends come last
    world = TopologicalMap(4, {place: frozenset(stars[place]) for place in last}, links)
    return Scene(world, [(0, 1), (1, 3)], "made")


def test_links_that_cross_are_two_stubs_with_one_letter():
    scene = with_a_bridge()
    assert scene.world.genus() == 1
    read, laid = agrees(scene)
    assert laid.crossing == [((5, 1), (15, 2))]
    assert (read.ways[5, RIGHT], read.ways[15, DOWN]) == ("A", "A")
    rows, words = printed(scene)
    assert "links that cross others: A 5.1 - 15.2" in words
    assert not is_dots(rows)


@pytest.mark.long
def test_a_torus_in_dots():
    scene = walk(grid(3, 3, "torus").map, 200, random.Random(1))
    rows, words = printed(scene)
    crossing = layout(scene.world, scene.world.links[scene.at[1]]).crossing
    assert is_dots(rows)
    assert crossing
    lies_as_laid_out(rows, scene)
    told = ", ".join(f"{p}.{s} - {q}.{r}" for (p, s), (q, r) in crossing)
    assert f" links that cross others: {told} " in " ".join(map(str.strip, words))


def dots_of(rows):
    """The dots of a picture, and those of the characters that are no dots, all filled."""
    found, filled = set(), set()
    for y, row in enumerate(rows):
        for x, c in enumerate(row):
            bits = ord(c) - BRAILLE
            for dy, pair in enumerate(DOTS):
                for dx, bit in enumerate(pair):
                    if 0 < bits < 256 and bits & bit:
                        found.add((4 * y + dy, 2 * x + dx))
                    elif c != " " and not 0 < bits < 256:
                        filled.add((4 * y + dy, 2 * x + dx))
    return found, filled


def parts(cells, diagonal):
    """The connected parts of a set of cells."""
    left, found = set(cells), []
    while left:
        part = [left.pop()]
        for y, x in part:
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    if (diagonal or not (dy and dx)) and (y + dy, x + dx) in left:
                        left.remove((y + dy, x + dx))
                        part.append((y + dy, x + dx))
        found.append(part)
    return found


POINTS = (0, 0), (0, 1), (1, 1), (1, 0), (2, 0), (2, 1), (1.5, 2)
WAYS = (0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (3, 4), (4, 5), (5, 2), (2, 6), (6, 5)


def town(slots):
    """Ways straight and aslant."""
    return by_bearing(WAYS, lambda a, b: flat_bearing(POINTS[a], POINTS[b]), slots, 0)


def linked(ways):
    """The world of four slots with these ways, each two gateways."""
    ends = [(name[0], int(name[1])) for name in ways.split()]
    links = dict(zip(ends[::2], ends[1::2], strict=True))
    return world(4, links | {there: here for here, there in links.items()})


DOTTED = [  # maps that are bent, or aslant, of 6, 8, 12 and 4 slots; and how long a walk
    (lattice("hexagons", 2, 3).map, 400),
    (lattice("triangles", 3, 4).map, 600),
    (town(8), 100),
    (town(12), 100),
    (linked("a0 b1 b0 c1 c0 a1"), 5),
    (linked("a1 b3 a2 b2 b1 c3 b0 c0"), 20),
]


def lies_as_laid_out(rows, scene):
    """Places lie to each other as in the layout, and the arrow to the agent's place."""
    laid = layout(scene.world, scene.world.links[scene.at[1]])
    cells = {
        int(found[0].strip("[]")): (found.start() + found.end(), -4 * y)
        for y, row in enumerate(rows)
        for found in PLACE.finditer(row)
    }
    for p, q in itertools.permutations(cells, 2):
        for axis in (0, 1):
            if laid.places[q][axis] - laid.places[p][axis] > 0.6:
                assert cells[q][axis] > cells[p][axis]
    ((x, y, arrow),) = [
        (2 * x + 1, -4 * y, c)
        for y, row in enumerate(rows)
        for x, c in enumerate(row)
        if c in ARROWS
    ]
    place, _ = scene.at[-1]
    out = laid.lines[scene.at[-1]][1] - laid.places[place]
    angle = 2 * math.pi * ARROWS.index(arrow) / 8
    here = cells[place]
    assert (x - here[0]) * out[0] + (y - here[1]) * out[1] > 0
    assert math.cos(angle) * out[0] + math.sin(angle) * out[1] > 0.9 * math.hypot(*out)


def test_numbers_are_all_there_where_there_is_little_room():
    scene = walk(lattice("triangles", 4, 6).map, 3000, random.Random(0))
    rows, _ = printed(scene, 20)
    names = PLACE.findall("\n".join(rows))
    assert sorted(int(name.strip("[]")) for name in names) == sorted(scene.world.stars)
    assert max(map(len, rows)) > 20
    rows, _ = printed(walk(*DOTTED[1], random.Random(0)), 40)
    assert max(map(len, rows)) <= 40


@pytest.mark.parametrize("width", [60, 100])
@pytest.mark.parametrize("which", range(len(DOTTED)))
def test_maps_of_dots(which, width):
    scene = walk(*DOTTED[which], random.Random(0))
    rows, words = printed(scene, width)
    assert is_dots(rows)
    assert max(map(len, rows)) <= width
    names = re.findall(r"\[\d+\]|(?<![\d(])\d+(?![\d)])", "\n".join(rows))
    assert sorted(int(name.strip("[]")) for name in names) == sorted(scene.world.stars)
    assert [int(name[1:-1]) for name in names if name[0] == "["] == [scene.at[-1][0]]
    lies_as_laid_out(rows, scene)
    bare = [FACE.sub(lambda found: " " * len(found[0]), row) for row in rows]
    found, filled = dots_of(bare)
    assert len(parts(found | filled, diagonal=True)) == 1
    height, wide = 4 * len(rows), 2 * max(map(len, rows))
    empty = {(y, x) for y in range(-1, height + 1) for x in range(-1, wide + 1)} - found - filled
    regions = [part for part in parts(empty, diagonal=False) if len(part) > 12]
    laid = layout(scene.world, scene.world.links[scene.at[1]])
    assert len(regions) == len(laid.faces)
    numbers = [int(number) for number in FACE.findall("\n".join(rows))]
    assert len(set(numbers)) == len(numbers)
    assert {*numbers, laid.outer + 1} <= set(range(1, len(laid.faces) + 1))
    told = " ".join(map(str.strip, words))
    for path in scene.world.paths():
        assert ": " + " ".join(str(place) for place, _ in path) + " " in told
    print("\n".join([*rows, *words]))


def call(*arguments, **environment):
    """What the command prints where stdout is a terminal."""
    here, there = pty.openpty()
    env = {k: v for k, v in os.environ.items() if k != "NO_COLOR"} | environment
    done = subprocess.Popen([BIN / "topomap", *arguments], stdout=there, env=env, cwd=ROOT)
    os.close(there)
    shown = b""
    with contextlib.suppress(OSError):  # a terminal reports its end as an OSError
        while piece := os.read(here, 1 << 16):
            shown += piece
    os.close(here)
    assert done.wait() == 0
    return shown.decode().replace("\r\n", "\n")


SHOWN = "show", "instances/grid-3x3-snake.lp", "--planar"
ESCAPE = re.compile(r"\x1b\[[\d;]*m")


@pytest.mark.long
def test_colour_is_for_terminals(topomap):
    plain = topomap(*SHOWN)
    assert plain.returncode == 0
    assert "\x1b" not in plain.stdout
    coloured = call(*SHOWN, TERM="xterm")
    assert ESCAPE.sub("", coloured) == plain.stdout
    assert len(ESCAPE.findall(coloured)) >= 2 * 9
    assert call(*SHOWN, TERM="xterm", NO_COLOR="1") == plain.stdout
    assert call(*SHOWN, TERM="dumb") == plain.stdout


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_other_encodings(topomap, encoding):
    env = {**os.environ, "PYTHONIOENCODING": encoding}
    done = topomap(*SHOWN, env=env)
    assert done.returncode == 0
    assert done.stdout.isascii()
    assert "[0]-----1" in done.stdout


def test_a_picture_in_ascii_has_no_other_characters():
    for made, steps in DOTTED[:4]:
        shown = drawn(walk(made, steps, random.Random(0)), 70)[0]
        assert not shown.isascii()
        assert shown.translate(ASCII).isascii()


def test_names_do_not_speak_to_the_terminal(topomap, tmp_path):
    file = tmp_path / "maps.json"
    sign = "\x1b]0;bad\x07\n"
    place = {"place": 0, "gateways": [0], "landmarks": [sign]}
    entry = {"at": [[0, 0, 0]], "places": [place], "links": []}
    file.write_text(json.dumps({"instance": "x" + sign, "slots": 4, "maps": [entry]}))
    done = topomap("show", file)
    assert done.returncode == 0
    assert all(c.isprintable() or c == "\n" for c in done.stdout)
    assert done.stdout.startswith("x\\x1b]0;bad\\x07\\n: map 1 of 1 found\n1 place, ")


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"at": [[0, 5, 0]]}, "at begins at a gateway that is not there"),
        ({"places": [{"place": float("inf"), "gateways": [0], "landmarks": []}]}, "not as solve"),
        ({"places": [{"place": 10**30, "gateways": [0], "landmarks": []}]}, "not as solve"),
    ],
)
def test_maps_that_cannot_be_shown(topomap, tmp_path, change, fault):
    file = tmp_path / "maps.json"
    place = {"place": 0, "gateways": [0], "landmarks": []}
    entry = {"at": [[0, 0, 0]], "places": [place], "links": [], **change}
    file.write_text(json.dumps({"slots": 4, "maps": [entry]}))
    done = topomap("show", file)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert fault in done.stderr
    assert str(file) in done.stderr


def test_no_map_in_time_is_said_once(topomap):
    done = topomap("show", "instances/manhattan-tour88-signs30.lp", "--timeout", "0.01")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (3, "", 1)


def test_places_that_are_drawn_close_together_make_no_endless_picture(monkeypatch):
    """Once such a map had lines of a hundred thousand characters."""

    def close(made, ahead, late, where):
        laid = layout(made, ahead)
        laid.places.update(dict.fromkeys(list(laid.places)[:2], next(iter(laid.places.values()))))
        return laid

    scene = walk(lattice("triangles", 2, 2).map, 12, random.Random(1))
    monkeypatch.setattr("topomap.drawing.terminal.layout", close)
    rows, _ = printed(scene, 80)
    assert is_dots(rows)
    assert 80 < max(map(len, rows)) < 5 * 80


# Maps that clingo found


GRID, PAPER = "instances/grid-3x3-snake.lp", "instances/grid-3x4-paper.lp"


def clingo(*arguments, instance=GRID):
    """What clingo prints of an instance, as JSON."""
    parts = [f"encodings/{part}.lp" for part in arguments if not part.startswith("-")]
    options = [option for option in arguments if option.startswith("-")]
    return run("clingo", "encodings/topomap.lp", *parts, instance, "--outf=2", *options).stdout


@pytest.fixture(scope="module")
def closed():
    return clingo("closed", "-n0")


def test_maps_of_clingo_are_shown_with_their_instance(topomap, inside, closed, tmp_path):
    """As they are shown from what solve writes of them."""
    solved, given = tmp_path / "solved.json", tmp_path / "given.json"
    inside("solve", GRID, "--closed", "--json", "-o", solved)
    given.write_text(closed)
    ours = [tuple(map(tuple, one["at"])) for one in json.loads(solved.read_text())["maps"]]
    witnesses = json.loads(closed)["Call"][0]["Witnesses"]
    for number, witness in list(enumerate(witnesses, 1))[::4]:
        atoms = [tuple(map(int, re.findall(r"\d+", atom))) for atom in witness["Value"]]
        same = ours.index(tuple(sorted(atoms))) + 1
        shown = inside("show", GRID, given, "--map", number)
        alone = inside("show", solved, "--map", same)
        assert (shown.returncode, shown.stderr, alone.returncode) == (0, "", 0)
        head, *rest = shown.stdout.splitlines()
        assert head == f"grid-3x3-snake: map {number} of {len(witnesses)} given"
        assert rest == alone.stdout.splitlines()[1:]
    piped = topomap("show", GRID, "-", "--map", number, input=closed)
    assert (piped.stdout, piped.stderr) == (shown.stdout, "")


@pytest.mark.parametrize(
    ("arguments", "title"),
    [
        (("closed", "planar", "perpendicular", "-n0"), "the only map given"),
        (("closed", "-n1"), "map 1 of 1 found"),
        (("closed", "boundary", "minimal", "-n0", "--opt-mode=optN"), "map 1 of 2 given"),
        # There are two best maps; clingo says More: no, and Optimal: 1.
        (("closed", "boundary", "minimal", "-n0"), "map 1 of 1 found"),
        (("closed", "-n0", "-q1"), "map 1 of 1 found"),
        # All within a bound were asked for, and cost as they may.
        (("closed", "minimal", "-n0", "--opt-mode=enum,99,99"), "map 1 of 4 given"),
        (
            ("planar", "boundary", "minimal", "closed", "-n0", "--opt-mode=optN"),
            "the only map given",
        ),
    ],
)
def test_a_map_of_clingo_is_the_only_one_given_if_clingo_gave_all(tmp_path, arguments, title):
    file = tmp_path / "maps.json"
    file.write_text(clingo(*arguments))
    assert first(file).title.startswith(f"grid-3x3-snake: {title}\n")


def first(file):
    """The first map of a file, as it is shown."""
    found, fault, _ = scenes_under(Watch(), str(ROOT / GRID), Query(), str(file))
    assert fault is None
    return found[0]


def test_an_interrupted_clingo_has_not_given_all(tmp_path, closed):
    file = tmp_path / "maps.json"
    told = json.loads(closed)
    for change in ({"More": "yes"}, {"Number": 9}, {"More": "no", "Brave": "yes"}, None):
        file.write_text(json.dumps({**told, "Models": {**told["Models"], **(change or {})}}))
        which = f"map 1 of 4 {'found' if change else 'given'}"
        assert first(file).title.startswith(f"grid-3x3-snake: {which}\n")
    del told["Models"]
    file.write_text(json.dumps(told))
    assert first(file).title.startswith("grid-3x3-snake: map 1 of 4 found\n")


def test_maps_of_clingo_are_not_shown_without_the_right_instance(inside, tmp_path, closed):
    file = tmp_path / "maps.json"
    file.write_text(closed)
    for call, fault in (
        ((file,), f"{file}: maps from clingo: the instance is wanted before them, "),
        ((PAPER, file), f"{file}: map 1: step "),
        ((GRID, file, "--planar"), f"{file}: these are maps, so parts, bound and"),
        ((GRID, file, "--map", 5), f"{file}: it has 4 maps, there is no map 5"),
        ((file, file), f"{file}:1: the facts of an instance are wanted"),
        (("-", "-"), "-: standard input is the instance or the maps, not both"),
    ):
        for command in (["show"], ["export", "--format", "dot"]):
            done = inside(*command, *call)
            assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
            assert done.stderr.startswith(fault), done.stderr
    picture = tmp_path / "map.svg"
    done = inside("draw", PAPER, file, "-o", picture)
    assert (done.returncode, picture.exists()) == (2, False)
    assert inside("draw", GRID, file, "-o", picture).returncode == 0
    assert "map 2 of 4 given" in inside("export", GRID, file, "--format=dot", "--map=2").stdout


@pytest.mark.long
def test_a_map_with_misread_views_is_shown_as_corrected(topomap):
    instance = "instances/grid-3x3-misread.lp"
    options = "noise", "closed", "planar", "minimal", "-n0", "--opt-mode=optN", "--const=noise=1"
    given = clingo(*options, instance=instance)
    assert "misread" in given
    done = topomap("show", instance, "-", input=given)
    assert (done.returncode, done.stderr) == (0, "")
    assert "9 places, 12 links, 6 paths, planar" in done.stdout


def test_of_a_file_of_several_instances_those_of_one_are_shown(inside, tmp_path):
    file = tmp_path / "maps.json"
    assert not inside("solve", GRID, PAPER, "--optimal", "--json", "-o", file).returncode
    done = inside("show", PAPER, file, "--map", 8)
    assert done.stdout.startswith("grid-3x4-paper: map 8 of 8, optimal\n")
    done = inside("show", "instances/grid-4x4-snake.lp", file)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
