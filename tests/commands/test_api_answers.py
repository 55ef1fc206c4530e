"""The public functions that find, count, make and check: they say what the commands say."""

import json
import subprocess
import sys
import threading
from itertools import islice
from types import MappingProxyType

import numpy
import pytest
import topomap
from conftest import COLUMNS, ROOT, answers

GRID, LARGE = "instances/grid-3x3-snake.lp", "instances/manhattan-tour40-signs30.lp"


@pytest.fixture(scope="module")
def seen():
    return topomap.read(ROOT / GRID)


def test_the_public_names_are_there_and_come_when_they_are_used():
    program = "import sys, topomap; print(*sys.modules); print(*dir(topomap))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    loaded, names = (set(line.split()) for line in done.stdout.splitlines())
    assert not {name for name in loaded if name.startswith(("topomap.api", "clingo"))}
    assert names == set(topomap.__all__)
    for name in names:
        assert getattr(topomap, name)
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        _ = topomap.fly


@pytest.mark.parametrize("by", ["clingo", "search"])
@pytest.mark.parametrize("parts", [{}, {"planar": True}, {"closed": True, "perpendicular": True}])
def test_solve_gives_the_maps(seen, parts, by):
    answer = topomap.solve(seen, by=by, **parts)
    assert {one.at for one in answer} == answers(tuple(parts), seen.facts())
    assert (answer.complete, answer.fault, answer.kind, answer.cost) == (
        *(True, None),
        *("consistent", ()),
    )
    assert [*answer] == [*answer]
    assert answer[-1] == [*answer][-1]
    assert answer[1:3] == [*answer][1:3]
    with pytest.raises(IndexError):
        _ = answer[999]


def test_maps_come_as_they_are_found():
    """The first are there long before the last could be."""
    answer = topomap.solve(topomap.read(ROOT / LARGE))
    first = [*islice(answer, 3)]
    assert answer[0] == first[0]
    assert len(set(first)) == 3


def test_the_best_are_proved(seen):
    best = topomap.solve(seen, optimal=True)
    assert (len(best), best.kind, best.cost, best.proved) == (2, "optimal", (0, 6, 9), True)
    assert {one.genus for one in best} == {0, 1}
    none = topomap.solve(seen, bound=3)
    assert (len(none), none.complete, none.proved) == (0, True, True)


def test_what_is_cut_says_so(seen):
    cut = topomap.solve(seen, limit=5)
    assert (len(cut), cut.complete, cut.fault) == (5, False, "limit")
    large = topomap.read(ROOT / LARGE)
    timed = topomap.solve(large, optimal=True, timeout=0.001)
    assert (timed.complete, timed.fault, timed.proved) == (False, "timeout", False)
    counts = topomap.count(large, timeout=0.001)
    assert (counts.complete, counts.fault, counts["nodes"]) == (False, "timeout", None)


def test_what_solve_refuses(seen):
    for options, fault in (
        ({"planr": True}, "'planr' is not one of the parts planar, .*; did you mean planar"),
        ({"bound": 0}, "bound=0"),
        ({"horizon": -1}, "horizon=-1"),
        ({"by": "magic"}, "'magic' is not one of the ways auto, clingo, search"),
        ({"encoding": "slow"}, "encoding='slow'"),
        ({"noise": 1, "by": "search"}, "noise cannot be combined with"),
        ({"noise": 1, "encoding": "paper"}, "cannot be combined with noise"),
        ({"genus": True, "encoding": "paper"}, "has no rules for genus"),
        ({"limit": 0}, "limit=0"),
        ({"optimal": True, "jobs": 2}, "not that for the best ones"),
    ):
        with pytest.raises(ValueError, match=fault):
            topomap.solve(seen, **options)
    with pytest.raises(ValueError, match="genus"):
        topomap.count(seen, genus=True)


@pytest.mark.slow
def test_from_a_thread(seen):
    """No signal handler is set, and none is needed."""
    came = []

    def work():
        came.append(topomap.solve(seen, planar=True, optimal=True, timeout=60)[0].genus)
        came.append(topomap.count(seen, planar=True)["final"])

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert came == [0, 62]


@pytest.mark.slow
def test_by_processes(seen):
    assert {one.at for one in topomap.solve(seen, jobs=2)} == answers((), seen.facts())
    assert dict(topomap.count(seen, jobs=2)) == dict(topomap.count(seen))


@pytest.mark.slow
def test_misreadings():
    seen = topomap.read(ROOT / "instances/grid-3x3-misread.lp", noisy=True)
    assert not topomap.solve(seen)
    (best,) = topomap.solve(seen, optimal=True, planar=True, noise=1)
    assert best.misread == ((13, 2),)


@pytest.mark.slow
@pytest.mark.parametrize("column", [column for column in COLUMNS if column["environment"] == "3x3"])
def test_count_is_the_papers(column):
    seen = topomap.read(ROOT / f"instances/{column['instance']}.lp")
    assert dict(topomap.count(seen, planar=column["planarity"])) == column["expected"]


def test_generate_is_the_command(inside):
    made = topomap.generate("maze", 3, 3, route="walk", steps=9, seed=4, signs=0.3)
    call = "generate maze 3 3 --route walk --steps 9 --seed 4 --signs 0.3"
    assert inside(*call.split()).stdout == made.text()
    for arguments, fault in (
        (("sphere", 2, 2), "'sphere' is not one of the environments"),
        (("grid", 2), "rows and columns are wanted"),
        (("grid", 2, 2), "needs steps"),
    ):
        with pytest.raises(ValueError, match=fault):
            topomap.generate(*arguments, route="walk")


