"""Worlds from street or corridor networks in GraphML, as OSMnx writes and networkx reads.

Read: directed or undirected (multi)graphs with node attributes x, y (projected, or
longitude and latitude) or lon, lat. A pair of opposite one-way edges is one way; loops
are left out; a way is the straight line between its ends.
"""

import io
import math
import re
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

from topomap.model.experience import MOST_SLOTS
from topomap.model.topology import Place
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_bytes
from topomap.runtime.limits import LARGEST
from topomap.worlds.environment import (
    Environment,
    by_bearing,
    flat_bearing,
    moves_of,
    plain,
)
from topomap.worlds.senses import Move

Point = tuple[float, float]
DEGREE = 111_195  # metres of a degree of latitude, on a sphere of 6,371 km


def load(file: str | Path, slots: int, north: float) -> tuple[Environment, list[str]]:
    """The world in a GraphML file, and warnings. Raises InputError on bad input."""
    if not 2 <= slots <= MOST_SLOTS or slots % 2:
        raise InputError(f"{file}: {slots} slots: they must be even, from 2 to {MOST_SLOTS}")
    if not math.isfinite(north):
        raise InputError(f"{file}: north {north}: it must be a finite number of degrees")
    graph = read_graphml(file, read_bytes(file))
    loops = list(nx.selfloop_edges(graph))
    graph.remove_edges_from(loops)
    lone = list(nx.isolates(graph))
    parts = nx.number_connected_components(nx.Graph(graph)) - len(lone)
    told = [
        f"{file}: {what}: {number}"
        for what, number in (
            ("loops left out", len(loops)),
            ("places without a way left out", len(lone)),
            ("not connected; an exploration stays in its part, of", parts if parts > 1 else 0),
        )
        if number
    ]
    ways = _ways(graph)
    if not ways:
        raise InputError(f"{file}: no ways in it")
    points = {place: _point(file, graph, place) for way in ways for place in way}
    unprojected = _unprojected(graph, points)
    if "crs" not in graph.graph:
        units = "degrees" if unprojected else "plane"
        told.append(f"{file}: no crs in it; coordinates taken to be: {units}")

    def bearing(here: Place, there: Place) -> float:
        (x, y), (to_x, to_y) = points[here], points[there]
        if (x, y) == (to_x, to_y):
            raise InputError(f"places {here} and {there} are at one point")
        if unprojected:
            to_x = x + ((to_x - x + 180) % 360 - 180) * math.cos(math.radians((y + to_y) / 2))
        return flat_bearing((x, y), (to_x, to_y))

    def move(here: Place, there: Place) -> Move:
        (x, y), (to_x, to_y) = points[here], points[there]
        if not unprojected:
            return to_x - x, to_y - y
        # In one frame for all places, as odometry is: a degree of longitude is as long as where the
        # first place is.
        east = ((to_x - x + 180) % 360 - 180) * math.cos(math.radians(equal))
        return DEGREE * east, DEGREE * (to_y - y)

    equal = next(iter(points.values()))[1]
    try:
        world = by_bearing(ways, bearing, slots, north)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    path = Path(file)
    call = "network", path.name, "--slots", str(slots), "--north", plain(north)
    scale = "longitude and latitude" if unprojected else "plane"
    notes = (
        f"coordinates: {scale}",
        f"slot 0 at {plain(north)} degrees clockwise of north",
        *_provenance(graph),
    )
    return Environment(path.stem, call, world, None, notes, moves_of(world, move)), told


def read_graphml(file: str | Path, content: bytes, node_type: type = str) -> "nx.Graph[Any]":
    """The graph in the content of a GraphML file. Raises InputError, one line."""
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
    except Exception as error:  # networkx has all kinds of errors for what it cannot read
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{file}: not a GraphML file that networkx reads: {reason}") from None
    return graph


def _ways(graph: "nx.Graph[Any]") -> list[tuple[Place, Place]]:
    """The ways in order of their places; opposite directed edges pair up."""
    edges = Counter(list(graph.edges()))
    if graph.is_directed():
        pairs = {tuple(sorted(edge)) for edge in edges}
        count = {(a, b): max(edges[a, b], edges[b, a]) for a, b in pairs}
    else:
        count = Counter()
        for edge, number in edges.items():
            count[tuple(sorted(edge))] += number
    return [way for way in sorted(count) for _ in range(count[way])]


def _point(file: str | Path, graph: "nx.Graph[Any]", place: Place) -> Point:
    attributes = graph.nodes[place]
    for x, y in (("x", "y"), ("lon", "lat")):
        if x in attributes and y in attributes:
            try:
                point = float(attributes[x]), float(attributes[y])
            except (TypeError, ValueError):
                point = math.nan, math.nan
            if all(abs(number) <= LARGEST for number in point):
                return point
    raise InputError(f"{file}: place {place} has no coordinates (numbers x, y or lon, lat)")


def _unprojected(graph: "nx.Graph[Any]", points: dict[Place, Point]) -> bool:
    """Whether the coordinates are degrees of longitude and latitude: as the coordinate
    reference system says or, without one, if they could be."""
    crs = str(graph.graph.get("crs", "")).lower()
    if crs:
        return bool(re.search(r"4326|4258|4269|crs84|longlat|latlong", crs))
    return all(abs(x) <= 180 and abs(y) <= 90 for x, y in points.values())


def _provenance(graph: "nx.Graph[Any]") -> tuple[str, ...]:
    """Source and licence, where the file tells them."""
    maker = str(graph.graph.get("created_with", ""))
    if not maker.startswith("OSMnx"):
        return ()
    date = str(graph.graph.get("created_date", ""))[:10]
    return (
        f"source: OpenStreetMap contributors, {date}, by {maker}",
        "licence: ODbL 1.0, https://opendatacommons.org/licenses/odbl/",
    )
