"""A planar part of a map, and ways for the other links through its faces."""

import random
from collections.abc import Iterable, Sequence

from topomap.drawing.mesh import TooLong
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx
from topomap.runtime.watch import Late, never

LINK_ORDERS = 30  # the number of orders of links that are tried for a planar part
WORK = 400_000  # gateways examined for a planar part, after which no further order is tried
Link = tuple[Gateway, Gateway]


def planar_part(world: TopologicalMap, work: int = WORK, late: Late = never) -> TopologicalMap:
    """Find a planar part of the map that is connected, with as many links as fit.

    It has links enough to be connected, and all further ones that leave it planar. Which these are
    depends on the order of the links. Of several orders, the one is taken by which the other links
    cross the fewest links. For a large map fewer orders are tried: none after the first one once so
    much ``work`` is done, or when it is ``late``.

    Raises:
        TooLong: It is late before the first order is done.
    """
    if not world.genus():
        return world
    edges = world.edges()
    best: tuple[tuple[int, int], list[Link]] | None = None
    for seed in range(LINK_ORDERS):
        if best and work <= 0:
            break
        walks = Walks(world, ())
        kept = walks.planar(random.Random(seed).sample(edges, len(edges)))
        some = {*kept}
        try:
            walks.route([link for link in edges if link not in some], late)
        except TooLong:
            if best:
                break
            raise
        work -= walks.work
        crossed = len(walks.crossings), -2 * len(kept)
        if best is None or crossed < best[0]:
            best = crossed, kept
    assert best is not None
    links = {a: b for out, end in best[1] for a, b in ((out, end), (end, out))}
    return TopologicalMap(world.slots, world.stars, links, world.landmarks)


def left_out(part: TopologicalMap, world: TopologicalMap) -> list[Link]:
    """The links of a map that a part of it does not have."""
    return [(out, end) for out, end in world.edges() if out not in part.links]


def routed(
    part: TopologicalMap, further: Sequence[Link], late: Late = never
) -> tuple[TopologicalMap, list[Place]]:
    """Lead further links through the faces of a planar part, one after the other.

    Each is led through as few faces as possible.

    Returns:
        A map of genus 0 that has the further links as well, and its places that are not the map's:
        each is a crossing of a further link and a link, through which both go straight.

    Raises:
        TooLong: It is late.
    """
    walks = Walks(part, part.edges())
    walks.route(further, late)
    return walks.map(), walks.crossings


