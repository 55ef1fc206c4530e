"""Work shared out among processes and the workers of a Dask cluster: the same numbers and maps
as by one, whichever worker is lost."""

import gc
import json
import os
import random
import re
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest
from conftest import BIN, COLUMNS, ROOT
from distributed import Client, LocalCluster
from oracles.worlds import random_experience
from topomap.cli import main
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.model.vocabulary import PARTS
from topomap.paper import statistics
from topomap.paper.statistics import tree
from topomap.runtime.errors import InputError
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Stopped, Watch
from topomap.search import traversal
from topomap.solver import crews, share, solving
from topomap.solver.processes import Processes
from topomap.solver.solving import count, demand_cover, hypotheses

GRID = str(ROOT / "instances/grid-3x3-snake.lp")
PAPER = str(ROOT / "instances/grid-3x4-paper.lp")
SNAKE = str(ROOT / "instances/grid-4x4-snake.lp")
QUIET = Watch()


@pytest.fixture(scope="module")
def cluster():
    with local_cluster() as made:
        yield made.scheduler_address


@pytest.fixture(autouse=True)
def nothing_is_left_open():
    """A client left to the collector may be closed while another one starts, which then waits
    for ever."""
    yield
    eventually(lambda: not open_clients())


def open_clients():
    clients = [one for one in gc.get_objects() if isinstance(one, Client)]
    return [one.status for one in clients if one.status not in ("closed", "newly-created")]


def local_cluster():
    """A cluster of two workers, a process and a thread each."""
    return LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address=":0",
        silence_logs=50,
    )


