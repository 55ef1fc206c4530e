"""The maps that none is preferred to by set inclusion, by clingo: ``encodings/circumscribe.lp``.

A map is guessed, and then checked: the solver is asked for a map that is preferred to it, which
takes its place, until there is none. Then all maps with its paths and places are answers, and
no further map may have as much.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import clingo

from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped, Watch
from topomap.solver.programs import Program, calls
from topomap.solver.threads import Put

PREFER, REPEAT = clingo.Function("prefer"), clingo.Function("repeat")
Extent = list[clingo.Symbol]  # the atoms has/2 of a map: its paths and places


def hypotheses(
    experience: Experience, query: Query, watch: Watch, kind: str
) -> Iterator[Found | None]:
    """The circumscribed maps of a query, those with the same paths and places one after the
    other. Raises Stopped at the time limit, or out of memory."""
    for at in calls(experience, query.having("circumscribe"), "", watch, _work):
        watch.found += 1
        yield Found(at, kind)


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
    while going and (extent := _extent(program)) is not None:
        while True:
            with _given(control, PREFER, extent):
                better = _extent(program)
            if better is None:
                break
            extent = better
        control.configuration.solve.models = 0
        with _given(control, REPEAT, extent):
            _settled(program.solve((), on_model=take))
        number += 1
        passed = [clingo.Function("passed", [clingo.Number(number), *has.arguments]) for has in extent]
        control.add(f"extent_{number}", [], "".join(f"{atom}.\n" for atom in passed))
        control.ground([(f"extent_{number}", []), ("passed", [clingo.Number(number)])])


def _extent(program: Program) -> Extent | None:
    """The paths and places of the first map that the solver finds, if there is one."""
    control: Any = program.control
    control.configuration.solve.models = 1
    found: list[Extent] = []

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
def _given(control: clingo.Control, ask: clingo.Symbol, extent: Extent) -> Iterator[None]:
    """While this map is given, and the solver is asked for those that are preferred to it, or
    have its paths and places."""
    atoms = [ask, *(clingo.Function("given", atom.arguments) for atom in extent)]
    for atom in atoms:
        control.assign_external(atom, True)
    try:
        yield
    finally:
        for atom in atoms:
            control.assign_external(atom, False)
