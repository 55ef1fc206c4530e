"""Worlds to explore: grids, tori, cylinders, crescents, mazes, and lattices.

A world is a map whose places count their slots from one common direction, so that a slot is a
compass direction (slot 0 is north on a grid).
"""

import math
import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import clingo

from topomap.model.topology import Gateway, Place, TopologicalMap, label
from topomap.runtime import nx
from topomap.runtime.checks import share, whole
from topomap.runtime.errors import InputError
from topomap.runtime.limits import MOST_PLACES
from topomap.runtime.near import meant
from topomap.worlds.senses import Move

UNIT = 100  # the length of a way of a grid or of a lattice
NORTH, EAST, SOUTH, WEST = range(4)
MOVES = {NORTH: (-1, 0), EAST: (0, 1), SOUTH: (1, 0), WEST: (0, -1)}


@dataclass(frozen=True)
class Environment:
    """A world, its name, and how it was made.

    ``call`` is the part of a ``topomap generate`` call that makes it. ``shape`` is the number of
    its rows and columns, if a route may use them; ``notes`` go into headers. ``moves`` tells for
    each gateway how far its way leads, east and north: in hundredths of a way of a grid or a
    lattice, in metres of a network, or in the units of a file that uses a plane. ``points`` tells
    where places are, in the same units. ``names`` tells the names of places, if they are not their
    labels, and ``north`` tells where slot 0 points, in degrees clockwise of north.
    """

    name: str
    call: tuple[str, ...]
    map: TopologicalMap
    shape: tuple[int, int] | None = None
    notes: tuple[str, ...] = ()
    moves: Mapping[Gateway, Move] = field(default_factory=dict)
    points: Mapping[Place, tuple[float, float]] = field(default_factory=dict)
    names: Mapping[Place, str] = field(default_factory=dict)
    north: float = 0.0

    def place(self, text: str) -> Place:
        """Find the place with this label.

        Raises:
            InputError: There is no such place.
        """
        for place in self.map.stars:
            if label(place) == text:
                return place
        raise InputError(f"{self.name}: there is no place {text!r}")

    def signed(self, rate: float, seed: int) -> "Environment":
        """The same world, in which ``round(rate * n)`` of its n places have a sign.

        A sign is a landmark that is the place's own name. The places are drawn from the sorted
        places, with the seed.

        Raises:
            ValueError: The rate is not from 0 to 1.
        """
        rate = share("signs", rate)
        places = sorted(self.map.stars)
        drawn = random.Random(seed).sample(places, round(rate * len(places)))
        landmarks = {place: frozenset((_term(place),)) for place in drawn}
        return replace(self, map=replace(self.map, landmarks=landmarks))


def plain(number: float) -> str:
    """Write a number exactly, as the command line accepts it."""
    return str(int(number)) if number == int(number) else repr(number)


def _term(place: Place) -> str:
    """A place as a ground term: a tuple of numbers, or a string."""
    if isinstance(place, tuple):
        return str(clingo.Tuple_([clingo.Number(number) for number in place]))
    return str(clingo.String(str(place)))


def world(slots: int, links: Mapping[Gateway, Gateway]) -> TopologicalMap:
    """Make the map in which every gateway is linked, with the places in order."""
    if not links:
        raise InputError("an environment needs a way between two places")
    stars: dict[Place, set[int]] = {place: set() for place in sorted({p for p, _ in links})}
    for place, slot in links:
        stars[place].add(slot)
    return TopologicalMap(slots, {place: frozenset(star) for place, star in stars.items()}, links)


def grid(rows: int, columns: int, kind: str = "grid") -> Environment:
    """Make a grid of places (row, column) with four slots, where slot 0 is north.

    On a ``cylinder`` each row is a ring, and on a ``torus`` each column is a ring, too. With
    ``crescents``, the columns, beginning with the first, are joined in pairs by ways round their
    northern ends; so each pair is one path, which meets each row twice.
    """
    links: dict[Gateway, Gateway] = {}
    for row in range(rows):
        for column in range(columns):
            for slot in EAST, SOUTH:
                down, right = MOVES[slot]
                there = row + down, column + right
                if kind == "torus":
                    there = there[0] % rows, there[1]
                if kind in ("torus", "cylinder"):
                    there = there[0], there[1] % columns
                if there[0] < rows and there[1] < columns:
                    _link(links, ((row, column), slot), (there, (slot + 2) % 4))
    moves = _squares(links)
    for column in range(0, columns - 1, 2) if kind == "crescents" else ():
        ends = ((0, column), NORTH), ((0, column + 1), NORTH)
        _link(links, *ends)
        moves |= {ends[0]: (UNIT, 0), ends[1]: (-UNIT, 0)}
    call = kind, str(rows), str(columns)
    made = world(4, links)
    name = f"{kind}-{rows}x{columns}"
    return Environment(name, call, made, (rows, columns), (), moves)


def _squares(links: Iterable[Gateway]) -> dict[Gateway, Move]:
    """The moves of the ways of a grid."""
    return {(place, slot): (UNIT * MOVES[slot][1], -UNIT * MOVES[slot][0]) for place, slot in links}


