"""Depth-first search for the maps of a query, which looks ahead and estimates its tree."""

import heapq
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace

from topomap.model.experience import Experience
from topomap.model.found import BEST_SO_FAR, OPTIMAL, Cube, Found
from topomap.model.query import Query
from topomap.runtime.watch import Stopped, Watch, spared
from topomap.search.hypothesis import OFTEN, Hypothesis
from topomap.search.lookahead import LookAhead

# After GREEDY_AFTER nodes, a search that minimises visits at most GREEDY nodes best-first.
GREEDY_AFTER, GREEDY = 4_000, 10_000
# If it has still found no map, it looks for one with few places (``_deepen``), and visits up to
# DEEPEN nodes for each node of its own; this is repeated whenever its nodes have doubled. If more
# than MANY_PAIRS pairs of visits can be of one place, and any number of places is allowed, the tree
# is too large to be searched: then this is done from the beginning, with DEEPEN_LONG nodes.
DEEPEN, DEEPEN_LONG, MANY_PAIRS = 4, 500, 5_000
Cost = tuple[int, ...]


class TooLarge(Exception):
    """The search was ended because its tree is too large."""


class Unforeseen(Hypothesis):
    """A hypothesis without any look ahead.

    It is used for experiences with steps that are not a travel, or with bearings that are not
    exact, and without the path axiom.
    """

    def __init__(self, experience: Experience, query: Query):
        planar = bool(query.parts & {"planar", "euler"})
        path_axiom = "no_path_axiom" not in query.parts
        perpendicular = "perpendicular" in query.parts
        super().__init__(experience, planar, query.places, perpendicular, path_axiom)

    def least(self) -> tuple[int, int]:
        """Proved lower bounds on the paths and places of each map below this node."""
        left = sum(turn is not None for turn in self.experience.turns[self.steps :])
        return max(1, len(self.paths) - left), self.places


