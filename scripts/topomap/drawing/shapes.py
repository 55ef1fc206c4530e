"""Drawings in whole units, small or large: where places, lines, faces and landmarks are."""

import math
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any

from topomap.drawing.labels import gaps
from topomap.model import words
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime.watch import Late, never

if TYPE_CHECKING:
    from topomap.drawing.layout import Layout

UNIT = 60  # the median length of links
RADIUS = 11  # the radius of a place
APART, NARROW = 30, 15  # least distances: of places, and in degrees of gateways
FEW, MANY = (25, 119), (120,)  # steps of the descent in a small picture and in a large one
STUB = 22
MARGIN = 20
# Of landmarks: the width of a letter, the height of a line, and the margin.
LETTER, HIGH, GAP = 7.2, 13, 4

Point = tuple[int, int]
Line = list[Point]
Link = tuple[Gateway, Gateway]
Box = tuple[int, int, int, int]  # left, top, width, height


@dataclass(frozen=True)
class Drawing:
    """Where the parts of a map are drawn.

    It has the places, and for each gateway the line that leaves by it, with y downwards; the links
    that cross others; the frame as x, y, width and height; the faces, each with its outline and a
    point in it, the outer one without an outline; where the landmarks of places begin; and a note
    if the drawing is plain (see ``layout.Layout``).
    """

    places: Mapping[Place, Point]
    lines: Mapping[Gateway, Line]
    crossing: Sequence[Link]
    frame: tuple[int, int, int, int]
    faces: Sequence[tuple[int, Line, Point]] = ()
    signs: Mapping[Place, Point] = field(default_factory=dict)
    note: str = ""


def drawing(
    world: TopologicalMap,
    ahead: Gateway | None,
    small: bool = False,
    late: Late = never,
    where: Mapping[Place, tuple[float, float]] | None = None,
) -> Drawing | None:
    """Draw a map (see ``layout.layout``), in as few steps as leave it legible.

    A small drawing has no faces. There is none if the gateways of a place could not be told apart.
    """
    from topomap.drawing import layout

    for steps in FEW if small else MANY:
        laid = layout.layout(world, ahead, steps, late, where)
        unit, places, lines = _scaled(laid, world)
        narrowest = min((_narrowest(lines, *star) for star in world.stars.items()), default=360)
        apart = all(math.dist(p, q) > APART for p, q in combinations(places.values(), 2))
        if (apart and narrowest > NARROW) or laid.note:
            break
    if small and not narrowest:
        return None
    points = [*places.values(), *(p for line in lines.values() for p in line)]
    taken = _taken(world, places, lines)
    signs = _signs(world, places, lines, taken)
    texts = [box_of(world, place, point) for place, point in signs.items()]
    frame = _frame(points, texts)
    faces: list[tuple[int, Line, Point]] = []
    if not small and not laid.crossing:  # otherwise they are not the map's
        from topomap.drawing.panel import inside  # loading it takes time

        # As in a layout, with y upwards.
        upwards = [(x, -y - high, x + wide, -y) for x, y, wide, high in [*taken, *texts]]
        x, y, wide, high = frame
        for number, face in enumerate(laid.faces, 1):
            if number - 1 == laid.outer:
                faces.append((number, [], (x + 6, y + high + 2)))
                frame = (x, y, max(wide, 64), high + 14)
            else:
                outline = unit * laid.outline(face)
                middle = _point(inside(outline, upwards))
                faces.append((number, [_point(p) for p in outline], middle))
    return Drawing(places, lines, laid.crossing, frame, faces, signs, laid.note)


def _frame(points: Sequence[Point], texts: Sequence[Box]) -> Box:
    """The frame around points and texts, with a margin."""
    sides = (-1, 1)
    corners = [(x + a * MARGIN, y + b * MARGIN) for x, y in points for a in sides for b in sides]
    for x, y, wide, high in texts:
        corners += [(x - GAP, y - GAP), (x + wide + GAP, y + high + GAP)]
    xs, ys = zip(*corners, strict=True)
    return min(xs), min(ys), max(xs) - min(xs), max(ys) - min(ys)


def _wide(text: str) -> int:
    """An estimate of the width of a text, whose font is the reader's."""
    wide = sum(1 + (unicodedata.east_asian_width(c) in "WF" or c in "MWmw") for c in text)
    return round(LETTER * wide)


def box_of(world: TopologicalMap, place: Place, point: Point) -> Box:
    """The box of the landmarks of a place, if they begin there."""
    lines = words.sign_lines(world.landmarks[place])
    return (*point, max(map(_wide, lines)), len(lines) * HIGH)


def _taken(
    world: TopologicalMap, places: Mapping[Place, Point], lines: Mapping[Gateway, Line]
) -> list[Box]:
    """The boxes of places and pending gateways."""
    size = 2 * RADIUS
    return [(x - RADIUS, y - RADIUS, size, size) for x, y in places.values()] + [
        (min(x, u) - 3, min(y, v) - 3, abs(u - x) + 6, abs(v - y) + 6)
        for gateway, ((x, y), *_, (u, v)) in lines.items()
        if gateway not in world.links
    ]


