"""Long runs are resumed where they were cut, and come to the same numbers."""

import json
import random
import re
import subprocess
import time
from functools import cache

import pytest
from conftest import BIN, ROOT, TRIED, run
from topomap.cli import main
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.paper import beyond, statistics
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import enumeration
from topomap.solver.share import ALONE

GRID = str(ROOT / "instances/grid-3x3-snake.lp")
PAPER = str(ROOT / "instances/grid-3x4-paper.lp")
SNAKE = str(ROOT / "instances/grid-4x4-snake.lp")
CLINGO = ["--by", "clingo"]  # else trees so small are searched at once, and nothing is kept of them
LONG_RUNS = {
    "count": ["count", PAPER],
    "count by two": ["count", PAPER, "--jobs", "2"],
    "count, JSON": ["count", PAPER, "--planar", "--json"],
    "solve": ["solve", PAPER, *CLINGO],
    "solve, JSON": ["solve", PAPER, *CLINGO, "--boundary", "--json"],
    "solve by search": ["solve", PAPER, "--by", "search"],
    "solve by two": ["solve", PAPER, *CLINGO, "--jobs", "2"],
    "solve two": ["solve", GRID, PAPER, *CLINGO, "--json"],
}


@cache
def counted():
    return run("topomap", "count", PAPER).stdout


def slow(name):
    """Those runs that the default tests can do without are long."""
    others = ("count", "solve, JSON", "solve by search")
    return pytest.param(name, marks=[] if name in others else pytest.mark.long)


@pytest.fixture(autouse=True)
def many_units(monkeypatch):
    """Have small trees counted cube by cube, too."""
    monkeypatch.setattr(statistics, "LARGE", 10)


class Cut(Exception):
    """A run is cut."""


def cut_after(patch, units):
    """Have a run cut when it has done so many units more, as a kill would."""
    commit, left = Journal.commit, iter(range(units))

    def commit_or_cut(self):
        commit(self)
        if next(left, None) is None:
            raise Cut

    patch.setattr(Journal, "commit", commit_or_cut)


def ordered(file):
    """A file's lines, maps in order and without their numbers: within a part of the tree
    clingo gives them in an order of its own."""
    return ordered_text(file.read_text())


def ordered_text(text):
    return sorted(re.sub(r"^map \d+|,$", "", line) for line in text.splitlines())


@pytest.mark.slow
@pytest.mark.parametrize("name", [slow(name) for name in LONG_RUNS])
def test_a_run_that_was_cut_goes_on(tmp_path, monkeypatch, name):
    whole, file = tmp_path / "whole", tmp_path / "file"
    assert main([*LONG_RUNS[name], "-o", str(whole)]) == 0
    draw = random.Random(name)
    cuts = 0
    while not file.exists():
        with monkeypatch.context() as patch:
            cut_after(patch, draw.randrange(*((50, 150) if "count" in name else (20, 40))))
            try:
                assert main([*LONG_RUNS[name], "-o", str(file), "--resume"]) == 0
            except Cut:
                cuts += 1
                TRIED["cuts of long runs, resumed"] += 1
                assert not file.exists()
    assert cuts > 0
    assert ordered(file) == ordered(whole)
    assert {path.name for path in tmp_path.iterdir()} == {"whole", "file"}


@pytest.mark.parametrize("way", ["clingo", "search"])
def test_what_is_done_is_not_done_again(tmp_path, monkeypatch, way):
    """A resumed run asks for the parts that are left, and no more."""
    file = str(tmp_path / "maps.json")
    call = ["solve", PAPER, "--by", way, "-o", file]
    with monkeypatch.context() as patch:
        cut_after(patch, 39)
        with pytest.raises(Cut):
            main(call)
    asked = []
    ask = enumeration.WAYS[way]

    def spy(*arguments, cubes=None, **options):
        if cubes is not None:
            asked.append(cubes)
        return ask(*arguments, cubes=cubes, **options)

    monkeypatch.setitem(enumeration.WAYS, way, spy)
    assert main([*call, "--resume"]) == 0
    (left,) = asked
    assert len(left) == len(traversal.cubes(read(PAPER), Query())[0]) - 40


