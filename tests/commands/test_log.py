"""Logs of explorers, CSV and JSON lines: what is read of them, which slots are chosen, and what is
refused. Walks through random worlds are written down as such logs, and read back."""

import csv
import io
import json
import random

import pytest
import topomap
from conftest import ROOT, answers
from oracles.worlds import random_world, wandering
from topomap.model.experience import Experience, observe
from topomap.worlds import rows
from topomap.worlds.environment import grid
from topomap.worlds.logs import LETTERS

CASES = 150
FILES = ROOT / "tests/files"

COURTYARD = """\
slots(4).
view(0,0). view(0,1). landmark(0,gate).
turn(1,0). view(1,0). view(1,1). view(1,2).
turn(2,1). view(2,0). view(2,1).
turn(3,1). view(3,0). view(3,1). landmark(3,well).
turn(4,1). view(4,0). view(4,1). view(4,2).
turn(5,1). view(5,0). view(5,1). landmark(5,gate).
"""
STREETS = r"""slots(4).
view(0,0). landmark(0,"Main St"). landmark(0,7). landmark(0,f(1)). drop(0). compass(0,1).
turn(1,0). view(1,0). view(1,1). drop(1,coin). compass(1,3). shift(1,250,0). length(1,250).
turn(2,1). view(2,0). view(2,3). landmark(2,"say \"hi\""). compass(2,2). shift(2,0,125). length(2,100).
turn(3,0). view(3,0). view(3,3). marker(3,coin). compass(3,0).
look(4). view(4,0). view(4,3). marker(4,coin). compass(4,0).
turn(5,3). view(5,0). landmark(5,"Main St"). landmark(5,7). landmark(5,f(1)). marker(5). compass(5,1). shift(5,-250,0). length(5,250).
start(6). view(6,0). compass(6,0).
"""  # noqa: E501


@pytest.fixture
def read(tmp_path):
    """Reads a text as a log."""

    def read(text, **options):
        file = tmp_path / "walk.txt"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return topomap.read_log(file, **options)

    return read


def faults(read, text, **options):
    """The fault of a log, without the folder of the file."""
    with pytest.raises(topomap.InputError) as fault:
        read(text, **options)
    said = str(fault.value)
    assert "\n" not in said
    assert len(said) < 400
    return said[said.index("walk.txt") :]


@pytest.mark.parametrize("file", ["courtyard.csv", "courtyard.jsonl"])
def test_a_log_by_hand_in_both_forms(file):
    log = topomap.read_log(FILES / file)
    assert log.experience.facts() == COURTYARD
    assert (log.slots, log.tolerance, log.frame, log.north) == (4, 0, "arrival", None)
    assert "4 slots and tolerance 0: all bearings are within 3 degrees" in log.chosen
    assert not log.warnings


def test_all_columns_with_a_bom_and_quotes():
    """Columns in another order, separated by semicolons, lines that end as on Windows."""
    log = topomap.read_log(FILES / "streets.csv")
    assert log.experience.facts() == STREETS
    assert (log.frame, log.north, log.unit) == ("north", 0, 0.01)


def test_the_command_writes_what_validate_accepts(topomap, tmp_path):
    target = tmp_path / "made.lp"
    done = topomap("log", FILES / "streets.csv", "-o", target)
    assert (done.returncode, done.stdout) == (0, "")
    assert done.stderr.count("\n") == 1
    assert "--slots and --tolerance choose otherwise" in done.stderr
    header, _, facts = target.read_text().partition("\n\n")
    assert facts == STREETS
    assert header.startswith("% streets\n")
    assert header.endswith("% made by: topomap log streets.csv")
    assert topomap("validate", target).returncode == 0
    told = json.loads(topomap("log", FILES / "streets.csv", "--json", "-o", target).stdout)
    assert (told["file"], told["facts"], told["steps"]) == (str(target), STREETS, 6)
    assert topomap("log", FILES / "streets.csv").stdout == target.read_text()


