"""Pictures in SVG for a page: maps, views, and a plot of numbers.

The style sheet determines what they look like. Places are circles, and links and stubs are lines,
in whole units, so that the text is short.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from html import escape
from itertools import pairwise

from topomap.drawing.scenes import Scene
from topomap.drawing.shapes import APART, RADIUS, Drawing, Line, Link, Point, box_of, way_of
from topomap.model import words
from topomap.model.topology import Gateway, Place, TopologicalMap, label


def body(
    scene: Scene,
    drawn: Drawing,
    small: bool = True,
    apart: Collection[Link] = (),
    strange: Collection[Place] = (),
) -> str:
    """The places, links and pending gateways of a map; if it is not small, the faces and steps.

    The links ``apart`` and the ``strange`` places are highlighted.
    """
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
        numbers = {gateway: number for number, gateway in enumerate(drawn.lines)}
        dots = Dots([*drawn.lines.values()])
        for gateway, end in world.edges():
            along = sorted(steps.get(gateway, []) + steps.get(end, []))
            own = {numbers[gateway], numbers[end]}
            parts.append(_along(drawn.lines[gateway], along, dots, own))
    for place, (x, y) in drawn.places.items():
        kind = "place strange" if place in strange else "place"
        kind += " signed" if world.landmarks.get(place) else ""
        parts.append(f'<circle class="{kind}" cx="{x}" cy="{y}" r="{RADIUS}"/>')
        parts.append(f'<text x="{x}" y="{y}">{escape(label(place))}</text>')
    parts += _gateways(drawn, world)
    for place, (x, y) in drawn.signs.items():
        if world.landmarks.get(place):
            _, _, wide, high = box_of(world, place, (x, y))
            lines = words.sign_lines(world.landmarks[place])
            for number, told in enumerate(lines):
                at = y + (2 * number + 1) * high // (2 * len(lines))
                middle = f'x="{x + wide // 2}" y="{at}"'
                parts.append(f'<text class="sign" {middle}>{escape(told)}</text>')
    return "".join(parts)


def _gateways(drawn: Drawing, world: TopologicalMap) -> list[str]:
    """A tick at each gateway, and a dot at gateway 0 of each place."""
    ticks, dots = [], []
    for (place, slot), line in drawn.lines.items():
        x, y = drawn.places[place]
        u, v = way_of(line)
        at, to = (f"{round(x + far * u, 1):g} {round(y + far * v, 1):g}" for far in (11, 15))
        ticks.append(f"M{at} {to}")
        dots += [f"M{at}h0"] * (slot == 0)
    return _lines("port", ticks) + _lines("zero", dots)


def path(line: Sequence[Point]) -> str:
    """A line as the data of an SVG path."""
    return "M" + " ".join(f"{x} {y}" for x, y in line)


def _lines(kind: str, paths: Sequence[str]) -> list[str]:
    """One element for all lines of a kind."""
    return [f'<path class="{kind}" d="{"".join(paths)}"/>'] if paths else []


class Dots:
    """Points on lines, nine on each, which are found by their position."""

    def __init__(self, lines: Sequence[Line]) -> None:
        from scipy.spatial import KDTree  # loading it takes time

        self.points = [_at(line, n / 10) for line in lines for n in range(1, 10)]
        self.tree = KDTree(self.points)

    def far(self, spot: Point, own: Collection[int]) -> int:
        """How far a point is from the lines that are not its own, up to a sufficient distance."""
        near = self.tree.query_ball_point(spot, APART // 2)
        others = (self.points[n] for n in near if n // 9 not in own)
        return min([APART // 2, *(int(math.dist(spot, dot)) for dot in others)])


def _along(line: Line, steps: Sequence[int], dots: Dots, own: Collection[int]) -> str:
    """The steps along a link, in its middle, or where other lines are not so near."""
    spots = [_at(line, share) for share in (0.5, 0.3, 0.7)]
    far = [dots.far(spot, own) for spot in spots]
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
    """The agent at its gateway."""
    (x, y), (a, b) = drawn.lines[dstate][0], way_of(drawn.lines[dstate])
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
    """A view: the gateways, with the one where the agent stands at the bottom."""
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
    """Plot numbers by step, on a logarithmic scale; None is left out."""
    width, height, left, bottom, top = 720, 300, 84, 44, 34
    last = max(1, max(len(values) for values in series.values()) - 1)
    most = max([v for values in series.values() for v in values if v], default=1)
    decades = max(1, math.ceil(math.log10(most)))

    def point(step: int, value: int) -> Point:
        """The point of a step and its value."""
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
