"""Maps that are minimal by set inclusion: clingo and the search, against each map compared with
each other one; and what the commands and the functions say of them."""

import json
import random
import re

import pytest
import topomap
from conftest import COLUMNS, ENCODINGS, ROOT, Truth, run
from oracles.brute_force import best, circumscribed
from oracles.known_answers import EXPERIENCES
from oracles.worlds import WORLDS, random_experience
from topomap.model.circumscription import extent
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.solver import circumscription

PAGE = (ROOT / "docs/circumscription.md").read_text()


def admitted(truth, *parts, bound=None):
    """The maps that are compared, and whether they are closed."""
    for demands in (("closed", "boundary"), ("boundary",)):
        found = truth.having(*parts, *demands, bound=bound)
        if found:
            return [truth.final[at] for at in found], "closed" in demands
    return [], False


def case(number):
    """An experience, and what is asked of it."""
    draw = random.Random(f"circumscribed {number}")
    experience = random_experience(draw, 10, marker=draw.random() < 0.2)
    parts = draw.choice([(), (), ("planar",), ("perpendicular",), ("travelled",)])
    return experience, parts, draw.choice([None, None, draw.randint(2, 6)])


@pytest.mark.parametrize(
    "numbers", [range(120), pytest.param(range(120, 900), marks=pytest.mark.long)]
)
def test_two_ways_find_what_comparing_all_maps_finds(numbers, record_property):
    more = kinds = 0
    for number in numbers:
        experience, parts, bound = case(number)
        truth = Truth(experience)
        maps, closed = admitted(truth, *parts, bound=bound)
        right = circumscribed(maps)
        query = Query(frozenset(parts), bound)
        for by in "clingo", "search":
            found = list(circumscription.circumscribed(experience, query, Watch(), by))
            assert len(found) == len(right), number
            assert {one.at for one in found} == right, number
            assert {one.kind for one in found} <= {
                "circumscribed" if closed else "circumscribed so far"
            }
        fewest = min((one.cost() for one in maps), default=None)
        by_number = {one.at for one in maps if one.cost() == fewest}
        assert by_number <= right  # a theorem
        if not parts and bound is None:
            assert by_number == best(truth.experience, truth.final, closed)
        more += right != by_number
        kinds += closed
    assert more > len(numbers) / 200
    assert len(numbers) / 20 < kinds < len(numbers) * 19 / 20
    record_property("experiences whose circumscribed maps were compared", len(numbers))


def test_names_are_those_of_the_definition():
    for experience in (EXPERIENCES | WORLDS).values():
        for at, hypothesis in Truth(experience).final.items():
            assert tuple(extent(experience, at)) == hypothesis.names()


def test_the_first_map_of_stock_clingo_is_circumscribed_and_can_be_checked(tmp_path):
    for number in range(40):
        experience, _, _ = case(number)
        truth = Truth(experience)
        maps = [truth.final[at] for at in truth.having("boundary")]
        right = circumscribed(maps)
        instance = tmp_path / "instance.lp"
        instance.write_text(experience.facts())
        files = [ENCODINGS / f"{file}.lp" for file in ("topomap", "boundary", "circumscribe")]
        first = run("clingo", *files, instance, "1", "--heuristic=Domain", "--outf=2")
        witnesses = json.loads(first.stdout)["Call"][0].get("Witnesses", [])
        assert bool(witnesses) == bool(maps)
        if not maps:
            continue
        (atoms,) = (witness["Value"] for witness in witnesses)
        steps = sorted(
            tuple(map(int, re.findall(r"\d+", atom))) for atom in atoms if atom.startswith("at(")
        )
        assert tuple((place, slot) for _, place, slot in steps) in right
        given = tmp_path / "given.lp"
        names = [atom.replace("has(", "given(", 1) for atom in atoms if atom.startswith("has(")]
        given.write_text(" ".join(f"{name}." for name in ["prefer", *names]))
        again = run("clingo", *files, instance, given, "0", "-q")
        assert "UNSATISFIABLE" in again.stdout


