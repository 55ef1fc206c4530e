"""Which way finds the maps of a query: the search if its tree is small, otherwise clingo.

The choice is made by counted work, never by time, so that the same input has the same answer on any
machine and at any load. The search is tried first. After 500, 1,000, 2,000 nodes and so on it
estimates how large its tree is (``Descent.size``). It is given up if the tree is too large.
"""

from collections.abc import Iterator

from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.watch import Stopped, Watch
from topomap.search.descent import MANY_PAIRS, Descent, TooLarge
from topomap.search.hypothesis import OFTEN
from topomap.solver import phases, solving

# The tree may have NODES_A_PAIR nodes for each pair of visits that can be of one place, because
# the ground program grows with these pairs; but at most FEW in all, which takes as long as clingo
# takes for some 100,000 rules. With more than MANY_PAIRS pairs the program could hardly be
# grounded, unless that is done in phases.
NODES_A_PAIR, FEW = 150, 75_000
# A query that minimises, and allows pending gateways, is harder for clingo: there are maps of
# any cost.
FEW_OPEN = 250_000
# If this is more, the tree may have so many nodes for each map: clingo takes as long to find one
# more map as the search takes to visit so many nodes.
NODES_A_MAP, NODES_A_MAP_ALONE = 20, 0.4  # with a part that prunes the tree, and without one one
NODES_A_STEP = 10  # and so many for each step, because the first map takes one for each
# If more maps than these are found, the search is no longer given up, and gives each map when it
# finds it.
KEPT = 10_000

AUTO, CLINGO, SEARCH = "auto", "clingo", "search"


class Trial:
    """A search for the maps of a query, which is given up where clingo would do better.

    ``by`` is the way that is to find the maps. If ``whole``, no more need be looked for: ``maps``
    has all maps, or the best ones if the query minimises, or one more than ``limit``. Otherwise
    ``maps`` has those that have been found (if the query minimises, the last one is the best of
    them), and ``rest`` gives the others if this search is to find them. If it is not, the search
    was given up because of the size of its tree; or for good, if ``fault`` says why: the watch has
    ended it, or it had found ``limit`` maps. ``least`` is a proved lower bound on what each map
    costs, or None.

    Parameters:
        experience: What the agent saw and did.
        query: Which maps are asked for.
        watch: What may end the search; its ``by`` is set to the way.
        kind: What the maps are said to be; by default what the query calls them.
        limit: The number of maps that is wanted; None for all.
    """

    def __init__(
        self,
        experience: Experience,
        query: Query,
        watch: Watch,
        kind: str | None = None,
        limit: int | None = None,
    ):
        self.by, self.whole = CLINGO, False
        self.fault: str | None = None
        self.maps: list[Found] = []
        self.rest: Iterator[Found | None] | None = None
        self.least: tuple[int, ...] | None = None
        self._query, self._next = query, OFTEN
        watch.by, watch.least = CLINGO, None
        if query.encoding != "work" or query.noise is not None or experience.assumed:
            return
        if experience.parted or experience.tolerance or "no_path_axiom" in query.parts:
            return  # there is no look ahead for these
        watch.by = SEARCH
        descent = Descent(experience, query, kind, self._heed)
        self._pairs = descent.pairs
        self.rest = descent.found(watch)
        many = self._pairs is None or self._pairs > MANY_PAIRS
        self._committed = many and not phases.serve(experience, query)
        if not self._committed:
            self._try(descent, watch, limit)
        if self.rest:
            self.by = SEARCH
        watch.by = self.by

    def _try(self, descent: Descent, watch: Watch, limit: int | None) -> None:
        """Search until it is decided which way is to find the maps."""
        known, minimises = watch.found, self._query.optimizes
        assert self.rest is not None
        try:
            for found in self.rest:
                if found:
                    self.maps.append(found)
                many = len(self.maps)
                if not minimises and many > KEPT:
                    self._committed = True
                    return
                if not minimises and limit is not None and many > limit:
                    break
            self.by, self.whole = SEARCH, True
            if minimises:
                self.maps = [found for found in self.maps if found.proved]
        except Stopped as stopped:
            self.by, self.fault = SEARCH, str(stopped)
        except TooLarge:
            if limit is not None and len(self.maps) >= limit:
                self.by, self.fault = SEARCH, "limit"
            else:
                watch.found = known
        self.rest = None
        self.least = descent.least

    def _heed(self, descent: Descent) -> None:
        """Give the search up if the tree is larger than is worth while.

        It goes on if little of the tree is left. If the query minimises, the tree shrinks as better
        maps are found, and an estimate would be too large, so the number of visited nodes is
        compared.

        Raises:
            TooLarge: The tree is too large.
        """
        if self._committed:
            return
        nodes, worth, size = descent.nodes, self._worth(descent), 0.0
        if nodes >= self._next:
            while self._next <= nodes:
                self._next *= 2
            # Before the end of a branch is reached, nothing is known of the other branches.
            if descent.passed and not self._query.optimizes:
                size = descent.size
        little = descent.size - nodes <= nodes / 4
        if nodes > 3 * worth or (max(nodes, size) > worth and not little):
            raise TooLarge

    def _worth(self, descent: Descent) -> float:
        """The largest number of nodes that is worth while.

        Even if few visits look alike, each step is a node.
        """
        steps = NODES_A_STEP * descent.node.experience.steps
        if self._query.optimizes and "closed" not in self._query.parts:
            return max(FEW_OPEN, steps)
        nodes = FEW if self._pairs is None else min(FEW, NODES_A_PAIR * self._pairs)
        prunes = bool(self._query.parts & {"planar", "perpendicular", "closed"})
        return max(nodes, steps, (NODES_A_MAP if prunes else NODES_A_MAP_ALONE) * descent.expected)


def hypotheses(
    experience: Experience, query: Query, watch: Watch, kind: str | None = None
) -> Iterator[Found | None]:
    """Find the maps of a query that minimises, by the way that has less work to do.

    It gives what ``solving.hypotheses`` gives, and sets ``watch.by`` to the way. A map that is not
    proved to be best is given only if it is better than the best one of the search.
    """
    trial = Trial(experience, query, watch, kind)
    if trial.whole:
        yield from trial.maps
        return
    if trial.rest:
        yield from trial.rest
        return
    best = trial.maps[-1:]  # it is open only if no closed map is found
    if best:
        watch.by, watch.least = SEARCH, trial.least
        yield from best
    if trial.fault:
        raise Stopped(trial.fault)
    for found in solving.hypotheses(experience, query, watch, kind):
        better = not best or (found and (best[0].open or found.cost < best[0].cost))
        if not found or found.proved or better:
            watch.by, watch.least = CLINGO, trial.least
            yield found
    watch.by = CLINGO
