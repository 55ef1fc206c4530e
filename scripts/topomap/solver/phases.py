"""Large maps in phases: small programs find what is certain, so that less is left to ground.

All that is found, except what is ``rare``, holds in every map that is asked for, so that the
answers stay the same: each program demands less than the maps must fulfil. (Programs that do not
load the theory do not consider the marker.) These programs are in ``encodings/phases/``:

1. ``visits.lp``: which visits can be of one place, by pairs; this is settled while grounding.
2. for closed maps with at most so many places that need not be perpendicular: the theory without
   planarity, but with ``ends.lp``: at which gateways a visit can be in any such map (brave
   consequences).

For large closed and perpendicular maps, if the counting argument of ``runs.lp`` applies:

3. ``runs.lp``: which runs never cross and never lie on one path, with one call for each pair.
4. the theory without planarity: which visits are the first of their place, with one call for each.
5. if the map must be planar, the theory with planarity, on longer and longer beginnings of
   the exploration: brave consequences again.

If it does not apply, ``lines.lp``: which visits are of one place in any map (brave consequences).
It has few rules, and clasp is quick on it. If the map must be planar, clauses of ``plane.py`` are
added as they are needed. If this is not settled in time, what was seen in no map so far is rare:
the maps without it are looked for first.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import clingo
from clingo import Function, Number, Symbol

from topomap.model.experience import Experience
from topomap.search.future import future_of
from topomap.solver.plane import Planarity

if TYPE_CHECKING:
    from topomap.model.query import Query

SQUARE = {"closed", "perpendicular"}
LEAST = 150  # pairs of visits that can be of one place: with fewer, one call is as quick
TRY = 20  # conflicts for a question that may be left open
IN_VAIN = 50  # after so many questions in a row without an answer, no further one is asked
TRY_BOUNDED = 200_000  # conflicts for all maps with a bound
TRY_HARD = 200_000  # conflicts for one beginning, or for all lines
BRAVE = ("0", "--enum-mode=brave")
STRIDE = 6  # the least number of steps from one beginning to the next

# A function that is often called with the control that is solved next; it may raise an error to
# end the work.
Heed = Callable[[clingo.Control], None]


def serve(experience: Experience, query: "Query") -> bool:
    """Tell whether there are phases for such a query.

    The phases need views that are right and exact, and opposite gateways that are on one path.
    """
    if experience.parted or experience.tolerance or experience.straight:
        return False
    if "no_path_axiom" in query.parts:
        return False
    return query.noise is None and (_bounded(experience, query) or _square(experience, query))


def _bounded(experience: Experience, query: "Query") -> bool:
    return "closed" in query.parts and query.places is not None and _large(experience, query)


def _square(experience: Experience, query: "Query") -> bool:
    return query.parts >= SQUARE and experience.slots == 4 and _large(experience, query)


def _large(experience: Experience, query: "Query") -> bool:
    """Tell whether the ground program is large.

    It grows with the pairs of visits that can be of one place. (For very many visits these are not
    counted.)
    """
    pairs = future_of(experience if query.horizon is None else experience.cut(query.horizon)).pairs
    return pairs is None or pairs >= LEAST


def program(experience: Experience, query: "Query") -> tuple[list[str], list[str]]:
    """The files and the options with which clingo solves what the phases leave of a query.

    The parts of the query are not among the files.
    """
    if _bounded(experience, query) and not (query.optimizes or "perpendicular" in query.parts):
        return ["phases/topomap", "phases/earlier"], ["--heuristic=Domain"]
    return ["phases/topomap"], []


def found(
    experience: Experience, query: "Query", folder: Path, heed: Heed, say: Callable[[str], None]
) -> str:
    """Find facts for ``phases/topomap.lp`` that hold in every map for which the query asks.

    ``folder`` has the encodings. ``heed`` is called between two calls of clingo. The controls that
    it gets may be interrupted; then less is found, but it is true. ``say`` is called with what is
    being done.
    """
    bounded, square = _bounded(experience, query), _square(experience, query)
    if query.horizon is not None:
        experience = experience.cut(query.horizon)
    work = _Phases(experience.facts(), folder, heed, experience.constants())
    say("which visits can be of one place")
    few = work.visits()
    if bounded and not square:
        say(f"with {query.places} places")
        work.bounded(query.places or 0)
    if square and few:
        say("which runs can lie on one path")
        work.runs()
        say("which places are new")
        work.new()
        if "planar" in query.parts:
            say("longer and longer beginnings")
            work.beginnings(experience)
    elif square:
        say("which runs lie on one path")
        work.lines(Planarity(experience.slots) if "planar" in query.parts else None)
    return work.facts()


class _Phases:
    def __init__(self, facts: str, folder: Path, heed: Heed, constants: Sequence[str] = ()):
        self._facts, self._folder, self._heed = facts, folder, heed
        self._constants = constants  # as options of clingo
        self._pairs: list[Symbol] = []  # comparable/3 and iff/6
        self._found: list[Symbol] = []

    def facts(self) -> str:
        """All that was found."""
        found = [Function("found", [symbol]) for symbol in self._found]
        return "phases.\n" + "".join(f"{symbol}.\n" for symbol in [*self._pairs, *found])

    def _grounded(self, *files: str, arguments: Iterable[str] = ()) -> clingo.Control:
        control = clingo.Control([*self._constants, *arguments])
        self._heed(control)
        for file in files:
            control.load(str(self._folder / f"{file}.lp"))
        control.add("base", [], self._facts + self.facts())
        control.ground()
        self._heed(control)
        return control

    def visits(self) -> bool:
        """Find which visits can be of one place, and tell whether ``runs.lp`` can be used."""
        control = self._grounded("phases/visits")
        shown: Sequence[Symbol] = []
        with control.solve(yield_=True) as models:
            for model in models:
                shown = model.symbols(shown=True)
        few = Function("runs_bind")
        self._pairs = [symbol for symbol in shown if symbol != few]
        return few in shown

    def runs(self) -> None:
        """Find which runs never cross and never lie on one path."""
        control = self._grounded("phases/runs")
        atoms = control.symbolic_atoms
        through = sorted(atom.symbol.arguments[0] for atom in atoms.by_signature("passes_four", 1))
        pairs = [(a, b) for a in through for b in through if a < b]
        for number, relation in enumerate(("line", "cross_at_four")):
            for asked in self._refuted(control, [Function(relation, pair) for pair in pairs]):
                self._know("never", *asked.arguments, Number(number))

    def new(self) -> None:
        """Find which visits are the first of their place."""
        control = self._grounded("phases/topomap", "closed", "perpendicular")
        asked = [atom.symbol for atom in control.symbolic_atoms.by_signature("new", 1)]
        for old in self._refuted(control, asked):
            self._know("old", *old.arguments)
        for new in self._refuted(control, asked, False):
            self._know("new", *new.arguments)

    def _refuted(
        self, control: clingo.Control, asked: Sequence[Symbol], value: bool = True
    ) -> Iterator[Symbol]:
        """Find the atoms that have that value in no answer, each by a short call.

        It ends when there has been no such atom for long.
        """
        seen: set[Symbol] = set()  # atoms that have the value in some answer
        vain = 0
        _limit(control, TRY)

        def note(model: clingo.Model) -> None:
            """Note the atoms that have the value in an answer."""
            shown = set(model.symbols(atoms=True))
            seen.update(atom for atom in asked if (atom in shown) == value)

        for atom in asked:
            self._heed(control)
            if atom in seen:
                continue
            if control.solve([(atom, value)], on_model=note).unsatisfiable:
                vain = 0
                yield atom
            else:
                vain += 1
                if vain == IN_VAIN:
                    return

    def _know(self, name: str, *arguments: Symbol) -> None:
        self._found.append(Function(name, arguments))

    def bounded(self, places: int) -> None:
        """Find the gateways of visits in maps with a bound."""
        files = "closed", "bound", "phases/ends"
        self._possible(TRY_BOUNDED, files, "--eq=0", "-c", f"places={places}")

    def beginnings(self, experience: Experience) -> None:
        """Find the gateways of visits in planar maps of longer and longer beginnings."""
        new = {found.arguments[0].number for found in self._found if found.name == "new"}
        start = next((step for step in range(experience.steps) if step not in new), 0)
        for end in _ends(experience, start):
            if not self._possible(TRY_HARD, ("perpendicular", "planar"), "-c", f"horizon={end}"):
                return  # the later ones are larger

    def _possible(self, conflicts: int, files: Iterable[str], *options: str) -> bool:
        """Exclude the dstates that are in no answer of the theory with these parts.

        Returns:
            Whether that was settled within so many conflicts.
        """
        control = self._grounded("phases/topomap", *files, arguments=[*BRAVE, *options])
        unseen, settled = self._unseen(control, conflicts, ("at", 3))
        if settled:
            for atom in unseen:
                self._know("out", *atom.arguments)
        return settled

    def lines(self, planarity: Planarity | None = None) -> None:
        # With another configuration it may take long until there is a first map.
        """Find which visits are of one place, by ``lines.lp``."""
        options = [*BRAVE, "--configuration=handy"]
        if planarity:
            # Preprocessing takes long here, but the search is quick.
            options.append("--sat-prepro=no")
        control = self._grounded("phases/lines", arguments=options)
        if planarity:
            control.register_propagator(planarity)
        unseen, settled = self._unseen(control, TRY_HARD, ("one_place", 3), ("new", 1))
        for atom in unseen:
            if settled:
                self._know({"one_place": "apart", "new": "old"}[atom.name], *atom.arguments)
            elif atom.name == "one_place":
                self._know("rare", *atom.arguments)
            else:
                self._know("rare", *atom.arguments * 2, Number(0))

    def _unseen(
        self, control: clingo.Control, conflicts: int, *asked: tuple[str, int]
    ) -> tuple[list[Symbol], bool]:
        """Find the atoms of these predicates that were in no answer within so many conflicts.

        Returns:
            These atoms, and whether all answers were found. If none was found, there are no atoms.
        """
        atoms = control.symbolic_atoms
        unseen = {atom.symbol for name in asked for atom in atoms.by_signature(*name)}
        _limit(control, conflicts)
        with control.solve(yield_=True) as models:
            for model in models:
                self._heed(control)
                unseen.difference_update(model.symbols(shown=True))
            settled, some = bool(models.get().exhausted), bool(models.get().satisfiable)
        return sorted(unseen) if settled or some else [], settled


def _limit(control: clingo.Control, conflicts: int) -> None:
    control.configuration.solve.solve_limit = str(conflicts)  # type: ignore[union-attr]


def _ends(experience: Experience, last: int) -> Iterator[int]:
    """Some later steps, some distance apart, and the last step."""
    for step in range(experience.steps):
        if step >= last + STRIDE:
            yield step
            last = step
    yield experience.steps