def test_nothing_is_half_written(topomap, tmp_path):
    bad, target = tmp_path / "bad.csv", tmp_path / "made.lp"
    bad.write_text("exits,taken\n0,0\n0 90,45\n0,\n")
    target.write_text("kept")
    done = topomap("log", bad, "-o", target)
    assert (done.returncode, done.stdout) == (2, "")
    said = "exit '45' is taken, but the exits seen are 0, 90"
    assert done.stderr == f"{bad}:3: step 1: {said}\n"
    assert target.read_text() == "kept"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.csv", "made.lp"]
    good = tmp_path / "good.csv"
    good.write_text("exits,taken\n0,0\n0,\n")
    assert topomap("log", good, "-o", good).returncode == 2
    assert good.read_text().startswith("exits")


def test_the_options_of_the_call_are_in_the_header(topomap):
    options = ["--slots", "8", "--tolerance", "1", "--straight", "20", "--unit", "0.5"]
    made = topomap("log", FILES / "courtyard.csv", *options)
    assert f"% made by: topomap log courtyard.csv {' '.join(options)}\n" in made.stdout
    assert "% to be read with: --tolerance 1\n" in made.stdout
    assert made.stderr == ""


def written(visits, form, draw):
    """Visits, dictionaries of the cells, as a text in one of the forms."""
    if form == "jsonl":
        lines = []
        for visit in visits:
            names = draw.sample(sorted(visit), len(visit))
            lines.append(json.dumps({name: visit[name] for name in names}))
        return "\n".join(lines)
    names = sorted({name for visit in visits for name in visit})
    draw.shuffle(names)
    delimiter = draw.choice(",;\t")
    out = io.StringIO()
    table = csv.writer(out, delimiter=delimiter, lineterminator=draw.choice(["\n", "\r\n"]))
    table.writerow(names)
    for visit in visits:
        cells = [visit.get(name) for name in names]
        table.writerow(
            [
                "; ".join(cell)
                if name == "landmarks" and cell
                else " ".join(map(str, cell))
                if isinstance(cell, list)
                else ""
                if cell is None
                else cell
                for name, cell in zip(names, cells, strict=True)
            ]
        )
    return draw.choice(["", "\ufeff"]) + out.getvalue()


def logged(world, dstates, route, frame, draw, facing="back", letters=False):
    """A walk as visits with bearings."""
    visits = []
    for step, (place, slot) in enumerate(dstates):

        def bearing(other, slot=slot):
            turned = other if frame == "north" else other - slot
            angle = 360 * (turned % world.slots) / world.slots
            if frame == "arrival" and facing == "ahead":
                angle = (angle + 180) % 360
            if letters:
                return LETTERS[round(angle * 16 / 360)]
            return angle + draw.choice([0, 0, -360]) if draw.random() < 0.1 else angle

        visit = {"exits": [bearing(other) for other in sorted(world.stars[place])]}
        draw.shuffle(visit["exits"])
        visit["taken"] = bearing(route[step]) if step < len(route) else None
        if frame == "north" or step == 0 or draw.random() < 0.2:
            visit["arrived"] = bearing(slot)
        if world.landmarks.get(place):
            visit["landmarks"] = sorted(world.landmarks[place])
        visits.append(visit)
    return visits


def compassed(seen, dstates):
    """An experience with a compass."""
    return Experience(
        *(seen.slots, seen.views, seen.turns, seen.landmarks),
        compass=[slot for _, slot in dstates],
    )


@pytest.mark.slow
@pytest.mark.parametrize("form", ["csv", "jsonl"])
@pytest.mark.parametrize("frame", ["arrival", "north"])
def test_walks_are_read_back(read, form, frame, record_property):
    """With the slots of the world the experience is the same, and with those that are chosen there
    are as many maps."""
    fewer = 0
    for number in range(25):
        draw = random.Random(f"log {form} {frame} {number}")
        world = random_world(draw)
        start = draw.choice(sorted(world.links))
        route, dstates = wandering(draw, world, start, 8)
        seen, _ = observe(world, start, route)
        if frame == "north":
            seen = compassed(seen, dstates)
        facing = draw.choice(["back", "ahead"])
        letters = frame == "north" and 16 % world.slots == 0 and draw.random() < 0.5
        text = written(logged(world, dstates, route, frame, draw, facing, letters), form, draw)
        options = {"frame": frame, "facing": facing}
        same = read(text, slots=world.slots, **options)
        found = replace_compass(same.experience, seen, same)
        assert found.facts() == seen.facts()
        chosen = read(text, **options)
        assert chosen.tolerance == 0
        assert chosen.straight is None
        fewer += chosen.slots != world.slots
        assert len(answers((), chosen.experience.facts())) == len(answers((), seen.facts()))
    assert fewer
    record_property("walks written as logs and read back", 25)