def maze(rows: int, columns: int, thin: float, seed: int) -> Environment:
    """Make a connected grid from which some ways are removed.

    ``round(thin * n)`` of its n ways are removed in a random order, with the seed, except those
    without which it would not be connected.
    """
    links = dict(grid(rows, columns).map.links)
    ways = world(4, links).edges()
    graph: nx.MultiGraph[Place] = nx.MultiGraph((a[0], b[0], a) for a, b in ways)
    spare = round(thin * len(ways))
    for a, b in random.Random(seed).sample(ways, len(ways)):
        if spare and not _is_bridge(graph, a, b):
            graph.remove_edge(a[0], b[0], a)
            del links[a], links[b]
            spare -= 1
    call = "maze", str(rows), str(columns), "--thin", plain(thin)
    name = f"maze-{rows}x{columns}-thin{100 * thin:g}"
    return Environment(name, call, world(4, links), (rows, columns), (), _squares(links))


def _is_bridge(graph: "nx.MultiGraph[Any]", a: Gateway, b: Gateway) -> bool:
    graph.remove_edge(a[0], b[0], a)
    bridge = not nx.has_path(graph, a[0], b[0])
    graph.add_edge(a[0], b[0], a)
    return bridge


def lattice(kind: str, rows: int, columns: int) -> Environment:
    """Make a lattice with six slots, 60 degrees apart, where slot 0 is at a bearing of 30 degrees.

    ``hexagons`` are the corners of rows x columns hexagons, with at most three ways at a place;
    ``triangles`` is a triangular lattice, with at most six.
    """
    make = nx.hexagonal_lattice_graph if kind == "hexagons" else nx.triangular_lattice_graph
    graph: nx.Graph[Any] = make(rows, columns)
    positions = nx.get_node_attributes(graph, "pos")
    ways = sorted(tuple(sorted(way)) for way in graph.edges())

    def bearing(here: Place, there: Place) -> float:
        """The bearing from a place to a neighbour."""
        return flat_bearing(positions[here], positions[there])

    def move(here: Place, there: Place) -> Move:
        """The move from a place to a neighbour."""
        (x, y), (to_x, to_y) = positions[here], positions[there]
        return UNIT * (to_x - x), UNIT * (to_y - y)

    call = kind, str(rows), str(columns)
    made = by_bearing(ways, bearing, 6, 30)
    return Environment(f"{kind}-{rows}x{columns}", call, made, None, (), moves_of(made, move))


def moves_of(made: TopologicalMap, move: Callable[[Place, Place], Move]) -> dict[Gateway, Move]:
    """The moves of the ways, if the places at their ends determine them."""
    return {out: move(out[0], end[0]) for out, end in made.links.items()}


def flat_bearing(here: tuple[float, float], there: tuple[float, float]) -> float:
    """The bearing from a point to another one, in degrees clockwise of north (x east, y north)."""
    return math.degrees(math.atan2(there[0] - here[0], there[1] - here[1]))


def by_bearing(
    ways: Iterable[tuple[Place, Place]],
    bearing: Callable[[Place, Place], float],
    slots: int,
    north: float,
) -> TopologicalMap:
    """Make a world of straight ways.

    Each leaves by the slot nearest to its bearing, and arrives by the opposite one; slot 0 is at
    ``north`` degrees clockwise of north.

    Raises:
        InputError: Two ways of a place have one slot; the message names the place.
    """
    links: dict[Gateway, Gateway] = {}
    for here, there in ways:
        slot = math.floor((bearing(here, there) - north) * slots / 360 + 0.5) % slots
        ends = (here, slot), (there, (slot + slots // 2) % slots)
        for end, other in (ends, ends[::-1]):
            if end in links:
                first, second = links[end][0], other[0]
                hint = "another --slots or --north may separate them"
                if first == second:
                    hint = "both are taken to be straight, so nothing separates them"
                raise InputError(
                    f"place {label(end[0])}: the ways to {label(first)} and {label(second)} "
                    f"fall into one slot, {end[1]} of {slots}; {hint}"
                )
        _link(links, *ends)
    return world(slots, links)


def _link(links: dict[Gateway, Gateway], a: Gateway, b: Gateway) -> None:
    links[a], links[b] = b, a


KINDS = ("grid", "cylinder", "torus", "crescents", "maze", "hexagons", "triangles")


def environment(
    kind: str, rows: int, columns: int, thin: float = 0.3, seed: int = 0
) -> Environment:
    """Make the world of a kind.

    The kinds are ``grid``, ``cylinder``, ``torus``, ``crescents``, ``maze`` (from which the share
    ``thin`` of the ways is removed with the seed), ``hexagons`` and ``triangles``.

    Raises:
        ValueError: The kind is not known, or a number is out of its range.
        InputError: The world would be too large.
    """
    rows, columns = whole("rows", rows, 1), whole("columns", columns, 1)
    thin, seed = share("thin", thin), whole("seed", seed, 0)
    if rows * columns > MOST_PLACES:
        raise InputError(f"{kind} {rows} x {columns}: more than {MOST_PLACES} places")
    if kind == "maze":
        return maze(rows, columns, thin, seed)
    if kind in ("hexagons", "triangles"):
        return lattice(kind, rows, columns)
    if kind in ("grid", "cylinder", "torus", "crescents"):
        return grid(rows, columns, kind)
    hint = f"; {near}" if (near := meant(str(kind), KINDS)) else ""
    raise ValueError(f"{kind!r} is not one of the environments {', '.join(KINDS)}{hint}")
