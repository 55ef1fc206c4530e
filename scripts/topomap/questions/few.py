"""Few reasons why there is no map, to be read.

A few single reasons tell most. If more are needed, they are gathered (``cores``), and the fewest
are sought: each set of gathered reasons without which there is a map must be met by those that
suffice. So the fewest that meet all sets found so far are tried: they suffice, or lead to one more
such set. Where this takes too long, reasons are spared one after the other instead.
"""

from collections.abc import Sequence

import clingo

from topomap.questions.cores import NEAR, Given, Unsettled, rank, reduced
from topomap.questions.reasons import of_one_step
from topomap.solver.programs import Program
from topomap.solver.threads import Put

MOST = 5  # single reasons; if more are needed, and fewer gathered ones, these are told
# Orders in which single reasons are tried, those that are parts of gathered ones, and gathered
# ones; and conflicts of the solver to try one.
ORDERS, PARTS, GATHERED = (NEAR, 0, 2), (NEAR, 0, 2, 3, 4, 5), (0, 1)
TRYING = 100
# Of the solver, until the fewest reasons are no longer sought: conflicts times rules, as they take
# the longer the more rules there are; and calls.
WORK, CALLS = 4_000_000, 400


def find_few(program: Program, put: Put) -> None:
    """Puts reasons that suffice, each time with whether they are gathered, and whether it is proved
    that no fewer suffice. Whether some of the last ones can be spared is left to ``verify``."""
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
    """The fewest names that meet each of some sets; of as many, those of the fewest steps."""

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
        """One more set."""
        with self._control.backend() as backend:
            backend.add_rule([], [-self._atoms[self.names.index(name)] for name in names])

    def least(self) -> list[str]:
        """The names that meet all sets."""
        found: list[list[str]] = []

        def take(model: clingo.Model) -> None:
            taken = sorted(one.arguments[0].number for one in model.symbols(atoms=True))
            found.append([self.names[number] for number in taken])

        self._control.solve(on_model=take)
        return found[-1]


def _fewest(given: Given) -> list[str] | None:
    """The fewest gathered reasons that suffice; None if they are not found within the budget."""
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
