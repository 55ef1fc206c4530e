"""The hypotheses that remain while an experience goes on.

This is the paper's search (Figure 2), breadth-first, without knowledge of the steps to come. Each
hypothesis is a map (``Form``) and the last visit of its way (``Visit``), which knows the visit
before. A map is never changed: a step along a known link shares the map of the step before, and a
step that adds a link or a place makes a new map. So a step costs at most as much as the map is
large, however long the log is, and a step that was taken back leaves no trace.

It is written from the definitions, like ``hypothesis.py``, and with its names: a gateway is the
number ``place * slots + slot``, and a place is named by the step at which it was first visited.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from topomap.model.exceptions import NamedException, named_exceptions
from topomap.model.experience import DState, Experience, Step
from topomap.model.topology import TopologicalMap
from topomap.search.hypothesis import Face, face_of, linked

# Where a sequence of shifts began; the position by them; the length.
Track = tuple[int, int, int, int]
Sides = tuple[int, int, int, int]
# For the visits of a place: the compass slots of its slot 0; the sequence of shifts of its last
# visits, and the least of their ``_sides``.
Known = tuple[frozenset[int], int, Sides]
NOTHING: Known = frozenset(), -1, (0, 0, 0, 0)


class Visit:
    """A visit of a way: the gateway of the agent, and the visit before.

    ``jump`` is a visit long before, so that any visit is found in few steps.
    """

    __slots__ = ("before", "gateway", "jump", "step")

    def __init__(self, gateway: int, before: "Visit | None" = None):
        self.gateway = gateway
        self.step = 0
        self.before = self.jump = self
        if before is not None:
            far = before.jump
            even = before.step - far.step == far.step - far.jump.step
            self.step, self.before = before.step + 1, before
            self.jump = far.jump if even else before

    def back(self, step: int) -> "Visit":
        """The visit after an earlier step, or after this one."""
        visit = self
        while visit.step > step:
            visit = visit.jump if visit.jump.step >= step else visit.before
        return visit

    def gateways(self, since: int = 0) -> list[int]:
        """The gateways of the way, from a step to this visit."""
        found, visit = [], self
        while visit.step > since:
            found.append(visit.gateway)
            visit = visit.before
        found.append(visit.gateway)
        return found[::-1]


@dataclass(frozen=True)
class Star:
    """What a visit sees, as a place of its own.

    It has the gateways counter-clockwise, what is seen from each (as a number), and the axis of
    each.
    """

    face: Face
    views: Mapping[int, int]
    axis: Mapping[int, int]

    @cached_property
    def axes(self) -> tuple[int, ...]:
        """The axes of the place."""
        return tuple(dict.fromkeys(self.axis.values()))

    @cached_property
    def ranks(self) -> dict[int, int]:
        """The gateways, each with its number, clockwise."""
        return {gateway: rank for rank, gateway in enumerate(reversed(self.face))}


class Told:
    """What is known of the steps so far, and what follows from that alone.

    It grows with each step, and shrinks when steps are taken back.
    """

    def __init__(self, slots: int, first: Step, drift: int, stretch: int, tolerance: int):
        self.slots, self.drift, self.stretch = slots, drift, stretch
        self.tolerance = tolerance
        self.straight = first.straight is not None
        self.steps: list[Step] = []
        self.tracks: list[Track] = []
        # For each step, the number of what is seen from the agent's gateway.
        self.arrivals: list[int] = []
        # The markers that lie somewhere before each step, each with the step that put it down.
        self.down: list[dict[str | None, int]] = []
        self.starts = 0  # the number of logs after the first one
        self.without_compass = 0  # the number of visits without a compass
        self._numbers: dict[Any, int] = {}
        self._stars: dict[int, Star] = {}
        self.add(first)

    @property
    def last(self) -> int:
        """The last step."""
        return len(self.steps) - 1

    def add(self, step: Step) -> None:
        """Go a step on."""
        number = len(self.steps)
        self.down.append(self.lying() if number else {})
        self.steps.append(step)
        shift = (0, 0) if step.shift is None and step.look else step.shift
        begun, x, y, way = self.tracks[-1] if number else (0, 0, 0, 0)
        if shift is None or step.start or not number:
            self.tracks.append((number, 0, 0, 0))
        else:
            right, up = shift
            self.tracks.append((begun, x + right, y + up, way + abs(right) + abs(up)))
        self.arrivals.append(self._seen_from(number, 0))
        self.starts += step.start
        self.without_compass += step.compass is None

    def cut(self, last: int) -> None:
        """Take steps back until this one is the last."""
        for number in range(last + 1, len(self.steps)):
            self.starts -= self.steps[number].start
            self.without_compass -= self.steps[number].compass is None
            self._stars.pop(number, None)
        for of in (self.steps, self.tracks, self.arrivals, self.down):
            del of[last + 1 :]

    def lying(self) -> dict[str | None, int]:
        """The markers that lie somewhere after the last step, each with the step that put it down.

        (After one step, a marker is taken up before it is put down.)
        """
        number = self.last
        step, down = self.steps[number], self.down[number]
        done = [(kind, None) for kind in step.marks] + [*step.things]
        picked = {name for kind, name in done if kind == "pick"}
        put = {name: number for kind, name in done if kind == "drop"}
        if not picked and not put:
            return down
        return {name: at for name, at in down.items() if name not in picked} | put

    def spotted(self, step: int) -> Iterator[tuple[int, bool]]:
        """The markers that lie somewhere before a step.

        Each comes with the step that put it down, and whether this step sees it.
        """
        if self.down[step]:
            told = self.steps[step]
            seen: set[str | None] = {None} if told.marks & {"pick", "marker"} else set()
            seen |= {name for kind, name in told.things if kind != "drop"}
            for name, at in self.down[step].items():
                yield at, name in seen

    def star(self, step: int) -> Star:
        """What a visit sees, as a place of its own."""
        if step not in self._stars:
            slots, told = self.slots, self.steps[step]
            first = step * slots
            face = tuple(first + slot for slot in sorted(told.view, reverse=True))
            views = {first + slot: self._seen_from(step, slot) for slot in told.view}
            pairs = {slot: min(pair) for pair in told.straight or () for slot in pair}
            axis = {
                first + slot: first
                + (pairs.get(slot, slot) if self.straight else slot % (slots // 2))
                for slot in told.view
            }
            self._stars[step] = Star(face, views, axis)
        return self._stars[step]

    def _seen_from(self, step: int, slot: int) -> int:
        """The number of what a visit sees from that slot."""
        told, slots = self.steps[step], self.slots
        seen = frozenset((other - slot) % slots for other in told.view)
        pairs = frozenset(
            frozenset((other - slot) % slots for other in pair)
            for pair in (told.straight or ())
            if pair[0] != pair[1]
        )
        return self._numbers.setdefault((seen, told.landmarks, pairs), len(self._numbers))

    def alike(self, gateway: int, step: int) -> bool:
        """Tell whether a step sees what is seen from this gateway."""
        place, slot = divmod(gateway, self.slots)
        if not self.tolerance:
            return self.star(place).views[gateway] == self.arrivals[step]
        return self._two(place, step).alike(0, slot, 1)

    def out(self, gateway: int, step: int) -> int:
        """The gateway by which a travel leaves, if the agent is at this one before it."""
        turn, (place, slot) = self.steps[step].turn, divmod(gateway, self.slots)
        assert turn is not None
        return place * self.slots + self.slot_at(place, slot, step - 1, turn)

    def slot_at(self, place: int, slot: int, visit: int, seen: int) -> int:
        """Translate a slot of a visit into a slot of its place, as ``Experience.slot_at`` does."""
        if not self.tolerance:
            return (slot + seen) % self.slots
        return self._two(place, visit).slot_at(0, slot, 1, seen)

    def _two(self, place: int, visit: int) -> Experience:
        """An experience of these two visits alone."""
        both = self.steps[place], self.steps[visit]
        return Experience(
            self.slots,
            [step.view for step in both],
            [0],
            [step.landmarks for step in both],
            straight=[step.straight or () for step in both] if self.straight else (),
            tolerance=self.tolerance,
        )

    def experience(self) -> Experience:
        """The experience so far; making it takes time in proportion to its length."""
        return experience_of(self.slots, self.steps, self.drift, self.stretch, self.tolerance)


def experience_of(
    slots: int, steps: Sequence[Step], drift: int, stretch: int, tolerance: int
) -> Experience:
    """Make the experience of these steps."""
    moving = steps[1:]
    numbered = [*enumerate(steps)]
    drops, picks, markers = (
        [number for number, step in numbered if kind in step.marks]
        for kind in ("drop", "pick", "marker")
    )
    return Experience(
        slots,
        [step.view for step in steps],
        [step.turn for step in moving],
        [step.landmarks for step in steps],
        drops,
        picks,
        markers,
        compass=[step.compass for step in steps],
        shifts=[step.shift for step in moving],
        lengths=[step.length for step in moving],
        same=[(one, number) for number, step in numbered for one in step.same],
        apart=[(one, number) for number, step in numbered for one in step.apart],
        drift=drift,
        stretch=stretch,
        starts=[number for number, step in numbered if step.start],
        looks=[number for number, step in numbered if step.look],
        things=[(kind, number, name) for number, step in numbered for kind, name in step.things],
        straight=[step.straight or () for step in steps] if steps[0].straight is not None else (),
        tolerance=tolerance,
    )


class Form:
    """A map.

    ``links`` joins gateways in both directions. ``faces`` has for each face its pending gateways,
    in the order of its walk. ``paths`` has for each path the set of its places, as bits, by the
    ``number`` of each place. ``made`` has the step that made each link, by the lower gateway of the
    link.
    """

    __slots__ = (
        *(
            "_exceptions",
            "_world",
            "components",
            "faces",
            "joined",
            "links",
            "made",
            "number",
            "part",
        ),
        "paths",
    )

    def __init__(self, before: "Form | None" = None):
        self.links: dict[int, int] = {**before.links} if before else {}
        self.made: dict[int, int] = {**before.made} if before else {}
        self.faces: tuple[Face, ...] = before.faces if before else ()
        self.paths: dict[int, int] = {**before.paths} if before else {}
        self.joined: dict[int, int] = {**before.joined} if before else {}
        self.number: dict[int, int] = before.number if before else {}
        self.part: dict[int, int] = before.part if before else {}
        self.components: int = before.components if before else 0
        self._exceptions: tuple[NamedException, ...] | None = None
        self._world: TopologicalMap | None = None

    @property
    def cost(self) -> tuple[int, int]:
        """The numbers of paths and places."""
        return len(self.paths), len(self.number)

    @property
    def closed(self) -> bool:
        """Whether no gateway is pending."""
        return not any(self.faces)

    @property
    def sizes(self) -> tuple[int, int, int, int, int]:
        """The numbers of places, links and paths, the genus, and the number of pending gateways."""
        places, links = len(self.number), len(self.links) // 2
        genus = (2 * self.components - places + links - len(self.faces)) // 2
        return places, links, len(self.paths), genus, sum(map(len, self.faces))

    def face(self, gateway: int) -> Face:
        """The face on which a pending gateway lies."""
        return face_of(self.faces, gateway)

    def component(self, place: int) -> int:
        """The component of the map to which a place belongs, named by one of its places."""
        while place in self.part:
            place = self.part[place]
        return place

    def path(self, axis: int) -> int:
        """The path on which an axis lies, named by one of its axes."""
        while axis in self.joined:
            axis = self.joined[axis]
        return axis

    def with_place(self, place: int, star: Star) -> "Form":
        """The map with one more place, which has no link."""
        form = Form(self)
        form._add_place(place, star)
        form.faces = (*self.faces, star.face)
        form.components += 1
        return form

    def _add_place(self, place: int, star: Star) -> None:
        self.number = {**self.number, place: len(self.number)}
        for axis in star.axes:
            self.paths[axis] = 1 << self.number[place]

    def with_link(self, out: int, arrival: int, step: int, told: Told) -> "Form":
        """The map with the link that a step makes."""
        form = Form(self)
        place = arrival // told.slots
        star = told.star(step) if place == step else None
        if star:
            form._add_place(step, star)
        form.faces = linked(self.faces, out, arrival, star.face if star else None)
        parts = self.component(out // told.slots), self.component(place)
        if parts[0] != parts[1]:
            form.part = {**self.part, parts[1]: parts[0]}
            form.components -= place != step
        form.links[out], form.links[arrival] = arrival, out
        form.made[min(out, arrival)] = step
        path, other = form.path_of(out, told), form.path_of(arrival, told)
        if path != other:  # otherwise the path is circular now
            form.joined[other] = path
            form.paths[path] |= form.paths.pop(other)
        return form

    def path_of(self, gateway: int, told: Told) -> int:
        """The path on which a gateway lies."""
        return self.path(told.star(gateway // told.slots).axis[gateway])

    def world(self, told: Told) -> TopologicalMap:
        """The same map as a TopologicalMap."""
        if self._world is None:
            self._world = self._as_world(told)
        return self._world

    def _as_world(self, told: Told) -> TopologicalMap:
        slots = told.slots
        links = {divmod(one, slots): divmod(other, slots) for one, other in self.links.items()}
        steps = {place: told.steps[place] for place in self.number}
        across = None
        if told.straight:
            across = {
                (place, one): (place, other)
                for place, step in steps.items()
                for pair in step.straight or ()
                if pair[0] != pair[1]
                for one, other in (pair, pair[::-1])
            }
        stars = {place: step.view for place, step in steps.items()}
        landmarks = {place: step.landmarks for place, step in steps.items()}
        return TopologicalMap(slots, stars, links, landmarks, across)

    def exceptions(self, told: Told) -> tuple[NamedException, ...]:
        """The exceptions to consistent boundaries, each with its paths."""
        if self._exceptions is None:
            world = self.world(told)
            first: dict[DState, int] = {}
            for gateway, step in self.made.items():
                for end in (gateway, self.links[gateway]):
                    first.setdefault(divmod(end, told.slots), step)
            self._exceptions = tuple(named_exceptions(world, first))
        return self._exceptions


class Living:
    """A hypothesis: a map, and the last visit of the way.

    ``known`` has for each place what is known of its visits besides views. ``along`` has for each
    link, by its lower gateway, the smallest and the largest length of the steps along it.
    """

    __slots__ = ("along", "form", "known", "visit")

    def __init__(
        self,
        form: Form,
        visit: Visit,
        known: Mapping[int, Known],
        along: Mapping[int, tuple[int, int]],
    ):
        self.form, self.visit, self.known, self.along = form, visit, known, along


class Tree:
    """Which hypotheses are children of which; they meet the demands."""

    def __init__(
        self, told: Told, planar: bool = False, bound: int | None = None, path_axiom: bool = True
    ):
        self.told, self.planar, self.bound, self.path_axiom = told, planar, bound, path_axiom

    def root(self) -> Living:
        """The hypothesis after step 0."""
        told, visit = self.told, Visit(0)
        form = Form().with_place(0, told.star(0))
        compass = told.steps[0].compass
        known = {} if compass is None else self._noted({}, visit, compass)
        return Living(form, visit, known, {})

    def children(self, of: Living) -> list[int]:
        """The gateways at which the next step can arrive, in ascending order.

        ``Hypothesis.children`` explains them.
        """
        told, form, step = self.told, of.form, of.visit.step + 1
        full = self.bound is not None and len(form.number) >= self.bound
        new = [] if full else [step * told.slots]
        if told.steps[step].look:
            near, new = [of.visit.gateway], []
        elif told.steps[step].start:
            near = [gateway for place in form.number for gateway in told.star(place).face]
        else:
            out = told.out(of.visit.gateway, step)
            if out in form.links:
                near, new = [form.links[out]], []
            else:
                near = [gateway for gateway in self._near(form, out) if gateway != out]
                if self.path_axiom:
                    mine = form.paths[form.path_of(out, told)]
                    near = [g for g in near if not mine & form.paths[form.path_of(g, told)]]
        near = [gateway for gateway in near if told.alike(gateway, step)]
        return sorted(gateway for gateway in near + new if self._allowed(of, gateway, step))

    def _near(self, form: Form, out: int) -> list[int]:
        """The pending gateways to which this one can be linked, in a planar map or in any map."""
        if not self.planar:
            return [gateway for face in form.faces for gateway in face]
        near = [*form.face(out)]
        if self.told.starts:
            here = form.component(out // self.told.slots)
            for face in form.faces:
                if face and form.component(face[0] // self.told.slots) != here:
                    near += face
        return near

    def _allowed(self, of: Living, gateway: int, step: int) -> bool:
        """Tell whether a step can arrive at this gateway by what is known besides views."""
        told = self.told
        place, slot = divmod(gateway, told.slots)
        now = told.steps[step]

        def was(earlier: int) -> int:
            """The place of the agent after an earlier step."""
            return of.visit.back(earlier).gateway // told.slots

        if any(seen != (was(down) == place) for down, seen in told.spotted(step)):
            return False
        if any(was(earlier) != place for earlier in now.same if earlier < step):
            return False
        if any(was(earlier) == place for earlier in now.apart):
            return False
        norths, begun, bounds = of.known.get(place, NOTHING)
        if now.compass is not None:
            for north in norths:
                off = (north + slot - now.compass) % told.slots
                if min(off, told.slots - off) > told.tolerance:
                    return False
        track = told.tracks[step]
        if track[0] == step - 1 and was(step - 1) == place:
            begun, bounds = step - 1, (0, 0, 0, 0)
        if track[0] == begun:
            here = self._sides(track)
            if any(side > bound for side, bound in zip(here, bounds, strict=True)):
                return False
        if now.length is not None:
            link = min(told.out(of.visit.gateway, step), gateway)
            for other in of.along.get(link, ()):
                most = max(now.length, other)
                if 100 * abs(now.length - other) > told.stretch * most:
                    return False
        return True

    def _sides(self, track: Track) -> Sides:
        """Where the agent is by odometry, towards each of four sides, minus the possible error.

        A visit can be of the place of an earlier one if none of these numbers exceeds that of the
        earlier one. This is equivalent to the rule 100 * |x - u| <= drift * (way - less).
        """
        _, x, y, way = track
        error = self.told.drift * way
        return 100 * x - error, -100 * x - error, 100 * y - error, -100 * y - error

    def enter(self, of: Living, arrival: int) -> Living:
        """The hypothesis after one more step, to a gateway that is one of the children."""
        told, form, step = self.told, of.form, of.visit.step + 1
        now, along = told.steps[step], of.along
        if now.look or now.start:
            if arrival // told.slots == step:
                form = form.with_place(step, told.star(step))
        else:
            out = told.out(of.visit.gateway, step)
            if out not in form.links:
                form = form.with_link(out, arrival, step, told)
            if now.length is not None:
                link = min(out, arrival)
                few, many = along.get(link, (now.length, now.length))
                along = {**along, link: (min(few, now.length), max(many, now.length))}
        known, visit = of.known, Visit(arrival, of.visit)
        if told.tracks[step][0] == step - 1:  # only now does the visit before it count
            known = self._noted(known, of.visit, None)
        if now.compass is not None or told.tracks[step][0] < step:
            known = self._noted(known, visit, now.compass)
        return Living(form, visit, known, along)

    def _noted(
        self, known: Mapping[int, Known], visit: Visit, compass: int | None
    ) -> Mapping[int, Known]:
        """What is known of places after one more visit."""
        told = self.told
        place, slot = divmod(visit.gateway, told.slots)
        norths, begun, bounds = known.get(place, NOTHING)
        if compass is not None:
            norths |= {(compass - slot) % told.slots}
        track = told.tracks[visit.step]
        sides = self._sides(track)
        if begun == track[0]:
            a, b, c, d = map(min, sides, bounds)
            sides = a, b, c, d
        return {**known, place: (norths, track[0], sides)}
