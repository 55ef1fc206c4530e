"""Worlds as files: GraphML, node-link JSON and tmap2, which ``worlds/readers`` reads back."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from topomap.exchange.robots import Edge, Node, tmap2_text
from topomap.model.topology import Gateway, Place, label
from topomap.runtime import formats, nx
from topomap.runtime.errors import InputError, printable
from topomap.worlds.environment import Environment
from topomap.worlds.plan import Point

LISTS = ("ends", "move", "landmarks", "straight")
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def world_text(environment: Environment, form: str) -> str:
    """Write a world as the text of a file.

    The world that is read back has the same slots, links, landmarks and moves, and the same places
    by their labels. If a world has no points, its moves tell where places are.

    Parameters:
        environment: The world.
        form: ``graphml``, ``json`` (node-link) or ``tmap2``.

    Returns:
        The text.

    Raises:
        InputError: A name cannot be written in this format, two places have one label, or it is not
            known where a place of a tmap2 is. One line.
        ValueError: ``form`` is another one.
    """
    if form not in WRITERS:
        raise ValueError(f"{form!r} is not one of {', '.join(WRITERS)}")
    labels = [label(place) for place in environment.map.stars]
    if len({*labels}) < len(labels):
        raise InputError(f"{environment.name}: two places have one label")
    if not environment.points:
        environment = replace(environment, points=points_of(environment))
    return WRITERS[form](environment)


FORMS = {".graphml": "graphml", ".json": "json", ".yaml": "tmap2", ".yml": "tmap2"}


def form_of(file: str | Path) -> str:
    """Tell the format of a file to write by the ending of its name.

    Raises:
        InputError: The ending is not known.
    """
    end = Path(file).suffix.lower()
    if end not in FORMS:
        raise InputError(f"{file}: a file with a world ends in {', '.join(FORMS)}")
    return FORMS[end]


def points_of(environment: Environment) -> dict[Place, Point]:
    """Find out where places are, as far as the moves tell it.

    In each component, positions are counted from the first place, along the ways by which a place
    is first reached. If the world is not flat, as a torus is not, other ways may lead elsewhere.
    """
    where: dict[Place, Point] = {}
    moves, links = environment.moves, environment.map.links
    if not moves:
        return where
    for start in environment.map.stars:
        if start in where:
            continue
        where[start] = (0.0, 0.0)
        for place in (waiting := [start]):
            x, y = where[place]
            for slot in sorted(environment.map.stars[place]):
                out = place, slot
                if out in links and out in moves and links[out][0] not in where:
                    there = links[out][0]
                    where[there] = (x + moves[out][0], y + moves[out][1])
                    waiting.append(there)
    return where


def _straight(environment: Environment) -> list[tuple[str, int, int]] | None:
    """The pairs of gateways on one path, if they are known."""
    across = environment.map.across
    if across is None:
        return None
    return [(label(one[0]), one[1], other[1]) for one, other in across.items() if one < other]


def _move(environment: Environment, out: Gateway) -> tuple[float, float] | None:
    move = environment.moves.get(out)
    return None if move is None else (move[0] + 0.0, move[1] + 0.0)  # -0 becomes 0


def _graph(environment: Environment) -> "nx.MultiGraph[str]":
    world, points, names = environment.map, environment.points, environment.names
    graph: nx.MultiGraph[str] = nx.MultiGraph()
    graph.graph.update(name=printable(environment.name), slots=world.slots)
    graph.graph["north"] = float(environment.north)
    if (straight := _straight(environment)) is not None:
        graph.graph["straight"] = straight
    for place in world.stars:
        about: dict[str, Any] = {"landmarks": sorted(world.landmarks.get(place, ()))}
        about |= {"name": names[place]} if place in names else {}
        if place in points:
            about |= {"x": float(points[place][0]), "y": float(points[place][1])}
        graph.add_node(label(place), **about)
    for a, b in world.edges():
        one, other = label(a[0]), label(b[0])
        move = _move(environment, a)
        told: dict[str, Any] = {} if move is None else {"move": [*move]}
        graph.add_edge(one, other, None, ends=[[one, a[1]], [other, b[1]]], **told)
    return graph


def _graphml(environment: Environment) -> str:
    graph = _graph(environment)
    for text in (*graph, *environment.names.values()):
        if _NO_XML.search(text):
            raise InputError(f"{environment.name}: XML cannot hold the name {printable(text)}")
    for attributes in (graph.graph, *graph.nodes.values(), *graph.edges.values()):
        attributes.update({k: json.dumps(attributes[k]) for k in LISTS if k in attributes})
    return "\n".join(nx.generate_graphml(graph, named_key_ids=True)) + "\n"


def _node_link(environment: Environment) -> str:
    graph = _graph(environment)
    return json.dumps(formats.headed(nx.node_link_data(graph, edges="edges"))) + "\n"


def _tmap2(environment: Environment) -> str:
    world, points = environment.map, environment.points
    if lost := [place for place in world.stars if place not in points]:
        name = printable(label(lost[0]))
        raise InputError(f"{environment.name}: the position of place {name} is not known")
    nodes = [
        Node(
            label(place),
            points[place],
            sorted(star),
            sorted(world.landmarks.get(place, ())),
            environment.names.get(place),
        )
        for place, star in world.stars.items()
    ]
    edges = [
        Edge(label(a[0]), a[1], label(b[0]), b[1], _move(environment, a))
        for a, b in sorted(world.links.items())
    ]
    straight = _straight(environment)
    return tmap2_text(
        printable(environment.name), world.slots, float(environment.north), nodes, edges, straight
    )


WRITERS: dict[str, Callable[[Environment], str]] = {
    "graphml": _graphml,
    "json": _node_link,
    "tmap2": _tmap2,
}
