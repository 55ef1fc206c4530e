"""Which of two maps is preferred by set inclusion, from the definition: the policy of
circumscription (the paper, section II)."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from topomap.model.experience import DState, Experience

Name = tuple[str | int, ...]


class Extent(NamedTuple):
    """The paths and the places of a map, by names that do not depend on the map.

    A path is named by the first step that travelled it, ``("first", T)``, or, if none did, by a
    place and the lower one of its slots there, ``("axis", P, S)``; a place by the step of its
    first visit.
    """

    paths: frozenset[Name]
    places: frozenset[int]

    def preferred_to(self, other: "Extent") -> bool:
        """Whether the map has a proper part of the other one's paths, or the same paths and a
        proper part of its places."""
        if self.paths != other.paths:
            return self.paths < other.paths
        return self.places < other.places


def extent(experience: Experience, at: Sequence[DState]) -> Extent:
    """The paths and places of a hypothesis, given by its dstate after each step."""
    world = experience.map_of(tuple(at))
    axes = experience.slots // 2
    first: dict[tuple[int, int], int] = {}
    for step, (place, slot) in reversed([*enumerate(at)][1:]):
        # Step T arrived at its gateway through the path that leads through it.
        first[place, slot % axes] = step
    paths: set[Name] = set()
    for path in world.paths():
        on = [(place, slot % axes) for place, slot in path]
        steps = [first[axis] for axis in on if axis in first]
        paths.add(("first", min(steps)) if steps else ("axis", *on[0]))
    return Extent(frozenset(paths), frozenset(world.stars))


def least(extents: Iterable[Extent]) -> set[Extent]:
    """Those that no other one is preferred to."""
    found: set[Extent] = set()
    for one in sorted(set(extents), key=lambda one: (len(one.paths), len(one.places))):
        # What is preferred to it is smaller, and so came before; and if that is not itself
        # among the least, something that is preferred to it is.
        if not any(other.preferred_to(one) for other in found):
            found.add(one)
    return found
