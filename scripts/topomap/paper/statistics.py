"""The figures of the search tree (the paper, Figure 4), by clingo and by search."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import islice
from typing import Any

from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.model.vocabulary import PRUNING
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.search.hypothesis import Hypothesis
from topomap.search.merging import Merging
from topomap.solver.circumscription import circumscribed
from topomap.solver.share import ALONE, Crew
from topomap.solver.solving import count, demand_cover

LARGE = 10_000  # a level with more hypotheses than this is counted cube by cube
KEYS = ("nodes", "maps_built", "final", "closed", "closed_text", "optimal", "perpendicular")
WORDS = {
    "nodes": "Search-tree nodes built",
    "maps_built": "Maps built",
    "final": "Final maps (all)",
    "closed": "Final maps (closed: no path untravelled)",
    "closed_text": "  (closed: no gateway pending)",
    "optimal": "Optimal final maps",
    "perpendicular": "Closed and perpendicular maps",
    "circumscribed": "Circumscribed final maps",
}
FINAL = {
    "closed": ("travelled",),
    "closed_text": ("closed",),
    "optimal": ("closed", "boundary", "minimal"),  # if some closed map has no exceptions
    "perpendicular": ("closed", "perpendicular"),
}
MERGED: dict[str, tuple[str, ...]] = {  # what can be counted by merging; the fastest comes first
    "perpendicular": FINAL["perpendicular"],
    "closed_text": FINAL["closed_text"],
    "final": (),
}
EXCEPTIONAL = ("closed", "exceptions", "minimal")  # the same if each closed map has exceptions


def merged(experience: Experience, query: Query, watch: Watch) -> Iterator[tuple[str, int]]:
    """Count figures of the maps of a query by merging.

    Each figure comes with its name, and those that are counted fastest come first.

    Raises:
        InputError: Something keeps hypotheses from being merged.
    """
    for key, parts in MERGED.items():
        watch.title(WORDS[key].strip(" ()").lower())
        *_, number = Merging(experience, query.having(*parts)).counts(watch)
        yield key, number


def tree(
    experience: Experience,
    query: Query,
    watch: Watch,
    journal: Journal,
    result: dict[str, Any],
    crew: Crew = ALONE,
    circumscribe: bool = False,
) -> None:
    """Count the search tree by clingo alone (semantics: "What Figure 4 counts").

    ``result`` gets these figures. ``per_step`` has the number of hypotheses after each step, from
    0, and ``nodes`` is their sum. ``maps_built`` counts those whose last step added a link, and the
    root. ``final`` counts those after the last step; of these, ``closed`` counts those in which
    every path has two places, as the table does, ``closed_text`` those without a pending gateway,
    ``optimal`` the optimal ones, and ``perpendicular`` those that are closed and qualitatively
    perpendicular. If it is asked for, ``circumscribed`` is counted, too, with its kind. What the
    time limit cuts off stays None.

    A node of the tree at depth t is an answer set with ``-c horizon=t``. Large levels are counted
    cube by cube, and each cube is a unit of the journal.
    """

    def counted(units: list[Unit]) -> Iterator[tuple[int, int]]:
        """Give the values of units, from the journal or newly counted."""
        known = journal.known(len(units))
        yield from known
        found = watch.found
        for pair in crew.each(partial(_counted, experience), units[len(known) :], watch):
            journal.keep(pair)
            watch.found = found = found + pair[0]
            yield pair

    maps_built = 0

    def level(pairs: Iterator[tuple[int, int]]) -> int:
        """Collect the pairs of a step, and return the number of hypotheses."""
        nonlocal maps_built
        numbers = list(pairs)
        maps_built += sum(grown for _, grown in numbers)
        result["per_step"].append(sum(total for total, _ in numbers))
        return int(result["per_step"][-1])

    result.update(dict.fromkeys(KEYS), per_step=[])
    if circumscribe:
        result.update(circumscribed=None, circumscribed_kind=None)
    monotone = query.parts <= set(PRUNING)
    last = experience.steps if query.horizon is None else min(query.horizon, experience.steps)
    branches: list[Cube] = [()]
    cubes: list[Cube] = []  # they replace the branches after a step
    depth = step = 0
    while step <= last:
        watch.title(f"step {step} of {last}")
        if not cubes and (not monotone or max(result["per_step"], default=0) > LARGE):
            cubes, depth = traversal.cubes(experience, query)
        if cubes and step >= depth:
            demand_cover(experience, query, watch, cubes, depth)
            branches = cubes
            break
        if not level(counted([(replace(query, horizon=step), cube, True) for cube in branches])):
            branches = [] if monotone else branches
        step += 1
    # All that is left is shared out at once, so that no process waits for the end of a step.
    steps = range(step, last + 1)
    units = [(replace(query, horizon=step), cube, True) for step in steps for cube in branches]
    asked = {key: query.having(*properties) for key, properties in FINAL.items()}
    cubes_of = {key: [()] if asked[key].optimizes else branches for key in asked}
    units += [(asked[key], cube, False) for key in asked for cube in cubes_of[key]]
    pairs = counted(units)
    for step in steps:
        watch.title(f"step {step} of {last}")
        level(islice(pairs, len(branches)))
    result.update(
        nodes=sum(result["per_step"]), maps_built=maps_built, final=result["per_step"][-1]
    )
    for key in asked:
        watch.title(f"{key} maps")
        number = sum(total for total, _ in islice(pairs, len(cubes_of[key])))
        if key == "optimal" and not number and result["closed_text"]:
            continue  # each closed map has exceptions
        result[key] = number
    if result["optimal"] is None:
        watch.title("optimal maps")
        ((result["optimal"], _),) = counted([(query.having(*EXCEPTIONAL), (), False)])
    if circumscribe:
        watch.title("circumscribed maps")
        kind, many = None, 0
        for found in circumscribed(experience, query, watch):
            kind, many = found.kind, many + 1
        result.update(circumscribed=many, circumscribed_kind=kind)


def final_maps(experience: Experience, query: Query, watch: Watch, crew: Crew) -> int:
    """Count the hypotheses after the last step by clingo."""
    branches, depth = traversal.cubes(experience, query)
    demand_cover(experience, query, watch, branches, depth)
    units = [(query, cube, False) for cube in branches]
    return sum(total for total, _ in crew.each(partial(_counted, experience), units, watch))


Unit = tuple[Query, Cube, bool]


def _counted(experience: Experience, unit: Unit, watch: Watch | None) -> tuple[int, int]:
    query, cube, grown = unit
    return count(experience, query, cube, watch, grown)


@dataclass
class Tally:
    """The same figures of nodes that a search visits.

    Each node is added, and the tallies of branches of the tree are merged. ``cost`` is that of the
    optimal maps so far: exceptions, paths, places.
    """

    steps: int
    per_step: list[int] = field(default_factory=list)
    maps_built: int = 0
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
        self.maps_built += node.grown
        if node.steps < self.steps:
            return
        self.closed += node.travelled()
        if node.closed():
            self.closed_text += 1
            self.perpendicular += node.square()
            if self.cost is None or (0, *node.cost) <= self.cost:
                self._best((sum(1 for _ in node.map.exceptions()), *node.cost), 1)

    def merge(self, other: "Tally") -> None:
        """Add what another tally has counted."""
        self.per_step = [a + b for a, b in zip(self.per_step, other.per_step, strict=True)]
        self.maps_built += other.maps_built
        self.closed += other.closed
        self.closed_text += other.closed_text
        self.perpendicular += other.perpendicular
        if other.cost is not None:
            self._best(tuple(other.cost), other.optimal)

    def _best(self, cost: tuple[int, ...], number: int) -> None:
        """Add a number of optimal maps of a cost."""
        if self.cost is None or cost <= self.cost:
            self.optimal = number + (self.optimal if cost == self.cost else 0)
            self.cost = cost

    def told(self, fault: str | None, order: str) -> dict[str, Any]:
        """Tell what is known of these figures if a search in this order was cut short."""
        figures = self.figures()
        if fault and order == "breadth":  # the last level that has a node is not complete
            whole = sum(map(bool, self.per_step)) - 1
            return dict.fromkeys(KEYS) | {"per_step": self.per_step[: max(0, whole)]}
        if fault:  # no level is complete, and an unknown map may be better than the best so far
            least = {key: figures[key] for key in (*KEYS, "per_step") if key != "optimal"}
            return dict.fromkeys((*KEYS, "per_step")) | {"at_least": least}
        return figures

    def figures(self) -> dict[str, Any]:
        """The figures, named as ``tree`` names them."""
        counted = {key: getattr(self, key) for key in FINAL}
        return {
            "nodes": sum(self.per_step),
            "maps_built": self.maps_built,
            "final": self.per_step[-1],
            **counted,
            "per_step": self.per_step,
        }


def searched(
    experience: Experience, query: Query, watch: Watch, journal: Journal, crew: Crew = ALONE
) -> Tally:
    """Count the tree by depth-first search.

    The top of the tree is counted first. Then come the branches below it, each of which is a unit
    of the journal.
    """
    branches, _ = traversal.cubes(experience, query, 256)
    node = traversal.root(experience, query)
    tally = Tally(node.experience.steps)
    for _ in traversal.top(node, set(branches)):
        tally.add(node)
    known = [Tally(**value) for value in journal.known(len(branches))]
    for done in known:
        tally.merge(done)
    for done in crew.each(partial(_branch, experience, query), branches[len(known) :], watch):
        journal.keep(asdict(done))
        tally.merge(done)
        watch.found = tally.per_step[-1]
        watch.tick()
    return tally


def _branch(experience: Experience, query: Query, cube: Cube, watch: Watch | None) -> Tally:
    """Count the tree from a node down."""
    node = traversal.root(experience, query)
    node.goto(cube)
    tally = Tally(node.experience.steps)
    for _ in traversal.depth_first(node, watch):
        tally.add(node)
    return tally


def figures_text(figures: Mapping[str, Any], fault: str | None) -> str:
    """Write the figures to read.

    If the search was cut short, ``at_least`` has the figures of the nodes that were visited.
    """
    least = figures.get("at_least")
    told, more = (least, "at least ") if least else (figures, "")
    merging = figures.get("way") == "merging"
    lines = []
    if not merging:
        steps = " ".join(map(str, told["per_step"])) or "not counted"
        lines.append(f"hypotheses after each step: {more}{steps}")
    asked = ("circumscribed",) if "circumscribed" in figures else ()
    for key in (*(key for key in KEYS if key in MERGED or not merging), *asked):
        known = "not counted" if told.get(key) is None else f"{more}{told[key]:,}"
        lines.append(f"{WORDS[key]:<42}{known:>12}")
    if (kind := figures.get("circumscribed_kind")) and kind != "circumscribed":
        lines.append(f"{kind}: no closed map has consistent boundaries, so gateways may be pending")
    if fault:
        lines.append(f"partial: {fault}")
    return "\n".join(lines) + "\n"
