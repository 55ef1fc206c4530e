"""docs/tutorial.ipynb runs as it is committed, and shows what its text says."""

import json

import nbformat
import pytest
from conftest import COLUMNS, ROOT
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_notebook

DOCS = ROOT / "docs"
BOOK = nbformat.read(DOCS / "tutorial.ipynb", as_version=4)
CODE = {cell.id: cell.source for cell in BOOK.cells if cell.cell_type == "code"}
TABLE = "table"  # the cell that takes long


def executed(folder, cells):
    """The outputs of cells of code, each with its name, in a notebook of their own."""
    book = new_notebook(cells=[new_code_cell(code, id=name) for name, code in cells.items()])
    client = NotebookClient(book, timeout=500, resources={"metadata": {"path": DOCS}})
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("IPYTHONDIR", str(folder))  # where it keeps its history
        return {cell.id: cell.outputs for cell in client.execute().cells}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    cells = {name: code for name, code in CODE.items() if name != TABLE}
    return executed(tmp_path_factory.mktemp("ipython"), cells)


def printed(cell):
    return "".join(output.text for output in cell if output.output_type == "stream")


def drawings(cell):
    shown = [output.get("data", {}) for output in cell]
    return [data["image/svg+xml"] for data in shown if "image/svg+xml" in data]


def expected(environment, planarity):
    (column,) = (
        column["expected"]
        for column in COLUMNS
        if (column["environment"], column["planarity"]) == (environment, planarity)
    )
    return column


def test_it_is_committed_without_outputs():
    nbformat.validate(BOOK)
    for cell in BOOK.cells:
        if cell.cell_type == "code":
            assert (cell.outputs, cell.execution_count) == ([], None)


@pytest.mark.slow
def test_maps_are_counted_and_drawn(outputs):
    final = [expected("3x3", planarity)["final"] for planarity in (False, True)]
    assert printed(outputs["solve"]).splitlines() == [
        *(f"{number} consistent maps, complete: True, fault: None" for number in final),
        "10 consistent maps, complete: False, fault: limit",
    ]
    number = expected("3x3", True)["optimal"]
    assert printed(outputs["draw"]).startswith(
        f"{number} optimal map, cost (exceptions, paths, places): (0, 6, 9)"
    )
    for name in "draw", "ask":
        (drawing,) = drawings(outputs[name])
        assert "<svg" in drawing
    assert printed(outputs["map"]).startswith(
        "9 places, 12 links, 6 paths\n5 faces, genus 0, pending gateways: []\n"
    )


def test_questions_are_answered(outputs, topomap):
    """As the command answers them."""
    assert printed(outputs["ask"]).splitlines() == [
        "same(3,12): in all of the optimal maps",
        "places < 12: in none of the optimal maps",
        "planar: in all of the optimal maps",
    ]
    explained = topomap("explain", "instances/grid-3x3-snake.lp", "same(1,7)")
    assert explained.stdout.startswith("same(1,7): impossible, already after step 7\n")
    assert printed(outputs["explain"]) == explained.stdout
    walk = topomap("explore", "instances/grid-4x4-snake.lp", "--among", "optimal")
    assert "\nleft in the worst case: 1 of 2 maps; no walk leaves fewer" in walk.stdout
    assert printed(outputs["explore"]) == walk.stdout


@pytest.mark.long
def test_the_table_is_the_papers(tmp_path):
    told = "import json\nprint(json.dumps([[*key, table[key].to_dict()] for key in table]))"
    cells = {name: CODE[name] for name in ("read", TABLE)} | {"told": told}
    outputs = executed(tmp_path, cells)
    assert "<table" in outputs[TABLE][0].data["text/html"]
    columns = json.loads(printed(outputs["told"]))
    assert len(columns) == len(COLUMNS)
    for environment, planarity, figures in columns:
        wanted = expected(environment, planarity)
        assert figures == {key: wanted[key] for key in wanted if key != "per_step"}
