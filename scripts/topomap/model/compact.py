"""The map of a hypothesis in numbers, for answers of a million maps.

What is the same in all maps of an experience is computed once. ``TopologicalMap`` is the
definition; tests find the two equal.

A gateway, or a direction without a gateway, is the number ``place * slots + slot``; a place is the
step of its first visit. Where it is known which gateways are on one path, the direction behind a
gateway G that ends its path is -1 - G.
"""

from collections.abc import Sequence

from topomap.model.experience import DState, Experience

Number = int


class Numbering:
    """What all maps of one experience have in common.

    In these maps each step arrives at a gateway that is seen there. With the path axiom no path is
    circular, which saves work.
    """

    def __init__(self, experience: Experience, path_axiom: bool = True):
        self.path_axiom = path_axiom
        self.slots = slots = experience.slots
        self.experience, self.turns = experience, experience.turns
        self.parted = experience.parted
        views = [sorted(view) for view in experience.views]
        # For each place: its gateways, and the number of axes on which they lie.
        self.gateways = [
            [place * slots + slot for slot in view] for place, view in enumerate(views)
        ]
        self.axes = [
            len(view) - sum(1 for _ in experience.pairs(visit)) for visit, view in enumerate(views)
        ]
        # For each gateway: the next one counter-clockwise at its place, and the one opposite.
        self.before: dict[Number, Number] = {}
        self.opposite: dict[Number, Number] = {}
        for place, star in enumerate(self.gateways):
            self.before.update(zip(star, star[-1:] + star, strict=False))
            if experience.straight:
                self.opposite |= {gateway: -1 - gateway for gateway in star}
                self.opposite |= {-1 - gateway: gateway for gateway in star}
                for pair in experience.straight[place]:
                    one, other = (place * slots + slot for slot in pair)
                    self.opposite |= {one: other, other: one}
                continue
            for slot in range(slots):
                across = place * slots + (slot + slots // 2) % slots
                self.opposite[place * slots + slot] = across

    def bearing(self, heading: Number) -> Number:
        """The slot of a heading."""
        if heading >= 0:
            return heading
        place, slot = divmod(-1 - heading, self.slots)
        return place * self.slots + (slot + self.slots // 2) % self.slots


class CompactMap:
    """The map of a hypothesis, given by its dstate after each step.

    It has ``places``, ``gateways``, and ``link``, which joins gateways in both directions (the
    paper, sections II and III).
    """

    __slots__ = ("_all", "link", "places")

    def __init__(self, numbering: Numbering, at: Sequence[DState]):
        self._all = numbering
        slots = numbering.slots
        place, slot = at[0]
        self.places = [0]
        self.link: dict[Number, Number] = {}
        link, tolerance = self.link, numbering.experience.tolerance
        for step, turn in enumerate(numbering.turns[: len(at) - 1], 1):
            before = place * slots + slot
            place, slot = at[step]
            if turn is not None:
                out = before - before % slots + (before % slots + turn) % slots
                if tolerance:
                    known = numbering.experience.way_out(step, divmod(before, slots))
                    out = known[0] * slots + known[1]
                arrival = place * slots + slot
                link[out] = arrival
                link[arrival] = out
            if place == step:
                self.places.append(step)

    def gateways(self) -> list[Number]:
        """All gateways, in order."""
        every = self._all.gateways
        return [gateway for place in self.places for gateway in every[place]]

    def number_of_paths(self) -> int:
        """The number of paths.

        Where no path is circular, each link joins two paths, so this is the number of axes minus
        that of the links.
        """
        if not self._all.path_axiom:
            return len(self.paths())
        axes = self._all.axes
        return sum([axes[place] for place in self.places]) - len(self.link) // 2

    def number_of_pending(self) -> int:
        """The number of gateways that have no link."""
        every = self._all.gateways
        return sum([len(every[place]) for place in self.places]) - len(self.link)

    def genus(self, faces: int | None = None) -> int:
        """The genus by the Euler-Poincare formula; a known number of faces saves finding them."""
        faces = len(self.faces()) if faces is None else faces
        if self._all.parted:
            return self._genus_of_parts(faces)
        return (2 - len(self.places) + len(self.link) // 2 - faces) // 2

    def _genus_of_parts(self, faces: int) -> int:
        """The genus of a map that may have several components."""
        slots = self._all.slots
        part = {place: place for place in self.places}

        def first(place: Number) -> Number:
            """The representative of the component of a place."""
            while part[place] != place:
                place = part[place]
            return place

        for out, end in self.link.items():
            one, other = first(out // slots), first(end // slots)
            part[max(one, other)] = min(one, other)
        parts = sum(first(place) == place for place in self.places)
        linked = {out // slots for out in self.link}
        bare = len(self.places) - len(linked)
        faces = faces + bare if self.link else bare
        return (2 * parts - len(self.places) + len(self.link) // 2 - faces) // 2

    def faces(self) -> list[list[Number]]:
        """Each face as the gateways by which its walk leaves, as in ``TopologicalMap.faces``."""
        link, before = self.link, self._all.before
        faces, done = [], set()
        for start in sorted(link):
            if start in done:
                continue
            face, gateway = [start], start
            while True:
                gateway = before[link[gateway]]
                while gateway not in link:
                    gateway = before[gateway]
                if gateway == start:
                    break
                face.append(gateway)
            done.update(face)
            faces.append(face)
        return faces or [[]]

    def paths(self) -> list[list[Number]]:
        """Each path as its headings in order, as ``TopologicalMap.paths`` has them."""
        link, opposite = self.link, self._all.opposite
        paths, done = [], set()
        for gateway in self.gateways():
            if gateway in done:
                continue
            # Go back to where the path begins; a circular path begins here.
            path = [gateway]
            ahead = opposite[gateway]
            while ahead in link and link[ahead] != gateway:
                path.append(link[ahead])
                ahead = opposite[link[ahead]]
            path = [gateway] if ahead in link else path[::-1]
            ahead = gateway
            while ahead in link and opposite[link[ahead]] != path[0]:
                ahead = opposite[link[ahead]]
                path.append(ahead)
            for heading in path:
                done.add(heading)
                done.add(opposite[heading])
            paths.append(path)
        return paths
