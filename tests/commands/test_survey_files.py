"""Worlds from cave surveys of Survex, and from floor plans of map_server."""

import math
import shutil
import struct
import zlib
from collections import Counter

import numpy as np
import pytest
from conftest import ROOT, run
from PIL import Image
from topomap.runtime.errors import InputError
from topomap.worlds import skeletons, surveys
from topomap.worlds.environment import grid
from topomap.worlds.files import load
from topomap.worlds.plan import Reading
from topomap.worlds.readers import read

FILES = ROOT / "tests/files"


def plan(path, text=None, **reading):
    if text is not None:
        path.write_text(text)
    return read(path, Reading(**reading))


def by_ends(made):
    """The ways of a plan, by the names of their ends, with bearings, moves and lengths that are
    rounded."""
    ways = {}
    for way in made.ways:
        (one, out), (other, back) = way.ends
        numbers = round(out % 360, 3) % 360, round(back % 360, 3) % 360
        ways[one, other, numbers] = (*(round(n, 3) + 0.0 for n in way.move), round(way.length, 3))
    return ways


def legs(path, text):
    """The ways of a survey as its legs are: the bearing out, and the length."""
    return {
        (one, other): (out, length)
        for (one, other, (out, _)), (*_, length) in by_ends(plan(path, text)).items()
    }


def test_a_cave():
    """Blocks, files that are included, units, corrections, orders of readings, splays, and a way
    that begins with a plumbed leg: it takes the direction of its second one."""
    made = plan(FILES / "cave.svx")
    one, two, three, mud = "cave.upper.1", "cave.upper.2", "cave.upper.3", "cave.lower.c"
    block = 30.48  # a hundred feet
    assert by_ends(made) == {
        (one, two, (0, 180)): (0, block, block),
        (two, three, (0, 0)): (block, 0, round(2 * 15.24 + 7 + 2 * block, 3)),
        (two, three, (90, 270)): (block, 0, block),
        (three, mud, (90, 270)): (round(10 / math.sqrt(2), 3), 0, 10),
    }
    assert made.points[one] == (500, 1000)
    assert made.points[mud] == pytest.approx((530.48 + 10 / math.sqrt(2), 1030.48), abs=1e-6)
    alone = plan(FILES / "cave/upper.svx").points  # where nothing is fixed, the first station is
    assert (alone["upper.1"], len(alone)) == ((0, 0), 4)
    assert [line.partition(": ")[2] for line in made.told] == [
        "splay legs left out: 4",
        "surface legs left out: 1",
        "lines of *data passage left out: 1",
        "legs measured again, between two stations that have one, left out: 1",
        "legs flagged duplicate left out, as other legs join what they join: 2",
        "fixed stations without a leg left out: 1 (cave.upper.99)",
        "stations without a leg left out: 3 (cave.lower.d1, cave.spare.1, cave.spare.2)",
    ]
    world = load(FILES / "cave.svx").environment.map
    assert (len(world.stars), len(world.edges()), world.slots) == (4, 4, 4)


def test_the_command_reads_a_cave(tmp_path):
    shutil.copytree(FILES, tmp_path, dirs_exist_ok=True)
    file = tmp_path / "cave.svx"
    done = run("topomap", "generate", "world", file, "--route", "tour")
    assert done.returncode == 0
    assert "places 4, ways 4, slots 4" in done.stdout
    assert f"warning: {file}: splay legs left out: 4\n" in done.stderr
    done = run("topomap", "simulate", "world", file, "--slots", "8")
    assert done.stdout.startswith("cave: 4 places, 4 ways, 0 signs\n"), done.stderr


def test_directions_are_those_along_the_way(tmp_path):
    """10 metres along, unless another length is given; a loop has at most a third of it."""
    text = "a b 4 0 0\nb c 20 90 0\nc d 1 0 0\nd e 8 0 0\n"
    file = tmp_path / "bent.svx"
    (near,) = plan(file, text, along=2).ways
    assert [end.bearing % 360 for end in near.ends] == pytest.approx([0, 180])
    (far,) = plan(file, text).ways
    assert far.ends[0].bearing == pytest.approx(math.degrees(math.atan2(6, 4)))
    assert far.ends[1].bearing % 360 == pytest.approx(180 + math.degrees(math.atan2(1, 9)))
    assert far.move == pytest.approx((20, 13))
    assert far.length == 33


