"""``make bench``: what it writes, and that no speed is shown for a wrong answer. Nothing here
depends on how long anything takes."""

import json
import signal
import subprocess
import sys
import time

import pytest
from bench import growth, jobs, measure, report, rows, ways
from conftest import ROOT
from topomap.model.query import Query

TESTS = ROOT / "tests"
COMMAND = [sys.executable, "-m", "bench"]
BASELINE = '[baseline]\ncommit = "HEAD"\n'
# Never done within a second, by no way.
ENDLESS = """
[[row]]
name = "endless {n}"
each = [1, 2]
generate = "grid 9 9 --route snake"
ask = "count"
ways = ["work", "search"]
series = "endless"
goals = { 1 = { solved = true } }
"""


def row(**fields):
    """A row of a file of tasks."""
    fields = {"generate": "grid 2 2 --route snake", "ask": "count", "ways": ["work"]} | fields
    return "[[row]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in fields.items())


@pytest.fixture
def bench(tmp_path):
    """A function that runs the command on tasks, in a folder of the test; gives the finished
    process, the JSON, and the report."""
    docs = tmp_path / "docs"

    def run(*arguments, tasks=None, report=False):
        options = ["--json", str(tmp_path / "bench.json"), *["--docs", str(docs)] * report]
        if tasks is not None:
            (tmp_path / "rows.toml").write_text(BASELINE + tasks)
            arguments = ["--rows", str(tmp_path / "rows.toml"), "--maps", "0", *arguments]
        done = subprocess.run(
            [*COMMAND, *options, *arguments], capture_output=True, text=True, cwd=TESTS
        )
        written = docs / "benchmark.md"
        return (
            done,
            json.loads((tmp_path / "bench.json").read_text()) if done.returncode < 2 else None,
            written.read_text() if written.exists() else None,
        )

    return run


