"""From a plan to a world: the slots of the exits, and which exits are on one path.

Slot 0 of K points ``north`` degrees clockwise of north, and each exit has the slot whose direction
is nearest to its bearing. No two exits of a place may have one slot.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

from topomap.model.experience import MOST_SLOTS
from topomap.model.topology import Gateway, Place, TopologicalMap, label
from topomap.runtime.errors import InputError
from topomap.worlds.plan import Exit, Plan, Point, Way

FEWEST, MOST = 4, 360  # numbers of slots to try; with four, straight on and a turn differ
SHOWN = 20  # the largest number of clashes that are listed
DIGITS = 9  # bearings and slots are rounded to so many digits, against errors of rounding


class Layout(NamedTuple):
    """A number of slots, and where slot 0 points, in degrees clockwise of north.

    It has the number of degrees by which the slots may be turned either way before two exits of a
    place share one. This is infinite if no two exits share one, however the slots are turned.
    """

    slots: int
    north: float
    margin: float

    def slot(self, bearing: float) -> int:
        """The slot whose direction is nearest to a bearing.

        If two are equally near, it is the one clockwise of the bearing.
        """
        slot = round((bearing - self.north) * self.slots / 360 + 0.5, DIGITS)
        return math.floor(slot) % self.slots


class Clash(NamedTuple):
    """Two exits of a place that share a slot, each with the place to which its way leads."""

    place: Place
    slot: int
    one: tuple[Place, float]
    other: tuple[Place, float]

    def text(self) -> str:
        """The clash in words."""
        (to, bearing), (other, also) = self.one, self.other
        return (
            f"place {label(self.place)}: the ways to {label(to)} ({bearing:.1f} degrees) and "
            f"{label(other)} ({also:.1f}) share slot {self.slot}"
        )


def exits_of(ways: Iterable[Way]) -> dict[Place, list[tuple[float, int, int]]]:
    """List the exits of each place, sorted.

    Each has its bearing, from 0 up to 360, the number of its way, and which of the two ends it is.
    """
    exits: dict[Place, list[tuple[float, int, int]]] = {}
    for number, way in enumerate(ways):
        for end, (place, bearing) in enumerate(way.ends):
            exits.setdefault(place, []).append((round(bearing, DIGITS) % 360, number, end))
    return {place: sorted(of) for place, of in sorted(exits.items())}


def layout(file: str, plan: Plan, slots: int | None = None, north: float | None = None) -> Layout:
    """Choose the fewest slots, and their best turn, so that no two exits of a place share one.

    Only what is not given is chosen. The best turn is in the middle of the largest range of such
    turns.

    Raises:
        InputError: No choice separates the exits. One line, which lists the clashes.
    """
    if slots is not None and (not 2 <= slots <= MOST_SLOTS or slots % 2):
        raise InputError(f"{file}: {slots} slots: they must be even, from 2 to {MOST_SLOTS}")
    if north is not None and not math.isfinite(north):
        raise InputError(f"{file}: north {north}: it must be a finite number of degrees")
    exits = exits_of(plan.ways)
    gaps = [gap for of in exits.values() for gap in _gaps(of)]
    if slots is None and plan.slots:
        slots, north = plan.slots, plan.north if north is None else north
    for many in range(FEWEST, MOST + 1, 2) if slots is None else [slots]:
        if slots is None and max(map(len, exits.values()), default=0) > many:
            continue
        turn, margin = (
            _best_turn(gaps, many) if north is None else (north, _margin(gaps, many, north))
        )
        at = Layout(many, turn, margin)
        # With a margin of 0, exits on the border of two slots may still clash.
        if margin >= 0 and not clashes(plan.ways, exits, at):
            return at
    most = Layout(MOST if slots is None else slots, north or 0.0, 0.0)
    found = clashes(plan.ways, exits, most)
    told = "; ".join(clash.text() for clash in found[:SHOWN])
    more = f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    turned = "however they are turned" if north is None else f"with slot 0 at {north:g} degrees"
    upto = f"up to {MOST}" if slots is None else str(slots)
    raise InputError(f"{file}: {upto} slots do not separate all ways, {turned}: {told}{more}")


def _gaps(exits: list[tuple[float, int, int]]) -> list[tuple[float, float]]:
    """The pairs of bearings of neighbouring exits of a place, clockwise."""
    if len(exits) < 2:
        return []
    bearings = [bearing for bearing, _, _ in exits]
    return [*pairwise(bearings), (bearings[-1], bearings[0] + 360)]


def _best_turn(gaps: list[tuple[float, float]], slots: int) -> tuple[float, float]:
    """The middle of the largest range of turns that separate all exits, and half its width.

    The width is negative if there is no such turn. Of the turns that differ by whole slots, the one
    nearest to north is taken.
    """
    width = 360 / slots
    # Between two bearings that are less than a slot apart there must be a border of slots. Borders
    # are half a slot from the directions of slots. So the turns that fail begin half a slot after
    # the second bearing, and end half a slot after the first one, by whole slots.
    bad = []
    for one, other in gaps:
        if other - one < width:
            begin = (other + width / 2) % width
            end = begin + width - (other - one)
            bad += [(begin, min(end, width))] + [(0.0, end - width)] * (end > width)
    if not bad:
        return 0.0, math.inf
    free, reached = [], 0.0
    for begin, end in sorted(bad):
        if begin > reached:
            free.append((reached, begin))
        reached = max(reached, end)
    if reached < width:
        free.append((reached, width))
    if len(free) > 1 and free[0][0] == 0 and free[-1][1] == width:
        free[-1] = (free[-1][0], width + free.pop(0)[1])
    begin, end = max(free, key=lambda part: part[1] - part[0], default=(0.0, -1.0))
    turn = (begin + end) / 2 % width
    turn -= width if turn > width / 2 else 0
    turn = round(turn, DIGITS) + 0.0  # -0 becomes 0
    return turn, min((end - begin) / 2, _margin(gaps, slots, turn))


def _margin(gaps: list[tuple[float, float]], slots: int, north: float) -> float:
    """By how many degrees slots may be turned either way before two exits share one.

    It is negative if two exits share one already.
    """
    width = 360 / slots
    margin = math.inf
    for one, other in gaps:
        if other - one >= width:
            continue
        border = math.floor((one - north) / width + 0.5) * width + width / 2 + north
        if not one < border <= other:
            return -1.0
        margin = min(margin, border - one, other - border)
    return margin


def clashes(
    ways: tuple[Way, ...], exits: Mapping[Place, list[tuple[float, int, int]]], at: Layout
) -> list[Clash]:
    """The pairs of exits of a place that share a slot."""
    found = []
    for place, of in exits.items():
        taken: dict[int, tuple[Place, float]] = {}
        for bearing, number, end in of:
            slot, there = at.slot(bearing), (ways[number].ends[1 - end].place, bearing)
            if slot in taken:
                found.append(Clash(place, slot, taken[slot], there))
            taken.setdefault(slot, there)
    return found


def links_of(ways: Iterable[Way], at: Layout) -> dict[Gateway, Gateway]:
    """The links of the ways, in both directions."""
    links: dict[Gateway, Gateway] = {}
    for way in ways:
        one, other = ((place, at.slot(bearing)) for place, bearing in way.ends)
        if one in links or other in links or one == other:
            raise RuntimeError("two exits share a slot")  # layout makes sure that none do
        links[one], links[other] = other, one
    return links


def across_of(ways: tuple[Way, ...], at: Layout, most: float) -> dict[Gateway, Gateway]:
    """Tell which exits of a place are on one path.

    Each exit belongs to the one most nearly opposite to it, if this is mutual, and if they are off
    from being opposite by at most so many degrees.
    """
    across: dict[Gateway, Gateway] = {}
    for place, of in exits_of(ways).items():
        best = {}
        for bearing, number, end in of:
            others = [one for one in of if one[1:] != (number, end)]
            off = [(_bend(bearing, one[0]), one[1:]) for one in others]
            if off and min(off)[0] <= most:
                best[number, end] = min(off)[1]
        for here, there in best.items():
            if best.get(there) == here:
                one, other = (
                    (place, at.slot(ways[number].ends[end].bearing))
                    for number, end in (here, there)
                )
                across[one] = other
    return across


def _bend(one: float, other: float) -> float:
    """By how many degrees two bearings are off from being opposite."""
    return abs((one - other) % 360 - 180)


def world_of(plan: Plan, at: Layout, straight: float | None = None) -> TopologicalMap:
    """Make the world of a plan.

    With ``straight``, exits are on one path as ``across_of`` finds it; otherwise as the plan says,
    or if they are opposite.
    """
    links = links_of(plan.ways, at)
    stars: dict[Place, set[int]] = {place: set() for place in sorted({p for p, _ in links})}
    for place, slot in links:
        stars[place].add(slot)
    return TopologicalMap(
        at.slots,
        {place: frozenset(star) for place, star in stars.items()},
        links,
        {place: terms for place, terms in plan.landmarks.items() if place in stars and terms},
        _pairs(plan, at) if straight is None else across_of(plan.ways, at, straight),
    )


def _pairs(plan: Plan, at: Layout) -> dict[Gateway, Gateway] | None:
    """The pairs of exits on one path, if the plan tells them."""
    if plan.straight is None:
        return None
    pairs = [[(end.place, at.slot(end.bearing)) for end in pair] for pair in plan.straight]
    return {out: other for one, two in pairs for out, other in ((one, two), (two, one))}


def shares(ends: Iterable[tuple[Place, Place]]) -> Callable[[Place, Place], float]:
    """Tell up to which share of a way between two places its direction may be measured.

    It is the middle of the way if there are several ways between the places, because these are
    apart in the middle, but meet at the other end. Otherwise it is the whole way.
    """
    many = Counter(frozenset(pair) for pair in ends)
    return lambda one, other: 0.5 if many[frozenset((one, other))] > 1 else 1.0


def exit_towards(place: Place, here: tuple[float, float], there: tuple[float, float]) -> Exit:
    """The exit of a place at a point, in the direction of another point of the plane."""
    return Exit(place, math.degrees(math.atan2(there[0] - here[0], there[1] - here[1])))


def point_along(course: Sequence[Point], far: float, share: float = 1.0) -> Point:
    """The point so far along a way, but at most at this share of its length.

    On a way back to the same place it is at most a third of the way.
    """
    long = sum(math.dist(*pair) for pair in pairwise(course))
    far = min(far, long * min(share, 1 / 3 if course[0] == course[-1] else 1.0))
    for one, other in pairwise(course):
        long = math.dist(one, other)
        if 0 < long >= far:
            share = far / long if far > 0 else 1.0  # 0: in the direction in which the way begins
            return one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])
        far -= long
    return course[-1]