LOOP = "a b 5 0 0\nb c 5 90 0\nc d 5 180 0\nd a 5 270 0\n"


def test_loops_and_parts(tmp_path):
    """A loop without a junction has a place where it begins, if loops are kept."""
    file = tmp_path / "loop.svx"
    with pytest.raises(InputError, match="no ways in it but 1 that lead back"):
        plan(file, LOOP)
    (way,) = plan(file, LOOP, loops=True, along=100).ways
    assert [end.place for end in way.ends] == ["a", "a"]
    assert (way.move, way.length) == (pytest.approx((0, 0), abs=1e-9), 20)
    # A third along is 5/3 beyond the first corner.
    assert way.ends[0].bearing == pytest.approx(math.degrees(math.atan2(5 / 3, 5)))
    hanging = plan(file, LOOP + "a x 9 250 0\n*begin far\n1 2 3 10 0\n*end far\n")
    assert set(by_ends(hanging)) == {("a", "x", (250, 70)), ("far.1", "far.2", (10, 190))}
    assert [line.partition(": ")[2] for line in hanging.told] == [
        "loops left out (--loops keeps them): 1"
    ]
    _, warnings, *_ = load(file)
    assert "not connected" in warnings[-1]
    apart = plan(file, LOOP + "x y 9 250 0\n")
    assert apart.told[0].endswith("loops without a junction left out (--loops keeps them): 1")


def test_upright_ways(tmp_path):
    """Those to a dead end are left out and named; between junctions they are refused."""
    file = tmp_path / "pit.svx"
    text = "1 2 10 0 0\n2 3 10 90 0\n2 4 5 - U\n4 5 3 20 85\n"
    made = plan(file, text)
    assert set(by_ends(made)) == {("1", "2", (0, 180)), ("2", "3", (90, 270))}
    assert made.told[-1].endswith("as they have no direction: 1 (5)")
    with pytest.raises(InputError, match=r"the way from 2 to 5 has only legs steeper than 80"):
        plan(file, text + "5 6 10 90 0\n5 7 10 180 0\n")
    made = plan(file, text + "*equate 2 5\n5 6 10 180 0\n")
    assert len(made.ways) == 3


@pytest.mark.parametrize("clino", ["U", "up", "+V", "d", "Down", "-v"])
def test_plumbed_legs_need_no_compass(tmp_path, clino):
    made = legs(tmp_path / "a.svx", f"1 2 7 - {clino}\n2 3 10 40 0\n")
    assert made == {("1", "3"): (40, 17)}


@pytest.mark.parametrize(
    ("text", "bearing", "length"),
    [
        ("1 2 10 100 0", 100, 10),
        ("*calibrate declination -3\n1 2 10 100 0", 103, 10),
        ("*declination 100 grads\n1 2 10 100 0", 190, 10),
        ("*calibrate compass 2\n1 2 10 100 0", 98, 10),
        ("*calibrate tape 0.5 2\n1 2 10 100 0", 100, 19),
        ("*calibrate tape 0.5 metres 2\n1 2 10 100 0", 100, 19.5),
        ("*units tape 0.1 metres\n1 2 10 100 0", 100, 1),
        ("*units tape yards\n*calibrate tape +1\n1 2 11 100 0", 100, 9.144),
        ("*units compass quads\n1 2 10 S34E 0", 146, 10),
        ("*units compass quads\n1 2 10 W 0", 270, 10),
        ("*units clino percent\n1 2 10 100 100", 100, 10),
        ("*data normal from to backtape backcompass backclino\n1 2 10 280 0", 100, 10),
        ("*data normal from to tape compass backcompass\n1 2 10 358 182", 0, 10),
        ("*data topofil from to ignore tape compass\n1 2 x 10 100", 100, 10),
        ("*data cartesian from to northing ignore easting ignoreall\n1 2 3 x 4 y z", 53.13, 5),
        ("*set decimal :\n*set names :_?\n1? 2 1:5 100 0", 100, 1.5),
        ("*set comment %\n1 2 10 100 0 % so", 100, 10),
        ("*begin\n*units tape feet\n*end\n1,2,10,100,0", 100, 10),
        ("*infer plumbs on\n*calibrate clino 1\n1 1a 1 0 90\n1a 2 9 100 1", 100, 10),
        ("*infer equates on\n*calibrate tape 1\n1 x 0 10 0\nx 2 11 100 0", 100, 10),
    ],
)
def test_what_legs_say(tmp_path, text, bearing, length):
    ((out, long),) = legs(tmp_path / "a.svx", text).values()
    assert (round(out, 2), long) == (bearing, pytest.approx(length))