@pytest.mark.long
def test_a_resumed_run_gives_the_same(tmp_path, monkeypatch):
    """The units do not depend on how many do them."""
    whole, file = tmp_path / "whole", tmp_path / "file"
    for command in ("count", "solve"):
        asked = [command, PAPER, "--horizon", "18", *(CLINGO if command == "solve" else [])]
        assert main([*asked, "-o", str(whole)]) == 0
        for jobs, units in ((2, 30), (1, 10), (3, None)):
            call = [*asked, "--jobs", str(jobs), "-o", str(file), "--resume"]
            with monkeypatch.context() as patch:
                if units is None:
                    assert main(call) == 0
                    break
                cut_after(patch, units)
                with pytest.raises(Cut):
                    main(call)
        assert ordered(file) == ordered(whole)
        file.unlink()


@pytest.mark.slow
def test_without_resume_a_run_begins_anew(tmp_path, monkeypatch):
    file = tmp_path / "count.txt"
    with monkeypatch.context() as patch:
        cut_after(patch, 20)
        with pytest.raises(Cut):
            main(["count", PAPER, "-o", str(file)])
    part = tmp_path / "count.txt.part"
    part.write_text(part.read_text().replace("[1, 1]", "[7, 7]"))
    assert main(["count", PAPER, "-o", str(file)]) == 0
    assert file.read_text() == counted()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda text: text, None),
        (lambda text: text[:-3], None),  # cut in the middle of a line
        (lambda text: text[:20], None),  # or of the first one
        (lambda text: "", None),
        (lambda text: text.replace('"facts and', '"other and'), "belongs to another run"),
        (lambda text: "no journal\n" + text, "not a journal of this program"),
        (lambda text: text.replace("[1, 1]", "[2, 1]", 1), "damaged after unit"),
        (lambda text: text.replace("[1, 1]", "null", 1), "damaged after unit"),
        (
            lambda text: re.sub(r"\ndone (\w+)\n", r"\ndone 0\1\n", text, count=1),
            "damaged after unit",
        ),
        (lambda text: re.sub(r"\n.*\ndone .*\n", "\n", text, count=1), "damaged after unit"),
        (lambda text: text + text.splitlines()[-1] + "\n", "damaged after unit"),
    ],
)
def test_a_journal_that_is_torn_or_of_another_run(tmp_path, monkeypatch, capsys, change, fault):
    file, part = tmp_path / "count.txt", tmp_path / "count.txt.part"
    with monkeypatch.context() as patch:
        cut_after(patch, 20)
        with pytest.raises(Cut):
            main(["count", PAPER, "-o", str(file)])
    part.write_text(changed := change(part.read_text()))
    status = main(["count", PAPER, "-o", str(file), "--resume"])
    if fault:
        assert (status, fault in capsys.readouterr().err) == (2, True)
        assert part.read_text() == changed
    else:
        assert status == 0
        assert file.read_text() == counted()


