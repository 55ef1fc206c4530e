"""Counting by merging, against listing."""

import random

import pytest
import topomap
from conftest import ROOT, TRIED, Truth
from oracles.worlds import bent, informed, logs, random_experience
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.search.merging import Merging, refusal
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance

ASKED = (), ("closed",), ("perpendicular",), ("closed", "perpendicular")


def agree(seen, truth, bound=None):
    """The numbers are those of the maps that brute force lists."""
    for parts in ASKED:
        *_, many = Merging(seen, Query(frozenset(parts), bound)).counts()
        assert many == len(truth.having(*parts, bound=bound)), (parts, bound, seen.facts())
    TRIED["experiences counted by merging"] += 1


def drawn(number):
    """A random experience that can be counted by merging."""
    draw = random.Random(f"merging {number}")
    kind = draw.choice([random_experience, random_experience, bent, informed])
    seen = kind(draw, draw.choice([7, 9, 11]))
    return None if refusal(seen, Query()) else seen


@pytest.mark.parametrize("numbers", [range(250)])
def test_random_experiences(numbers):
    maps = 0
    for number in numbers:
        if seen := drawn(number):
            truth = Truth(seen)
            if len(truth.final) < 3000:
                agree(seen, truth, bound=number % 3 + 3 if number % 2 else None)
                maps += len(truth.final)
    assert maps > 2 * len(numbers), maps


@pytest.mark.long
@pytest.mark.parametrize("block", range(16))
def test_ten_thousand_random_experiences(block):
    """Of sixteen thousand that are drawn, some ten thousand can be counted, and listed soon."""
    test_random_experiences(range(1000 * (block + 1), 1000 * (block + 2)))


@pytest.mark.slow
def test_what_no_listing_ends():
    """The snake of the 4 x 5 grid: all its maps were counted by another program, too."""
    counts = topomap.count(instance(grid(4, 5), "snake").experience, merging=True)
    assert (counts["final"], counts["closed_text"], counts["perpendicular"]) == (
        *(2_415_342_109, 1_704_960, 18_432),
    )
    assert counts["nodes"] is None
    assert counts["per_step"] == []


def test_what_cannot_be_merged_is_refused():
    seen = topomap.read(ROOT / "instances/grid-3x3-snake.lp")
    with pytest.raises(InputError, match=r"by merging: planar \(only closed, perpendicular"):
        topomap.count(seen, merging=True, planar=True)
    for number in range(40):
        told = logs(random.Random(f"unmerged {number}"), 5)
        if why := refusal(told, Query()):
            with pytest.raises(InputError, match=f"cannot be counted by merging: {why}"):
                topomap.count(told, merging=True)