def replace_compass(found, seen, log):
    """With a world of few bearings slot 0 may be turned: then the compass is turned by as much."""
    if not found.compass or found.compass[0] == seen.compass[0]:
        return found
    by = seen.compass[0] - found.compass[0]
    assert (log.north - by * 360 / found.slots) % 360 == pytest.approx(0, abs=1e-6)
    return replace_field(found, [(slot + by) % found.slots for slot in found.compass])


def replace_field(found, compass):
    return Experience(*(found.slots, found.views, found.turns, found.landmarks), compass=compass)


@pytest.mark.parametrize("kind", ["grid", "hexagons"])
def test_generated_walks_with_all_that_is_measured(read, kind):
    """Ways are straight in these worlds, so the exits of arrival need not be given."""
    given = {"compass": True, "odometry": 0, "lengths": True, "signs": 0.5, "seed": 4}
    made = topomap.generate(kind, 2, 3, route="walk", steps=30, **given)
    seen = made.experience
    visits = []
    stood = seen.compass
    for step, view in enumerate(seen.views):

        def bearing(slot, step=step):
            return 360 * ((slot + stood[step]) % seen.slots) / seen.slots

        visit = {"exits": [bearing(slot) for slot in view]}
        visit["landmarks"] = sorted(seen.landmarks[step])
        if step < seen.steps:
            visit["taken"] = bearing(seen.turns[step])
            visit["length"] = seen.lengths[step] / 100
            visit["east"], visit["north"] = (one / 100 for one in seen.shifts[step])
        visits.append(visit)
    for form in ("csv", "jsonl"):
        text = written(visits, form, random.Random(kind))
        log = read(text, frame="north", straight_ways=40, slots=seen.slots, unit=0.01)
        assert log.experience.facts() == seen.facts()
        assert log.text().endswith(seen.facts())


def test_bearings_that_are_a_little_off_fit_the_fewest_slots(read):
    """Also where the whole is turned; then the log tells how it is turned."""
    made = topomap.generate("grid", 3, 3, route="snake", compass=True).experience
    for number in range(10):
        draw = random.Random(f"off {number}")
        turn = draw.choice([0, 29, -40])
        visits = []
        for step, view in enumerate(made.views):
            slots = [(slot + made.compass[step]) % 4 for slot in sorted(view)]
            exits = [round(turn + 90 * slot + draw.uniform(-5, 5), 2) for slot in slots]
            taken = None
            if step < made.steps:
                taken = exits[sorted(view).index(made.turns[step])]
            visits.append({"exits": exits, "taken": taken})
        log = read(written(visits, "csv", draw), frame="north", straight_ways=20)
        assert log.slots == 4
        assert log.experience.facts() == made.facts()
        assert log.north == pytest.approx(turn, abs=5)
        assert "all bearings are within" in log.chosen


def rough(draw, error, steps):
    """A walk through a grid whose exits point up to 20 degrees beside those of four slots, read
    with an error: its visits, what is seen without any in four slots, and the true hypothesis."""
    world = grid(2, 3).map
    beside = {out: draw.choice([-20, -15, 0, 15, 20]) for out in sorted(world.links)}
    start = draw.choice(sorted(world.links))
    place, slot = start
    route = []
    for _ in range(steps):
        back = slot if draw.random() < 0.4 else draw.choice(sorted(world.stars[place]))
        route.append(back)
        place, slot = world.links[place, back]
    seen, truth = observe(world, start, route)
    dstates = [start]
    for slot in route:
        dstates.append(world.links[dstates[-1][0], slot])
    visits = []
    for step, (place, at) in enumerate(dstates):

        def bearing(out):
            return 90 * out[1] + beside[out]

        read_at = {
            other: (bearing((place, other)) - bearing((place, at)) + draw.uniform(-error, error))
            % 360
            for other in sorted(world.stars[place])
        }
        read_at[at] = 0.0
        visit = {"exits": [round(one, 1) for one in read_at.values()]}
        visit["taken"] = round(read_at[route[step]], 1) if step < len(route) else None
        visit["arrived"] = 0
        visits.append(visit)
    return visits, seen, truth


