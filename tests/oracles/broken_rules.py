"""Hypotheses that may break any rule: all dstates after the steps, and which rules they break,
each written from its definition. Shares nothing with the encodings; for tiny experiences."""


class Assignment:
    """Any dstates after the steps: a place visited before, or a new one."""

    def __init__(self, experience, at, bound=None):
        self.experience, self.at, self.bound = experience, at, bound
        self.slots, self.half = experience.slots, experience.slots // 2
        self.ways = [(self.named(t, turn), at[t + 1]) for t, turn in enumerate(experience.turns)]
        self.new = [step for step, (place, _) in enumerate(at) if place == step]
        self.linked = {end for way in self.ways for end in way}

    def broken(self, reason):
        kind, _, rest = reason.partition("(")
        numbers = [int(n) for n in rest.rstrip(")").split(",")] if rest else []
        return getattr(self, kind)(*numbers)

    def named(self, t, slot):
        """The gateway of its place that visit t sees in this slot. Where bearings are not exact,
        those of both are numbered clockwise from the one stood at, and are as many."""
        place, gateway = self.at[t]
        if not self.experience.tolerance:
            return place, (gateway + slot) % self.slots
        star = sorted(self.experience.views[place])
        return place, star[
            (star.index(gateway) + sorted(self.experience.views[t]).index(slot)) % len(star)
        ]

    def view(self, t, p):
        if self.at[t][0] != self.at[p][0]:
            return False
        seen, inexact = self.experience, self.experience.tolerance
        here, there = ({self.named(v, s) for s in seen.views[v]} for v in (t, p))
        if here != there or seen.landmarks[t] != seen.landmarks[p]:
            return True
        if self.at[p][0] == p and inexact:
            turns = ((self.named(t, s)[1] - self.at[t][1] - s) % self.slots for s in seen.views[t])
            if any(min(turn, self.slots - turn) > inexact for turn in turns):
                return True
        return self.pairs(t) != self.pairs(p)

    def pairs(self, t):
        """Which gateways of its place visit t takes to be on one path."""
        seen = self.experience
        told = seen.straight[t] if seen.straight else ()
        if not seen.straight:
            told = [(s, s + self.half) for s in seen.views[t] if s + self.half in seen.views[t]]
        return {frozenset(self.named(t, s) for s in pair) for pair in told}

    def axis(self, gateway):
        """The gateways on one path with this one at its place, as its first visit has it; where
        opposite ones are, and bearings are exact, whether they are seen or not."""
        place, slot = gateway
        seen = self.experience
        if not seen.straight and not seen.tolerance:
            return frozenset([gateway, (place, (slot + self.half) % self.slots)])
        told = [pair for pair in self.pairs(place) if gateway in pair]
        return told[0] if told else frozenset([gateway])

    def marker(self, t):
        e, down = self.experience, None
        for step in range(t):
            down = None if step in e.picks else down
            down = step if step in e.drops else down
        seen = t in e.markers or t in e.picks
        return down is not None and seen != (self.at[t][0] == self.at[down][0])

    def compass(self, t, u):
        slots = {v: self.experience.compass[v] for v in (t, u)}
        zeros = {
            (slot - self.at[v][1]) % self.slots for v, slot in slots.items() if slot is not None
        }
        off = {(one - other) % self.slots for one in zeros for other in zeros}
        far = any(min(d, self.slots - d) > self.experience.tolerance for d in off)
        return self.at[t][0] == self.at[u][0] and far

    def odometry(self, t, u):
        moved = self.experience.shifts[t:u]
        if None in moved:
            return False
        way = sum(abs(x) + abs(y) for x, y in moved)
        far = max(abs(sum(shift[axis] for shift in moved)) for axis in (0, 1))
        return self.at[t][0] == self.at[u][0] and 100 * far > self.experience.drift * way

    def length(self, t, u):
        one, other = self.experience.lengths[t - 1], self.experience.lengths[u - 1]
        if one is None or other is None:
            return False
        unlike = 100 * abs(one - other) > self.experience.stretch * max(one, other)
        return unlike and self.ways[u - 1][1] in self.ways[t - 1]

    def same(self, t, u):
        return (t, u) in self.experience.same and self.at[t][0] != self.at[u][0]

    def apart(self, t, u):
        return (t, u) in self.experience.apart and self.at[t][0] == self.at[u][0]

    def schema(self, t, u):
        (out, end), (other, arrival) = self.ways[t - 1], self.ways[u - 1]
        return (out == other) != (end == arrival)

    def unification(self, t, u):
        (out, end), (other, arrival) = self.ways[t - 1], self.ways[u - 1]
        return (end == other) != (out == arrival)

    def itself(self, t):
        out, end = self.ways[t - 1]
        return out == end

    def runs(self):
        """Of each run the gateways by which it passes its visits: by which it leaves the first one,
        and arrives at the others."""
        runs, seen = {}, self.experience
        for t, (out, arrival) in enumerate(self.ways, 1):
            turn = seen.turns[t - 1]
            on = turn == self.half
            if seen.straight:
                on = turn != 0 and tuple(sorted((0, turn))) in seen.straight[t - 1]
            if t == 1 or not on:
                runs[t] = {t - 1: out}
                last = t
            runs[last][t] = arrival
        return runs

    def axes(self, run):
        return {(gateway[0], self.axis(gateway)) for gateway in self.runs()[run].values()}

    def path(self, run):
        """The runs on one path with it."""
        runs, met = self.runs(), {run}
        while more := {b for b in runs if b not in met and
                       any(self.axes(a) & self.axes(b) for a in met)}:  # fmt: skip
            met |= more
        return met

    def twice(self, t, u):
        on = any({t, u} <= set(run) for run in self.runs().values())
        return on and self.at[t][0] == self.at[u][0]

    def crossed(self, a, b):
        return (
            a < b
            and b in self.path(a)
            and any(p == q and x != y for p, x in self.axes(a) for q, y in self.axes(b))
        )

    def circular(self, a):
        if a not in self.runs() or a != min(self.path(a)):
            return False
        axes = [axis for run in self.path(a) for _, axis in self.axes(run)]
        return all(len(axis) > 1 and axis <= self.linked for axis in axes)

    def fresh(self, t):
        return not any(self.ways[t - 1][0] in way for way in self.ways[: t - 1])

    def planar(self, t, u):
        """Where a gateway comes on the walk round the tree: after all that is beyond it."""

        def key(gateway):
            place, slot = gateway
            return (*(key(self.ways[place - 1][0])[:-1] if place else ()), slot, self.slots)

        def chord(t):
            return self.fresh(t) and t not in self.new

        def between(end):
            place, slot = end
            seen = slot in self.experience.views[place]
            return seen and sum(key(end) < key(other) for other in self.ways[u - 1]) == 1

        out, end = self.ways[t - 1]
        return chord(t) and chord(u) and between(out) != between(end)

    def closed(self, p, s):
        return p in self.new and s in self.experience.views[p] and (p, s) not in self.linked

    def travelled(self, p, s):
        ends = {(p, s), (p, (s + self.half) % self.slots)}
        there = any(end[1] in self.experience.views[p] for end in ends)
        return p in self.new and there and not ends & self.linked

    def places_on(self, a):
        return {place for run in self.path(a) for place, _ in self.axes(run)}

    def perpendicular(self, a, b):
        first = {min(self.path(run)) for run in self.runs()}
        both = {a, b} <= first
        return both and len(self.places_on(a) & self.places_on(b)) > 1

    boundary = perpendicular

    def place_twice(self, a):
        axes = {axis for run in self.path(a) for axis in self.axes(run)}
        return a == min(self.path(a)) and len(axes) > len({place for place, _ in axes})

    def triangle(self, a, b, c):
        first = {min(self.path(run)) for run in self.runs()}
        if not {a, b, c} <= first:
            return False
        on = [self.places_on(run) for run in (a, b, c)]
        meet = on[0] & on[1] and on[1] & on[2] and on[0] & on[2]
        return bool(meet) and not (self.slots >= 6 and on[0] & on[1] & on[2])


