"""Few reasons why there is no map, so that they can be read.

A few single reasons say most. If more are needed, they are gathered (``cores``), and the fewest are
sought as a minimum hitting set: each set of gathered reasons without which there is a map must
contain one of the reasons that suffice. So the fewest reasons that hit all sets found so far are
tried. Either they suffice, or they lead to one more such set. If this takes too long, reasons are
removed one after the other instead.
"""

from collections.abc import Sequence

import clingo

from topomap.questions.cores import NEAR, Given, Unsettled, rank, reduced
from topomap.questions.reasons import of_one_step
from topomap.solver.programs import Program
from topomap.solver.threads import Put

MOST = 5  # if more single reasons are needed than gathered ones, the gathered ones are given
# Orders in which single reasons, parts of gathered reasons, and gathered reasons are tried; and
# the solver's conflicts to try one reason.
ORDERS, PARTS, GATHERED = (NEAR, 0, 2), (NEAR, 0, 2, 3, 4, 5), (0, 1)
TRYING = 100
# The solver's work after which the fewest reasons are no longer sought: conflicts times rules,
# because a conflict takes longer if there are more rules; and calls.
WORK, CALLS = 4_000_000, 400


def find_few(program: Program, put: Put) -> None:
    """Put reasons that suffice, and whether they are gathered and proved to be the fewest.

    Whether some of the last ones are not needed is left to ``verify``.
    """
    given = Given(program, ())
    given.name(gather=True)
    enough = given.core(given.names)
    if enough is None:
        raise RuntimeError("the maps differ between two encodings")
    put((True, tuple(sorted(enough, key=rank)), False))
    given.name(gather=False)
    single = reduced(given, lambda _: put(None), MOST, ORDERS, TRYING)
    if single is not None:
        put((False, tuple(sorted(single, key=rank)), False))
        return
    given.name(gather=True)
    fewest = _fewest(given)
    if fewest is None:
        given.name(gather=True)

        def tell(names: Sequence[str]) -> bool:
            """Put gathered reasons, and say whether to go on."""
            return put((True, tuple(names), False))

        reasons = reduced(given, tell, orders=GATHERED, limit=TRYING) or []
    else:
        reasons = fewest
    put((True, tuple(sorted(reasons, key=rank)), fewest is not None))
    parts = given.in_force(reasons)
    given.name(gather=False)
    most = max(MOST, len(reasons))
    single = reduced(given, lambda _: put(None), most, PARTS, TRYING, parts)
    if single is not None:
        put((False, tuple(sorted(single, key=rank)), False))


class _Meeting:
    """The fewest names that hit each of some sets; of equally many, those with the fewest steps."""

    def __init__(self, names: Sequence[str]):
        self.names = names
        self._control = clingo.Control()
        with self._control.backend() as backend:
            symbols = [clingo.Function("taken", [clingo.Number(n)]) for n in range(len(names))]
            self._atoms = [backend.add_atom(symbol) for symbol in symbols]
            backend.add_rule(self._atoms, choice=True)
            backend.add_minimize(2, [(atom, 1) for atom in self._atoms])
            steps = [a for a, name in zip(self._atoms, names, strict=True) if of_one_step(name)]
            backend.add_minimize(1, [(atom, 1) for atom in steps])

    def add(self, names: Sequence[str]) -> None:
        """Add one more set."""
        with self._control.backend() as backend:
            backend.add_rule([], [-self._atoms[self.names.index(name)] for name in names])

    def least(self) -> list[str]:
        """Find the names that hit all sets."""
        found: list[list[str]] = []

        def take(model: clingo.Model) -> None:
            """Note the names of an answer."""
            taken = sorted(one.arguments[0].number for one in model.symbols(atoms=True))
            found.append([self.names[number] for number in taken])

        self._control.solve(on_model=take)
        return found[-1]


def _fewest(given: Given) -> list[str] | None:
    """Find the fewest gathered reasons that suffice; None if the budget is not enough."""
    meeting = _Meeting(given.names)
    conflicts = WORK // len(given.literals)
    while given.conflicts < conflicts and given.calls < CALLS:
        names = meeting.least()
        try:
            if given.core(names, conflicts - given.conflicts) is not None:
                return names
        except Unsettled:
            return None
        kept = given.grown(names)
        meeting.add([name for name in given.names if name not in kept])
    return None
