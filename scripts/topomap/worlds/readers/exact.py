"""Worlds whose links name their gateways.

These are the graphs that topomap writes, and what other readers make of slots that a file tells.
Such a graph says how many ``slots`` there are, and may say where slot 0 points (``north``). Each
edge has its ``ends``, two gateways ``[P,S]``, and may have a ``move``, which is how far it leads
from the first of them to the second, east and north. A node may have its ``gateways``,
``landmarks``, a ``name``, and coordinates ``x`` and ``y``. The graph may have ``straight``, the
pairs of gateways that are on one path: ``[[P,S,R], ...]``. Lists are JSON texts in a format that
has no lists.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from topomap.model.facts import slots_fault
from topomap.model.topology import Gateway, Place
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Exit, Plan, Point, Way
from topomap.worlds.readers.common import (
    demand_few,
    landmarks_of,
    name_of,
    number_of,
    numbered,
    shown,
)


class Link(NamedTuple):
    """A link, and how far it leads from its first gateway to its second, if that is known."""

    one: Gateway
    other: Gateway
    move: Point | None = None


def fits(graph: "nx.Graph[Any]") -> bool:
    """Tell whether the links of a graph name their gateways."""
    edges = graph.edges(data=True)
    return "slots" in graph.graph and all("ends" in data for _, _, data in edges)


def plan_of(file: str, graph: "nx.Graph[Any]") -> Plan:
    """Make the plan of such a graph.

    Raises:
        InputError: The graph has a fault.
    """
    demand_few(file, len(graph))
    names = {node: name_of(file, f"place {shown(node)}", node) for node in graph}
    places = numbered({*names.values()})
    slots, north = _head(file, graph.graph)
    links = []
    for number, (a, b, data) in enumerate(graph.edges(data=True), 1):
        what = f"link {number}, {shown(a)} to {shown(b)}"
        try:
            (p, s), (q, r) = _list(data["ends"])
            ends = (places[str(p)], _slot(s)), (places[str(q)], _slot(r))
            fit = {str(p), str(q)} == {names[a], names[b]}
        except (ValueError, TypeError, KeyError, RecursionError):
            fit = False
        if not fit:
            raise InputError(f"{file}: {what}: its ends are not two gateways [P,S] of these places")
        links.append(Link(*ends, _move(file, what, data.get("move"))))
    points, landmarks, called, pending = {}, {}, {}, 0
    linked = {end for link in links for end in link[:2]}
    for node, data in graph.nodes(data=True):
        place, what = places[names[node]], f"place {shown(node)}"
        x, y = number_of(data.get("x")), number_of(data.get("y"))
        if x is not None and y is not None:
            points[place] = (x, y)
        if "landmarks" in data:
            landmarks[place] = landmarks_of(file, what, _list_or_none(data["landmarks"]))
        if "name" in data:
            called[place] = name_of(file, what, data["name"])
        gateways = _list_or_none(data.get("gateways", [])) or []
        if not all(isinstance(slot, int) for slot in gateways):
            raise InputError(f"{file}: {what}: its gateways are not a list of slots")
        pending += sum((place, slot) not in linked for slot in gateways)
    straight = None
    if "straight" in graph.graph:
        try:
            told = [
                (places[str(p)], _slot(s), _slot(r)) for p, s, r in _list(graph.graph["straight"])
            ]
        except (ValueError, TypeError, KeyError, RecursionError):
            raise InputError(f"{file}: straight is not a list of places with two slots") from None
        straight = [((place, one), (place, other)) for place, one, other in told]
    return plan(
        file,
        slots,
        north,
        links,
        straight,
        points=points,
        landmarks=landmarks,
        names=called,
        pending=pending,
    )


def plan(
    file: str,
    slots: int,
    north: float,
    links: Sequence[Link],
    straight: Sequence[tuple[Gateway, Gateway]] | None = None,
    *,
    points: Mapping[Place, Point] | None = None,
    landmarks: Mapping[Place, frozenset[str]] | None = None,
    names: Mapping[Place, str] | None = None,
    pending: int = 0,
    told: Sequence[str] = (),
) -> Plan:
    """Make the plan of links whose slots are known.

    ``pending`` gateways have no link, and are left out.

    Raises:
        InputError: A gateway has two links, or is not a gateway.
    """
    ends: dict[Gateway, Gateway] = {}
    for link in links:
        for (place, slot), other in (link[:2], (link.other, link.one)):
            name = f"place {shown(place)}"
            if not 0 <= slot < slots:
                raise InputError(f"{file}: {name}: slot {slot} is not in 0..{slots - 1}")
            if (place, slot) == other:
                raise InputError(f"{file}: {name}: gateway {slot} is linked to itself")
            if (place, slot) in ends:
                raise InputError(f"{file}: {name}: gateway {slot} has two links")
        ends[link.one], ends[link.other] = link.other, link.one
    if pending and not links:
        raise InputError(f"{file}: all its gateways are pending, so it has no link to explore")
    warnings = [f"{file}: pending gateways left out: {pending}"] if pending else []
    if straight is not None:
        told_once: set[Gateway] = set()
        for pair in straight:
            for place, slot in pair:
                what = f"{file}: place {shown(place)}: straight: gateway {slot}"
                if (place, slot) not in ends:
                    raise InputError(f"{what} has no link")
                if (place, slot) in told_once or pair[0] == pair[1]:
                    raise InputError(f"{what} is in more than one pair")
            told_once.update(pair)

    def leave(gateway: Gateway) -> Exit:
        """The exit of a gateway."""
        return Exit(gateway[0], (north + 360 * gateway[1] / slots) % 360)

    return Plan(
        Path(file).stem,
        tuple(Way((leave(link.one), leave(link.other)), link.move) for link in links),
        points=dict(points or {}),
        landmarks=dict(landmarks or {}),
        names=dict(names or {}),
        slots=slots,
        north=north,
        straight=None
        if straight is None
        else tuple((leave(one), leave(other)) for one, other in straight),
        told=(*told, *warnings),
    )


def demand_slots(file: str, told: object) -> int:
    """Read a number of slots.

    Raises:
        InputError: It is not a number of slots.
    """
    try:
        slots = _slot(told)
    except ValueError:
        raise InputError(f"{file}: slots is not a whole number") from None
    if fault := slots_fault(slots):
        raise InputError(f"{file}: {fault}")
    return slots


def _head(file: str, told: Mapping[str, Any]) -> tuple[int, float]:
    north = number_of(told.get("north", 0))
    if north is None:
        raise InputError(f"{file}: north is not a number of degrees")
    return demand_slots(file, told["slots"]), north


def _slot(told: object) -> int:
    number = number_of(told)
    if number is None or number != int(number):
        raise ValueError("a slot is a whole number")
    return int(number)


def _list(told: object) -> Any:
    return json.loads(told) if isinstance(told, str) else told


def _list_or_none(told: object) -> Any:
    try:
        made = _list(told)
    except (ValueError, RecursionError):
        return None
    return made if isinstance(made, list) else None


def _move(file: str, what: str, told: object) -> Point | None:
    if told is None:
        return None
    move = _list_or_none(told)
    numbers = [number_of(number) for number in move] if move is not None else []
    if len(numbers) != 2 or numbers[0] is None or numbers[1] is None:
        raise InputError(f"{file}: {what}: its move is not two numbers")
    return numbers[0], numbers[1]
