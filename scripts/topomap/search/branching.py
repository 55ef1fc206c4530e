"""Equation (1) of the paper, node by node: how much planarity narrows the search.

The equation predicts bp/b = (pi / mean p) / (m + 1). Here pi is the number of pending gateways on
the face of the gateway by which the step leaves, p that on all f faces, mean p = p / f, and m the
number of matches so far. This is compared with what is measured: every child is built, and its
genus counted anew. Children are counted before the path axiom, the bound and the marker are
applied; one of them is always the map with a new place.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from topomap.model.found import steps_json
from topomap.runtime.watch import Watch, spared
from topomap.search.hypothesis import Hypothesis
from topomap.search.traversal import breadth_first


@dataclass(frozen=True)
class Branches:
    """The branches of a node.

    It has the numbers of children ``b`` and of planar ones ``bp``, the numbers of pending gateways
    on the face ``pi`` and in all ``p``, and the ratio bp/b by equation (1), which is None if p is
    0.
    """

    b: int
    bp: int
    pi: int
    p: int
    predicted: Fraction | None

    @property
    def measured(self) -> Fraction:
        """The ratio bp/b as it is."""
        return Fraction(self.bp, self.b)

    @property
    def difference(self) -> Fraction | None:
        """The measured ratio minus the predicted one."""
        return None if self.predicted is None else self.measured - self.predicted

    def document(self) -> dict[str, Any]:
        """The branches as JSON."""
        numbers = {"measured": self.measured, "predicted": self.predicted}
        return {
            **{key: getattr(self, key) for key in ("b", "bp", "pi", "p")},
            **{key: None if n is None else float(n) for key, n in numbers.items()},
            "equal": self.measured == self.predicted,
        }


@dataclass(frozen=True)
class BranchingNode:
    """A node whose next step, ``step``, leaves by a pending gateway.

    ``worst`` counts as if every pending gateway fitted the view, as the paper assumes. ``seen``
    counts only those that fit (its footnote 2: pi and p count only these, too). ``start_fits``
    tells whether the gateway by which the step leaves is one of them, as it is in the worst case.
    """

    at: tuple[tuple[int, int], ...]
    step: int
    matches: int
    faces: int
    start_fits: bool
    worst: Branches
    seen: Branches

    @property
    def faces_hold(self) -> bool:
        """Whether f = m + 1."""
        return self.faces == self.matches + 1

    @property
    def gap(self) -> Fraction:
        """The ratio for the views that are seen, minus that of equation (1) as it stands."""
        return self.seen.measured - (self.worst.predicted or 0)

    def document(self) -> dict[str, Any]:
        """The node as JSON."""
        return {
            "step": self.step,
            "at": steps_json(self.at),
            "m": self.matches,
            "f": self.faces,
            "start_fits": self.start_fits,
            "worst": self.worst.document(),
            "seen": self.seen.document(),
            "seen_minus_equation": float(self.gap),
        }


@spared
def branching(node: Hypothesis, watch: Watch) -> Iterator[BranchingNode]:
    """Find the branching nodes of a planar tree, step by step."""
    for _ in breadth_first(node, watch):
        last = node.steps == node.experience.steps
        if not last and not node.rests and node.out() not in node.links:
            watch.found += 1
            yield _branching(node)


def _branching(node: Hypothesis) -> BranchingNode:
    out, new = node.out(), (node.steps + 1) * node.slots
    pending = tuple(gateway for face in node.faces for gateway in face)
    faces = len(node.map.faces())
    planar = {new} | {gateway for gateway in pending if gateway != out and _planar(node, gateway)}

    def branches(fit: set[int]) -> Branches:
        """Count the branches to the gateways that fit."""
        children = {new} | fit - {out}
        pi, p = len(fit & set(node.face(out))), len(fit)
        by_equation = Fraction(pi, 1) / Fraction(p, faces) / (node.matches + 1) if p else None
        return Branches(len(children), len(children & planar), pi, p, by_equation)

    fitting = set(node.fitting(pending))
    return BranchingNode(
        at=node.dstates,
        step=node.steps + 1,
        matches=node.matches,
        faces=faces,
        start_fits=out in fitting,
        worst=branches(set(pending)),
        seen=branches(fitting),
    )


def _planar(node: Hypothesis, arrival: int) -> bool:
    """Tell whether the map stays planar when the next step arrives there."""
    return node.experience.map_of((*node.dstates, divmod(arrival, node.slots))).genus() == 0


class Summary:
    """Totals over branching nodes, by step and in all.

    ``worst_equal`` is the number of nodes at which the worst case is as predicted. ``seen_equal``
    is that for the views that are seen, by footnote 2, of the nodes for which it predicts anything
    (``seen_predicted``). ``largest_difference`` is the largest difference there, and
    ``largest_gap`` the largest one to equation (1) as it stands.
    """

    def __init__(self) -> None:
        self.totals: dict[str, Any] = {**dict.fromkeys(FIGURES, 0), "steps": []}

    def add(self, node: BranchingNode) -> None:
        """Add a node, of the same step as the last one or of a later one."""
        steps = self.totals["steps"]
        if not steps or steps[-1]["step"] != node.step:
            steps.append({"step": node.step, **dict.fromkeys(FIGURES, 0)})
        for key, figure in FIGURES.items():
            for totals in self.totals, steps[-1]:
                totals[key] = (max if key in MAXIMA else sum)((totals[key], figure(node)))

    @property
    def holds(self) -> bool:
        """Whether f = m + 1, and equation (1) in the worst case, hold at every node."""
        return bool(
            self.totals["nodes"] == self.totals["f_is_m_plus_1"] == self.totals["worst_equal"]
        )


FIGURES: dict[str, Callable[[BranchingNode], float]] = {
    "nodes": lambda n: 1,
    "f_is_m_plus_1": lambda n: n.faces_hold,
    "matches": lambda n: n.matches,
    "worst_b": lambda n: n.worst.b,
    "worst_bp": lambda n: n.worst.bp,
    "worst_equal": lambda n: n.worst.difference == 0,
    "seen_b": lambda n: n.seen.b,
    "seen_bp": lambda n: n.seen.bp,
    "seen_predicted": lambda n: n.seen.difference is not None,
    "seen_equal": lambda n: n.seen.difference == 0,
    "start_fits": lambda n: n.start_fits,
    "start_fits_and_equal": lambda n: n.start_fits and n.seen.difference == 0,
    "largest_difference": lambda n: round(float(abs(n.seen.difference or 0)), 6),
    "largest_gap": lambda n: round(float(abs(n.gap)), 6),
}
MAXIMA = "largest_difference", "largest_gap"


def totals_text(totals: dict[str, Any]) -> str:
    """Write the totals of a summary to read, by step and in all."""
    head = "step", "nodes", "m", "worst b", "bp", "bp/b", "seen b", "bp", "bp/b", "start fits"
    lines = [" ".join(word.rjust(9) for word in head)]
    for part in [*totals["steps"], totals]:
        b, bp = part["worst_b"], part["worst_bp"]
        seen, seen_bp = part["seen_b"], part["seen_bp"]
        cells = [
            str(part.get("step", "all")),
            str(part["nodes"]),
            f"{part['matches'] / (part['nodes'] or 1):.2f}",
            *(str(b), str(bp), f"{bp / (b or 1):.3f}"),
            *(str(seen), str(seen_bp), f"{seen_bp / (seen or 1):.3f}"),
            str(part["start_fits"]),
        ]
        lines.append(" ".join(cell.rjust(9) for cell in cells))
    nodes = totals["nodes"]
    return "\n".join(
        [
            *lines,
            "m: matches so far (mean); b, bp: children, planar children (sums), in the worst case",
            "(every pending gateway fits) and as seen; start fits: nodes where the gateway left by",
            "would fit too",
            f"f = m + 1: at {totals['f_is_m_plus_1']} of {nodes} branching nodes",
            f"worst case as equation (1) predicts: at {totals['worst_equal']} of {nodes}",
            "as seen, of those that fit (footnote 2): "
            f"at {totals['seen_equal']} of {totals['seen_predicted']} with a prediction, "
            f"largest difference {totals['largest_difference']:.3f}; "
            f"where the start fits too: at {totals['start_fits_and_equal']} "
            f"of {totals['start_fits']}",
            f"as seen, against equation (1) with all pending gateways: largest difference "
            f"{totals['largest_gap']:.3f}",
            "",
        ]
    )
