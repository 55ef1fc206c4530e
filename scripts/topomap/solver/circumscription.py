"""The maps that none is preferred to by set inclusion: the policy of circumscription.

By clingo, with ``encodings/circumscribe.lp``: a map is guessed, and then checked. The solver is
asked for a map that is preferred to it, which takes its place, until there is none. Then all maps
with the same paths and places are answers, and each further map must lack some of these. By
search: all maps are listed, and compared by the definition.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import clingo

from topomap.model.circumscription import extent, least
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped, Watch
from topomap.search import traversal
from topomap.solver.programs import Program, calls
from topomap.solver.threads import Put

PREFER, REPEAT = clingo.Function("prefer"), clingo.Function("repeat")
Names = list[clingo.Symbol]  # the atoms has/2 of a map: its paths and places


def circumscribed(
    experience: Experience, query: Query, watch: Watch, by: str = "clingo"
) -> Iterator[Found]:
    """The circumscribed maps of a query, by one of WAYS.

    ``circumscribed``: of the closed maps with consistent boundaries those that none of them is
    preferred to; where there is none, ``circumscribed so far``: the same, pending gateways
    allowed. Those with the same paths and places come one after the other. Raises Stopped at the
    time limit, or out of memory.
    """
    way, admitted = WAYS[by], query.having("boundary")
    some = False
    for found in way(experience, admitted.having("closed"), watch, "circumscribed"):
        some = True
        yield found
    if not some:
        yield from way(experience, admitted, watch, "circumscribed so far")


def _by_clingo(experience: Experience, query: Query, watch: Watch, kind: str) -> Iterator[Found]:
    for at in calls(experience, query.having("circumscribe"), "", watch, _work):
        watch.found += 1
        yield Found(at, kind)


def _by_search(experience: Experience, query: Query, watch: Watch, kind: str) -> Iterator[Found]:
    known = watch.found
    maps = {
        found.at: extent(experience, found.at)
        for found in traversal.hypotheses(experience, query, watch)
        if found
    }
    watch.found = known  # those were not answers
    kept = least(maps.values())
    for at in sorted(
        maps, key=lambda at: (sorted(maps[at].paths, key=str), sorted(maps[at].places), at)
    ):
        if maps[at] in kept:
            watch.found += 1
            yield Found(at, kind)


WAYS: dict[str, Callable[[Experience, Query, Watch, str], Iterator[Found]]] = {
    "clingo": _by_clingo,
    "search": _by_search,
}


def _work(program: Program, put: Put) -> None:
    """Puts the dstates of each map."""
    control: Any = program.control
    program.changed = True
    control.configuration.solver.heuristic = "Domain"
    going = True

    def take(model: clingo.Model) -> bool:
        nonlocal going
        steps = sorted(
            [a.number for a in atom.arguments]
            for atom in model.symbols(shown=True)
            if atom.name == "at"
        )
        going = put(tuple((place, slot) for _, place, slot in steps))
        return going

    number = 0
    while going and (one := _first(program)) is not None:
        while True:
            with _given(control, PREFER, one):
                better = _first(program)
            if better is None:
                break
            one = better
        control.configuration.solve.models = 0
        with _given(control, REPEAT, one):
            _settled(program.solve((), on_model=take))
        number += 1
        passed = [clingo.Function("passed", [clingo.Number(number), *has.arguments]) for has in one]
        control.add(f"extent_{number}", [], "".join(f"{atom}.\n" for atom in passed))
        control.ground([(f"extent_{number}", []), ("passed", [clingo.Number(number)])])


def _first(program: Program) -> Names | None:
    """The paths and places of the first map that the solver finds, if there is one."""
    control: Any = program.control
    control.configuration.solve.models = 1
    found: list[Names] = []

    def take(model: clingo.Model) -> bool:
        found.append([atom for atom in model.symbols(shown=True) if atom.name == "has"])
        return False

    _settled(program.solve((), on_model=take))
    return found[0] if found else None


def _settled(result: clingo.SolveResult) -> None:
    """Raises Stopped if the solver was interrupted."""
    if result.interrupted:
        raise Stopped(INTERRUPT)


@contextmanager
def _given(control: clingo.Control, ask: clingo.Symbol, names: Names) -> Iterator[None]:
    """While this map is given, and the solver is asked for those that are preferred to it, or
    have its paths and places."""
    atoms = [ask, *(clingo.Function("given", atom.arguments) for atom in names)]
    for atom in atoms:
        control.assign_external(atom, True)
    try:
        yield
    finally:
        for atom in atoms:
            control.assign_external(atom, False)