def in_slots(seen, fine, truth):
    """The true hypothesis in the slots of another experience of the same walk."""
    return tuple(
        (place, sorted(fine.views[place])[sorted(seen.views[place]).index(slot)])
        for place, slot in truth
    )


def test_bearings_that_fit_no_slots_have_a_tolerance(read):
    """It is measured where the walk goes back, and the truth is consistent with it."""
    for number in range(20):
        draw = random.Random(f"rough {number}")
        visits, seen, truth = rough(draw, 2, 60)
        log = read(written(visits, draw.choice(["csv", "jsonl"]), draw))
        assert log.slots == 360
        assert 3 <= log.tolerance <= 13  # three errors, twice, and rounding
        assert "by which bearings of one exit differ" in log.chosen
        assert not log.warnings
        fine = log.experience
        there = in_slots(seen, fine, truth)
        for step, (place, slot) in enumerate(there):
            assert fine.alike(place, slot, step), (number, step)
        exact = read(written(visits, "csv", draw), tolerance=0).experience
        off = [exact.alike(*dstate, step) for step, dstate in enumerate(there)]
        assert not all(off)


def test_the_truth_is_among_the_maps_of_a_rough_log(read):
    found = 0
    for number in range(10):
        draw = random.Random(f"maps of a rough log {number}")
        visits, seen, truth = rough(draw, 1, 8)
        fine = read(written(visits, "csv", draw), tolerance=4).experience
        maps = {one.at for one in topomap.solve(fine)}
        assert in_slots(seen, fine, truth) in maps
        found += len(maps)
    assert found > 10


def test_what_is_chosen_is_reported(read):
    """What was measured, what is a guess, and what is on one path."""
    bend = "exits,taken\n0 33 171,0\n0,0\n0 32 173,32\n0,"
    log = read(bend)
    assert (log.slots, log.tolerance, log.straight) == (360, 4, 35)
    assert "tolerance 4: twice the 2 degrees by which bearings of one exit differ" in log.chosen
    assert "straight(0,0,171)" in log.text()
    assert "straight(2,0,173)" in log.text()
    none = read(bend, straight=0).experience
    assert none.straight == (frozenset(),) * 4
    assert none.facts().count("straight") == 1  # which says that there are none
    guess = read("exits,taken\n0 33 171,0\n0,")
    assert guess.tolerance == 5
    assert "a guess of 5 degrees, as no exit is surely seen twice" in guess.chosen
    given = read(bend, slots=12, tolerance=1, straight=20)
    assert given.chosen is None
    assert (given.slots, given.tolerance) == (12, 1)
    degrees = read("exits,taken\n0 90,0\n0,", tolerance=3)
    assert (degrees.slots, degrees.tolerance) == (360, 3)


def test_a_place_that_changed_is_warned_of(read):
    """The walk goes out and back, and one exit less is seen."""
    log = read("exits,taken\n0 90,0\n0,0\n0,")
    assert [one.partition("walk.txt")[2] for one in log.warnings] == [
        ":4: step 2: it must be the place after step 0, as a known way leads there, but it looks "
        "different"
    ]
    assert not [*topomap.solve(log.experience)]
    assert not read("exits,taken\n0 90,0\n0,0\n0 90,").warnings


@pytest.mark.parametrize(
    "text",
    [
        'exits,taken\n"0,90",90\n"0, 180",\n',
        "exits;taken\n0|90;90\n0 / 180\n",
        "exits\ttaken\r0\u00b0 90\u00b0\t90\u00b0\r0 -180.0\r",
        '{"exits": "0,90", "taken": 90}\n{"exits": ["0", 180], "taken": null, "look": false}',
    ],
)
def test_how_bearings_may_be_written(read, text):
    facts = "slots(4).\nview(0,0). view(0,3).\nturn(1,0). view(1,0). view(1,2).\n"
    assert read(text).experience.facts() == facts


