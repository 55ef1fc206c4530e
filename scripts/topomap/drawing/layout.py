"""Where the places, links and pending gateways of a map are drawn.

A map of genus 0 is drawn without crossings; of one of higher genus a planar part is, and the
other links are led through its faces, across as few links as can be. Around each place the
gateways leave in their order, clockwise as the agent turns. If all links can be straight and in
the directions of one compass, they are.
"""

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from topomap.drawing.bent import STEPS, bent
from topomap.drawing.mesh import Points, cross, faces_of
from topomap.drawing.planarize import left_out, planar_part, routed
from topomap.drawing.springs import STUB
from topomap.model.topology import Gateway, Place, TopologicalMap

GAP = 1.0  # between components
SHORTEST = 0.4  # link in a drawing by the compass
TRIES, LENGTHS = 150, (1, 1, 1, 2, 3)  # of other drawings, and of links in them


@dataclass(frozen=True)
class Layout:
    """A drawing, y upwards, links about 1 long.

    ``places``: a point each. ``lines``: of each gateway the line that leaves by it: to the place
    at the other end, or to the end of a stub. ``faces``: those of a planar map, each as the
    gateways that its walk leaves by, the face on their right; ``outer``: the number of the outer
    one. ``crossing``: of another map the links that are not in the planar part.
    """

    places: dict[Place, Points]
    lines: dict[Gateway, Points]
    faces: list[list[Gateway]]
    outer: int
    crossing: list[tuple[Gateway, Gateway]]

    def outline(self, face: list[Gateway]) -> Points:
        """The line round a face."""
        return np.concatenate([self.lines[gateway][:-1] for gateway in face])


def layout(world: TopologicalMap, ahead: Gateway | None = None, steps: int = STEPS) -> Layout:
    """A drawing of a map. ``ahead`` is a gateway that is left to the right of the
    picture (else the first one); fewer ``steps`` do for a small picture. Several components stand
    side by side, and then no faces are told, for they share the outer one."""
    parts = world.parts()
    if len(parts) > 1:
        return _beside([layout(part, _there(ahead, part), steps) for part in parts])
    part = planar_part(world)
    lines = _by_compass(part) if part is world else None
    if lines is None:
        lines = bent(*routed(part, left_out(part, world)), steps)
    return _layout(world, part, lines, ahead)


def straight(world: TopologicalMap, ahead: Gateway | None = None) -> Layout | None:
    """A drawing by the compass, if there is one; of the links that are not in the planar part
    only the beginning and the end, as stubs."""
    parts = world.parts()
    if len(parts) > 1:
        drawn = [straight(part, _there(ahead, part)) for part in parts]
        laid = [one for one in drawn if one is not None]
        return _beside(laid) if len(laid) == len(parts) else None
    part = planar_part(world)
    lines = _by_compass(part)
    return None if lines is None else _layout(world, part, lines, ahead)


def _there(gateway: Gateway | None, part: TopologicalMap) -> Gateway | None:
    """The gateway, if it is of this part of a map."""
    return gateway if gateway is not None and gateway[0] in part.stars else None


def _beside(drawings: Sequence[Layout]) -> Layout:
    """Drawings in a row, from left to right."""
    places: dict[Place, Points] = {}
    lines: dict[Gateway, Points] = {}
    crossing: list[tuple[Gateway, Gateway]] = []
    right = 0.0
    for laid in drawings:
        points = np.concatenate([*laid.lines.values(), *([p] for p in laid.places.values())])
        shift = np.array([right - points[:, 0].min(), 0.0])
        places |= {place: point + shift for place, point in laid.places.items()}
        lines |= {gateway: line + shift for gateway, line in laid.lines.items()}
        crossing += laid.crossing
        right += points[:, 0].max() - points[:, 0].min() + GAP
    return Layout(places, lines, [], -1, crossing)


def _layout(
    world: TopologicalMap,
    part: TopologicalMap,
    lines: Mapping[Gateway, Points],
    ahead: Gateway | None,
) -> Layout:
    """The drawing, turned so that ``ahead`` leads to the right."""
    crossing = left_out(part, world)
    faces, outer = ([], -1) if crossing else faces_of(world)
    first = ahead or next(world.gateways(), None)
    if first is None:
        return Layout({place: np.zeros(2) for place in world.stars}, {}, faces, outer, [])
    x, y = lines[first][1] - lines[first][0]
    turn = np.array([[x, -y], [y, x]]) / np.hypot(x, y)
    lines = {gateway: line @ turn for gateway, line in lines.items()}
    places = {place: line[0] for (place, _), line in lines.items()}
    return Layout(places, lines, faces, outer, crossing)


