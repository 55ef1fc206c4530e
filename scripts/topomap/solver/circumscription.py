"""The maps to which no other is preferred by set inclusion: the policy of circumscription.

By clingo, with ``encodings/circumscribe.lp``, up to LISTED maps are listed and compared by their
paths and places. If there are more, a map is guessed and then checked: the solver is asked for a
map that is preferred to it, which takes its place, until there is none. Then all maps with the same
paths and places are answers, and each further map must lack some of these. By search, all maps are
listed, and compared by the definition.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import clingo

from topomap.model.circumscription import Extent, extent, least
from topomap.model.experience import DState, Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped, Watch
from topomap.search import traversal
from topomap.solver.programs import Program, calls
from topomap.solver.shown import Shown
from topomap.solver.threads import Put

LISTED = 10_000  # maps: up to so many are listed and compared, which is quicker than checks
PREFER, REPEAT = clingo.Function("prefer"), clingo.Function("repeat")
Names = list[clingo.Symbol]  # the atoms has/2 of a map: its paths and places


def circumscribed(
    experience: Experience, query: Query, watch: Watch, by: str = "clingo"
) -> Iterator[Found]:
    """Find the circumscribed maps of a query, by one of WAYS.

    They are ``circumscribed`` if they are those of the closed maps with consistent boundaries to
    which no other one is preferred. If there is no such map, they are ``circumscribed so far``: the
    same of all maps with consistent boundaries, which may have pending gateways. Maps with the same
    paths and places come one after the other.

    Raises:
        Stopped: The time limit has passed, or memory ran out.
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
    maps: dict[Extent, list[tuple[DState, ...]]] = {}
    for found in traversal.hypotheses(experience, query, watch):
        if found:
            maps.setdefault(extent(experience, found.at), []).append(found.at)
    watch.found = known  # the maps before were not answers
    kept = least(maps, watch.tick)
    for one, alike in maps.items():
        for at in alike if one in kept else ():
            watch.found += 1
            yield Found(at, kind)


WAYS: dict[str, Callable[[Experience, Query, Watch, str], Iterator[Found]]] = {
    "clingo": _by_clingo,
    "search": _by_search,
}


def _work(program: Program, put: Put) -> None:
    """Put the dstates of each map."""
    control: Any = program.control
    program.changed = True
    shown, going = Shown(), True
    maps: dict[Extent, list[tuple[DState, ...]]] = {}
    many = 0

    def add(model: clingo.Model) -> bool:
        """Add a map to the list."""
        nonlocal many
        many += 1
        at, others = shown.of(model.symbols(shown=True))
        names: dict[str, set[clingo.Symbol]] = {"path": set(), "place": set()}
        for _, (kind, name) in others:
            names[kind.name].add(name)
        one = Extent(frozenset(names["path"]), frozenset(names["place"]))
        maps.setdefault(one, []).append(at)
        return many <= LISTED

    _settled(program.solve((), on_model=add))
    if many <= LISTED:
        kept = least(maps)
        for one, alike in maps.items():
            for at in alike if one in kept else ():
                if not put(at):
                    return
        return
    maps.clear()

    def take(model: clingo.Model) -> bool:
        """Put a map."""
        nonlocal going
        going = put(shown.of(model.symbols(shown=True))[0])
        return going

    control.configuration.solver.heuristic = "Domain"
    number = 0
    while going and (names := _first(program)) is not None:
        while True:
            with _given(control, PREFER, names):
                better = _first(program)
            if better is None:
                break
            names = better
        control.configuration.solve.models = 0
        with _given(control, REPEAT, names):
            _settled(program.solve((), on_model=take))
        number += 1
        n = clingo.Number(number)
        passed = [clingo.Function("passed", [n, *has.arguments]) for has in names]
        control.add(f"extent_{number}", [], "".join(f"{atom}.\n" for atom in passed))
        control.ground([(f"extent_{number}", []), ("passed", [n])])


def _first(program: Program) -> Names | None:
    """The paths and places of the first map that the solver finds, or None."""
    control: Any = program.control
    control.configuration.solve.models = 1
    found: list[Names] = []

    def take(model: clingo.Model) -> bool:
        """Note the paths and places of the map."""
        found.append([atom for atom in model.symbols(shown=True) if atom.name == "has"])
        return False

    _settled(program.solve((), on_model=take))
    return found[0] if found else None


def _settled(result: clingo.SolveResult) -> None:
    """Check that the solver was not interrupted.

    Raises:
        Stopped: It was.
    """
    if result.interrupted:
        raise Stopped(INTERRUPT)


@contextmanager
def _given(control: clingo.Control, ask: clingo.Symbol, names: Names) -> Iterator[None]:
    """A context in which this map is given to the solver.

    The solver is asked for maps that are preferred to it, or that have its paths and places.
    """
    atoms = [ask, *(clingo.Function("given", atom.arguments) for atom in names)]
    for atom in atoms:
        control.assign_external(atom, True)
    try:
        yield
    finally:
        for atom in atoms:
            control.assign_external(atom, False)
