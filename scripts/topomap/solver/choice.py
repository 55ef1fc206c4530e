"""Which way gives the maps of a query: the search where its tree is small, and else clingo.

That is decided by counted work, never by time, so that the same input has the same answer on any
machine and at any load. The search begins. After 500 nodes, 1,000 and so on it tells how large
its tree is (``Descent.size``); as long as it is worth it, it goes on.
"""

from collections.abc import Iterator

from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search.descent import Descent, TooLarge
from topomap.solver import solving

# What a tree may have, in nodes: so many for each pair of visits that can be of one place, as the
# ground program grows with these; but no more than FEW, which take as long as clingo takes for
# some 100,000 rules, unless there are so many pairs that the program could hardly be grounded.
NODES_A_PAIR, FEW, MANY_PAIRS = 150, 75_000, 5_000
# A query that minimises, and allows pending gateways, is harder for clingo: there are maps of
# any cost.
FEW_OPEN = 250_000
# And so many for each map: to find one more takes clingo as long as the search takes for these.
NODES_A_MAP, NODES_A_MAP_ALONE = 20, 0.4  # with a part that prunes the tree, and without
# More maps than these are not kept until the search is done: it begins anew, and hands them over.
KEPT = 10_000

AUTO, CLINGO, SEARCH = "auto", "clingo", "search"


class Trial:
    """A search for the maps of a query that ends where clingo would do better.

    ``by`` is the way that is to give them. If the search has ended, ``whole`` says so, and ``maps``
    has all of them, or the best ones; or else those that were found until then, of which the
    last one is the best so far, and which may be ``enough``: as many as are wanted.
    """

    def __init__(
        self,
        experience: Experience,
        query: Query,
        watch: Watch,
        kind: str | None = None,
        limit: int | None = None,
    ):
        self.by, self.whole, self.enough = CLINGO, False, False
        self.maps: list[Found] = []
        self.least: tuple[int, ...] | None = None
        self._query, self._limit = query, limit
        if query.encoding != "work" or query.noise is not None:
            return
        descent = Descent(experience, query, kind, self._heed)
        self._pairs = descent.node.future.pairs
        known = watch.found
        try:
            for found in descent.found(watch):
                if found:
                    self.maps.append(found)
                if limit is not None and len(self.maps) > limit and not query.optimizes:
                    break
            self.by, self.whole = SEARCH, True
            if query.optimizes:
                self.maps = [found for found in self.maps if found.proved]
        except TooLarge:
            self.enough = limit is not None and len(self.maps) >= limit
            watch.found = len(self.maps) if self.enough else known
        self.least = descent.least

    def _heed(self, descent: Descent) -> None:
        """Raises TooLarge if the tree is not worth it, or it is but has too many maps to keep."""
        # Of a query that minimises the tree becomes smaller as better maps are found.
        size = descent.nodes if self._query.optimizes else max(descent.size, descent.nodes)
        if size > self._worth(descent):
            raise TooLarge
        if len(self.maps) > KEPT and not self._query.optimizes:
            self.by = SEARCH
            raise TooLarge

    def _worth(self, descent: Descent) -> float:
        """How many nodes are worth it."""
        pairs = self._pairs
        if self._query.optimizes and "closed" not in self._query.parts:
            return FEW_OPEN
        nodes = FEW if pairs is None else NODES_A_PAIR * pairs
        if pairs is not None and pairs <= MANY_PAIRS:
            nodes = min(nodes, FEW)
        prunes = bool(self._query.parts & {"planar", "perpendicular", "closed"})
        return max(nodes, (NODES_A_MAP if prunes else NODES_A_MAP_ALONE) * descent.expected)


def hypotheses(
    experience: Experience, query: Query, watch: Watch, kind: str | None = None
) -> Iterator[Found | None]:
    """What ``solving.hypotheses`` gives of a query that minimises, by the way that suits;
    ``watch.by`` says by which. Of maps that are not proved to be best, only better ones than the
    best of the search are given."""
    trial = Trial(experience, query, watch, kind)
    watch.by, watch.least = trial.by, trial.least
    if trial.whole:
        yield from trial.maps
        return
    best = trial.maps[-1:]
    if best:
        watch.by = SEARCH
        yield from best
    for found in solving.hypotheses(experience, query, watch, kind):
        if not found or found.proved or not best or found.cost < best[0].cost:
            watch.by = CLINGO
            yield found
    watch.by = CLINGO
