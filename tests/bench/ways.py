"""How long ``topomap solve`` takes, beside each of its two ways alone.

It also measures how long answers take to be written, and how long a simulated robot takes.

    PYTHONPATH=tests python -m bench.ways [--networks FOLDER] [--cases FOLDER] [--only PATTERN]

Writes docs/solve.md, unless ``--only`` is given. All times are those of whole processes, except for
``json.dumps``. Exit status: 0 if each goal is met; 1 if one is missed, or if the two ways find
different numbers of maps.
"""

import argparse
import json
import os
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from topomap.runtime.files import output

from bench import rows
from bench.report import number, table
from bench.rows import ROOT

TOPOMAP = [sys.executable, "-m", "topomap"]
FOUR = "grid 4 4 --route snake"
SLACK = 6  # yardsticks
WALL, PROCESSOR = 1.2, 2.2  # times what the better way takes
LEAST, LIMIT = 10.0, 100.0  # seconds after which a way is cut, at least and at most
LARGEST = 60_000  # maps of a row
MISSED = " **missed**"
ROBOT = 400  # yardsticks, for the robot in the 5x5 grid
MORE = {  # rows that docs/benchmark.md does not have: the call that makes it, and the options
    "walk of 140 steps on 6x6, at most 20 places, perpendicular, planar": (
        "grid 6 6 --route walk --steps 140 --seed 1",
        "--perpendicular --planar --bound 20",
    ),
    "walk of 95 steps on 6x6, at most 20 places, perpendicular, planar": (
        "grid 6 6 --route walk --steps 95 --seed 1",
        "--perpendicular --planar --bound 20",
    ),
    "walk of 240 steps on 4x4, optimal, perpendicular, planar": (
        "grid 4 4 --route walk --steps 240 --seed 1",
        "--optimal --perpendicular --planar",
    ),
    "walk of 240 steps on 4x4, closed, perpendicular, planar, the first map": (
        "grid 4 4 --route walk --steps 240 --seed 1",
        "--closed --perpendicular --planar --limit 1",
    ),
    "a walk of 90 steps that has no map, closed, perpendicular, at most 2 places": (
        "{cases}/no-map-90-steps.lp",
        "--closed --perpendicular --bound 2",
    ),
    "4x4 snake, optimal": (FOUR, "--optimal"),
    "5x5 tour, optimal, planar": ("grid 5 5 --route tour", "--optimal --planar"),
    "walk of 61 steps on 5x5, optimal, perpendicular, planar": (
        "grid 5 5 --route walk --steps 61 --seed 2",
        "--optimal --perpendicular --planar",
    ),
}
HOW = (
    "Written by `make bench` (`python -m bench.ways`). It compares `topomap solve`, which "
    "[takes the way](ways.md) that needs less work, with each way alone. Seconds are those of "
    "whole processes, by the clock and (in brackets) of the processor, with the answer written "
    "to a file, on {cores} cores at a load of {load:.1f}. The yardstick Y is the time of "
    "`clingo -q` for all maps of the 4x4 snake with at most 16 places, in the same run: "
    "{yard:.3f} s by the clock.",
    "The goal is at most {wall} times what the faster of the two ways takes alone, plus {slack} "
    "Y, by the clock; and at most {processor} times the processor time of that way. A way is "
    "cut when it takes three times as long as `solve`, but not before {least:g} s, and at "
    "{limit:g} s at the latest.",
)


class Run(NamedTuple):
    """What a process took, in seconds; whether it was cut; and what it printed last."""

    wall: float
    processor: float
    cut: bool
    last: str


def run(call: list[str], limit: float = LIMIT, file: str | None = None) -> Run:
    """Run a process, which is ended after so many seconds; what it prints goes to a file."""
    begun = time.monotonic()
    with Path(file or os.devnull).open("w") as out:
        process = subprocess.Popen(call, cwd=ROOT, stdout=out, stderr=subprocess.DEVNULL)
        cut = False
        try:
            while True:
                pid, status, used = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    break
                if time.monotonic() - begun > limit:
                    cut = True
                    process.kill()
                    _, status, used = os.wait4(process.pid, 0)
                    break
                time.sleep(0.002)
        except BaseException:
            process.kill()
            raise
    process.returncode = os.waitstatus_to_exitcode(status)
    wall = time.monotonic() - begun
    last = ""
    if file:
        lines = Path(file).read_text(encoding="utf-8").splitlines()
        last = lines[-1] if lines else ""
    return Run(wall, used.ru_utime + used.ru_stime, cut, last)