def test_names(tmp_path):
    """Blocks qualify names; upper case is kept if it is asked for; quotes allow blanks; each
    anonymous station of three points is one of its own."""
    file = tmp_path / "a.svx"
    assert {*legs(file, "*begin A\n*begin b.C\nX y 1 2 3\n*end B.c\n*end a")} == {
        ("a.b.c.x", "a.b.c.y")
    }
    text = "*case preserve\n2a 2A 1 2 3\n*case toupper\n2a x 1 90 3\n*truncate 2\n2a12 q 2 50 0"
    assert {*legs(file, text)} == {("2a", "2A"), ("2A", "X"), ("2A", "Q")}
    assert {*legs(file, '"the pit" b 1 2 3')} == {("the pit", "b")}
    several = plan(file, "1 ... 5 0 0\n1 ... 5 90 0\n1 ... 5 180 0")
    assert len({end.place for way in several.ways for end in way.ends}) == 4


def test_encodings_and_bearings_that_stay_magnetic(tmp_path):
    file = tmp_path / "a.svx"
    file.write_bytes("*declination auto 1 2 3\n1 2 10 90 0 ; H\u00f6hle".encode("latin-1"))
    made = plan(file)
    assert made.notes == ("bearings: magnetic north",)
    assert [line.partition(": ")[2] for line in made.told] == [
        "files that are not UTF-8, read as Latin-1: 1",
        "commands *declination auto, which is not computed: bearings stay magnetic: 1",
    ]
    file.write_bytes(
        "\ufeff1 h\u00f6hle 10 90 0\r\nh\u00f6hle 3 4 0 0\r\nh\u00f6hle 4 4 180 0".encode()
    )
    assert ("1", "h\u00f6hle") in {(one, other) for one, other, _ in by_ends(plan(file))}


def test_duplicates_that_alone_join_a_passage_are_kept(tmp_path):
    text = (
        "1 2 10 0 0\n*flags duplicate\n2 3 10 90 0\n3 4 10 90 0\n*flags not duplicate\n4 5 9 0 0\n"
    )
    made = plan(tmp_path / "a.svx", text)
    assert [way.length for way in made.ways] == [39]
    assert not made.told


def test_depths_and_legs_that_nobody_measured(tmp_path):
    """A diver's tape runs along the line, that of cylindrical polar data is level; a leg without a
    survey is left out, and a reading that cannot be is counted."""
    diving = "*data diving from to tape compass fromdepth todepth\n1 2 50 90 0 30\n"
    (way,) = plan(tmp_path / "a.svx", diving).ways
    assert (way.length, way.move) == (50, (pytest.approx(40), pytest.approx(0)))
    change = "*data diving from to compass tape depthchange\n1 2 180 50 -40\n"
    (way,) = plan(tmp_path / "a.svx", change).ways
    assert way.move == (pytest.approx(0), pytest.approx(-30))
    level = "*units depth feet\n*data cylpolar from to tape compass depthchange\n1 2 30 0 100\n"
    (way,) = plan(tmp_path / "a.svx", level).ways
    assert way.move == (pytest.approx(0), pytest.approx(30))
    assert way.length == pytest.approx(math.hypot(30, 30.48))
    plumbed = plan(tmp_path / "a.svx", f"{diving}2 3 9 0 30 39\n3 4 9 0 39 39\n")
    assert [way.length for way in plumbed.ways] == [68]
    made = plan(tmp_path / "a.svx", "1 2 10 400 0\n*data nosurvey from to\n2 3\n3 4\n")
    assert [way.ends[0].bearing for way in made.ways] == [pytest.approx(40)]
    assert [line.partition(": ")[2] for line in made.told] == [
        "compass readings below 0 or above 360 degrees: 1",
        "lines of *data nosurvey left out: 2",
    ]


