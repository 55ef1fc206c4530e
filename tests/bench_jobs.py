"""How much faster a count is by more processes."""

import sys
import time

from topomap import share
from topomap.environment import grid
from topomap.generate import instance
from topomap.journal import Journal
from topomap.solver import Query, Watch
from topomap.statistics import tree

TASKS = {
    "5x5, planar, at most 25 places, 26 steps": ((5, 5), Query(frozenset(["planar"]), 25, 26)),
    "5x5, at most 25 places, 23 steps": ((5, 5), Query(frozenset(), 25, 23)),
}


def speedup(jobs: int = 2) -> list[dict[str, float | str]]:
    """For each task the nodes of its tree, the seconds that one process and ``jobs`` take to
    count them, and the ratio. The figures of the two must be the same."""
    rows: list[dict[str, float | str]] = []
    for name, (size, query) in TASKS.items():
        experience = instance(grid(*size), "snake").experience
        seconds, figures = [], []
        for number in (1, jobs):
            figures.append({})
            begun = time.perf_counter()
            with share.crew(number) as crew:
                tree(experience, query, Watch(quiet=True), Journal(), figures[-1], crew)
            seconds.append(time.perf_counter() - begun)
        if figures[0] != figures[1]:
            sys.exit(f"{name}: {jobs} processes count {figures[1]}, one {figures[0]}")
        rows.append(
            {
                "task": name,
                "nodes": figures[0]["nodes"],
                "seconds by 1": seconds[0],
                f"seconds by {jobs}": seconds[1],
                "ratio": seconds[0] / seconds[1],
            }
        )
    return rows


if __name__ == "__main__":
    for row in speedup():
        print(row)