@pytest.mark.long
def test_nothing_is_said_of_the_processes():
    for command in (["count"], ["solve", "--by", "clingo"], ["solve", "--by", "search"]):
        call = [BIN / "topomap", *command, GRID, "--jobs", "2"]
        done = subprocess.run(call, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


# What the crews are given to do


def square(number, watch):
    return number * number


def die_once(folder, number, watch):
    """Kill the worker, the first time that number 5 is tried."""
    mark = Path(folder) / "died"
    if number == 5 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die(number, watch):
    os.kill(os.getpid(), signal.SIGKILL)


def refuse(number, watch):
    raise InputError(f"number {number}")


def exhaust(number, watch):
    raise MemoryError


class Heavy:
    """What takes longer to send than the wait between two looks at the time limit."""

    def __reduce__(self):
        time.sleep(0.3)
        return Heavy, ()

    def __eq__(self, other):
        return isinstance(other, Heavy)


def lift(number, watch):
    return Heavy()


def linger(folder, number, watch):
    """Note this process, and stay while the work is wanted."""
    (Path(folder) / str(os.getpid())).touch()
    try:
        while True:
            time.sleep(0.05)
            if watch:
                watch.tick()
    except Stopped:
        (Path(folder) / "let go").touch()
        raise


# Counting


@pytest.mark.slow
@pytest.mark.parametrize("block", [*range(4), pytest.param(99, marks=pytest.mark.long)])
def test_what_clingo_counts_is_what_it_enumerates(block):
    """With each part, and for the best maps; whole, and in the parts of the tree."""
    for number in range(400) if block == 99 else range(10 * block, 10 * block + 10):
        draw = random.Random(f"counted {number}")
        experience = random_experience(draw, 9)
        parts = [part for part in PARTS if draw.random() < 0.25]
        query = Query(frozenset(parts), draw.choice([None, None, 4]), draw.choice([None, 5]))
        maps = [found.at for found in hypotheses(experience, query, QUIET) if found.proved]
        node = traversal.root(experience, query)
        grown = 0
        for at in maps:
            node = traversal.root(experience, Query(horizon=query.horizon))
            node.goto(at)
            grown += node.grown
        assert count(experience, query, (), QUIET) == (len(maps), grown)
        assert count(experience, query, (), None, grown=False) == (len(maps), 0)
        if query.optimizes:
            continue
        cubes, depth = traversal.cubes(experience, query, draw.choice([1, 2, 5, 64]))
        demand_cover(experience, query, QUIET, cubes, depth)
        begun = [sum(at[: len(cube)] == cube for at in maps) for cube in cubes]
        assert [count(experience, query, cube, QUIET)[0] for cube in cubes] == begun
        assert sum(begun) == len(maps)


def test_cubes_part_the_tree():
    for number in range(60):
        draw = random.Random(f"parted {number}")
        experience = random_experience(draw, 10)
        least = draw.choice([1, 2, 3, 8])
        cubes, depth = traversal.cubes(experience, Query(), least)
        node = traversal.root(experience, Query())
        nodes = [node.dstates for node in traversal.depth_first(node)]
        level = [at for at in nodes if len(at) == depth + 1]
        for at in nodes:
            over = [cube for cube in cubes if at[: len(cube)] == cube]
            assert len(over) <= 1
            assert over or len(at) <= depth
        sizes = {cube: sum(at[: len(cube)] == cube for at in level) for cube in cubes}
        assert all(size * least <= len(level) or size == 1 for size in sizes.values())
        assert len(cubes) >= min(least, len(level))
        above = [node.dstates for node in traversal.top(node, set(cubes))]
        below = [at for at in nodes if any(at[: len(cube)] == cube for cube in cubes)]
        assert sorted(above + below) == sorted(nodes)


def test_a_part_of_the_tree_that_is_missed_or_met_twice_is_noticed():
    experience = read(GRID)
    cubes, depth = traversal.cubes(experience, Query())
    demand_cover(experience, Query(), QUIET, cubes, depth)
    for wrong in (cubes[1:], [*cubes, cubes[-1][:-1]]):
        with pytest.raises(RuntimeError, match="differ"):
            demand_cover(experience, Query(), QUIET, wrong, depth)


def test_a_count_can_be_stopped():
    """While clingo counts, and in a program that has been used before."""
    experience = read(SNAKE)
    assert count(experience, Query(horizon=20), (), QUIET, grown=False) == (1200, 0)
    begun = time.monotonic()
    with pytest.raises(Stopped, match="timeout"):
        count(experience, Query(), (), Watch(timeout=1.0))
    assert time.monotonic() - begun < 5
    assert count(experience, Query(horizon=20), (), QUIET, grown=False) == (1200, 0)


# Crews


@pytest.fixture(params=["alone", "processes", "cluster"])
def crew(request):
    if request.param == "alone":
        return crews.crew()
    if request.param == "processes":
        return crews.crew(2)
    return crews.crew(dask=request.getfixturevalue("cluster"))


@pytest.mark.slow
def test_results_come_in_order(crew):
    with crew:
        for numbers in (range(40), [], [3]):
            assert list(crew.each(square, numbers, QUIET)) == [n * n for n in numbers]
        assert next(crew.each(square, range(40), QUIET)) == 0  # and the rest is not wanted
        assert list(crew.each(square, range(5), QUIET)) == [0, 1, 4, 9, 16]


@pytest.mark.slow
def test_the_same_figures(crew, monkeypatch):
    monkeypatch.setattr(statistics, "LARGE", 100)
    column = COLUMNS[3]
    figures = {}
    with crew:
        experience = read(ROOT / f"instances/{column['instance']}.lp")
        tree(experience, Query(frozenset(["planar"])), QUIET, Journal(), figures, crew)
    assert {**figures, **column["paper"], **column["expected"]} == figures


@pytest.mark.slow
def test_the_same_maps(cluster, capsys):
    def maps(*more):
        assert main(["solve", PAPER, "--json", "--horizon", "15", *more]) == 0
        answer = json.loads(capsys.readouterr().out)
        return answer["count"], sorted(map(json.dumps, answer["maps"]))

    whole = maps()
    for way in ("clingo", "search"):
        for more in (["--jobs", "2"], ["--dask", cluster]):
            assert maps(*more, "--by", way) == whole
    assert whole[0] > 64


def test_a_limit_holds(capsys):
    assert main(["solve", PAPER, GRID, "--limit", "70", "--json", "--jobs", "2"]) == 3
    results = json.loads(capsys.readouterr().out)["results"]
    assert [result["count"] for result in results] == [70, 70]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["processes", "cluster"])
def test_a_lost_worker_costs_its_unit_only(tmp_path, kind):
    with local_cluster() if kind == "cluster" else crews.crew(2) as made:
        crew = crews.crew(dask=made.scheduler_address) if kind == "cluster" else made
        with crew:
            done = list(crew.each(partial(die_once, tmp_path), range(20), QUIET))
            assert (tmp_path / "died").exists()
            assert done == list(range(20))