@pytest.mark.parametrize(
    ("text", "line", "fault"),
    [
        ("*data diving from to tape fromdepth todepth", 1, "data diving without: compass"),
        ("*data cylpolar from to tape compass clino", 1, "the reading clino is not read"),
        (
            "*data diving from to tape compass depthchange\n1 2 5 0 9",
            2,
            "the depths differ by more",
        ),
        ("*data normal station newline tape compass clino", 1, "legs on several lines"),
        ("*data normal from to tape compass newline", 1, "legs on several lines"),
        ("*data normal from to fromcount tocount compass", 1, "reading fromcount is not read"),
        ("*data normal from to tape", 1, "without: compass"),
        ("*data normal from to tape tape compass", 1, "occurs twice"),
        ("*data normal from to tape ignoreall compass", 1, "last"),
        ("*frobnicate", 1, r"\*frobnicate is not read"),
        ("*prefix a", 1, r"\*prefix is not read"),
        ("*", 1, "command must follow"),
        ("1 2 10 0", 1, "no clino: this line has 4 of 5"),
        ("1 2 10 0 0 0", 1, "'0' is more than is wanted"),
        ("1 2 ten 0 0", 1, "'ten' is not a number"),
        ("1 2 nan 0 0", 1, "'nan' is not a number"),
        ("1 2 1e3 0 0", 1, "'1e3' is not a number"),
        ("1 2 99999999999 0 0", 1, "not a number of at most"),
        ("*set decimal ,\n1 2 1.5 0 0", 2, "'1.5' is not a number"),
        ("1 2 -1 0 0", 1, "below 0"),
        ("1 2 - 0 0", 1, "no tape"),
        ("1 2 10 - 0", 1, "no compass"),
        ("1 2 10 0 91", 1, "more than 90 degrees"),
        ("1 - 10 0 0", 1, r"\*alias station - \.\."),
        ("1 .... 10 0 0", 1, "anonymous"),
        ("1 a..b 10 0 0", 1, "not the name of a station"),
        ("1 a+b 10 0 0", 1, "not the name of a station"),
        ('1 "a.b" 10 0 0', 1, "not the name of a station"),
        ('1 "ab 10 0 0', 1, "quotation mark"),
        ("1 \\a 10 0 0", 1, "from the root"),
        (f"1 {'a' * 401} 10 0 0", 1, "more than 400 characters"),
        ("*begin a\n*begin b\n*end a\n*end b", 3, r"another block .* line 2, \*begin b"),
        ("*begin a", 1, r"\*begin a has no \*end"),
        ("*end a", 1, "no block has begun"),
        ("*begin\n" * 51, 51, "more than 50 nested blocks"),
        ("*equate a", 1, "two stations"),
        ("*fix a 1 2", 1, "three coordinates"),
        ("*flags deep", 1, "'deep' is not a flag"),
        ("*flags not", 1, "a flag is wanted"),
        ("*units tape degrees", 1, "'degrees' is not a unit of tape"),
        ("*units tape 0 feet", 1, "must not be 0"),
        ("*units length", 1, "a unit is wanted"),
        ("*units width feet", 1, "'width' is not a quantity"),
        ("*calibrate tape", 1, "zero error"),
        ("*calibrate tape 1 furlongs 2", 1, "'furlongs' is not a unit"),
        ("*alias station x y", 1, "only"),
        ("*case upper", 1, "toupper"),
        ("*cartesian magnetic", 1, "only"),
        ("*infer all on", 1, "'all'"),
        ("*set eol ;", 1, "'eol' is not read"),
        ("*include", 1, "one file"),
        ("*include none", 1, "no such file"),
        ("*include /etc/passwd", 1, "outside"),
        ("*include ../a", 1, "outside"),
        ("*include a", 1, "includes itself"),
        ("1 1 10 0 0", None, "no ways"),
        ("*equate 1 2\n*fix 1", None, "no ways"),
        ("a b 10 0 0\nb c 10 180 0", None, "a again 20 metres along"),
        ("", None, "no ways"),
    ],
)
def test_surveys_refused(tmp_path, text, line, fault):
    folder = tmp_path / "cave"
    folder.mkdir()
    (tmp_path / "a.svx").write_text("1 2 10 0 0\n")
    file = folder / "a.svx"
    with pytest.raises(InputError, match=fault) as error:
        plan(file, text, along=20)
    assert str(error.value).startswith(f"{file}: " if line is None else f"{file}:{line}: ")
    assert "\n" not in str(error.value)