def test_check_judges_maps(seen):
    maps = topomap.solve(seen, closed=True)
    judged = topomap.check(seen, maps, planar=True)
    assert (judged.count, len(judged.unsound), judged.complete) == (4, 1, True)
    wrong = {"at": [[step, 0, 0] for step in range(seen.steps + 1)]}
    assert topomap.check(seen, [maps[0], maps[1].document(), wrong]).unsound
    assert not topomap.check(seen, [maps[0], maps[1].document()]).unsound
    with pytest.raises(ValueError, match="genus"):
        topomap.check(seen, maps, genus=True)


def entries(answer):
    return [one.document() for one in answer]


def tampered(answer):
    (one, *_) = entries(answer)
    return [{**one, "genus": 7, "links": [], "faces": [], "places": [], "paths": []}]


NOISY = "instances/grid-3x3-misread.lp"
MISREAD = {"optimal": True, "planar": True, "noise": 1}
JUDGED = {  # what is judged, of which maps, with which options; and how many of it are unsound
    "maps": (GRID, {"closed": True}, entries, {"planar": True}, 1),
    "noisy": (NOISY, MISREAD, entries, {"noise": 1}, 0),
    "noise that is not allowed": (NOISY, MISREAD, entries, {"noise": 0}, 1),
    "tampered": (GRID, {"optimal": True}, tampered, {}, 1),
    "doubled": (GRID, {"optimal": True}, lambda answer: entries(answer) * 2, {}, 2),
    "more keys": (GRID, {"optimal": True}, lambda a: [{**e, "x": 1} for e in entries(a)], {}, 2),
    "real": (GRID, {"optimal": True}, lambda a: [{**e, "real": True} for e in entries(a)], {}, 2),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", JUDGED)
def test_check_is_the_command(inside, tmp_path, case):
    instance, asked, made, options, unsound = JUDGED[case]
    seen = topomap.read(ROOT / instance, noisy="noise" in asked)
    answer = topomap.solve(seen, **asked)
    maps, file = made(answer), tmp_path / "maps.json"
    file.write_text(json.dumps({"maps": maps}))
    flags = [f"--{key}" if value is True else f"--{key}={value}" for key, value in options.items()]
    told = json.loads(inside("check", instance, file, *flags, "--json").stdout)
    given = [maps, (one for one in maps), {"maps": maps}, file, str(file)]
    if made is entries:
        given += [answer, [*answer]]
    for one in given:
        judged = topomap.check(seen, one, **options)
        ours = json.loads(json.dumps(judged.document()).replace('"maps: ', f'"{file}: '))
        assert ours == {key: told[key] for key in ours}
        assert (len(judged.unsound), bool(judged)) == (unsound, unsound == 0)


def test_check_of_one_map(seen):
    one = topomap.solve(seen, optimal=True)[0]
    for given in (one, one.document(), {"maps": [one]}, MappingProxyType(one.document())):
        assert topomap.check(seen, given).count == 1
        assert topomap.check(seen, given)
    said = {"maps": [one.document()], "kind": "optimal", "optimal": True, "cost": [0, 5, 9]}
    assert topomap.check(seen, said).unsound[0].faults == ["cost: it is [0, 6, 9]"]
    at = [tuple(map(numpy.int64, dstate)) for dstate in one.document()["at"]]
    assert topomap.check(seen, [{"at": at}, {"at": at[:3]}]).short == 1


def test_a_check_that_is_cut_is_not_taken_for_sound(seen):
    judged = topomap.check(seen, topomap.solve(seen), timeout=0)
    assert (judged.fault, judged.unsound, bool(judged)) == ("timeout", [], False)


@pytest.mark.parametrize(
    ("maps", "error", "fault"),
    [
        (["x"], topomap.InputError, "maps: map 1: a Map, or a dictionary with the key at, is wa"),
        ([{"at": []}, {}], topomap.InputError, r"maps: map 2: at is not a list \[\[T,P,S\]"),
        ([{"at": [1, 2]}], topomap.InputError, "maps: map 1: at is not a list"),
        ([{"at": None}], topomap.InputError, "maps: map 1: at is not a list"),
        ([{"at": [[0, 0, 0.5]]}], topomap.InputError, "maps: map 1: at is not a list"),
        ([{"at": [], "x": {1, 2}}], topomap.InputError, "maps: map 1: JSON cannot hold it"),
        ({"maps": 5}, topomap.InputError, "maps: no maps in it"),
        ({}, topomap.InputError, "maps: no maps in it"),
        ("none.json", topomap.InputError, "none.json: no such file"),
        (None, TypeError, "maps: a Map, a dictionary, the path of a file .*, not None"),
        (5, TypeError, "maps: a Map, a dictionary"),
        (b"x", TypeError, "maps: a Map, a dictionary"),
    ],
)
def test_what_check_refuses(seen, maps, error, fault):
    with pytest.raises(error, match=fault) as told:
        topomap.check(seen, maps)
    assert "\n" not in str(told.value)
    with pytest.raises(TypeError, match="truth: a TopologicalMap is wanted"):
        topomap.check(seen, [], truth="x")


def test_validate_is_the_command(inside, tmp_path):
    bad = tmp_path / "bad.lp"
    bad.write_text("slots(4).\nveiw(0,0).")
    for file in (bad, ROOT / GRID):
        judged = topomap.validate(file)
        (told,) = json.loads(inside("validate", file, "--json").stdout)["files"]
        assert judged.document() == told
        assert str(judged) + "\n" == inside("validate", file).stdout
        assert bool(judged) == judged.valid == (file != bad)
    assert topomap.validate(bad).faults[0]["line"] == 2
    with pytest.raises(topomap.InputError, match="did you mean view/2"):
        topomap.read(bad)
