"""The tmap2 of topological_navigation, a format of maps for robots (ROS and ROS 2), in YAML.

Each node has a pose, which is its position in metres, and edges to its neighbours. What else
topomap knows stands where such a map has room for it, so that ``worlds/readers/tmap2.py`` reads the
same world. Under ``meta`` are the ``slots``, where slot 0 points (``north``), and the pairs of
gateways on one path (``straight``). Under the ``properties`` of an edge are the ``slot`` by which
it leaves, the slot by which it arrives (``back``), and how far it leads (``move``). Under those of
a node are ``gateways``, ``landmarks`` and a ``title``.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import yaml

from topomap.model.topology import Place

ACTION = "navigate_to_pose"
# The format needs a date. It is always this one, so that one map always gives the same bytes.
UPDATED = "01-01-1970_00-00-00"
ZONE = 0.5  # metres: half the side of the square in which a robot counts as being at a node


class Node(NamedTuple):
    """A place: its name, its position, its gateways and landmarks, and its title."""

    name: str
    point: tuple[float, float]
    gateways: Sequence[int]
    landmarks: Sequence[str] = ()
    title: str | None = None


class Edge(NamedTuple):
    """A way in one direction.

    It has the place and the slot that it leaves, the place and the slot where it arrives, and how
    far it leads, east and north.
    """

    place: str
    slot: int
    to: str
    back: int
    move: tuple[float, float] | None = None


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """The safe writer of YAML, without aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        """Write equal data twice, without an alias."""
        return True


def tmap2_text(
    name: str,
    slots: int,
    north: float,
    nodes: Iterable[Node],
    edges: Iterable[Edge],
    straight: Sequence[tuple[Place, int, int]] | None = None,
) -> str:
    """Write a tmap2; ``edges`` has each way in both directions."""
    leaving: dict[str, list[Edge]] = {}
    for edge in edges:
        leaving.setdefault(edge.place, []).append(edge)
    meta: dict[str, Any] = {"last_updated": UPDATED, "slots": slots, "north": north}
    if straight is not None:
        meta["straight"] = [[*pair] for pair in straight]
    document = {
        "meta": meta,
        "metric_map": name,
        "name": name,
        "pointset": name,
        "transformation": {
            "topo_frame_id": "topo_map",
            "parent": "map",
            "rotation": {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0},
            "translation": {"x": 0.0, "y": 0.0, "z": 0.0},
        },
        "nodes": [
            {
                "meta": {"map": name, "node": node.name, "pointset": name},
                "node": _node(node, leaving.get(node.name, ())),
            }
            for node in nodes
        ],
    }
    return str(yaml.dump(document, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100))


def _node(node: Node, edges: Iterable[Edge]) -> dict[str, Any]:
    x, y = node.point
    properties: dict[str, Any] = {"xy_goal_tolerance": 0.3, "yaw_goal_tolerance": 6.28}
    properties |= {"title": node.title} if node.title is not None else {}
    properties["gateways"] = [*node.gateways]
    properties["landmarks"] = [*node.landmarks]
    corners = ((-ZONE, -ZONE), (ZONE, -ZONE), (ZONE, ZONE), (-ZONE, ZONE))
    return {
        "name": node.name,
        "edges": [_edge(edge) for edge in edges],
        "pose": {
            "orientation": {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0},
            "position": {"x": x + 0.0, "y": y + 0.0, "z": 0.0},
        },
        "properties": properties,
        "verts": [{"x": east, "y": north} for east, north in corners],
    }


def _edge(edge: Edge) -> dict[str, Any]:
    properties: dict[str, Any] = {"slot": edge.slot, "back": edge.back}
    properties |= {} if edge.move is None else {"move": [one + 0.0 for one in edge.move]}
    return {
        "action": ACTION,
        "edge_id": f"{edge.place}.{edge.slot}_{edge.to}.{edge.back}",
        "node": edge.to,
        "properties": properties,
    }