def test_bearings_from_ahead(read):
    """The exit of arrival is the one nearest to 180, up to 10 degrees beside it, and the others
    count from it."""
    back = "exits,taken\n0,0\n189.5 99.5 9.5,9.5\n170.5,"
    assert read(back, facing="ahead").experience.facts() == (
        "slots(4).\nview(0,0).\nturn(1,0). view(1,0). view(1,2). view(1,3).\n"
        "turn(2,2). view(2,0).\n"
    )
    assert "is within 10 degrees of 180" in faults(read, back.replace("170", "169"), facing="ahead")


def test_looks_and_starts(read):
    """A start that is left after a second look stands at the exit that is then taken."""
    log = read("exits,taken,look,start\n10 100,,,\n101 11,101,yes,\n0,,,\n180 0,0,,yes\n0,,,\n")
    assert log.experience.facts() == (
        "slots(4).\nview(0,0). view(0,3).\nlook(1). view(1,0). view(1,3).\nturn(2,0). view(2,0).\n"
        "start(3). view(3,0). view(3,2).\nturn(4,0). view(4,0).\n"
    )


def test_displacements_and_decimal_commas(read):
    """A displacement may stand in one column; and where columns are not separated by commas,
    numbers may have them."""
    rows = '{"exits": ["N"], "taken": "N", "displacement": [0.5, 12]}\n{"exits": ["S"]}\n'
    table = "exits;taken;east;north\nN;N;0,5;12\nS;;;\n"
    plain = "exits,taken,east,north\nN,N,0.5,12\nS,,,\n"
    one, two, three = (read(text, straight_ways=10).experience for text in (rows, table, plain))
    assert one == two == three
    assert one.shifts
    bent = "exits;taken\n0,5 90,5;90,5\n0,5;\n"
    assert read(bent).experience == read(bent.replace(",", ".").replace(";", ",")).experience