@pytest.mark.slow
def test_what_is_measured_is_written(bench, tmp_path):
    done, document, text = bench("--quick", "--only", "^3x3 snake, all maps", report=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert document["complete"]
    (only,) = document["rows"]
    assert (only["number"], only["expected"], only["verdict"]) == (88, 88, "right")
    assert set(only["ways"]) == set(rows.WAYS)
    for way, of in only["ways"].items():
        assert of["number"] == 88
        assert of["seconds"] > 0
        assert of["processor seconds"] > 0
        assert 10 < of["memory"] < 1000
        if way == "search":
            assert 88 < of["nodes"] < 317  # of the whole tree, which is cut
        else:
            assert 500 < of["atoms"] < of["rules"] < 10_000
            assert of["conflicts"] <= of["choices"]
    assert {"baseline", "search"} <= set(only["ratios"])
    assert document["machine"]["processor"]
    assert document["versions"]["clingo"] in text
    assert "| 3x3 snake, all maps | 88 |" in text
    assert (tmp_path / "docs/figures/scaling.svg").read_text().rstrip().endswith("</svg>")


@pytest.mark.slow
def test_a_wrong_number_has_no_speed(bench):
    done, document, text = bench(
        tasks=row(name="two", expected=1000) + row(name="one"), report=True
    )
    wrong, right = document["rows"]
    assert done.returncode == 1
    assert wrong["verdict"] == f"WRONG: work has {right['number']}, expected are 1,000"
    assert "seconds" not in wrong["ways"]["work"]
    assert "1 wrong" in done.stdout
    line = next(line for line in text.splitlines() if line.startswith("| two | "))
    assert set(line.removeprefix(f"| two | **{wrong['verdict']}** |")) == {" ", "|"}


def test_the_real_map_must_be_among_the_answers(bench):
    task = row(name="ring", generate="torus 3 3 --route EEE", ask="maps")
    done, document, _ = bench(tasks=task)
    assert done.returncode == 1
    assert document["rows"][0]["verdict"] == "WRONG: work: the real map is not among them"


def test_ways_that_differ_are_wrong(monkeypatch, tmp_path):
    counts = {"work": 3, "search": 4}
    monkeypatch.setattr(measure, "_instance", lambda *_: ("", ""))
    monkeypatch.setattr(
        measure, "_run", lambda row, way, *_: {"number": counts[way], "seconds": 1.0}
    )
    plan = measure.Plan(1, 1, 1, 0, tmp_path, tmp_path, tmp_path)
    task = rows.Row("two", "count", ways=("work", "search"))
    told = measure.measured(task, plan, [*rows.WAYS])
    assert told["verdict"] == "WRONG: the ways differ: {'work': 3, 'search': 4}"


def test_a_map_that_is_not_there_is_skipped_and_a_way_that_fails_is_wrong(bench):
    there = row(name="street", generate="network {networks}/none.graphml --route tour")
    done, document, _ = bench(tasks=there + row(name="part", parts=["none"]))
    assert done.returncode == 1
    skipped, failed = (row["verdict"] for row in document["rows"])
    assert skipped == "skipped: none.graphml is not there"
    assert failed == "WRONG: work failed, status 1"
    assert "none.lp: not found" in done.stderr


@pytest.mark.slow
def test_the_time_limit_gives_a_floor(bench):
    done, document, text = bench("--limit", "0.5", "--others", "0.25", tasks=ENDLESS, report=True)
    assert done.returncode == 0
    first, second = document["rows"]
    for way, limit in ("work", 0.5), ("search", 0.25):
        assert (first["ways"][way]["cut"], first["ways"][way]["limit"]) == ("time", limit)
        assert first["ways"][way]["memory"] > 10
        assert len(first["ways"][way]["runs"]) == 1
        assert second["ways"][way] == {"cut": "endless 1"}
    assert (first["verdict"], first["ratios"]) == ("open", {"search": None})
    assert first["goal met"] == {"solved": False}
    assert "| > 0.5 |" in text
    assert "| > 0.25 |" in text
    assert "| not tried |" in text
    assert "solved: **not met**" in text


def test_what_was_measured_before_an_interrupt_is_kept(tmp_path):
    file, tasks = tmp_path / "bench.json", tmp_path / "rows.toml"
    tasks.write_text(BASELINE + row(name="done") + ENDLESS)
    call = [*COMMAND, "--rows", str(tasks), "--json", str(file), "--docs", str(tmp_path / "docs")]
    process = subprocess.Popen(call, cwd=TESTS, stdout=subprocess.PIPE, text=True)
    while not file.exists():
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate()
    document = json.loads(file.read_text())
    assert process.returncode == 130
    assert out.endswith("partial: interrupted, 1 of 3 rows\n")
    assert (document["complete"], document["fault"]) == (False, "interrupted")
    assert [row["name"] for row in document["rows"]] == ["done"]
    assert not (tmp_path / "docs").exists()


@pytest.mark.parametrize(
    ("arguments", "tasks", "message"),
    [
        (["--only", "no such row"], None, "no row has such a name"),
        ([], "row = ", "rows.toml"),
        ([], row(name="a", speed=1), "rows.toml"),
        ([], row(name="a").replace("count", "guess"), "guess"),
    ],
)
def test_bad_input_is_refused_in_one_line(bench, arguments, tasks, message):
    done, _, text = bench(*arguments, tasks=tasks)
    assert (done.returncode, done.stdout, text) == (2, "", None)
    assert done.stderr.startswith("bench: ")
    assert message in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_ratio_with_a_run_that_was_cut_is_a_bound():
    short, long = [{"seconds": 2.0}, {"seconds": 4.0}], [{"seconds": 20.0}, {"seconds": 20.0}]
    cut = [{"cut": "time", "limit": 60}]
    assert measure._ratio(long, short) == {"value": 7.5, "is": "="}
    assert measure._ratio(cut, short) == {"value": 30, "is": ">"}
    assert measure._ratio(short, cut) == {"value": 1 / 30, "is": "<"}
    assert measure._ratio(cut, cut) is None
    assert measure._ratio([{"cut": "memory", "limit": 60}], short) is None


def test_a_goal_is_missed_by_so_much():
    ways = {"work": {"rules": 30, "seconds": 2.0, "runs": []}}
    wanted = {"rules": 20, "seconds": 4, "conflicts": 1}
    known = {"goal": wanted, "ways": ways}
    known["goal met"] = {key: measure._met(key, most, known) for key, most in wanted.items()}
    assert report.goal(known) == (
        "20 rules: **missed** by a factor of 1.5; 4 s: met; 1 conflicts: **not met**"
    )


def test_exponents_are_fitted_to_what_grows():
    def measured(x, conflicts):
        way = {"rules": 3 * x**2, "conflicts": conflicts, "seconds": 0.01, "runs": [{}]}
        return {"growth": "steps", "series": "s", "about": {"steps": x}, "ways": {"work": way}}

    cut = {"cut": "time", "limit": 9, "runs": [{}]}
    last = {"growth": "steps", "series": "s", "about": {"steps": 80}, "ways": {"work": cut}}
    found = growth.curves([*map(measured, (5, 10, 20, 40), (1, 10, 80, 640)), last])
    rules, conflicts, seconds = found
    assert [curve["figure"] for curve in found] == ["rules", "conflicts", "seconds"]
    assert rules["exponent"] == pytest.approx(2)
    assert rules["explained"] == pytest.approx(1)
    assert (rules["fitted"], conflicts["fitted"], seconds["fitted"]) == (4, 3, 0)
    assert conflicts["exponent"] == pytest.approx(3)
    assert (conflicts["from"], conflicts["to"]) == (pytest.approx(10), pytest.approx(40))
    assert "exponent" not in seconds
    assert seconds["cut"] == [(80, 9)]


@pytest.mark.slow
def test_the_picture_has_the_same_bytes_each_time(tmp_path):
    points = [(x, 2.0 * x**3) for x in (10, 20, 40)]
    curve = {"series": "s", "x": "steps", "way": "work", "points": points, "cut": [(80, 9)]}
    curve |= growth._fit(points, 1)
    found = [curve | {"figure": shown, "shown": shown} for shown in growth.SHOWN]
    for name in ("a.svg", "b.svg"):
        growth.draw(found, tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert "exponent 3.0" in (tmp_path / "a.svg").read_text()


@pytest.mark.long
def test_rows_are_measured_again_into_what_there_is(bench):
    tasks = row(name="one", expected=6) + row(name="two")
    done, _, _ = bench("--again", "one", tasks=tasks)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    _, first, _ = bench("--repeat", "1", tasks=tasks)
    done, document, text = bench("--repeat", "1", "--again", "one", tasks=tasks, report=True)
    assert "\n1 rows in " in done.stdout
    assert [of["name"] for of in document["rows"]] == ["one", "two"]
    assert document["rows"][1] == first["rows"][1]
    assert document["rows"][0] != first["rows"][0]
    assert [again["rows"] for again in document["again"]] == [["one"]]
    assert ": one.\n" in text


@pytest.mark.slow
def test_what_more_processes_gain_is_reported_and_that_they_count_the_same(monkeypatch):
    monkeypatch.setattr(jobs, "TASKS", {"a task": ((3, 3), Query(frozenset(["planar"])))})
    (found,) = jobs.speedup(2)
    assert found["nodes"] == 240
    assert found["same"]
    assert found["ratio"] == found["alone"] / found["shared"]
    assert "| a task | 240 |" in report.jobs([found])
    assert "WRONG" in report.jobs([found | {"same": False}])


def test_the_rows_are_those_of_the_table():
    _, everything = rows.read()
    names = [row.name for row in everything]
    assert len(names) == len(set(names))
    assert set(report.reference()["rows"]) <= set(names)
    assert {row.ask for row in everything} == {"count", "maps", "one", "table", "command"}
    figures = {row.name: row.expected for row in everything if row.expected not in (None, 0, 1)}
    assert figures == {
        "3x3 snake, all maps": 88,
        "4x4 snake, at most 16 places, all maps": 23_685,
        "4x4 snake, at most 16 places, planar": 545,
        "4x4 snake, any number of places, all maps": 920_024,
        "4x4 snake, any number of places, planar": 49_123,
        "5x5 snake, closed, planar, at most 25 places": 1_525,
        "6x6 snake, closed, planar, at most 18 places": 212,
    }


@pytest.mark.slow
def test_the_rules_are_reported_where_maps_are_listed(bench):
    _, document, _ = bench(
        "--quick", "--only", "^3x3 snake, closed, perpendicular", "--repeat", "1"
    )
    (only,) = document["rows"]
    assert all(of["rules"] > 1000 for way, of in only["ways"].items() if way != "search")


@pytest.mark.slow
def test_one_solve_is_measured_beside_its_two_ways(capsys, monkeypatch):
    """A row of the table; where the ways give different numbers it is wrong, and where solve takes
    much longer than the better one, its goal is missed."""
    monkeypatch.setattr(sys, "argv", ["bench.ways", "--only", "^3x3 snake, all maps"])
    assert ways.main() == 0
    name, maps, by, *_ = capsys.readouterr().out.split(" | ")
    assert (name, maps, by) == ("3x3 snake, all maps", "88", "search")

    def one(wall, processor, cut, last):
        return ways.Run(wall, processor, cut, last)

    taken = iter([one(9, 9, False, "3 maps by search"), one(1, 1, False, "4 maps by clingo")] * 2)
    monkeypatch.setattr(ways, "run", lambda *_: next(taken))
    cells, bad = ways.line("row", ways.measured("file", [], 0.1, "folder"))
    assert (cells[1], bad) == ("**WRONG**", True)
    assert cells[6] == "5 **missed**"
    assert cells[7] == "9 **missed**"
