"""Experiences with misreadings, and what brute force says of them: all ways to correct so many
views, each judged by the independent search."""

import itertools
import random
from dataclasses import replace

from conftest import Truth
from topomap.model.experience import Experience
from topomap.model.vocabulary import OPTIMIZING

from oracles.worlds import random_experience


def corrupted(draw: random.Random, steps: int) -> Experience:
    """A random experience of few slots in which up to two views were misread."""
    seen = random_experience(draw, steps, marker=draw.random() < 0.3)
    while seen.slots > 6 or (seen.slots == 6 and seen.steps > 3):
        seen = random_experience(draw, steps, marker=draw.random() < 0.3)
    for _ in range(draw.choice([0, 1, 1, 1, 2])):
        step = draw.randint(0, seen.steps)
        here = sorted(seen.landmarks[step] | {"a"})
        kind = draw.choice(["any", "any", "stands", "leaves", "sign", "nothing"])
        if kind == "sign":
            seen = seen.corrected([(step, draw.choice(here))])
        elif kind == "nothing":
            seen = seen.corrected((step, slot) for slot in seen.views[step])
        elif kind == "any":
            seen = seen.corrected([(step, draw.randrange(seen.slots))])
        elif kind == "leaves" and step < seen.steps:
            seen = seen.corrected({(step, seen.turns[step])})
        else:
            seen = seen.corrected([(step, 0)])
    return seen


def brute(seen: Experience, most: int):
    """What the independent search says of each way to correct so many views at most, by what
    was misread."""
    signs = sorted(frozenset().union(*seen.landmarks))
    things = [*range(seen.slots), *signs]
    others = [
        change
        for number in range(1, len(things) + 1)
        for change in itertools.combinations(things, number)
    ]
    for number in range(most + 1):
        for wrong in itertools.combinations(range(seen.steps + 1), number):
            for changes in itertools.product(others, repeat=number):
                pairs = zip(wrong, changes, strict=True)
                misread = [(step, what) for step, change in pairs for what in change]
                views = [set(view) for view in seen.views]
                landmarks = [set(known) for known in seen.landmarks]
                for step, what in misread:
                    (views if isinstance(what, int) else landmarks)[step] ^= {what}
                stands = all(0 in view for view in views)
                leaves = (t for t, turn in enumerate(seen.turns) if turn is not None)
                if stands and all(seen.turns[t] in views[t] for t in leaves):
                    true = replace(
                        seen,
                        views=tuple(map(frozenset, views)),
                        landmarks=tuple(map(frozenset, landmarks)),
                    )
                    yield frozenset(misread), Truth(true)


def expected(ways, parts):
    """The hypotheses of each way with these parts, and what each costs."""
    every = {}
    for misread, truth in ways:
        for at in truth.having(*(part for part in parts if part not in OPTIMIZING)):
            h = truth.final[at]
            cost = (len({step for step, _ in misread}), len(misread))
            cost += (h.genus(),) * ("genus" in parts)
            cost += (sum(h.exceptions()),) * ("exceptions" in parts) + h.cost() * (
                "minimal" in parts
            )
            every[at, misread] = cost
    return every
