"""Maps for other tools.

The formats are GraphML and JSON (node-link), which ``imports`` reads back, DOT, clingraph, and the
tmap2 of robots. As a graph a map is a networkx MultiGraph: a node is a place, and an edge is a
link. In GraphML, which has no lists, lists are JSON texts.
"""

import json
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import clingo

from topomap.drawing.scenes import Scene
from topomap.exchange.robots import Edge as Leg
from topomap.exchange.robots import Node as Stop
from topomap.exchange.robots import tmap2_text
from topomap.model.found import steps_json
from topomap.model.topology import Gateway, Place, gid
from topomap.runtime import formats, nx
from topomap.runtime.errors import printable

if TYPE_CHECKING:
    from topomap.drawing.layout import Layout
    from topomap.drawing.mesh import Points

Node = tuple[Place | Gateway, dict[str, str]]
Edge = tuple[Place | Gateway, Place | Gateway, dict[str, str]]
LISTS = {
    "at",
    "rests",
    "gateways",
    "landmarks",
    "ends",
    "steps",
    "back",
}  # attributes that are lists
POINTS, RADIUS = 72, 0.15  # in DOT: points of a link of length 1; and, in lengths, of a place
COMMON = {
    "graph": {"inputscale": "72"},  # positions are in points
    "graph_nodes": {
        "shape": "circle",
        "width": f"{2 * RADIUS:g}",
        "fixedsize": "true",
        "style": "filled",
        "fillcolor": "white",
    },
}
STUB = {"shape": "point", "width": "0.06"}


def _placed(scene: Scene, laid: "Layout | None") -> "nx.MultiGraph[int]":
    """The map as a graph whose nodes have coordinates ``x`` and ``y``, in lengths of links.

    There are none if it is not known where the places are.
    """
    graph = graph_of(scene)
    for place, (x, y) in _points(laid).items() if laid else ():
        graph.nodes[place].update(x=x, y=y)
    return graph


def _points(laid: "Layout") -> dict[Place, tuple[float, float]]:
    """The positions of the places."""

    def near(number: float) -> float:
        """Round a coordinate."""
        return round(float(number), 4) + 0.0  # -0 becomes 0

    return {place: (near(point[0]), near(point[1])) for place, point in laid.places.items()}


def graph_of(scene: Scene) -> "nx.MultiGraph[int]":
    """The map as a graph.

    The attribute ``at`` of the graph is the route, ``[[T,P,S], ...]``, and ``rests`` has the steps
    of it that are not a travel, if there are any. The attributes of a node are its ``gateways`` and
    ``landmarks``. Those of an edge are its ``ends``, two gateways ``[P,S]``, the ``steps`` that
    travel it from the first to the second, and those that travel it ``back``.
    """
    world = scene.world
    graph: nx.MultiGraph[int] = nx.MultiGraph(
        name=printable(scene.name),
        kind=scene.kind,
        slots=world.slots,
        genus=world.genus(),
        at=steps_json(scene.at),
    )
    if scene.rests:
        graph.graph["rests"] = sorted(scene.rests)
    for place, star in world.stars.items():
        signs = sorted(world.landmarks.get(place, ()))
        graph.add_node(place, gateways=sorted(star), landmarks=signs)
    steps = scene.steps()
    for number, (a, b) in enumerate(world.edges(), 1):
        there, back = steps.get(a, []), steps.get(b, [])
        graph.add_edge(a[0], b[0], number, ends=[list(a), list(b)], steps=there, back=back)
    return graph


def graphml(scene: Scene, laid: "Layout | None" = None) -> str:
    """The map as GraphML."""
    graph = _placed(scene, laid)
    every = [graph.graph, *graph.nodes.values(), *graph.edges.values()]
    for attributes in every:
        attributes.update({key: json.dumps(attributes[key]) for key in LISTS & set(attributes)})
    return "\n".join(nx.generate_graphml(graph, named_key_ids=True)) + "\n"


def node_link(scene: Scene, laid: "Layout | None" = None) -> str:
    """The map as node-link JSON."""
    return json.dumps(formats.headed(nx.node_link_data(_placed(scene, laid), edges="edges"))) + "\n"


def _drawing(scene: Scene, laid: "Layout") -> tuple[list[Node], list[Edge]]:
    """The map as ``draw`` draws it, in attributes of Graphviz, with lengths in points.

    The stub of a pending gateway ends in a node of its own. A link that crosses others is dashed.
    """
    world = scene.world
    steps = scene.steps()
    nodes: list[Node] = []
    edges: list[Edge] = []
    for place, point in laid.places.items():
        signs = ", ".join(sorted(world.landmarks.get(place, ())))
        nodes.append((place, {"pos": f"{_point(point)}!"} | ({"xlabel": signs} if signs else {})))
    crossing = [out for out, _ in laid.crossing]
    for a, b in world.edges():
        slots = {"taillabel": str(a[1]), "headlabel": str(b[1])}
        travelled = zip(("steps", "back"), (steps.get(a, ()), steps.get(b, ())), strict=True)
        told = slots | {key: " ".join(map(str, those)) for key, those in travelled if those}
        told |= {"style": "dashed"} if a in crossing else {}
        told["pos"] = _spline(laid.lines[a], 2)
        edges.append((a[0], b[0], told))
    for a in world.pending():
        nodes.append((a, {"pos": f"{_point(laid.lines[a][-1])}!", **STUB}))
        edges.append((a[0], a, {"taillabel": str(a[1]), "pos": _spline(laid.lines[a], 1)}))
    return nodes, edges


