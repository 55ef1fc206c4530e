"""Topological maps of robots, as topological_navigation (ROS and ROS 2) writes them: tmap2, YAML.

``nodes`` is a list. Each item has a ``node`` with its ``name``, its ``pose``, whose ``position`` x,
y is in metres in the plane of the map, and its ``edges``, each with its ``edge_id`` and the
``node`` where it ends. An edge can be gone in its direction only; two opposite ones are one way.
The older form, a list of such nodes alone, is read, too. The orientation, the actions, and the
transformation of the map's frame are not used.
"""

import re
from collections.abc import Hashable
from dataclasses import replace
from typing import Any

import yaml

from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Plan, Reading
from topomap.worlds.readers import exact, graphml
from topomap.worlds.readers.common import (
    demand_few,
    json_of,
    looks_like_json,
    name_of,
    number_of,
    numbered,
    shown,
)

DEEPEST = 50
MOST_BYTES = 2**25
MOST_VALUES = 5 * 10**6  # an alias counts as much as what it stands for
_NODES = re.compile(rb"""^(?:["']?nodes["']?\s*:|-\s+["']?(?:meta|node)["']?\s*:)""", re.MULTILINE)


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """The safe loader of YAML, which reads all plain values as texts."""

    yaml_implicit_resolvers = {  # noqa: RUF012
        "<": [("tag:yaml.org,2002:merge", re.compile(r"^(?:<<)$"))]
    }


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is YAML, or JSON, with nodes that have edges."""
    if looks_like_json(content):
        told = json_of(content)
        nodes = told.get("nodes") if isinstance(told, dict) else told
        first = nodes[0] if isinstance(nodes, list) and nodes else None
        return isinstance(first, dict) and bool({"node", "pose"} & first.keys())
    return (
        content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] != b"<"
        and bool(_NODES.search(content))
        and b"edges" in content
    )


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan of a tmap2.

    Raises:
        InputError: The file has a fault.
    """
    told = _yaml(file, content)
    listed = told.get("nodes") if isinstance(told, dict) else told
    meta = told.get("meta") if isinstance(told, dict) else None
    meta = meta if isinstance(meta, dict) else {}
    if not isinstance(listed, list):
        raise InputError(f"{file}: its nodes are not a list")
    demand_few(file, len(listed))
    nodes: dict[str, dict[str, Any]] = {}
    for number, entry in enumerate(listed):
        node = entry.get("node", entry) if isinstance(entry, dict) else None
        if not isinstance(node, dict) or "name" not in node:
            raise InputError(f"{file}: node {number} of the list, from 0, has no name")
        name = name_of(file, f"node {number} of the list, from 0", node["name"])
        if name in nodes:
            raise InputError(f"{file}: two nodes are called {shown(name)}")
        nodes[name] = node
    edges = [(name, *edge) for name, node in nodes.items() for edge in _edges(file, name, node)]
    for one, other, edge, _ in edges:
        if other not in nodes:
            raise InputError(
                f"{file}: edge {shown(edge)} of node {shown(one)}: no node {shown(other)}"
            )
    if "slots" in meta and all({"slot", "back"} <= about.keys() for *_, about in edges):
        return exact.plan_of(file, _told_exactly(file, meta, nodes, edges))
    places = numbered(nodes)
    graph: nx.MultiDiGraph[Any] = nx.MultiDiGraph(crs="plane")
    for name, node in nodes.items():
        graph.add_node(places[name], **_position(node))
    again = 0
    for one, other, _, _ in edges:
        if graph.has_edge(places[one], places[other]):
            again += 1
        else:
            graph.add_edge(places[one], places[other])
    plan = graphml.plan_of(file, graph, reading)
    if again:
        said = f"{file}: edges between the same two nodes, taken as one way: {again} more"
        plan = replace(plan, told=(*plan.told, said))
    return plan


