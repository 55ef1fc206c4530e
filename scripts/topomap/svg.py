"""Small pictures in SVG, to be put into a page: maps, views, and a plot of numbers.

What it looks like is the style sheet's; places are circles, links and stubs lines, in whole
units, so that the text is short.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any

from topomap.scenes import Scene
from topomap.topology import Gateway, Place, TopologicalMap, label

if TYPE_CHECKING:
    from topomap.layout import Layout

UNIT = 60  # the middle one of the links
RADIUS = 11  # of a place
APART, NARROW = 30, 15  # places, and in degrees gateways, if they are to be told
FEW, MANY = (80, 400), (300,)  # steps of the descent, in a small picture and a large one
STUB = 22
MARGIN = 20
LONGEST = 16  # letters of a landmark in a picture

Point = tuple[int, int]
Line = list[Point]
Link = tuple[Gateway, Gateway]


@dataclass(frozen=True)
class Drawing:
    """Where a map is drawn: places, of each gateway the line that leaves by it, y downwards; the
    links that cross others; the frame, x, y, width and height; and faces, each its
    outline and a point in it."""

    places: Mapping[Place, Point]
    lines: Mapping[Gateway, Line]
    crossing: Sequence[Link]
    frame: tuple[int, int, int, int]
    faces: Sequence[tuple[int, Line, Point]] = ()


def drawing(world: TopologicalMap, ahead: Gateway | None, small: bool = False) -> Drawing | None:
    """A drawing of a map (see ``layout.layout``), made in as few steps as leave it legible. A
    small one has no faces, and there is none if the gateways of a place cannot be told apart."""
    from topomap import layout  # scipy takes its time

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
    xs, ys = zip(*points, strict=True)
    corner = min(xs) - MARGIN, min(ys) - MARGIN
    frame = (*corner, max(xs) + MARGIN - corner[0], max(ys) + MARGIN - corner[1])
    faces = []
    if not small:
        from topomap.draw import inside  # so does matplotlib

        for number, face in enumerate(laid.faces, 1):
            if number - 1 != laid.outer:
                outline = unit * laid.outline(face)
                faces.append((number, [_point(p) for p in outline], _point(inside(outline))))
    return Drawing(places, lines, laid.crossing, frame, faces)


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
    return Drawing(places, lines, crossing, whole.frame)


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
        parts.append(f'<path class="face f{number % 4}" d="{path(outline)}Z"/>')
        parts.append(f'<text class="face" x="{x}" y="{y}">{number}</text>')
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
            parts.append(_along(drawn.lines[gateway], along))
    for place, (x, y) in drawn.places.items():
        kind = "place strange" if place in strange else "place"
        kind += " signed" if world.landmarks.get(place) else ""
        parts.append(f'<circle class="{kind}" cx="{x}" cy="{y}" r="{RADIUS}"/>')
        parts.append(f'<text x="{x}" y="{y}">{escape(label(place))}</text>')
    for place, signs in world.landmarks.items():
        if signs:
            x, y = drawn.places[place]
            text = ", ".join(_short(sign) for sign in sorted(signs))
            parts.append(
                f'<text class="sign" x="{x + RADIUS - 2}" y="{y - RADIUS - 1}">'
                f"{escape(_short(text))}</text>"
            )
    return "".join(parts)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def path(line: Sequence[Point]) -> str:
    return "M" + " ".join(f"{x} {y}" for x, y in line)


def _lines(kind: str, paths: Sequence[str]) -> list[str]:
    """One element for all lines of a kind."""
    return [f'<path class="{kind}" d="{"".join(paths)}"/>'] if paths else []


def _along(line: Line, steps: Sequence[int]) -> str:
    """The steps along a link, in its middle."""
    k = len(line) // 2
    (x, y), (u, v) = line[k - 1], line[k]
    if len(line) % 2:
        x, y = u, v
    text = " ".join(map(str, steps[:4])) + (" …" if len(steps) > 4 else "")
    return f'<text class="along" x="{(x + u) // 2}" y="{(y + v) // 2}">{text}</text>'


def agent(drawn: Drawing, dstate: Gateway) -> str:
    """The agent at the gateway where it stands."""
    (x, y), (u, v) = drawn.lines[dstate][:2]
    length = math.dist((x, y), (u, v)) or 1.0
    a, b = (u - x) / length, (v - y) / length
    foot = x + 1.2 * RADIUS * a, y + 1.2 * RADIUS * b
    corners = ((12, 0), (0, 6), (0, -6))
    points = [(round(foot[0] + f * a - s * b), round(foot[1] + f * b + s * a)) for f, s in corners]
    return f'<path class="agent" d="{path(points)}Z"/>'


def picture(name: str, frame: Sequence[int], content: str, kind: str = "map") -> str:
    """A picture, with its name in words."""
    view = " ".join(map(str, frame))
    size = f'width="{frame[2]}" height="{frame[3]}"'
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
