"""Maps in a terminal: drawn with characters, and then described in words.

Straight maps along two directions are drawn with line characters, with columns and rows by the
order of the places, so that lengths may be uneven. All others are drawn with the dots of Braille.
Places are bare numbers, the agent's in brackets, with an arrow for its gateway; faces are numbers
in parentheses. A pending gateway is a short stub with an open end. A link that would cross others
is two stubs with one letter, or a line of dots.
"""

import math
import textwrap
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby, pairwise
from string import ascii_letters

import numpy as np

from topomap.drawing.layout import ELSEWHERE, Layout, layout, straight
from topomap.drawing.mesh import Points
from topomap.drawing.scenes import Scene
from topomap.model.topology import Gateway, Place, gid, label
from topomap.runtime.errors import printable
from topomap.runtime.watch import Late, never

Cell = tuple[int, int]  # row and column
PLACE, AGENT, LINK, CROSSING, PENDING, SIGN, FACE = "1", "1;33", "", "31", "34", "1;32", "2"
ARROWS = "→↗↑↖←↙↓↘"  # counter-clockwise, 45 degrees apart
# The characters of stubs, by direction.
ENDS = {(0, 1): "─╴", (0, -1): "─╶", (1, 0): "│╵", (-1, 0): "│╷"}
LETTERS = ascii_letters[26:] + ascii_letters[:26].replace("v", "").replace("o", "")
OPEN = "o"  # the end of a stub of dots
BRAILLE = 0x2800
# The bits of a Braille character, by row.
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
ASCII = str.maketrans(
    "─│╴╶╵╷" + ARROWS + "".join(map(chr, range(BRAILLE + 1, BRAILLE + 256))),
    "-|oooo" + ">/^\\</v\\" + "." * 255,
)
SAME = 0.03  # smaller differences are one row or column; layouts keep lines 0.05 apart
# Free cells between columns, between rows, and between two facing stubs.
ACROSS, DOWN, FACING = 5, 3, 5
FINEST = 28.0  # the largest number of dots of a link of length 1
LARGER = 1.2, 8  # if numbers overlap: the factor, and how often it is applied at most


class Taken(Exception):
    """Something is there already."""


class Canvas:
    """Characters by row and column, each with a colour."""

    def __init__(self) -> None:
        self.cells: dict[Cell, tuple[str, str]] = {}

    def put(self, row: int, column: int, text: str, colour: str, over: bool = False) -> None:
        """Write a text, beginning in a cell.

        Raises:
            Taken: Something is there already, and ``over`` is false.
        """
        for number, character in enumerate(text, column):
            if not over and (row, number) in self.cells:
                raise Taken
            self.cells[row, number] = character, colour

    def lines(self, coloured: bool) -> Iterator[str]:
        """The rows, from the leftmost column on."""
        rows: dict[int, dict[int, tuple[str, str]]] = defaultdict(dict)
        for (row, column), cell in self.cells.items():
            rows[row][column] = cell
        left = min(column for _, column in self.cells)
        for row in range(min(rows), max(rows) + 1):
            line = rows.get(row, {})
            cells = [
                line.get(column, (" ", "")) for column in range(left, max(line, default=left) + 1)
            ]
            runs = groupby(cells, lambda cell: cell[1] if coloured else "")
            yield "".join(_in_colour("".join(c for c, _ in run), colour) for colour, run in runs)


def _in_colour(text: str, colour: str) -> str:
    return f"\x1b[{colour}m{text}\x1b[0m" if colour else text


