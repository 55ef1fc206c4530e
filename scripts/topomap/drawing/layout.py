"""Where the places, links and pending gateways of a map are drawn.

A map of genus 0 is drawn without crossings. Of a map of higher genus a planar part is drawn like
this, and the other links are led through its faces, across as few links as possible. Around each
place the gateways leave in their order, clockwise as the agent turns. If all links can be straight
and in the directions of one compass, they are. If it is known where places are, they are drawn
there, or as near as possible without a crossing, and north is up. What takes too long is drawn
plainly, and the drawing says so.
"""

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from topomap.drawing.bent import STEPS, bent
from topomap.drawing.clearance import led_round, under
from topomap.drawing.mesh import Points, TooLong, cross, faces_of, outer_of
from topomap.drawing.placed import ALIKE, Targets, at_their_places, difference, targets, turned
from topomap.drawing.plain import NOTE, UNDER, plain
from topomap.drawing.planarize import left_out, planar_part, routed
from topomap.drawing.scenes import Where
from topomap.drawing.springs import STUB
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime.watch import Late, never

GAP = 1.0  # the space between components
SHORTEST = 0.4  # the least length of a link in a drawing by the compass
NARROW = 0.05  # the least distance between lines in it
DISTORTED = 0.5  # the largest difference from known positions in a terminal
QUARTER = [np.array([[x, y], [-y, x]], float) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
ELSEWHERE = "some places are not drawn at their positions"
# The number of other drawings that are tried, and lengths of links in them.
TRIES, LENGTHS = 150, (1, 1, 1, 2, 3)


@dataclass(frozen=True)
class Layout:
    """A drawing with y upwards, in which links are about 1 long.

    ``places`` has a point for each place. ``lines`` has for each gateway the line that leaves by
    it, to the place at the other end or to the end of a stub. ``faces`` has those of a planar map,
    each as the gateways by which its walk leaves, with the face on their right; ``outer`` is the
    number of the outer one. ``crossing`` has, for a map that is not planar, the links that are not
    in the planar part. ``note`` says that the drawing is plain, if it is: then neither faces nor
    crossings are given. ``elsewhere`` tells that it is known where places are, but that some are
    drawn elsewhere.
    """

    places: dict[Place, Points]
    lines: dict[Gateway, Points]
    faces: list[list[Gateway]]
    outer: int
    crossing: list[tuple[Gateway, Gateway]]
    note: str = ""
    elsewhere: bool = False

    def outline(self, face: list[Gateway]) -> Points:
        """The line around a face."""
        return np.concatenate([self.lines[gateway][:-1] for gateway in face])


def layout(
    world: TopologicalMap,
    ahead: Gateway | None = None,
    steps: int = STEPS,
    late: Late = never,
    where: Where | None = None,
) -> Layout:
    """Draw a map.

    ``where`` tells where places are, and what is up. If that is not known of all places, the
    gateway ``ahead`` (by default the first one) leaves to the right of the picture. Fewer ``steps``
    are enough for a small picture. Several components stand side by side, and then no faces are
    given, because the components share the outer one. The drawing is plain if it is ``late`` before
    there is a better one, or if that would take more work than one drawing may.
    """
    parts = world.parts()
    if len(parts) > 1:
        return _beside([layout(part, _there(ahead, part), steps, late, where) for part in parts])
    known = targets(world, where)
    try:
        part = planar_part(world, late=late)
        placed = _placed(part, known, late) if part is world else None
        if placed is not None:
            lines = placed
        else:
            lines = bent(*routed(part, left_out(part, world), late), steps, late, known)
            lines = led_round(world, lines)
    except TooLong:
        lines = plain(world, STUB, known)
        note = f"{NOTE}, and {UNDER}" if under(world, lines) else NOTE
        return replace(_turned(world, lines, ahead, known), note=note)
    return _layout(world, part, lines, ahead, known)


def _placed(
    world: TopologicalMap, known: Targets | None, late: Late
) -> dict[Gateway, Points] | None:
    """Draw straight lines between places where they are known to be.

    They are also drawn by the compass, if places are then about there.
    """
    for placed in at_their_places(world, known) if known else ():
        if not _meet(world, placed) and not under(world, placed):
            return placed
    lines = _by_compass(world, late)
    if lines and known and difference(lines, known) > ALIKE:
        return None
    return lines


def straight(
    world: TopologicalMap,
    ahead: Gateway | None = None,
    late: Late = never,
    where: Where | None = None,
) -> Layout | None:
    """Draw by the compass, if that is possible; the drawing is turned by quarters only.

    Links that are not in the planar part are drawn only at their beginning and their end, as stubs.
    """
    parts = world.parts()
    if len(parts) > 1:
        drawn = [straight(part, _there(ahead, part), late, where) for part in parts]
        laid = [one for one in drawn if one is not None]
        return _beside(laid) if len(laid) == len(parts) else None
    try:
        part = planar_part(world, late=late)
    except TooLong:
        return None
    lines = _by_compass(part, late)
    known = targets(world, where)
    if lines is None or (known and difference(lines, known) > DISTORTED):
        return None
    if known:  # the way ahead leads to the right; then it is turned by quarters
        level = _turned(world, lines, ahead, None).lines
        x, y = _way(turned(level, known), ahead)
        quarters = round(float(np.arctan2(y, x)) / (np.pi / 2)) % 4
        lines = {out: line @ QUARTER[quarters] for out, line in level.items()}
        there = {out[0]: line[0] for out, line in lines.items()}
        elsewhere = difference(lines, known) > ALIKE
        return replace(_layout(world, part, lines, ahead, there), elsewhere=elsewhere)
    return _layout(world, part, lines, ahead, None)


def _way(lines: Mapping[Gateway, Points], ahead: Gateway | None) -> Points:
    """The direction of a line; by default that of the first one."""
    line = lines[ahead or next(iter(lines))]
    return np.asarray(line[1] - line[0])


def _there(gateway: Gateway | None, part: TopologicalMap) -> Gateway | None:
    """The gateway, if it belongs to this part of a map."""
    return gateway if gateway is not None and gateway[0] in part.stars else None


def _beside(drawings: Sequence[Layout]) -> Layout:
    """Put drawings in a row, from left to right."""
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
    note = next((laid.note for laid in drawings if laid.note), "")
    return Layout(places, lines, [], -1, crossing, note, any(one.elsewhere for one in drawings))


def _layout(
    world: TopologicalMap,
    part: TopologicalMap,
    lines: Mapping[Gateway, Points],
    ahead: Gateway | None,
    known: Targets | None,
) -> Layout:
    """Make the drawing, with what it shows of the map."""
    crossing = left_out(part, world)
    faces, outer = ([], -1) if crossing else faces_of(world)
    laid = _turned(world, lines, ahead, known)
    if known and world.links and not crossing:
        outer = outer_of([laid.outline(face) for face in faces])
    return replace(laid, faces=faces, outer=outer, crossing=crossing)


def _turned(
    world: TopologicalMap,
    lines: Mapping[Gateway, Points],
    ahead: Gateway | None,
    known: Targets | None,
) -> Layout:
    """Turn places and lines.

    Places come as near as possible to where they are known to be; otherwise ``ahead`` leads to the
    right.
    """
    first = ahead or next(world.gateways(), None)
    if first is None:
        return Layout({place: np.zeros(2) for place in world.stars}, {}, [], -1, [])
    if known:
        lines = turned(lines, known)
        elsewhere = difference(lines, known) > ALIKE
        places = {out[0]: line[0] for out, line in lines.items()}
        return Layout(places, {**lines}, [], -1, [], elsewhere=elsewhere)
    x, y = lines[first][1] - lines[first][0]
    turn = np.array([[x, -y], [y, x]]) / np.hypot(x, y)
    lines = {gateway: line @ turn for gateway, line in lines.items()}
    return Layout({place: line[0] for (place, _), line in lines.items()}, lines, [], -1, [])


def compass(world: TopologicalMap) -> tuple[dict[Place, int], bool]:
    """The direction of each place's slot 0, in slots clockwise from that of the first place.

    It is as if links arrived in the direction in which they leave. The second result is whether
    that is possible for every link.
    """
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


def _by_compass(world: TopologicalMap, late: Late = never) -> dict[Gateway, Points] | None:
    """Draw lines in the directions of the compass, with lengths as near to 1 as possible.

    If lines meet or become too short, other lengths are tried. It is None if they do so with all
    that are tried, or are tried before it is late.
    """
    north, fits = compass(world)
    if not fits:
        return None
    number = {place: index for index, place in enumerate(world.stars)}
    edges = world.edges()
    starts, ends = (np.array([number[edge[n][0]] for edge in edges], int) for n in (0, 1))
    along = np.array([_direction(north[p] + s, world.slots) for (p, s), _ in edges]).reshape(-1, 2)
    aside = 100 * along[:, ::-1] * [-1, 1]
    # Two rows for each link: how far it leads along its direction, and a hundred times how far
    # aside; and two rows for the first place.
    row = np.repeat(2 + np.arange(2 * len(edges)).reshape(-1, 2), 4, axis=0).reshape(-1, 4, 2)
    column = np.stack([2 * ends, 2 * ends + 1, 2 * starts, 2 * starts + 1], 1)
    entry = np.stack([np.hstack([along, -along]), np.hstack([aside, -aside])], 2)
    column = np.repeat(column[:, :, None], 2, axis=2)
    rows, columns, entries = (
        np.concatenate([[0, 1] if n < 2 else [1.0, 1.0], part.ravel()])
        for n, part in enumerate((row, column, entry))
    )
    shape = 2 + 2 * len(edges), 2 * len(number)
    by = sparse.csc_matrix((entries, (rows, columns)), shape)
    solved = linalg.splu((by.T @ by).tocsc())
    draw = random.Random(0)
    some = sorted(([draw.choice(LENGTHS) for _ in edges] for _ in range(TRIES)), key=sum)
    for lengths in [[1] * len(edges), *some]:
        wanted = np.zeros(shape[0])
        wanted[2::2] = lengths
        found = solved.solve(by.T @ wanted).reshape(-1, 2)
        side = found[ends] - found[starts]
        far = (side * along).sum(1)
        off = np.linalg.norm(side - far[:, None] * along, axis=1)
        if (far >= SHORTEST).all() and (off <= 0.01 * SHORTEST).all():
            lines = _lines(world, north, dict(zip(number, found, strict=True)))
            if not _meet(world, lines) and not under(world, lines):
                return lines
        if late():
            break
    return None


def _lines(
    world: TopologicalMap, north: Mapping[Place, int], found: Mapping[Place, Points]
) -> dict[Gateway, Points]:
    """The lines between places, and stubs."""
    lines = {}
    for p, s in world.gateways():
        here = found[p]
        linked = (p, s) in world.links
        stub = STUB * _direction(north[p] + s, world.slots)
        lines[p, s] = np.array([here, found[world.links[p, s][0]] if linked else here + stub])
    return lines


def _meet(world: TopologicalMap, lines: Mapping[Gateway, Points]) -> bool:
    """Tell whether straight lines meet elsewhere than at their places."""
    once = [g for g in lines if g not in world.links or g < world.links[g]]
    number = {place: index for index, place in enumerate(world.stars)}
    places = np.array(
        [[number[g[0]], number[world.links[g][0] if g in world.links else g[0]]] for g in once]
    )
    drawn = np.array([lines[g] for g in once]).reshape(-1, 2, 2)
    low, high = drawn.min(1) - NARROW, drawn.max(1) + NARROW
    for n in range(len(once) - 1):
        beside = (low[n + 1 :] <= high[n]).all(1) & (high[n + 1 :] >= low[n]).all(1)
        beside &= ~(places[n + 1 :, :, None] == places[n]).any((1, 2))
        if not beside.any():
            continue
        (a, b), (c, d) = drawn[n], drawn[n + 1 :][beside].transpose(1, 0, 2)
        # The distances of each line's ends from this line, and of this line's ends from each line.
        ends = _distance(c, a, b), _distance(d, a, b), _distance(a, c, d), _distance(b, c, d)
        side = [cross(b - a, p - a) for p in (c, d)]
        over = [cross(d - c, p - c) for p in (a, b)]
        crossed = (side[0] * side[1] < 0) & (over[0] * over[1] < 0)
        if (crossed | (np.min(ends, axis=0) < NARROW)).any():
            return True
    return False


def _distance(p: Points, a: Points, b: Points) -> Points:
    """The distances of points from line segments."""
    along = ((p - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    return np.asarray(np.linalg.norm(p - a - np.clip(along, 0, 1)[..., None] * (b - a), axis=-1))
