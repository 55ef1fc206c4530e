"""Small pictures in SVG, to be put into a page: maps, views, and a plot of numbers.

What it looks like is the style sheet's; places are circles, links and stubs lines, in whole
units, so that the text is short.
"""

import math
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any

from topomap.drawing.scenes import Scene
from topomap.model import words
from topomap.model.topology import Gateway, Place, TopologicalMap, label

if TYPE_CHECKING:
    from topomap.drawing.layout import Layout

UNIT = 60  # the middle one of the links
RADIUS = 11  # of a place
APART, NARROW = 30, 15  # places, and in degrees gateways, if they are to be told
FEW, MANY = (25, 119), (120,)  # steps of the descent, in a small picture and a large one
STUB = 22
MARGIN = 20
LETTER, HIGH, GAP = 7.2, 13, 4  # of a landmark: a letter, a line, and what is left round it

Point = tuple[int, int]
Line = list[Point]
Link = tuple[Gateway, Gateway]
Box = tuple[int, int, int, int]  # left, top, width, height


@dataclass(frozen=True)
class Drawing:
    """Where a map is drawn: places, of each gateway the line that leaves by it, y downwards; the
    links that cross others; the frame, x, y, width and height; faces, each its
    outline and a point in it, the outer one without an outline; and where the landmarks of
    places begin."""

    places: Mapping[Place, Point]
    lines: Mapping[Gateway, Line]
    crossing: Sequence[Link]
    frame: tuple[int, int, int, int]
    faces: Sequence[tuple[int, Line, Point]] = ()
    signs: Mapping[Place, Point] = field(default_factory=dict)


def drawing(world: TopologicalMap, ahead: Gateway | None, small: bool = False) -> Drawing | None:
    """A drawing of a map (see ``layout.layout``), made in as few steps as leave it legible. A
    small one has no faces, and there is none if the gateways of a place cannot be told apart."""
    from topomap.drawing import layout

    for steps in FEW if small else MANY:
        laid = layout.layout(world, ahead, steps)
        unit, places, lines = _scaled(laid, world)
        narrowest = min((_narrowest(lines, *star) for star in world.stars.items()), default=360)
        apart = all(math.dist(p, q) > APART for p, q in combinations(places.values(), 2))
        if apart and narrowest > NARROW:
            break
    if small and not narrowest:
        return None
    points = [*places.values(), *(p for line in lines.values() for p in line)]
    taken = _taken(world, places, lines)
    signs = _signs(world, places, lines, taken)
    texts = [_box(world, place, point) for place, point in signs.items()]
    frame = _frame(points, texts)
    faces: list[tuple[int, Line, Point]] = []
    if not small and not laid.crossing:  # else they are not the map's
        from topomap.drawing.draw import inside  # so does matplotlib

        # As a layout has them, y upwards.
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
    return Drawing(places, lines, laid.crossing, frame, faces, signs)


def _frame(points: Sequence[Point], texts: Sequence[Box]) -> Box:
    """What is round points, with a margin, and texts."""
    sides = (-1, 1)
    corners = [(x + a * MARGIN, y + b * MARGIN) for x, y in points for a in sides for b in sides]
    for x, y, wide, high in texts:
        corners += [(x - GAP, y - GAP), (x + wide + GAP, y + high + GAP)]
    xs, ys = zip(*corners, strict=True)
    return min(xs), min(ys), max(xs) - min(xs), max(ys) - min(ys)


def _wide(text: str) -> int:
    """The width of a text, about: the font is the reader's."""
    wide = sum(1 + (unicodedata.east_asian_width(c) in "WF" or c in "MWmw") for c in text)
    return round(LETTER * wide)


def _box(world: TopologicalMap, place: Place, point: Point) -> Box:
    """What the landmarks of a place cover, if they begin there."""
    return (*point, _wide(words.signs(world.landmarks[place])), HIGH)


def _taken(
    world: TopologicalMap, places: Mapping[Place, Point], lines: Mapping[Gateway, Line]
) -> list[Box]:
    """What places and pending gateways cover."""
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
    """Where the landmarks of the places are: in the widest gap between the lines that leave; if
    they cover something there, in that where they cover least."""
    covered = list(taken)
    found: dict[Place, Point] = {}
    for place, (x, y) in places.items():
        if world.landmarks.get(place):
            directions = []
            for slot in world.stars[place]:
                u, v = _way(lines[place, slot])
                directions.append(math.atan2(-v, u))
            boxes: list[Box] = []
            for gap, middle in gaps(directions):
                if gap > 0.5 or not boxes:
                    a, b = math.cos(middle), -math.sin(middle)
                    _, _, wide, high = _box(world, place, (0, 0))
                    left = round(x + (RADIUS + GAP) * a + (_sign(a) - 1) * wide / 2)
                    top = round(y + (RADIUS + GAP) * b + (_sign(b) - 1) * high / 2)
                    boxes.append((left, top, wide, high))
            best = min(boxes, key=lambda box: sum(_shared(box, other) for other in covered))
            covered.append(best)
            found[place] = best[:2]
    return found


