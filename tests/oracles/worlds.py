"""Worlds and explorations of them, for comparing ways to the same answer: named ones, each of
something that is easily got wrong, and random ones."""

import random
from dataclasses import replace
from itertools import pairwise

from topomap.model.experience import MARKER, Experience, Step, observe
from topomap.model.topology import TopologicalMap
from topomap.worlds.environment import grid, world


def random_world(draw: random.Random) -> TopologicalMap:
    """Any number of slots, one to six gateways a place, dead ends, parallel links, loops;
    or a small grid, cylinder or torus with ways missing; with landmarks or without."""
    made = _random_links(draw) if draw.random() < 0.5 else _thinned_grid(draw)
    rate = draw.choice([0, 0, 0.3])
    marked = [place for place in made.stars if draw.random() < rate]
    landmarks = {place: frozenset(draw.choice("ab")) for place in marked}
    return TopologicalMap(made.slots, made.stars, made.links, landmarks)


def _random_links(draw: random.Random) -> TopologicalMap:
    slots = draw.choice([2, 4, 4, 4, 6, 6, 8, 12])
    gateways = [
        (place, slot)
        for place in range(draw.randint(2, 6))
        for slot in draw.sample(range(slots), draw.randint(1, min(slots, 6)))
    ]
    draw.shuffle(gateways)
    pairs = list(zip(gateways[::2], gateways[1::2], strict=False))
    return world(slots, dict(pairs) | {b: a for a, b in pairs})


def _thinned_grid(draw: random.Random) -> TopologicalMap:
    while True:
        kind = draw.choice(["grid", "grid", "cylinder", "torus"])
        whole = grid(draw.randint(1, 3), draw.randint(2, 4), kind).map
        kept = [edge for edge in whole.edges() if draw.random() < 0.9]
        if kept:
            return world(4, dict(kept) | {b: a for a, b in kept})


def random_experience(draw: random.Random, steps: int, marker: bool = False) -> Experience:
    """A walk of up to ``steps`` steps through a random world, with a liking for going
    straight on, from any gateway of any place; the same walk with a marker put down and taken
    up here and there."""
    made = random_world(draw)
    start = draw.choice(sorted(made.links))
    route, _ = wandering(draw, made, start, steps)
    return observe(made, start, route, *(with_marker(route) if marker else ()))[0]


