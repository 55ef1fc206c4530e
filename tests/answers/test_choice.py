"""``topomap solve`` chooses by counted work which way gives the maps, and says which one did."""

import json
import random
import time
from collections import Counter

import pytest
from conftest import ROOT
from oracles.worlds import random_experience
from topomap.api.solve import solve
from topomap.cli import main
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.runtime.watch import Stopped, Watch
from topomap.search import descent
from topomap.search.descent import Descent, TooLarge
from topomap.search.lookahead import LookAhead
from topomap.solver import choice, solving
from topomap.solver.choice import Trial
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

SNAKE = "instances/grid-4x4-snake.lp"
SMALL = "instances/grid-3x3-snake.lp"


def facts(path, rows, columns, route, **options):
    """An instance file of a grid."""
    path.write_text(instance(grid(rows, columns), route, **options).text())
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "options", "way", "number"),
    [
        (SMALL, [], "search", 88),
        (SMALL, ["--planar", "--closed"], "search", 3),
        (SNAKE, ["--planar", "--bound", "16"], "search", 545),
        (SNAKE, ["--optimal"], "search", 2),
        (SNAKE, ["--bound", "16"], "clingo", 23685),
        (SMALL, ["--optimal", "--noise", "0"], "clingo", 2),
        (SMALL, ["--encoding", "paper"], "clingo", 88),
        (SMALL, ["--by", "clingo"], "clingo", 88),
        (SMALL, ["--by", "search"], "search", 88),
    ],
)
def test_the_answer_says_which_way_gave_it(topomap, file, options, way, number):
    done = topomap("solve", file, *options, "--json")
    answer = json.loads(done.stdout)
    assert (answer["by"], answer["count"]) == (way, number)
    assert (
        topomap("solve", file, *options)
        .stdout.splitlines()[-1]
        .partition(",")[0]
        .endswith(f" by {way}")
    )


def test_many_maps_of_one_tree_are_handed_over_as_they_are_found(monkeypatch):
    """More maps than are kept: the search begins anew, and gives them one by one."""
    experience = read(ROOT / SNAKE)
    monkeypatch.setattr(choice, "KEPT", 100)
    trial = Trial(experience, Query(frozenset(["planar"]), 16), Watch())
    assert (trial.by, trial.whole) == ("search", False)
    answer = solve(experience, planar=True, bound=16)
    assert (len(answer), answer.by) == (545, "search")


@pytest.mark.slow
@pytest.mark.parametrize("slow", ["search", "clingo"])
def test_time_decides_nothing(inside, monkeypatch, tmp_path, slow):
    """The answer has the same bytes when one of the two ways is slowed down."""
    files = [
        (SMALL, "--planar"),
        (SNAKE, "--planar", "--bound", "16", "--limit", "5"),
        (SNAKE, "--bound", "16", "--limit", "30"),
        (SNAKE, "--optimal"),
        (facts(tmp_path / "tour.lp", 4, 5, "tour"), "--closed", "--planar"),
        (facts(tmp_path / "snake.lp", 6, 6, "snake"), "--closed", "--planar", "--limit", "1"),
    ]
    quick = [inside("solve", *words, "--json") for words in files]
    assert {json.loads(done.stdout)["by"] for done in quick} == {"search", "clingo"}
    children, hypotheses = LookAhead.children, solving.hypotheses
    number, clock = 0, time.monotonic

    def late(node):
        nonlocal number
        number += 1
        if number % 50 == 0:
            time.sleep(0.001)
        return children(node)

    def jumping():
        """A clock by which each node takes a second."""
        return clock() + number

    def later(*args, **options):
        time.sleep(0.5)
        for found in hypotheses(*args, **options):
            time.sleep(0.01)
            yield found

    if slow == "search":
        monkeypatch.setattr(LookAhead, "children", late)
        monkeypatch.setattr(time, "monotonic", jumping)
    else:
        monkeypatch.setattr(solving, "hypotheses", later)
        monkeypatch.setitem(choice_ways(), "clingo", later)
    for words, before in zip(files, quick, strict=True):
        after = inside("solve", *words, "--json")
        assert (after.stdout, after.returncode) == (before.stdout, before.returncode)
    assert number or slow == "clingo"


def choice_ways():
    from topomap.solver.enumeration import WAYS

    return WAYS


def test_what_the_search_found_is_kept_when_clingo_is_cut(monkeypatch):
    """A walk of 240 steps on 4x4: the search finds the true map at once, clingo does not."""
    walk = instance(grid(4, 4), "walk", steps=240, seed=1)

    def cut(*_, **__):
        raise Stopped("timeout")
        yield

    monkeypatch.setitem(choice_ways(), "clingo", cut)
    monkeypatch.setattr(choice, "MANY_PAIRS", 10**9)
    answer = solve(walk.experience, closed=True, planar=True, perpendicular=True)
    assert [one.at for one in answer] == [walk.truth]
    assert (answer.fault, answer.by, answer.complete) == ("timeout", "search", False)


