"""A second way to every count: the search of the paper's Figure 2, written plainly.

It shares nothing with the encodings or with the package: it reads bare facts, keeps
whole maps as dictionaries, and recomputes each property from its definition. It is
slow on purpose, and meant for small experiences.

An experience is ``(slots, views, turns, landmarks, marker, known)``: ``views[t]`` the set of slots
seen after step t, ``turns[t]`` the turn of step t (``turns[0]`` is unused),
``landmarks[t]`` the set of landmarks recognised after step t; ``marker`` is what was done
with the marker and when, as ``(t, "put")``, ``(t, "took")``, ``(t, "saw")``, or with the name of
another one, ``(t, "put", name)``; ``turns[t]`` is "start" or "look" of a step that is not a travel
step; ``known`` is a list of
what is known besides views: ``("compass", t, slot)``, ``("shift", t, x, y)``, ``("length", t, d)``,
``("same", t, u)``, ``("apart", t, u)``, ``("drift", percent)``, ``("stretch", percent)``,
``("straight", t, s, r)`` (with s = r: no other gateway is on that path), ``("tolerance", slots)``.
A hypothesis is the tuple of its ``(place, gateway)`` after each step, as ``at/3`` gives them.
"""

from itertools import combinations

RESTS = ("start", "look")


class Hypothesis:
    """A map, and the dstates through which the agent went."""

    def __init__(self, experience, at):
        self.slots, views, self.turns, *_, known = experience
        self.at, self.views = at, views
        told = [one[1:] for one in known if one[0] == "straight"]
        self.told = bool(told)
        self.pairs = {(t, a): b for t, s, r in told if s != r for a, b in ((s, r), (r, s))}
        self.inexact = any(one[0] == "tolerance" and one[1] for one in known)
        self.stars = {p: frozenset(views[p]) for p, _ in at}
        self.link = {}
        for t in range(1, len(at)):
            if self.turns[t] in RESTS:
                continue
            here, there = self.leaves(t), at[t]
            self.link[here], self.link[there] = there, here

    def leaves(self, t):
        return counterpart(self.slots, self.views, self.at, t - 1, self.turns[t], self.inexact)

    def gateways(self):
        return [(p, s) for p in sorted(self.stars) for s in sorted(self.stars[p])]

    def pending(self):
        return [g for g in self.gateways() if g not in self.link]

    def opposite(self, gateway):
        place, slot = gateway
        if isinstance(slot, str):  # what is behind a gateway that ends its path
            return place, int(slot)
        if self.told:
            return place, self.pairs.get(gateway, str(slot))
        return place, (slot + self.slots // 2) % self.slots

    def direction(self, heading):
        _, slot = heading
        if isinstance(slot, str):
            return (int(slot) + self.slots // 2) % self.slots
        return slot

    def ray(self, gateway):
        """Gateways of arrival when walking out of ``gateway`` straight on."""
        met = []
        while gateway in self.link:
            arrival = self.link[gateway]
            if arrival in met:
                break
            met.append(arrival)
            gateway = self.opposite(arrival)
        return met

    def breaks_path_axiom(self):
        return any(g[0] == a[0] for g in self.link for a in self.ray(g))

    def paths(self):
        """Each path as the ordered list of (place, heading slot)."""
        done, paths = set(), []
        for gateway in self.gateways():
            axis = frozenset((gateway, self.opposite(gateway)))
            if axis in done:
                continue
            back = self.ray(gateway)
            forth = [self.opposite(a) for a in self.ray(self.opposite(gateway))]
            path = [*reversed(back), self.opposite(gateway), *forth]
            # A path that is circular begins with the dstate that it ends with.
            axes = {frozenset((h, self.opposite(h))): h for h in path}
            done |= axes.keys()
            paths.append([*axes.values()])
        return paths

    def faces(self):
        """Faces as lists of directed links, each written as the gateway it leaves by."""
        faces, done = [], set()
        for dart in self.link:
            face = []
            while dart not in done:
                done.add(dart)
                face.append(dart)
                place, slot = self.link[dart]
                while True:
                    slot = (slot - 1) % self.slots
                    if (place, slot) in self.link:
                        break
                dart = place, slot
            if face:
                faces.append(face)
        return faces or [[]]

    def parts(self):
        """The components of the map, each as the set of its places."""
        parts = []
        for place in self.stars:
            near = {place}
            while more := {q for (p, _), (q, _) in self.link.items() if p in near} - near:
                near |= more
            if near not in parts:
                parts.append(near)
        return parts

    def euler(self):
        """|V| - |E| + faces of all components, less 2 for each one but the first."""
        parts = self.parts()
        bare = sum(len(part) == 1 and not any(p in part for p, _ in self.link) for part in parts)
        faces = len(self.faces()) * bool(self.link) + bare
        return len(self.stars) - len(self.link) // 2 + faces - 2 * (len(parts) - 1)

    def genus(self):
        return (2 - self.euler()) // 2

    def one_face(self, g, h):
        """Whether two pending gateways lie on one face of the map."""

        def corner(gateway):
            place, slot = gateway
            for _ in range(self.slots):
                slot = (slot - 1) % self.slots
                if (place, slot) in self.link:
                    return place, slot
            return None

        if not any({g[0], h[0]} <= part for part in self.parts()):
            return True
        if corner(g) is None or corner(h) is None:
            return True
        return any(corner(g) in face and corner(h) in face for face in self.faces())

    def closed(self):
        return not self.pending()

    def travelled(self):
        return all(
            any({h, self.opposite(h)} & self.link.keys() for h in path) for path in self.paths()
        )

    def perpendicular(self):
        places = [{p for p, _ in path} for path in self.paths()]
        if any(len(a & b) > 1 for a, b in combinations(places, 2)):
            return False
        for a, b, c in combinations(places, 3):
            if a & b and b & c and a & c and len((a & b) | (b & c) | (a & c)) == 3:
                return False
        return True

    def sides(self):
        """Of each path its places, and those right and left of it."""
        for path in self.paths():
            on, left, right = {p for p, _ in path}, set(), set()
            for heading in path:
                place, ahead = heading[0], self.direction(heading)
                behind = self.direction(self.opposite(heading))
                side = right
                for turn in range(1, self.slots):
                    slot = (ahead + turn) % self.slots
                    if slot == behind:
                        side = left
                    else:
                        side |= {p for p, _ in self.ray((place, slot))}
            yield on, right, left

    def boundary(self):
        """Whether there is no exception. Where opposite gateways are on one path, and the path
        axiom holds, then no place is on a path and beside it, either."""
        consistent = not any(self.exceptions())
        if not self.told and not self.breaks_path_axiom():
            sides = self.sides()
            assert consistent != any(a & b for three in sides for a, b in combinations(three, 2))
        return consistent

    def exceptions(self):
        """How many pairs of paths share two places, paths hold a place twice, and places are on
        both sides of a path."""
        places = [{p for p, _ in path} for path in self.paths()]
        pairs = sum(len(a & b) > 1 for a, b in combinations(places, 2))
        again = sum(len({p for p, _ in path}) < len(path) for path in self.paths())
        return pairs, again, sum(len(left & right) for _, right, left in self.sides())

    def cost(self):
        return len(self.paths()), len(self.stars)

    def worth(self):
        """What the best of the closed maps have the least of: exceptions, paths, places."""
        return sum(self.exceptions()), *self.cost()

    def names(self):
        """The paths, each by the first step along it, or by its place and lower slot there, and
        the places: what circumscription compares (docs/circumscription.md)."""
        paths = set()
        for path in self.paths():
            ends = {*path} | {self.opposite(h) for h in path}
            steps = [
                t
                for t in range(1, len(self.at))
                if self.turns[t] not in RESTS and self.leaves(t) in ends
            ]
            place, slot = min((p, s) for p, s in ends if not isinstance(s, str))
            slot = slot if self.told else slot % (self.slots // 2)
            paths.add(("first", steps[0]) if steps else ("axis", place, slot))
        return frozenset(paths), frozenset(self.stars)


def counterpart(slots, views, at, t, slot, inexact):
    """The gateway of the place of visit t that is seen there in this slot."""
    place, gateway = at[t]
    if not inexact:
        return place, (gateway + slot) % slots
    # The gateways of both are numbered clockwise, from the one stood at.
    here = sorted(views[t], key=lambda other: other % slots)
    there = sorted(views[place], key=lambda other: (other - gateway) % slots)
    return place, there[here.index(slot)]


def marked(marker, at):
    """Whether after the last step each marker is seen if it is where the agent is, and not
    else: its whole story is followed again."""
    for name in {tuple(mark[2:]) for mark in marker}:
        lies = None
        for t, (place, _) in enumerate(at):
            sees = (t, "saw", *name) in marker or (t, "took", *name) in marker
            here = lies == place
            ready = lies is not None
            if (t, "took", *name) in marker:
                lies = None
            if (t, "put", *name) in marker:
                lies = place
        if ready and sees != here:
            return False
    return True


def contradicts(experience, at):
    """Whether dstates contradict what is known besides views: each statement is compared with each
    pair of steps, by its definition."""
    slots, views, turns, _, _, known = experience
    told = {}
    for name, *rest in known:
        told.setdefault(name, []).append(rest)
    last = len(at) - 1
    compass = dict(told.get("compass", []))
    shift = {t: (x, y) for t, x, y in told.get("shift", [])}
    length = dict(told.get("length", []))
    (drift,), (stretch,) = told.get("drift", [[10]])[0], told.get("stretch", [[10]])[0]
    ((tolerance,),) = told.get("tolerance", [[0]])
    for t, u in combinations(range(last + 1), 2):
        if at[t][0] != at[u][0]:
            continue
        # The compass slot of the place's gateway 0 is one, whichever visit tells it.
        zeros = [(compass[v] - at[v][1]) % slots for v in (t, u) if v in compass]
        if len(zeros) > 1 and apart(slots, *zeros) > tolerance:
            return True
        between = [*range(t + 1, u + 1)] if shift else []
        if any(turns[step] == "start" for step in between):
            continue
        between = [step for step in between if turns[step] != "look" or step in shift]
        if all(step in shift for step in between):
            moved = [sum(shift[step][axis] for step in between) for axis in (0, 1)]
            way = sum(abs(shift[step][0]) + abs(shift[step][1]) for step in between)
            if 100 * max(abs(moved[0]), abs(moved[1])) > drift * way:
                return True
    if any(at[t][0] != at[u][0] for t, u in told.get("same", []) if max(t, u) <= last):
        return True
    if any(at[t][0] == at[u][0] for t, u in told.get("apart", []) if max(t, u) <= last):
        return True

    def link(t):
        return {counterpart(slots, views, at, t - 1, turns[t], tolerance), at[t]}

    return any(
        turns[t] not in RESTS
        and turns[u] not in RESTS
        and t in length
        and u in length
        and link(t) == link(u)
        and 100 * abs(length[t] - length[u]) > stretch * max(length[t], length[u])
        for t, u in combinations(range(1, last + 1), 2)
    )


def apart(slots, one, other):
    """How many slots lie between two, round the circle."""
    return min((one - other) % slots, (other - one) % slots)


def on_one_path(experience, t):
    """The pairs of slots of visit t whose gateways are on one path."""
    slots, views, *_, known = experience
    told = [one[1:] for one in known if one[0] == "straight"]
    if told:
        return {frozenset((s, r)) for step, s, r in told if step == t and s != r}
    return {frozenset((s, r)) for s, r in combinations(views[t], 2) if 2 * abs(s - r) == slots}


def looks_alike(experience, t, place, gateway):
    """Whether visit t sees what is seen from this gateway of a place, except for landmarks."""
    slots, views, *_, known = experience
    (tolerance,) = [one[1] for one in known if one[0] == "tolerance"] or [0]
    here = sorted(views[t])
    there = sorted(views[place], key=lambda other: (other - gateway) % slots)
    if len(here) != len(there):
        return False
    if any(
        apart(slots, s - here[0], r - gateway) > tolerance for s, r in zip(here, there, strict=True)
    ):
        return False
    same = dict(zip(here, there, strict=True))
    pairs = {frozenset(same[s] for s in pair) for pair in on_one_path(experience, t)}
    return pairs == on_one_path(experience, place)


def tree(experience, planar=False, bound=None, axiom=True):
    """All hypotheses by step: a list of lists, one for each step from 0 (Figure 2); with or without
    the path axiom."""
    slots, views, turns, landmarks, marker, known = experience
    levels = [[((0, 0),)]]
    for t in range(1, len(turns)):
        level = []
        for at in levels[-1]:
            before = Hypothesis(experience, at)

            def fits(p, s, t=t):
                return looks_alike(experience, t, p, s) and landmarks[p] == landmarks[t]

            if turns[t] in RESTS:
                arrivals = [at[-1]] if turns[t] == "look" else [*before.gateways(), (t, 0)]
                for arrival in arrivals:
                    child = *at, arrival
                    after = Hypothesis(experience, child)
                    if (arrival != (t, 0) and not fits(*arrival)) or not marked(marker, child):
                        continue
                    if known and contradicts(experience, child):
                        continue
                    if bound is None or len(after.stars) <= bound:
                        level.append(child)
                continue
            x = counterpart(slots, views, before.at, t - 1, turns[t], before.inexact)
            if x in before.link:
                child = *at, before.link[x]
                fitting = fits(*before.link[x]) and marked(marker, child)
                if fitting and not (known and contradicts(experience, child)):
                    level.append(child)
                continue
            arrivals = [g for g in before.pending() if g != x and fits(*g)]
            if planar:
                arrivals = [g for g in arrivals if before.one_face(x, g)]
            for arrival in [*arrivals, (t, 0)]:
                child = (*at, arrival)
                after = Hypothesis(experience, child)
                if (axiom and after.breaks_path_axiom()) or not marked(marker, child):
                    continue
                if known and contradicts(experience, child):
                    continue
                if bound is not None and len(after.stars) > bound:
                    continue
                level.append(child)
        levels.append(level)
    return levels


def best(experience, hypotheses, closed=True):
    """Those with the fewest exceptions to consistent boundaries, then the fewest paths, then the
    fewest places."""
    maps = [Hypothesis(experience, at) for at in hypotheses]
    worth = {m.at: m.worth() for m in maps if m.closed() or not closed}
    least = min(worth.values(), default=None)
    return {at for at, one in worth.items() if one == least}


def circumscribed(maps):
    """Those maps that none of them is preferred to: each is compared with each."""
    names = {m.at: m.names() for m in maps}

    def preferred(one, other):
        return one[0] < other[0] or (one[0] == other[0] and one[1] < other[1])

    return {at for at in names if not any(preferred(other, names[at]) for other in names.values())}


def certain(hypotheses):
    """What is so in all of them: the pairs of steps at one place, and the steps at new places."""
    steps = range(len(hypotheses[0]))
    same = {
        (t, u) for t, u in combinations(steps, 2) if all(h[t][0] == h[u][0] for h in hypotheses)
    }
    return same, {t for t in steps if all(h[t][0] == t for h in hypotheses)}
