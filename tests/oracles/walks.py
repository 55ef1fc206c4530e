"""All further walks through maps, by definition: what the plans of topomap explore, and the
encodings for them, are compared with. It shares nothing with either."""

from dataclasses import replace
from itertools import combinations, product

from conftest import Truth
from topomap.questions.standings import Standing

from oracles.worlds import bent as bent_walk
from oracles.worlds import random_experience, random_world


def standing(experience, at, marker=None):
    north = {}
    if experience.compass and None not in experience.compass:
        north = {place: experience.compass[place] for place, _ in at}
    world = experience.map_of(at)
    signs = dict(world.landmarks)
    for kind, step, name in experience.things:
        taken = {other for mark, other, one in experience.things if (mark, one) == ("pick", name)}
        if kind == "drop" and not any(other > step for other in taken):
            place = at[step][0]
            signs[place] = signs.get(place, frozenset()) | {f"marker({name})"}
    return Standing(replace(world, landmarks=signs), at[-1], marker, north)


def drawn(draw, most=4, steps=8):
    """Some hypotheses of a random experience, as the slow search has them."""
    while True:
        experience = random_experience(draw, steps)
        if experience.steps:
            found = sorted(Truth(experience).final)
            return experience, draw.sample(found, min(len(found), draw.randint(1, most)))


def drawn_bent(draw, most, steps):
    """Some hypotheses, with or without the path axiom, of an experience with exact bearings where
    pairs of gateways are given, and matter; or a compass is."""
    while True:
        experience = bent_walk(draw, steps)
        if experience.tolerance or not (experience.straight or experience.compass):
            continue
        found = sorted(Truth(experience, axiom=False).final)
        found = draw.sample(found, min(len(found), most))
        among = [standing(experience, at) for at in found]
        bare = [replace(one, world=replace(one.world, across=None), compass={}) for one in among]
        if any(
            related(among[i], among[j], False) != related(bare[i], bare[j], False)
            for i, j in combinations(range(len(among)), 2)
        ):
            return experience, found


def bent(draw, among):
    """The same maps, where pairs of gateways are given: at each place the same ones in all of them,
    with a few exceptions."""
    pairs = {}

    def drawn_pairs(place, star):
        star = draw.sample(sorted(star), len(star))
        half = len(star) // 2
        both = [*zip(star[:half], star[half : 2 * half], strict=True)]
        return {
            (place, one): (place, other)
            for pair in draw.sample(both, draw.randint(0, half))
            for one, other in (pair, pair[::-1])
        }

    found = []
    for one in among:
        across = {}
        for place, star in sorted(one.world.stars.items()):
            again = place not in pairs or draw.random() < 0.2
            mine = drawn_pairs(place, star) if again else pairs[place]
            across |= pairs.setdefault(place, mine) if draw.random() < 0.8 else mine
        found.append(replace(one, world=replace(one.world, across=across)))
    # What is seen now is the same in all of them.
    return [one for one in found if sight(one, (one.dstate, None)) == first_sight(found)]


def first_sight(among):
    return sight(among[0], (among[0].dstate, None))


def scattered(draw, most=4, rate=0.9):
    """One random world, with other links missing each time (or none), and the agent at dstates
    that look the same."""
    while True:
        made = random_world(draw)
        looks = {}
        for place, slot in made.gateways():
            look = made.view((place, slot)), made.landmarks.get(place, frozenset())
            looks.setdefault(look, []).append((place, slot))
        if sum(map(len, made.stars.values())) > 24:
            continue
        ends = draw.choice(sorted(looks.values()))
        among = []
        for _ in range(draw.randint(2, most)):
            kept = [edge for edge in made.edges() if draw.random() < draw.choice([1, 1, rate])]
            links = dict(kept) | {b: a for a, b in kept}
            among.append(Standing(replace(made, links=links), draw.choice(ends)))
        if draw.random() < 0.2:
            among = [turned(draw, one) for one in among]
        return made, among


def turned(draw, one):
    """The same with a compass, which points to slot 0 where the agent stands, and anywhere else at
    other places."""
    place, slot = one.dstate
    north = {
        other: draw.choice([0, 0, draw.randrange(one.world.slots)]) for other in one.world.stars
    }
    return replace(one, compass=north | {place: -slot % one.world.slots})


def asked(draw, number, most):
    """Hypotheses of one experience, or any maps."""
    if number % 3:
        made, among = scattered(draw, most)
    else:
        made, found = drawn(draw, most)
        among = [standing(made, at) for at in found]
    return made.slots, among


# All walks, by definition: what is known is where the agent is in each map (None: the map does
# not say), where the marker lies, and which pairs of maps were distinguished.


def sight(one, here):
    (place, slot), lies = here
    world = one.world
    star = tuple(sorted((s - slot) % world.slots for s in world.stars[place]))
    north = (slot + one.compass[place]) % world.slots if place in one.compass else None
    pairs = {
        ((s - slot) % world.slots, (r - slot) % world.slots)
        for (at, s), (_, r) in (world.across or {}).items()
        if at == place
    }
    signs = tuple(sorted(world.landmarks.get(place, ())))
    return star, signs, lies == place, north, tuple(sorted(pairs))