def drawn(scene: Scene, width: int, coloured: bool = False, late: Late = never) -> tuple[str, str]:
    """Draw a map in a terminal of that many columns.

    Maps of lines are as wide as they need. Maps of dots fit, unless numbers would overlap: then
    they are up to four times as wide.

    Returns:
        The map, and a note if the drawing is plain (see ``layout``).
    """
    world = scene.world
    where = scene.where()
    laid = None if scene.like else straight(world, scene.ahead, late, where)
    letters = _letters(laid) if laid else {}
    canvas = boxes(scene, laid, letters) if laid else None
    if laid is None or canvas is None:
        laid, letters = layout(world, scene.ahead, late=late, where=where), {}
        canvas = dots(scene, laid, width)
    title, sizes = scene.title.rsplit("\n", 1)
    sizes += f", {laid.note}" * bool(laid.note) + f", {ELSEWHERE}" * laid.elsewhere
    told = [title, sizes, "", *canvas.lines(coloured), ""]
    for line in words(scene, laid, letters):
        told += textwrap.wrap(printable(line), width, subsequent_indent="    ")
    return "\n".join([*map(printable, told[:2]), *told[2:]]) + "\n", laid.note


def _letters(laid: Layout) -> dict[Gateway, str]:
    """The letter of each gateway of a link that would cross others, while there are letters."""
    return {
        gateway: LETTERS[number] if number < len(LETTERS) else "?"
        for number, link in enumerate(laid.crossing)
        for gateway in link
    }


def _names(scene: Scene) -> dict[Place, tuple[str, str]]:
    """The name of each place, and its colour."""
    world = scene.world
    names = {
        place: (label(place), SIGN if world.landmarks.get(place) else PLACE)
        for place in world.stars
    }
    if scene.at:
        place = scene.at[-1][0]
        names[place] = f"[{label(place)}]", AGENT
    return names


def boxes(scene: Scene, laid: Layout, letters: dict[Gateway, str]) -> Canvas | None:
    """The map in line characters; None if a line bends, is oblique, or would touch others."""
    ahead: dict[Gateway, Cell] = {}
    for gateway, line in laid.lines.items():
        x, y = line[-1] - line[0]
        if len(line) > 2 or min(abs(x), abs(y)) > SAME:
            return None
        ahead[gateway] = (0, 1 if x > 0 else -1) if abs(x) > abs(y) else (-1 if y > 0 else 1, 0)
    try:
        return _boxes(scene, laid, letters, ahead)
    except Taken:
        return None


def _boxes(
    scene: Scene, laid: Layout, letters: dict[Gateway, str], ahead: dict[Gateway, Cell]
) -> Canvas:
    links = scene.world.links
    names = _names(scene)
    column = _ranks({place: point[0] for place, point in laid.places.items()})
    row = _ranks({place: -point[1] for place, point in laid.places.items()})
    stub = {gateway for gateway in ahead if gateway in letters or gateway not in links}
    down, up = (
        {(row[p], column[p]) for p, s in stub if ahead[p, s] == (step, 0)} for step in (1, -1)
    )
    facing = {upper for upper, at in down if (upper + 1, at) in up}
    tall = [FACING if upper in facing else DOWN for upper in range(max(row.values()))]
    out, into = [0] * len(names), [0] * len(names)  # for each column, right and left of its middle
    for place, (name, _) in names.items():
        into[column[place]] = max(into[column[place]], _before(name))
        out[column[place]] = max(out[column[place]], len(name) - 1 - _before(name))
    wide = [out[n] + ACROSS + into[n + 1] for n in range(max(column.values()))]
    rows, columns = (np.cumsum([0, *(gap + 1 for gap in gaps)]).tolist() for gaps in (tall, wide))
    cell = {place: (rows[row[place]], columns[column[place]]) for place in names}

    canvas = Canvas()
    edge: dict[tuple[Place, int], int] = {}
    for place, (name, colour) in names.items():
        y, x = cell[place]
        canvas.put(y, x - _before(name), name, colour)
        edge[place, -1], edge[place, 1] = x - _before(name), x - _before(name) + len(name) - 1
    for gateway, (dy, dx) in ahead.items():
        place = gateway[0]
        y, x = cell[place]
        x = edge[place, dx] if dx else x
        if gateway in stub:
            end = ENDS[dy, dx]
            colour = CROSSING if gateway in letters else PENDING
            for n, character in enumerate(end[0] + letters.get(gateway, end[1]), 1):
                canvas.put(y + n * dy, x + n * dx, character, colour)
        elif (dy, dx) in ((0, 1), (1, 0)):
            other = links[gateway][0]
            to_y, to_x = cell[other]
            if dx and (y != to_y or edge[other, -1] <= x):
                raise Taken
            if dy and (x != to_x or to_y <= y):
                raise Taken
            for n in range(1, (edge[other, -1] - x) if dx else to_y - y):
                canvas.put(y + n * dy, x + n * dx, "─" if dx else "│", LINK)
    if scene.at:
        place, _ = scene.at[-1]
        dy, dx = ahead[scene.at[-1]]
        y, x = cell[place]
        x = edge[place, dx] if dx else x
        canvas.put(
            y + dy,
            x + dx,
            ARROWS[{(0, 1): 0, (-1, 0): 2, (0, -1): 4, (1, 0): 6}[dy, dx]],
            AGENT,
            over=True,
        )
    _number_faces(canvas, laid, lambda face: [cell[place][::-1] for place, _ in face])
    return canvas