def median(call: list[str], file: str | None = None, times: int = 3) -> float:
    """What a process takes by the clock."""
    return statistics.median(run(call, file=file).wall for _ in range(times))


def tasks(networks: str, cases: str) -> Iterator[tuple[str, str, list[str]]]:
    """The name of each row, the call or the file of its instance, and the options of solve."""
    _, known = rows.read()
    for row in known:
        small = row.expected is None or row.expected <= LARGEST
        if row.large or row.ask not in ("count", "maps", "one") or not small:
            continue
        if re.match(r"(11|12)x", row.name):
            continue
        options = [f"--{part}" for part in row.parts]
        if isinstance(row.places, int):
            options += ["--bound", str(row.places)]
        if row.ask == "one":
            options += ["--bound", "36", "--limit", "1"]
        yield row.name, row.generate.replace("{networks}", shlex.quote(networks)), options
    for name, (call, options_text) in MORE.items():
        yield name, call.replace("{cases}", cases), options_text.split()


def instance(call: str, folder: str) -> str | None:
    """The file of an instance; None if what it is made from is not there."""
    if call.endswith(".lp"):
        return call if Path(call).is_file() else None
    made = str(Path(folder) / "instance.lp")
    done = subprocess.run(
        [*TOPOMAP, "generate", *shlex.split(call), "-o", made], capture_output=True, cwd=ROOT
    )
    return None if done.returncode else made


def measured(file: str, options: list[str], yard: float, folder: str) -> dict[str, Any]:
    """What ``solve`` and its two ways take for a row (``solve``, ``alone``), and whether they say
    different things, such as another number of maps or another cost (``wrong``). ``wall`` is the
    time of ``solve`` by the clock, divided by the goal; ``processor`` is its processor time,
    divided by that of the faster way; both are None if both ways were cut."""
    call, answer = [*TOPOMAP, "solve", file, *options], str(Path(folder) / "answer")
    solve = run(call, LIMIT, answer)
    limit = min(LIMIT, max(LEAST, 3 * solve.wall))
    alone = {way: run([*call, "--by", way], limit, answer) for way in ("clingo", "search")}
    ended = {way: one for way, one in alone.items() if not one.cut}
    better = min(ended.values(), key=lambda one: one.wall, default=None)
    told = {re.sub(r" by \w+", "", one.last) for one in [solve, *ended.values()] if not one.cut}
    return {
        "solve": solve,
        "alone": alone,
        "wrong": len(told) > 1,
        "wall": better and solve.wall / (WALL * better.wall + SLACK * yard),
        "processor": better and solve.processor / better.processor,
    }


def seconds(one: Run) -> str:
    return f"> {one.wall:.0f}" if one.cut else f"{one.wall:.2f} ({one.processor:.2f})"


def answers(yard: float, folder: str) -> tuple[str, bool]:
    """What it takes to write 23,685 maps down; and whether a goal is missed."""
    snake, maps = str(Path(folder) / "snake.lp"), str(Path(folder) / "maps")
    subprocess.run([*TOPOMAP, "generate", *FOUR.split(), "-o", snake], check=True, cwd=ROOT)
    call = [*TOPOMAP, "solve", snake, "--bound", "16"]
    text = median(call, maps)
    kept = median([*call, "-o", maps])
    as_json = median([*call, "--json"], maps)
    document = json.loads(Path(maps).read_text(encoding="utf-8"))
    begun = time.monotonic()
    for one in document["maps"]:
        json.dumps(one)
    dumps = time.monotonic() - begun
    most = 6 * yard + 35e-6 * len(document["maps"])
    lines = [
        ["text, to standard output", text, most],
        ["text, to a file that a killed run can resume (`-o`)", kept, most],
        ["JSON", as_json, 1.5 * dumps + most],
    ]
    made = [
        [name, f"{took:.2f}", f"{goal:.2f}", f"{took / goal:.2f}{MISSED * (took > goal)}"]
        for name, took, goal in lines
    ]
    told = table(["how", "s", "goal", "s : goal"], made)
    why = (
        f"The table shows what it takes to find and write all {len(document['maps']):,} maps of "
        "the 4x4 snake with at most 16 places. The goal for text is 6 Y, plus 35 microseconds for "
        "each map. The goal for JSON is that for text, plus "
        f"1.5 times what `json.dumps` takes for the finished documents ({dumps:.2f} s).\n\n"
    )
    return why + told, any(took > goal for _, took, goal in lines)