GOOD = "exits,taken\n0 90,90\n0,\n"
HOSTILE = [
    (
        "exits,taken,displacement\nN,N,1\nS,,\n",
        ":2: step 0: displacement: there must be two numbers, east and north",
    ),
    ("", "walk.txt: there are no rows in it"),
    ("exits,taken\n", "walk.txt: there are no rows in it"),
    ("exits,taken\n0 90,45\n0,\n", ":2: step 0: exit '45' is taken, but the exits seen are 0, 90"),
    ("exits,taken\n0,0\n,0\n0,\n", ":3: step 1: exits: there are none;"),
    ("exits,takn\n0,0\n", ":1: column 'takn' is not known; did you mean taken?"),
    ("exits,x\n0,0\n", ":1: column 'x' is not known; known are exits, taken,"),
    ("exits,taken,exits\n0,0,0\n", ":1: column exits occurs twice"),
    ("taken\n0\n", ":1: there is no column exits"),
    ("exits,taken\n0 north,0\n0,\n", ":2: step 0: 'north' is not a bearing"),
    ("exits,taken\n0 nan,0\n0,\n", ":2: step 0: 'nan' is not a bearing"),
    ("exits,taken\n0 1e9,0\n0,\n", ":2: step 0: '1e9' is not a bearing: it is not from -360"),
    ("exits,taken\n0 90 E,0\n0,\n", ":2: step 0: 'E': compass letters and degrees are mixed"),
    ("exits,taken\n0 90,0\nS,\n", ":3: step 1: 'S': compass letters and degrees are mixed"),
    ("exits,taken\nN,N\nS,\n", ":3: step 1: the exit by which one arrived is not known"),
    ("exits;taken\n0 12,5,6;0\n0;\n", ":2: step 0: '12.5.6' is not a bearing"),
    ("exits,taken\n0 0,0\n0,\n", ":2: step 0: exits: 0 occurs twice"),
    ("exits,taken\n0 360,0\n0,\n", ":2: step 0: exits: 0 occurs twice"),
    ("exits,taken\n0 1 359.9999999999,0\n0,\n", ":2: step 0: exits: 360 occurs twice"),
    ("exits,taken\n0 0.2,0\n0,\n", ":2: step 0: the exits at 0 and 0.2 degrees from the arrival"),
    ("exits,taken\n0,0\n90 180,\n", ":3: step 1: no exit, or more than one, is within 10 degrees"),
    ("exits,taken\n0,0\n5 355,\n", ":3: step 1: no exit, or more than one, is within 10 degrees"),
    ("exits,taken\n0,0\n0,0\n", ":3: step 1: an exit is taken, but no later row"),
    ("exits,taken\n0,0\n0,\n0,\n", ":3: step 1: no exit is taken, but there are later rows"),
    ("exits,taken,look\n0,0,yes\n0,,\n", ":2: step 0: look: there is no earlier look"),
    ("exits,taken,look\n0,0,\n0,,yes\n", ":3: step 1: it is a second look, but in the row before"),
    ("exits,start\n0,\n0,maybe\n", ":3: step 1: start: 'maybe' is neither yes nor no"),
    ("exits,start,look\n0,,\n0,1,1\n", ":3: step 1: it begins a log, and is a second look"),
    ("exits,taken,length\n0,0,\n0,,3\n", ":3: step 1: length: no exit is taken here"),
    ("exits,taken,length\n0,0,-3\n0,,\n", ":2: step 0: length: -3 is not above 0"),
    ("exits,taken,length\n0,0,0.001\n0,,\n", ":2: step 0: length: 0.001 is not above 0 when"),
    ("exits,taken,length\n0,0,9999999999\n0,,\n", ":2: step 0: length 9999999999 is above"),
    ("exits,taken,length\n0,0,1e300\n0,,\n", ":2: step 0: length: '1e300' is not a number"),
    ("exits,taken,east\n0,0,3\n0,,\n", ":2: step 0: north: it is empty, but the other one"),
    (
        "exits,taken,east,north\n0,0,1,1\n0,0,21474836,0\n0,,,\n",
        ":3: step 1: the shifts up to here come to 21474838",
    ),
    ("exits,marker\n0,yes\n", ":2: step 0: the marker is seen, but lies nowhere"),
    ("exits,pick\n0,coin\n", ":2: step 0: the marker coin is taken up, but lies nowhere"),
    ("exits,taken,step\n0,0,0\n0,,2\n", ":3: step 1: step: 2 is given"),
    ("exits,taken\n0 90,0 90\n0,\n", ":2: step 0: taken: '0 90' is more than one value"),
    ("exits,taken\n0,0,7\n0,\n", ":2: the header names 2 columns, but '7' stands after them"),
    ('exits,taken\n"0,0\n0,\n', ":2: not a row of CSV: unexpected end of data"),
    ('exits,taken\n"0"1,0\n0,\n', ":2: not a row of CSV: "),
    (f"exits,note\n0,{'x' * 200000}\n", ":2: not a row of CSV: field larger than"),
    (f"exits\n{' '.join(str(n / 2) for n in range(400))}\n", "exits: there are 400, more than 360"),
    ("exits,landmarks\n0,a\x07b\n", ":2: step 0: landmarks: "),
    (b"exits,taken\n0,\xff\n", "walk.txt: not a text file"),
    ("exits,taken\n0,0\n0,\n".encode("utf-16"), "walk.txt: not a text file"),
    ("[]", "walk.txt: a JSON list; JSON lines are wanted"),
    ('{"exits": [0]', ":1: not a line of JSON: expecting ',' delimiter, at letter"),
    ('{"exits": [0], "taken": 0}\n7\n', ":2: a JSON object is wanted, one a line"),
    ('{"exits": [0], "exits": [1]}', ":1: column exits occurs twice"),
    ('{"exits": [0], "taken": NaN}', ":1: not a line of JSON: NaN is not a number"),
    ('{"exits": [1e999]}', ":1: step 0: 'inf' is not a bearing"),
    ('{"exits": [[0]]}', ":1: exits: a list holds texts and numbers only"),
    ('{"exits": [true]}', ":1: exits: a list holds texts and numbers only"),
    ('{"exits": {"a": 1}}', ":1: exits: an object is not a value here"),
    ('{"exits": [0], "landmark": "a"}', ":1: column 'landmark' is not known; did you mean"),
    ('{"exits": [0], "landmarks": ["\\ud800"]}', ":1: step 0: landmarks: "),
    ('{"exits": ' + "[" * 100000, ":1: not a line of JSON: it is nested too deep"),
    (f'{{"exits": [{"9" * 5000}]}}', ":1: not a line of JSON: Exceeds the limit"),
]