@pytest.mark.parametrize(
    "column",
    [
        pytest.param(column, id=f"{column['environment']}-{column['planarity']}")
        if column["environment"] != "4x4"
        else pytest.param(column, id=f"4x4-{column['planarity']}", marks=pytest.mark.long)
        for column in COLUMNS
    ],
)
def test_the_page_has_the_figures_of_the_columns(column):
    planar = column["planarity"]
    experience = read(ROOT / f"instances/{column['instance']}.lp")
    found = topomap.solve(experience, circumscribe=True, planar=planar, bound=column["places"])
    name = column["environment"] + (", planar" if planar else "")
    best_ones = topomap.solve(experience, optimal=True, planar=planar, bound=column["places"])
    row = rf"^\| {name} \| [\d,]+ \| {len(found)} \| {len(best_ones)} \| {len(best_ones)} \|$"
    assert found.kind == "circumscribed"
    assert re.search(row, PAGE, re.MULTILINE)


FORKS = re.search(r"^```asp forks.lp\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]


def test_the_example_of_the_page(tmp_path, topomap):
    """The readings differ in it, and neither map has only paths of the other one."""
    file = tmp_path / "forks.lp"
    file.write_text(FORKS)
    truth = Truth(read(file))
    maps, closed = admitted(truth)
    assert not closed
    right = circumscribed(maps)
    assert len(right) == 2
    assert len(best(truth.experience, truth.final, False)) == 1
    told = json.loads(topomap("solve", file, "--circumscribe", "--json").stdout)
    assert {tuple((place, slot) for _, place, slot in one["at"]) for one in told["maps"]} == right
    assert (told["kind"], told["circumscribe"]) == ("circumscribed so far", True)
    counted = json.loads(topomap("count", file, "--circumscribe", "--json").stdout)
    assert (counted["circumscribed"], counted["circumscribed_kind"]) == (2, told["kind"])
    plain = json.loads(topomap("count", file, "--json").stdout)
    assert "circumscribed" not in plain


def test_the_functions(tmp_path):
    file = tmp_path / "forks.lp"
    file.write_text(FORKS)
    seen = topomap.read(file)
    found = topomap.solve(seen, circumscribe=True)
    assert (len(found), found.kind, found.complete, found.proved) == (
        2,
        "circumscribed so far",
        True,
        True,
    )
    assert topomap.count(seen, circumscribe=True)["circumscribed"] == 2
    first = topomap.solve(seen, circumscribe=True, limit=1)
    assert (len(first), first.fault) == (1, "limit")
    again = topomap.solve(seen, circumscribe=True)  # nothing of the first call is left
    assert len(again) == 2
    for other in ({"optimal": True}, {"minimal": True}, {"noise": 1}, {"encoding": "paper"}):
        with pytest.raises(ValueError, match="circumscribe does not go with"):
            topomap.solve(seen, circumscribe=True, **other)
    with pytest.raises(ValueError, match="jobs"):
        topomap.solve(seen, circumscribe=True, jobs=2)


@pytest.mark.parametrize(
    "other", ["--optimal", "--minimal", "--genus", "--noise=1", "--encoding=paper", "--jobs=2"]
)
def test_what_does_not_go_together(inside, other):
    done = inside("solve", "instances/grid-3x3-snake.lp", "--circumscribe", other)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert "--circumscribe" in done.stderr or "not the best ones" in done.stderr


def test_without_a_map(inside, tmp_path):
    file = tmp_path / "none.lp"
    file.write_text("slots(4). view(0,0). turn(1,0). view(1,0). turn(2,0). view(2,0). view(2,1).")
    done = inside("solve", file, "--circumscribe")
    assert (done.returncode, done.stderr) == (1, "")
    assert done.stdout == "0 circumscribed maps\n"


def test_a_limit_of_time_keeps_what_was_found(inside):
    done = inside("solve", "instances/grid-4x4-snake.lp", "--circumscribe", "--timeout", "0.001")
    assert done.returncode == 3
    assert "partial: timeout" in done.stdout
