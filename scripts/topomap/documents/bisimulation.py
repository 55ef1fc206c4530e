"""A checker of bisimulations, which prove that no further walk tells two maps apart.

It works from the definition, and shares no code with what finds them.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

Place = Any
DState = tuple[Place, int]
Where = tuple[Place | None, Place | None]  # where the marker lies in each map, or None
Pair = tuple[DState, DState, Where]


@dataclass(frozen=True)
class Chart:
    """A map as plain data.

    It has the gateways and landmarks of each place, the gateway at the other end of each link, the
    dstate of the agent, and the place of the marker, if it lies somewhere. With a compass it has
    the compass slot to which slot 0 of each place points. If it is known which gateways are on one
    path, it has for each gateway the other one on its path, unless its path ends there.
    """

    slots: int
    gateways: Mapping[Place, Collection[int]]
    links: Mapping[DState, DState]
    dstate: DState
    landmarks: Mapping[Place, Collection[str]] = field(default_factory=dict)
    marker: Place | None = None
    compass: Mapping[Place, int] = field(default_factory=dict)
    across: Mapping[DState, DState] | None = None


def faults(one: Chart, other: Chart, related: Collection[Pair], marker: bool) -> Iterator[str]:
    """Find what is wrong with a relation that should be a bisimulation.

    The dstates of the agent must be related. Related dstates must look the same; and for each turn
    that leads on in both maps, the dstates to which it leads must be related. With ``marker``, the
    agent carries a marker that it may put down once.
    """
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
    """The pending gateways of each map at which a relation arrives."""
    found: tuple[set[DState], set[DState]] = (set(), set())
    for pair in related:
        for chart, (place, _), gateways in zip((one, other), pair[:2], found, strict=True):
            gateways.update(
                (place, slot) for slot in chart.gateways[place] if (place, slot) not in chart.links
            )
    return found


def _look(chart: Chart, dstate: DState, marker: Place | None) -> tuple[Any, ...]:
    """What is seen at a dstate.

    It has the gateways clockwise, the landmarks, whether the marker is there, the direction by the
    compass, and the pairs of gateways on one path.
    """
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
    """The pairs of dstates to which the turns lead that are possible in both maps."""
    (place, slot), (image, at), _ = pair
    for out in one.gateways[place]:
        way = image, (out - slot + at) % one.slots
        if (place, out) in one.links and way in other.links:
            yield one.links[place, out], other.links[way]


def _words(pair: Pair) -> str:
    (place, slot), (image, at), _ = pair
    return f"{place}.{slot} and {image}.{at}"
