"""Maps in topomap's own JSON, as ``topomap solve --json`` writes them (docs/formats.md).

The linked part of a map becomes a world with its slots, its landmarks, and the pairs of gateways on
one path. Each place counts its slots from a gateway of its own, so a compass has no meaning in such
a world.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from topomap.model.topology import Gateway
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.limits import LARGEST
from topomap.worlds.plan import Plan, Reading
from topomap.worlds.readers import exact
from topomap.worlds.readers.common import (
    demand_few,
    demand_json,
    json_of,
    landmarks_of,
    looks_like_json,
)

Pairs = list[tuple[Gateway, Gateway]]


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is JSON with maps in it."""
    if not looks_like_json(content):
        return False
    told = json_of(content)
    if isinstance(told, InputError):
        return b'"maps"' in content or (b'"at"' in content and b'"gateways"' in content)
    if isinstance(told, list):
        return bool(told) and isinstance(told[0], dict) and "at" in told[0]
    return isinstance(told, dict) and bool({"maps", "results", "at"} & told.keys())


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan of the map in a file, which is the first one if there are several.

    Raises:
        InputError: The file has a fault.
    """
    told = demand_json(file, content)
    formats.demand(file, told)
    results = told.get("results") if isinstance(told, dict) and "results" in told else [told]
    if not isinstance(results, list) or not results or not isinstance(results[0], dict | list):
        raise InputError(f"{file}: results: not a list of answers")
    first = results[0]
    formats.demand(file, first)
    if isinstance(first, list) or "maps" not in first:
        raise InputError(f"{file}: no number of slots in it, as topomap solve --json writes it")
    maps = first["maps"]
    if not isinstance(maps, list) or not maps or not isinstance(maps[0], dict):
        raise InputError(f"{file}: no maps in it")
    if "slots" not in first or not {"places", "links"} <= maps[0].keys():
        wanted = "slots, places and links are wanted, as topomap solve --json writes them"
        raise InputError(f"{file}: map 1: {wanted}")
    warnings = []
    if len(results) > 1:
        warnings.append(f"{file}: the answer of the first of {len(results)} instances is taken")
    if len(maps) > 1:
        warnings.append(f"{file}: the first of {len(maps)} maps is taken")
    return _plan(file, exact.demand_slots(file, first["slots"]), maps[0], warnings)


def _plan(file: str, slots: int, entry: Mapping[str, Any], warnings: Sequence[str]) -> Plan:
    stars: dict[int, list[int]] = {}
    landmarks = {}
    try:
        demand_few(file, len(entry["places"]))
        for told in entry["places"]:
            place = _whole(told["place"])
            if place in stars:
                raise InputError(f"{file}: map 1: place {place} occurs twice")
            stars[place] = [_whole(slot) for slot in told["gateways"]]
            signs = landmarks_of(file, f"place {place}", told.get("landmarks", []))
            landmarks[place] = signs
        pairs = [tuple((_whole(p), _whole(s)) for p, s in link) for link in entry["links"]]
        links = [exact.Link(one, other) for one, other in pairs]
    except (LookupError, TypeError, ValueError, AttributeError):
        raise InputError(
            f"{file}: map 1: places or links are not as topomap solve --json writes them"
        ) from None
    ends = {one: other for link in links for one, other in (link[:2], (link.other, link.one))}
    for place, slot in ends:
        if slot not in stars.get(place, ()):
            raise InputError(
                f"{file}: map 1: place {place} has no gateway {slot}, but a link there"
            )
    pending = sum((place, slot) not in ends for place, star in stars.items() for slot in star)
    straight = None
    if "paths" in entry:
        try:
            paths = [[(_whole(p), _whole(s)) for p, s in path] for path in entry["paths"]]
            straight = _straight(paths, ends, slots)
        except (LookupError, TypeError, ValueError):
            raise InputError(f"{file}: map 1: its paths do not go along its links") from None
        if {frozenset(pair) for pair in straight} == {
            frozenset((out, _opposite(out, slots))) for out in ends if _opposite(out, slots) in ends
        }:
            straight = None
    lone = [place for place in stars if not any((place, slot) in ends for slot in stars[place])]
    told_all = [*warnings, *([f"{file}: places without a link left out: {len(lone)}"] * bool(lone))]
    return exact.plan(
        file, slots, 0.0, links, straight, landmarks=landmarks, pending=pending, told=told_all
    )


def _whole(told: object) -> int:
    if not isinstance(told, int) or isinstance(told, bool) or abs(told) > LARGEST:
        raise ValueError("a whole number is wanted")
    return told


def _opposite(gateway: Gateway, slots: int) -> Gateway:
    return gateway[0], (gateway[1] + slots // 2) % slots


def _straight(
    paths: Sequence[Sequence[Gateway]], ends: Mapping[Gateway, Gateway], slots: int
) -> Pairs:
    """Find the pairs of linked gateways that are on one path, from the headings of the paths.

    A heading that is not the last one is a gateway. It is on one path with the gateway by which one
    arrives from the heading before. The last heading is pending, or is a direction without a
    gateway of this path, unless the path is circular: then it is linked to the first place. Another
    path may have a gateway in that direction, which is opposite to the gateway of arrival. But each
    gateway is on one path.

    Raises:
        ValueError: The headings do not follow the links, or can be read in two ways.
        LookupError: A gateway is not known.
    """
    used: Counter[Gateway] = Counter()
    pairs: Pairs = []
    # For each path: the gateway of arrival, the last heading, and the first one.
    circular: list[tuple[list[Gateway], Gateway, Gateway]] = []
    perhaps: list[tuple[list[Gateway], Gateway, Gateway]] = []
    for path in paths:
        through = [ends[heading] for heading in path[:-1]]
        if [arrival[0] for arrival in through] != [place for place, _ in path[1:]]:
            raise ValueError("no link from place to place")
        used.update([*path[:-1], *through])
        pairs += zip(through[:-1], path[1:-1], strict=True)
        last = path[-1]
        if last in ends and ends[last][0] == path[0][0]:
            bare = through and _opposite(through[-1], slots) == last
            (perhaps if bare else circular).append((through, last, path[0]))
    for _, last, _ in circular:
        used.update((last, ends[last]))
    more = [one for one in perhaps if not used[one[1]]]
    for _, last, _ in more:
        used.update((last, ends[last]))
    for through, last, first in circular + more:
        pairs.append((ends[last], first))
        pairs += [(through[-1], last)] if through else []
    if any(number > 1 for number in used.values()):
        raise ValueError("a gateway is on two paths")
    return pairs