LAST = r"(.*) \w+\n$"  # the line of a map of a part that was cut


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda text: text, None),
        (lambda text: text[:-3], None),
        (lambda text: text + "[[0, 0], [1, ", None),
        *(
            (lambda text, line=line: text + line + "\n", "damaged after unit")
            for line in (
                "[[0,0],[1,0]]",
                "[] 0",
                "{}",
                "null",
                "null 00000000",
                "3",
                "junk",
                "done",
            )
        ),
        (lambda text: re.sub(LAST, r"\1\n", text), "damaged after unit"),
        (lambda text: text[:-1] + "0\n", "damaged after unit"),
        (lambda text: re.sub(r"\]\] \w+\ndone", "]]done", text, count=1), "damaged after unit"),
        (lambda text: re.sub(r"\]\] \w+\n\[\[", "]][[", text, count=1), "damaged after unit"),
        (lambda text: re.sub(r"\d+(\]\] \w+\n)$", r"7\1", text), "damaged after unit"),
    ],
)
def test_the_part_that_was_cut_may_be_damaged_too(tmp_path, capsys, change, fault):
    file, part = tmp_path / "maps.txt", tmp_path / "maps.txt.part"
    assert main(["solve", PAPER, *CLINGO, "--limit", "300", "-o", str(file)]) == 3
    old = file.read_text()
    part.write_text(changed := change(part.read_text()))
    capsys.readouterr()
    status = main(["solve", PAPER, *CLINGO, "-o", str(file), "--resume"])
    if fault:
        assert (status, fault in capsys.readouterr().err) == (2, True)
        assert (part.read_text(), file.read_text()) == (changed, old)
    else:
        assert status == 0
        assert ordered(file) == ordered_text(run("topomap", "solve", PAPER, *CLINGO).stdout)


def test_other_queries_and_instances_are_other_runs(tmp_path, monkeypatch, capsys):
    file = str(tmp_path / "maps")
    with monkeypatch.context() as patch:
        cut_after(patch, 3)
        with pytest.raises(Cut):
            main(["solve", PAPER, *CLINGO, "-o", file])
    for call in (
        ["solve", PAPER, *CLINGO, "--closed"],
        ["solve", GRID, *CLINGO],
        ["solve", PAPER, "--by", "search"],
        ["solve", PAPER, *CLINGO, "--bound", "9"],
        ["solve", PAPER, *CLINGO, "--horizon", "0"],
        ["count", PAPER],
    ):
        assert main([*call, "-o", file, "--resume"]) == 2
        assert "belongs to another run" in capsys.readouterr().err
    assert main(["solve", PAPER, *CLINGO, "--json", "--limit", "3", "-o", file, "--resume"]) == 3


def test_two_runs_do_not_share_a_journal(tmp_path, capsys):
    file = str(tmp_path / "count.txt")
    with Journal(file, {}):
        assert main(["count", GRID, "-o", file]) == 2
    assert "another run is writing it" in capsys.readouterr().err


def test_a_file_of_somebody_else_is_not_touched(tmp_path, capsys):
    file, part = tmp_path / "maps", tmp_path / "maps.part"
    target = tmp_path / "target"
    target.write_text("precious")
    part.write_text("precious")
    assert main(["solve", GRID, "-o", str(file)]) == 2
    assert capsys.readouterr().err == f"{part}: not a journal of this program; it is in the way\n"
    assert part.read_text() == "precious"
    part.unlink()
    part.symlink_to(target)
    assert main(["solve", GRID, "-o", str(file)]) == 2
    assert capsys.readouterr().err.startswith(f"{part}: ")
    assert target.read_text() == "precious"


def test_resume_needs_a_file(capsys):
    assert main(["count", GRID, "--resume"]) == 2
    assert main(["count", GRID, "--resume", "-o", "/dev/null"]) == 2
    assert capsys.readouterr().err.count("it needs an output file") == 2


@pytest.mark.slow
def test_a_partial_answer_is_kept_and_gone_on_with(tmp_path):
    file = tmp_path / "maps.json"
    call = ["solve", PAPER, *CLINGO, "--json", "-o", str(file)]
    assert main([*call, "--limit", "200"]) == 3
    partial = json.loads(file.read_text())
    assert (len(partial["maps"]), partial["complete"]) == (200, False)
    assert main([*call, "--resume"]) == 0
    whole = json.loads(file.read_text())
    assert (len(whole["maps"]), whole["complete"]) == (1465, True)
    assert all(one in whole["maps"] for one in partial["maps"])
    assert [path.name for path in tmp_path.iterdir()] == ["maps.json"]


