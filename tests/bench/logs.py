"""How the time of ``topomap solve`` grows with the length of the log: random walks through grids.

    PYTHONPATH=tests python -m bench.logs [--lengths N ...]

Writes docs/logs.md, unless ``--lengths`` is given. All times are those of whole processes, by the
clock. Exit status: 0 if each goal is met; 1 if one is missed.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from topomap.runtime.files import output

from bench.report import table
from bench.ways import MISSED, ROOT, TOPOMAP, run, yardstick

SEEDS = range(5)
GOALS = {4_000: 65, 50_000: 400}  # yardsticks, of all maps
LENGTHS = (240, 1_000, *GOALS)
BEST = 30  # yardsticks, of the best map that is found by then
LIMIT = 65  # yardsticks: what a row without a goal is given


class World(NamedTuple):
    """Where the walks lead: the call that makes the world, how many places and paths it has, and
    what is asked of the maps."""

    name: str
    call: str
    places: int
    paths: int
    options: str


WORLDS = (
    World("4x4", "grid 4 4", 16, 8, ""),
    World("5x5, planar, perpendicular", "grid 5 5", 25, 10, "--planar --perpendicular"),
    World("6x6 with a compass, planar", "grid 6 6 --compass", 36, 12, "--planar"),
)
HEAD = """# Long logs

Written by `make bench` (`python -m bench.logs`). The logs are random walks through three grids,
five of each length. Seconds are those of whole processes, by the clock, on {cores} cores, at a load
of {load:.1f} when the run began. The yardstick Y is the time of `clingo -q` for all maps of the
4x4 snake with at most 16 places, in the same run: {yard:.3f} s. A call is cut after 1.5 times
its goal, or after {limit:.0f} Y if it has no goal.

## All maps

The maps may have at most as many places as the world has. The goal is 65 Y for 4,000 steps, and
400 Y for 50,000 steps.
"""
BEST_HEAD = """
## The best map that is found soon

`topomap solve --minimal`, with any number of places, is cut after {best} Y. The columns are: in how
many of the five walks it has found a map by then; how many of these maps have as many paths and
places as the world; how many have fewer paths, or as many paths and fewer places; and how many are
proved to be best. (A map with fewer paths and fewer places may fit a walk, too.)
"""


def walk(world: World, steps: int, seed: int, folder: str) -> str:
    """The file of a random walk."""
    file = str(Path(folder) / "walk.lp")
    call = [*world.call.split(), "--route", "walk", "--steps", str(steps), "--seed", str(seed)]
    subprocess.run([*TOPOMAP, "generate", *call, "-o", file], check=True, cwd=ROOT)
    return file


def every(world: World, steps: int, yard: float, folder: str) -> tuple[list[str], bool]:
    """The row of all maps of the walks of a length; and whether its goal is missed."""
    took, maps = [], []
    answer = str(Path(folder) / "answer")
    for seed in SEEDS:
        file = walk(world, steps, seed, folder)
        options = [*world.options.split(), "--bound", str(world.places)]
        one = run([*TOPOMAP, "solve", file, *options], 1.5 * GOALS.get(steps, LIMIT) * yard, answer)
        took.append(float("inf") if one.cut else one.wall)
        maps.append(0 if one.cut else int(one.last.split()[0]))
    goal = GOALS.get(steps)
    late = goal is not None and max(took) > goal * yard
    found = sorted({many for many in maps if many})
    cells = [
        f"{world.name}, {steps:,} steps",
        " to ".join(f"{many:,}" for many in dict.fromkeys([found[0], found[-1]])) if found else "-",
        str(sum(1 for many in maps if many)),
        seconds(statistics.median(took)),
        seconds(max(took)),
        ("-" if max(took) == float("inf") else f"{max(took) / yard:.0f}") + MISSED * late,
    ]
    return cells, late


def seconds(took: float) -> str:
    return "cut" if took == float("inf") else f"{took:.1f}"


def best(world: World, steps: int, yard: float, folder: str) -> tuple[list[str], bool]:
    """The row of the best maps without a bound; and whether one is missing."""
    known: list[tuple[int, int] | None] = []
    proved = 0
    answer = str(Path(folder) / "answer")
    for seed in SEEDS:
        file = walk(world, steps, seed, folder)
        options = [*world.options.split(), "--minimal", "--timeout", f"{BEST * yard:.2f}"]
        one = run([*TOPOMAP, "solve", file, *options], 2 * BEST * yard, answer)
        cost = re.search(r"cost (\d+) (\d+)", one.last)
        known.append((int(cost[1]), int(cost[2])) if cost else None)
        proved += bool(cost) and "partial" not in one.last
    found = [cost for cost in known if cost]
    true = sum(cost == (world.paths, world.places) for cost in found)
    fewer = sum(cost < (world.paths, world.places) for cost in found)
    cells = [f"{world.name}, {steps:,} steps", *map(str, (len(found), true, fewer, proved))]
    missing = len(found) < len(SEEDS)
    cells[1] += MISSED * missing
    return cells, missing


def rows(make: Any, lengths: Iterable[int], *rest: Any) -> tuple[list[list[str]], bool]:
    """The rows of a table; and whether the goal of one is missed."""
    lines, missed = [], False
    for world in WORLDS:
        for steps in lengths:
            cells, late = make(world, steps, *rest)
            missed |= late
            lines.append(cells)
            print(" | ".join(cells), flush=True)
    return lines, missed


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.logs", description=__doc__.partition("\n")[0])
    parser.add_argument("--lengths", type=int, nargs="+", metavar="N", help="these; no report")
    args = parser.parse_args()
    lengths = args.lengths or LENGTHS
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        yard = yardstick(folder)
        print(f"Y = {yard:.3f} s", flush=True)
        whole, late = rows(every, lengths, yard, folder)
        some, missing = rows(best, [n for n in lengths if n <= 4_000], yard, folder)
    if args.lengths:
        return int(late or missing)
    known = {
        "cores": os.cpu_count(),
        "load": load,
        "yard": yard,
        "limit": 1.5 * LIMIT,
        "best": BEST,
    }
    head = ["walks", "maps", "walks that ended", "s, median", "s, longest", "longest, Y"]
    best_head = ["walks", "a map", "as the world", "fewer paths or places", "proved"]
    with output(str(ROOT / "docs/logs.md")) as out:
        out.write(HEAD.format(**known) + "\n" + table(head, whole))
        out.write(BEST_HEAD.format(**known) + "\n" + table(best_head, some))
    return int(late or missing)


if __name__ == "__main__":
    sys.exit(main())
