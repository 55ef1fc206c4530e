"""The paper's own search: the figures of its tree, and the first closed map that it finds."""

from dataclasses import dataclass

from topomap.api.count import Counts
from topomap.documents.maps import BEST_FIRST
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.paper.statistics import Tally
from topomap.runtime.watch import Attempt, Watch
from topomap.search import traversal


def count_by_search_under(watch: Watch, experience: Experience, query: Query, order: str) -> Counts:
    """Count the search tree without clingo, under the watch of a command.

    ``order`` is the order in which the nodes are visited, ``breadth`` or ``depth``. If the work was
    cut short, ``at_least`` may have what is known.
    """
    node = traversal.root(experience, query)
    tally = Tally(node.experience.steps)
    with Attempt() as attempt:
        for _ in traversal.ORDERS[order](node, watch):
            tally.add(node)
            watch.found = tally.per_step[-1]
    return Counts(tally.told(attempt.fault, order), attempt.fault)


@dataclass(frozen=True)
class FirstClosed:
    """The first closed map of the best-first search, if it found one, as ``found``.

    ``nodes`` is the number of nodes that were searched, and ``fault`` says why the search was cut
    short, if it was.
    """

    found: Found | None
    nodes: int
    fault: str | None


def first_closed_under(watch: Watch, experience: Experience, query: Query) -> FirstClosed:
    """Search best-first, as the paper does, under the watch of a command.

    The search backtracks as long as the map is not closed.
    """
    nodes = 0
    found = None
    with Attempt() as attempt:
        for node in traversal.best_first(traversal.root(experience, query), watch):
            nodes += 1
            if node.steps == node.experience.steps and node.closed():
                found = Found(node.dstates, BEST_FIRST, node.cost, proved=False)
                break
    return FirstClosed(found, nodes, attempt.fault)
