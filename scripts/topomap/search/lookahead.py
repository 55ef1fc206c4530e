"""A node of the search tree that looks ahead.

It compares what the maps that are asked for need with what the steps to come can still do. A child
is left out if there can be no such map below it.
"""

from typing import NamedTuple

from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.search.future import future_of
from topomap.search.hypothesis import Hypothesis, after


class _Before(NamedTuple):
    """What a step changed, and the ``ran`` steps over known links that followed it.

    It has the place of arrival, and what was known before of the places and gateways of which
    more is known now.
    """

    place: int
    possible: dict[int, int]
    linked_by: dict[int, int]
    in_time: int
    ran: int = 0


class LookAhead(Hypothesis):
    """A hypothesis that has only those children below which there may be a map of a query.

    ``possible_at`` has for each place the visits that can be there, as bits
    (``Future.possible_visits``): those that can be of one place with each visit that was there. No
    other visit arrives there.

    In a closed map each pending gateway must be linked by a step to come. ``linked_by`` has for
    each of them the last step after which that is still possible, given the visits that fit at its
    place. ``pending`` has the number of pending gateways of each kind: the steps to come must have
    as many ends of this kind. ``in_time`` is the last step after which the gateways of each face of
    a planar map can still be linked (``Future.last_of_face``).
    """

    def __init__(self, experience: Experience, query: Query):
        parts = query.parts
        planar = bool(parts & {"planar", "euler"})
        super().__init__(experience, planar, query.places, "perpendicular" in parts)
        self._meets_once = "boundary" in parts  # two paths that meet twice are an exception
        self._crosses |= self._meets_once
        self._closed = "closed" in parts
        self.future = future_of(experience)
        self.possible_at = {0: self.future.possible_visits(0, 0)}
        self._counted = self._closed or "minimal" in parts
        self.linked_by: dict[int, int] = {}
        self.pending = [0] * len(self.future.ends)
        self.in_time = experience.steps
        self.dead_ends = [  # the number of gateways of a place with none opposite
            2 * len({self._axis[gateway] for gateway in star}) - len(star) for star in self.stars
        ]
        self.path_ends = self.dead_ends[0]
        # The number of places of each kind in the map, and the least number of places of each map
        # below this node.
        self.places_of = [0] * len(self.future.needed)
        self.least_places = sum(self.future.needed)
        self._count_place(0, 1)
        self._before: list[_Before] = []
        for gateway in self.stars[0] if self._counted else ():
            self.pending[self.views[gateway]] += 1
        if self._closed:
            for gateway in self.stars[0]:
                self.linked_by[gateway] = self.future.last_at(gateway, self.possible_at[0])
            self._enter_faces()

    def children(self) -> list[int]:
        """The gateways at which the next step can arrive, as far as what is to come allows it."""
        out, step = self.out(), self.steps + 1
        if out in self.links:
            arrivals = self._known(out, step)
        elif self._closed and not self._others_wait(out, step):
            arrivals = []
        else:
            due = self._due(out, step)
            arrivals = self._matches(out, step, due)
            more = self._exceeds(self.future.place_kind[step])
            room = self.bound is None or self.least_places + more <= self.bound
            if room and not due and self._makes_place(out, step):
                arrivals.append(step * self.slots)
        if step not in self.lying and not self.evidence:
            return arrivals
        return self.allowed(arrivals)

    def _exceeds(self, kind: int) -> bool:
        """Tell whether one more place of a kind would be more than each map needs."""
        return self.places_of[kind] >= self.future.needed[kind]

    def _count_place(self, place: int, many: int) -> None:
        """Count a place that was made (1), or that is taken back (-1)."""
        kind = self.future.place_kind[place]
        before = max(self.places_of[kind], self.future.needed[kind])
        self.places_of[kind] += many
        self.least_places += max(self.places_of[kind], self.future.needed[kind]) - before

    def _known(self, out: int, step: int) -> list[int]:
        """The other end of a known link, if the next step can arrive there.

        The pending gateways must be able to wait until after it.
        """
        arrival = self.links[out]
        place, slot = divmod(arrival, self.slots)
        if not self.possible_at[place] >> (step * self.slots + slot) & 1:
            return []
        future = self.future
        if self.views[arrival] != future.arrival[step]:
            return []
        if self._closed:
            if self.in_time < step or min(self.linked_by.values(), default=step) < step:
                return []
            for kind in (future.out[step], future.arrival[step]):
                if self.pending[kind] and future.last(kind, self.pending[kind]) < step:
                    return []
        return [arrival]

    def _others_wait(self, out: int, step: int) -> bool:
        """Tell whether a link from this gateway leaves time for faces that it does not touch."""
        if self.in_time >= step or not self.planar:
            return True
        last = self.future.last_of_face
        return all(not face or out in face or last(face) >= step for face in self.faces)

    def _matches(self, out: int, step: int, due: list[int]) -> list[int]:
        """The gateways of known places at which the next step can arrive by a new link."""
        future, slots, views, last = self.future, self.slots, self.views, self.future.last_of_face
        seen, possible_at = future.arrival[step], self.possible_at
        faces = (self.face(out),) if self.planar else self.faces
        path, arrivals, paired = self.path(out), [], step <= future.paired
        for face in faces:
            for gateway in face:
                if views[gateway] != seen or gateway == out:
                    continue
                place, slot = divmod(gateway, slots)
                if paired and not possible_at[place] >> (step * slots + slot) & 1:
                    continue
                if not self._joins(path, self.path(gateway)):
                    continue
                if self._closed:
                    if due and due != [gateway]:
                        continue
                    if self.planar:
                        first, second = sorted((face.index(out), face.index(gateway)))
                        one, two = face[first + 1 : second], face[second + 1 :] + face[:first]
                        if (one and last(one) < step) or (two and last(two) < step):
                            continue
                arrivals.append(gateway)
        return arrivals

    def _joins(self, path: int, other: int) -> bool:
        if self._meets_once and self.meets[path] & self.meets[other]:
            return False
        return super()._joins(path, other)

    def _due(self, out: int, step: int) -> list[int]:
        """The other pending gateways that only the next step can still link."""
        if not self._closed:
            return []
        return [gateway for gateway, by in self.linked_by.items() if by < step and gateway != out]

    def _makes_place(self, out: int, step: int) -> bool:
        """Tell whether the next step may make a new place.

        The steps after it must still be able to link all pending gateways.
        """
        if not self._closed:
            return True
        future, pending = self.future, self.pending
        if future.place_by[step] < step:
            return False
        for kind, many in future.kinds_of[step]:
            more = pending[kind] + many - (kind == future.out[step])
            if more and future.last(kind, more) < step:
                return False
        if not self.planar:
            return True
        face = after(self.stars[step], step * self.slots) + after(self.face(out), out)
        return not face or future.last_of_face(face) >= step

    def enter(self, arrival: int) -> None:
        """Go one step on, to a gateway that is one of the children."""
        super().enter(arrival)
        step, link = self.steps, self._trail[-1]
        place, slot = divmod(arrival, self.slots)
        changed: dict[int, int] = {}
        self._before.append(_Before(place, {}, changed, self.in_time))
        if place == step:
            self.path_ends += self.dead_ends[place]
            self._count_place(place, 1)
        if link is not None and self._counted:
            if place == step:
                for gateway in self.stars[place]:
                    self.pending[self.views[gateway]] += 1
            self.pending[self.views[link.out]] -= 1
            self.pending[self.views[arrival]] -= 1
        if link is not None and self._closed:
            if place != step:
                changed[arrival] = self.linked_by.pop(arrival)
            changed[link.out] = self.linked_by.pop(link.out)
            self._enter_faces()
        self._narrow(place, slot)

    def _narrow(self, place: int, slot: int) -> bool:
        """Note that the last visit is at this place; tell whether fewer visits can be there now."""
        possible = self.possible_at.get(place)
        here = self.future.possible_visits(self.steps, slot)
        narrowed = here if possible is None else possible & here
        if narrowed == possible:
            return False
        before, linked_by = self._before[-1], self.linked_by
        if possible is not None:
            before.possible.setdefault(place, possible)
        self.possible_at[place] = narrowed
        if self._closed:
            for gateway in self.stars[place]:
                if gateway not in self.links:
                    if gateway in linked_by:
                        before.linked_by.setdefault(gateway, linked_by[gateway])
                    linked_by[gateway] = self.future.last_at(gateway, narrowed)
        return True

    def run(self) -> bool:
        """Go on over known links as far as possible; return False if there can be no map below.

        These steps are undone together with the last step that was entered.
        """
        begun, last = self.steps, self.experience.steps
        if begun == last or self.evidence or not self._before or self.out() not in self.links:
            return True
        slots, at, links, views = self.slots, self.at, self.links, self.views
        turns, seen, lying = self.future.turns, self.future.arrival, self.lying
        paired, until = self.future.paired, self._until()
        gateway, alive = at[-1], True
        for step in range(begun + 1, last + 1):
            out = gateway - gateway % slots + (gateway + turns[step]) % slots
            if out not in links or step in lying:
                break
            gateway = links[out]
            if views[gateway] != seen[step] or step > until:
                alive = False
                break
            if step <= paired:
                place, slot = divmod(gateway, slots)
                if not self.possible_at[place] >> (step * slots + slot) & 1:
                    alive = False
                    break
                self.steps = step
                if self._narrow(place, slot):
                    until = self._until()
            at.append(gateway)
        self.steps = len(at) - 1
        if self.steps > begun:
            self._before[-1] = self._before[-1]._replace(ran=self.steps - begun)
        return alive

    def _until(self) -> int:
        """The last step up to which known links can be followed while pending gateways wait."""
        last = self.experience.steps
        if not self._closed:
            return last
        kinds = (self.future.last(kind, n) for kind, n in enumerate(self.pending) if n)
        return min(last, self.in_time, *self.linked_by.values(), *kinds)

    def _enter_faces(self) -> None:
        if self.planar:
            last = self.future.last_of_face
            in_time = [last(face) for face in self.faces if face]
            self.in_time = min(in_time, default=self.experience.steps)

    def undo(self) -> None:
        """Go one step back, after going back over the known links that followed it."""
        before = self._before.pop()
        if before.ran:
            del self.at[-before.ran :]
            self.steps -= before.ran
        step, link, arrival = self.steps, self._trail[-1], self.at[-1]
        super().undo()
        place = before.place
        self.possible_at.update(before.possible)
        if place == step:
            del self.possible_at[place]
            self.path_ends -= self.dead_ends[place]
            self._count_place(place, -1)
        if link is not None and self._counted:
            self.pending[self.views[link.out]] += 1
            self.pending[self.views[arrival]] += 1
            if place == step:
                for gateway in self.stars[place]:
                    self.pending[self.views[gateway]] -= 1
        if not self._closed:
            return
        self.linked_by.update(before.linked_by)
        if place == step:
            for gateway in self.stars[place]:
                self.linked_by.pop(gateway, None)
        self.in_time = before.in_time

    def least(self) -> tuple[int, int]:
        """Proved lower bounds on the paths and places of each map below this node.

        A path has two ends, each of them at a pending gateway, or at a gateway with none opposite.
        In maps that need not be closed, gateways stay pending if the steps to come have too few
        ends of their kind.
        """
        ends = self.path_ends
        if not self._closed:
            left, step = self.future.left, self.steps
            for kind, many in enumerate(self.pending):
                if many:
                    ends += max(0, many - left(kind, step))
        return (ends + 1) // 2, self.least_places
