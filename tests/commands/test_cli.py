"""The command ``topomap``: answers, exit statuses, bad input, limits and interruption."""

import json
import re
import signal
import subprocess
import sys
import time

import pytest
from conftest import BIN, ROOT, answers
from topomap.cli import SUBCOMMANDS
from topomap.model.facts import read
from topomap.model.vocabulary import PARTS
from topomap.runtime import formats

GRID = "instances/grid-3x3-snake.lp"
LARGE = "instances/manhattan-tour40-signs30.lp"


def found(done):
    return {tuple((p, s) for _, p, s in m["at"]) for m in json.loads(done.stdout)["maps"]}


@pytest.mark.parametrize("part", ["", *(p for p in PARTS)])
def test_solve_gives_the_maps_of_clingo(inside, part):
    done = inside("solve", GRID, *([f"--{part.replace('_', '-')}"] if part else []), "--json")
    assert done.returncode == 0
    parts = (part,) if part else ()
    assert found(done) == answers(parts, read(ROOT / GRID).facts())
    assert json.loads(done.stdout)["complete"] is True


def test_solve_bound_and_horizon(inside):
    done = inside("solve", GRID, "--bound", "9", "--horizon", "12", "--planar", "--json")
    facts = read(ROOT / GRID).cut(12).facts()
    assert found(done) == answers(("planar", "bound"), facts, "-c", "places=9")


def test_a_map_tells_all_about_itself(inside):
    done = inside("solve", GRID, "--closed", "--planar", "--perpendicular", "--json")
    (only,) = json.loads(done.stdout)["maps"]
    assert len(only["places"]) == 9
    assert {tuple(p["gateways"]) for p in only["places"] if len(p["gateways"]) == 4} == {
        (0, 1, 2, 3)
    }
    assert (len(only["links"]), len(only["paths"]), len(only["faces"])) == (12, 6, 5)
    assert sum(map(len, only["faces"])) == 24
    assert (only["genus"], only["pending"], only["dstate"]) == (0, [], only["at"][-1][1:])
    assert all(len(path) == 3 for path in only["paths"])


@pytest.mark.parametrize(
    ("arguments", "kind", "count", "cost"),
    [
        ([GRID], "optimal", 2, [0, 6, 9]),
        ([GRID, "--planar"], "optimal", 1, [0, 6, 9]),
        (["instances/grid-3x4-paper.lp"], "optimal", 8, [0, 7, 12]),
        (["instances/grid-3x4-paper.lp", "--genus"], "optimal", 1, [0, 0, 7, 12]),
        (["instances/manhattan-tour20.lp"], "best so far", 3, [0, 8, 13]),
        ([GRID, "--horizon", "0"], "best so far", 1, [0, 2, 1]),
    ],
)
def test_optimal_says_which_kind(inside, arguments, kind, count, cost):
    done = inside("solve", *arguments, "--optimal", "--json")
    answer = json.loads(done.stdout)
    assert (answer["kind"], answer["count"], answer["cost"]) == (kind, count, cost)
    assert answer["proved"] is answer["complete"] is True
    text = inside("solve", *arguments, "--optimal").stdout.splitlines()
    assert len(text) == count + 1
    assert text[-1].startswith(f"{count} {kind} map")