@pytest.mark.slow
def test_what_takes_long_to_send_arrives(crew):
    with crew:
        done = list(crew.each(lift, range(3), Watch(timeout=30)))
    assert done == [Heavy()] * 3


@pytest.mark.long
def test_what_kills_each_worker_is_given_up():
    with Processes(1) as crew, pytest.raises(Stopped, match=share.LOST):
        list(crew.each(die, range(3), QUIET))


def test_faults_come_home(crew):
    with crew:
        with pytest.raises(InputError, match="number 7"):
            list(crew.each(refuse, [7], QUIET))
        with pytest.raises((Stopped, MemoryError)):
            list(crew.each(exhaust, [7], QUIET))
        assert list(crew.each(square, [2], QUIET)) == [4]


class Bell(Watch):
    """A time limit that comes when so many files are in a folder."""

    def __init__(self, folder, files):
        super().__init__()
        self.folder, self.files = folder, files

    def tick(self):
        if len([*self.folder.iterdir()]) == self.files:
            raise Stopped("timeout")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["processes", "cluster"])
def test_the_time_limit_ends_what_is_being_done(tmp_path, kind, request):
    address = request.getfixturevalue("cluster") if kind == "cluster" else None
    with crews.crew(2, address) as crew, pytest.raises(Stopped, match="timeout"):
        list(crew.each(partial(linger, tmp_path), range(9), Bell(tmp_path, 2)))
    if kind == "cluster":
        eventually(lambda: (tmp_path / "let go").exists())
        with Client(address, set_as_default=False) as client:
            eventually(lambda: not any(client.processing().values()))
    else:
        assert not any(Path(f"/proc/{path.name}").exists() for path in tmp_path.iterdir())


def eventually(holds):
    """Demand that this comes true."""
    end = time.monotonic() + 20
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


def children(pid):
    """The processes that a process has started."""
    found = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(child) for child in found.read_text().split()] if found.exists() else []


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_no_worker_outlives_the_command(number):
    call = [BIN / "topomap", "count", SNAKE, "--jobs", "2", "--json"]
    with subprocess.Popen(call, stdout=subprocess.PIPE, text=True) as process:
        eventually(lambda: len(children(process.pid)) == 2)
        time.sleep(0.5)
        started = children(process.pid)
        process.send_signal(number)
        out, _ = process.communicate(timeout=60)
    if number == signal.SIGKILL:
        assert process.returncode == -number
    else:
        answer = json.loads(out)
        assert process.returncode == 130
        assert (answer["complete"], answer["fault"]) == (False, "interrupted")
    eventually(lambda: not any(running(pid) for pid in started))


def test_no_worker_outlives_a_process_that_is_killed_while_it_works(tmp_path):
    """Not even in the middle of a unit."""
    (tmp_path / "work.py").write_text(
        "import time\nfrom pathlib import Path\n"
        "def stay(number, watch):\n"
        "    Path(__file__).with_name(f'begun{number}').touch()\n"
        "    time.sleep(600)\n"
    )
    (tmp_path / "script.py").write_text(
        "from topomap.runtime.watch import Watch\n"
        "from topomap.solver.processes import Processes\n"
        "from work import stay\n"
        "list(Processes(2).each(stay, range(2), Watch()))\n"
    )
    with subprocess.Popen([sys.executable, tmp_path / "script.py"]) as process:
        eventually(lambda: len([*tmp_path.glob("begun*")]) == 2)
        started = children(process.pid)
        process.kill()
    assert len(started) == 2
    eventually(lambda: not any(running(pid) for pid in started))


@pytest.mark.slow
def test_the_interrupt_key_is_for_no_worker():
    """Ctrl-C in the terminal goes to all processes; each worker has it blocked from its start."""
    with Processes(3) as crew:
        assert list(crew.each(square, range(9), QUIET)) == [number**2 for number in range(9)]
        started = children(os.getpid())
        for pid in started:
            (line,) = re.findall(r"SigBlk:\s*(\w+)", Path(f"/proc/{pid}/status").read_text())
            assert int(line, 16) >> signal.SIGINT - 1 & 1
            os.kill(pid, signal.SIGINT)
        assert list(crew.each(square, range(9), QUIET)) == [number**2 for number in range(9)]
        assert children(os.getpid()) == started
    assert len(started) >= 3


