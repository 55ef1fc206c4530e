"""Maps in numbers, and their texts, against the maps of the definition."""

import json
import random
from itertools import islice

import pytest
from conftest import TRIED
from oracles.worlds import WORLDS, random_experience
from topomap.documents.answers import Texts, map_json
from topomap.model.compact import CompactMap, Numbering
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.search import traversal


def experiences():
    yield from WORLDS.values()
    for number in range(60):
        yield random_experience(random.Random(f"compact {number}"), 9, marker=number % 3 == 0)


@pytest.mark.parametrize("parts", [(), ("no_path_axiom",)])
def test_a_map_in_numbers_is_the_map(parts):
    some = set()
    for experience in experiences():
        numbering, texts = Numbering(experience, not parts), Texts(experience, not parts)
        slots = experience.slots
        for found in islice(
            traversal.hypotheses(experience, Query(frozenset(parts)), Watch()), 300
        ):
            world, one = experience.map_of(found.at), CompactMap(numbering, found.at)
            size = (
                len(world.stars),
                len(world.links) // 2,
                len(world.paths()),
                world.genus(),
                len(world.pending()),
            )
            assert size == (
                len(one.places),
                len(one.link) // 2,
                one.number_of_paths(),
                one.genus(),
                one.number_of_pending(),
            )
            for mine, theirs in (one.paths(), world.paths()), (one.faces(), world.faces()):
                assert [[divmod(g, slots) for g in each] for each in mine] == theirs
            assert texts.document(found.at) == json.dumps(map_json(world, found.at))
            line = texts.line(Found(found.at, ""))
            way = " ".join(f"{place}.{slot}" for place, slot in found.at)
            words = "places {}, links {}, paths {}, genus {}, pending {}: ".format(*size)
            assert line == words + way
            some.add(size)
            TRIED["maps in numbers that break the path axiom"] += bool(world.path_axiom_fault())
    assert len(some) > 40
    assert len({genus for *_, genus, _ in some}) > 1
