"""Where the places of a map are, if it is a map of a world whose places have positions.

The links tell which place of the world is which place of the map: each place is one of the world
with gateways in the same slots, each link is one of its links, and no two places are one. If the
map fits nowhere in the world, places are found by names: a landmark that only one place of the map
has, and that is the landmark or the name of only one place of the world.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from topomap.drawing.scenes import Where
from topomap.model.terms import spelt
from topomap.model.topology import Gateway, Place, TopologicalMap, label
from topomap.worlds.plan import Plan

ENOUGH = 3  # the least number of places found by name, between which the others are put
ROUNDS = 300  # the number of rounds in which the others are put there
WORK = 2_000_000  # the largest number of gateways that are examined
SEVERAL = 16  # so many ways to lay a map on a world are looked for
ALIKE = 0.05  # ways to lay a map are equally good if their ``_unlike`` differ by less


class Likeness(NamedTuple):
    """Where the places of a map are (None if that is not known), and what is said about it.

    ``laid`` tells whether the map is a part of the world.
    """

    where: Where | None
    note: str
    laid: bool = False


def likeness(
    world: TopologicalMap, real: TopologicalMap, plan: Plan, known: Where | None = None
) -> Likeness:
    """Find where the places of a map are, by the places of a real world and the plan of it.

    ``known`` tells where places are by what was measured. If the map can be laid on the world in
    several ways, the way that is most like ``known`` is taken.
    """
    if not all(place in plan.points for place in real.stars):
        return Likeness(None, "the world does not tell where its places are")
    names = _names(real, plan)
    named = _by_name(world, names)
    found: list[dict[Place, Place]] = []
    for same in (_same_slots, _same_order) if world.slots == real.slots else (_same_order,):
        found = list(_laid(world, real, same, named))
        if found:
            break
    if found:
        laid = [{place: plan.points[there] for place, there in one.items()} for one in found]
        unlike = [_unlike(one, known or {}) for one in laid]
        least = min(unlike)
        several = "it can be laid onto the world in several ways, of which this is one"
        many = sum(one < least + ALIKE for one in unlike) > 1
        return Likeness(laid[unlike.index(least)], several if many else "", laid=True)
    if len(named) >= ENOUGH:
        at = {place: plan.points[there] for place, there in named.items()}
        told = f"{len(named)} places are found by their names, and the others put between them"
        return Likeness(_between(world, at), f"it is not a part of the world: {told}")
    return Likeness(None, "it is not a part of the world, as its links tell, and names do not help")


def _unlike(where: Where, known: Where) -> float:
    """How far places are from where they were measured, as a share of the size.

    The measured points are moved and scaled so that they fit best, but are not turned. It is 0 if
    too little is known.
    """
    both = [place for place in where if place in known]
    if len(both) < 2:
        return 0.0
    one, other = (np.array([points[place] for place in both], float) for points in (known, where))
    one, other = one - one.mean(0), other - other.mean(0)
    size, norm = float((one**2).sum()), float(np.linalg.norm(other))
    if size == 0 or norm == 0:
        return 0.0
    scale = max(0.0, float((one * other).sum()) / size)
    return float(np.linalg.norm(scale * one - other)) / norm


def _names(real: TopologicalMap, plan: Plan) -> dict[str, Place]:
    """The places of a world, by names and landmarks that only one of them has."""
    called: list[tuple[str, Place]] = []
    for place in real.stars:
        terms = {*plan.landmarks.get(place, ())}
        for name in (plan.names.get(place), label(place)):
            if name:
                quoted = name.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
                terms.add(f'"{quoted}"')
                terms |= _term(name)
        called += [(term, place) for term in terms]
    times = Counter(term for term, _ in called)
    return {term: place for term, place in called if times[term] == 1}


def _term(name: str) -> set[str]:
    """A name as a term of clingo, if it is one."""
    try:
        return {spelt(name)}
    except ValueError:
        return set()


def _by_name(world: TopologicalMap, names: Mapping[str, Place]) -> dict[Place, Place]:
    """The place of the world for each place of the map, as far as landmarks tell it."""
    times = Counter(sign for signs in world.landmarks.values() for sign in signs)
    found: dict[Place, Place] = {}
    for place, signs in world.landmarks.items():
        there = {names[sign] for sign in signs if times[sign] == 1 and sign in names}
        if len(there) == 1:
            found[place] = there.pop()
    twice = Counter(found.values())
    return {place: there for place, there in found.items() if twice[there] == 1}


Same = Callable[[TopologicalMap, Gateway, TopologicalMap, Gateway], list[tuple[int, int]] | None]


def _same_slots(
    world: TopologicalMap, mine: Gateway, real: TopologicalMap, theirs: Gateway
) -> list[tuple[int, int]] | None:
    """The gateways of a place, each with the gateway of the other place in the same slot.

    One of the places is laid on the other; it is None if they differ.
    """
    turn = theirs[1] - mine[1]
    pairs = [(slot, (slot + turn) % real.slots) for slot in sorted(world.stars[mine[0]])]
    return pairs if {slot for _, slot in pairs} == real.stars[theirs[0]] else None


def _same_order(
    world: TopologicalMap, mine: Gateway, real: TopologicalMap, theirs: Gateway
) -> list[tuple[int, int]] | None:
    """The same if slots may differ, but not the order of the gateways."""
    star, other = sorted(world.stars[mine[0]]), sorted(real.stars[theirs[0]])
    if len(star) != len(other):
        return None
    off = other.index(theirs[1]) - star.index(mine[1])
    return [(slot, other[(n + off) % len(other)]) for n, slot in enumerate(star)]


def _laid(
    world: TopologicalMap, real: TopologicalMap, same: Same, named: Mapping[Place, Place]
) -> Iterator[dict[Place, Place]]:
    """The ways to lay a map of one component on a world; only some are looked for."""
    if len(world.components()) > 1:
        return
    first = next(iter(named), None)
    starts: Iterable[Place] = real.stars if first is None else [named[first]]
    mine = next((out for out in world.gateways() if first is None or out[0] == first), None)
    if mine is None:
        return
    work, many = WORK, 0
    for place in starts:
        for slot in sorted(real.stars[place]):
            found, looked = _match(world, mine, real, (place, slot), same)
            work -= looked
            if found is not None and all(found[one] == named[one] for one in named):
                yield found
                many += 1
            if work < 0 or many >= SEVERAL:
                return


def _match(
    world: TopologicalMap, mine: Gateway, real: TopologicalMap, theirs: Gateway, same: Same
) -> tuple[dict[Place, Place] | None, int]:
    """Lay a map on a world, with one gateway on another.

    Returns:
        The places of the world for those of the map, None if that fails; and how many gateways were
        examined.
    """
    image: dict[Gateway, Gateway] = {}
    places: dict[Place, Place] = {}
    taken: set[Place] = set()
    waiting = [(mine, theirs)]
    while waiting:
        here, there = waiting.pop()
        if here in image:
            if image[here] != there:
                return None, len(image)
            continue
        pairs = None if there[0] in taken else same(world, here, real, there)
        if pairs is None:
            return None, len(image)
        places[here[0]] = there[0]
        taken.add(there[0])
        for slot, other in pairs:
            image[here[0], slot] = there[0], other
        for slot, other in pairs:
            end = world.links.get((here[0], slot))
            if end is not None:
                if (there[0], other) not in real.links:
                    return None, len(image)
                waiting.append((end, real.links[there[0], other]))
    return places, len(image)


def _between(world: TopologicalMap, at: Where) -> Where:
    """Find points for all places if some are known.

    Each of the others is put in the middle of those to which it is linked.
    """
    middle = np.mean([*at.values()], axis=0)
    found = {place: np.array(at.get(place, middle), float) for place in world.stars}
    ends: dict[Place, list[Place]] = {place: [] for place in world.stars if place not in at}
    for out, end in world.links.items():
        if out[0] in ends:
            ends[out[0]].append(end[0])
    for _ in range(ROUNDS):
        for place, near in ends.items():
            if near:
                found[place] = np.mean([found[other] for other in near], axis=0)
    return {place: (float(x), float(y)) for place, (x, y) in found.items()}
