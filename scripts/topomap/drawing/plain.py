"""Plain drawings, which take little time.

Places are about as far from each other as they are in the map, and lines are straight from one to
the other. Lines leave each place in their order, but may cross where they need not. They are led
round the places under which they would pass.
"""

from collections.abc import Mapping

import numpy as np
from scipy import linalg, sparse
from scipy.sparse import csgraph
from scipy.spatial import KDTree

from topomap.drawing.clearance import CLEAR, passing
from topomap.drawing.mesh import Points
from topomap.model.topology import Gateway, Place, TopologicalMap

ROUNDS = 60  # the largest number of rounds of stress majorization
WORK = 2_000_000  # the largest number of distances in all rounds
MOST_PLACES = 1500  # more places than these stay on a circle
NEAREST = 0.6  # the least distance between places
PUSHES = 200  # the largest number of times that places are pushed apart
STEM = 0.3  # the length of a line's first piece
MOST_TURN = np.pi / 2.4  # the largest angle between a line's first piece and its goal
# The largest number for a line; the distance from a place, in least distances.
DETOURS, AROUND = 30, 1.2
NOTE = "drawn plainly, as a better drawing takes too long"
UNDER = "links pass under places"


def plain(
    world: TopologicalMap, stub: float, known: Mapping[Place, Points] | None = None
) -> dict[Gateway, Points]:
    """Draw the lines of a map of one component; a place without gateways has none.

    Places are about where they are ``known`` to be, if they are.
    """
    number = {place: n for n, place in enumerate(world.stars)}
    pairs = [(number[p], number[q]) for (p, _), (q, _) in world.edges() if p != q]
    points = (
        _points(len(number), pairs) if known is None else pushed_apart(np.array([*known.values()]))
    )
    ends = [(number[p], number[world.links[p, s][0]], s) for p, s in world.links if (p, s)]
    norths = _norths(points, [end for end in ends if end[0] != end[1]], world.slots)
    turn = 2 * np.pi / world.slots
    lines = {}
    for gateway in world.gateways():
        place, slot = gateway
        here, angle = points[number[place]], norths[number[place]] - turn * slot
        other = world.links.get(gateway)
        if other is None:
            lines[gateway] = np.array([here, here + stub * _way(angle)])
        elif gateway not in lines:
            there = points[number[other[0]]]
            back = norths[number[other[0]]] - turn * other[1]
            if other[0] == place:  # a loop goes out, round between its gateways, and in
                back = angle - turn * ((other[1] - slot) % world.slots)
                middle = here + 2 * STEM * _way((angle + back) / 2)
                line = [here, here + STEM * _way(angle), middle, here + STEM * _way(back), here]
            else:
                leaving = _stem(here, angle, there)
                line = [here, *leaving, *_stem(there, back, here)[::-1], there]
            lines[gateway] = np.array(line)
            lines[other] = lines[gateway][::-1]
    return _led_round(world, dict(zip(number, points, strict=True)), lines)


def _led_round(
    world: TopologicalMap, places: Mapping[Place, Points], lines: dict[Gateway, Points]
) -> dict[Gateway, Points]:
    """Lead the lines round the places under which they would pass.

    Their first and last pieces stay as they are, so each still leaves by its gateway.
    """
    once = [out for out, _ in world.edges()]
    ends = [{out[0], world.links[out][0]} for out in once]
    for _ in range(DETOURS):
        met = passing(places, list(zip(ends, (lines[out] for out in once), strict=True)))
        led: set[int] = set()
        for number, piece, place in met:
            line = lines[once[number]]
            if number in led or not 0 < piece < len(line) - 2:
                continue
            led.add(number)
            a, b = line[piece], line[piece + 1]
            way = (b - a) / max(1e-9, float(np.hypot(*(b - a))))
            aside = np.array([-way[1], way[0]])
            side = np.copysign(1.0, (a - places[place]) @ aside)
            spot = places[place] + side * AROUND * CLEAR * aside
            out = once[number]
            lines[out] = np.insert(line, piece + 1, spot, axis=0)
            lines[world.links[out]] = lines[out][::-1]
        if not led:
            break
    return lines


