"""Whether a statement holds in all maps, in some or in none.

A statement holds in some map (it is a brave consequence) if there is an answer under the assumption
that it holds. It holds in all maps (it is a cautious consequence) if there is no answer under the
assumption that it does not. So no maps are enumerated, and what a map shows about other statements
is not asked again. For the best maps, their cost is found first, and is then a bound.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import clingo

from topomap.documents.answers import map_json, map_line
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.questions.statements import Statement
from topomap.runtime.watch import Watch
from topomap.solver.programs import Program, calls
from topomap.solver.solving import preferences

BUDGETS = ("1000", "30000", "umax")  # conflicts: a hard question does not delay the others
Literal = tuple[str, bool]  # a term of a statement, and whether it holds


@dataclass
class Known:
    """What is known of a statement.

    It has a map in which the statement holds, a map in which it does not, and whether it is proved
    that there is no such map.
    """

    statement: Statement
    witness: Found | None = None
    counter: Found | None = None
    never: bool = False
    always: bool = False

    @property
    def holds(self) -> str | None:
        """Whether the statement holds in all maps, some or none, if that is settled."""
        if self.always or self.never:
            return "all" if self.always else "none"
        return "some" if self.witness and self.counter else None

    def words(self) -> str:
        """What is known, in words."""
        if self.holds:
            note = self.statement.note
            return f"in {self.holds}" + (f": {note}" if note else "")
        if self.witness or self.counter:
            return f"not settled: in some or {'all' if self.witness else 'none'}"
        return "not settled"


class Inquiry:
    """What is known of statements about certain maps; ``some`` tells whether there are any maps."""

    def __init__(self, asked: Sequence[Statement]):
        self.each = [Known(statement) for statement in asked]
        self.terms = dict.fromkeys(statement.term for statement in asked)
        self.some: bool | None = None
        self.kind: str | None = None
        self.cost: tuple[int, ...] = ()

    def settle(self, experience: Experience, query: Query, optimal: bool, watch: Watch) -> None:
        """Settle all statements.

        Raises:
            Stopped: The time limit has passed, or memory ran out.
        """
        if not optimal:
            self._settle(experience, query, query.kind, watch)
            return
        for closed, kind in ((("closed",), "optimal"), ((), "best so far")):
            for preferred, before in preferences(query):
                asked = query.having(*closed, preferred, "minimal")
                # No map of one kind does not mean that there is no map.
                self.some, self.kind = None, None
                self._settle(experience, asked, kind, watch)
                if self.some:
                    self.cost = (*before, *self.cost)
                    return

    def _settle(self, experience: Experience, query: Query, kind: str, watch: Watch) -> None:
        facts = "".join(f"ask({term}).\n" for term in self.terms)
        work = partial(_work, list(self.terms), query.optimizes)
        for at, cost, literals in calls(experience, query.having("query"), facts, watch, work):
            if at:
                watch.found += 1
                self.some, self.kind, self.cost = True, kind, cost
                self._see(Found(at, kind, cost), set(literals))
            elif literals:
                self._rule_out(*literals)
            else:
                self.some, self.kind = False, kind

    def _see(self, found: Found, literals: set[Literal]) -> None:
        for known in self.each:
            if (known.statement.term, known.statement.positive) in literals:
                known.witness = known.witness or found
            else:
                known.counter = known.counter or found

    def _rule_out(self, literal: Literal) -> None:
        for known in self.each:
            if known.statement.term == literal[0]:
                if known.statement.positive == literal[1]:
                    known.never = True
                else:
                    known.always = True

    def lines(self, experience: Experience, fault: str | None) -> Iterator[str]:
        """What is known, as lines to read; ``fault`` says why not everything is settled."""
        if self.some is False:
            yield "no map is consistent with it"
            return
        for known in self.each:
            yield f"{known.statement.text}: {known.words()}"
            for does, found in ("it holds", known.witness), ("it does not", known.counter):
                if found:
                    yield f"  a map in which {does}: {map_line(experience, found)}"
        if self.some:
            cost = f", cost {' '.join(map(str, self.cost))}" if self.cost else ""
            yield f"of the {self.kind} maps{cost}"
        if fault:
            yield f"partial: {fault}"

    def document(self, experience: Experience, query: Query, optimal: bool) -> dict[str, Any]:
        """What is known, as JSON, with whole maps as ``solve`` writes them."""

        def whole(found: Found | None) -> Any:
            """A map as ``solve`` writes it."""
            return found and map_json(experience.map_of(found.at), found.at)

        return {
            "slots": experience.slots,
            "parts": sorted(query.parts),
            "bound": query.places,
            "horizon": query.horizon,
            "optimal": optimal,
            "kind": self.kind,
            "cost": self.cost if self.some else None,
            "has_maps": self.some,
            "statements": [
                {
                    "statement": known.statement.text,
                    "holds": known.holds,
                    "note": known.statement.note,
                    "witness": whole(known.witness),
                    "counter": whole(known.counter),
                }
                for known in (self.each if self.some is not False else ())
            ],
        }


def _work(
    terms: Sequence[str], optimizes: bool, program: Program, put: Callable[[Any], bool]
) -> None:
    """Settle statements by clingo, and put what is found.

    Put are maps, each with its cost and what holds in it; literals that hold in no map; or that
    there is no map.
    """
    seen: set[Literal] = set()
    cost: tuple[int, ...] = ()
    going = True

    def take(model: clingo.Model) -> bool:
        """Put a map."""
        nonlocal cost, going
        if optimizes and not cost and not model.optimality_proven:
            return True
        cost = tuple(model.cost)
        shown = model.symbols(shown=True)
        holding = {str(atom.arguments[0]) for atom in shown if atom.name == "holds"}
        literals = [(term, term in holding) for term in terms]
        steps = sorted([a.number for a in atom.arguments] for atom in shown if atom.name == "at")
        seen.update(literals)
        going = put((tuple((place, slot) for _, place, slot in steps), cost, literals))
        return False

    if program.solve((), on_model=take).unsatisfiable:
        put(((), (), []))
        return
    if optimizes:
        bound = ",".join(map(str, cost))
        program.control.configuration.solve.opt_mode = f"enum,{bound}"  # type: ignore[union-attr]
    left = [(term, value) for term in terms for value in (True, False)]
    for conflicts in BUDGETS:
        program.control.configuration.solve.solve_limit = conflicts  # type: ignore[union-attr]
        asked, left = left, []
        for literal in asked:
            if not going or literal in seen:
                continue
            assumed = clingo.Function("holds", [clingo.parse_term(literal[0])]), literal[1]
            result = program.solve((), [assumed], on_model=take)
            if result.interrupted:
                return
            if result.unsatisfiable:
                going = put(((), (), [literal]))
            elif result.unknown:
                left.append(literal)
