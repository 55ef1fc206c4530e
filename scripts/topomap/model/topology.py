"""Topological maps: places with gateways in cyclic order, and the links between them.

A map is a rotation system. Its gateways are pairs (place, slot). Slots are numbered clockwise from
0 to ``slots - 1``, and opposite slots are ``slots / 2`` apart. The same class has the map of a
hypothesis and the map of a whole environment.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

Place = Any  # it can be hashed, and compared with the other places of its map
Gateway = tuple[Place, int]


@dataclass(frozen=True)
class Exceptional:
    """An exception of a map to boundary consistency.

    It has its ``kind``, the ``paths`` that it is about, by their numbers, and the ``places``.
    """

    kind: str
    paths: tuple[int, ...]
    places: tuple[Place, ...]


@dataclass(frozen=True)
class TopologicalMap:
    """A map (the paper, sections II and III.A).

    ``stars`` gives the gateways of each place. ``links`` gives the gateway at the other end of each
    linked gateway, in both directions. ``landmarks`` gives the landmarks recognised at a place, as
    texts. ``across`` gives the other gateway of the place that is on the same path, in both
    directions; a gateway that is not in it ends its path. If ``across`` is None, opposite gateways
    are on one path.
    """

    slots: int
    stars: Mapping[Place, frozenset[int]]
    links: Mapping[Gateway, Gateway]
    landmarks: Mapping[Place, frozenset[str]] = field(default_factory=dict)
    across: Mapping[Gateway, Gateway] | None = None

    def gateways(self) -> Iterator[Gateway]:
        """All gateways, in the order of places and slots."""
        for place, star in self.stars.items():
            for slot in sorted(star):
                yield place, slot

    def edges(self) -> list[tuple[Gateway, Gateway]]:
        """Each link once, beginning with the gateway that comes first in the order."""
        seen: set[Gateway] = set()
        edges = []
        for gateway in self.gateways():
            if gateway in self.links and gateway not in seen:
                seen |= {gateway, self.links[gateway]}
                edges.append((gateway, self.links[gateway]))
        return edges

    def pending(self) -> list[Gateway]:
        """The gateways without a link (the paper, section III.B)."""
        return [gateway for gateway in self.gateways() if gateway not in self.links]

    def view(self, gateway: Gateway) -> frozenset[int]:
        """The gateways of the place, as slots clockwise from the one where the agent stands."""
        place, slot = gateway
        return frozenset((other - slot) % self.slots for other in self.stars[place])

    def pairs(self, gateway: Gateway) -> frozenset[tuple[int, int]] | None:
        """The pairs of gateways of the place that are on one path.

        They are slots clockwise from the gateway where the agent stands; None if opposite gateways
        are on one path.
        """
        if self.across is None:
            return None
        place, slot = gateway
        return frozenset(
            ((one - slot) % self.slots, (end[1] - slot) % self.slots)
            for one in self.stars[place]
            for end in [self.across.get((place, one))]
            if end is not None
        )

    def opposite(self, gateway: Gateway) -> Gateway:
        """The direction on the opposite side of the place, with or without a gateway.

        Where it is known which gateways are on one path (``across``), the direction of a path that
        ends at gateway S is the number -1 - S, because another path may have a gateway in the
        opposite slot.
        """
        place, slot = gateway
        if self.across is None:
            return place, (slot + self.slots // 2) % self.slots
        return self.across.get(gateway, (place, -1 - slot))

    def bearing(self, heading: Gateway) -> int:
        """The slot of a gateway, or of a direction without a gateway."""
        slot = heading[1]
        return slot if slot >= 0 else (self.slots // 2 - 1 - slot) % self.slots

    def headings(self) -> list[list[Gateway]]:
        """The paths, with the slot of each heading."""
        paths = self.paths()
        if self.across is None:
            return paths
        return [[(end[0], self.bearing(end)) for end in path] for path in paths]

    def straight_on(self, gateway: Gateway) -> list[Gateway]:
        """The gateways of arrival on a walk that leaves by ``gateway`` and goes straight on.

        It ends at a pending gateway, at a place without a gateway ahead, or when it returns to its
        start.
        """
        arrivals: list[Gateway] = []
        ahead = gateway
        while ahead in self.links:
            arrivals.append(self.links[ahead])
            ahead = self.opposite(arrivals[-1])
            if ahead == gateway:
                break
        return arrivals

    def paths(self) -> list[list[Gateway]]:
        """Each path as its dstates in order: places, each with the slot of its heading.

        A path continues through opposite gateways (semantics of the SSH). A circular path is given
        once round.
        """
        paths = []
        done: set[Gateway] = set()
        for gateway in self.gateways():
            if gateway in done or self.opposite(gateway) in done:
                continue
            back = self.straight_on(self.opposite(gateway))
            circular = bool(back) and back[-1] == gateway
            path = [] if circular else list(reversed(back))
            path.append(gateway)
            path.extend(self.opposite(arrival) for arrival in self.straight_on(gateway))
            if circular:
                path.pop()
            done |= {end for dstate in path for end in (dstate, self.opposite(dstate))}
            paths.append(path)
        return paths

    def path_axiom_fault(self) -> str | None:
        """How the map breaks the path axiom, or None.

        By this axiom a place occurs at most once on a path, and no path is circular.
        """
        for path in self.paths():
            places = [place for place, _ in path]
            for place, times in Counter(places).items():
                if times > 1:
                    return f"a path passes place {label(place)} twice"
            if self.links.get(path[-1]) == self.opposite(path[0]):
                return f"the path through place {label(places[0])} is circular"
        return None

    def beside(self, path: Sequence[Gateway]) -> tuple[set[Place], set[Place]]:
        """The places to the right and to the left of a path (the SSH's boundary regions).

        They are the places that one reaches by leaving the path to that side and walking straight
        on. A gateway in the very slot of the heading, or in the opposite slot, is on neither side.
        """
        right: set[Place] = set()
        left: set[Place] = set()
        for heading in path:
            place, ahead = heading[0], self.bearing(heading)
            behind = (self.bearing(self.opposite(heading)) - ahead) % self.slots
            for other in self.stars[place]:
                turn = (other - ahead) % self.slots
                if turn not in (0, behind):
                    side = right if turn < behind else left
                    side.update(met for met, _ in self.straight_on((place, other)))
        return right, left

    def exceptions(self) -> Iterator[Exceptional]:
        """The exceptions to consistent boundaries.

        They are the pairs of paths that share two places or more, the paths that contain a place
        twice, and the places that are both left and right of a path (semantics: "What is preferred,
        also where no map is perfect"). Paths are numbered as in ``paths``.
        """
        paths = self.paths()
        on = [Counter(place for place, _ in path) for path in paths]
        for (one, here), (other, there) in combinations(enumerate(on), 2):
            shared = here.keys() & there.keys()
            if len(shared) > 1:
                yield Exceptional("meet twice", (one, other), tuple(sorted(shared)))
        for number, places in enumerate(on):
            again = sorted(place for place, times in places.items() if times > 1)
            if again:
                yield Exceptional("place twice", (number,), tuple(again))
        for number, path in enumerate(paths):
            right, left = self.beside(path)
            for place in sorted(right & left):
                yield Exceptional("both sides", (number,), (place,))

    def boundaries_consistent(self) -> bool:
        """Whether there is no exception (semantics: "Boundary consistency")."""
        return next(self.exceptions(), None) is None

    def next(self, gateway: Gateway) -> Gateway:
        """The next link of the face walk (the paper's next = pred . rev).

        The walk takes the link out of ``gateway``, and then the next linked gateway
        counter-clockwise.
        """
        place, slot = self.links[gateway]
        while True:
            slot = (slot - 1) % self.slots
            if (place, slot) in self.links:
                return place, slot

    def faces(self) -> list[list[Gateway]]:
        """Each face as the gateways by which its walk leaves; one empty face without any links."""
        faces = []
        done: set[Gateway] = set()
        for gateway in self.gateways():
            if gateway in done or gateway not in self.links:
                continue
            face = [gateway]
            while (following := self.next(face[-1])) != gateway:
                face.append(following)
            done |= set(face)
            faces.append(face)
        return faces or [[]]

    def genus(self) -> int:
        """The genus by the Euler-Poincare formula, summed over the components."""
        bare = len(self.stars) - len({place for place, _ in self.links})
        faces = bare + (len(self.faces()) if self.links else 0)
        return (2 * len(self.components()) - len(self.stars) + len(self.links) // 2 - faces) // 2

    def components(self) -> list[list[Place]]:
        """The places of each component; a map of one log has one component."""
        ends: dict[Place, dict[Place, None]] = {place: {} for place in self.stars}
        for (place, _), (other, _) in self.links.items():
            ends[place][other] = None
        parts: list[list[Place]] = []
        seen: set[Place] = set()
        for start in self.stars:
            if start in seen:
                continue
            seen.add(start)
            for place in (part := [start]):
                near = [other for other in ends[place] if other not in seen]
                seen.update(near)
                part += near
            parts.append(part)
        return parts

    def parts(self) -> list["TopologicalMap"]:
        """The components, each as a map."""
        components = self.components()
        if len(components) == 1:
            return [self]
        return [
            TopologicalMap(
                self.slots,
                {place: self.stars[place] for place in part},
                {out: end for out, end in self.links.items() if out[0] in {*part}},
                {place: signs for place, signs in self.landmarks.items() if place in {*part}},
                self.across,
            )
            for part in components
        ]

    def isomorphic(self, other: "TopologicalMap") -> bool:
        """Tell whether the maps are one map up to names.

        The names of places may differ, and so may the slot from which each place counts. They must
        be the same connected embedded graph, with the same directions at each place and the same
        landmarks.
        """
        sizes = len(self.stars), len(self.links), self.slots
        if sizes != (len(other.stars), len(other.links), other.slots):
            return False
        start = next(self.gateways(), None)
        return start is None or any(self._match(start, other, g) for g in other.gateways())

    def indistinguishable(self, mine: Gateway, other: "TopologicalMap", theirs: Gateway) -> bool:
        """Tell whether the maps are bisimilar from these dstates, if both are closed.

        Then no further walk can tell them apart: whichever ways are taken, the same is seen in both
        (the paper, Figure 1).
        """
        seen = {(mine, theirs)}
        for here, there in (waiting := list(seen)):
            (place, slot), (image, at) = here, there
            if self.view(here) != other.view(there) or self.pairs(here) != other.pairs(there):
                return False
            if self.landmarks.get(place, frozenset()) != other.landmarks.get(image, frozenset()):
                return False
            for turn in self.view(here):
                out, way = (slot + turn) % self.slots, (at + turn) % self.slots
                pair = self.links[place, out], other.links[image, way]
                if pair not in seen:
                    seen.add(pair)
                    waiting.append(pair)
        return True

    def _match(self, mine: Gateway, other: "TopologicalMap", theirs: Gateway) -> bool:
        """Tell whether the maps coincide if ``mine`` is laid on ``theirs``."""
        image: dict[Place, Gateway] = {}
        used: set[Place] = set()
        stack = [(mine, theirs)]
        while stack:
            (place, slot), (target, at) = stack.pop()
            turn = (at - slot) % self.slots
            if place in image:
                if image[place] != (target, turn):
                    return False
                continue
            if target in used or self.view((place, slot)) != other.view((target, at)):
                return False
            if self.pairs((place, slot)) != other.pairs((target, at)):
                return False
            if self.landmarks.get(place, frozenset()) != other.landmarks.get(target, frozenset()):
                return False
            image[place] = target, turn
            used.add(target)
            for out in sorted(self.stars[place]):
                end = self.links.get((place, out))
                their_end = other.links.get((target, (out + turn) % self.slots))
                if (end is None) != (their_end is None):
                    return False
                if end is not None and their_end is not None:
                    stack.append((end, their_end))
        return len(image) == len(self.stars)


def label(place: Place) -> str:
    """The name of a place in messages, headers and on the command line."""
    return ",".join(map(str, place)) if isinstance(place, tuple) else str(place)


def gid(gateway: Gateway) -> str:
    """A gateway's name in pictures and lines: ``P.S``."""
    return f"{label(gateway[0])}.{gateway[1]}"