def running(pid):
    """Whether a process runs; one that has ended and that nobody has waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


# The command


def test_usage(capsys, monkeypatch):
    for call, fault in (
        (["solve", GRID, "--jobs", "2", "--optimal"], "not the best ones"),
        (["solve", GRID, "--dask", "tcp://127.0.0.1:1", "--minimal"], "not the best ones"),
        (["solve", GRID, "--jobs", "2", "--genus"], "not the best ones"),
        (["solve", GRID, "--jobs", "2", "--dask", "tcp://127.0.0.1:1"], "not allowed with"),
        (["count", GRID, "--jobs", "0"], "whole number"),
        (["count", GRID, "--dask", ""], "--dask"),
        (["count", GRID, "--dask", "nowhere"], "--dask nowhere: "),
        (["count", GRID, "--dask", "no://127.0.0.1:1"], "--dask no://127.0.0.1:1: "),
        (["count", GRID, "--dask", "tcp://127.0.0.1:1"], "--dask tcp://127.0.0.1:1: "),
    ):
        monkeypatch.setattr("topomap.solver.cluster.PATIENCE", 1)
        assert main(call) == 2, call
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1), err
        assert fault in err
    assert main(["solve", GRID, "--jobs", "1", "--optimal"]) == 0


@pytest.mark.slow
def test_a_client_that_finds_no_cluster_is_closed(monkeypatch):
    monkeypatch.setattr("topomap.solver.cluster.PATIENCE", 1)
    gc.disable()
    try:
        for address in ("nowhere", "no://127.0.0.1:1", "tcp://127.0.0.1:1"):
            with pytest.raises(InputError):
                crews.crew(dask=address)
            assert not open_clients(), address
    finally:
        gc.enable()


def test_without_dask(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["count", GRID, "--dask", "tcp://127.0.0.1:1"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("--dask: distributed is not installed; it comes with the extra dask: ")


@pytest.mark.slow
def test_workers_that_have_another_topomap(cluster, capsys, monkeypatch):
    monkeypatch.setattr(solving, "digest", lambda: "another one")
    assert main(["count", GRID, "--dask", cluster]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "has another topomap" in err


@pytest.mark.long
def test_a_lost_cluster(capsys):
    """The scheduler goes while the work is done."""
    with local_cluster() as made:
        threading.Timer(3, made.close).start()
        begun = time.monotonic()
        assert main(["count", SNAKE, "--json", "--dask", made.scheduler_address]) == 3
        assert time.monotonic() - begun < 60
    answer = json.loads(capsys.readouterr().out)
    assert (answer["complete"], answer["fault"]) == (False, share.LOST)


def kill_a_worker(made):
    """Kill a worker of the cluster, in mid-run."""
    found = []

    def busy():
        states = list(made.scheduler.workers.values())
        at_work = {state.address for state in states if state.processing}
        found[:] = [one.pid for one in made.workers.values() if one.worker_address in at_work]
        return any(found)

    time.sleep(0.3)
    eventually(busy)
    os.kill(next(filter(None, found)), signal.SIGKILL)


@pytest.mark.parametrize(
    ("instance", "more", "kills"),
    [
        pytest.param(PAPER, [], 1, marks=pytest.mark.long),
        pytest.param(SNAKE, ["--bound", "16"], 3, marks=pytest.mark.long),
        pytest.param(SNAKE, ["--planar"], 3, marks=pytest.mark.long),
    ],
)
def test_the_same_numbers_though_workers_are_killed(monkeypatch, capsys, instance, more, kills):
    monkeypatch.setattr(statistics, "LARGE", 100)
    assert main(["count", instance, "--json", *more]) == 0
    whole = capsys.readouterr().out
    with local_cluster() as made:
        done = []

        def strike():
            for _ in range(kills):
                kill_a_worker(made)
                done.append(made)

        striker = threading.Thread(target=strike)
        striker.start()
        assert main(["count", instance, "--json", *more, "--dask", made.scheduler_address]) == 0
        struck = len(done)
        striker.join()
    assert capsys.readouterr().out == whole
    assert struck == kills