def gaps(directions: Sequence[float]) -> list[tuple[float, float]]:
    """The gaps between directions, in radians: the width of each, and its middle; those up and
    to the right, where a text is looked for, before the others of their width."""
    order = sorted(directions) or [-2.4]
    pairs = pairwise([*order, order[0] + 2 * math.pi])
    found = [(round(b - a, 1), (a + b) / 2) for a, b in pairs]
    return sorted(found, key=lambda gap: (-gap[0], round(-math.cos(gap[1] - 0.9), 3)))


def _sign(number: float) -> int:
    return 0 if abs(number) < 0.3 else 1 if number > 0 else -1


def _shared(one: Box, other: Box) -> int:
    """How much two boxes have in common."""
    wide, high = (
        min(one[n] + one[n + 2], other[n] + other[n + 2]) - max(one[n], other[n]) for n in (0, 1)
    )
    return max(0, wide) * max(0, high)


def _way(line: Line) -> tuple[float, float]:
    """The direction in which a line leaves."""
    x, y = line[0]
    u, v = next((p for p in line if p != (x, y)), (x + 1, y))
    length = math.dist((x, y), (u, v))
    return (u - x) / length, (v - y) / length


def _scaled(
    laid: "Layout", world: TopologicalMap
) -> tuple[float, dict[Place, Point], dict[Gateway, Line]]:
    """The unit, and places and lines in it. A stub may be squeezed, but it has a direction."""
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
    """The least angle in degrees between neighbouring gateways of a place; 0 if they are not
    seen to be in their order."""
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
    """The drawing of a map that has grown to the whole one; None if it would show a crossing
    that it need not have, or gateways cannot be told apart."""
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


def body(
    scene: Scene,
    drawn: Drawing,
    small: bool = True,
    apart: Collection[Link] = (),
    strange: Collection[Place] = (),
) -> str:
    """The places, links and pending gateways of a map; if it is not small, the faces and the
    steps too. The links ``apart`` and the ``strange`` places are set off."""
    world, steps = scene.world, scene.steps()
    parts = []
    for number, outline, (x, y) in () if small else drawn.faces:
        if outline:
            parts.append(f'<path class="face f{number % 4}" d="{path(outline)}Z"/>')
            parts.append(f'<text class="face" x="{x}" y="{y}">{number}</text>')
        else:
            parts.append(f'<text class="face outer" x="{x}" y="{y}">{number} (outer)</text>')
    crossing = {end for link in drawn.crossing for end in link}
    normal: list[str] = []
    other: list[str] = []
    pending: list[str] = []
    ends: list[Point] = []
    for gateway, line in drawn.lines.items():
        end = world.links.get(gateway)
        if end is None:
            pending.append(path(line))
            ends.append(line[-1])
        elif gateway not in crossing and gateway < end:
            differs = (gateway, end) in apart
            (other if differs else normal).append(path(line))
    parts += _lines("link", normal) + _lines("link apart", other) + _lines("pending", pending)
    parts += [f'<circle class="end" cx="{x}" cy="{y}" r="3"/>' for x, y in ends]
    for out, end in drawn.crossing:
        kind = "crossing apart" if (out, end) in apart or (end, out) in apart else "crossing"
        parts += _lines(kind, [path(drawn.lines[out])])
    if not small:
        for gateway, end in world.edges():
            along = sorted(steps.get(gateway, []) + steps.get(end, []))
            others = [line for other, line in drawn.lines.items() if other not in (gateway, end)]
            parts.append(_along(drawn.lines[gateway], along, others))
    for place, (x, y) in drawn.places.items():
        kind = "place strange" if place in strange else "place"
        kind += " signed" if world.landmarks.get(place) else ""
        parts.append(f'<circle class="{kind}" cx="{x}" cy="{y}" r="{RADIUS}"/>')
        parts.append(f'<text x="{x}" y="{y}">{escape(label(place))}</text>')
    parts += _gateways(drawn, world)
    for place, (x, y) in drawn.signs.items():
        if world.landmarks.get(place):
            _, _, wide, high = _box(world, place, (x, y))
            text = escape(words.signs(world.landmarks[place]))
            middle = f'x="{x + wide // 2}" y="{y + high // 2}"'
            parts.append(f'<text class="sign" {middle}>{text}</text>')
    return "".join(parts)


def _gateways(drawn: Drawing, world: TopologicalMap) -> list[str]:
    """A tick at each gateway, and a dot at gateway 0 of each place."""
    ticks, dots = [], []
    for (place, slot), line in drawn.lines.items():
        x, y = drawn.places[place]
        u, v = _way(line)
        at, to = (f"{round(x + far * u, 1):g} {round(y + far * v, 1):g}" for far in (11, 15))
        ticks.append(f"M{at} {to}")
        dots += [f"M{at}h0"] * (slot == 0)
    return _lines("port", ticks) + _lines("zero", dots)


def path(line: Sequence[Point]) -> str:
    return "M" + " ".join(f"{x} {y}" for x, y in line)


def _lines(kind: str, paths: Sequence[str]) -> list[str]:
    """One element for all lines of a kind."""
    return [f'<path class="{kind}" d="{"".join(paths)}"/>'] if paths else []


