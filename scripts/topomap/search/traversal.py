"""Search of the tree of hypotheses (the paper, Figure 2): the second way to every answer.

Each order visits the nodes of the tree with one ``Hypothesis``, which it moves; what is to be known
of a node is read while the hypothesis is there.
"""

import heapq
from collections.abc import Collection, Iterator, Sequence
from itertools import groupby
from operator import itemgetter

from topomap.model.experience import Experience
from topomap.model.found import Cube, Found
from topomap.model.query import Query
from topomap.model.vocabulary import PRUNING
from topomap.runtime.watch import Watch, spared
from topomap.search.descent import Descent
from topomap.search.hypothesis import OFTEN, Hypothesis


def root(experience: Experience, query: Query) -> Hypothesis:
    """The root of the tree without the children that the query forbids."""
    if query.horizon is not None:
        experience = experience.cut(query.horizon)
    planar, perpendicular = (part in query.parts for part in PRUNING)
    path_axiom = "no_path_axiom" not in query.parts
    return Hypothesis(experience, planar, query.places, perpendicular, path_axiom)


@spared
def depth_first(node: Hypothesis, watch: Watch | None = None) -> Iterator[Hypothesis]:
    """Visit the nodes from this one down; memory grows with the steps, not with the tree."""
    open_children = [_children(node)[::-1]]
    yield node
    nodes = 0
    while open_children:
        if not open_children[-1]:
            open_children.pop()
            if open_children:
                node.undo()
            continue
        node.enter(open_children[-1].pop())
        open_children.append(_children(node)[::-1])
        nodes += 1
        if watch and nodes % OFTEN == 0:
            watch.tick()
        yield node


@spared
def breadth_first(node: Hypothesis, watch: Watch | None = None) -> Iterator[Hypothesis]:
    """Visit the nodes from this one down, step by step; memory holds two levels of the tree."""
    level = [top := node.dstates]
    while level:
        children = []
        for number, at in enumerate(level):
            node.goto(at)
            yield node
            children += [(*at, divmod(arrival, node.slots)) for arrival in _children(node)]
            if watch and number % OFTEN == 0:
                watch.tick()
        level = children
    node.goto(top)


@spared
def best_first(node: Hypothesis, watch: Watch | None = None) -> Iterator[Hypothesis]:
    """Visit the nodes by the optimality policy (the paper, section IV).

    The node with the fewest paths, then the fewest places comes first, and of equal ones the
    deepest. Taking the next one after a leaf is backtracking.
    """
    border = [(node.cost, 0, node.dstates)]
    nodes = 0
    while border:
        *_, at = heapq.heappop(border)
        node.goto(at)
        nodes += 1
        if watch and nodes % OFTEN == 0:
            watch.tick()
        yield node
        for arrival in _children(node):
            node.enter(arrival)
            heapq.heappush(border, (node.cost, -node.steps, node.dstates))
            node.undo()


ORDERS = {"breadth": breadth_first, "depth": depth_first, "best": best_first}


def _children(node: Hypothesis) -> list[int]:
    return node.children() if node.steps < node.experience.steps else []


def cubes(experience: Experience, query: Query, least: int = 64) -> tuple[list[Cube], int]:
    """Find nodes that divide the hypotheses, so that a long run can be shared, cut and resumed.

    There are at least ``least`` of them, if there are as many. They are of similar size, as far as
    this can be told from the first level of the tree that has 32 times as many nodes (or else from
    the last level): the branches with more nodes of this level are divided again.

    Returns:
        The nodes, and the step of that level. The hypotheses after that step, and after each later
        one, begin with exactly one of the nodes each.
    """
    level: list[Cube] = []
    for node in breadth_first(root(experience, query)):
        if level and len(node.at) > len(level[0]):
            if len(level) >= 32 * least:
                break
            level = []
        level.append(node.dstates)
    branches: list[Cube] = []
    open_branches = [(1, level)]
    while open_branches:
        size, under = open_branches.pop()
        if len(under) * least <= len(level) or size == len(under[0]):
            branches.append(under[0][:size])
        else:
            groups = groupby(under, key=itemgetter(size))
            open_branches += [(size + 1, list(group)) for _, group in groups][::-1]
    return branches, len(level[0]) - 1


def top(node: Hypothesis, cubes: Collection[Cube]) -> Iterator[Hypothesis]:
    """Visit the nodes from this one down that are in none of the branches of the cubes."""
    border = [node.dstates]
    while border:
        at = border.pop()
        if at not in cubes:
            node.goto(at)
            yield node
            border += [(*at, divmod(arrival, node.slots)) for arrival in _children(node)]


def hypotheses(
    experience: Experience,
    query: Query,
    watch: Watch,
    kind: str | None = None,
    cubes: Sequence[Cube] | None = None,
) -> Iterator[Found | None]:
    """Find what ``solving.hypotheses`` gives, in the order of the tree.

    Raises:
        Stopped: The watch ends the search.
    """
    return Descent(experience, query, kind).found(watch, cubes)
