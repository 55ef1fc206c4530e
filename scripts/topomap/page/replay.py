"""The replay of an exploration, step by step.

It tells how many hypotheses there are, which of them to show, and which arrivals were refused, by
which rule. It is made by the search, and no decision in it depends on a clock.
"""

import heapq
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.model.topology import Gateway
from topomap.runtime.watch import Attempt, Watch
from topomap.search import traversal
from topomap.search.hypothesis import OFTEN, RULES, Hypothesis

MOST = 20_000  # hypotheses of a step: up to so many, all are examined
KEPT = 500  # of more hypotheses, so many are examined, the first in the order
SHOWN, BEGUN = 4, 3  # hypotheses of a step, and of these the beginnings of later ones


@dataclass
class Step:
    """What was found at a step.

    There are ``alive`` hypotheses after it; this is None if not all were examined. ``shown`` has
    some of them. If all hypotheses after the step before were examined (``judged``), ``ended``
    counts those without a child, by the rule that ended them; ``tried`` counts the arrivals, by the
    rule that refuses them, and under "" the children; ``foreseen`` is the number of hypotheses that
    determine where the step arrives.
    """

    alive: int | None = None
    shown: list[Cube] = field(default_factory=list)
    ended: Counter[str] = field(default_factory=Counter)
    tried: Counter[str] = field(default_factory=Counter)
    foreseen: int = 0
    judged: bool = False


def replay(
    experience: Experience, query: Query, best: Sequence[Cube], watch: Watch
) -> tuple[list[Step], str | None]:
    """Go through the steps of an experience from 0.

    After the last step, the ``best`` maps are shown first. After an earlier step, the beginnings of
    the hypotheses that are shown after the next step come first. Then come those with the fewest
    paths, then the fewest places, then in the order of the dstates. After a step with more than
    ``MOST`` hypotheses, only the descendants of the first ``KEPT`` in that order are examined.

    Returns:
        The steps, and why the last ones were not examined, or None.
    """
    node = traversal.root(experience, query)
    steps = [Step() for _ in range(node.experience.steps + 1)]
    first: list[list[Cube]] = [[] for _ in steps]
    with Attempt() as attempt:
        _walk(node, steps, first, watch)
    later: Iterable[Cube] = best
    for step in range(len(steps) - 1, -1, -1):
        begun = list(dict.fromkeys(at[: step + 1] for at in later))[:BEGUN]
        steps[step].shown = later = list(dict.fromkeys([*begun, *first[step]]))[:SHOWN]
    return steps, attempt.fault


def _walk(node: Hypothesis, steps: list[Step], first: list[list[Cube]], watch: Watch) -> None:
    level, whole = [node.dstates], True
    for number, step in enumerate(steps):
        watch.title(f"replay of step {number} of {len(steps) - 1}")
        ordered: list[tuple[tuple[int, int], Cube]] = []
        children: list[Cube] = []
        after = steps[number + 1] if number + 1 < len(steps) else None
        found = Step()
        for count, at in enumerate(level):
            if count % OFTEN == 0:
                watch.tick()
            node.goto(at)
            ordered.append((node.cost, at))
            if after and len(level) <= MOST:
                _go_on(node, children, found)
        ordered = heapq.nsmallest(KEPT if len(level) > MOST else SHOWN, ordered)
        first[number] = [at for _, at in ordered[:SHOWN]]
        step.alive = len(level) if whole else None
        if after and len(level) > MOST:
            whole = False
            for _, at in ordered:
                node.goto(at)
                _go_on(node, children, found)
        elif after and whole:
            after.ended, after.tried, after.foreseen = found.ended, found.tried, found.foreseen
            after.judged = True
        level = children


def _go_on(node: Hypothesis, children: list[Cube], after: Step) -> None:
    """Find the children of a node, and what is refused there."""
    tried = list(node.tried())
    at = node.dstates
    children += [(*at, divmod(arrival, node.slots)) for arrival, rule in tried if rule is None]
    after.tried.update(rule or "" for _, rule in tried)
    after.foreseen += len(tried) == 1 and not node.rests and node.out() in node.links
    if all(rule for _, rule in tried):  # the last one is the end of a link, or a new place
        after.ended[tried[-1][1] or ""] += 1


def in_force(query: Query, experience: Experience) -> list[str]:
    """List the rules that can refuse something here, in the order in which they are tried."""
    never = {
        "planarity": "planar" not in query.parts,
        "perpendicular": "perpendicular" not in query.parts,
        "bound": query.places is None,
        "landmark": not any(experience.landmarks),
        "marker": not experience.drops,
        "compass": not experience.compass,
        "odometry": not experience.shifts,
        "length": not experience.lengths,
        "same": not experience.same,
        "apart": not experience.apart,
    }
    return [rule for rule in RULES if not never.get(rule)]


def fate(
    experience: Experience, query: Query, at: Cube
) -> tuple[int, str, dict[str, list[Gateway]]]:
    """Find out what becomes of a hypothesis.

    Returns:
        How many children it has; if it has none, the rule that ended it; and the arrivals that are
        refused, by rule. An arrival at a new place is at gateway 0 of the place that has the number
        of its step.
    """
    node = traversal.root(experience, query)
    node.goto(at)
    if node.steps == node.experience.steps:
        return 0, "", {}
    tried = list(node.tried())
    refused: dict[str, list[Gateway]] = {}
    for rule in RULES:
        found = sorted(divmod(arrival, node.slots) for arrival, why in tried if why == rule)
        refused |= {rule: [*found]} if found else {}
    return sum(rule is None for _, rule in tried), tried[-1][1] or "", refused