def _signs(
    world: TopologicalMap,
    places: Mapping[Place, Point],
    lines: Mapping[Gateway, Line],
    taken: Sequence[Box],
) -> dict[Place, Point]:
    """Where the landmarks of the places are.

    They are in the widest gap between the lines that leave; if they cover something there, in the
    gap where they cover least.
    """
    covered = list(taken)
    found: dict[Place, Point] = {}
    for place, (x, y) in places.items():
        if world.landmarks.get(place):
            directions = []
            for slot in world.stars[place]:
                u, v = way_of(lines[place, slot])
                directions.append(math.atan2(-v, u))
            boxes: list[Box] = []
            for gap, middle in gaps(directions):
                if gap > 0.5 or not boxes:
                    a, b = math.cos(middle), -math.sin(middle)
                    _, _, wide, high = box_of(world, place, (0, 0))
                    left = round(x + (RADIUS + GAP) * a + (_sign(a) - 1) * wide / 2)
                    top = round(y + (RADIUS + GAP) * b + (_sign(b) - 1) * high / 2)
                    boxes.append((left, top, wide, high))
            best = min(boxes, key=lambda box: sum(_shared(box, other) for other in covered))
            covered.append(best)
            found[place] = best[:2]
    return found


def _sign(number: float) -> int:
    return 0 if abs(number) < 0.3 else 1 if number > 0 else -1


def _shared(one: Box, other: Box) -> int:
    """The area that two boxes have in common."""
    wide, high = (
        min(one[n] + one[n + 2], other[n] + other[n + 2]) - max(one[n], other[n]) for n in (0, 1)
    )
    return max(0, wide) * max(0, high)


def way_of(line: Line) -> tuple[float, float]:
    """The direction in which a line leaves."""
    x, y = line[0]
    u, v = next((p for p in line if p != (x, y)), (x + 1, y))
    length = math.dist((x, y), (u, v))
    return (u - x) / length, (v - y) / length


def _scaled(
    laid: "Layout", world: TopologicalMap
) -> tuple[float, dict[Place, Point], dict[Gateway, Line]]:
    """The unit, and places and lines in it; a short stub keeps a direction."""
    crossing = {end for link in laid.crossing for end in link}
    linked = [end for end in laid.lines if end in world.links and end not in crossing]
    lengths = sorted(sum(math.dist(p, q) for p, q in pairwise(laid.lines[end])) for end in linked)
    unit = UNIT / lengths[len(lengths) // 2] if lengths else UNIT
    lines = {}
    for gateway, line in laid.lines.items():
        points = [unit * p for p in line]
        if gateway not in world.links:
            way = (line[1] - line[0]) / math.dist(line[0], line[1])
            points = [unit * line[0] + far * way for far in (0, STUB)]
        lines[gateway] = [_point(p) for p in points]
    return unit, {place: _point(unit * p) for place, p in laid.places.items()}, lines


def _narrowest(lines: Mapping[Gateway, Line], place: Place, star: Collection[int]) -> float:
    """The least angle in degrees between neighbouring gateways of a place.

    It is 0 if they are not seen to be in their order.
    """
    angles = []
    for slot in sorted(star):
        x, y = lines[place, slot][0]
        u, v = next((p for p in lines[place, slot] if p != (x, y)), (x, y))
        angles.append(math.degrees(math.atan2(v - y, u - x)))
    gaps = [(b - a) % 360 for a, b in pairwise([*angles, angles[0]])] if len(star) > 1 else [360.0]
    return min(gaps) if sum(gaps) < 361 else 0.0


def _point(point: Any) -> Point:
    return round(float(point[0])), round(-float(point[1]))


def part_of(whole: Drawing, world: TopologicalMap) -> Drawing | None:
    """The drawing of a map that has grown into the whole one, as a part of its drawing.

    It is None if it would show a crossing that it need not have, or if gateways could not be told
    apart.
    """
    if whole.note:
        return None
    crossing = [link for link in whole.crossing if link[0] in world.links]
    if crossing and world.genus() == 0:
        return None
    lines = {
        gateway: line if gateway in world.links else _stub(line)
        for gateway, line in whole.lines.items()
        if gateway[0] in world.stars
    }
    if not all(_narrowest(lines, *star) for star in world.stars.items()):
        return None
    places = {place: point for place, point in whole.places.items() if place in world.stars}
    return Drawing(places, lines, crossing, whole.frame, signs=whole.signs)


def _stub(line: Line) -> Line:
    """The beginning of a line."""
    kept, left = [line[0]], float(STUB)
    for (x, y), (u, v) in pairwise(line):
        length = math.dist((x, y), (u, v))
        share = min(1.0, left / length) if length else 1.0
        kept.append((round(x + share * (u - x)), round(y + share * (v - y))))
        left -= length
        if left <= 0:
            break
    return kept