class Walks:
    """The walks round the faces of a map that grows link by link.

    Gateways are numbers. A walk passes every gateway. By one that has a link it leaves; when it
    comes to a place, or to a pending gateway, it goes on with the next gateway counter-clockwise.
    Walks are numbers, too; if a link splits one, the shorter half gets a new number. ``work``
    counts the gateways that were examined.
    """

    def __init__(self, world: TopologicalMap, links: Iterable[Link]) -> None:
        self.world = world
        self.names = list(world.gateways())
        self.number = {gateway: n for n, gateway in enumerate(self.names)}
        self.before: list[int] = []  # the next gateway of the place, counter-clockwise
        for star in world.stars.values():
            first = len(self.before)
            self.before += [first + len(star) - 1, *range(first, first + len(star) - 1)][
                : len(star)
            ]
        self.twin = [-1] * len(self.names)  # the gateway at the other end
        self.crossings: list[Place] = []
        self.work = self.walks = 0
        for out, end in links:
            a, b = self.number[out], self.number[end]
            self.twin[a], self.twin[b] = b, a
        self._number_walks()

    def _number_walks(self) -> None:
        self.face = [-1] * len(self.names)
        for start in range(len(self.names)):
            if self.face[start] < 0:
                self._mark(self._walk(start))

    def _mark(self, walk: list[int]) -> None:
        """Give a walk a number of its own."""
        for gateway in walk:
            self.face[gateway] = self.walks
        self.walks += 1
        self.work += len(walk)

    def _next(self, gateway: int) -> int:
        twin = self.twin[gateway]
        return self.before[gateway if twin < 0 else twin]

    def _walk(self, start: int) -> list[int]:
        """The gateways of a walk, beginning with one of them."""
        walk = [start]
        while (following := self._next(walk[-1])) != start:
            walk.append(following)
        return walk

    def _link(self, a: int, b: int) -> None:
        """Join two pending gateways that are on one walk, which is split."""
        self.twin[a], self.twin[b] = b, a
        one, other = [a], [b]
        while True:  # go round both halves at once, until the shorter one is complete
            for walk in one, other:
                following = self._next(walk[-1])
                if following == walk[0]:
                    self._mark(walk)
                    return
                walk.append(following)

    def planar(self, edges: Sequence[Link]) -> list[Link]:
        """Add links in their order as long as the map stays planar.

        First come those that connect the places, and then the further ones that join two gateways
        of one walk.
        """
        joined = nx.utils.UnionFind(self.world.stars)
        tree: list[Link] = []
        others: list[Link] = []
        for link in edges:
            (p, _), (q, _) = link
            (others if joined[p] == joined[q] else tree).append(link)
            joined.union(p, q)
        for out, end in tree:
            a, b = self.number[out], self.number[end]
            self.twin[a], self.twin[b] = b, a
        self._number_walks()
        kept = tree
        for out, end in others:
            a, b = self.number[out], self.number[end]
            if self.face[a] == self.face[b]:
                self._link(a, b)
                kept.append((out, end))
        return kept

    def route(self, further: Iterable[Link], late: Late = never) -> None:
        """Lead further links through the faces, across as few links as possible.

        Raises:
            TooLong: It is late.
        """
        slots = self.world.slots
        half = slots // 2
        right, left = max(1, half // 2), half + max(1, half // 2)
        for out, end in further:
            if late():
                raise TooLong
            at, to = self.number[out], self.number[end]
            for gateway in self._crossed(at, to):
                self.crossings.append(place := f"x{len(self.crossings)}")
                back, first = self.twin[gateway], len(self.names)
                ahead, aside, behind, beyond = range(first, first + 4)
                self.names += [(place, slot) for slot in (0, right, half, left)]
                self.before += [beyond, ahead, aside, behind]
                self.face += [self.face[n] for n in (gateway, gateway, back, back)]
                self.twin += [back, -1, gateway, -1]
                self.twin[gateway], self.twin[back] = behind, ahead
                self._link(at, aside)
                at = beyond
            self._link(at, to)

    def _crossed(self, out: int, end: int) -> list[int]:
        """The links that a line between two pending gateways crosses, from right to left.

        They are as few as possible.
        """
        target = self.face[end]
        start = self.face[out]
        # For each walk, the gateway and the walk before.
        came: dict[int, tuple[int, int]] = {start: (-1, start)}
        inside = [(start, out)]  # walks to examine, and a gateway of each
        for number, gateway in inside:
            if target in came:
                break
            walk = [one for one in self._walk(gateway) if self.twin[one] >= 0]
            self.work += len(walk)
            first = walk.index(min(walk))
            for one in walk[first:] + walk[:first]:
                over = self.face[self.twin[one]]
                if over not in came:
                    came[over] = one, number
                    inside.append((over, self.twin[one]))
        crossed: list[int] = []
        number = target
        while number != start:
            gateway, number = came[number]
            crossed.append(gateway)
        return crossed[::-1]

    def map(self) -> TopologicalMap:
        """The map with all its links, and with the crossings as places."""
        stars = dict(self.world.stars)
        for n, place in enumerate(self.crossings):
            first = len(self.names) - 4 * (len(self.crossings) - n)
            stars[place] = frozenset(slot for _, slot in self.names[first : first + 4])
        names = self.names
        links = {names[a]: names[b] for a, b in enumerate(self.twin) if b >= 0}
        return TopologicalMap(self.world.slots, stars, links, self.world.landmarks)