def test_includes_are_limited(tmp_path, monkeypatch):
    """A loop of files, a link that leads out, many files, and large ones."""
    inner = tmp_path / "in"
    inner.mkdir()
    file = inner / "a.svx"
    (inner / "b.svx").write_text("; a comment\n*include a\n")
    with pytest.raises(InputError, match=r"b\.svx:2: \*include a: .* includes itself"):
        plan(file, "*include b\n")
    (tmp_path / "out.svx").write_text("1 2 3 4 5\n")
    (inner / "link.svx").symlink_to(tmp_path / "out.svx")
    with pytest.raises(InputError, match="outside"):
        plan(file, "*include link\n")
    (inner / "c.svx").write_text("")
    monkeypatch.setattr(surveys, "MOST_FILES", 20)
    with pytest.raises(InputError, match=r"a\.svx:20: .* more than 20 files"):
        plan(file, "*include c\n" * 30)
    (inner / "c.svx").write_text(";" * 1000)
    monkeypatch.setattr(surveys, "MOST_BYTES", 5000)
    with pytest.raises(InputError, match="with what it includes, larger than"):
        plan(file, "*include c\n" * 10)
    (inner / "d.dat").write_text("")
    with pytest.raises(InputError, match="only files of Survex"):
        plan(file, "*include d.dat\n")


# Floor plans.


def corridors(width, turn=0.0, seed=0, noise=0.01):
    """A raster of three corridors across three others, turned clockwise: True where it is free."""
    apart = max(45, 3 * width)
    size = 3 * apart + 4 * width
    row, column = np.mgrid[:size, :size] - (size - 1) / 2
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    across, down = column * cos + row * sin, row * cos - column * sin
    free = np.zeros((size, size), dtype=bool)
    for middle in (-apart, 0, apart):
        for one, other in ((across, down), (down, across)):
            free |= (abs(one - middle) <= width / 2) & (abs(other) <= apart + width / 2)
    return free ^ (np.random.default_rng(seed).random(free.shape) < noise), apart


def map_file(folder, free, kind="P5", **told):
    """The files of a map of free space, of one of three kinds of image."""
    grey = np.where(free, 254, 0).astype(np.uint8)
    name = "floor.png" if kind == "png" else "floor.pgm"
    rows, columns = grey.shape
    if kind == "png":
        Image.fromarray(grey).save(folder / name)
    elif kind == "P5":
        head = f"P5\n# drawn by a test\n{columns} {rows}\n255\n"
        (folder / name).write_bytes(head.encode() + grey.tobytes())
    else:
        lines = "\n".join(" ".join(map(str, line)) for line in grey.tolist())
        (folder / name).write_text(f"P2\n{columns} {rows}\n255\n{lines}\n")
    return yaml_file(folder, image=name, **told)


