"""Maps of Trizbort (XML), with which players draw the rooms of a text adventure.

A ``room`` has an ``id``, a ``name``, and a position on the paper, x to the right and y downwards. A
``line`` has its ``dock``s, by ``index``: the ``id`` of a room, and the ``port`` there, which is one
of sixteen directions of the compass. With ``flow="oneWay"`` it can be gone only from its first dock
to its last. A line may also end at a ``point`` of the paper: it leads nowhere yet, and is left out.
Lines that go up, down, in or out, as their labels say, and those without a port, are left out, too,
because they have no direction.
"""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

from topomap.model.topology import Place
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Exit, Plan, Point, Reading, Way
from topomap.worlds.readers.common import (
    demand_few,
    is_xml_with,
    name_of,
    number_of,
    numbered,
    shown,
)

PORTS = [
    "n",
    "nne",
    "ne",
    "ene",
    "e",
    "ese",
    "se",
    "sse",
    "s",
    "ssw",
    "sw",
    "wsw",
    "w",
    "wnw",
    "nw",
    "nnw",
]  # clockwise
NO_DIRECTION = re.compile(r"(in|out|u|d)|.*\b(up|down)\b.*", re.DOTALL)  # labels of lines
NAMED = 10  # the largest number of lines in a warning


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is a map of Trizbort."""
    return is_xml_with(content, b"trizbort")


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan in a map of Trizbort.

    Raises:
        InputError: The file has a fault.
    """
    root = _root(file, content)
    found = root.find("map")
    rooms: dict[str, Element] = {}
    for room in () if found is None else found.iter("room"):
        name = name_of(file, "a room", room.get("id", ""))
        if not name or name in rooms:
            said = "has no id" if not name else f"{shown(name)}: its id occurs twice"
            raise InputError(f"{file}: a room {said}")
        rooms[name] = room
    demand_few(file, len(rooms))
    places = numbered(rooms)
    titles = {
        name: name_of(file, f"room {shown(name)}", room.get("name", ""))
        for name, room in rooms.items()
    }
    points = {places[name]: _centre(file, name, room) for name, room in rooms.items()}
    ways: list[Way] = []
    dangling: list[str] = []
    without: list[str] = []
    loops: list[str] = []
    for line in () if found is None else found.iter("line"):
        what = f"line {shown(line.get('id', '?'))}"
        ends = _ends(file, what, line)
        if len(ends) < 2 or not all(end.tag == "dock" and end.get("id") in rooms for end in ends):
            dangling.append(what)
            continue
        ids = [end.get("id", "") for end in ends]
        titled = " to ".join(shown(titles[name] or name) for name in ids)
        labels = {line.get(key, "").strip().lower() for key in ("startText", "endText")}
        ports = [end.get("port", "").strip().lower() for end in ends]
        if any(map(NO_DIRECTION.fullmatch, labels)) or not all(ports):
            without.append(titled)
        elif ids[0] == ids[1] and not reading.loops:
            loops.append(titled)
        else:
            one, other = (_exit(file, what, places[i], p) for i, p in zip(ids, ports, strict=True))
            (x, y), (to_x, to_y) = points[one.place], points[other.place]
            one_way = line.get("flow", "").lower() == "oneway"
            ways.append(Way((one, other), (to_x - x, to_y - y), None, one_way))
    ways, again = _once(ways)
    used = {end.place for way in ways for end in way.ends}
    lone = [name for name in rooms if places[name] not in used]
    told = [
        f"{file}: {what} left out: {len(lines)}{named}"
        for what, lines, named in (
            ("lines that lead nowhere", dangling, ""),
            ("lines up, down, in, out or without a port", without, _named(without)),
            ("loops", loops, _named(loops)),
            ("second lines between the same two ports", again, ""),
            ("rooms without a way", lone, _named(titles[name] or name for name in lone)),
        )
        if lines
    ]
    called = {places[name]: title or name for name, title in titles.items()}
    _demand_apart(file, ways, called)
    return Plan(
        Path(file).stem,
        tuple(ways),
        {place: point for place, point in points.items() if place in used},
        names={places[name]: title for name, title in titles.items() if places[name] in used},
        slots=len(PORTS),
        notes=("coordinates: the paper of a Trizbort map",),
        told=tuple(told),
    )


def _root(file: str, content: bytes) -> Element:
    try:
        root: Element = fromstring(content, forbid_dtd=True)
    except DefusedXmlException:
        raise InputError(
            f"{file}: it declares a document type or entities, which is refused"
        ) from None
    except ParseError as error:
        line = error.position[0]
        raise InputError(f"{file}:{line}: not whole XML: {str(error).split(':')[0]}") from None
    except (ValueError, LookupError):
        raise InputError(f"{file}: not XML in an encoding that is known") from None
    if root.tag != "trizbort":
        raise InputError(f"{file}: not a map of Trizbort: its root is {shown(root.tag)}")
    return root


def _ends(file: str, what: str, line: Element) -> list[Element]:
    """The first and the last end of a line, by their index."""
    ends = []
    for number, end in enumerate(line):
        if end.tag in ("dock", "point"):
            index = number_of(end.get("index", str(number)))
            if index is None:
                raise InputError(f"{file}: {what}: the index of one of its ends is not a number")
            ends.append((index, number, end))
    ends.sort(key=lambda one: one[:2])
    return [end for _, _, end in ends[:1] + ends[1:][-1:]]


def _exit(file: str, what: str, place: Place, port: str) -> Exit:
    if port not in PORTS:
        raise InputError(f"{file}: {what}: port {shown(port)} is not one of {', '.join(PORTS)}")
    return Exit(place, 360 * PORTS.index(port) / len(PORTS))


def _centre(file: str, name: str, room: Element) -> Point:
    """The middle of a room, east and north."""
    told = [
        number_of(room.get(key, usual))
        for key, usual in (("x", ""), ("y", ""), ("w", "0"), ("h", "0"))
    ]
    x, y, w, h = told
    if x is None or y is None or w is None or h is None:
        raise InputError(f"{file}: room {shown(name)}: its x, y, w and h are not finite numbers")
    return x + w / 2, -(y + h / 2)


def _once(ways: Iterable[Way]) -> tuple[list[Way], list[Way]]:
    """Take lines between the same two ports as one way.

    It can be gone both ways if one of the lines can, or if two of them lead in opposite directions.

    Returns:
        The ways, and the lines that are left out.
    """
    known: dict[tuple[Exit, ...], Way] = {}
    again = []
    for way in ways:
        key = tuple(sorted(way.ends))
        if key not in known:
            known[key] = way
            continue
        again.append(way)
        one_way = known[key].one_way and way.one_way and known[key].ends == way.ends
        both = way if not way.one_way else known[key]
        known[key] = both._replace(one_way=one_way)
    return [*known.values()], again


def _demand_apart(file: str, ways: Iterable[Way], called: Mapping[Place, str]) -> None:
    """Check that no two lines end at one port of a room.

    Raises:
        InputError: Two lines do.
    """
    taken: dict[Exit, Place] = {}
    for way in ways:
        for end, other in (way.ends, way.ends[::-1]):
            if end in taken:
                port = PORTS[round(end.bearing * len(PORTS) / 360)]
                room, one, two = (shown(called[p]) for p in (end.place, taken[end], other.place))
                raise InputError(
                    f"{file}: room {room}: two lines end at its port {port}, to {one} and {two}"
                )
            taken[end] = other.place


def _named(names: Iterable[str]) -> str:
    listed = [*names]
    more = len(listed) - NAMED
    return f" ({', '.join(listed[:NAMED])}{f' and {more} more' if more > 0 else ''})"
