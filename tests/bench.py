"""``make bench``: what clingo and the search take for the same answers, and the memory that
the enumeration of a million maps to a file takes.

Ratios are of one run; look at ground size, choices and conflicts first.
"""

import argparse
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from topomap.environment import grid
from topomap.experience import read
from topomap.generate import instance
from topomap.search import depth_first, root
from topomap.solver import Query, Watch
from topomap.statistics import Tally

ROOT = Path(__file__).resolve().parents[1]
TASKS = [
    ("3x4, all maps", "grid-3x4-paper", (), None),
    ("3x4, planar", "grid-3x4-paper", ("planar",), None),
    ("4x4, at most 16 places", "grid-4x4-snake", (), 16),
    ("4x4, planar, at most 16 places", "grid-4x4-snake", ("planar",), 16),
    ("4x4, planar and closed", "grid-4x4-snake", ("closed", "planar"), None),
]


def ways() -> None:
    """Each task by clingo and by search: counts, ground size, conflicts, seconds."""
    print(f"{'':32}     maps    rules  choices conflicts    nodes   clingo : search")
    for name, file, parts, places in TASKS:
        experience = read(ROOT / f"instances/{file}.lp")
        query = Query(frozenset(parts), places)
        begun = time.perf_counter()
        control = query.control(experience.facts())
        control.ground()
        found = [0]

        def count(_: object, found: list[int] = found) -> None:
            found[0] += 1

        control.solve(on_model=count)
        by_clingo = time.perf_counter() - begun
        begun = time.perf_counter()
        tally = Tally(experience.steps)
        for node in depth_first(root(experience, query), Watch(quiet=True)):
            tally.add(node)
        by_search = time.perf_counter() - begun
        of_search = tally.closed_text if "closed" in parts else tally.per_step[-1]
        assert found[0] == of_search, f"{name}: clingo has {found[0]}, the search {of_search}"
        statistics = control.statistics
        rules = statistics["problem"]["lp"]["rules"]
        solver = statistics["solving"]["solvers"]
        print(
            f"{name:32}{found[0]:9,}{rules:9,.0f}{solver['choices']:9,.0f}"
            f"{solver['conflicts']:10,.0f}{sum(tally.per_step):9,}{by_clingo / by_search:16.1f} : 1"
        )


def memory(maps: int) -> None:
    """Enumerate so many maps of the 5x4 snake to a file; the resident memory as it grows."""
    with tempfile.TemporaryDirectory() as folder:
        snake, file = Path(folder) / "snake.lp", Path(folder) / "maps.txt"
        snake.write_text(instance(grid(5, 4), "snake").text())
        journal = Path(f"{file}.part")
        call = ["solve", str(snake), "--bound", "20", "--limit", str(maps), "-o", str(file)]
        begun = time.perf_counter()
        process = subprocess.Popen([sys.executable, "-m", "topomap", *call])
        samples = []
        while process.poll() is None:
            time.sleep(0.5)
            status = Path(f"/proc/{process.pid}/status").read_text()
            if journal.exists() and (resident := re.search(r"VmRSS:\s+(\d+)", status)):
                samples.append((journal.stat().st_size, int(resident[1]) / 1024))
        seconds = time.perf_counter() - begun
        with file.open() as lines:
            written = sum(line.startswith("map ") for line in lines)
        size = journal.stat().st_size
    print(f"{written:,} maps of 5x4 to a file in {seconds:.0f} s; resident memory, MB:")
    tenths = [max(mb for at, mb in samples if at <= size * part / 10) for part in range(1, 11)]
    print("  " + "  ".join(f"{10 * part}%: {mb:.0f}" for part, mb in enumerate(tenths, 1)))
    if tenths[-1] > 1.25 * tenths[0]:
        sys.exit("the memory grows with the number of maps")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--maps", type=int, default=1_000_000, help="default: %(default)s")
    arguments = parser.parse_args()
    ways()
    memory(arguments.maps)
