"""An exploration again, step by step: how many hypotheses there are, which of them to show,
and what was refused, by which rule. By the search, with no clock in what it decides."""

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

MOST = 20_000  # hypotheses of a step that are all looked at
KEPT = 500  # of more of them: these, the first by the order
SHOWN, BEGUN = 4, 3  # hypotheses of a step; those of them that later ones begin with, at most


@dataclass
class Step:
    """What was found at a step.

    ``alive`` hypotheses after it, None if not all were looked at; ``shown`` some of them.
    If all of those after the step before were looked at (``judged``), ``ended`` are those left
    with no child, by rule; ``tried`` the arrivals, by the rule that refuses them, "" for the
    children; ``foreseen`` is how many hypotheses said where the step arrives.
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
    """The steps of an experience from 0, and why the last ones were not looked at, if so.

    Shown after the last step are first the ``best`` maps, and after another one what those
    shown after the next step begin with; then those of fewest paths, then places, then by the
    dstates. After a step with more than ``MOST`` hypotheses only the descendants of the first
    ``KEPT`` of that order are looked at.
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
    """The children of a node, and what is refused there."""
    tried = list(node.tried())
    at = node.dstates
    children += [(*at, divmod(arrival, node.slots)) for arrival, rule in tried if rule is None]
    after.tried.update(rule or "" for _, rule in tried)
    after.foreseen += len(tried) == 1 and not node.rests and node.out() in node.links
    if all(rule for _, rule in tried):  # the last one is the link's end, or a new place
        after.ended[tried[-1][1] or ""] += 1


def in_force(query: Query, experience: Experience) -> list[str]:
    """The rules that can refuse something here, in the order in which they are tried."""
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
    """How many children a hypothesis has, and if none, the rule that ended it; and the arrivals
    that are refused, by rule. That at a new place is at gateway 0 of the place named by its
    step."""
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