def _before(name: str) -> int:
    """How many characters of a number are left of its middle one."""
    return (len(name) - 1) // 2


def _ranks(values: dict[Place, float]) -> dict[Place, int]:
    """The rank of each value; values that are nearly equal have the same rank."""
    ranks: dict[Place, int] = {}
    start, rank = -math.inf, -1
    for place, value in sorted(values.items(), key=lambda item: item[1]):
        if value > start + SAME:
            start, rank = value, rank + 1
        ranks[place] = rank
    return ranks


def _number_faces(
    canvas: Canvas, laid: Layout, outline: Callable[[list[Gateway]], Sequence[tuple[float, float]]]
) -> None:
    """Write the numbers of the inner faces in their middles, where there is room."""
    for number, face in enumerate(laid.faces, 1):
        if number - 1 == laid.outer:
            continue
        name = f"({number})"
        corners = list(outline(face))
        sides = list(pairwise([*corners, corners[0]]))
        inside: list[Cell] = []
        fits: list[Cell] = []
        for row in range(
            math.ceil(min(y for _, y in corners)), math.ceil(max(y for _, y in corners))
        ):
            met = sorted(
                x + (row - y) * (to_x - x) / (to_y - y)
                for (x, y), (to_x, to_y) in sides
                if min(y, to_y) <= row < max(y, to_y)
            )
            for left, right in zip(met[::2], met[1::2], strict=True):
                for at in range(math.floor(left) + 1, math.ceil(right)):
                    inside.append((row, at))
                    spot = range(at - 1, at + len(name) + 1)
                    if (
                        spot[-1] < right
                        and spot[0] > left
                        and not any((row, n) in canvas.cells for n in spot)
                    ):
                        fits.append((row, at))
        if fits:
            y, x = np.mean(inside, axis=0)
            row, at = min(
                fits,
                key=lambda cell: (
                    round(2 * abs(cell[0] - y) + abs(cell[1] + (len(name) - 1) / 2 - x), 6),
                    cell,
                ),
            )
            canvas.put(row, at, name, FACE)