def line(name: str, one: dict[str, Any]) -> tuple[list[str], bool]:
    """A row of the table; and whether its goal is missed, or it is wrong."""
    last = one["solve"].last
    by = re.search(r" by (\w+)", last)
    # Where both ways alone were cut, solve is the better one if it has ended.
    late = one["solve"].cut if one["wall"] is None else one["wall"] > 1
    dear = one["processor"] is not None and one["processor"] > PROCESSOR
    cells = [
        name,
        "**WRONG**" if one["wrong"] else "-" if one["solve"].cut else last.split(" ")[0],
        by[1] if by else "-",
        seconds(one["solve"]),
        *(seconds(alone) for alone in one["alone"].values()),
        number(one["wall"], 2) + MISSED * late,
        number(one["processor"], 2) + MISSED * dear,
    ]
    return cells, one["wrong"] or late or dear


def yardstick(folder: str) -> float:
    """What clingo takes for all maps of the 4x4 snake with at most 16 places, unprinted."""
    snake = str(Path(folder) / "yard.lp")
    subprocess.run([*TOPOMAP, "generate", *FOUR.split(), "-o", snake], check=True, cwd=ROOT)
    encodings = [str(ROOT / f"encodings/{part}.lp") for part in ("topomap", "bound")]
    call = [*TOPOMAP, "clingo", *encodings, snake, "0", "-q", "-c", "places=16"]
    return median(call, times=5)


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.ways", description=__doc__.partition("\n")[0])
    parser.add_argument("--networks", default=str(ROOT.parent / "shared/maps"))
    parser.add_argument("--cases", default=str(ROOT.parent / "shared/cases"))
    parser.add_argument("--only", metavar="PATTERN", help="rows whose name matches; no report")
    args = parser.parse_args()
    load, missed = os.getloadavg()[0], False
    lines: list[list[str]] = []
    with tempfile.TemporaryDirectory() as folder:
        yard = yardstick(folder)
        for name, call, options in tasks(args.networks, args.cases):
            if args.only and not re.search(args.only, name):
                continue
            file = instance(call, folder)
            if file is None:
                lines.append([name, "skipped: not there", *[""] * 6])
                continue
            cells, bad = line(name, measured(file, options, yard, folder))
            missed |= bad
            lines.append(cells)
            print(" | ".join(cells), flush=True)
        if args.only:
            return int(missed)
        told, late = answers(yard, folder)
        print(told, flush=True)
        robot = run([*TOPOMAP, "simulate", *["grid", "5", "5", "--planar", "--perpendicular"]], 200)
    slow = robot.cut or robot.wall > ROBOT * yard
    known = {"cores": os.cpu_count(), "load": load, "yard": yard, "wall": WALL, "slack": SLACK}
    known |= {"processor": PROCESSOR, "least": LEAST, "limit": LIMIT}
    how = [textwrap.fill(text.format(**known), 98, break_on_hyphens=False) for text in HOW]
    head = ["row", "maps", "by", "`solve`, s (of the processor)", "by clingo", "by search"]
    robots = (
        f"`topomap simulate grid 5 5 --planar --perpendicular` takes {seconds(robot)} s; "
        f"the goal is {ROBOT} Y, {ROBOT * yard:.0f} s{MISSED * slow}.\n"
    )
    parts = [
        "# One solve\n",
        *(text + "\n" for text in how),
        table([*head, "s : goal", "processor : better"], lines),
        "## Writing the answers\n",
        told,
        "## A robot\n",
        robots,
    ]
    with output(str(ROOT / "docs/solve.md")) as out:
        out.write("\n".join(parts))
    return int(missed or late or slow)


if __name__ == "__main__":
    sys.exit(main())