def gone(one, here, turn):
    """Where a turn leads: to a dstate; to None, if through a pending gateway; to the end."""
    (place, slot), lies = here
    way = place, (slot + turn) % one.world.slots
    if way[1] not in one.world.stars[place]:
        return "end"
    return (one.world.links[way], lies) if way in one.world.links else None


def told(among, heres, before):
    sights = [
        None if here is None else sight(one, here) for one, here in zip(among, heres, strict=False)
    ]
    return before | {
        (i, j)
        for i, j in combinations(range(len(among)), 2)
        if sights[i] and sights[j] and sights[i] != sights[j]
    }


def worst(among, pairs):
    numbers = range(len(among))
    return max(sum((min(i, j), max(i, j)) not in pairs for j in numbers) for i in numbers)


def walks(among, carried):
    """Each state that walks lead to, first by the shortest walk, and of these by the one of
    least turns: the walk, the pairs that it distinguishes, and the maps that it left."""
    heres = tuple((one.dstate, one.marker) for one in among)
    start = heres, carried, frozenset(), frozenset()
    level, known = {start: ()}, {start}
    while level:
        following = {}
        for (heres, carries, pairs, out), walk in level.items():
            yield walk, pairs, out
            turns = {t for one, h in zip(among, heres, strict=False) if h for t in sight(one, h)[0]}
            for drops in (False, True) if carries else (False,):
                for turn in sorted(turns):
                    ends, off = [], set(out)
                    for number, (one, here) in enumerate(zip(among, heres, strict=False)):
                        if here is None:
                            ends.append(None)
                            continue
                        lies = here[0][0] if drops else here[1]
                        end = gone(one, (here[0], lies), turn)
                        if end is None:
                            off.add(number)
                        ends.append(None if end in (None, "end") else end)
                    ends = tuple(ends)
                    more = told(among, ends, pairs)
                    state = ends, carries and not drops, frozenset(more), frozenset(off)
                    if state not in known:
                        known.add(state)
                        following[state] = (*walk, (drops, turn))
        level = following


def best(among, carried=False):
    """The least worst case of all walks, and the shortest one of these; the most maps that a
    walk leads out of, and the shortest one of those."""
    every = [(walk, worst(among, pairs), len(out)) for walk, pairs, out in walks(among, carried)]
    return (
        min((left, len(walk)) for walk, left, _ in every),
        next(w for w, left, _ in every if left == min(e[1] for e in every)),
        max((out, -len(walk)) for walk, _, out in every),
        next(w for w, _, out in every if out == max(e[2] for e in every)),
    )


def alike(one, other):
    """The least relation with the current pair that goes on with each turn; None if two of its
    dstates look different."""
    waiting = [((one.dstate, one.marker), (other.dstate, other.marker))]
    for here, there in waiting:
        if sight(one, here) != sight(other, there):
            return None
        for turn in sight(one, here)[0]:
            pair = gone(one, here, turn), gone(other, there, turn)
            if None not in pair and pair not in waiting:
                waiting.append(pair)
    return waiting


def same(one, other):
    """Whether the maps are one up to names, with the agent at one dstate, as far as it can
    go; they are closed."""
    slots = one.world.slots
    places = {
        (here[0][0], there[0][0], (there[0][1] - here[0][1]) % slots)
        for here, there in alike(one, other) or ()
    }
    return 0 < len(places) == len({p for p, *_ in places}) == len({q for _, q, _ in places})


def every(among, n, carried=False):
    """Every walk of at most n steps, as turns and the step after which the marker is dropped,
    with the pairs of maps that it tells apart and the maps that it leads out of."""
    turns = sorted({t for one in among for d in one.world.gateways() for t in one.world.view(d)})
    for length in range(n + 1):
        drops = [None, *range(length)] if carried else [None]
        for walk in product(turns, repeat=length):
            for drop in drops:
                end = gone_by(among, walk, drop)
                if end is not None:
                    yield walk, drop, *end


def gone_by(among, walk, drop):
    """What a walk tells apart and leads out of; None if no map knows where it is before its
    last step, or has such a gateway."""
    heres = [(one.dstate, one.marker) for one in among]
    pairs, out = frozenset(), set()
    for step, turn in enumerate(walk):
        if drop == step:
            heres = [h and (h[0], h[0][0]) for h in heres]
        ends = [h and gone(one, h, turn) for one, h in zip(among, heres, strict=True)]
        if all(h is None or end == "end" for h, end in zip(heres, ends, strict=True)):
            return None
        out |= {n for n, h in enumerate(heres) if h and ends[n] is None}
        heres = [None if end == "end" else end for end in ends]
        pairs = told(among, heres, pairs)
    return pairs, out


def related(one, other, carried):
    """What is related by walks, as (dstate, dstate, places of the marker), and whether all of it
    looks the same."""
    waiting = [((one.dstate, one.marker), (other.dstate, other.marker), carried)]
    for here, there, carries in waiting:
        following = [(here, there, carries)]
        if carries:
            following.append(((here[0], here[0][0]), (there[0], there[0][0]), False))
        for turn in sight(one, here)[0]:
            if turn in sight(other, there)[0]:
                following.append((gone(one, here, turn), gone(other, there, turn), carries))
        waiting += [new for new in following if None not in new and new not in waiting]
    alike = all(sight(one, here) == sight(other, there) for here, there, _ in waiting)
    return {(here[0], there[0], (here[1], there[1])) for here, there, _ in waiting}, alike
