"""Graphs in node-link JSON, as networkx, D3 and other programs write them.

Nodes stand under ``nodes``, and edges under ``links`` or ``edges``. An edge has ``source`` and
``target`` (or ``from`` and ``to``), each of which is the ``id`` of a node or its position in the
list, from 0. A node has coordinates: ``x`` and ``y``, ``lon`` and ``lat``, or ``pos`` or
``position``, which is a list of two numbers or has x and y. An edge may have its course,
``geometry``, as in GraphML, or as a LineString of GeoJSON. y and the second number point north.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from topomap.model.topology import Place
from topomap.runtime import formats, nx
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Plan, Reading
from topomap.worlds.readers import exact, graphml
from topomap.worlds.readers.common import (
    demand_few,
    demand_json,
    json_of,
    landmarks_of,
    looks_like_json,
    name_of,
    number_of,
    numbered,
    shown,
)

EDGES = ("links", "edges")
POINTS = ("pos", "position")
ENDS = (("source", "target"), ("from", "to"))


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is JSON with nodes and edges in it."""
    if not looks_like_json(content):
        return False
    told = json_of(content)
    if isinstance(told, InputError):
        return b'"nodes"' in content and any(f'"{key}"'.encode() in content for key in EDGES)
    return isinstance(told, dict) and "nodes" in told and bool({*EDGES} & told.keys())


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan of a graph in node-link JSON.

    Raises:
        InputError: The file has a fault.
    """
    told = demand_json(file, content)
    formats.demand(file, told)
    nodes, edges = told["nodes"], told["links" if "links" in told else "edges"]
    for what, listed in (("nodes", nodes), ("edges", edges)):
        if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
            raise InputError(f"{file}: its {what} are not a list of objects")
    demand_few(file, len(nodes))
    names = _names(file, nodes)
    attributes = told.get("graph")
    attributes = attributes if isinstance(attributes, dict) else {}
    kind = nx.MultiDiGraph if told.get("directed") is True else nx.MultiGraph
    graph: nx.MultiGraph[Any] = kind()
    graph.graph.update(attributes)
    own = "slots" in attributes and all("ends" in edge for edge in edges)
    places: dict[str, Place] = {name: name for name in names} if own else numbered(names)
    for name, node in zip(names, nodes, strict=True):
        graph.add_node(places[name])
        graph.nodes[places[name]].update(node if own else {**node, **_point(node)})
    ends = _Ends(file, nodes, names, edges)
    for number, edge in enumerate(edges):
        one, other = (places[name] for name in ends.of(number))
        key = graph.add_edge(one, other)
        graph.edges[one, other, key].update(_course(edge))
    if own:
        return exact.plan_of(file, graph)
    plan = graphml.plan_of(file, graph, reading)
    called: dict[Place, str] = {}
    landmarks: dict[Place, frozenset[str]] = {}
    for name, node in zip(names, nodes, strict=True):
        what = f"node {shown(name)}"
        if title := next((node[key] for key in ("name", "label") if node.get(key)), None):
            called[places[name]] = name_of(file, what, title)
        if "landmarks" in node:
            landmarks[places[name]] = landmarks_of(file, what, node["landmarks"])
    return replace(plan, names=called, landmarks=landmarks)


def _course(edge: Mapping[str, Any]) -> dict[str, Any]:
    """What the file says about an edge, with a course of GeoJSON as a list."""
    told = {**edge}
    course = told.get("geometry")
    if isinstance(course, dict):
        told["geometry"] = json.dumps(course.get("coordinates"))
    elif isinstance(course, list):
        told["geometry"] = json.dumps(course)
    elif course is None:
        told.pop("geometry", None)
    return told


def _names(file: str, nodes: Sequence[Mapping[str, Any]]) -> list[str]:
    """The name of each node: its id, or its number if no node has one."""
    if not any("id" in node for node in nodes):
        return [str(number) for number in range(len(nodes))]
    names = []
    seen = set()
    for number, node in enumerate(nodes):
        if "id" not in node:
            said = f"node {number} of the list, from 0, has no id, but others have one"
            raise InputError(f"{file}: {said}")
        names.append(_name(file, f"node {number} of the list, from 0", node["id"]))
        if names[-1] in seen:
            raise InputError(f"{file}: node {shown(names[-1])} occurs twice")
        seen.add(names[-1])
    return names


def _name(file: str, what: str, told: object) -> str:
    """Read a name; the nodes of networkx may also be tuples, which are lists in JSON."""
    if isinstance(told, list) and told and not any(isinstance(one, list | dict) for one in told):
        return ",".join(name_of(file, what, one) for one in told)
    return name_of(file, what, told)


def _id(end: object) -> object:
    """The name of the end of an edge.

    When D3 has drawn a graph, the end is the node itself, which has its name in it.
    """
    if isinstance(end, dict):
        return end.get("id", end.get("index"))
    return end


class _Ends:
    """The ends of edges, by the names of nodes or, if one is not such a name, by their numbers."""

    def __init__(
        self,
        file: str,
        nodes: Sequence[Mapping[str, Any]],
        names: Sequence[str],
        edges: Sequence[Mapping[str, Any]],
    ) -> None:
        self.file, self.names = file, names
        self.told: list[tuple[object, object]] = []
        for number, edge in enumerate(edges):
            keys = next((keys for keys in ENDS if {*keys} <= edge.keys()), None)
            if keys is None:
                raise InputError(f"{file}: edge {number}, from 0: it has no source and target")
            one, other = (edge[key] for key in keys)
            self.told.append((_id(one), _id(other)))
        known = {*names}
        self.by_name = all(
            _name(file, f"edge {number}, from 0", end) in known
            for number, ends in enumerate(self.told)
            for end in ends
        )

    def of(self, number: int) -> list[str]:
        """The names of the two ends of an edge."""
        made = []
        for end in self.told[number]:
            what = f"edge {number}, from 0"
            if self.by_name:
                made.append(_name(self.file, what, end))
            elif isinstance(end, int) and not isinstance(end, bool) and 0 <= end < len(self.names):
                made.append(self.names[end])
            else:
                name = shown(_name(self.file, what, end))
                raise InputError(f"{self.file}: {what}: {name} is not a node")
        return made


def _point(node: Mapping[str, Any]) -> dict[str, Any]:
    """The coordinates of a node that have other names than x and y, or lon and lat."""
    for key in POINTS:
        point = node.get(key)
        if isinstance(point, dict):
            told: tuple[Any, Any] = (point.get("x"), point.get("y"))
        elif isinstance(point, list) and len(point) >= 2:
            told = (point[0], point[1])
        else:
            continue
        x, y = number_of(told[0]), number_of(told[1])
        if x is not None and y is not None:
            return {"x": x, "y": y}
    return {}
