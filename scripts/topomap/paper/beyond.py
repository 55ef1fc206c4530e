"""Beyond the paper's table: larger grids, and 4x4 without a bound, by depth-first search. The
last level of the tree is counted by clingo too, where that ends in time."""

from collections.abc import Iterator
from typing import Any

from topomap.model.query import Query
from topomap.paper.statistics import final_maps, searched
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Stopped, Watch
from topomap.solver.share import Crew
from topomap.worlds.environment import grid
from topomap.worlds.instance import Instance, instance

VERDICT = "Counted by depth-first search, the final maps by clingo too where it finished."
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


def rows(
    crew: Crew, watch: Watch, journal: Journal, limit: float = 600
) -> Iterator[dict[str, Any]]:
    """The rows of the table; clingo is given ``limit`` seconds for each. Raises Stopped."""
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
        }


def _by_clingo(
    made: Instance, query: Query, limit: float, watch: Watch, journal: Journal, crew: Crew
) -> dict[str, int]:
    """The number of final maps, if clingo has it in ``limit`` seconds."""
    for value in journal.known(1):
        return dict(value)
    final: dict[str, int] = {}
    try:
        with watch.deadline.earlier(limit):
            final = {"final": final_maps(made.experience, query, watch, crew)}
    except Stopped:
        watch.tick()  # raises it again, if it was not for the limit
    journal.keep(final)
    return final
