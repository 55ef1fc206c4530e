"""Maps: paths, faces, genus and sameness, against the independent search and networkx."""

import random
from dataclasses import replace

import networkx as nx
import pytest
from conftest import Truth
from oracles.worlds import random_experience, random_world
from topomap.model.topology import TopologicalMap
from topomap.worlds.environment import grid, lattice, world


@pytest.mark.parametrize("seed", range(60))
def test_maps_agree_with_the_search(seed):
    experience = random_experience(random.Random(f"maps {seed}"), 8)
    for at, hypothesis in Truth(experience).final.items():
        found = experience.map_of(at)
        assert found.links == hypothesis.link
        assert found.pending() == hypothesis.pending()
        assert found.genus() == hypothesis.genus()
        assert sorted(map(len, found.faces())) == sorted(map(len, hypothesis.faces()))
        assert sorted(map(len, found.paths())) == sorted(map(len, hypothesis.paths()))
        assert found.path_axiom_fault() is None
        on = [{place for place, _ in path} for path in found.paths()]
        theirs = [{place for place, _ in path} for path in hypothesis.paths()]
        assert sorted(map(sorted, on)) == sorted(map(sorted, theirs))


def embedded(map):
    """The map as networkx's embedding, each link cut in three so that none is parallel."""
    embedding = nx.PlanarEmbedding()

    def joint(gateway):
        return ("joint", gateway)

    for place, star in map.stars.items():
        linked = [slot for slot in sorted(star) if (place, slot) in map.links]
        for before, slot in zip([None, *linked], linked, strict=False):
            reference = joint((place, before)) if before is not None else None
            embedding.add_half_edge(place, joint((place, slot)), ccw=reference)
    for gateway, other in map.links.items():
        embedding.add_half_edge(joint(gateway), gateway[0])
        embedding.add_half_edge(joint(gateway), joint(other), ccw=gateway[0])
    return embedding


def is_planar(map):
    try:
        embedded(map).check_structure()
    except nx.NetworkXException:
        return False
    return True


def test_genus_zero_is_what_networkx_finds_planar():
    seen = set()
    for seed in range(40):
        experience = random_experience(random.Random(f"planar {seed}"), 8)
        for at in Truth(experience).final:
            found = experience.map_of(at)
            if found.links:
                seen.add(found.genus() == 0)
                assert is_planar(found) == (found.genus() == 0)
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("map", "genus", "paths", "fault"),
    [
        (grid(3, 4).map, 0, 7, None),
        (grid(3, 4, "cylinder").map, 0, 7, "circular"),
        (grid(3, 3, "torus").map, 1, 6, "circular"),
        (grid(4, 4).map, 0, 8, None),
        (lattice("hexagons", 2, 2).map, 0, 19, None),
        (grid(1, 1, "torus").map, 1, 2, "twice|circular"),
    ],
)
def test_worlds_are_as_expected(map, genus, paths, fault):
    assert (map.genus(), len(map.paths())) == (genus, paths)
    if fault is None:
        assert map.path_axiom_fault() is None
    else:
        assert any(word in map.path_axiom_fault() for word in fault.split("|"))


def test_triangles_have_three_families_of_paths():
    map = lattice("triangles", 3, 4).map
    assert (map.genus(), map.path_axiom_fault()) == (0, None)
    directions = [{slot % 3 for _, slot in path} for path in map.paths()]
    assert set.union(*directions) == {0, 1, 2}
    assert all(len(family) == 1 for family in directions)


def test_paths_are_in_order():
    assert grid(1, 3).map.paths()[0] == [((0, 0), 1), ((0, 1), 1), ((0, 2), 1)]
    (ring,) = [path for path in grid(1, 3, "cylinder").map.paths() if len(path) > 1]
    assert sorted(place for place, _ in ring) == [(0, 0), (0, 1), (0, 2)]


@pytest.mark.parametrize("seed", range(20))
def test_isomorphic_maps(seed):
    draw = random.Random(f"same {seed}")
    first = random_world(draw)
    component = nx.node_connected_component(
        nx.Graph((a[0], b[0]) for a, b in first.links.items()), next(iter(first.stars))
    )
    links = {a: b for a, b in first.links.items() if a[0] in component}
    first = replace(world(first.slots, links), landmarks=first.landmarks)
    turn = {place: draw.randrange(first.slots) for place in first.stars}
    name = dict(zip(first.stars, draw.sample(range(100), len(first.stars)), strict=True))

    def moved(gateway):
        place, slot = gateway
        return name[place], (slot + turn[place]) % first.slots

    second = TopologicalMap(
        first.slots,
        {name[p]: frozenset(moved((p, s))[1] for s in star) for p, star in first.stars.items()},
        {moved(a): moved(b) for a, b in first.links.items()},
        {name[p]: first.landmarks.get(p, frozenset()) for p in first.stars},
    )
    assert first.isomorphic(second)
    assert second.isomorphic(first)
    place = next(iter(second.stars))
    assert not first.isomorphic(replace(second, landmarks={place: frozenset(["z"])}))
    a, b = next(iter(second.links.items()))
    less = {g: h for g, h in second.links.items() if g not in (a, b)}
    assert not first.isomorphic(replace(second, links=less))


def test_a_mirrored_map_is_another():
    spiral = {("a", 0): ("b", 0), ("b", 1): ("c", 0), ("c", 2): ("d", 0), ("c", 1): ("e", 0)}
    spiral |= {b: a for a, b in spiral.items()}
    mirrored = {(p, -s % 4): (q, -r % 4) for (p, s), (q, r) in spiral.items()}
    assert not world(4, spiral).isomorphic(world(4, mirrored))


def test_the_same_graph_drawn_otherwise_is_another():
    torus, flat = grid(2, 2, "torus").map, grid(2, 2, "cylinder").map
    assert not torus.isomorphic(flat)
    assert torus.isomorphic(grid(2, 2, "torus").map)
