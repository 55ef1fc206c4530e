"""Random worlds and explorations of them, for comparing ways to the same answer."""

import random

from topomap.environment import grid, world
from topomap.experience import Experience, explore
from topomap.topology import TopologicalMap


def random_world(draw: random.Random) -> TopologicalMap:
    """Any number of slots, one to six gateways a place, dead ends, parallel links, loops;
    or a small grid, cylinder or torus with ways missing; with landmarks or without."""
    made = _random_links(draw) if draw.random() < 0.5 else _thinned_grid(draw)
    rate = draw.choice([0, 0, 0.3])
    marked = [place for place in made.stars if draw.random() < rate]
    landmarks = {place: frozenset(draw.choice("ab")) for place in marked}
    return TopologicalMap(made.slots, made.stars, made.links, landmarks)


def _random_links(draw: random.Random) -> TopologicalMap:
    slots = draw.choice([2, 4, 4, 4, 6, 6, 8, 12])
    gateways = [
        (place, slot)
        for place in range(draw.randint(2, 6))
        for slot in draw.sample(range(slots), draw.randint(1, min(slots, 6)))
    ]
    draw.shuffle(gateways)
    pairs = list(zip(gateways[::2], gateways[1::2], strict=False))
    return world(slots, dict(pairs) | {b: a for a, b in pairs})


def _thinned_grid(draw: random.Random) -> TopologicalMap:
    while True:
        kind = draw.choice(["grid", "grid", "cylinder", "torus"])
        whole = grid(draw.randint(1, 3), draw.randint(2, 4), kind).map
        kept = [edge for edge in whole.edges() if draw.random() < 0.9]
        if kept:
            return world(4, dict(kept) | {b: a for a, b in kept})


def random_experience(draw: random.Random, steps: int) -> Experience:
    """A walk of up to ``steps`` steps through a random world, with a liking for going
    straight on, from any gateway of any place."""
    made = random_world(draw)
    start = place, slot = draw.choice(sorted(made.links))
    route = []
    for _ in range(draw.randint(0, steps)):
        ahead = (slot + made.slots // 2) % made.slots
        if ahead not in made.stars[place] or draw.random() < 0.5:
            ahead = draw.choice(sorted(made.stars[place]))
        route.append(ahead)
        place, slot = made.links[place, ahead]
    return explore(made, start, route)[0]