def compass(world: TopologicalMap) -> tuple[dict[Place, int], bool]:
    """The direction of each place's slot 0, in slots clockwise from that of the first place,
    if links arrive as they leave; and whether that can be so for every link."""
    north = {next(iter(world.stars)): 0}
    for place in (waiting := list(north)):
        for slot in sorted(world.stars[place]):
            if (place, slot) in world.links:
                other, arrival = world.links[place, slot]
                if other not in north:
                    north[other] = (north[place] + slot + world.slots // 2 - arrival) % world.slots
                    waiting.append(other)
    fits = all(
        (north[p] + s + world.slots // 2 - north[q] - r) % world.slots == 0
        for (p, s), (q, r) in world.links.items()
    )
    return north, fits


def _direction(angle: float, slots: int) -> Points:
    """A step in a direction, in slots clockwise from the right."""
    turn = -2 * np.pi * angle / slots
    return np.array([np.cos(turn), np.sin(turn)])


def _by_compass(world: TopologicalMap) -> dict[Gateway, Points] | None:
    """Lines in the directions of the compass, as near as can be to length 1, or if they meet or
    become short, to some other lengths; None if they do so by all that are tried."""
    north, fits = compass(world)
    if not fits:
        return None
    number = {place: index for index, place in enumerate(world.stars)}
    rows = [np.eye(2, 2 * len(number))[n] for n in (0, 1)]
    edges = world.edges()
    for (p, s), (q, _) in edges:
        along = _direction(north[p] + s, world.slots)
        for axis in along, 100 * along[::-1] * [-1, 1]:
            row = np.zeros((len(number), 2))
            row[number[q]] += axis
            row[number[p]] -= axis
            rows.append(row.ravel())
    lengths = np.zeros((len(rows), 1 + TRIES))
    draw = random.Random(0)
    some = sorted(([draw.choice(LENGTHS) for _ in edges] for _ in range(TRIES)), key=sum)
    lengths[2::2] = np.array([[1] * len(edges), *some]).T
    tried = np.linalg.lstsq(np.array(rows), lengths, rcond=None)[0].T.reshape(1 + TRIES, -1, 2)
    drawn = (_lines(world, north, dict(zip(number, found, strict=True))) for found in tried)
    return next((lines for lines in drawn if lines is not None), None)


def _lines(
    world: TopologicalMap, north: Mapping[Place, int], found: Mapping[Place, Points]
) -> dict[Gateway, Points] | None:
    """The lines between places, and stubs; None if one is aslant or short, or meets others."""
    lines = {}
    for p, s in world.gateways():
        along, here = _direction(north[p] + s, world.slots), found[p]
        end = here + STUB * along
        if (p, s) in world.links:
            end = found[world.links[p, s][0]]
            if (end - here) @ along < SHORTEST or np.linalg.norm(
                (end - here) - (end - here) @ along * along
            ) > 0.01 * SHORTEST:
                return None
        lines[p, s] = np.array([here, end])
    return None if _meet(world, lines) else lines


def _meet(world: TopologicalMap, lines: Mapping[Gateway, Points]) -> bool:
    """Whether straight lines meet elsewhere than at their places."""
    once = [g for g in lines if g not in world.links or g < world.links[g]]
    ends = [{g[0], world.links[g][0]} if g in world.links else {g[0]} for g in once]
    a, b = (np.array([lines[g][n] for g in once]) for n in (0, 1))
    for n in range(len(once)):
        # The distance of each line's ends from this line, and the other way round.
        near = _distance(a[n + 1 :], a[n], b[n]), _distance(b[n + 1 :], a[n], b[n])
        other = _distance(a[n], a[n + 1 :], b[n + 1 :]), _distance(b[n], a[n + 1 :], b[n + 1 :])
        least = np.min([*near, *other], axis=0)
        side = [cross(b[n] - a[n], p[n + 1 :] - a[n]) for p in (a, b)]
        over = [cross(b[n + 1 :] - a[n + 1 :], p[n] - a[n + 1 :]) for p in (a, b)]
        crossed = (side[0] * side[1] < 0) & (over[0] * over[1] < 0)
        apart = np.array([not ends[n] & ends[m] for m in range(n + 1, len(once))], dtype=bool)
        if (apart & (crossed | (least < 0.05))).any():
            return True
    return False


def _distance(p: Points, a: Points, b: Points) -> Points:
    """Of points from line segments."""
    along = ((p - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    return np.asarray(np.linalg.norm(p - a - np.clip(along, 0, 1)[..., None] * (b - a), axis=-1))