@pytest.mark.parametrize("parts", [{"boundary": True}, {"boundary": True, "minimal": True}])
def test_what_was_found_is_kept_when_the_search_is_cut(monkeypatch, parts):
    """By the watch, while it is not yet decided which way gives the maps."""
    ticks = iter(range(2))

    def tick(_):
        if next(ticks, None) is None:
            raise Stopped("timeout")

    monkeypatch.setattr(Watch, "tick", tick)
    answer = solve(read(ROOT / SNAKE), bound=16, **parts)
    assert (answer.fault, answer.by) == ("timeout", "search")
    assert len(answer) == 1 if "minimal" in parts else len(answer) > 1
    assert not answer.complete


def test_a_best_map_that_is_not_proved_says_what_is_proved(monkeypatch, inside, tmp_path):
    """What each map costs at least; and that it is not proved to be the best."""
    path = facts(tmp_path / "tour.lp", 5, 5, "tour")

    def cut(*_, **__):
        raise Stopped("timeout")
        yield

    monkeypatch.setattr(solving, "hypotheses", cut)
    monkeypatch.setattr(choice, "FEW", 600)
    done = inside("solve", path, "--optimal", "--planar", "--perpendicular", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 3
    assert (answer["kind"], answer["proved"], answer["fault"]) == (
        "not proved to be best",
        False,
        "timeout",
    )
    assert answer["cost"] == [0, 10, 25]
    assert [0, 1, 1] < answer["least"] <= answer["cost"]
    done = inside("solve", path, "--optimal", "--planar", "--perpendicular")
    least = " ".join(map(str, answer["least"]))
    assert done.stdout.splitlines()[-1] == (
        "1 map found by search, cost 0 10 25, not proved to be best, "
        f"proved to cost at least {least}; partial: timeout"
    )


def test_many_pairs_of_visits_are_searched_at_once():
    """clingo's program would be too large; but if it is grounded in phases, it is tried."""
    walk = instance(grid(6, 6), "walk", steps=140, seed=1).experience
    planar = Query(frozenset(["planar", "perpendicular"]), 20)
    trial = Trial(walk, planar, Watch())
    assert (trial.by, trial.whole, trial.maps) == ("search", False, [])
    assert len([*trial.rest]) == 10
    closed = planar.having("closed")
    assert Trial(walk, closed, Watch()).whole


def test_a_bound_of_closed_maps_is_not_said_where_there_may_be_none(monkeypatch):
    """The search for closed maps is given up with a bound, clingo finds that there is none, and
    is cut before it has another map."""
    seen = instance(grid(3, 3), "walk", steps=14, seed=3).experience
    for name in ("FEW", "FEW_OPEN", "NODES_A_STEP"):
        monkeypatch.setattr(choice, name, 0)
    for module in (descent, choice):
        monkeypatch.setattr(module, "OFTEN", 1)
    parts = ["closed", "boundary", "minimal"]
    assert Trial(seen, Query(frozenset(parts)), Watch()).least is not None

    def cut(_, query, *rest):
        if "closed" not in query.parts:
            raise Stopped("timeout")
        return iter(())

    monkeypatch.setattr(solving, "hypotheses", cut)
    answer = solve(seen, optimal=True)
    assert (len(answer), answer.fault, answer.least) == (0, "timeout", None)


def test_a_long_log_of_which_one_hypothesis_lives_is_searched():
    """No two visits look alike; no branch of the tree has ended when its size is first given."""
    log = instance(grid(30, 30), "snake", steps=700, signs=1).experience
    trial = Trial(log, Query(), Watch())
    assert (trial.by, trial.whole, len(trial.maps)) == ("search", True, 1)


@pytest.mark.slow
def test_a_file_can_be_resumed_whichever_way_gives_its_maps(tmp_path):
    """A run that is cut by its limit, and one that goes on with it."""
    for number, words in enumerate(([SMALL], [SNAKE, "--bound", "16", "--planar"], [SNAKE])):
        file, whole = tmp_path / f"{number}", tmp_path / f"{number} whole"
        rest = ["--horizon", "24"] if words == [SNAKE] else []
        assert main(["solve", *words, *rest, "-o", str(file), "--limit", "50"]) == 3
        assert main(["solve", *words, *rest, "-o", str(file), "--resume"]) == 0
        assert main(["solve", *words, *rest, "-o", str(whole)]) == 0
        assert sorted(line.partition(": ")[2] for line in file.read_text().splitlines()) == sorted(
            line.partition(": ")[2] for line in whole.read_text().splitlines()
        )


def test_a_limit_ends_the_search(monkeypatch):
    """The search ends as soon as it has found ``limit`` maps and one more, which shows that there
    are others; and as many maps are given if it is given up after it found them."""
    nodes = []
    monkeypatch.setattr(Trial, "_heed", lambda self, descent: nodes.append(descent.nodes))
    experience = read(ROOT / SNAKE)
    answer = solve(experience, planar=True, limit=3)
    assert (len(answer), answer.fault, answer.by) == (3, "limit", "search")
    assert not nodes
    walk = instance(grid(4, 4), "walk", steps=240, seed=1)
    monkeypatch.undo()
    monkeypatch.setattr(choice, "MANY_PAIRS", 10**9)
    first = solve(walk.experience, closed=True, planar=True, perpendicular=True, limit=1)
    assert [one.at for one in first] == [walk.truth]
    assert (first.fault, first.by) == ("limit", "search")
    every = solve(experience, planar=True, bound=16, limit=545)
    assert (len(every), every.fault) == (545, None)


def test_an_unknown_way_is_refused():
    with pytest.raises(ValueError, match="'guess' is not one of the ways auto, clingo, search"):
        solve(read(ROOT / SMALL), by="guess")
    assert main(["solve", SMALL, "--by", "guess"]) == 2


@pytest.mark.slow
@pytest.mark.parametrize("given_up", [False, True])
@pytest.mark.parametrize("large", [False, True])
def test_an_open_map_that_comes_first_hides_no_other(monkeypatch, large, given_up):
    """The optimal maps are those of clingo where the search gives open maps, as it has found no
    closed one yet: by the search, and by what suits, also if it is given up then."""
    monkeypatch.setattr(descent, "OFTEN", 4)
    monkeypatch.setattr(descent, "GREEDY_AFTER", 4)
    monkeypatch.setattr(descent, "MANY_PAIRS", -1 if large else 5_000)
    meanwhile = Counter()
    open_ones = Descent._open_ones

    def counted(self):
        for found in open_ones(self):
            assert (found.open, found.proved) == (True, False)
            meanwhile["open maps"] += 1
            yield found

    def heed(self, search):
        if search.nodes > 8:
            meanwhile["given up"] += 1
            raise TooLarge

    monkeypatch.setattr(Descent, "_open_ones", counted)
    if given_up:
        monkeypatch.setattr(Trial, "_heed", heed)
    kinds = Counter()
    for number in range(60):
        draw = random.Random(f"open first {number}")
        experience = random_experience(draw, 11)
        parts = draw.choice([{}, {"planar": True}, {"perpendicular": True}])
        true = solve(experience, optimal=True, by="clingo", **parts)
        for by in ("auto",) if given_up else ("auto", "search"):
            answer = solve(experience, optimal=True, by=by, **parts)
            assert (answer.kind, answer.cost) == (true.kind, true.cost)
            assert {one.at for one in answer} == {one.at for one in true}
            assert answer.complete
        kinds[true.kind] += 1
    assert min(kinds["optimal"], kinds["best so far"]) > 5
    assert meanwhile["open maps"] > 4
    assert bool(meanwhile["given up"]) is given_up


@pytest.mark.slow
def test_the_walks_on_which_an_open_map_hid_the_closed_ones():
    for seed, kind in ((110, "optimal"), (6, "best so far")):
        walk = instance(grid(4, 4), "walk", steps=36, seed=seed).experience
        found = [solve(walk, optimal=True, by=by) for by in ("search", "clingo")]
        assert [one.kind for one in found] == [kind, kind]
        assert found[0].cost == found[1].cost
        assert {one.at for one in found[0]} == {one.at for one in found[1]}


@pytest.mark.slow
def test_an_open_map_that_is_given_at_the_time_limit_is_called_so(inside, monkeypatch, tmp_path):
    """Nothing is said of what closed maps cost; and where closed maps are asked for, and not the
    optimal ones, it is not given."""
    file = facts(tmp_path / "walk.lp", 4, 4, "walk", steps=60, seed=3)
    deepen = Descent._deepen

    def stopped(self, *arguments):
        if self._kind == "best so far":
            yield from deepen(self, *arguments)
        else:
            raise Stopped("timeout")

    monkeypatch.setattr(descent, "DEEPEN_LONG", 4)
    monkeypatch.setattr(Descent, "_deepen", stopped)
    call = "solve", file, "--planar", "--by", "search"
    done = inside(*call, "--optimal")
    assert done.stdout.splitlines()[-1] == (
        "1 map found by search, cost 0 6 10, with pending gateways, as no closed map is found yet; "
        "partial: timeout"
    )
    answer = json.loads(inside(*call, "--optimal", "--json").stdout)
    assert answer["open"] is True
    assert "least" not in answer
    assert answer["maps"][0]["pending"]
    done = inside(*call, "--closed", "--minimal")
    assert done.stdout == "no map found yet; partial: timeout\n"