def _way(angle: float) -> Points:
    return np.array([np.cos(angle), np.sin(angle)])


def _stem(here: Points, angle: float, there: Points) -> list[Points]:
    """How a line leaves a place at an angle, and comes round it before it goes on straight."""
    x, y = there - here
    off = (np.arctan2(y, x) - angle + np.pi) % (2 * np.pi) - np.pi
    found = [here + STEM * _way(angle)]
    while abs(off) > MOST_TURN:
        step = np.copysign(MOST_TURN / 2, off)
        angle, off = angle + step, off - step
        found.append(here + STEM * _way(angle))
    return found


def _norths(points: Points, ends: list[tuple[int, int, int]], slots: int) -> Points:
    """The direction of each place's slot 0 by which its lines leave roughly as they go on."""
    if not ends:
        return np.zeros(len(points))
    place, other, slot = np.array(ends).T
    out = points[other] - points[place]
    turned = np.arctan2(out[:, 1], out[:, 0]) + 2 * np.pi * slot / slots
    x, y = (np.bincount(place, f(turned), len(points)) for f in (np.cos, np.sin))
    return np.asarray(np.arctan2(y, x))


def _points(many: int, pairs: list[tuple[int, int]]) -> Points:
    """Points whose distances are about the numbers of links between them.

    They are found by stress majorization (Gansner, Koren and North 2004), or are points on a
    circle. None are too close to each other.
    """
    circle = _circle(many)
    if many < 3 or many > MOST_PLACES:
        return circle
    one, other = np.array(pairs).T
    near = sparse.coo_matrix((np.ones(len(one)), (one, other)), (many, many)).tocsr()
    far = csgraph.shortest_path(near, directed=False, unweighted=True)
    np.fill_diagonal(far, 1)
    points = _scaled(far, many) if many > 3 else circle
    weight = far**-2
    np.fill_diagonal(weight, 0)
    total = np.diag(weight.sum(1) + 1) - weight
    factor = np.linalg.inv(total)
    for _ in range(min(ROUNDS, WORK // many**2)):
        apart = np.hypot(*(points[:, None, axis] - points[None, :, axis] for axis in (0, 1)))
        np.fill_diagonal(apart, 1)
        ratio = weight * far / np.maximum(apart, 1e-3)
        points = factor @ (ratio.sum(1)[:, None] * points - ratio @ points + points)
    return _pushed(points, circle)


def pushed_apart(points: Points) -> Points:
    """Points where they are, except those that are too close to each other."""
    return _pushed(points, _circle(len(points)))


def _circle(many: int) -> Points:
    turn = 2 * np.pi * np.arange(many) / many
    return max(1, many * NEAREST / 5) * np.stack([np.cos(turn), np.sin(turn)], 1)


def _scaled(far: Points, many: int) -> Points:
    """Points from their distances, by classical multidimensional scaling."""
    squares = far**2
    np.fill_diagonal(squares, 0)
    squares -= squares.mean(0)
    squares -= squares.mean(1)[:, None]
    values, vectors = linalg.eigh(-squares / 2, subset_by_index=[many - 2, many - 1])
    signs = np.sign(vectors[np.abs(vectors).argmax(0), [0, 1]])
    return np.asarray(vectors * signs * np.sqrt(np.maximum(values, 1e-6)))


def _pushed(points: Points, circle: Points) -> Points:
    """Push the points apart where they are too close; if that fails, take those on a circle."""
    # So that no two points are equal.
    points = points + 1e-3 * circle / max(1.0, float(abs(circle).max()))
    for _ in range(PUSHES):
        one, other = KDTree(points).query_pairs(NEAREST, output_type="ndarray").T
        if not len(one):
            return points
        side = points[other] - points[one]
        length = np.maximum(np.linalg.norm(side, axis=1), 1e-9)[:, None]
        push = 0.55 * (NEAREST * 1.01 - length) * side / length
        for axis in (0, 1):
            points[:, axis] += np.bincount(other, push[:, axis], len(points))
            points[:, axis] -= np.bincount(one, push[:, axis], len(points))
    return circle