GIVEN = {
    "resolution": 0.1,
    "origin": "[-10.0, 5.0, 0.0]",
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def yaml_file(folder, **told):
    file = folder / "floor.yaml"
    lines = [f"{key}: {value}" for key, value in {**GIVEN, **told}.items() if value is not None]
    file.write_text("\n".join(lines) + "\n")
    return file


RASTERS = [
    (width, turn, kind, 10 * number + seed)
    for number, kind in enumerate(("P2", "P5", "png"))
    for width in (5, 9, 21)
    for turn in (0, 10, 45)
    for seed in range(2)
]


@pytest.mark.parametrize(("width", "turn", "kind", "seed"), RASTERS)
def test_a_grid_of_corridors(tmp_path, width, turn, kind, seed):
    """It is the grid of 3 x 3 places, whose ways have the directions and the lengths drawn, in
    spite of noise in one pixel of a hundred."""
    free, apart = corridors(width, turn, seed)
    file = map_file(tmp_path, free, kind)
    made, warnings, found, _, _ = load(file, Reading(), 4, turn)
    assert (len(made.map.stars), len(found.ways)) == (9, 12)
    assert made.map.isomorphic(grid(3, 3).map)
    for way in found.ways:
        assert way.length == pytest.approx(0.1 * apart, abs=0.1 * width / 2 + 0.2)
        assert math.hypot(*way.move) == pytest.approx(0.1 * apart, abs=0.1 * width / 2 + 0.2)
        for (_, bearing), sign in zip(way.ends, (1, -1), strict=True):
            east, north = (sign * number for number in way.move)
            ahead = math.degrees(math.atan2(east, north))
            assert abs((bearing - ahead + 180) % 360 - 180) < 8
            assert abs((bearing - turn + 45) % 90 - 45) < 8
    told = dict(line.partition(": ")[2].rsplit(": ", 1) for line in warnings)
    assert told["corners taken as places"] == "4"
    # The noise that the test put in, except at the walls, is what was changed.
    changed = int(told["pixels changed, as noise or as small spots"])
    assert changed == pytest.approx(0.01 * free.size, rel=0.35)


def bend(width, radius):
    """A corridor that comes from the west, and goes to the south by a bend of a radius."""
    row, column = np.mgrid[:300, :300].astype(float)
    free = (abs(row - 150 + radius) <= width / 2) & (column <= 150) & (column > 10)
    free |= (abs(column - 150 - radius) <= width / 2) & (row >= 150) & (row < 290)
    off = abs(np.hypot(column - 150, row - 150) - radius) <= width / 2
    return free | (off & (column >= 150) & (row <= 150))


@pytest.mark.parametrize("width", [5, 9, 15])
@pytest.mark.parametrize(("radius", "places"), [(0.5, 3), (1, 3), (3, 2), (6, 2)])
def test_a_smooth_bend_is_not_a_corner(width, radius, places):
    net = skeletons.net_of(bend(width, radius * width))
    assert (len(net.where), len(net.lines)) == (places, places - 1)


def test_halls_rings_and_alcoves():
    """A hall is one place; a ring has its corners as places, or is left out and counted; an
    alcove that is less deep than half the width of the corridor is not a way."""
    row, column = np.mgrid[:200, :200] - 100
    hall = (abs(row) <= 40) & (abs(column) <= 40)
    crossing = hall | (abs(row) <= 4) | (abs(column) <= 4)
    net = skeletons.net_of(crossing)
    assert Counter(len(of) for of in net.at.values()) == {1: 4, 4: 1}
    block = np.maximum(abs(row), abs(column))
    net = skeletons.net_of((block >= 56) & (block <= 64))
    assert (len(net.where), len(net.lines), net.corners) == (4, 4, 4)
    far = np.hypot(row, column)
    net = skeletons.net_of((far >= 56) & (far <= 64))
    assert (len(net.where), net.rings) == (0, 1)
    corridor = (abs(row) <= 10) & (abs(column) <= 90)
    for deep, ways in ((4, 1), (40, 3)):
        net = skeletons.net_of(corridor | ((row < 0) & (row > -10 - deep) & (abs(column) <= 8)))
        assert len(net.lines) == ways
    assert not skeletons.net_of(np.ones((50, 50), dtype=bool)).lines
    assert not skeletons.net_of(np.zeros((50, 50), dtype=bool)).lines


def test_a_radius_merges_junctions(tmp_path):
    """Two corridors leave a long one to the north and to the south, 3 metres apart."""
    row, column = np.mgrid[:200, :200] - 100
    free = abs(row) <= 4
    free |= (abs(column - 15) <= 4) & (row < 0) | (abs(column + 15) <= 4) & (row > 0)
    file = map_file(tmp_path, free)
    assert Counter(by_degree(plan(file))) == {1: 4, 3: 2}
    assert Counter(by_degree(plan(file, radius=4.0))) == {1: 4, 4: 1}
    assert "junctions merged into others near them: 1" in " ".join(plan(file, radius=4.0).told)
    assert Counter(by_degree(plan(file, radius=2.0))) == {1: 4, 3: 2}


def by_degree(made):
    return Counter(end.place for way in made.ways for end in way.ends).values()


def test_what_the_yaml_file_says(tmp_path):
    """Negated and raw values, an image below the folder, the yaw, and what is transparent."""
    free, _ = corridors(9, noise=0)
    usual = by_ends(plan(map_file(tmp_path, free)))
    assert by_ends(plan(map_file(tmp_path, ~free, negate="true"))) == usual
    assert by_ends(plan(map_file(tmp_path, free, "png", mode="scale", free_thresh="1e-1"))) == usual
    below = tmp_path / "below"
    below.mkdir()
    Image.fromarray(np.where(free, 3, 255).astype(np.uint8)).save(below / "raw.png")
    assert by_ends(plan(yaml_file(tmp_path, image="below/raw.png", mode="raw"))) == usual
    deep = np.where(free, 65000, 0).astype(np.uint16)
    Image.fromarray(deep).save(below / "deep.png")
    assert by_ends(plan(yaml_file(tmp_path, image="below/deep.png"))) == usual
    seen = np.full((*free.shape, 4), 255, np.uint8)
    seen[..., 3] = np.where(free, 255, 0)
    Image.fromarray(seen).save(below / "seen.png")
    assert by_ends(plan(yaml_file(tmp_path, image="below/seen.png"))) == usual
    turned = plan(map_file(tmp_path, free, origin=f"[0, 0, {math.pi / 2}]"))
    straight = plan(map_file(tmp_path, free, origin="[0, 0, 0]"))
    moves = [
        {tuple(end.place for end in way.ends): way.move for way in made.ways}
        for made in (straight, turned)
    ]
    assert len(moves[0]) == len(moves[1]) == 12
    for ends, (east, north) in moves[0].items():
        assert moves[1][ends] == pytest.approx((-north, east))
    for place, (east, north) in straight.points.items():
        assert turned.points[place] == pytest.approx((-north, east))
    size = free.shape[0] / 20
    assert straight.points[5] == pytest.approx((size, size), abs=0.1)  # the middle of the image


@pytest.mark.parametrize(
    ("told", "fault"),
    [
        ({"resolution": 0}, "resolution: it must be greater than 0"),
        ({"resolution": -0.1}, "resolution: it must be greater than 0"),
        ({"resolution": ".nan"}, "resolution: it must be a number"),
        ({"resolution": ".inf"}, "resolution: it must be a number"),
        ({"resolution": "true"}, "resolution: it must be a number"),
        ({"resolution": 1e9}, "wider than"),
        ({"origin": "[0, 0]"}, "origin: it must be three numbers"),
        ({"origin": "[0, 0, x]"}, "origin: it must be a number"),
        ({"origin": "[0, 0, 90]"}, "radians"),
        ({"free_thresh": 0.7}, "0 <= free < occupied <= 1"),
        ({"occupied_thresh": 1.5}, "0 <= free < occupied <= 1"),
        ({"negate": 2}, "negate: it must be 0 or 1"),
        ({"mode": "grey"}, "mode: it must be one of: trinary, scale, raw"),
        ({"negate": None}, "negate is not given"),
        ({"free_thresh": "0.2\nfree_thresh: 0.3"}, "free_thresh is given twice"),
        ({"image": "/etc/passwd"}, "is not there"),
        ({"image": "../floor.pgm"}, "outside of the folder"),
        ({"image": "link.pgm"}, "outside of the folder"),
        ({"image": "none.pgm"}, "none.pgm is not there"),
        ({"image": "floor.yaml"}, "not a PNG or PGM image"),
        ({"image": '"a\\0b"'}, "is not the name of a file"),
        ({"image": "half.pgm"}, "half.pgm"),
        ({"image": "half.png"}, "half.png"),
        ({"image": "black.png"}, r"no way between two places .* \(0 pixels\)"),
        ({"resolution": "!!python/object/apply:os.getcwd []"}, ":1: YAML tags are refused"),
        ({"resolution": "!!float 0.1"}, ":1: YAML tags are refused"),
        ({"resolution": "&a 0.1\nx: *a"}, ":1: YAML anchors"),
        ({"resolution": "[" * 3000}, "not a YAML file"),
        ({"resolution": "}"}, "not a YAML file"),
        ({"resolution": "0.1\n---\na: 1"}, "not a YAML file"),
        ({"resolution": "0.1 #" + "x" * 70_000}, "larger than 64 KiB"),
    ],
)
def test_maps_refused(tmp_path, told, fault):
    folder = tmp_path / "maps"
    folder.mkdir()
    map_file(tmp_path, corridors(5, noise=0)[0])
    (folder / "link.pgm").symlink_to(tmp_path / "floor.pgm")
    (folder / "half.pgm").write_bytes((tmp_path / "floor.pgm").read_bytes()[:-9])
    Image.fromarray(corridors(5)[0]).save(folder / "whole.png")
    (folder / "half.png").write_bytes((folder / "whole.png").read_bytes()[:200])
    Image.new("L", (50, 50)).save(folder / "black.png")
    shutil.copy(tmp_path / "floor.pgm", folder)
    file = yaml_file(folder, **{"image": "floor.pgm", **told})
    with pytest.raises(InputError, match=fault) as error:
        plan(file)
    assert str(error.value).startswith(f"{file}:")
    assert "\n" not in str(error.value)


def test_what_map_saver_writes_for_unknown_space_is_reported(tmp_path):
    """By its usual free_thresh, 0.25, it counts as free; otherwise there is no message."""
    free, _ = corridors(9, noise=0)
    steps = [(row, column) for row in range(-3, 4) for column in range(-3, 4)]
    walls = np.any([np.roll(free, step, (0, 1)) for step in steps], axis=0)
    grey = np.where(free, 254, np.where(walls, 0, 205)).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "floor.png")
    for thresh, told in (0.25, True), (0.196, False):
        made = plan(yaml_file(tmp_path, image="floor.png", free_thresh=thresh))
        assert any("the grey value 205 is free, but" in one for one in made.told) == told
    assert len(made.points) == 9


