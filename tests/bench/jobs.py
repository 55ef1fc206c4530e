"""How much faster a count is by more processes."""

import time
from typing import Any

from topomap.model.query import Query
from topomap.paper.statistics import tree
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Watch
from topomap.solver import crews, programs
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

TASKS = {
    "5x5, planar, at most 25 places, 26 steps": ((5, 5), Query(frozenset(["planar"]), 25, 26)),
    "5x5, at most 25 places, 23 steps": ((5, 5), Query(frozenset(), 25, 23)),
}


def speedup(jobs: int) -> list[dict[str, Any]]:
    """For each task the nodes of its tree, the seconds that one process and ``jobs`` take to
    count them, and the ratio; and whether the figures of the two are the same."""
    rows: list[dict[str, Any]] = []
    for name, (size, query) in TASKS.items():
        experience = instance(grid(*size), "snake").experience
        seconds, figures = [], []
        for number in (1, jobs):
            programs.forget()
            figures.append({})
            begun = time.perf_counter()
            with crews.crew(number) as crew:
                tree(experience, query, Watch(), Journal(), figures[-1], crew)
            seconds.append(time.perf_counter() - begun)
        rows.append(
            {
                "task": name,
                "nodes": figures[0]["nodes"],
                "jobs": jobs,
                "alone": seconds[0],
                "shared": seconds[1],
                "ratio": seconds[0] / seconds[1],
                "same": figures[0] == figures[1],
            }
        )
    return rows
