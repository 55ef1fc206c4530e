"""The paper's own search: the figures of its tree, and the first closed map by its policy."""

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
    """The figures of the search tree, whose nodes are passed in that order, ``breadth`` or
    ``depth``, under the watch of a command. If the work was cut, ``at_least`` may have what
    is known."""
    node = traversal.root(experience, query)
    tally = Tally(node.experience.steps)
    with Attempt() as attempt:
        for _ in traversal.ORDERS[order](node, watch):
            tally.add(node)
            watch.found = tally.per_step[-1]
    return Counts(tally.told(attempt.fault, order), attempt.fault)


@dataclass(frozen=True)
class FirstClosed:
    """The first closed map that the best-first search ``found``, if it did, after so many
    ``nodes``; ``fault`` says why it was cut, if it was."""

    found: Found | None
    nodes: int
    fault: str | None


def first_closed_under(watch: Watch, experience: Experience, query: Query) -> FirstClosed:
    """The paper's best-first search, with backtracking while the map is not closed, under the
    watch of a command."""
    nodes = 0
    found = None
    with Attempt() as attempt:
        for node in traversal.best_first(traversal.root(experience, query), watch):
            nodes += 1
            if node.steps == node.experience.steps and node.closed():
                found = Found(node.dstates, BEST_FIRST, node.cost, proved=False)
                break
    return FirstClosed(found, nodes, attempt.fault)
