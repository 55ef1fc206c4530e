"""Kills, interrupts, time limits and want of memory at random moments: what is on disk is the
old file or a whole new one, a partial answer says that it is, and a second run completes."""

import json
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from conftest import BIN, COLUMNS, ROOT, run
from oracles.known_answers import CORRIDOR
from topomap.runtime import files
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import programs, solving

OLD = "old\n"
QUIET = Watch()
GRID = ROOT / "instances/grid-3x3-snake.lp"
PAPER = ROOT / "instances/grid-3x4-paper.lp"
SNAKE = ROOT / "instances/grid-4x4-snake.lp"
LARGE = ROOT / "instances/manhattan-tour40-signs30.lp"


def quote(path):
    """A path as a word of a command line, whatever is in its name."""
    return shlex.quote(str(path))


COMMANDS = {
    "generate": "generate grid 60 60 --route snake -o out",
    "solve": f"solve {quote(PAPER)} -o out",
    "solve --json": f"solve {quote(GRID)} {quote(PAPER)} --planar --json -o out",
    "solve --optimal": f"solve {quote(PAPER)} --optimal --json -o out",
    "solve --by search": f"solve {quote(PAPER)} --by search --json -o out",
    "count": f"count {quote(PAPER)} --planar --json -o out",
    "search": f"search {quote(PAPER)} --order depth --json -o out",
    "branching": f"branching {quote(PAPER)} --json -o out",
}
NUMBERS = [signal.SIGKILL, signal.SIGINT, signal.SIGTERM]


def heeds(process):
    """Whether a process has come so far as to take SIGTERM itself, or has ended. Until
    then Python starts, and is ended by a signal as any program is."""
    try:
        caught = re.search(r"SigCgt:\s+(\w+)", Path(f"/proc/{process.pid}/status").read_text())
    except OSError:
        return True
    return caught is None or int(caught[1], 16) >> (signal.SIGTERM - 1) & 1 or process.poll()