def _along(line: Line, steps: Sequence[int], others: Sequence[Line]) -> str:
    """The steps along a link, in its middle, or where other lines are not so near."""
    dots = [_at(other, n / 10) for other in others for n in range(1, 10)]
    spots = [_at(line, share) for share in (0.5, 0.3, 0.7)]
    far = [min([APART // 2, *(int(math.dist(spot, dot)) for dot in dots)]) for spot in spots]
    x, y = spots[far.index(max(far))]
    text = " ".join(map(str, steps[:4])) + (" …" if len(steps) > 4 else "")
    return f'<text class="along" x="{x}" y="{y}">{text}</text>'


def _at(line: Line, share: float) -> Point:
    """The point at a share of the length of a line."""
    left = share * sum(math.dist(p, q) for p, q in pairwise(line))
    for (x, y), (u, v) in pairwise(line):
        length = math.dist((x, y), (u, v))
        if length and left <= length:
            return round(x + left / length * (u - x)), round(y + left / length * (v - y))
        left -= length
    return line[-1]


def agent(drawn: Drawing, dstate: Gateway) -> str:
    """The agent at the gateway where it stands."""
    (x, y), (a, b) = drawn.lines[dstate][0], _way(drawn.lines[dstate])
    foot = x + 1.2 * RADIUS * a, y + 1.2 * RADIUS * b
    corners = ((12, 0), (0, 6), (0, -6))
    points = [(round(foot[0] + f * a - s * b), round(foot[1] + f * b + s * a)) for f, s in corners]
    return f'<path class="agent" d="{path(points)}Z"/>'


def picture(
    name: str, frame: Sequence[int], content: str, kind: str = "map", larger: float = 1
) -> str:
    """A picture, with its name in words."""
    view = " ".join(map(str, frame))
    size = f'width="{round(larger * frame[2])}" height="{round(larger * frame[3])}"'
    name = escape(name)
    return (
        f'<svg class="{kind}" role="img" aria-label="{name}" viewBox="{view}" {size}>'
        f"<title>{name}</title>{content}</svg>"
    )


def view(name: str, slots: int, seen: Collection[int]) -> str:
    """A view: the gateways, that where the agent stands at the bottom."""
    size = 17
    ways = []
    for slot in sorted(seen):
        turn = 2 * math.pi * slot / slots
        x, y = -math.sin(turn), math.cos(turn)
        ways.append([(round(5 * x), round(5 * y)), (round(15 * x), round(15 * y))])
    parts = _lines("link", [path(way) for way in ways])
    parts += [
        '<circle class="place" cx="0" cy="0" r="5"/>',
        '<circle class="agent" cy="14" r="3"/>',
    ]
    return picture(name, (-size, -size, 2 * size, 2 * size), "".join(parts), "view")


def plot(name: str, series: Mapping[str, Sequence[int | None]]) -> str:
    """Numbers by step, on a log scale; what is None is left out."""
    width, height, left, bottom, top = 720, 300, 84, 44, 34
    last = max(1, max(len(values) for values in series.values()) - 1)
    most = max([v for values in series.values() for v in values if v], default=1)
    decades = max(1, math.ceil(math.log10(most)))

    def point(step: int, value: int) -> Point:
        x = left + step * (width - left - 14) / last
        return round(x), round(height - bottom - math.log10(value) * room / decades)

    room = height - bottom - top
    parts = []
    for power in range(decades + 1):
        _, y = point(0, 10**power)
        parts.append(f'<path class="grid" d="M{left} {y}H{width - 14}"/>')
        parts.append(f'<text class="tick" x="{left - 6}" y="{y}">{10**power:,}</text>')
    for step in range(0, last + 1, max(1, math.ceil(last / 16))):
        x, y = point(step, 1)
        parts.append(f'<text class="step" x="{x}" y="{y + 16}">{step}</text>')
    parts.append(f'<text class="step" x="{(left + width) // 2}" y="{height - 8}">step</text>')
    x, y = point(0, 1)
    to = width - 14 - left
    parts.append(f'<path class="now" data-to="{to}" d="M{x} {top}V{y}"/>')
    for number, (which, values) in enumerate(series.items()):
        points = [point(step, v) for step, v in enumerate(values) if v]
        parts.append(f'<path class="series s{number}" d="{path(points)}"/>' if points else "")
        marks = [_mark(number, x, y) for x, y in points]
        parts.append(f'<path class="mark s{number}" d="{"".join(marks)}"/>')
        x = left + 8 + 200 * number
        parts.append(f'<path class="series s{number}" d="M{x} 14h28"/>')
        parts.append(f'<path class="mark s{number}" d="{_mark(number, x + 14, 14)}"/>')
        parts.append(f'<text class="key" x="{x + 34}" y="14">{escape(which)}</text>')
    return picture(name, (0, 0, width, height), "".join(parts), "plot")


def _mark(number: int, x: int, y: int) -> str:
    return f"M{x - 3} {y - 3}h6v6h-6Z" if number else f"M{x} {y - 4}l4 4l-4 4l-4 -4Z"