def dots(scene: Scene, laid: Layout, width: int) -> Canvas:
    """The map in dots, in that many columns, or in more if numbers would overlap."""
    names = _names(scene)
    points = np.concatenate([*laid.lines.values(), *([p] for p in laid.places.values())])
    low, high = points.min(0), points.max(0)
    longest = max(len(name) for name, _ in names.values())
    scale = min(FINEST, 2 * max(8, width - longest - 2) / max(high[0] - low[0], 1e-9))
    for _ in range(LARGER[1]):
        cell = {p: _cell((point - low) * scale) for p, point in laid.places.items()}
        numbers = [
            (y, x - _before(names[place][0]) + n)
            for place, (y, x) in cell.items()
            for n in range(len(names[place][0]) + 1)
        ]
        if len(set(numbers)) == len(numbers):
            break
        scale *= LARGER[0]

    canvas = Canvas()
    marked: dict[Cell, int] = defaultdict(int)
    passing: dict[Cell, set[Gateway]] = defaultdict(set)
    lines = {gateway: (line - low) * scale for gateway, line in laid.lines.items()}
    for gateway, line in lines.items():
        other = scene.world.links.get(gateway)
        if other in lines and other < gateway:
            continue  # it is drawn from its other end
        for x, y in _along(line):
            at = _cell((x, y))
            passing[at].add(gateway)
            marked[at] |= DOTS[3 - math.floor(y) % 4][math.floor(x) % 2]
    crossing = {end for link in laid.crossing for end in link}

    def colour_of(gateway: Gateway) -> str:
        """The colour of the line of a gateway."""
        links = scene.world.links
        return CROSSING if gateway in crossing else LINK if gateway in links else PENDING

    for at, bits in marked.items():
        kinds = set(map(colour_of, passing[at]))
        colour = next(kind for kind in (CROSSING, PENDING, LINK) if kind in kinds)
        canvas.put(*at, chr(BRAILLE + bits), colour)
    taken = set()
    for place, (name, colour) in names.items():
        y, x = cell[place]
        canvas.put(y, x - _before(name), name, colour, over=True)
        taken |= {(y, x - _before(name) + n) for n in range(len(name))}
    for gateway, line in lines.items():
        at = _cell(line[-1])
        if gateway not in scene.world.links and passing[at] == {gateway} and at not in taken:
            canvas.put(*at, OPEN, PENDING, over=True)
            taken.add(at)
    if scene.at:
        line = lines[scene.at[-1]]
        x, y = line[1] - line[0]
        arrow = ARROWS[round(math.atan2(y, x) / (math.pi / 4)) % 8]
        for free in [at for at in map(_cell, _along(line)) if at not in taken][:1]:
            canvas.put(*free, arrow, AGENT, over=True)

    def outline(face: list[Gateway]) -> list[tuple[float, float]]:
        """The outline of a face, in dots."""
        return [(x / 2 - 0.5, 0.5 - y / 4) for x, y in (laid.outline(face) - low) * scale]

    _number_faces(canvas, laid, outline)
    return canvas


def _cell(point: Sequence[float] | Points) -> Cell:
    """The character that holds a dot."""
    x, y = point
    return -(math.floor(y) // 4), math.floor(x) // 2


def _along(line: Points) -> Iterator[tuple[float, float]]:
    """Points of a line that are no farther apart than dots."""
    for (x, y), (to_x, to_y) in pairwise(line.tolist()):
        steps = max(1, math.ceil(max(abs(to_x - x), abs(to_y - y))))
        for n in range(steps + 1):
            yield x + (to_x - x) * n / steps, y + (to_y - y) * n / steps


def words(scene: Scene, laid: Layout, letters: dict[Gateway, str]) -> Iterator[str]:
    """What the picture shows, line by line; ``P.S`` is gateway S of place P."""
    world = scene.world

    def letter(gateway: Gateway) -> str:
        """The letter of a gateway, if its link would cross others."""
        return f"{letters[gateway]} " if gateway in letters else ""

    if scene.at:
        yield f"the agent is at place {label(scene.at[-1][0])}, at the gateway {gid(scene.at[-1])}"
    for number, path in enumerate(world.paths(), 1):
        circular = world.links.get(path[-1]) == world.opposite(path[0])
        places = " ".join(label(place) for place, _ in path)
        yield f"path {number}{' (circular)' * circular}: {places}"
    for number, face in enumerate(world.faces(), 1):
        outer = " (outer)" * (number - 1 == laid.outer)
        yield f"face {number}{outer}: {' '.join(label(place) for place, _ in face) or 'all'}"
    if laid.crossing:
        links = ", ".join(f"{letter(a)}{gid(a)} - {gid(b)}" for a, b in laid.crossing)
        yield f"links that cross others: {links}"
    yield f"pending gateways: {' '.join(map(gid, world.pending())) or 'none'}"
    signs = ((place, sorted(world.landmarks.get(place, ()))) for place in world.stars)
    told = [f"{label(place)}: {', '.join(those)}" for place, those in signs if those]
    yield from (f"landmarks at {line}" for line in told)
    if scene.marker:
        yield f"the marker: {scene.marker}"