def struck(call, folder, after, number):
    """Send a signal to a command some seconds after it heeds signals; its status, what it
    printed, and how long it went on from then."""
    with subprocess.Popen(
        call, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while not heeds(process):
            time.sleep(0.001)
        begun = time.monotonic()
        time.sleep(after)
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
    return process.returncode, out, err, time.monotonic() - begun


def stable(text):
    """What a second run gives again."""
    return re.sub(r'"seconds": [\d.]+', "", text)


def partial(text):
    """Whether an answer says that it is partial, and why; its maps are those it counts."""
    if not text.startswith("{"):
        return text.splitlines()[-1].endswith("partial: interrupted")
    answer = json.loads(text)
    for result in answer.get("results", [answer]):
        assert "count" not in result or len(result["maps"]) == result["count"]
    faults = [result["fault"] for result in answer.get("results", [answer])]
    return answer["complete"] is False and faults[-1] in ("interrupted", None)


def test_an_interrupt_at_any_moment_leaves_no_temporary_file(tmp_path):
    """At each line of the writer in turn."""

    def interrupted(at):
        """Write a file, with an interrupt before line ``at``; returns the lines until then."""
        lines = 0

        def trace(frame, event, _):
            nonlocal lines
            if frame.f_code.co_filename != files.__file__:
                return None
            lines += event == "line"
            if event == "line" and lines == at:
                raise KeyboardInterrupt
            return trace

        before = sys.gettrace()
        sys.settrace(trace)
        try:
            with files.output(str(tmp_path / "out")) as out:
                out.write("new")
        except KeyboardInterrupt:
            pass
        finally:
            sys.settrace(before)
        return lines

    at = 1
    while interrupted(at) == at:
        assert {path.name for path in tmp_path.iterdir()} <= {"out"}, at
        at += 1
    assert at > 20
    assert (tmp_path / "out").read_text() == "new"


def strikes(name, command, folder, seeds, again):
    """Strike a command at random moments; returns how often it was struck before its end."""
    call = [BIN / "topomap", *shlex.split(command)]
    target = folder / "out"
    subprocess.run(call, cwd=folder, check=True, capture_output=True)
    expected, hits = stable(target.read_text()), 0
    status, _, _, seconds = struck(call, folder, 0, 0)
    assert status == hits == 0
    for seed in seeds:
        draw = random.Random(f"{name} {seed}")
        for left in folder.glob(".topomap-*"):  # of the strike before, a kill
            left.unlink()
        target.write_text(OLD)
        after, number = draw.uniform(0, seconds), draw.choice(NUMBERS)
        status, out, err, _ = struck(call, folder, after, number)
        told = f"{name}: {number.name} after {after:.3f} s: {status} {out[-200:]} {err[-500:]}"
        text = target.read_text()
        whole = text == OLD or stable(text) == expected
        assert "Traceback" not in err, told
        if number == signal.SIGKILL:
            assert whole, told
            assert status in (0, -signal.SIGKILL), told
        else:
            assert status in (0, 130), told
            assert whole or (status == 130 and partial(text)), told
            left = {path.name for path in folder.iterdir()}
            assert left == {"out"} or (left == {"out", "out.part"} and status == 130), told
        assert stable(text) == expected or status != 0, told
        hits += status != 0
        if draw.random() < again:
            subprocess.run(call, cwd=folder, check=True, capture_output=True)
            assert stable(target.read_text()) == expected, told
            assert {path.name for path in folder.iterdir()} == {"out"}, told
    return hits


SOON = [(name, range(1)) for name in ("solve", "count")]
LATER = [pytest.param(name, range(20), marks=pytest.mark.long) for name in COMMANDS]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seeds"), [*SOON, *LATER])
def test_strikes(tmp_path, name, seeds, record_property):
    hits = strikes(name, COMMANDS[name], tmp_path, seeds, again=1 if len(seeds) == 1 else 0.3)
    assert hits >= len(seeds) // 4
    record_property("strikes", hits)


@pytest.mark.long
def test_strikes_at_the_table(tmp_path, record_property):
    hits = strikes("table", "table -o out", tmp_path, range(10), again=0.1)
    assert hits > 4
    record_property("strikes", hits)


def test_an_interrupt_where_none_can_be_raised_comes_again():
    program = """if True:
        import time
        from topomap import __main__, cli

        class Late:
            def __del__(self):
                raise KeyboardInterrupt

        def main():
            Late()
            for _ in range(500):
                time.sleep(0.01)
            return 0

        cli.main = main
        __main__.run()"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_a_killed_writer_leaves_a_file_that_the_next_one_removes(tmp_path):
    """But the file of a writer that still writes stays, and so do other files."""
    call = [BIN / "topomap", "solve", LARGE, "--json", "-o"]
    quick = [BIN / "topomap", "solve", GRID, "--closed", "-o", "quick"]
    with (
        subprocess.Popen([*call, "none"], cwd=tmp_path, stderr=subprocess.DEVNULL) as killed,
        subprocess.Popen([*call, "out"], cwd=tmp_path, stderr=subprocess.DEVNULL) as living,
    ):
        while len(list(tmp_path.glob(".topomap-*"))) < 2:
            time.sleep(0.05)
        (tmp_path / ".topomap").write_text("mine")
        killed.kill()
        killed.wait()
        assert len(list(tmp_path.glob(".topomap-*"))) == 2
        subprocess.run(quick, cwd=tmp_path, check=True)
        assert len(list(tmp_path.glob(".topomap-*"))) == 1
        living.terminate()
        assert living.wait(timeout=60) == 130
    journals = {"none.part", "out.part"}
    assert {path.name for path in tmp_path.iterdir()} - journals == {".topomap", "out", "quick"}
    assert partial((tmp_path / "out").read_text())


@pytest.mark.long
def test_several_writers_of_one_file(tmp_path):
    call = [BIN / "topomap", "generate", "grid", "3", "3", "--route", "snake", "-o", "out"]
    writers = [subprocess.Popen(call, cwd=tmp_path) for _ in range(8)]
    assert [writer.wait() for writer in writers] == [0] * 8
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out").read_text().startswith("% grid-3x3-snake\n")


@pytest.fixture
def copy(tmp_path):
    """The parts of the repository that make instances."""
    if not (ROOT / ".venv/bin/topomap").exists():
        pytest.skip("make has not set up .venv")
    for name in ("Makefile", "pyproject.toml"):
        shutil.copy2(ROOT / name, tmp_path)
    for name in (".venv", "scripts"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "instances").mkdir()
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("batch", "kills"),
    [
        ("grid 3 {3..5} --route snake\n", 1),
        pytest.param((ROOT / "instances/batch.txt").read_text(), 8, marks=pytest.mark.long),
    ],
)
def test_killed_batches(copy, batch, kills, record_property):
    """Each kill is of make and all it has started; the family file changes now and then."""
    family, folder = copy / "instances/batch.txt", copy / "build/instances"
    call = ["make", "-j2", "-o", ".venv/set-up", "instances"]
    texts = [batch, batch.replace("3..5", "3..6").replace("grid 3", "grid 4")]

    def whole():
        return {path.name: path.read_text() for path in folder.glob("*.lp")}

    def make(text, after=None):
        family.write_text(text)
        with subprocess.Popen(
            call,
            cwd=copy,
            start_new_session=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        ) as process:
            try:
                process.wait(timeout=after)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, draw.choice(NUMBERS))
            return process.wait()

    draw = random.Random("batches")
    expected, seconds = [], []
    for text in texts:
        shutil.rmtree(folder, ignore_errors=True)
        begun = time.monotonic()
        assert make(text) == 0
        seconds.append(time.monotonic() - begun)
        expected.append(whole())
    known = {(name, text) for files in expected for name, text in files.items()}
    assert len(known) > len(expected[0]) > 1
    hits, few = 0, kills < 5  # few kills are to hit
    for _ in range(kills):
        which = draw.randrange(2)
        if few or draw.random() < 0.7:
            shutil.rmtree(folder, ignore_errors=True)
        hits += make(texts[which], draw.uniform(0, seconds[which] * (0.3 if few else 1))) != 0
        time.sleep(0.1)
        assert set(whole().items()) <= known
        if few or draw.random() < 0.3:
            assert make(texts[which]) == 0
            assert whole() == expected[which]
            names = {path.name for path in folder.iterdir()} - {".family"}
            assert {Path(name).suffix for name in names} == {".lp", ".args"}
            assert len(names) == 2 * len(expected[which])
    assert hits > kills // 3
    record_property("kills of make", hits)


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [range(2), pytest.param(range(30), marks=pytest.mark.long)])
def test_time_limits(seeds, record_property):
    """A partial answer says so, and what it holds is as in the whole one."""
    whole = json.loads(run("topomap", "count", PAPER, "--json").stdout)
    maps = json.loads(run("topomap", "solve", PAPER, "--json").stdout)["maps"]
    cut = 0
    for seed in seeds:
        draw = random.Random(f"limits {seed}")
        limit = ["--timeout", f"{draw.uniform(0.001, 0.5):.3f}", "--json"]
        done = run("topomap", "count", PAPER, *limit)
        answer = json.loads(done.stdout)
        counted = [key for key in whole if key in answer and answer[key] == whole[key]]
        if done.returncode == 0:
            assert answer == whole
        else:
            assert (done.returncode, done.stderr) == (3, "")
            assert (answer["complete"], answer["fault"]) == (False, "timeout")
            steps = answer["per_step"]
            assert steps == whole["per_step"][: len(steps)]
            rest = set(whole) - {*counted, "per_step", "complete", "fault"}
            assert all(answer[key] is None for key in rest)
        cut += done.returncode == 3
        if draw.random() < 0.5:
            limit += ["--limit", str(draw.randint(1, 2000))]
        done = run("topomap", "solve", PAPER, *limit)
        answer = json.loads(done.stdout)
        assert answer["maps"] == maps[: answer["count"]]
        assert (done.returncode, done.stderr) == (0 if answer["complete"] else 3, "")
        assert answer["complete"] == (answer["count"] == len(maps))
        assert answer["fault"] in ([None] if answer["complete"] else ["timeout", "limit"])
        cut += done.returncode == 3
    assert cut >= len(seeds) // 2
    record_property("limits that cut", cut)


OUT_OF_MEMORY = "topomap: out of memory\n"


def confined(kilobytes, *arguments):
    """A command whose memory is limited: its status, its output and its messages."""
    call = ["bash", "-c", f'ulimit -v {kilobytes} && exec "$0" "$@"', BIN / "topomap", *arguments]
    done = subprocess.run(call, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def least_memory():
    """Megabytes in which all is loaded that a search needs."""
    call = "search", SNAKE, "--horizon", "0"
    return next(mb for mb in range(20, 500, 5) if not confined(mb * 1024, *call)[0])


@pytest.mark.slow
@pytest.mark.parametrize(
    "extra", [[60], pytest.param(range(0, 300, 40), marks=pytest.mark.long)], ids=len
)
def test_want_of_memory(tmp_path, extra, record_property):
    """What was found is kept, in a partial answer. Grounding a snake of 14 x 14 asks for more
    than is given here; the first maps of the small grid do not."""
    least = least_memory()
    hungry = tmp_path / "hungry.lp"
    made = run("topomap", "generate", "grid", "14", "14", "--route", "snake", "-o", hungry)
    assert made.returncode == 0
    failed = 0
    for megabytes in extra:
        limit = (least + 20 + megabytes) * 1024
        out = tmp_path / "out"
        status, printed, told = confined(limit, "solve", hungry, "--by", "clingo", "--optimal")
        assert status == 3, (megabytes, status, printed, told)
        assert printed in ("no map found yet; partial: out of memory\n", "")
        assert told == ("" if printed else OUT_OF_MEMORY)
        out.write_text(OLD)
        call = "solve", GRID, hungry, "--by", "clingo", "--json", "--planar", "-o", out
        status, _, told = confined(limit, *call)
        assert status == 3, (megabytes, status, told)
        if out.read_text() == OLD:
            assert told == OUT_OF_MEMORY
        else:
            assert "Traceback" not in told
            answer = json.loads(out.read_text())
            faults = [result["fault"] for result in answer["results"]]
            assert (answer["complete"], faults[1]) == (False, "out of memory")
            assert (faults[0], answer["results"][0]["count"]) == (None, 62) or faults[0]
        status, printed, told = confined(limit, "count", hungry, "--timeout", "3", "--json")
        assert status == 3, (megabytes, status, told)
        assert told == ("" if printed else OUT_OF_MEMORY)
        answer = json.loads(printed or '{"complete": false, "fault": null, "per_step": []}')
        assert answer["complete"] is False
        assert answer["fault"] in ("out of memory", "timeout", None)
        assert answer["per_step"][:3] == [1, 1, 1][: len(answer["per_step"])]
        failed += 2 + (answer["fault"] != "timeout")
    record_property("runs out of memory", failed)


@pytest.mark.slow
@pytest.mark.parametrize(
    "call",
    [
        f"search {quote(SNAKE)} --bound 16",
        f"search {quote(LARGE)} --order best",
        pytest.param(f"branching {quote(SNAKE)}", marks=pytest.mark.long),
    ],
)
def test_want_of_memory_of_a_search(tmp_path, call):
    """What it has counted until then is written."""
    out = tmp_path / "out"
    status, _, told = confined(
        (least_memory() + 12) * 1024, *shlex.split(call), "--json", "-o", out
    )
    assert (status, "Traceback" in told) == (3, False)
    answer = json.loads(out.read_text())
    assert (answer["complete"], answer["fault"]) == (False, "out of memory")
    if "per_step" in answer:
        steps = answer["per_step"]
        assert steps == COLUMNS[4]["expected"]["per_step"][: len(steps)]
        assert len(steps) > 8
    if "summary" in answer:
        assert len(answer["nodes"]) == answer["summary"]["nodes"] > 100


def test_want_of_memory_elsewhere(tmp_path):
    least = least_memory()
    (tmp_path / "large.lp").write_text("slots(4). " + "view(0,0). " * 3_000_000)
    for call in (
        ["solve", tmp_path / "large.lp"],
        ["generate", "grid", "300", "300", "--route", "snake", "-o", tmp_path / "out"],
    ):
        assert confined((least + 5) * 1024, *call) == (3, "", OUT_OF_MEMORY)
    assert [path.name for path in tmp_path.iterdir()] == ["large.lp"]


def test_a_thread_that_ends_unheard_is_not_waited_for(monkeypatch):
    def end(*_, **__):
        raise SystemExit  # as MemoryError does where not even that can be reported

    monkeypatch.setattr(programs.Program, "solve", end)
    with pytest.raises(Stopped, match="out of memory"):
        list(solving.hypotheses(CORRIDOR, solving.Query(), QUIET))


def test_queries_one_after_another_are_solved_in_one_thread(monkeypatch):
    threads, solve = set(), programs.Program.solve

    def note(*arguments, **named):
        threads.add(threading.get_ident())
        solve(*arguments, **named)

    monkeypatch.setattr(programs.Program, "solve", note)
    for horizon in range(4):
        assert list(solving.hypotheses(CORRIDOR, solving.Query(horizon=horizon), QUIET))
    assert len(threads) == 1
    assert threads != {threading.get_ident()}