@pytest.mark.long
def test_of_several_instances_the_first_is_gone_on_with(tmp_path):
    """A limit cuts each of them; the journal is of the first, then."""
    file, whole = tmp_path / "maps.json", tmp_path / "whole.json"
    call = ["solve", PAPER, GRID, PAPER, *CLINGO, "--json", "-o"]
    assert main([*call, str(file), "--limit", "40"]) == 3
    assert main([*call, str(file), "--limit", "70", "--resume"]) == 3
    assert [r["count"] for r in json.loads(file.read_text())["results"]] == [70, 70, 70]
    assert main([*call, str(file), "--resume"]) == 0
    assert main([*call, str(whole)]) == 0
    assert ordered(file) == ordered(whole)


@pytest.mark.slow
def test_nothing_that_was_found_is_lost(tmp_path, monkeypatch, capsys):
    """Not when a run is cut in the middle of a part, and again while it catches up."""
    file = tmp_path / "maps.json"
    call = ["solve", PAPER, *CLINGO, "--json", "-o", str(file), "--resume"]
    found = 0
    for limit in (100, 300, 500, 800):
        assert main([*call, "--limit", str(limit)]) == 3
        assert "the same call with --resume goes on from here" in capsys.readouterr().err
        assert main([*call, "--timeout", "0.001"]) in (0, 3)
        if not (tmp_path / "maps.json.part").exists():
            break
        before, found = found, len(json.loads(file.read_text())["maps"])
        assert found >= limit > before
    assert main(call) == 0
    assert len(json.loads(file.read_text())["maps"]) == 1465


@pytest.mark.slow
def test_beyond_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(beyond, "COLUMNS", [(3, 3, None, False), (2, 4, 8, True), (3, 3, 9, True)])
    whole, file = tmp_path / "whole.json", tmp_path / "file.json"
    call = ["table", "--beyond", "--jobs", "1", "--json", "-o"]
    assert main([*call, str(whole)]) == 0
    for units in (50, 30, 1000):
        with monkeypatch.context() as patch:
            cut_after(patch, units)
            if units < 1000:
                with pytest.raises(Cut):
                    main([*call, str(file), "--resume"])
            else:
                assert main([*call, str(file), "--resume"]) == 0
    assert file.read_bytes() == whole.read_bytes()
    row = json.loads(whole.read_text())["rows"][1]
    assert (row["final"], row["clingo"]) == (88, {"final": 88})


@pytest.mark.long
def test_clingo_may_not_finish_beyond(monkeypatch):
    monkeypatch.setattr(beyond, "COLUMNS", [(4, 4, 16, False)])
    (row,) = beyond.rows(ALONE, Watch(), Journal(), limit=0.01)
    assert (row["final"], row["clingo"]) == (23685, {})


@pytest.mark.long
@pytest.mark.parametrize("block", range(2))
def test_killed_again_and_again(tmp_path, block):
    """kill -9, at random moments, until a run comes to its end: each has the time to read what
    was done, and some more."""
    draw = random.Random(f"killed {block}")
    calls = [
        ["count", SNAKE, "--bound", "16"],
        ["solve", SNAKE, "--bound", "16", "--json"],
        ["solve", SNAKE, "--bound", "16", "--by", "search"],
    ]
    for call in calls:
        whole, file = tmp_path / "whole", tmp_path / "file"
        begun = time.monotonic()
        assert run("topomap", *call, "-o", whole).returncode == 0
        took = time.monotonic() - begun
        status = None
        while status is None:
            process = subprocess.Popen([BIN / "topomap", *call, "-o", file, "--resume"])
            try:
                status = process.wait(draw.uniform(0.2, 1.5) * took)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                TRIED["kills of long runs, resumed"] += 1
        assert status == 0
        assert ordered(file) == ordered(whole)
        for left in tmp_path.iterdir():
            left.unlink()