def test_several_instances(inside):
    done = inside("solve", GRID, "instances/grid-3x4-paper.lp", "--optimal", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 0
    assert answer["complete"] is True
    assert [result["count"] for result in answer["results"]] == [2, 8]


@pytest.mark.slow
def test_no_map_is_status_1(inside):
    done = inside("solve", GRID, "--bound", "3", "--json")
    assert done.returncode == 1
    assert json.loads(done.stdout)["maps"] == []
    assert inside("count", GRID, "--bound", "3").returncode == 1


def test_a_limit_is_status_3_and_says_so(topomap):
    done = topomap("solve", GRID, "--limit", "5", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 3
    assert len(answer["maps"]) == answer["count"] == 5
    assert (answer["complete"], answer["fault"]) == (False, "limit")
    assert topomap("solve", GRID, "--limit", "88").returncode == 0
    assert "partial: limit" in topomap("solve", GRID, "--limit", "87").stdout


@pytest.mark.slow
def test_a_timeout_is_status_3_and_keeps_what_was_found(topomap):
    done = topomap("solve", LARGE, "--timeout", "1", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 3
    assert len(answer["maps"]) == answer["count"]
    assert (answer["complete"], answer["fault"]) == (False, "timeout")
    done = topomap("count", LARGE, "--timeout", "1", "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == 3
    assert answer["complete"] is False
    assert answer["nodes"] is None
    assert answer["per_step"][:3] == [1, 1, 1]


def test_a_timeout_ends_grounding(topomap, tmp_path):
    """To ground this takes many minutes; the test's own limit is only a safeguard."""
    topomap("generate", "grid", "14", "14", "--route", "snake", "-o", tmp_path)
    file = tmp_path / "grid-14x14-snake.lp"
    done = topomap("solve", file, "--planar", "--optimal", "--timeout", "1", timeout=120)
    assert done.returncode == 3
    assert done.stdout == "no map found yet; partial: timeout\n"


def interrupted(number, folder, *command):
    """Send a signal to a command that writes to a folder, once it does; its output."""
    with subprocess.Popen(
        [BIN / "topomap", *command], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        while not any(folder.iterdir()):
            time.sleep(0.05)
        time.sleep(1)
        process.send_signal(number)
        output = process.stdout.read()
        assert process.wait(timeout=60) == 130
    return output


def test_an_interrupted_table_says_so(tmp_path):
    output = interrupted(signal.SIGINT, tmp_path, "table", "-o", tmp_path / "figure4.json")
    assert re.search(r"^partial: interrupted; \d of 6 columns$", output, re.MULTILINE)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("beyond", [[], pytest.param(["--beyond"], marks=pytest.mark.long)])
def test_a_time_limit_ends_the_table(topomap, tmp_path, beyond):
    file = tmp_path / "table.json"
    file.write_text("old")
    goes_on = f"{file}: partial; the same call with --resume goes on from here"
    for seconds in (1, 8, 30):  # in which something is done, how slow the machine may be
        done = topomap("table", *beyond, "--timeout", seconds, "--json", "-o", file)
        answer = json.loads(done.stdout)
        if not beyond or goes_on in done.stderr:
            break
    assert (done.returncode, answer["complete"], answer["fault"]) == (3, False, "timeout")
    assert (goes_on in done.stderr) == bool(beyond)
    assert file.read_text() == "old"


@pytest.mark.long
def test_a_timeout_and_an_interrupt_end_the_phases(topomap, tmp_path):
    """They take long."""
    topomap("generate", "grid", "20", "20", "--route", "snake", "-o", tmp_path)
    (into := tmp_path / "answers").mkdir()
    asked = "solve", tmp_path / "grid-20x20-snake.lp", "--closed", "--perpendicular", "--planar"
    done = topomap(*asked, "--timeout", "1", timeout=120)
    assert done.returncode == 3
    assert done.stdout == "no map found yet; partial: timeout\n"
    file = into / "maps.json"
    interrupted(signal.SIGINT, into, *asked, "--json", "-o", file)
    answer = json.loads(file.read_text())
    assert (answer["complete"], answer["fault"], answer["maps"]) == (False, "interrupted", [])


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_keeps_what_was_found(tmp_path, number):
    file = tmp_path / "maps.json"
    interrupted(number, tmp_path, "solve", LARGE, "--json", "-o", file)
    answer = json.loads(file.read_text())
    assert (answer["complete"], answer["fault"]) == (False, "interrupted")
    assert len(answer["maps"]) == answer["count"]
    assert {path.name for path in tmp_path.iterdir()} - {"maps.json.part"} == {"maps.json"}


@pytest.mark.slow
def test_count(inside):
    done = inside("count", "instances/grid-3x4-paper.lp", "--planar", "--json")
    answer = json.loads(done.stdout)
    assert answer["complete"] is True
    assert (answer["nodes"], answer["maps_built"], answer["final"]) == (1722, 1425, 507)
    assert (answer["closed"], answer["optimal"], len(answer["per_step"])) == (3, 1, 22)
    assert "1,722" in inside("count", "instances/grid-3x4-paper.lp", "--planar").stdout


@pytest.mark.slow
def test_the_real_map_is_marked(topomap, tmp_path):
    truth = tmp_path / "truth.json"
    topomap("generate", "grid", "3", "3", "--route", "snake", "--truth", truth)
    done = topomap("solve", GRID, "--optimal", "--json", "--truth", truth)
    maps = json.loads(done.stdout)["maps"]
    assert sorted((m["genus"], m["real"]) for m in maps) == [(0, True), (1, False)]
    assert topomap("solve", GRID, "--optimal", "--truth", truth).stdout.count("real map") == 1
    assert topomap("solve", LARGE, "--truth", truth).returncode == 2
    short = tmp_path / "short.json"
    for text in (GRID, "{}", '{"maps": [{"at": [[0, 0, 0]]}]}', odd(99, 0), odd("x", 0), odd(0, 4)):
        short.write_text(text)
        done = topomap("solve", GRID, GRID, "--truth", short, "--json")
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def odd(place, slot):
    return json.dumps({"maps": [{"at": [[step, place, slot] for step in range(17)]}]})


BAD = {
    "": "no facts",
    "% only a comment": "no facts",
    "view(0,0).": "no facts slots",
    "slots(4). slots(6). view(0,0).": "2 facts slots",
    "slots(5). view(0,0).": "K must be even",
    "slots(0). view(0,0).": "K must be even",
    "slots(four). view(0,0).": "whole number",
    "slots(4).": "step 0: no view",
    "slots(4). view(0,1).": "step 0: the view lacks slot 0",
    "slots(4). view(0,0). view(0,4).": "step 0: slot 4 is not in 0..3",
    "slots(4). view(0,0). view(1,0).": "step 1: it has no turn",
    "slots(4). view(0,0). turn(1,0).": "step 1: no view",
    "slots(4). view(0,0). turn(1,1). view(1,0).": "step 1: turn 1: no gateway there",
    "slots(4). view(0,0). turn(0,0).": "step 0: there is a turn",
    "slots(4). view(0,0). turn(2,0). view(2,0).": "step 1: no turn",
    "slots(4). view(0,0;0,1). turn(1,0;1,1). view(1,0).": "not a ground fact",
    "slots(4). view(0,0). view(0,1). turn(1,0). turn(1,1). view(1,0).": "step 1: more than one",
    "slots(4). view(0,0). place(1).": ":1: place(1) is not a fact over",
    "slots(4). view(0,0). view(0).": ":1: view(0): view has 2 arguments, view(T,S)",
    "slots(4).\nview(0,0).\nview(X,0).": ":3: 'view(X,0)' is not a ground fact",
    "slots(4). view(0,0). a :- b.": "'a :- b' is not a ground fact",
    "slots(4). view(0,0). :- a.": "not a ground fact",
    "slots(4). view(0,0). {view(0,1)}.": "not a ground fact",
    "slots(4). view(0,0..1).": "not a ground fact",
    "slots(4). view(0,0)": "does not end",
    "slots(4). view(0,0). %* on %* and *% on": "a comment does not end",
    "slots(99999999999). view(0,0).": "is not a plain fact",
    "slots(4). view(0,0). landmark(0,f(4294967296)).": "is not a plain fact",
    "slots(4). view(0,65536*65536).": "is not a plain fact: clingo reads it as view(0,0)",
    "slots(4). view(0,0x0).": "is not a plain fact",
    "slots(2000000000). view(0,0).": "K must be even, from 2 to",
    '#include "/etc/passwd".': "not a ground fact",
    "#script (python) print(1) #end.": "not a ground fact",
    "slots(4). view(0,0). landmark(3,a).": "step 3: it has no turn",
    "slots(4). -view(0,0).": "not a fact over",
    'slots(4). view(0,"0").': "whole number",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_instances_are_refused_in_one_line(inside, tmp_path, text):
    file = tmp_path / "bad.lp"
    file.write_text(text)
    for command in (["solve"], ["count", "--json"]):
        done = inside(command[0], file, *command[1:])
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(f"{file}:")
        assert done.stderr.count("\n") == 1
        assert BAD[text] in done.stderr


@pytest.mark.slow
def test_files_that_cannot_be_read_or_written(topomap, tmp_path):
    binary = tmp_path / "binary.lp"
    binary.write_bytes(b"\xff\xfe\x00")
    for arguments in (
        ["solve", tmp_path / "none.lp"],
        ["solve", tmp_path],
        ["solve", binary],
        ["solve", GRID, "-o", tmp_path],
        ["solve", GRID, "-o", tmp_path / "no" / "file"],
        ["count", GRID, "-o", "/dev/full"],
        ["generate", "grid", "2", "2", "--route", "snake", "-o", "/dev/full"],
        ["table", "-o", tmp_path],
        ["table", "-o", "/proc/none/file"],
        ["family", tmp_path / "none.txt", "-d", tmp_path],
        ["family", "instances/batch.txt", "-d", binary],
    ):
        done = topomap(*arguments)
        assert done.returncode == 2, arguments
        assert done.stderr.strip().count("\n") == 0, done.stderr


def test_comments_strings_and_layout_are_read(tmp_path):
    file = tmp_path / "odd.lp"
    file.write_text(
        "\ufeff%* a %* nested\n *% block\nview(9,9). *% slots(4)\n"
        ".view(0,0).% view(8,8).\nturn(1,0).\n"
        'view( 1 , 0 ). landmark(1,"a. %b"). landmark(0,f(x,(1,2))).\n'
    )
    experience = read(file)
    assert (experience.slots, experience.turns) == (4, (0,))
    assert experience.landmarks == (frozenset(["f(x,(1,2))"]), frozenset(['"a. %b"']))


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["fly"],
        ["solve"],
        ["solve", GRID, "--limit", "0"],
        ["solve", GRID, "--limit", "x"],
        ["solve", GRID, "--timeout", "-1"],
        ["solve", GRID, "--bound", "0"],
        ["solve", GRID, "--horizon", "-1"],
        ["solve", GRID, "--spherical"],
        ["count", GRID, GRID],
        ["table", "--jobs", "0"],
        ["solve", GRID, "--timeout", "nan"],
        ["solve", GRID, "--bound", "3000000000"],
        ["count", GRID, "--horizon", "3000000000"],
        ["generate", "grid", "2", "2", "--route=--"],
    ],
)
def test_bad_usage_is_one_line(inside, arguments):
    done = inside(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("topomap")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["sovle", GRID], "topomap: no such command: 'sovle' (did you mean solve? see"),
        (["solve", GRID, "--optimall"], "topomap solve: unrecognized arguments: --optimall (did"),
    ],
)
def test_bad_usage_says_what_may_be_meant(inside, words, said):
    done = inside(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(said)


def test_an_input_is_not_overwritten(inside, tmp_path):
    log, other = tmp_path / "log.lp", tmp_path / "other.lp"
    text = (ROOT / GRID).read_text()
    log.write_text(text)
    other.symlink_to(log)
    for call in (
        ["solve", log, "-o", log],
        ["solve", log, "-o", other],
        ["count", log, "-o", tmp_path / "." / "log.lp"],
        ["solve", GRID, log, "--json", "-o", log],
        ["check", GRID, log, "-o", log],
        ["solve", GRID, "--truth", log, "-o", log],
        ["report", log, "-o", log],
    ):
        done = inside(*call)
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), call
        assert done.stderr.endswith(": it is an input, so it cannot be written\n")
        assert log.read_text() == text


@pytest.mark.parametrize("command", ["", "generate", "solve", "count", "table", "family"])
def test_help_has_an_example(inside, command):
    done = inside(*command.split(), "--help")
    assert done.returncode == 0
    assert "exit status" in done.stdout
    assert "example" in done.stdout


def loaded(*calls):
    """The modules that are loaded when a process has run these calls, one after the other."""
    program = (
        "import json, sys\n"
        "before = set(sys.modules)\n"
        "from topomap.cli import main\n"
        "for call in json.loads(sys.argv[1]):\n"
        "    main(call)\n"
        "print(*set(sys.modules) - before)"
    )
    call = [sys.executable, "-c", program, json.dumps(calls)]
    done = subprocess.run(call, capture_output=True, text=True, cwd=ROOT, check=True)
    return set(done.stdout.splitlines()[-1].split())


def test_help_and_bad_usage_load_no_module_of_others():
    calls = [["--version"], ["--help"], [], ["fly"], ["solve"], ["solve", GRID, "--spherical"]]
    calls += [[name, "--help"] for name in SUBCOMMANDS if name != "clingo"]
    tops = {name.partition(".")[0] for name in loaded(*calls)}
    assert "topomap" in tops
    assert tops <= sys.stdlib_module_names | {"topomap"}


def test_a_command_starts_without_what_few_need():
    """Each of these takes as long to load as all else together, or longer."""
    modules = loaded(["solve", GRID])
    assert "clingo" in modules
    slow = {"tqdm", "networkx", "numpy", "scipy", "matplotlib", "distributed", "asyncio"}
    assert not modules & (slow | {"multiprocessing", "defusedxml"})


def test_a_closed_pipe_is_not_an_error():
    call = ["bash", "-c", '"$0" "$@" | head -1', BIN / "topomap", "solve", GRID]
    done = subprocess.run(call, capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.startswith("map 1")
    assert not done.stderr


def test_families(topomap, tmp_path):
    family = tmp_path / "family.txt"
    family.write_text("# grids\ngrid {2..3} 2 --route {snake,E}  # two by two\n\n")
    folder = tmp_path / "made"
    done = topomap("family", family, "-d", folder, "--json")
    names = ["grid-2x2-snake", "grid-2x2-E", "grid-3x2-snake", "grid-3x2-E"]
    assert json.loads(done.stdout) == formats.answer({"instances": names})
    before = {path: path.stat().st_mtime_ns for path in folder.glob("*.args")}
    assert {path.stem for path in before} == set(names)
    kept = folder / "grid-2x2-snake.args"
    (folder / "grid-2x2-E.lp").write_text("stale")
    (folder / "mine.args").write_text("not of the family")
    family.write_text("grid 2 2 --route snake\n")
    assert topomap("family", family, "-d", folder).stdout == "grid-2x2-snake\n"
    assert {path.name for path in folder.iterdir()} == {".family", "mine.args", kept.name}
    assert kept.stat().st_mtime_ns == before[kept]
    for text, fault in (
        ("grid 2 2", "--route"),
        ("grid 2 2 --route E\n" * 2, "named grid-2x2-E; give it another --name"),
    ):
        family.write_text(text)
        done = topomap("family", family, "-d", folder)
        assert done.returncode == 2
        assert fault in done.stderr