def _edges(file: str, name: str, node: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """The edges of a node: where each ends, its name, and its properties."""
    listed = node.get("edges")
    listed = [] if listed in (None, "", "null", "~") else listed
    if not isinstance(listed, list):
        raise InputError(f"{file}: node {shown(name)}: its edges are not a list")
    made = []
    for number, edge in enumerate(listed):
        what = f"edge {number}, from 0, of node {shown(name)}"
        if not isinstance(edge, dict) or "node" not in edge:
            raise InputError(f"{file}: {what}: it does not tell its node")
        about = edge.get("properties")
        other = name_of(file, what, edge["node"])
        called = name_of(file, what, edge.get("edge_id", str(number)))
        made.append((other, called, about if isinstance(about, dict) else {}))
    return made


def _position(node: dict[str, Any]) -> dict[str, float]:
    pose = node.get("pose")
    point = pose.get("position") if isinstance(pose, dict) else None
    told = [number_of(point.get(key)) for key in "xy"] if isinstance(point, dict) else [None]
    return dict(zip("xy", told, strict=True)) if None not in told else {}  # type: ignore[arg-type]


def _told_exactly(
    file: str,
    meta: dict[str, Any],
    nodes: dict[str, dict[str, Any]],
    edges: list[tuple[str, str, str, dict[str, Any]]],
) -> "nx.MultiGraph[Any]":
    """The graph of a map that topomap wrote, whose edges tell their slots."""
    head = {key: meta[key] for key in ("slots", "north", "straight") if key in meta}
    graph: nx.MultiGraph[Any] = nx.MultiGraph()
    graph.graph.update(**head)
    for name, node in nodes.items():
        about = node.get("properties")
        about = about if isinstance(about, dict) else {}
        more = {key: about[key] for key in ("landmarks", "gateways") if key in about}
        more |= {"name": about["title"]} if "title" in about else {}
        if "gateways" in more and isinstance(more["gateways"], list):
            slots = [number_of(slot) for slot in more["gateways"]]
            more["gateways"] = [slot if slot is None else int(slot) for slot in slots]
        graph.add_node(name, **_position(node), **more)
    gone: dict[tuple[str, str, str, str], int] = {}
    for one, other, called, about in edges:
        ends = one, str(about["slot"]), other, str(about["back"])
        back = ends[2:] + ends[:2]
        if ends in gone:
            raise InputError(f"{file}: edge {shown(called)} of node {shown(one)} occurs twice")
        gone[ends] = 1
        if back not in gone:
            move = {"move": about["move"]} if "move" in about else {}
            graph.add_edge(one, other, ends=[ends[:2], ends[2:]], **move)
    if alone := [ends for ends in gone if ends[2:] + ends[:2] not in gone]:
        one, slot, other, _ = alone[0]
        raise InputError(
            f"{file}: the edge from slot {shown(slot)} of node {shown(one)} to node {shown(other)} "
            "has no edge back, with the same slots"
        )
    return graph


def _yaml(file: str, content: bytes) -> Any:
    """Read a file of YAML, with all plain values as texts.

    Raises:
        InputError: It cannot be read.
    """
    if len(content) > MOST_BYTES:
        raise InputError(f"{file}: larger than {MOST_BYTES >> 20} MiB")
    try:
        text = content.decode("utf-8-sig")
        _demand_plain(file, text)
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
            if node is None:
                raise InputError(f"{file}: nothing in it")
            _demand_small(file, node)
            return loader.construct_document(node)
        finally:
            loader.dispose()
    except UnicodeDecodeError:
        raise InputError(f"{file}: not a text file") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f"{mark.line + 1}" if mark else ""
        said = getattr(error, "problem", None) or "a character that is not allowed"
        raise InputError(f"{file}:{line}: not YAML: {' '.join(str(said).split())[:100]}") from None
    except (RecursionError, ValueError, TypeError):
        raise InputError(f"{file}: not YAML that can be read") from None


def _demand_plain(file: str, text: str) -> None:
    """Check that there are no tags, and that nothing is nested too deeply.

    Raises:
        InputError: There is a tag, or something is nested too deeply.
    """
    depth = 0
    for event in yaml.parse(text, Loader=_Loader):
        line = _line(event)
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > DEEPEST:
            raise InputError(f"{file}:{line}: nested deeper than {DEEPEST}")
        if (tag := getattr(event, "tag", None)) is not None:
            raise InputError(f"{file}:{line}: the tag {shown(tag)} is refused, as all tags are")


def _line(part: yaml.Event | yaml.Node) -> int:
    """The line in which a part of the text begins, from 1."""
    return part.start_mark.line + 1 if part.start_mark else 1


def _demand_small(file: str, root: yaml.Node) -> None:
    """Check that no value contains itself, and that aliases do not make the file too large.

    Raises:
        InputError: A value contains itself, or the file becomes too large.
    """
    sizes: dict[Hashable, int] = {}
    waiting = [(root, False)]
    open_: set[int] = set()
    while waiting:
        node, done = waiting.pop()
        parts: list[yaml.Node] = []
        if isinstance(node, yaml.SequenceNode):
            parts = node.value
        elif isinstance(node, yaml.MappingNode):
            parts = [part for pair in node.value for part in pair]
        if done:
            open_.discard(id(node))
            sizes[id(node)] = 1 + sum(sizes[id(part)] for part in parts)
            if sizes[id(node)] > MOST_VALUES:
                said = f"more than {MOST_VALUES} values, counting what aliases stand for"
                raise InputError(f"{file}:{_line(node)}: {said}")
        elif id(node) in open_:
            raise InputError(f"{file}:{_line(node)}: it contains itself by an alias")
        elif id(node) not in sizes:
            open_.add(id(node))
            waiting.append((node, True))
            waiting += [(part, False) for part in parts]
