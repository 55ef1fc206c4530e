"""Which default of the theory, or which part, stands in the way of a closed map.

Each alone is removed, and a closed map is looked for, within a small budget of counted work.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

import clingo

from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.watch import Watch
from topomap.solver.programs import Program, calls
from topomap.solver.threads import Put

# The budget for each thing that is removed: the largest number of conflicts of clingo, and the
# largest number of pairs of visits that look alike, with which the ground program grows.
CONFLICTS, PAIRS = 2_000, 1_000
PATH_AXIOM, BOUND = "path_axiom", "bound"
# What is removed, in words, with the option that removes it, or that is left out.
WORDS = {
    PATH_AXIOM: "the path axiom there is one: --no-path-axiom",
    "boundary": "--boundary there is one",
    "perpendicular": "--perpendicular there is one",
    "planar": "--planar there is one",
    "euler": "--euler there is one",
    BOUND: "--bound there is one",
}


def in_the_way(experience: Experience, query: Query, watch: Watch) -> list[str]:
    """Find what alone stands in the way of a closed map, for a query that has none.

    Only what is proved is named. If the budget is used up first, nothing is reported.

    Parameters:
        experience: What the agent saw and did.
        query: What was asked for. Nothing more need be proved about it than that it has no closed
            map.
        watch: What may end the work, with Stopped.

    Returns:
        Keys of WORDS, in that order. There are none if views may be wrong, if the paper's rules
        were asked for, or if so many visits look alike that grounding would take long.
    """
    seen = experience if query.horizon is None else experience.cut(query.horizon)
    alike = Counter(map(len, seen.views)).values()
    many = sum(number * (number - 1) // 2 for number in alike) > PAIRS
    if query.noise is not None or query.encoding != "work" or many:
        return []
    asked = replace(query, parts=query.parts - {"minimal", "exceptions", "genus"})
    watch.phase("what stands in the way of a closed map")
    return [
        name
        for name, other in _taken_away(asked.having("closed"))
        if _has_map(experience, other, watch)
    ]


def told(names: Sequence[str]) -> str:
    """Say in one line what stands in the way; there must be something."""
    return "; ".join(["no closed map", *(f"without {WORDS[name]}" for name in names)])


def _taken_away(query: Query) -> Iterator[tuple[str, Query]]:
    if "no_path_axiom" not in query.parts:
        yield PATH_AXIOM, query.having("no_path_axiom")
    for part in ("boundary", "perpendicular", "planar", "euler"):
        if part in query.parts:
            yield part, replace(query, parts=query.parts - {part})
    if query.places is not None:
        yield BOUND, replace(query, places=None)


def _has_map(experience: Experience, query: Query, watch: Watch) -> bool:
    """Tell whether a map of a query is found within the budget."""
    found: list[bool] = []

    def take(_: clingo.Model) -> bool:
        """Note that there is a map."""
        found.append(True)
        return False

    def work(program: Program, put: Put) -> None:
        """Solve the program, and put whether there is a map."""
        solve = program.control.configuration.solve
        solve.solve_limit = f"{CONFLICTS},umax"  # type: ignore[union-attr]
        program.solve((), on_model=take)
        put(True)

    for _ in calls(experience, query, "", watch, work):
        pass
    return bool(found)
