"""A planar part of a map, and ways for the other links through its faces."""

import random
from collections import defaultdict
from collections.abc import Sequence

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx

LINK_ORDERS = 30  # of links, for a planar part


def planar_part(world: TopologicalMap) -> TopologicalMap:
    """The map with links enough to be connected, and all further ones that leave it planar.
    Which these are depends on the order of the links; of some orders the one by which the
    rest cross the fewest links counts."""
    if not world.genus():
        return world
    draws = (random.Random(seed) for seed in range(LINK_ORDERS))
    parts = (_planar(world, draw.sample(world.edges(), len(world.edges()))) for draw in draws)

    def crossed(part: TopologicalMap) -> tuple[int, int]:
        return len(routed(part, left_out(part, world))[1]), -len(part.links)

    return min(parts, key=crossed)


def left_out(part: TopologicalMap, world: TopologicalMap) -> list[tuple[Gateway, Gateway]]:
    """The links of a map that a part of it lacks."""
    return [(out, end) for out, end in world.edges() if out not in part.links]


def _planar(world: TopologicalMap, edges: list[tuple[Gateway, Gateway]]) -> TopologicalMap:
    """The planar part by the links in this order."""
    part = TopologicalMap(world.slots, world.stars, {}, world.landmarks)
    joined = nx.utils.UnionFind(world.stars)
    tree: list[tuple[Gateway, Gateway]] = []
    others: list[tuple[Gateway, Gateway]] = []
    for link in edges:
        (p, _), (q, _) = link
        (others if joined[p] == joined[q] else tree).append(link)
        joined.union(p, q)
    for out, end in tree + others:
        links = {**part.links, out: end, end: out}
        more = TopologicalMap(world.slots, world.stars, links, world.landmarks)
        if (out, end) in tree or more.genus() == 0:
            part = more
    return part


def routed(
    part: TopologicalMap, further: Sequence[tuple[Gateway, Gateway]]
) -> tuple[TopologicalMap, list[Place]]:
    """A map of genus 0 that has the further links as well, and of it the places that are not
    the map's: each is where a further link crosses a link, and straight through it go both.
    A link is led through as few faces as can be, one after the other."""
    stars, links = dict(part.stars), dict(part.links)
    half = part.slots // 2
    right, left = max(1, half // 2), half + max(1, half // 2)
    crossings: list[Place] = []
    for out, end in further:
        at = out
        for gateway in _crossed(TopologicalMap(part.slots, stars, links), out, end):
            back = links[gateway]
            crossings.append(place := f"x{len(crossings)}")
            stars[place] = frozenset([0, right, half, left])
            for a, b in (gateway, (place, half)), ((place, 0), back), (at, (place, right)):
                links[a], links[b] = b, a
            at = place, left
        links[at], links[end] = end, at
    return TopologicalMap(part.slots, stars, links, part.landmarks), crossings


def _crossed(world: TopologicalMap, out: Gateway, end: Gateway) -> list[Gateway]:
    """The links that a line between two pending gateways crosses, from their right to their
    left: as few as can be."""
    face = {gateway: n for n, walk in enumerate(world.faces()) for gateway in walk}
    beside: dict[int, list[Gateway]] = defaultdict(list)
    for gateway, number in face.items():
        beside[number].append(gateway)

    def lies(gateway: Gateway) -> int:
        place, slot = gateway
        while (place, slot) not in world.links:
            slot = (slot - 1) % world.slots
        return face[place, slot]

    lines: dict[int, list[Gateway]] = {lies(out): []}
    for number in (waiting := list(lines)):
        for gateway in beside[number]:
            over = face[world.links[gateway]]
            if over not in lines:
                lines[over] = [*lines[number], gateway]
                waiting.append(over)
    return lines[lies(end)]
