"""Large closed perpendicular maps in phases: the answers are those of the plain encoding and of
the search, and what each phase finds is true of every map."""

import random
from collections import Counter
from itertools import combinations

import pytest
from conftest import TRIED
from topomap import phases, search, solver
from topomap.environment import grid, maze, world
from topomap.experience import Experience, explore
from topomap.solver import FORMS, Query, Watch
from topomap.topology import TopologicalMap
from worlds import WORLDS, random_world

QUIET = Watch(quiet=True)
SQUARE = ("closed", "perpendicular")
MORE = [
    (),
    ("planar",),
    ("planar", "boundary"),
    ("minimal",),
    ("boundary", "minimal", "planar"),
    ("genus",),
    ("euler",),
    ("planar", "travelled"),
    ("planar", "euler", "genus", "minimal"),
]


@pytest.fixture(autouse=True)
def always(monkeypatch):
    """Have short explorations done in phases too."""
    monkeypatch.setattr(phases, "LEAST", 0)
    monkeypatch.setattr(phases, "STRIDE", 3)


def crossing_streets(draw: random.Random) -> TopologicalMap:
    """Streets, some of which cross, no three each other: where two do there is a place, at
    the end of a street or in its midst. As a rule it has no plane drawing."""
    while True:
        number = draw.randint(2, 6)
        crossings: set[tuple[int, int]] = set()
        for pair in draw.sample(sorted(combinations(range(number), 2)), number * (number - 1) // 2):
            near = [{a for other in crossings if b in other for a in other} for b in pair]
            if draw.random() < 0.7 and not near[0] & near[1]:
                crossings.add(pair)
        links = {}
        turned = {place: draw.randint(0, 3) for place in crossings}
        for street in range(number):
            ahead = draw.choice([0, 2])
            places = [place for place in sorted(crossings) if street in place]
            lone = [(street, street, n) for n in range(draw.choice([0, 0, 1, 2]))]
            places = draw.sample([*places, *lone], len(places) + len(lone))
            for here, there in zip(places, places[1:], strict=False):
                side = [(turned.get(p, 0) + p.index(street)) % 4 for p in (here, there)]
                out, back = (here, (side[0] + ahead) % 4), (there, (side[1] + ahead + 2) % 4)
                links |= {out: back, back: out}
        if links:
            return world(4, links)


def square_world(draw: random.Random) -> TopologicalMap:
    """A closed world which is as a rule perpendicular: a grid with ways missing, a maze, or
    streets; or any one; with signs or without."""
    rows, columns = draw.randint(2, 3), draw.randint(2, 4)
    kind = draw.choice(["grid", "maze", "streets", "streets", "any"])
    if kind == "grid":
        kept = [edge for edge in grid(rows, columns).map.edges() if draw.random() < 0.9]
        made = world(4, dict(kept) | {b: a for a, b in kept}) if kept else grid(2, 2).map
    elif kind == "maze":
        made = maze(rows, columns, draw.choice([0, 0.3, 1]), draw.randint(0, 10**6)).map
    elif kind == "streets":
        made = crossing_streets(draw)
    else:
        made = random_world(draw)
        while made.slots != 4:
            made = random_world(draw)
    marked = [place for place in made.stars if draw.random() < draw.choice([0, 0, 0.3])]
    signs = {place: frozenset(draw.choice("ab")) for place in marked}
    return TopologicalMap(4, made.stars, made.links, signs)


def toured(draw: random.Random, most: int) -> tuple[Experience, int | None]:
    """A walk on which, as a rule, all ways of a square world are taken, most of them but
    once; and a horizon, as a rule none."""
    while True:
        made = square_world(draw)
        start = place, slot = draw.choice(sorted(made.links))
        route, taken = [], set()
        waste = draw.choice([0, 0.1, 0.3])
        while len(route) < most:
            left = [s for s in sorted(made.stars[place]) if (place, s) not in taken]
            straight = (slot + 2) % 4
            if left and draw.random() >= waste:
                slot = straight if straight in left and draw.random() < 0.7 else draw.choice(left)
            elif (way := way_to_new(made, place, taken)) is not None:
                slot = way if draw.random() >= waste else draw.choice(sorted(made.stars[place]))
            else:
                break
            route.append(slot)
            there = made.links[place, slot]
            taken |= {(place, slot), there}
            place, slot = there
        if len(route) < most:
            experience = explore(made, start, route)[0]
            cut = experience.steps + draw.randint(-3, 1)
            return experience, max(cut, 0) if draw.random() < 0.2 else None


def way_to_new(made: TopologicalMap, place, taken) -> int | None:
    """The slot by which the nearest place with a way not taken is reached."""
    first = {place: None}
    for here in (reached := [place]):
        for slot in sorted(made.stars[here]):
            if (here, slot) not in taken and first[here] is not None:
                return first[here]
            there = made.links[here, slot][0]
            if there not in first:
                first[there] = slot if first[here] is None else first[here]
                reached.append(there)
    return None


def found(way, experience, parts, form="fast", horizon=None, places=None):
    """The hypotheses of a query; of the least cost, if it minimises."""
    query = Query(frozenset(parts), places, horizon, form)
    if form == "fast":
        assert phases.serve(experience, query)
    answers = [each.at for each in way(experience, query, QUIET) if each.proved]
    assert len(answers) == len(set(answers))
    return set(answers)


def agree(experience, horizon=None, more=MORE, searched=True, places=None):
    """Demand the same answers of the phases, of the plain encoding and of the search."""
    for parts in more:
        asked = experience, (*SQUARE, *parts)
        plain = found(solver.hypotheses, *asked, "plain", horizon, places)
        TRIED["queries in phases"] += 1
        TRIED["queries in phases that had an answer"] += bool(plain)
        assert found(solver.hypotheses, *asked, "fast", horizon, places) == plain, (
            experience.facts(),
            parts,
            horizon,
            places,
        )
        if searched:
            assert found(search.hypotheses, *asked, "plain", horizon, places) == plain
    return plain
