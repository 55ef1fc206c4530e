"""Maps that are minimal by set inclusion: clingo and the search, against each map compared with
each other one; and what the commands and the functions say of them."""

import json
import random
import re

import pytest
import topomap
from conftest import COLUMNS, ENCODINGS, ROOT, Truth, run
from oracles.brute_force import circumscribed
from oracles.known_answers import EXPERIENCES
from oracles.worlds import WORLDS, random_experience
from topomap.model.circumscription import extent
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import circumscription
from topomap.solver.solving import hypotheses
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

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
    bound = draw.choice([None, None, draw.randint(2, 6)])
    horizon = draw.choice([None, None, None, draw.randint(0, experience.steps)])
    return experience, parts, bound, horizon


@pytest.mark.slow
@pytest.mark.parametrize("listed", [circumscription.LISTED, 0, 2])
@pytest.mark.parametrize(
    "numbers", [range(70), pytest.param(range(70, 520), marks=pytest.mark.long)]
)
def test_two_ways_find_what_comparing_all_maps_finds(numbers, listed, record_property, monkeypatch):
    """Also where clingo lists no maps first, or only some."""
    monkeypatch.setattr(circumscription, "LISTED", listed)
    more = kinds = 0
    for number in numbers:
        experience, parts, bound, horizon = case(number)
        truth = Truth(experience if horizon is None else experience.cut(horizon))
        maps, closed = admitted(truth, *parts, bound=bound)
        right = circumscribed(maps)
        query = Query(frozenset(parts), bound, horizon)
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
        fewer = query.having("boundary", "minimal", *["closed"] * closed)
        found = hypotheses(experience, fewer, Watch())
        assert {one.at for one in found if one.proved} == by_number
        more += right != by_number
        kinds += closed
    assert more > len(numbers) / 200
    assert len(numbers) / 20 < kinds < len(numbers) * 19 / 20
    record_property("experiences whose circumscribed maps were compared", len(numbers))


def test_names_are_those_of_the_definition():
    for experience in (EXPERIENCES | WORLDS).values():
        for at, hypothesis in Truth(experience).final.items():
            assert tuple(extent(experience, at)) == hypothesis.names()


@pytest.mark.slow
def test_the_first_map_of_stock_clingo_is_circumscribed_and_can_be_checked(tmp_path):
    for number in range(15):
        experience, *_ = case(number)
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


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("listed", [circumscription.LISTED, 0])
def test_walks_that_are_solved_in_phases(listed, monkeypatch):
    """Closed maps of at most so many places, from forty steps on."""
    monkeypatch.setattr(circumscription, "LISTED", listed)
    many = 0
    for seed in range(2):
        draw = random.Random(f"phases {seed}")
        made = instance(grid(3, 3), "".join(walk_on_grid(draw, 3, 3, 42)))
        query = Query(frozenset(["planar"] if seed % 2 else []), 9 + seed % 2)
        found = [
            {one.at for one in circumscription.circumscribed(made.experience, query, Watch(), by)}
            for by in ("clingo", "search")
        ]
        assert found[0] == found[1]
        many += len(found[0])
    assert many


def walk_on_grid(draw, rows, columns, steps):
    """The letters of a random walk from a corner."""
    row = column = 0
    for _ in range(steps):
        ways = {"N": (-1, 0), "E": (0, 1), "S": (1, 0), "W": (0, -1)}
        kept = {
            letter: (row + down, column + right)
            for letter, (down, right) in ways.items()
            if row + down in range(rows) and column + right in range(columns)
        }
        letter = draw.choice(sorted(kept))
        row, column = kept[letter]
        yield letter


FORKS, PRISM = (
    re.search(rf"^```asp {name}.lp\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
    for name in ("forks", "prism")
)


def test_the_example_of_the_page(tmp_path, topomap):
    """The readings differ in it, and neither map has only paths of the other one."""
    file = tmp_path / "forks.lp"
    file.write_text(FORKS)
    truth = Truth(read(file))
    maps, closed = admitted(truth)
    assert not closed
    right = circumscribed(maps)
    assert len(right) == 2
    assert len(truth.least(lambda h: h.cost(), [one.at for one in maps])) == 1
    told = json.loads(topomap("solve", file, "--circumscribe", "--json").stdout)
    assert {tuple((place, slot) for _, place, slot in one["at"]) for one in told["maps"]} == right
    assert (told["kind"], told["circumscribe"]) == ("circumscribed so far", True)
    counted = json.loads(topomap("count", file, "--circumscribe", "--json").stdout)
    assert (counted["circumscribed"], counted["circumscribed_kind"]) == (2, told["kind"])
    plain = json.loads(topomap("count", file, "--json").stdout)
    assert "circumscribed" not in plain


def test_the_closed_example_of_the_page(tmp_path):
    """The readings differ among closed maps, too."""
    file = tmp_path / "prism.lp"
    file.write_text(PRISM)
    truth = Truth(read(file))
    maps, closed = admitted(truth)
    assert closed
    right = circumscribed(maps)
    assert sorted(truth.final[at].cost() for at in right) == [(6, 4), (9, 6)]
    assert len(truth.least(lambda h: h.cost(), [one.at for one in maps])) == 1


@pytest.mark.slow
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
        with pytest.raises(ValueError, match="circumscribe cannot be combined with"):
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
    assert done.stdout == "0 circumscribed maps by clingo\n"


def test_a_limit_keeps_what_was_found(inside, tmp_path):
    done = inside("solve", "instances/grid-4x4-snake.lp", "--circumscribe", "--timeout", "0.001")
    assert (done.returncode, done.stdout) == (3, "no map found yet; partial: timeout\n")
    file = tmp_path / "forks.lp"
    file.write_text(FORKS)
    done = inside("solve", file, "--circumscribe", "--limit", "1")
    assert done.returncode == 3
    assert done.stdout.endswith(
        "1 circumscribed so far map found by clingo, more may exist; partial: limit\n"
    )


def test_the_first_one_of_many_comes_before_all_are_known():
    """Each kind of map is given as soon as it is proved."""
    seen = topomap.read(ROOT / "instances/grid-4x4-snake.lp")
    watch = Watch()
    found = circumscription.circumscribed(seen.cut(28), Query(), watch)
    first = next(found)
    assert first.kind.startswith("circumscribed")
    watch.ended = "enough"
    with pytest.raises(Stopped, match="enough"):
        list(found)
