"""Equation (1) of the paper, at every branching node of the planar search tree."""

from collections.abc import Iterator
from typing import Any

from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Attempt, Watch
from topomap.search import branching, traversal
from topomap.search.branching import BranchingNode


class BranchingNodes:
    """The branching nodes as they are found, and then their totals."""

    def __init__(self, nodes: Iterator[BranchingNode]):
        self._summary = branching.Summary()
        self._coming = nodes
        self.fault: str | None = None

    def __iter__(self) -> Iterator[BranchingNode]:
        """Give the nodes that are still to come; they are not kept."""
        with Attempt() as attempt:
            for node in self._coming:
                self._summary.add(node)
                yield node
        self.fault = attempt.fault

    @property
    def totals(self) -> dict[str, Any]:
        """The figures of the nodes that came, in all and for each step."""
        return self._summary.totals

    @property
    def holds(self) -> bool:
        """Whether equation (1) is true at each node that came."""
        return self._summary.holds

    def lines(self) -> Iterator[str]:
        """The totals as the lines that ``topomap branching`` prints."""
        yield from branching.totals_text(self.totals).splitlines()
        if self.fault:
            yield f"partial: {self.fault}; the figures are of the nodes met until then"


def branching_nodes_under(watch: Watch, experience: Experience, query: Query) -> BranchingNodes:
    """Find the branching nodes of the planar maps of a query, under the watch of a command."""
    if experience.starts:
        raise InputError("branching: equation (1) is of one log, without start(T)")
    node = traversal.root(experience, query.having("planar"))
    return BranchingNodes(branching.branching(node, watch))
