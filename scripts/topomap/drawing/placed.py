"""Drawings of maps whose places are known to be somewhere, exactly or approximately."""

from collections.abc import Iterator, Mapping

import numpy as np
from scipy.spatial import KDTree

from topomap.drawing.mesh import Points
from topomap.drawing.plain import pushed_apart
from topomap.drawing.scenes import Where
from topomap.drawing.springs import STUB
from topomap.model.topology import Gateway, Place, TopologicalMap

Targets = Mapping[Place, Points]
LEAST = 0.5  # the least distance between two places
LARGER = 1.0, 1.6, 2.5  # scales that are tried, to separate lines and places
SHARP = 0.16  # the least angle between two lines of a place, in radians
ALIKE = 0.2  # a difference of a shape that is not visible, as a share of its size


def targets(world: TopologicalMap, where: Where | None) -> dict[Place, Points] | None:
    """Where the places of a map of one component are, about the middle, with links about 1 long.

    It is None if that is not known of all places, or if all are at one point.
    """
    if not where or not all(place in where for place in world.stars):
        return None
    points = np.array([where[place] for place in world.stars], float)
    number = {place: n for n, place in enumerate(world.stars)}
    ends = [(number[out[0]], number[end[0]]) for out, end in world.edges() if out[0] != end[0]]
    if not ends:
        return None
    one, other = np.array(ends).T
    lengths = np.linalg.norm(points[one] - points[other], axis=1)
    usual = float(np.median(lengths[lengths > 1e-9])) if (lengths > 1e-9).any() else 0.0
    if not usual or not np.isfinite(points).all():
        return None
    points = (points - (points.min(0) + points.max(0)) / 2) / usual
    return dict(zip(world.stars, points, strict=True))


def at_their_places(world: TopologicalMap, known: Targets) -> Iterator[dict[Gateway, Points]]:
    """Draw straight lines between the places where they are, in several sizes.

    If some places are too close, they are moved a little. The gateways of each place keep their
    order. It is not checked whether lines meet.
    """
    ends = [frozenset((out[0], end[0])) for out, end in world.edges()]
    if len(set(ends)) < len(ends) or any(len(pair) == 1 for pair in ends):
        return
    points = np.array([known[place] for place in world.stars])
    least = float(np.asarray(KDTree(points).query(points, k=2)[0])[:, 1].min())
    for larger in LARGER:
        spread = points * larger
        near = larger * least < LEAST
        lines = _straight(world, pushed_apart(spread) if near else spread)
        if lines is not None:
            yield lines


def _straight(world: TopologicalMap, points: Points) -> dict[Gateway, Points] | None:
    """Draw straight lines between places at points.

    It is None if they do not leave a place in their order, or are too close to each other.
    """
    at = dict(zip(world.stars, points, strict=True))
    lines: dict[Gateway, Points] = {}
    turn = 2 * np.pi / world.slots
    for place, star in world.stars.items():
        slots = sorted(star)
        angles: dict[int, float] = {}
        for slot in slots:
            if (place, slot) in world.links:
                x, y = at[world.links[place, slot][0]] - at[place]
                angles[slot] = float(np.arctan2(y, x))
        if not angles:
            return None
        linked = list(angles)
        # Pending gateways are between those that have links, in proportion to their slots.
        for n, slot in enumerate(linked):
            following = linked[(n + 1) % len(linked)]
            slots_on = (following - slot - 1) % world.slots + 1
            wide = (angles[slot] - angles[following]) % (2 * np.pi)
            share = turn if len(linked) == 1 else wide / slots_on
            for other in slots:
                on = (other - slot) % world.slots
                if other not in linked and 0 < on < slots_on:
                    angles[other] = angles[slot] - share * on
        order = sorted(slots)
        gaps = [
            (angles[one] - angles[other]) % (2 * np.pi)
            for one, other in zip(order, order[1:] + order[:1], strict=True)
        ]
        if len(order) > 1 and (sum(gaps) > 2 * np.pi + 1e-6 or min(gaps) < min(SHARP, turn / 2)):
            return None
        for slot in slots:
            here = at[place]
            if (place, slot) in world.links:
                lines[place, slot] = np.array([here, at[world.links[place, slot][0]]])
            else:
                way = np.array([np.cos(angles[slot]), np.sin(angles[slot])])
                lines[place, slot] = np.array([here, here + STUB * way])
    return {gateway: lines[gateway] for gateway in world.gateways()}


def turned(lines: Mapping[Gateway, Points], known: Targets) -> dict[Gateway, Points]:
    """Turn a drawing so that its places come as near as possible to where they should be."""
    one, other = _pair(lines, known)
    fit = complex((one.conj() * other).sum())
    if abs(fit) < 1e-9:
        return dict(lines)
    x, y = fit.real / abs(fit), fit.imag / abs(fit)
    turn = np.array([[x, y], [-y, x]])
    return {gateway: line @ turn for gateway, line in lines.items()}


def difference(lines: Mapping[Gateway, Points], known: Targets) -> float:
    """How much a drawing differs from where its places should be, as a share of its size.

    Before that it is moved, turned and scaled so as to fit best.
    """
    one, other = _pair(lines, known)
    sizes = float((abs(one) ** 2).sum() * (abs(other) ** 2).sum())
    fit = abs(complex((one.conj() * other).sum()))
    return float(np.sqrt(max(0.0, 1 - fit**2 / sizes))) if sizes > 0 else 1.0


def _pair(lines: Mapping[Gateway, Points], known: Targets) -> tuple[Points, Points]:
    """Where places are and should be, from their centres, as complex numbers."""
    drawn = {place: line[0] for (place, _), line in lines.items()}
    both = np.array([[*drawn[place], *known[place]] for place in drawn])
    both = both - both.mean(0)
    return both[:, 0] + 1j * both[:, 1], both[:, 2] + 1j * both[:, 3]