def assignments(experience):
    """All dstates by step that are named by first visits; where bearings are not exact, the
    gateways are those of the first visit."""

    def gateways(place):
        return sorted(experience.views[place]) if experience.tolerance else range(experience.slots)

    ats = [((0, 0),)]
    for step in range(1, experience.steps + 1):
        ats = [
            (*at, dstate)
            for at in ats
            for dstate in [
                (step, 0),
                *((p, s) for p, q in enumerate(at) if p == q[0] for s in gateways(p)),
            ]
        ]
    return ats


def reasons(experience):
    """All that the rules of every map can name."""
    steps = range(experience.steps + 1)
    for t in steps:
        yield f"marker({t})"
        yield from [f"itself({t})"] * bool(t)
        for u in steps[t + 1 :]:
            yield from (f"view({u},{t})", f"twice({t},{u})")
            yield from (f"same({t},{u})", f"apart({t},{u})")
            yield from [f"compass({t},{u})"] * bool(experience.compass)
            yield from [f"odometry({t},{u})"] * bool(experience.shifts)
            if t:
                yield from (f"schema({t},{u})", f"unification({t},{u})")
                yield from [f"length({t},{u})"] * bool(experience.lengths)
    runs = Assignment(experience, tuple((t, 0) for t in steps)).runs()
    yield from (f"circular({a})" for a in runs)
    yield from (f"crossed({a},{b})" for a in runs for b in runs if a < b)