class Descent:
    """A search for the maps of a query.

    ``nodes`` is the number of nodes that were visited, and ``maps`` that of the maps that were
    found. ``passed`` estimates which share of the tree was searched, as if the trees below the
    children of a node were equally large. From it follow ``size``, an estimate of the nodes of the
    tree, and ``expected``, an estimate of the maps. ``heed`` is called with this search after each
    OFTEN nodes; it may raise TooLarge to end the search.

    If the query minimises, a node is left if each map below it costs more than the best one so far
    (``LookAhead.least``); no map costs less than ``least``.
    """

    def __init__(
        self,
        experience: Experience,
        query: Query,
        kind: str | None = None,
        heed: Callable[["Descent"], None] | None = None,
    ):
        if query.horizon is not None:
            experience = experience.cut(query.horizon)
        self.query, self._experience = query, experience
        unforeseen = experience.parted or experience.tolerance or "no_path_axiom" in query.parts
        self.node = Unforeseen(experience, query) if unforeseen else LookAhead(experience, query)
        self.nodes = self.maps = 0
        self.passed = 0.0
        self._kind = kind or query.kind
        self._heed = heed
        self._watch: Watch | None = None
        self._best: dict[Cube, Found] = {}  # they all have one cost
        self._worst: Cost | None = None  # their cost; no map that costs more is wanted
        self._fewest: int | None = None  # the least number of places of the maps that were found
        # The number of places that the next search for a map with few places allows; and, if the
        # genus is minimised, whether that search is for planar maps.
        self._deepened: int | None = None
        self._flat = True
        # For each node on the way to the current one: the gateway of arrival; its children that are
        # still to be visited, the share of the tree below each, and the least cost of a map below
        # them.
        self._decided: list[int] = []
        self._way: list[tuple[list[int], float, Cost]] = []

    @property
    def pairs(self) -> int | None:
        """The number of pairs of visits that can be of one place.

        It is None for very many visits, and if there is no look ahead.
        """
        return self.node.future.pairs if isinstance(self.node, LookAhead) else None

    @property
    def _large(self) -> bool:
        """Whether the tree is too large to be searched."""
        return self.query.places is None and (self.pairs is None or self.pairs > MANY_PAIRS)

    @property
    def size(self) -> float:
        """An estimate of the number of nodes of the tree."""
        return self.nodes / self.passed if self.passed else float("inf")

    @property
    def expected(self) -> float:
        """An estimate of the number of maps; 0 before the end of a branch was reached.

        (Maps may have been found elsewhere by then.)
        """
        return self.maps / self.passed if self.passed else 0.0

    @property
    def least(self) -> Cost | None:
        """A proved lower bound on the cost of each map.

        It is None if nothing is minimised, or if there is no map.
        """
        if not self.query.optimizes:
            return None
        costs = [cost for children, _, cost in self._way if children]
        costs += [self._cost()] if self._way else []
        costs += [self._worst] if self._worst else []
        return min(costs, default=None)

    @spared
    def found(
        self, watch: Watch | None = None, cubes: Sequence[Cube] | None = None
    ) -> Iterator[Found | None]:
        """Find what ``solving.hypotheses`` gives, in the order of the tree.

        Raises:
            Stopped: The watch ends the search. What ``heed`` raises is passed on, too.
        """
        self._watch = watch
        try:
            for cube in cubes or [((0, 0),)]:
                self.node.goto(cube)
                if watch:
                    watch.tick()
                yield from self._below()
                if cubes is not None:
                    yield None
        except Stopped:
            if watch and self._best:
                watch.least = self.least
            raise
        for one in self._best.values():
            yield replace(one, proved=True)

    def _below(self) -> Iterator[Found]:
        """The maps at the current node and below it.

        They are better and better ones if the query minimises.
        """
        node, steps, way = self.node, self.node.experience.steps, self._way
        if node.steps == steps:
            yield from self._here()
            return
        minimises = self.query.optimizes
        way.append(self._open(1.0))
        begun, decided = tuple(node.at), self._decided
        decided.clear()
        look = self.nodes - self.nodes % OFTEN + OFTEN
        after = OFTEN if self._large else GREEDY_AFTER
        again = after
        while way:
            children, share, _ = way[-1]
            if not children:
                way.pop()
                if way:
                    node.undo()
                    decided.pop()
                continue
            decided.append(children.pop())
            before = node.steps
            alive = self._enter(decided[-1])
            self.nodes += node.steps - before
            if self.nodes >= look:
                look = self.nodes - self.nodes % OFTEN + OFTEN
                if self._watch:
                    self._watch.tick()
                if self._heed:
                    self._heed(self)
                if self.nodes >= again and minimises:
                    yield from self._for_a_while(begun, again == after)
                    again = 2 * max(again, self.nodes)
            if not alive:
                pass
            elif node.steps == steps:
                yield from self._here()
            elif self._worst is None or self._cost() <= self._worst:
                below = self._open(share)
                if below[0]:
                    way.append(below)
                    continue
            self.passed += share
            node.undo()
            decided.pop()

    def _enter(self, arrival: int) -> bool:
        """Go on to a child, and over known links; return False if there can be no map below."""
        self.node.enter(arrival)
        return self.node.run()

    def _for_a_while(self, begun: Sequence[int], first: bool) -> Iterator[Found]:
        """Look for good maps elsewhere in the tree, which help to cut it.

        ``first`` tells whether this was not done before. Afterwards the search is at the same node
        again, below ``begun``.
        """
        large = self._large
        if first and not large:
            yield from self._greedily(begun)
        if self._worst is None and first and self._kind == OPTIMAL:
            yield from self._open_ones()
        if self._worst is None or large:
            yield from self._deepen(begun, (DEEPEN_LONG if large else DEEPEN) * self.nodes)

    def _greedily(self, begun: Sequence[int]) -> Iterator[Found]:
        """Best-first search by the paper's policy (section IV).

        The node whose map costs least so far comes first, and of equal ones the deepest. It gives
        the first map that it finds, and better ones. It visits at most GREEDY nodes, and once it
        has found a map after n nodes, at most 2 * n + OFTEN. So a good map is found soon, which
        cuts the tree. A node is identified by its decisions: where it arrived by each step that was
        not over a known link. Afterwards the search is at the same node again, below ``begun``.
        """
        node, steps = self.node, self.node.experience.steps
        node.go(begun[:1])
        border: list[tuple[Cost, int, tuple[int, ...]]] = [(self._of(node.cost), 0, ())]
        most, nodes = GREEDY, 0
        here: tuple[int, ...] = ()
        while border and nodes < most:
            *_, decided = heapq.heappop(border)
            self._go(here, decided)
            here = decided
            nodes += 1
            if self._watch and nodes % OFTEN == 0:
                self._watch.tick()
            if self._worst is not None and self._cost() >= self._worst:
                continue
            for arrival in node.children():
                alive = self._enter(arrival)
                if alive and node.steps == steps:
                    for found in self._here():
                        most = min(most, 2 * nodes + OFTEN)
                        yield found
                elif alive:
                    heapq.heappush(border, (self._of(node.cost), -node.steps, (*decided, arrival)))
                node.undo()
        node.go(begun[:1])
        node.go(begun)
        self._go((), self._decided)

    def _open_ones(self) -> Iterator[Found]:
        """Find the best map with pending gateways, as far as it is found soon.

        This is done while no closed map is found. If there is a closed map, this one is not
        optimal.
        """

        def heed(descent: "Descent") -> None:
            """End the search when it has had its share of nodes."""
            if descent.nodes > (0 if self._large else GREEDY_AFTER) + OFTEN:
                raise TooLarge

        query = replace(self.query, parts=self.query.parts - {"closed"})
        try:
            for found in Descent(self._experience, query, BEST_SO_FAR, heed).found(self._watch):
                if found:
                    yield replace(found, kind=OPTIMAL, proved=False, open=True)
        except TooLarge:
            pass

    def _deepen(self, begun: Sequence[int], most: int) -> Iterator[Found]:
        """Iterative deepening by the number of places.

        A depth-first search looks for a map of as few places as possible, then of one more, and so
        on, until no map of fewer places is known or ``most`` nodes were visited: the fewer places
        are allowed, the smaller is the tree. If the genus is minimised, every other search is for
        planar maps. Afterwards the search is at the same node again, below ``begun``.
        """
        node = self.node
        if not isinstance(node, LookAhead):
            return
        steps, planar, bound = node.experience.steps, node.planar, node.bound
        node.go(begun[:1])
        if self._deepened is None:
            self._deepened = node.least_places
        elif "genus" in self.query.parts:
            self._flat = not self._flat
        node.planar = planar or ("genus" in self.query.parts and self._flat)
        nodes = 0
        try:
            while nodes < most and self._deepened <= self._places(bound):
                node.bound, way = self._deepened, [node.children()[::-1]]
                while way and nodes < most and self._deepened <= self._places(bound):
                    if not way[-1]:
                        way.pop()
                        if way:
                            node.undo()
                        continue
                    nodes += 1
                    if self._watch and nodes % OFTEN == 0:
                        self._watch.tick()
                    alive = self._enter(way[-1].pop())
                    alive = alive and (self._worst is None or self._cost() <= self._worst)
                    if alive and node.steps < steps:
                        way.append(node.children()[::-1])
                        continue
                    if alive:
                        yield from self._here()
                    node.undo()
                self._deepened += not way
                for _ in way[1:]:
                    node.undo()
        finally:
            node.planar, node.bound = planar, bound
        node.go(begun)
        self._go((), self._decided)

    def _places(self, bound: int | None) -> int:
        """The largest number of places of a map that is worth looking for."""
        most = self.node.experience.steps + 1 if bound is None else bound
        return most if self._fewest is None else min(most, self._fewest - 1)

    def _go(self, here: Sequence[int], decided: Sequence[int]) -> None:
        """Go from one node to another one; each is identified by its decisions."""
        pairs = enumerate(zip(here, decided, strict=False))
        common = next((n for n, (a, b) in pairs if a != b), min(len(here), len(decided)))
        for _ in here[common:]:
            self.node.undo()
        for arrival in decided[common:]:
            self._enter(arrival)

    def _open(self, share: float) -> tuple[list[int], float, Cost]:
        """Find the children of the current node.

        Returns:
            The children in reverse order; the share of the tree below each of them, if ``share`` is
            that of the node; and the least cost below the node.
        """
        children = self.node.children()[::-1]
        return children, share / max(1, len(children)), self._cost()

    def _cost(self) -> Cost:
        """The least cost that a map below the node may have, the most important number first.

        It is empty if the query minimises nothing.
        """
        return self._of(self.node.least()) if self.query.optimizes else ()

    def _of(self, paths_and_places: tuple[int, int]) -> Cost:
        """What the query minimises, for these numbers of paths and places.

        The genus of the node's map comes first, which no link makes smaller, then its exceptions,
        of which nothing is known before the map is complete.
        """
        node, parts = self.node, self.query.parts
        genus = (node.genus,) if "genus" in parts else ()
        exceptions: Cost = ()
        if "exceptions" in parts:
            whole = node.steps == node.experience.steps
            exceptions = (sum(1 for _ in node.map.exceptions()) if whole else 0,)
        return genus + exceptions + (paths_and_places if "minimal" in parts else ())

    def _here(self) -> Iterator[Found]:
        """The map of the current node, if it is one of the query.

        If the query minimises, it must be better than those before.
        """
        cost = self._cost()
        if self._worst is not None and cost > self._worst:
            return
        if not holds(self.node, self.query.parts):
            return
        self.maps += 1
        self._fewest = min(self._fewest or self.node.places, self.node.places)
        if self._watch:
            self._watch.found += 1
        one = Found(self.node.dstates, self._kind, cost, not self.query.optimizes)
        if self.query.optimizes:
            better = self._worst is None or cost < self._worst
            if better:
                self._best, self._worst = {}, cost
            self._best.setdefault(one.at, one)
            if not better:
                return
        yield one


def holds(node: Hypothesis, parts: Collection[str]) -> bool:
    """Tell whether a map has the properties that can only be checked of the whole."""
    return (
        ("euler" not in parts or node.genus == 0)
        and ("closed" not in parts or node.closed())
        and ("travelled" not in parts or node.travelled())
        and ("perpendicular" not in parts or node.path_axiom or node.square())
        and ("boundary" not in parts or node.map.boundaries_consistent())
    )
