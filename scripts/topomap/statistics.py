"""The figures of the search tree (the paper, Figure 4), from clingo alone.

A node of the tree at depth t is an answer set with ``-c horizon=t``.
"""

from typing import Any

from topomap.experience import Experience
from topomap.solver import Query, Watch, count

KEYS = ("nodes", "maps", "final", "closed", "closed_text", "optimal", "perpendicular")
FINAL = {
    "closed": ("travelled",),
    "closed_text": ("closed",),
    "optimal": ("closed", "boundary", "minimal"),
    "perpendicular": ("closed", "perpendicular"),
}


def tree(experience: Experience, query: Query, watch: Watch, result: dict[str, Any]) -> None:
    """Fill in ``result`` (semantics: "What Figure 4 counts"):

    ``per_step``: hypotheses after each step, from 0; ``nodes``: their sum; ``maps``:
    those whose last step added a link, and the root; ``final``: those after the last
    step; of these ``closed``: every path holds two places, as the table counts it;
    ``closed_text``: no pending gateway; ``optimal``; ``perpendicular``: closed and
    qualitatively perpendicular. What the time limit cuts off stays None.
    """
    result.update(dict.fromkeys(KEYS), per_step=[])
    last = experience.steps if query.horizon is None else min(query.horizon, experience.steps)
    nodes = maps = 0
    for step in range(last + 1):
        watch.title(f"step {step} of {last}")
        total, grown = count(experience, Query(query.parts, query.places, step), watch)
        result["per_step"].append(total)
        nodes += total
        maps += grown
    result.update(nodes=nodes, maps=maps, final=total)
    for key, parts in FINAL.items():
        watch.title(f"{key} maps")
        result[key], _ = count(experience, query.having(*parts), watch)
