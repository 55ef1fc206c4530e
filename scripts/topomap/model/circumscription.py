"""The policy of circumscription: which of two maps is preferred, by set inclusion.

It is computed from the definition (the paper, section II).
"""

from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import NamedTuple

from topomap.model.experience import DState, Experience
from topomap.model.topology import Gateway

OFTEN = 64  # sets that are compared with all others between two looks at the clock


class Extent(NamedTuple):
    """The paths and the places of a map, by names that do not depend on the map.

    ``extent`` names a path by the first step that travelled it, ``("first", T)``, or, if no step
    did, by a place and the lower one of its slots there, ``("axis", P, S)``. It names a place by
    the step of its first visit.
    """

    paths: frozenset[Hashable]
    places: frozenset[Hashable]


def extent(experience: Experience, at: Sequence[DState]) -> Extent:
    """Find the paths and places of a hypothesis, given by its dstate after each step."""
    world = experience.map_of(tuple(at))
    first: dict[Gateway, int] = {}
    for step, arrival in reversed([*enumerate(at)][1:]):
        # Step T travelled the path on which its gateway of arrival lies.
        first[arrival] = first[world.opposite(arrival)] = step
    paths: set[Hashable] = set()
    for path in world.paths():
        steps = [first[heading] for heading in path if heading in first]
        place, slot = min(path[0], world.opposite(path[0]))
        if world.across is None:
            slot %= experience.slots // 2
        elif slot < 0:  # the path ends at the gateway
            slot = -1 - slot
        paths.add(("first", min(steps)) if steps else ("axis", place, slot))
    return Extent(frozenset(paths), frozenset(world.stars))


def least(extents: Iterable[Extent], tick: Callable[[], None] = lambda: None) -> set[Extent]:
    """Select the extents to which no other one is preferred.

    One extent is preferred to another if its paths are a proper subset of the paths of the other,
    or if the paths are the same and its places are a proper subset of the places of the other.
    ``tick`` is called now and then, and may end the work by an error.
    """
    by_paths: dict[frozenset[Hashable], set[frozenset[Hashable]]] = {}
    for paths, places in extents:
        by_paths.setdefault(paths, set()).add(places)
    return {
        Extent(paths, places)
        for paths in _least(by_paths, tick)
        for places in _least(by_paths[paths], tick)
    }


def _least(
    sets: Iterable[frozenset[Hashable]], tick: Callable[[], None]
) -> list[frozenset[Hashable]]:
    """Select the sets of which no other set is a subset; each is compared as bits of a number."""
    bits: dict[Hashable, int] = {}
    kept: list[int] = []
    found = []
    # A subset is smaller than its set, so it comes first; and if the subset is not kept itself, a
    # subset of it is.
    for number, one in enumerate(sorted(sets, key=len)):
        if number % OFTEN == 0:
            tick()
        mask = sum(1 << bits.setdefault(name, len(bits)) for name in one)
        if not any(other & mask == other for other in kept):
            kept.append(mask)
            found.append(one)
    return found
