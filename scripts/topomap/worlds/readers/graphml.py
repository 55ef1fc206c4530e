"""Street and corridor networks in GraphML, as OSMnx writes and networkx reads them.

They are directed or undirected (multi)graphs. Nodes have coordinates x, y (projected, or longitude
and latitude) or lon, lat. Edges may have their course (``geometry``) as WKT, ``LINESTRING (x y,
...)``, or as a list of points. An edge without a course is straight. Two opposite directed edges
with one course are one way; an edge that has no opposite edge can be gone one way only.
"""

import io
import json
import math
import re
import warnings
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

from topomap.model.topology import Place
from topomap.runtime import nx
from topomap.runtime.errors import InputError, printable
from topomap.runtime.limits import LARGEST
from topomap.worlds.courses import SHOWN, exit_towards, point_along, shares
from topomap.worlds.plan import Plan, Point, Reading, Way
from topomap.worlds.readers import exact
from topomap.worlds.readers.common import is_xml_with

Data = Mapping[str, Any]  # what the file says about an edge
DEGREE = 111_195  # metres of a degree of latitude, for an earth radius of 6,371 km
NEAR = 1e-9  # two points that are so near are one
FAR = 0.1  # if a course ends farther from its places, as a share of its length, there is a warning
# Most EPSG codes from 4000 to 4999 are of longitude and latitude, and so are newer ones like those
# in GEOGRAPHIC. The codes in GEOCENTRIC are not: their three axes are metres from the middle of the
# Earth.
GEOGRAPHIC = {6318, 6668, 6706, 7844}
PLANES = {"plane", "local", "cartesian", "none", "null"}
GEOCENTRIC = {4328, 4936, 4978}
NO, YES = {"false", "0", "no"}, {"true", "1", "yes"}  # the values of the attribute oneway


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is GraphML."""
    return is_xml_with(content, b"graphml")


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan in a GraphML file.

    Raises:
        InputError: The file has a fault.
    """
    graph = read_graphml(file, content)
    return exact.plan_of(file, graph) if exact.fits(graph) else plan_of(file, graph, reading)