def test_an_image_named_by_its_path_on_another_machine(tmp_path):
    map_file(tmp_path, corridors(5, noise=0)[0])
    made = plan(yaml_file(tmp_path, image="/home/robot/maps/floor.pgm"))
    assert "taken to be the file of this name beside it" in made.told[0]
    assert len(made.points) == 9


@pytest.mark.parametrize("side", [7000, 10**5, 2**31 - 1])
def test_large_images_are_refused_by_their_header(tmp_path, side):
    """No pixel of these files is there."""
    (tmp_path / "large.pgm").write_text(f"P5 {side} {side} 255\n")
    head = b"IHDR" + struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    chunk = struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head))
    (tmp_path / "large.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I", 0) + b"IDAT" + bytes(4)
    )
    for name in ("large.pgm", "large.png"):
        with pytest.raises(InputError, match=r"more than 40,000,000 pixels"):
            plan(yaml_file(tmp_path, image=name))


def test_wide_halls_in_large_images_take_too_much_work(tmp_path, monkeypatch):
    monkeypatch.setattr(skeletons, "MOST_WORK", 10**5)
    file = map_file(tmp_path, np.ones((100, 100), dtype=bool))
    with pytest.raises(InputError, match=r"too much work \(free space 100 pixels wide"):
        plan(file)


def test_the_command_reads_a_floor(tmp_path):
    file = map_file(tmp_path, corridors(9)[0])
    done = run(
        "topomap", "generate", "world", file, "--slots", "4", "--north", "0", "--route", "tour"
    )
    assert done.returncode == 0, done.stderr
    assert "places 9, ways 12, slots 4" in done.stdout
    assert "% resolution: 0.1 metres a pixel" in done.stdout


def test_without_the_extra_it_is_named(tmp_path, monkeypatch):
    file = map_file(tmp_path, corridors(9)[0])
    monkeypatch.setattr("topomap.runtime.extras.find_spec", lambda module: None)
    with pytest.raises(InputError, match=r"comes with the extra floorplan"):
        plan(file)
