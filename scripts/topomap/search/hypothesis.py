"""A node of the search tree of the paper's Figure 2, and the way to its children.

It is written from the definitions, not from the encodings: a second way to every answer. The map is
changed in place: a step is entered, and undone. A gateway is the number ``place * slots + slot``; a
place is named by the step at which it was first visited.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import Any, NamedTuple

from topomap.model.experience import DState, Experience, Slots
from topomap.model.topology import TopologicalMap
from topomap.search.evidence import RULES as KNOWN
from topomap.search.evidence import Evidence

OFTEN = 500  # nodes between two looks at the clock
Face = tuple[int, ...]
# The rules that can refuse an arrival: another view is seen there, or other landmarks; the marker
# is seen and does not lie there, or lies there and is not seen; what is known besides views; a
# place would be on a path twice, or the path would be circular; and the demands.
RULES = (
    *("view", "landmark", "marker", *KNOWN),
    *("twice", "circular", "planarity", "perpendicular", "bound"),
)


class Link(NamedTuple):
    """What a link changed.

    ``out`` and ``arrival`` are its gateways, and ``path`` and ``other`` are the two paths that it
    joined. The rest is what was there before: the faces, and for each of the two paths its places
    and the paths that it meets.
    """

    out: int
    arrival: int
    path: int
    other: int
    faces: tuple[Face, ...]
    path_places: int
    other_places: int
    path_meets: int
    other_meets: int
    part: int | None  # the component that it joined to another one


class Hypothesis:
    """A map, and the dstates of the agent in it (``at``, as gateways).

    ``links`` joins gateways in both directions. ``faces`` has for each face its pending gateways,
    in the order of its walk (the paper, section III.B). A link inside a face splits it, and a link
    between two faces, which planarity forbids, merges them. ``paths`` has for each path the set of
    its places, as bits; ``meets`` has the set of the paths with which it shares a place, if that is
    needed.

    With ``planar``, ``bound`` and ``perpendicular``, children that break these demands are dropped.
    Without the ``path_axiom`` a path may come back to one of its places, and may be circular;
    ``perpendicular`` then drops nothing, and is checked of the whole (``square``).
    """

    def __init__(
        self,
        experience: Experience,
        planar: bool = False,
        bound: int | None = None,
        perpendicular: bool = False,
        path_axiom: bool = True,
    ):
        self.experience, self.slots = experience, experience.slots
        self.planar, self.bound, self.perpendicular = planar, bound, perpendicular
        self.path_axiom = path_axiom
        self._crosses = perpendicular  # whether ``meets`` is kept
        self.stars: list[Face] = []  # the place that each step would make, counter-clockwise
        self.views: dict[int, int] = {}  # for each gateway, the number of what is seen from it
        numbers: dict[Any, int] = {}
        # The compass is a part of the view if it is known at each visit, and exact. What is seen
        # from the gateways of a visit is computed once for all visits that see the same.
        north = experience.compass_told() == experience.steps + 1 and not experience.tolerance
        known: dict[Any, list[tuple[int, int]]] = {}
        for step, view in enumerate(experience.views):
            landmarks, pairs = experience.landmarks[step], self._told_straight(step)
            points = experience.compass[step] if north else None
            seen = (view, landmarks, pairs, points)
            if seen not in known:
                known[seen] = [
                    (slot, numbers.setdefault(self._seen_from(slot, *seen), len(numbers)))
                    for slot in sorted(view, reverse=True)
                ]
            first = step * self.slots
            self.stars.append(tuple([first + slot for slot, _ in known[seen]]))
            self.views.update((first + slot, number) for slot, number in known[seen])
        # For each step: the steps that put down the markers which lie somewhere, and whether each
        # marker is seen now.
        self.lying: dict[int, list[tuple[int, bool]]] = {}
        for step, down, spotted, _ in experience.lying():
            self.lying.setdefault(step, []).append((down, spotted))
        self.evidence = Evidence(experience, compass=not north)
        # For each place its visits, and for each link (by the lower of its gateways) the steps
        # along it, if these are needed.
        self.visits: dict[int, list[int]] = {0: [0]}
        self.steps_along: dict[int, list[int]] = {}
        self.steps = 0  # the number of steps that were entered
        self.at = [0]
        self.links: dict[int, int] = {}
        self.faces: tuple[Face, ...] = (self.stars[0],)
        self.paths: dict[int, int] = {}
        self.meets: dict[int, int] = {}
        self._axis = {gateway: self._axis_of(gateway) for star in self.stars for gateway in star}
        self.places = 0
        self.matches = 0  # links between known places: m in the paper's equation (1)
        self._joined: dict[int, int] = {}  # from an axis to another one of its path
        self.parted = bool(experience.starts)  # whether there may be several components
        self._part: dict[int, int] = {}  # from a place to another one of its component
        self.components = 1
        self._trail: list[Link | None] = []
        self._add_place(0)

    def _told_straight(self, step: int) -> frozenset[Slots]:
        """The pairs of gateways of a visit that are known to be on one path."""
        told = self.experience.straight
        return told[step] if told else frozenset()

    def _seen_from(
        self,
        slot: int,
        view: frozenset[int],
        landmarks: frozenset[str],
        pairs: frozenset[Slots],
        points: int | None,
    ) -> tuple[Any, ...]:
        """What is seen from a gateway of a visit, in slots clockwise from it.

        It includes the direction of the gateway, if the visit's own gateway points to ``points``.
        """
        star = frozenset((other - slot) % self.slots for other in view)
        told = frozenset(frozenset((end - slot) % self.slots for end in pair) for pair in pairs)
        return star, landmarks, told, None if points is None else (points + slot) % self.slots

    def _axis_of(self, gateway: int) -> int:
        """The name of the axis of a gateway at its place, which is the lower slot of the axis."""
        place, slot = divmod(gateway, self.slots)
        if not self.experience.straight:
            return gateway - slot + slot % (self.slots // 2)
        pairs = self.experience.straight[place]
        return gateway - slot + next((pair[0] for pair in pairs if slot in pair), slot)

    def axes(self, place: int) -> dict[int, int]:
        """The gateways of a place, each with the name of its axis."""
        return {gateway: self._axis[gateway] for gateway in self.stars[place]}

    @property
    def dstates(self) -> tuple[DState, ...]:
        """The place and the gateway after each step, named as in ``at/3``."""
        known = {gateway: divmod(gateway, self.slots) for gateway in {*self.at}}
        return tuple(map(known.__getitem__, self.at))

    @property
    def cost(self) -> tuple[int, int]:
        """The numbers of paths and places; the policy prefers fewer."""
        return len(self.paths), self.places

    @property
    def grown(self) -> bool:
        """Whether the last step added a link; true also if there is no step."""
        return not self._trail or self._trail[-1] is not None

    @property
    def genus(self) -> int:
        """The genus, by Euler's formula.

        The map is a tree with ``matches`` more links, or has several components.
        """
        if self.parted:
            links = len(self.links) // 2
            return (2 * self.components - self.places + links - len(self.faces)) // 2
        return (self.matches + 1 - len(self.faces)) // 2

    @property
    def map(self) -> TopologicalMap:
        """The map as an object of its own."""
        return self.experience.map_of(self.dstates)

    def closed(self) -> bool:
        """Whether no gateway is pending."""
        return not any(self.faces)

    def travelled(self) -> bool:
        """Whether every path has a link.

        Then it has two places or more. Without the path axiom, it is enough that a link leads from
        a place back to this place.
        """
        alone = [path for path, places in self.paths.items() if not places & (places - 1)]
        return not alone or {*alone} <= {self.path(gateway) for gateway in self.links}

    def square(self) -> bool:
        """Whether the map is qualitatively perpendicular (the paper, section IV)."""
        return all(self._square(path, places) for path, places in self.paths.items())

    def _square(self, path: int, places: int) -> bool:
        """Tell whether a path with these places meets no path twice and is in no triangle.

        It is in no triangle if no two paths that meet it at different places meet each other.
        """
        met = [(places & of, of) for other, of in self.paths.items() if other != path]
        met = [(common, of) for common, of in met if common]
        if any(common & (common - 1) for common, _ in met):
            return False
        return not any(x != y and a & b for (x, a), (y, b) in combinations(met, 2))

    @property
    def rests(self) -> str | None:
        """Why the next step is not a travel: "start" of a new log, or "look"; None if it is one."""
        step = self.steps + 1
        if step in self.experience.starts:
            return "start"
        return "look" if step in self.experience.looks else None

    def out(self) -> int:
        """The gateway by which the next step leaves, which must be a travel."""
        place, slot = divmod(self.at[-1], self.slots)
        if self.experience.tolerance:
            return place * self.slots + self.experience.way_out(self.steps + 1, (place, slot))[1]
        turn = self.experience.turns[self.steps]
        assert turn is not None
        return place * self.slots + (slot + turn) % self.slots

    def component(self, place: int) -> int:
        """The component of the map to which a place belongs, named by one of its places."""
        while place in self._part:
            place = self._part[place]
        return place

    def path(self, gateway: int) -> int:
        """The path on which a gateway lies, named by one of its axes."""
        axis, joined = self._axis[gateway], self._joined
        while axis in joined:
            axis = joined[axis]
        return axis

    def face(self, gateway: int) -> Face:
        """The face on which a pending gateway lies."""
        return face_of(self.faces, gateway)

    def fitting(self, gateways: Face) -> list[int]:
        """Select the gateways from which what the next step sees would be seen."""
        if self.experience.tolerance:
            return [gateway for gateway in gateways if self._alike(gateway)]
        seen = self.views[(self.steps + 1) * self.slots]
        return [gateway for gateway in gateways if self.views[gateway] == seen]

    def _alike(self, gateway: int) -> bool:
        """Tell whether the next step sees what is seen from this gateway."""
        step = self.steps + 1
        if not self.experience.tolerance:
            return self.views[gateway] == self.views[step * self.slots]
        return self.experience.alike(*divmod(gateway, self.slots), step)

    def marked(self, gateway: int) -> bool:
        """Tell whether the place of this gateway agrees with what the next step sees of markers.

        The step must see a marker if and only if it lies at this place.
        """
        place, at, slots = gateway // self.slots, self.at, self.slots
        told = self.lying.get(self.steps + 1, ())
        return all(seen == (place == at[down] // slots) for down, seen in told)

    def denied(self, gateway: int) -> str | None:
        """The first rule of ``evidence`` by which the next step does not arrive there, or None."""
        evidence, step = self.evidence, self.steps + 1
        place, slot = divmod(gateway, self.slots)
        rules = set()
        for visit in self.visits.get(place, ()):
            turn = (slot - self.at[visit]) % self.slots
            rules.add(evidence.refuses(visit, step, turn))
        if any(self.at[earlier] // self.slots != place for earlier in evidence.same.get(step, ())):
            rules.add("same")
        if evidence.lengths and not self.rests:
            along = self.steps_along.get(min(self.out(), gateway), ())
            if any(evidence.unequal(other, step) for other in along):
                rules.add("length")
        return next((rule for rule in KNOWN if rule in rules), None)

    def allowed(self, arrivals: Iterable[int]) -> list[int]:
        """Select the gateways that agree with what is known of the next step besides its view.

        This includes what it sees of the marker.
        """
        marked = [gateway for gateway in arrivals if self.marked(gateway)]
        if not self.evidence:
            return marked
        return [gateway for gateway in marked if not self.denied(gateway)]

    def children(self) -> list[int]:
        """The gateways at which the next step can arrive.

        They are gateways of known places, and gateway 0 of a new one. If the link is known, it is
        the other end of the link, provided that the view is the predicted one.
        """
        if self.rests:
            return self._resting()
        out = self.out()
        if out in self.links:
            return self.allowed(self.fitting((self.links[out],)))
        near = self._near(out)
        arrivals = [
            g for g in self.fitting(near) if g != out and self._joins(self.path(out), self.path(g))
        ]
        if self.bound is None or self.places < self.bound:
            arrivals.append((self.steps + 1) * self.slots)
        return self.allowed(arrivals)

    def _near(self, out: int) -> Face:
        """The pending gateways to which this one can be linked, in a planar map or in any map."""
        if not self.planar:
            return tuple(gateway for face in self.faces for gateway in face)
        near = self.face(out)
        if self.parted:
            here = self.component(out // self.slots)
            for face in self.faces:
                if face and self.component(face[0] // self.slots) != here:
                    near += face
        return near

    def _resting(self) -> list[int]:
        """Where the agent can be after a step that is not a travel.

        After a second look it is where it was. A new log begins at any gateway of a known place, or
        at a new place.
        """
        step = self.steps + 1
        if self.rests == "look":
            return self.allowed(self.fitting((self.at[-1],)))
        known = [
            gateway
            for place in {gateway // self.slots: None for gateway in self.at}
            for gateway in self.stars[place]
        ]
        arrivals = self.fitting(tuple(known))
        if self.bound is None or self.places < self.bound:
            arrivals.append(step * self.slots)
        return self.allowed(arrivals)

    def tried(self) -> Iterator[tuple[int, str | None]]:
        """The gateways at which the next step might arrive, and the rules that refuse them.

        It might arrive at the other end of its link or, if that is not known, at any other pending
        gateway, or at a new place. Each comes with the first of ``RULES`` that refuses it; the
        children are those that no rule refuses.
        """
        if self.rests:
            yield from self._tried_resting()
            return
        out = self.out()
        if out in self.links:
            yield self.links[out], self._mistaken(self.links[out])
            return
        face = self._near(out)
        for gateway in (g for face in self.faces for g in face if g != out):
            rule = self._mistaken(gateway)
            paths = self.path(out), self.path(gateway)
            if rule is None and not self._joins(*paths):
                common = self.paths[paths[0]] & self.paths[paths[1]]
                rule = "twice" if common else "perpendicular"
                rule = "circular" if paths[0] == paths[1] else rule
            if rule in (None, "perpendicular") and self.planar and gateway not in face:
                rule = "planarity"
            yield gateway, rule
        yield from self._tried_new()

    def _tried_resting(self) -> Iterator[tuple[int, str | None]]:
        """The same for a step that is not a travel."""
        if self.rests == "look":
            yield self.at[-1], self._mistaken(self.at[-1])
            return
        for place in {gateway // self.slots: None for gateway in self.at}:
            for gateway in self.stars[place]:
                yield gateway, self._mistaken(gateway)
        yield from self._tried_new()

    def _tried_new(self) -> Iterator[tuple[int, str | None]]:
        """The same for a new place."""
        new = (self.steps + 1) * self.slots
        full = self.bound is not None and self.places >= self.bound
        refused = "marker" if not self.marked(new) else self.denied(new)
        yield new, refused or ("bound" if full else None)

    def _mistaken(self, gateway: int) -> str | None:
        """The first rule by which the view of the next step refuses this gateway, or None."""
        step, (place, slot) = self.steps + 1, divmod(gateway, self.slots)
        if self._alike(gateway):
            return self.denied(gateway) if self.marked(gateway) else "marker"
        if not self.experience.looks_alike(place, slot, step):
            return "view"
        if not self.experience.alike(place, slot, step):
            return "landmark"
        return "compass" if self.marked(gateway) else "marker"

    def _joins(self, path: int, other: int) -> bool:
        """Tell whether a link may join these paths.

        By the path axiom they must be two paths that share no place; and a map that must be
        ``perpendicular`` must stay so.
        """
        if not self.path_axiom:
            return True
        if self.paths[path] & self.paths[other]:
            return False
        return not self.perpendicular or self._squares(self.meets[path], self.meets[other])

    def _squares(self, meets: int, others: int) -> bool:
        """Tell whether the map stays perpendicular when two paths become one.

        They meet the paths ``meets`` and ``others``. The two share no place, so a path that meets
        both would meet the new one twice. And if a path that meets the one meets a path that meets
        the other, the new path makes a triangle with them.
        """
        if meets & others:
            return False
        return not any(self.meets[met] & others for met in numbers(meets))

    def enter(self, arrival: int) -> None:
        """Go one step on, to a gateway that is one of the children."""
        if self.rests:
            self._rest(arrival)
            return
        out = self.out()
        self._trail.append(None if out in self.links else self._add_link(out, arrival))
        self.at.append(arrival)
        self.steps += 1
        if self.evidence:
            self.visits.setdefault(arrival // self.slots, []).append(self.steps)
            self.steps_along.setdefault(min(out, arrival), []).append(self.steps)

    def _rest(self, arrival: int) -> None:
        """Go on by a step that is not a travel, to one of the children."""
        place = arrival // self.slots
        self._trail.append(None)
        self.at.append(arrival)
        self.steps += 1
        if self.evidence:
            self.visits.setdefault(place, []).append(self.steps)
        if place == self.steps:
            self._add_place(place)
            self.faces = (*self.faces, self.stars[place])
            self.components += 1

    def _add_link(self, out: int, arrival: int) -> Link:
        place, step = arrival // self.slots, self.steps + 1
        faces = self.faces
        if place == step:
            self._add_place(place)
        self.faces = linked(faces, out, arrival, self.stars[place] if place == step else None)
        parts = self.component(out // self.slots), self.component(place)
        if self.parted and parts[0] != parts[1]:
            self._part[parts[1]] = parts[0]
            self.components -= place != step
        self.matches += place != step
        self.links[out], self.links[arrival] = arrival, out
        path, other = self.path(out), self.path(arrival)
        merged = parts[1] if self.parted and parts[0] != parts[1] else None
        if path == other:  # the path is circular now
            kept = self.paths[path], self.meets[path]
            return Link(out, arrival, path, path, faces, kept[0], kept[0], kept[1], kept[1], merged)
        places, more = self.paths[path], self.paths.pop(other)
        meets, met = self.meets[path], self.meets.pop(other)
        self._joined[other] = path
        self.paths[path] = places | more
        both = (1 << path) | (1 << other)
        if self._crosses:
            self.meets[path] = (meets | met) & ~both
            self._cross(path, other, meets & ~both, met & ~both)
        return Link(out, arrival, path, other, faces, places, more, meets, met, merged)

    def _cross(self, path: int, other: int, meets: int, met: int) -> None:
        """Note which paths meet the path that two paths become, or take that back.

        Of the paths that meet these two, ``meets`` meet the one and ``met`` the other.
        """
        both = (1 << path) | (1 << other)
        for crossing in numbers(met):
            self.meets[crossing] ^= both & ~(meets >> crossing & 1 and 1 << path)

    def undo(self) -> None:
        """Go one step back."""
        link = self._trail.pop()
        arrival = self.at.pop()
        step, self.steps = self.steps, self.steps - 1
        if self.evidence:
            self.visits[arrival // self.slots].pop()
            if not self.rests:
                self.steps_along[min(self.out(), arrival)].pop()
        if link is None:
            if arrival // self.slots == step:
                self._remove_place(step)
                self.faces = self.faces[:-1]
                self.components -= 1
            return
        if link.part is not None:
            del self._part[link.part]
            self.components += arrival // self.slots != step
        del self.links[link.out], self.links[arrival]
        if link.path != link.other:
            del self._joined[link.other]
            self.paths[link.path], self.paths[link.other] = link.path_places, link.other_places
            self.meets[link.path], self.meets[link.other] = link.path_meets, link.other_meets
            if self._crosses:
                both = (1 << link.path) | (1 << link.other)
                meets, met = link.path_meets & ~both, link.other_meets & ~both
                self._cross(link.path, link.other, meets, met)
        self.faces = link.faces
        if arrival // self.slots == step:
            self._remove_place(step)
        else:
            self.matches -= 1

    def _add_place(self, place: int) -> None:
        self.places += 1
        axes = {self._axis[gateway] for gateway in self.stars[place]}
        every = sum(1 << axis for axis in axes)
        for axis in axes:
            self.paths[axis] = 1 << place
            self.meets[axis] = every ^ (1 << axis)

    def _remove_place(self, place: int) -> None:
        self.places -= 1
        for axis in {self._axis[gateway] for gateway in self.stars[place]}:
            del self.paths[axis], self.meets[axis]

    def run(self) -> bool:
        """Go on over known links as far as possible; return False if there can be no map below.

        These steps are undone together with the last step that was entered.
        """
        return True

    def goto(self, dstates: Sequence[DState]) -> None:
        """Go to another node of the tree, by way of what the two have in common."""
        self.go([place * self.slots + slot for place, slot in dstates])

    def go(self, at: Sequence[int]) -> None:
        """Go to the node with these gateways, by way of what the two have in common."""
        pairs = enumerate(zip(self.at, at, strict=False))
        common = next((step for step, (a, b) in pairs if a != b), min(len(self.at), len(at)))
        while len(self.at) > common:
            self.undo()
        for arrival in at[len(self.at) :]:
            self.enter(arrival)


def face_of(faces: Iterable[Face], gateway: int) -> Face:
    """The face on which a pending gateway lies."""
    for face in faces:
        if gateway in face:
            return face
    raise KeyError(gateway)


def linked(faces: tuple[Face, ...], out: int, arrival: int, star: Face | None) -> tuple[Face, ...]:
    """The faces after a link between two pending gateways.

    ``star`` is the place of the second gateway, as its gateways counter-clockwise, if it is a new
    place. A link inside a face splits it, and a link between two faces merges them.
    """
    here = face_of(faces, out)
    rest = after(here, out)
    others = [face for face in faces if face is not here]
    if star is not None:
        return (after(star, arrival) + rest, *others)
    if arrival in rest:
        middle = rest.index(arrival)
        return (rest[:middle], rest[middle + 1 :], *others)
    there = face_of(others, arrival)
    others.remove(there)
    return (rest + after(there, arrival), *others)


def after(face: Face, gateway: int) -> Face:
    """The other gateways of a face, in the order of its walk, beginning after this one."""
    index = face.index(gateway)
    return face[index + 1 :] + face[:index]


def numbers(bits: int) -> Iterator[int]:
    """The numbers of a set that is held as bits."""
    while bits:
        one = bits & -bits
        yield one.bit_length() - 1
        bits ^= one