def read_graphml(file: str | Path, content: bytes, node_type: type = str) -> "nx.Graph[Any]":
    """Read the graph in the content of a GraphML file.

    Raises:
        InputError: There is none. One line.
    """
    try:
        fromstring(content, forbid_dtd=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            graph: nx.Graph[Any] = nx.read_graphml(io.BytesIO(content), node_type)
    except DefusedXmlException:
        raise InputError(
            f"{file}: it declares a document type or entities, which is refused"
        ) from None
    except MemoryError:
        raise
    except Exception as error:  # networkx raises all kinds of errors on bad files
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{file}: not a GraphML file that networkx reads: {reason}") from None
    return graph


def plan_of(file: str, graph: "nx.Graph[Any]", reading: Reading) -> Plan:
    """Make the plan of a graph whose nodes have coordinates.

    Raises:
        InputError: The graph has a fault.
    """
    edges = _edges(file, graph)
    loops = [edge for edge in edges if edge[0] == edge[1]]
    if not reading.loops:
        edges = [edge for edge in edges if edge[0] != edge[1]]
    ended = {end for edge in edges for end in edge[:2]}
    used = [place for place in graph if place in ended]
    lone = len(graph) - len(used)
    guessed = ""
    told = [
        f"{file}: {what}: {number}"
        for what, number in (
            ("loops left out", 0 if reading.loops else len(loops)),
            ("places without a way left out", lone),
        )
        if number
    ]
    points = {place: _point(file, graph, place) for place in used}
    degrees = _degrees(graph, points) if reading.degrees is None else reading.degrees
    if degrees is None:
        degrees = False
        crs = printable(str(graph.graph["crs"]))[:60]
        told.append(f"{file}: crs {crs} is not known, and is taken to be of a plane (--degrees)")
    if degrees and not all(abs(lon) <= 540 and abs(lat) <= 90 for lon, lat in points.values()):
        raise InputError(f"{file}: its coordinates are not longitude and latitude (--plane)")
    if "crs" not in graph.graph and reading.degrees is None:
        units = "degrees" if degrees else "plane"
        flag = "--plane" if degrees else "--degrees"
        guessed = f"no crs in it; coordinates taken to be: {units}; {flag} says otherwise"
        told.append(f"{file}: {guessed}")
    flat = _in_degrees if degrees else _in_plane
    places = {place: flat(point, points[used[0]]) for place, point in points.items()}
    ways = []
    elsewhere = []
    share = shares(edge[:2] for edge in edges)
    for one, other, told_course, one_way in edges:
        course, gap = _placed(told_course, (points[one], points[other]))
        if gap > FAR * _long(course):
            elsewhere.append(f"{printable(str(one))} to {printable(str(other))}")
        if one == other and len({*course}) < 3:
            raise InputError(
                f"{file}: the way from place {printable(str(one))} back to itself has no course, "
                "so it cannot be given slots"
            )
        ends = []
        for place, line in ((one, course), (other, course[::-1])):
            here = [flat(point, points[place]) for point in line]
            if all(math.dist(point, here[0]) == 0 for point in here):
                names = f"{printable(str(one))} and {printable(str(other))}"
                raise InputError(f"{file}: places {names} are at one point")
            there = point_along(here, reading.along, share(one, other))
            if math.dist(here[0], there) < NEAR:
                names = f"{printable(str(one))} to {printable(str(other))}"
                said = f"is at {printable(str(place))} again where its direction is taken (--along)"
                raise InputError(f"{file}: the way from place {names} {said}")
            ends.append(exit_towards(place, here[0], there))
        where = [flat(point, points[used[0]]) for point in course]
        move = where[-1][0] - where[0][0], where[-1][1] - where[0][1]
        long = sum(math.dist(*pair) for pair in pairwise(here))
        ways.append(Way((ends[0], ends[1]), move, long, one_way))
    if elsewhere:
        more = f" and {len(elsewhere) - SHOWN} more" if len(elsewhere) > SHOWN else ""
        listed = ", ".join(elsewhere[:SHOWN]) + more
        told.append(f"{file}: ways whose course does not end at their places: {listed}")
    scale = "longitude and latitude" if degrees else "plane"
    return Plan(
        Path(file).stem,
        tuple(ways),
        places,
        notes=(f"coordinates: {scale}", *_provenance(graph)),
        told=tuple(told),
        guessed=guessed,
    )


class _Edge(NamedTuple):
    """What the file says about an edge: its course, if it has one, and its attribute ``oneway``."""

    course: tuple[Point, ...] | None
    oneway: str

    @property
    def key(self) -> tuple[Point, ...]:
        """The course from the end that is first in order.

        It is equal for two edges with one course, even if they are written from different ends.
        """
        return min(self.course, self.course[::-1]) if self.course else ()


def _edges(
    file: str, graph: "nx.Graph[Any]"
) -> list[tuple[Place, Place, tuple[Point, ...] | None, bool]]:
    """The ways, in the order of their places.

    Each has its ends, its course (None if it is not given), and whether it can be gone only from
    the first end to the second.

    Raises:
        InputError: A course cannot be read.
    """
    made: list[tuple[Place, Place, _Edge, bool]] = []
    between: dict[tuple[Place, Place], list[_Edge]] = defaultdict(list)
    data: Data
    for one, other, data in graph.edges(data=True):
        edge = _Edge(_course(file, one, other, data), str(data.get("oneway", "")).lower())
        between[one, other].append(edge)
    if not graph.is_directed():
        for (one, other), several in between.items():
            for edge in several:
                one_way = edge.oneway in YES
                ends = (one, other) if one_way else (min(one, other), max(one, other))
                made.append((*ends, edge, one_way))
    else:
        # Two opposite edges with one course are one way. A loop that can be gone both ways occurs
        # twice.
        for one, other in sorted({(min(pair), max(pair)) for pair in between}):
            back: dict[tuple[Point, ...], list[_Edge]] = defaultdict(list)
            for edge in between[other, one] if one != other else ():
                back[edge.key].append(edge)
            for edge in between[one, other]:
                if back[edge.key]:
                    back[edge.key].pop()
                    made.append((one, other, edge, False))
                elif one == other:
                    back[edge.key].append(edge)
                else:
                    made.append((one, other, edge, edge.oneway not in NO))
            made += [
                (other, one, edge, edge.oneway not in NO) for left in back.values() for edge in left
            ]
    made.sort(key=lambda way: (*way[:2], way[2].key, way[3]))
    return [(one, other, edge.course, one_way) for one, other, edge, one_way in made]


def _course(file: str, one: Place, other: Place, data: Data) -> tuple[Point, ...] | None:
    """Read the course of an edge; None if it is not given.

    Raises:
        InputError: It cannot be read.
    """
    try:
        points = _points(str(data.get("geometry", "")))
    except (ValueError, TypeError, KeyError, IndexError, RecursionError, OverflowError):
        names = f"{printable(str(one))} to {printable(str(other))}"
        said = "its geometry is neither a LINESTRING (x y, ...) nor a list of points"
        raise InputError(f"{file}: the way from place {names}: {said}") from None
    return None if points is None else tuple(points)


def _points(text: str) -> list[Point] | None:
    """Read the points of a course; None if there is none.

    Raises:
        ValueError: It cannot be read.
    """
    text = text.strip()
    if not text:
        return None
    if match := re.fullmatch(r"LINESTRING\s*(?:Z|M|ZM)?\s*\(([^()]*)\)", text, re.IGNORECASE):
        rows = [[float(number) for number in point.split()] for point in match[1].split(",")]
    else:
        rows = json.loads(text.translate(str.maketrans("()", "[]")))
    points = [(float(row[0]), float(row[1])) for row in rows]
    if len(points) < 2 or not all(abs(number) <= LARGEST for point in points for number in point):
        raise ValueError("two points or more are wanted, with finite numbers")
    return points


def _placed(
    told: tuple[Point, ...] | None, points: tuple[Point, Point]
) -> tuple[list[Point], float]:
    """The points of a way, in the order from its first end to its second.

    The second result is how far they end from the two places.
    """
    if told is None:
        return [*points], 0.0
    apart = math.dist(told[0], points[0]) + math.dist(told[-1], points[1])
    turned = math.dist(told[-1], points[0]) + math.dist(told[0], points[1])
    return [*(told[::-1] if turned < apart else told)], min(apart, turned)


def _long(course: Sequence[Point]) -> float:
    return sum(math.dist(*pair) for pair in pairwise(course))


def _in_plane(point: Point, origin: Point) -> Point:
    return point[0] - origin[0], point[1] - origin[1]


def _in_degrees(point: Point, origin: Point) -> Point:
    """Metres east and north of another point, both in degrees of longitude and latitude.

    A degree of longitude is taken to be as long as at the mean of their latitudes.
    """
    east = (point[0] - origin[0] + 180) % 360 - 180
    middle = math.radians((point[1] + origin[1]) / 2)
    return DEGREE * east * math.cos(middle), DEGREE * (point[1] - origin[1])


def _point(file: str, graph: "nx.Graph[Any]", place: Place) -> Point:
    attributes = graph.nodes[place]
    for x, y in (("x", "y"), ("lon", "lat")):
        if x in attributes and y in attributes:
            try:
                point = float(attributes[x]), float(attributes[y])
            except (TypeError, ValueError, OverflowError):
                point = math.nan, math.nan
            if all(abs(number) <= LARGEST for number in point):
                return point
    name = printable(str(place))
    raise InputError(f"{file}: place {name} has no coordinates (numbers x, y or lon, lat)")


def _degrees(graph: "nx.Graph[Any]", points: Mapping[Place, Point]) -> bool | None:
    """Tell whether the coordinates are degrees of longitude and latitude.

    The coordinate reference system says so; the result is None if this system is not known. Without
    one they are taken to be of a plane, as those of a robot are, unless they have the names lon and
    lat.
    """
    crs = str(graph.graph.get("crs", "")).strip().lower()
    if not crs:
        return not any("x" in graph.nodes[place] for place in points)
    if crs in PLANES:
        return False
    if re.match(r"(bound|compound)?(crs|cs)?\W*(proj(ected)?c(r?)s|local_?cs|engcrs)", crs):
        return False
    if re.match(r"(geog|geod|geographic|geodetic)(c(r?)s)\b", crs):
        return True
    if proj := re.search(r"\+proj=(\w+)", crs):
        return proj[1] in ("longlat", "latlong", "lonlat", "latlon")
    if re.search(r"crs:?84\b", crs):
        return True
    if code := re.fullmatch(r".*\bepsg\W+(?:[\d.]*\W+)?(\d+)\W*", crs):
        number = int(code[1])
        if number in GEOGRAPHIC or (4000 <= number < 5000 and number not in GEOCENTRIC):
            return True
        if not all(abs(x) <= 180 and abs(y) <= 90 for x, y in points.values()):
            return False
    return None


def _provenance(graph: "nx.Graph[Any]") -> tuple[str, ...]:
    """Source and licence, if the file tells them."""
    maker = str(graph.graph.get("created_with", ""))
    if not maker.startswith("OSMnx"):
        return ()
    date = str(graph.graph.get("created_date", ""))[:10]
    return (
        f"source: OpenStreetMap contributors, {date}, by {maker}",
        "licence: ODbL 1.0, https://opendatacommons.org/licenses/odbl/",
    )