def _point(point: "Points") -> str:
    # Adding 0 turns -0 into 0.
    return ",".join(f"{round(float(number) * POINTS, 2) + 0:g}" for number in point)


def _spline(line: "Points", ends: int) -> str:
    """A line as a spline.

    Each of its sides is a piece of the spline, with control points at its thirds. It begins at the
    circle of a place, and ends at one if it has two ``ends``.
    """
    line = line.copy()
    for here, there in ((0, 1), (-1, -2))[:ends]:
        way = line[there] - line[here]
        line[here] += way * min(0.5, RADIUS / float((way @ way) ** 0.5))
    parts = (_point(a + (b - a) * k / 3) for a, b in pairwise(line) for k in (1, 2, 3))
    return " ".join([_point(line[0]), *parts])


def _label(scene: Scene, laid: "Layout") -> str:
    return f"{scene.title}{f', {laid.note}' * bool(laid.note)}"


def dot(scene: Scene, laid: "Layout") -> str:
    """The map in the language of Graphviz; ``neato -n2`` draws it as ``draw`` does."""

    def name(node: Place | Gateway) -> str:
        """The name of a node."""
        return f'"{gid(node)}"' if isinstance(node, tuple) else f'"{node}"'

    def told(attributes: dict[str, str]) -> str:
        """Attributes in the language of Graphviz."""
        quoted = ((k, escaped(v).replace('"', '\\"')) for k, v in attributes.items())
        return "[" + ", ".join(f'{key}="{value}"' for key, value in quoted) + "];"

    nodes, edges = _drawing(scene, laid)
    lines = [f"  graph {told({**COMMON['graph'], 'label': _label(scene, laid)})}"]
    lines.append(f"  node {told(COMMON['graph_nodes'])}")
    lines += [f"  {name(node)} {told(attributes)}" for node, attributes in nodes]
    lines += [f"  {name(a)} -- {name(b)} {told(attributes)}" for a, b, attributes in edges]
    return "\n".join(["graph topomap {", *lines, "}"]) + "\n"


def escaped(text: str) -> str:
    """Escape a text for Graphviz, where a backslash begins an escape."""
    return "\\n".join(printable(line).replace("\\", "\\\\") for line in text.split("\n"))


def clingraph(scene: Scene, laid: "Layout") -> str:
    """The map as facts of clingraph, for its default graph and the engine neato."""

    def told(kind: str, identifier: str, attributes: dict[str, str]) -> Iterator[str]:
        """The facts about the attributes of a node or an edge."""
        for key, value in attributes.items():
            # In clingraph a value with a variable, here the key, is not a template.
            string = clingo.String(escaped(value))
            yield f"attr({kind},{identifier},({key},value),{string})."

    nodes, edges = _drawing(scene, laid)
    facts = [*told("graph", "default", {**COMMON["graph"], "label": _label(scene, laid)})]
    facts += told("graph_nodes", "default", COMMON["graph_nodes"])
    for node, attributes in nodes:
        facts += [f"node({_term(node)}).", *told("node", _term(node), attributes)]
    for number, (a, b, attributes) in enumerate(edges, 1):
        edge = f"({_term(a)},{_term(b)},{number})"
        facts += [f"edge({edge}).", *told("edge", edge, attributes)]
    return "\n".join(facts) + "\n"


def _term(node: Place | Gateway) -> str:
    return f"({node[0]},{node[1]})" if isinstance(node, tuple) else str(node)


def tmap2(scene: Scene, laid: "Layout") -> str:
    """The map as a tmap2; a length of 1 in the drawing is taken for a metre."""
    world = scene.world
    points = _points(laid)
    stops = [
        Stop(str(place), points[place], sorted(star), sorted(world.landmarks.get(place, ())))
        for place, star in world.stars.items()
    ]
    legs = [Leg(str(a[0]), a[1], str(b[0]), b[1]) for a, b in sorted(world.links.items())]
    return tmap2_text(printable(scene.name), world.slots, 0.0, stops, legs)


DRAWN: dict[str, "Callable[[Scene, Layout], str]"] = {
    "dot": dot,
    "clingraph": clingraph,
    "graphml": graphml,
    "json": node_link,
    "tmap2": tmap2,
}
