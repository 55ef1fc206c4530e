"""Maps from other tools: the GraphML and the JSON (node-link) that ``exports`` writes."""

import json
from typing import Any

from topomap.documents import maps
from topomap.documents.answers import map_json
from topomap.drawing.scenes import of_document
from topomap.exchange.exports import LISTS, graph_of
from topomap.model.found import BEST
from topomap.runtime import formats, nx
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_bytes
from topomap.worlds.readers.graphml import read_graphml


def import_map(file: str) -> str:
    """Read a map from a file of GraphML or node-link JSON.

    Returns:
        What ``solve --json`` writes of the map.

    Raises:
        InputError: There is no map in it as ``export`` writes it. One line.
    """
    content = read_bytes(file)
    if content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<":
        graph = read_graphml(file, content, int)
    else:
        try:
            told = json.loads(content)
            formats.demand(file, told)
            graph = nx.node_link_graph(told, edges="edges")
        except (MemoryError, InputError):
            raise
        except Exception:  # networkx raises all kinds of errors on bad files
            raise InputError(f"{file}: not a graph in JSON that networkx reads") from None
    return _document(file, graph)


def _document(file: str, graph: "nx.Graph[Any]") -> str:
    given = graph.graph
    if graph.is_directed() or not isinstance(given, dict) or not {"slots", "at"} <= set(given):
        raise InputError(
            f"{file}: not a map, as topomap export writes it: no slots, or no route at"
        )
    try:
        for attributes in (given, *graph.nodes.values(), *graph.edges.values()):
            for key in LISTS & set(attributes):
                if isinstance(attributes[key], str):
                    attributes[key] = json.loads(attributes[key])
    except (ValueError, RecursionError):
        raise InputError(f"{file}: {key} is not a list, as topomap export writes it") from None
    kind = given.get("kind") if given.get("kind") in maps.KINDS else None
    entry = {
        "at": given["at"],
        "places": [{**attributes, "place": place} for place, attributes in graph.nodes.items()],
        "links": [attributes.get("ends") for attributes in graph.edges.values()],
    }
    claims = {
        "instance": given.get("name"),
        "slots": given["slots"],
        "parts": [],
        "bound": None,
        "optimal": kind in BEST,
    }
    if "rests" in given:
        claims["rests"] = given["rests"]
    (scene,) = of_document(maps.document(file, {**claims, "maps": [entry], "kind": kind}))
    if not scene.at:
        raise InputError(f"{file}: no route in it")
    try:
        same = _told(graph) == _told(graph_of(scene))
    except RecursionError:
        same = False
    if not same:
        raise InputError(f"{file}: gateways, landmarks, steps or genus do not fit the links and at")
    claims["horizon"] = len(scene.at) - 1
    # There may be other maps of that kind.
    made = {**claims, "maps": [map_json(scene.world, scene.at)], "kind": kind, "count": 1}
    return formats.line(made, "a single map, imported")


def _told(graph: "nx.Graph[Any]") -> str:
    """What a graph says of a map; attributes that other tools have added are passed over."""
    whole = [graph.graph.get(key) for key in ("slots", "genus", "at", "rests")]
    places = [
        [place, *(attributes.get(key) for key in ("gateways", "landmarks"))]
        for place, attributes in graph.nodes.items()
    ]
    links = [
        [sorted([a, b], key=str), *(attributes.get(key) for key in ("ends", "steps", "back"))]
        for a, b, attributes in graph.edges(data=True)
    ]
    return json.dumps([whole, places, sorted(links, key=str)])
