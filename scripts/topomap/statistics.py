"""The figures of the search tree (the paper, Figure 4), by clingo and by search."""

import signal
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from multiprocessing import TimeoutError, get_context
from typing import Any

from topomap.experience import Experience
from topomap.hypothesis import Hypothesis
from topomap.journal import Journal
from topomap.search import breadth_first, cubes, depth_first, root
from topomap.solver import Cube, Query, Watch, count, demand_level

KEYS = ("nodes", "maps", "final", "closed", "closed_text", "optimal", "perpendicular")
FINAL = {
    "closed": ("travelled",),
    "closed_text": ("closed",),
    "optimal": ("closed", "boundary", "minimal"),
    "perpendicular": ("closed", "perpendicular"),
}


def tree(
    experience: Experience, query: Query, watch: Watch, journal: Journal, result: dict[str, Any]
) -> None:
    """Fill in ``result``, by clingo alone (semantics: "What Figure 4 counts"):

    ``per_step``: hypotheses after each step, from 0; ``nodes``: their sum; ``maps``:
    those whose last step added a link, and the root; ``final``: those after the last
    step; of these ``closed``: every path holds two places, as the table counts it;
    ``closed_text``: no pending gateway; ``optimal``; ``perpendicular``: closed and
    qualitatively perpendicular. What the time limit cuts off stays None.

    A node of the tree at depth t is an answer set with ``-c horizon=t``. Large levels are
    counted cube by cube, each a unit of the journal.
    """

    def total(query: Query, cubes: list[Cube]) -> tuple[int, int]:
        pairs = journal.known(len(cubes))
        if left := cubes[len(pairs) :]:
            for pair in count(experience, query, watch, left):
                journal.keep(pair)
                pairs.append(pair)
        return sum(pair[0] for pair in pairs), sum(pair[1] for pair in pairs)

    result.update(dict.fromkeys(KEYS), per_step=[])
    whole: list[Cube] = [()]
    parts = cubes(experience, query)
    demand_level(experience, query, watch, parts)
    last = experience.steps if query.horizon is None else min(query.horizon, experience.steps)
    nodes = maps = 0
    for step in range(last + 1):
        watch.title(f"step {step} of {last}")
        at_step = replace(query, horizon=step)
        final, grown = total(at_step, whole if step < len(parts[0]) else parts)
        result["per_step"].append(final)
        nodes += final
        maps += grown
    result.update(nodes=nodes, maps=maps, final=final)
    for key, properties in FINAL.items():
        watch.title(f"{key} maps")
        asked = query.having(*properties)
        result[key], _ = total(asked, whole if asked.optimizes else parts)


@dataclass
class Tally:
    """The same figures, of nodes that a search passes: add each, and merge the tallies of
    parts of the tree. ``cost`` is that of the optimal maps so far."""

    steps: int
    per_step: list[int] = field(default_factory=list)
    maps: int = 0
    closed: int = 0
    closed_text: int = 0
    perpendicular: int = 0
    cost: tuple[int, ...] | None = None
    optimal: int = 0

    def __post_init__(self) -> None:
        self.per_step = self.per_step or [0] * (self.steps + 1)

    def add(self, node: Hypothesis) -> None:
        """Count a node."""
        self.per_step[node.steps] += 1
        self.maps += node.grown
        if node.steps < self.steps:
            return
        self.closed += node.travelled()
        if node.closed():
            self.closed_text += 1
            self.perpendicular += node.square()
            if self.cost is None or node.cost <= self.cost:
                self._best(node.cost, node.map.boundaries_consistent())

    def merge(self, other: "Tally") -> None:
        """Count what another tally has counted."""
        self.per_step = [a + b for a, b in zip(self.per_step, other.per_step, strict=True)]
        self.maps += other.maps
        self.closed += other.closed
        self.closed_text += other.closed_text
        self.perpendicular += other.perpendicular
        if other.cost is not None:
            self._best(tuple(other.cost), other.optimal)

    def _best(self, cost: tuple[int, ...], number: int) -> None:
        """Take in so many optimal maps."""
        if number and (self.cost is None or cost <= self.cost):
            self.optimal = number + (self.optimal if cost == self.cost else 0)
            self.cost = cost

    def figures(self) -> dict[str, Any]:
        """What ``tree`` gives."""
        counted = {key: getattr(self, key) for key in FINAL}
        return {
            "nodes": sum(self.per_step),
            "maps": self.maps,
            "final": self.per_step[-1],
            **counted,
            "per_step": self.per_step,
        }


def searched(
    experience: Experience, query: Query, watch: Watch, journal: Journal, jobs: int = 1
) -> Tally:
    """The figures of the tree by depth-first search: of its top, and of the parts below it,
    each a unit of the journal, shared out among so many processes."""
    parts = cubes(experience, query, 16 * 64)
    node = root(experience, query)
    tally = Tally(node.experience.steps)
    for _ in breadth_first(node, watch):
        if len(node.at) == len(parts[0]):
            break
        tally.add(node)
    known = [Tally(**value) for value in journal.known(len(parts))]
    for done in known:
        tally.merge(done)
    for done in _shared(experience, query, watch, parts[len(known) :], jobs):
        journal.keep(asdict(done))
        tally.merge(done)
        watch.found = tally.per_step[-1]
        watch.tick()
    return tally


def _part(experience: Experience, query: Query, cube: Cube, watch: Watch | None = None) -> Tally:
    """The figures of the tree from a node down."""
    node = root(experience, query)
    node.goto(cube)
    tally = Tally(node.experience.steps)
    for _ in depth_first(node, watch):
        tally.add(node)
    return tally


def _shared(
    experience: Experience, query: Query, watch: Watch, parts: list[Cube], jobs: int
) -> Iterator[Tally]:
    """The figures of each part, in order."""
    if jobs == 1:
        yield from (_part(experience, query, cube, watch) for cube in parts)
        return
    with get_context("spawn").Pool(jobs, _heed_the_parent) as pool:
        tallies = pool.imap(partial(_part, experience, query), parts)
        for _ in parts:
            while True:
                try:
                    yield tallies.next(timeout=0.5)
                    break
                except TimeoutError:
                    watch.tick()


def _heed_the_parent() -> None:
    """In a worker: end when the pool is ended, not by Ctrl-C in the terminal."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
