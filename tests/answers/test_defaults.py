"""Which default stands in the way of a closed map: by trying, and by the oracle."""

import json
import random

import pytest
import topomap
from conftest import ROOT, TRIED, plain
from oracles import brute_force
from oracles.worlds import random_experience
from topomap.model.query import Query
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import defaults
from topomap.solver.defaults import WORDS, in_the_way

LOOP = ROOT / "tests/cases/loop.lp"
PARTS = ("boundary", "perpendicular", "planar")
HELP = "no closed map; without the path axiom there is one: --no-path-axiom\n"


def has_closed(world, parts, bound, axiom):
    """Whether the oracle's tree ends with a closed map that has these parts."""
    for at in brute_force.tree(world, "planar" in parts, bound, axiom)[-1]:
        one = brute_force.Hypothesis(world, at)
        if one.closed() and all(getattr(one, part)() for part in {*parts} - {"planar"}):
            return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [range(n, n + 25) for n in range(0, 200, 25)])
def test_it_is_what_the_oracle_says(seeds):
    for seed in seeds:
        draw = random.Random(f"defaults {seed}")
        seen = random_experience(draw, draw.choice([4, 6, 8, 9]))
        parts = {part for part in PARTS if draw.random() < 0.5}
        bound = draw.choice([None, None, 2, 3, 4])
        axiom = draw.random() < 0.8
        world = plain(seen)
        if has_closed(world, parts, bound, axiom):
            continue
        right = ["path_axiom"] if axiom and has_closed(world, parts, bound, False) else []
        right += [
            part
            for part in PARTS
            if part in parts and has_closed(world, parts - {part}, bound, axiom)
        ]
        if bound is not None and has_closed(world, parts, None, axiom):
            right.append("bound")
        asked = frozenset(parts if axiom else {*parts, "no_path_axiom"})
        assert in_the_way(seen, Query(asked, bound), Watch()) == right
        for name in right or ["nothing"]:
            TRIED[f"in the way of a closed map: {name}"] += 1


def test_where_the_budget_ends_nothing_is_claimed(monkeypatch):
    torus = topomap.generate("torus", 3, 3, route="tour").experience
    assert in_the_way(torus, Query(), Watch()) == ["path_axiom"]
    with monkeypatch.context() as patched:
        patched.setattr(defaults, "CONFLICTS", 0)
        assert in_the_way(torus, Query(), Watch()) == []
    with monkeypatch.context() as patched:
        patched.setattr(defaults, "PAIRS", 0)
        assert in_the_way(torus, Query(), Watch()) == []
    assert in_the_way(torus, Query(noise=1), Watch()) == []
    assert in_the_way(torus, Query(encoding="paper"), Watch()) == []
    with pytest.raises(Stopped):
        in_the_way(torus, Query(), Watch(0))


@pytest.mark.parametrize("options", [["--closed"], ["--optimal"], ["--closed", "--by", "clingo"]])
def test_solve_says_it_in_one_line(topomap, options):
    done = topomap("solve", LOOP, *options)
    assert done.stderr == ""
    assert done.stdout.endswith(HELP)
    assert done.stdout.count("no closed map") == 1
    answer = json.loads(topomap("solve", LOOP, *options, "--json").stdout)
    assert answer["in_the_way"] == ["path_axiom"]


@pytest.mark.parametrize("options", [[], ["--planar"], ["--closed", "--no-path-axiom"]])
def test_nothing_is_said_where_it_was_not_asked(topomap, options):
    """No closed map was asked for, or there is one."""
    assert "no closed map" not in topomap("solve", LOOP, *options).stdout
    assert "in_the_way" not in json.loads(topomap("solve", LOOP, *options, "--json").stdout)


def test_what_is_in_the_way_is_a_key_of_a_document(topomap, tmp_path):
    """The file that solve writes is read again; another name there is a fault."""
    file = tmp_path / "none.json"
    assert topomap("solve", LOOP, "--closed", "--json", "-o", file).returncode == 1
    assert "in_the_way" not in topomap("check", LOOP, file).stderr
    document = json.loads(file.read_text())
    for wrong in ([["path_axiom"]], ["axiom"], "path_axiom"):
        file.write_text(json.dumps({**document, "in_the_way": wrong}))
        done = topomap("check", LOOP, file)
        assert done.returncode == 2
        assert "in_the_way" in done.stderr


def test_nothing_is_said_where_nothing_helps(topomap, tmp_path):
    file = tmp_path / "one.lp"
    file.write_text("slots(4). view(0,0).\n")
    assert topomap("solve", file, "--closed").stdout == "0 consistent maps by search\n"
    assert json.loads(topomap("solve", file, "--closed", "--json").stdout)["in_the_way"] == []


def test_each_thing_has_its_words():
    line = defaults.told(["path_axiom", "bound"])
    assert line == f"{HELP[:-1]}; without --bound there is one"
    assert {*WORDS} == {"path_axiom", "bound", "euler", *PARTS}


def test_explain_says_it_instead_of_reasons(topomap):
    done = topomap("explain", LOOP, "--closed")
    assert done.stdout == f"{HELP}no map is consistent with the experience\n"
    answer = json.loads(topomap("explain", LOOP, "--closed", "--json").stdout)
    assert (answer["in_the_way"], answer["reasons"]) == (["path_axiom"], [])


def test_the_answer_has_it():
    seen = topomap.read(LOOP)
    assert topomap.solve(seen, optimal=True).in_the_way() == ["path_axiom"]
    assert topomap.solve(seen, closed=True).in_the_way() == ["path_axiom"]
    assert topomap.solve(seen).in_the_way() is None
    assert topomap.explain(seen, closed=True).in_the_way == ["path_axiom"]
    snake = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    assert topomap.solve(snake, optimal=True).in_the_way() is None
