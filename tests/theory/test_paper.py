"""The paper's numbers, by plain clingo, by our command, and by the independent search."""

import json
import re

import pytest
from conftest import COLUMNS, ROOT, Truth, answers, run
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.paper import figure4
from topomap.paper.statistics import tree
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Watch
from topomap.solver.programs import FORMS

IDS = [f"{c['environment']}{'-planar' * c['planarity']}" for c in COLUMNS]


def grid(name):
    return read(ROOT / "instances" / f"{name}.lp")


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("parts", "instance", "options", "line"),
    [
        ("topomap", "grid-3x3-snake", "0 -q", "Models       : 88"),
        ("topomap planar", "grid-3x3-snake", "0 -q", "Models       : 62"),
        (
            "topomap planar bound travelled",
            "grid-4x4-snake",
            "-c places=16 0 -q",
            "Models       : 58",
        ),
        (
            "topomap closed boundary minimal",
            "grid-3x4-paper",
            "--opt-mode=optN 0 -q",
            "  Optimal    : 8",
        ),
    ],
)
def test_clingo_alone_prints_the_count(parts, instance, options, line, form):
    files = [FORMS[form] / f"{part}.lp" for part in parts.split()]
    done = run("clingo", *files, f"instances/{instance}.lp", *options.split())
    assert line in done.stdout.splitlines()
    assert done.returncode == 30
    assert not done.stderr


STATED = {  # the figures of a column that need no search tree, and the parts that they demand
    "final": (),
    "closed": ("travelled",),
    "closed_text": ("closed",),
    "perpendicular": ("closed", "perpendicular"),
    "optimal": ("closed", "boundary", "minimal"),
}


@pytest.mark.parametrize("figure", STATED)
@pytest.mark.parametrize(
    "column",
    [*COLUMNS[:4], *(pytest.param(column, marks=pytest.mark.long) for column in COLUMNS[4:])],
    ids=IDS,
)
def test_the_statement_has_the_figures_of_a_column(column, figure):
    """By clingo on encodings/paper/, without any of our Python."""
    parts = [*STATED[figure], *["planar"] * column["planarity"]]
    options = ["0", "-q", *["--opt-mode=optN"] * (figure == "optimal")]
    if column["places"] is not None:
        parts.append("bound")
        options += ["-c", f"places={column['places']}"]
    files = [FORMS["paper"] / f"{part}.lp" for part in ("topomap", *parts)]
    done = run("clingo", *files, f"instances/{column['instance']}.lp", *options, "--outf=2")
    models = json.loads(done.stdout)["Models"]
    found = models.get("Optimal", models["Number"]) if figure == "optimal" else models["Number"]
    assert found == column["expected"][figure]


@pytest.mark.slow
@pytest.mark.parametrize(
    "column",
    [*COLUMNS[:4], *(pytest.param(column, marks=pytest.mark.long) for column in COLUMNS[4:])],
    ids=IDS,
)
def test_a_column_of_the_table(column):
    parts = frozenset(["planar"] if column["planarity"] else [])
    query, figures = Query(parts, column["places"]), {}
    tree(grid(column["instance"]), query, Watch(), Journal(), figures)
    assert not figure4.differences({**column, **figures})
    assert figures["per_step"] == column["expected"]["per_step"]
    assert sum(figures["per_step"]) == figures["nodes"]


@pytest.mark.parametrize("column", [c for c in COLUMNS if c["environment"] == "3x3"])
def test_the_search_has_the_same_tree(column):
    truth = Truth(grid(column["instance"]))
    tree = truth.planar_levels() if column["planarity"] else truth.levels
    assert [len(level) for level in tree] == column["expected"]["per_step"]


@pytest.mark.parametrize("form", FORMS)
def test_the_two_best_maps_of_the_3x3_grid_are_one_graph(form):
    """Figure 1 b and c: the grid, and the same graph on a torus."""
    experience = grid("grid-3x3-snake")
    best = answers(("closed", "boundary", "minimal"), experience.facts(), encoding=form)
    maps = [experience.map_of(at) for at in best]
    assert sorted(world.genus() for world in maps) == [0, 1]
    assert len({len(world.edges()) for world in maps}) == 1


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_the_4x4_grid_has_over_minimal_maps(form):
    """Figure 5 c and d: planar, 12 places, 6 paths, 18 links, with and without planarity."""
    experience = grid("grid-4x4-snake")
    best = ("closed", "boundary", "minimal")
    found = answers(best, experience.facts(), encoding=form)
    assert found == answers(("planar", *best), experience.facts(), encoding=form)
    sizes = {
        (len(world.stars), len(world.paths()), len(world.edges()), world.genus())
        for world in map(experience.map_of, found)
    }
    assert len(found) == 2
    assert sizes == {(12, 6, 18, 0)}


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_the_unique_perpendicular_map_is_the_grid(tmp_path, form):
    """Figure 5 a."""
    truth = tmp_path / "truth.json"
    run("topomap", "generate", "grid", "4", "4", "--route", "snake", "--truth", truth)
    solve = ["solve", "instances/grid-4x4-snake.lp", "--closed", "--perpendicular", "--planar"]
    done = run("topomap", *solve, "--encoding", form, "--truth", truth, "--json")
    (only,) = json.loads(done.stdout)["maps"]
    assert only["real"] is True


@pytest.mark.slow
def test_table_prints_and_writes_all_of_it(tmp_path):
    file = tmp_path / "new" / "figure4.json"
    done = run("topomap", "table", "-o", file)
    assert done.returncode == 0, done.stdout + done.stderr
    written = json.loads(file.read_text())
    assert written["complete"] is True
    assert [(r["environment"], r["planarity"]) for r in written["rows"]] == [
        (c["environment"], c["planarity"]) for c in COLUMNS
    ]
    for row, column in zip(written["rows"], COLUMNS, strict=True):
        assert {key: row[key] for key in column["expected"]} == column["expected"]
        assert (row["paper"], row["expected"]) == (column["paper"], column["expected"])
    printed = re.sub(",", "", done.stdout)
    for column in COLUMNS:
        for figure in column["paper"].values():
            assert re.search(rf"\b{figure}\b", printed)


def test_a_table_that_differs_names_the_cells():
    row = {**COLUMNS[0], **COLUMNS[0]["expected"], "closed": 7, "seconds": 0.0}
    assert figure4.differences(row) == [
        "3x3 without planarity: closed is 7, paper has 6",
        "3x3 without planarity: closed is 7, expected has 6",
    ]
