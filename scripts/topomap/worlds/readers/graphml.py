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
from typing import Any

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

from topomap.model.topology import Place
from topomap.runtime import nx
from topomap.runtime.errors import InputError, printable
from topomap.runtime.limits import LARGEST
from topomap.worlds.courses import exit_towards, point_along
from topomap.worlds.plan import Plan, Point, Reading, Way
from topomap.worlds.readers import exact

Data = Mapping[str, Any]  # what is told of an edge
DEGREE = 111_195  # metres of a degree of latitude, for an earth radius of 6,371 km
NO, YES = {"false", "0", "no"}, {"true", "1", "yes"}  # the values of the attribute oneway


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is GraphML."""
    begins = content[:4000].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    return begins[:1] == b"<" and b"graphml" in begins


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
    edges = _edges(graph)
    loops = [edge for edge in edges if edge[0] == edge[1]]
    if not reading.loops:
        edges = [edge for edge in edges if edge[0] != edge[1]]
    used = [place for place in graph if place in {end for edge in edges for end in edge[:2]}]
    lone = len(graph) - len(used)
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
    if "crs" not in graph.graph and reading.degrees is None:
        units = "degrees" if degrees else "plane"
        flag = "--plane" if degrees else "--degrees"
        guess = f"{file}: no crs in it; coordinates taken to be: {units}"
        told.append(f"{guess} ({flag} says otherwise)")
    flat = _in_degrees if degrees else _in_plane
    places = {place: flat(point, points[used[0]]) for place, point in points.items()}
    ways = []
    for one, other, data, one_way in edges:
        course = _course(file, (one, other), (points[one], points[other]), data)
        if one == other and len({*course}) < 3:
            raise InputError(
                f"{file}: the way from place {printable(str(one))} back to itself has no course, "
                "so no slots can be had for it"
            )
        ends = []
        for place, line in ((one, course), (other, course[::-1])):
            here = [flat(point, points[place]) for point in line]
            if all(math.dist(point, here[0]) == 0 for point in here):
                names = f"{printable(str(one))} and {printable(str(other))}"
                raise InputError(f"{file}: places {names} are at one point")
            ends.append(exit_towards(place, here[0], point_along(here, reading.along)))
        where = [flat(point, points[used[0]]) for point in course]
        move = where[-1][0] - where[0][0], where[-1][1] - where[0][1]
        long = sum(math.dist(*pair) for pair in pairwise(here))
        ways.append(Way((ends[0], ends[1]), move, long, one_way))
    scale = "longitude and latitude" if degrees else "plane"
    return Plan(
        Path(file).stem,
        tuple(ways),
        places,
        notes=(f"coordinates: {scale}", *_provenance(graph)),
        told=tuple(told),
    )


def _edges(graph: "nx.Graph[Any]") -> list[tuple[Place, Place, Data, bool]]:
    """The ways, in the order of their places.

    Each has its ends, what is told of it, and whether it can be gone only from the first end to the
    second.
    """
    made: list[tuple[Place, Place, Data, bool]] = []
    between: dict[tuple[Place, Place], list[Data]] = defaultdict(list)
    data: Data
    for one, other, data in graph.edges(data=True):
        between[one, other].append(data)
    if not graph.is_directed():
        for (one, other), several in between.items():
            for data in several:
                one_way = str(data.get("oneway", "")).lower() in YES
                ends = (one, other) if one_way else (min(one, other), max(one, other))
                made.append((*ends, data, one_way))
    else:
        for one, other in sorted({(min(pair), max(pair)) for pair in between}):
            back = [] if one == other else [*between[other, one]]
            for data in between[one, other]:
                opposite = _opposite(data, between[one, other] if one == other else back)
                if one == other:
                    # A loop that can be gone both ways occurs twice.
                    if opposite is not None and _key(opposite) < _key(data):
                        continue
                elif opposite is not None:
                    back.remove(opposite)
                made.append((one, other, data, opposite is None and _one_way(data)))
            made += [(other, one, data, _one_way(data)) for data in back]
    return sorted(made, key=lambda edge: (edge[:2], _key(edge[2]), edge[3]))


def _one_way(data: Data) -> bool:
    """Tell whether a directed edge without an opposite edge can be gone one way only."""
    return str(data.get("oneway", "")).lower() not in NO


def _key(data: Data) -> str:
    return str(data.get("geometry", ""))


def _opposite(data: Data, others: Sequence[Data]) -> Data | None:
    """The edge with the same course in the other direction, if there is one."""
    course = _points(_key(data))
    for other in others:
        back = _points(_key(other))
        same = course is None and back is None
        if course is not None and back is not None:
            same = course == back[::-1]
        if same and other is not data:
            return other
    return None


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
        raise ValueError("two points are wanted, and no numbers without end")
    return points


def _course(
    file: str,
    ends: tuple[Place, Place],
    points: tuple[Point, Point],
    data: Data,
) -> list[Point]:
    """The points of a way from its first end to its second."""
    try:
        course = _points(_key(data))
    except (ValueError, TypeError, KeyError, IndexError, RecursionError, OverflowError):
        names = f"{printable(str(ends[0]))} to {printable(str(ends[1]))}"
        said = "its geometry is no LINESTRING (x y, ...), and no list of points"
        raise InputError(f"{file}: the way from place {names}: {said}") from None
    if course is None:
        return [*points]
    apart = math.dist(course[0], points[0]) + math.dist(course[-1], points[1])
    turned = math.dist(course[-1], points[0]) + math.dist(course[0], points[1])
    return course[::-1] if turned < apart else course


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


def _degrees(graph: "nx.Graph[Any]", points: Mapping[Place, Point]) -> bool:
    """Tell whether the coordinates are degrees of longitude and latitude.

    The coordinate reference system says so. Without one they are taken to be of a plane, as those
    of a robot are, unless they have the names lon and lat.
    """
    if crs := str(graph.graph.get("crs", "")).lower():
        return bool(re.search(r"4326|4258|4269|crs84|longlat|latlong", crs))
    return not any("x" in graph.nodes[place] for place in points)


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
