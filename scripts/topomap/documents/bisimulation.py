"""A checker of bisimulations: proofs that no further walk tells two maps apart.

It works from the definition, and shares nothing with what finds them.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

Place = Any
DState = tuple[Place, int]
Where = tuple[Place | None, Place | None]  # where the marker lies in each map, if it does
Pair = tuple[DState, DState, Where]


@dataclass(frozen=True)
class Chart:
    """A map as plain data: the gateways and landmarks of each place, the gateway at the other
    end of each link, where the agent stands, and the place where the marker lies, if it is
    out; with a compass, the compass slot to which slot 0 of each place points; and if it is told
    which gateways are on one path, the other one of each that is not the end of its path."""

    slots: int
    gateways: Mapping[Place, Collection[int]]
    links: Mapping[DState, DState]
    dstate: DState
    landmarks: Mapping[Place, Collection[str]] = field(default_factory=dict)
    marker: Place | None = None
    compass: Mapping[Place, int] = field(default_factory=dict)
    across: Mapping[DState, DState] | None = None


def faults(one: Chart, other: Chart, related: Collection[Pair], marker: bool) -> Iterator[str]:
    """What is wrong with a relation, if it is to prove that no walk tells the maps apart by what
    both predict; with ``marker``, the agent carries one that it may drop once.

    The dstates where the agent stands are related. Whatever are related look the same, and to
    each turn there the dstates that it leads to are related, if it leads on in both maps."""
    pairs = set(related)
    start = one.dstate, other.dstate, (one.marker, other.marker)
    if one.slots != other.slots:
        yield "the maps differ in slots"
        return
    if start not in pairs:
        yield "where the agent stands is not related"
    for pair in pairs:
        (place, slot), (image, at), where = pair
        if slot not in one.gateways.get(place, ()) or at not in other.gateways.get(image, ()):
            yield f"{_words(pair)}: no such gateways"
            continue
        if _look(one, pair[0], where[0]) != _look(other, pair[1], where[1]):
            yield f"{_words(pair)}: they do not look the same"
        for end, image_end in _ways(one, other, pair):
            if (end, image_end, where) not in pairs:
                yield f"{_words(pair)}: a way leads to dstates that are not related"
        carried = marker and start[2] == (None, None) and where == (None, None)
        if carried and (*pair[:2], (place, image)) not in pairs:
            yield f"{_words(pair)}: the marker may be put down there"


def pending(one: Chart, other: Chart, related: Collection[Pair]) -> tuple[set[DState], set[DState]]:
    """The pending gateways that a relation comes to, of each map."""
    found: tuple[set[DState], set[DState]] = (set(), set())
    for pair in related:
        for chart, (place, _), gateways in zip((one, other), pair[:2], found, strict=True):
            gateways.update(
                (place, slot) for slot in chart.gateways[place] if (place, slot) not in chart.links
            )
    return found


def _look(chart: Chart, dstate: DState, marker: Place | None) -> tuple[Any, ...]:
    """What is seen at a dstate: gateways clockwise of it, landmarks, whether the marker, where it
    points by the compass, and which gateways are on one path."""
    place, slot = dstate
    gateways = {(other - slot) % chart.slots for other in chart.gateways[place]}
    north = (slot + chart.compass[place]) % chart.slots if place in chart.compass else None
    pairs = {
        ((one - slot) % chart.slots, (chart.across[place, one][1] - slot) % chart.slots)
        for one in chart.gateways[place]
        if chart.across and (place, one) in chart.across
    }
    return gateways, set(chart.landmarks.get(place, ())), marker == place, north, pairs


def _ways(one: Chart, other: Chart, pair: Pair) -> Iterator[tuple[DState, DState]]:
    """Where each turn leads that can be taken in both maps."""
    (place, slot), (image, at), _ = pair
    for out in one.gateways[place]:
        way = image, (out - slot + at) % one.slots
        if (place, out) in one.links and way in other.links:
            yield one.links[place, out], other.links[way]


def _words(pair: Pair) -> str:
    (place, slot), (image, at), _ = pair
    return f"{place}.{slot} and {image}.{at}"