def wandering(draw, made, start, steps):
    """A random route of up to so many steps, and the dstates on it."""
    place, slot = start
    route, dstates = [], [start]
    for _ in range(draw.randint(0, steps)):
        ahead = (slot + made.slots // 2) % made.slots
        if ahead not in made.stars[place] or draw.random() < 0.5:
            ahead = draw.choice(sorted(made.stars[place]))
        route.append(ahead)
        place, slot = made.links[place, ahead]
        dstates.append((place, slot))
    return route, dstates


def informed(draw: random.Random, steps: int) -> Experience:
    """A walk with more known than views: some of compass, odometry, lengths, and visits of
    one place or of two, of some steps or of all, most of it true."""
    made = random_world(draw)
    start = draw.choice(sorted(made.links))
    where = {p: (draw.randint(-3, 3), draw.randint(-3, 3)) for p in sorted(made.stars)}
    long = {}  # of each link
    route, dstates = wandering(draw, made, start, steps)
    seen, _ = observe(made, start, route)
    kinds = {kind for kind in ("compass", "shift", "length", "pairs") if draw.random() < 0.5}
    rate = draw.choice([1, 1, 0.8, 0.5])
    wrong = draw.choice([0, 0, 0.05])

    def told(value, other):
        if draw.random() >= rate:
            return None
        return other if draw.random() < wrong else value

    compass, shifts, lengths = [], [], []
    for step, (place, slot) in enumerate(dstates):
        compass.append(told(slot, draw.randrange(made.slots)))
        if step:
            before = dstates[step - 1][0]
            moved = [there - here for here, there in zip(where[before], where[place], strict=True)]
            way = 10 * sum(map(abs, moved))
            x, y = (10 * one + draw.randint(-way // 20, way // 20) for one in moved)
            shifts.append(told((x, y), (draw.randint(-30, 30), draw.randint(-30, 30))))
            out = before, route[step - 1]
            link = min(out, (place, slot))
            lengths.append(told(long.setdefault(link, draw.randint(1, 40)), draw.randint(1, 40)))
    pairs = {"same": [], "apart": []}
    for _ in range(draw.randint(0, 3)):
        t, u = draw.randrange(len(dstates)), draw.randrange(len(dstates))
        true = (dstates[t][0] == dstates[u][0]) != (draw.random() < wrong)
        if t != u or true:
            pairs["same" if true else "apart"].append((t, u))
    return Experience(
        *(seen.slots, seen.views, seen.turns, seen.landmarks),
        compass=compass if "compass" in kinds else (),
        shifts=shifts if "shift" in kinds else (),
        lengths=lengths if "length" in kinds else (),
        **(pairs if "pairs" in kinds else {}),
        drift=draw.choice([0, 5, 10, 30]),
        stretch=draw.choice([0, 10, 50]),
    )


def bent(draw: random.Random, steps: int) -> Experience:
    """A walk through a world where the gateways of one path need not be opposite ones, where
    bearings are now and then a slot or two off, or both; sometimes with a compass."""
    made = random_world(draw)
    start = draw.choice(sorted(made.links))
    route, dstates = wandering(draw, made, start, steps)
    pairs = {}
    for place in sorted(made.stars):
        star = sorted(made.stars[place])
        draw.shuffle(star)
        half = len(star) // 2
        both = [*zip(star[:half], star[half : 2 * half], strict=True)]
        pairs[place] = draw.sample(both, draw.randint(0, half))
    error = draw.choice([0, 1, 1, 2])
    views, turns, told, compass = [], [], [], []
    for step, (place, slot) in enumerate(dstates):
        true = sorted((other - slot) % made.slots for other in made.stars[place])
        seen = [0, *(one + draw.randint(-error, error) for one in true[1:])]
        if sorted({*seen}) != seen or seen[-1] >= made.slots:
            seen = true
        named = dict(zip(true, seen, strict=True))
        views.append(seen)
        told.append([[named[(one - slot) % made.slots] for one in pair] for pair in pairs[place]])
        if step < len(route):
            turns.append(named[(route[step] - slot) % made.slots])
        compass.append((slot + draw.randint(-error, error)) % made.slots)
    return Experience(
        *(made.slots, views, turns, [made.landmarks.get(place, ()) for place, _ in dstates]),
        straight=told if draw.random() < 0.6 else (),
        compass=compass if draw.random() < 0.3 else (),
        tolerance=draw.choice([0, 1, 1, 2, 5]) if error else draw.choice([0, 0, 0, 1]),
    )


def wavering(draw: random.Random) -> Experience:
    """A junction that is left by some of its gateways, for dead ends, and seen again from each of
    these: every bearing is as far off as it may be to one side, or to the other, or exact."""
    slots, off = draw.choice([(24, 1), (36, 2), (60, 3)])
    ways = draw.randint(3, 4)
    star = [way * slots // ways + draw.randint(-2, 2) for way in range(ways)]
    seen_from = {way: (star[way] - star[0]) % slots for way in range(ways)}
    views, turns = [[*seen_from.values()]], []
    for _ in range(draw.choice([2, 2, 3])):
        at = draw.randrange(ways)
        turns += [seen_from[at], 0]
        wrong = [draw.choice([-off, 0, off]) for _ in star]
        seen_from = {way: (star[way] - star[at] + wrong[way]) % slots for way in range(ways)}
        seen_from[at] = 0
        views += [[0], [*seen_from.values()]]
    told = draw.choice([(), [[] for _ in views]])  # that no two are opposite need not be seen
    return Experience(slots, views, turns, tolerance=off, straight=told)


def logs(draw: random.Random, steps: int) -> Experience:
    """Several logs of one world, with second looks, markers with names, and now and then a compass,
    odometry and lengths."""
    made = random_world(draw)
    gateways = sorted(made.links)
    where = {p: (draw.randint(-3, 3), draw.randint(-3, 3)) for p in sorted(made.stars)}
    here = draw.choice(gateways)
    turns, dstates, starts, looks = [], [here], [], []
    for step in range(1, draw.randint(0, steps) + 1):
        place, slot = here
        kind = draw.random()
        if kind < 0.15:
            here = draw.choice(gateways)
            starts.append(step)
        elif kind < 0.25:
            looks.append(step)
        else:
            ahead = (slot + made.slots // 2) % made.slots
            if ahead not in made.stars[place] or draw.random() < 0.5:
                ahead = draw.choice(sorted(made.stars[place]))
            turns.append((ahead - slot) % made.slots)
            here = made.links[place, ahead]
        dstates.append(here)
        turns += [None] * (kind < 0.25)
    wished = {
        (kind, step, name)
        for step in range(len(dstates))
        for name in ("coin", "rope")
        for kind in ("drop", "pick")
        if draw.random() < 0.3
    }
    things = _sound(wished, dstates)
    travels = [turn is not None for turn in turns]
    moved = [
        tuple(10 * (b - a) for a, b in zip(where[one[0]], where[other[0]], strict=True))
        for one, other in pairwise(dstates)
    ]
    shifts = [
        shift if draw.random() < 0.9 and (travels[step] or draw.random() < 0.5) else None
        for step, shift in enumerate(moved)
    ]
    return Experience(
        made.slots,
        [made.view(dstate) for dstate in dstates],
        turns,
        [made.landmarks.get(place, frozenset()) for place, _ in dstates],
        starts=starts,
        looks=looks,
        things=things,
        compass=[slot for _, slot in dstates] if draw.random() < 0.2 else (),
        shifts=shifts if draw.random() < 0.3 else (),
        lengths=[10 + step % 2 if there else None for step, there in enumerate(travels)]
        if draw.random() < 0.2
        else (),
    )


def _sound(wished: set, dstates: list) -> set:
    """What is done with markers, of what is wished: each is put down when it is in hand, and seen,
    or taken up, where it lies."""
    found, lies = set(), {}
    for step, (place, _) in enumerate(dstates):
        for name in sorted({name for _, _, name in wished}):
            kinds = {kind for kind, at, other in wished if (at, other) == (step, name)}
            if lies.get(name) == place:
                taken = "pick" in kinds
                found.add(("pick" if taken else "marker", step, name))
                lies[name] = None if taken else place
            if "drop" in kinds and lies.get(name) is None:
                found.add(("drop", step, name))
                lies[name] = place
    return found


def with_marker(route: list[int]) -> list[list[int]]:
    """Steps of a route at which the marker might be put down and taken up, at random but the same
    each time."""
    own = random.Random(f"marker {route}")
    rates = 0.4, own.choice([0, 0.5])
    return [[step for step in range(len(route) + 1) if own.random() < rate] for rate in rates]


def walked(slots: int, ways: str, start: str, route: str, signs: str = "") -> Experience:
    """A walk through the world with these ways, each two gateways ("a1 b3"), from a gateway,
    leaving by these slots; with a sign at these places (of two kinds: "a" and "b+")."""
    ends = [(text[0], int(text[1:])) for text in ways.split()]
    links = dict(zip(ends[::2], ends[1::2], strict=True))
    links |= {there: here for here, there in links.items()}
    landmarks = {text[0]: frozenset("ab"[len(text) - 1]) for text in signs.split()}
    made = replace(world(slots, links), landmarks=landmarks)
    leaving = map(int, route.split())
    return observe(made, (start[0], int(start[1:])), leaving)[0]


def of_grid(
    rows: int, columns: int, kind: str, start: tuple[int, int, int], route: str
) -> Experience:
    """A walk by compass letters through a grid, from gateway (row, column, slot)."""
    *place, slot = start
    made = grid(rows, columns, kind).map
    return observe(made, (tuple(place), slot), map("NESW".index, route))[0]


LINE = "a1 b0  b1 c0  c1 d0"
COMB = "a1 b3  b1 c3  c1 d3  b0 e2  c0 f2  d0 g2"
CORNERS = "a1 b3  b2 c0  c3 d1  d0 a2"
DOUBLE = "a1 b3  a2 b2  b1 c3  b0 c0"
STAR6 = "a0 z3  b1 z4  c2 z5  d3 z0  e4 z1  f5 z2"
WHEEL6 = STAR6 + "  a2 b5  b3 c0  c4 d1  d5 e2  e0 f3  f1 a4"
STAR8 = "a0 z4  b1 z5  c2 z6  d3 z7  e4 z0  f5 z1"
STAR12 = "a0 z6  b1 z7  c5 z11  d6 z0  e7 z1"
WORLDS = {
    # K = 2: all is one path.
    "two ways: there and back": walked(2, LINE, "a1", "1 1 1 0 0 0 1 1"),
    "two ways: from the midst": walked(2, LINE, "b1", "1 0 0 1 1 1 0"),
    "two ways: a ring": walked(2, LINE + " d1 a0", "a1", "1 1 1 1 0 0"),
    # Places on three paths and more.
    "six ways: no way straight on": walked(
        6, "a0 b3 b1 c4 c2 d5 d3 e0 e4 f1 f5 a2 a4 g1 d1 h4", "a0", "0 1 2 3 4 5 4 1 0"
    ),
    "six ways: three paths through a place": walked(6, STAR6, "a0", "0 0 3 1 4 2 5 3"),
    "six ways: a wheel": walked(6, WHEEL6, "a0", "2 3 4 1 0 5"),
    "six ways: triangles": walked(6, WHEEL6, "z0", "0 5 0 5 3 2 1"),
    "eight ways: straight and aslant": walked(8, STAR8 + " a2 b6 b3 c7", "a0", "0 0 4 5 3 2 4 2 1"),
    "eight ways: by turns": walked(8, STAR8, "a0", "0 0 4 1 5 6 2 7 3 5"),
    "eight ways: all alike": walked(
        8, "a0 b4 b0 c4 c0 a4 a1 b5 b1 c5 c1 a5 a3 b7 b3 c7 c3 a7", "a1", "0 1 3 4 7"
    ),
    "twelve ways: all alike": walked(12, "a0 b6 b0 a6 a1 b7 b1 a7 a4 b10 b4 a10", "a0", "0 1 4 7"),
    "twelve ways": walked(12, STAR12 + " a3 b9", "a3", "3 1 0 6 1 7 11 5 6 3"),
    # Dead ends and ways back.
    "dead ends of a comb": walked(4, COMB, "a1", "1 0 2 1 0 2 1 0 2 3 3 3"),
    "to and fro": walked(4, COMB, "b1", "1 3 1 3 1 1 3 1 0 2 3"),
    "one way and back": walked(4, "a0 b2", "a0", "0 2 0 2 0"),
    # Parallel links, and links of a place to itself.
    "parallel links": walked(4, DOUBLE, "a1", "1 2 1 1 0 2 1 2"),
    "parallel links that cross paths": walked(4, "a1 b3 a2 b1 a0 b0", "a1", "1 1 0 0 1 3 2"),
    "a link from a place to itself": walked(4, "a0 a1 a3 b1 b3 c1", "b1", "1 0 1 3 3 1 1 0"),
    "a straight link from a place to itself": walked(4, "a0 a2 a1 b3", "b3", "3 0 0 2 1 3 0"),
    "only loops": walked(6, "a0 a3 a1 a2 a4 a5", "a0", "0 1 4 0 2"),
    # No map without a circular path is the real one.
    "torus of one place": of_grid(1, 1, "torus", (0, 0, 1), "EENNESW"),
    "torus of four places": of_grid(2, 2, "torus", (0, 0, 1), "EESSWN"),
    "torus, straight on": of_grid(1, 3, "torus", (0, 0, 0), "NEEES"),
    "cylinder": of_grid(2, 3, "cylinder", (0, 0, 1), "EEESEEE"),
    "cylinder, round and back": of_grid(2, 2, "cylinder", (0, 0, 2), "SEENWWSE"),
    # The start: its gateway is not the one left by, and is found again.
    "a start in a corner": walked(4, CORNERS, "a1", "2 1 0 3 1 2"),
    "a start at a crossing": walked(4, COMB + " e1 f3", "b0", "1 0 3 2 3 1 0"),
    "a start at a third gateway": walked(4, COMB + " e1 f3", "c3", "0 3 2 1 0"),
    "a start in the midst of a run": of_grid(2, 4, "grid", (0, 2, 2), "EWWWSEEEN"),
    # Long runs, seen again from the other side, joined from the midst, or cut.
    "along a street from both sides": of_grid(2, 4, "grid", (0, 0, 1), "EEESWWWNESEENWWW"),
    "into a street from its side": of_grid(3, 3, "grid", (0, 1, 2), "SSENNWWSEESW"),
    "a street of equal crossings": walked(
        4, "a1 b3 b1 c3 c1 d3 d1 a3 a0 a2 b0 b2 c0 c2 d0 d2", "a1", "1 1 1 3 3 0 1"
    ),
    "two runs of one street": of_grid(1, 5, "grid", (0, 2, 1), "EEWWWWEE"),
    "a street that bends back": of_grid(3, 2, "grid", (0, 0, 1), "ESWSENNW"),
    # Signs: some views differ, and some do not.
    "signs of one kind": walked(4, CORNERS, "a1", "1 2 3 0 1 2", "a c"),
    "signs of two kinds": walked(4, COMB, "a1", "1 0 2 1 0 2 1 0 2", "e f+ g"),
    "signs at a crossing": walked(8, STAR8, "a0", "0 1 5 6 2 7 3", "z a+ b"),
    # A start alone.
    "a start alone": walked(4, COMB, "b0", ""),
    "a start alone, of two ways": walked(2, LINE, "b0", ""),
    "a start alone, of twelve": walked(12, STAR12, "z0", "", "z"),
}


def marks(experience, step):
    """What was done with the marker after a step."""
    told = experience.drops, experience.picks, experience.markers
    return frozenset(name for name, steps in zip(MARKER, told, strict=True) if step in steps)


def told(experience, step):
    """The facts about a step."""
    pairs = {
        name: frozenset(one for one, other in getattr(experience, name) if other == step)
        for name in ("same", "apart")
    }
    known = {"compass": experience.compass[step] if experience.compass else None}
    if step:
        known["shift"] = experience.shifts[step - 1] if experience.shifts else None
        known["length"] = experience.lengths[step - 1] if experience.lengths else None
    turn = experience.turns[step - 1] if step else None
    known |= {"start": step in experience.starts, "look": step in experience.looks}
    known["straight"] = experience.straight[step] if experience.straight else None
    known["things"] = frozenset((kind, name) for kind, at, name in experience.things if at == step)
    seen = experience.views[step], experience.landmarks[step], marks(experience, step)
    return Step(turn, *seen, **known, **pairs)