@pytest.mark.parametrize(("text", "fault"), HOSTILE)
def test_what_is_refused(read, text, fault):
    assert fault in faults(read, text)


@pytest.mark.parametrize(
    ("options", "text", "fault"),
    [
        ({"frame": "arrival"}, "exits,taken\nN,N\nS,\n", "'N': a compass letter, but bearings are"),
        ({"straight_ways": 20}, "exits,taken\nN,N\nE,\n", "there is no exit, or two are"),
        (
            {"straight_ways": 60},
            "exits,taken\nN,N\nSE SW,\n",
            "there is no exit, or two are equally near",
        ),
        ({"slots": 5}, GOOD, "walk.txt: slots(5): K must be even"),
        ({"slots": 4}, "exits,taken\n0 30,0\n0,\n", ":2: step 0: the exits at 0 and 30 degrees"),
        ({"facing": "ahead"}, GOOD, ":3: step 1: no exit, or more than one, is within 10"),
    ],
)
def test_what_options_refuse(read, options, text, fault):
    assert fault in faults(read, text, **options)


def test_too_many_rows(read, monkeypatch):
    monkeypatch.setattr(rows, "MOST_STEPS", 2)
    assert read("exits,taken\n0,0\n0,0\n0,\n").experience.steps == 2
    text = "exits,taken\n0,0\n0,0\n0,0\n0,\n"
    assert faults(read, text) == "walk.txt:5: there are more than 2 steps"


@pytest.mark.parametrize(
    ("name", "value", "fault"),
    [
        ("slots", 1, "slots=1: it must be a whole number, 2 or more"),
        ("tolerance", -1, "tolerance=-1: it must be a whole number, 0 or more"),
        ("frame", "south", "frame='south': it must be arrival or north"),
        ("facing", None, "facing=None: it must be back or ahead"),
        ("straight", 181, "straight=181: it must be a number of degrees, from 0 to 180"),
        ("straight_ways", "9", "straight_ways='9': it must be a number of degrees"),
        ("unit", 0, "unit=0: it must be a number from 1e-09 to"),
        ("unit", float("nan"), "unit=nan: it must be a number from 1e-09 to"),
    ],
)
def test_arguments_that_cannot_be(name, value, fault):
    with pytest.raises(ValueError, match="=") as said:
        topomap.read_log(FILES / "courtyard.csv", **{name: value})
    assert fault in str(said.value)


@pytest.mark.parametrize("file", ["courtyard.csv", "courtyard.jsonl", "streets.csv"])
def test_logs_that_were_spoilt(tmp_path, file, record_property):
    """A log in which letters were changed is read, and then is a good instance, or is refused in
    one line that names it."""
    good = (FILES / file).read_text()
    bad, made = tmp_path / "bad", tmp_path / "made.lp"
    refused = taken = 0
    for number in range(CASES):
        draw = random.Random(f"spoilt {file} {number}")
        text = [*good]
        for _ in range(draw.randint(1, 2)):
            at = draw.randrange(len(text))
            new = draw.choice(
                ["", "0", "9", ",", ";", '"', "\n", "-", "N", "é", "{", "]", ".", " "]
            )
            text[at : at + draw.choice([0, 1, 1, 5])] = [new]
        bad.write_text("".join(text))
        said = None
        try:
            log = topomap.read_log(bad)
        except topomap.InputError as fault:
            said = str(fault)
        if said is not None:
            assert said.startswith(str(bad))
            assert "\n" not in said
            refused += 1
            continue
        made.write_text(log.text())
        assert topomap.validate(made).valid
        assert topomap.read(made, tolerance=log.tolerance) == log.experience
        taken += 1
    assert refused > CASES / 10
    assert taken > CASES / 20
    record_property("spoilt logs refused", refused)
