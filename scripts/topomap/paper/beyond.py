"""Beyond the paper's table: larger grids, and 4x4 without a bound, by depth-first search.

The last level of the tree is also counted by clingo, where that ends in time, and, if maps need not
be planar, by merging hypotheses that have the same future. Where there are too many maps for a
search, only merging counts them.
"""

from collections.abc import Iterator
from typing import Any

from topomap.model.query import Query
from topomap.paper.statistics import KEYS, final_maps, merged, searched
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Stopped, Watch
from topomap.solver.share import Crew
from topomap.worlds.environment import grid
from topomap.worlds.instance import Instance, instance

VERDICT = (
    "Counted by depth-first search, the final maps by clingo too where it finished, and by merging "
    "where maps need not be planar; by merging alone where only what it counts is shown."
)
# rows, columns, most places, planarity
COLUMNS: list[tuple[int, int, int | None, bool]] = [
    (4, 4, None, False),
    (4, 4, None, True),
    (4, 5, 20, False),
    (4, 5, 20, True),
    (5, 4, 20, False),
    (5, 4, 20, True),
    (5, 5, 25, True),
]
MERGED = [(4, 5), (5, 4)]  # with any number of places, and only by merging


def rows(
    crew: Crew, watch: Watch, journal: Journal, limit: float = 600
) -> Iterator[dict[str, Any]]:
    """Count the rows of the table; clingo gets ``limit`` seconds for each.

    Raises:
        Stopped: The work was cut short.
    """
    for height, width, places, planar in COLUMNS:
        made = instance(grid(height, width), "snake")
        query = Query(frozenset(["planar"] if planar else []), places)
        watch.title(f"{made.name}, {'planar' if planar else 'any'} maps")
        figures = searched(made.experience, query, watch, journal, crew).figures()
        yield {
            "environment": f"{height}x{width}",
            "planarity": planar,
            "places": places,
            **figures,
            "way": "depth-first search",
            "clingo": _by_clingo(made, query, limit, watch, journal, crew),
            "merging": {} if planar else _by_merging(made, query, watch, journal),
        }
    for height, width in MERGED:
        made = instance(grid(height, width), "snake")
        yield {
            "environment": f"{height}x{width}",
            "planarity": False,
            "places": None,
            **dict.fromkeys(KEYS),
            "per_step": [],
            "way": "merging",
            "clingo": {},
            "merging": _by_merging(made, Query(), watch, journal),
        }


def _by_merging(made: Instance, query: Query, watch: Watch, journal: Journal) -> dict[str, int]:
    """Count what can be counted by merging."""
    for value in journal.known(1):
        return dict(value)
    figures = dict(merged(made.experience, query, watch))
    journal.keep(figures)
    return figures


def _by_clingo(
    made: Instance, query: Query, limit: float, watch: Watch, journal: Journal, crew: Crew
) -> dict[str, int]:
    """Count the final maps, if clingo can do that in ``limit`` seconds."""
    for value in journal.known(1):
        return dict(value)
    final: dict[str, int] = {}
    try:
        with watch.deadline.earlier(limit):
            final = {"final": final_maps(made.experience, query, watch, crew)}
    except Stopped:
        watch.tick()  # raises it again, unless the limit of clingo was the reason
    journal.keep(final)
    return final
