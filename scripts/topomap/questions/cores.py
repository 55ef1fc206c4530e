"""Minimal unsatisfiable cores: sets of reasons each of which is needed.

clingo gives unsatisfiable cores. They are made smaller, and each reason is verified by a map that
breaks only this one.

A reason may be single, such as ``view(7,1)``: the views after steps 7 and 1 differ, so they are not
of one place. Or it may be gathered: a whole rule, such as ``planarity``, or all that is seen after
one step, such as ``view(7)``. A single reason is in force if all gathered reasons of which it is
a part are in force: ``view(7,1)`` is a part of ``view(7)`` and of ``view(1)``.
"""

import math
import random
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import clingo

from topomap.model.experience import DState
from topomap.questions.reasons import (
    FIRST,
    RULE_NAMES,
    RULES,
    gathered,
    kind_of,
    numbers_of,
    of_one_step,
)
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped
from topomap.solver.programs import Program
from topomap.solver.threads import Put

REASON_ORDERS = 12  # the largest number of orders
NEAR = -1  # the order that removes reasons with neighbouring steps last
CONFLICTS, CALLS = 3_000, 500  # the solver's work after which no further order is tried
TIDYING = 100  # so many reasons are tried so that a map breaks few others
GROWING = 60  # conflicts for each gathered reason that is tried for the same purpose


def dstates(symbols: Sequence[clingo.Symbol]) -> tuple[DState, ...]:
    """The dstate after each step, from the atoms of an answer."""
    steps = sorted([a.number for a in atom.arguments] for atom in symbols if atom.name == "at")
    return tuple((place, slot) for _, place, slot in steps)


class Unsettled(Exception):
    """A call of the solver has used up its conflicts."""


class Given:
    """A program with reasons that may be given up, solved with some of them in force."""

    def __init__(self, program: Program, assumed: Sequence[tuple[clingo.Symbol, bool]]):
        self.control, self.assumed = program.control, list(assumed)
        settings: Any = self.control.configuration.solve
        settings.models, settings.opt_mode = 1, "ignore"
        program.solve(())  # this grounds the program
        atoms = self.control.symbolic_atoms.by_signature("waived", 1)
        literals = {str(atom.symbol.arguments[0]): -atom.literal for atom in atoms}
        self.literals = {name: literals[name] for name in sorted(literals, key=rank)}
        self.waived: set[str] = set()
        self.name(gather=False)

    def name(self, *, gather: bool) -> None:
        """Use gathered reasons, or single ones, from now on."""
        self.gather = gather
        self.of = {name: gathered(name) if gather else (name,) for name in self.literals}
        self.names = sorted({one for names in self.of.values() for one in names}, key=rank)
        self.conflicts = self.calls = 0

    def in_force(self, names: Sequence[str]) -> list[str]:
        """The single reasons that are in force with these reasons.

        They are in order, because what clingo blames depends on it.
        """
        rank_of = {name: number for number, name in enumerate(names)}
        kept = [name for name, of in self.of.items() if rank_of.keys() >= {*of}]
        return sorted(kept, key=lambda name: max(rank_of[one] for one in self.of[name]))

    def core(self, names: Sequence[str], limit: int | None = None) -> list[str] | None:
        """Find an unsatisfiable core of these reasons.

        Returns:
            Some of them with which there is no map; or None if there is a map with all of them, and
            then ``waived`` has the single reasons that it breaks.

        Raises:
            Unsettled: It takes more conflicts than the limit.
        """
        used: list[int] = []

        def take(model: clingo.Model) -> None:
            """Note which reasons a map breaks."""
            shown = model.symbols(shown=True)
            self.waived = {str(one.arguments[0]) for one in shown if one.name == "waived"}

        settings: Any = self.control.configuration.solve
        settings.solve_limit = f"{'umax' if limit is None else limit},umax"
        result = self.control.solve(self._assumed(names), on_core=used.extend, on_model=take)
        self.calls += 1
        self.conflicts += int(self.control.statistics["solving"]["solvers"]["conflicts"])
        if result.satisfiable is None:
            if limit is None or result.interrupted:
                raise Stopped(INTERRUPT)
            raise Unsettled
        if result.satisfiable:
            return None
        met = set(used)
        blamed = {one for name, of in self.of.items() if self.literals[name] in met for one in of}
        return [name for name in names if name in blamed]

    def grown(
        self, names: Sequence[str], without: str | None = None, most: float = math.inf
    ) -> list[str]:
        """Extend satisfiable reasons by others.

        There is a map with ``names``, the map of the last call. Others are added as long as a map
        allows them all; the reason ``without`` is left out. Each is tried with few conflicts, and,
        after ``most`` conflicts in all, without asking the solver.

        Returns:
            The reasons.
        """
        kept, end = list(names), self.conflicts + most
        for name in self.names:
            if name in kept or name == without:
                continue
            try:
                if self.waived & {*self.in_force([*kept, name])}:
                    if self.conflicts > end:
                        continue
                    before = self.waived
                    if self.core([*kept, name], GROWING) is not None:
                        self.waived = before
                        continue
                kept.append(name)
            except Unsettled:
                pass
        return kept

    def _assumed(self, names: Sequence[str]) -> list[tuple[clingo.Symbol, bool] | int]:
        return [*self.assumed, *(self.literals[name] for name in self.in_force(names))]

    def spare(self, names: list[str], demands: bool, limit: int | None = None) -> list[str]:
        """Remove whole kinds of reasons that are not needed, the last kinds first.

        They are kinds of demands, or all others. Each kind is tried with at most so many conflicts.
        """
        ranks = {kind_of(name): rank(name)[0] for name in names}
        for kind in sorted(ranks, key=ranks.__getitem__, reverse=True):
            spared = [name for name in names if kind_of(name) != kind]
            if demands == (ranks[kind] >= FIRST):
                with suppress(Unsettled):
                    names = names if self.core(spared, limit) is None else spared
        return names

    def broken(self, names: Sequence[str], without: str) -> tuple[clingo.Symbol, ...]:
        """Find a map with these reasons in force, except one, in which few others are broken.

        The last call has shown that there is such a map.

        Returns:
            What holds in the map.
        """
        if self.gather:
            return self._model(self.grown(names, without, GROWING))
        others = [name for name in self.names if name not in names and name != without]
        given_up: list[str] = []
        while (core := self.core([*names, *others])) is not None:
            more = set(core) - set(names)
            given_up += sorted(more, key=rank)
            others = [name for name in others if name not in more]
        for name in given_up[:TIDYING]:
            if self.core([*names, *others, name]) is None:
                others.append(name)
        return self._model([*names, *others])

    def _model(self, names: Sequence[str]) -> tuple[clingo.Symbol, ...]:
        """Find a map with these reasons in force, and return what holds in it."""
        found: list[tuple[clingo.Symbol, ...]] = []

        def take(model: clingo.Model) -> None:
            """Note what holds in the map."""
            found.append(tuple(model.symbols(atoms=True)))

        settings: Any = self.control.configuration.solve
        settings.solve_limit = "umax,umax"
        self.control.solve(self._assumed(names), on_model=take)
        if not found:
            raise Stopped(INTERRUPT)
        return found[0]


def find_reasons(assumed: Sequence[tuple[clingo.Symbol, bool]], program: Program, put: Put) -> None:
    """Put single reasons that suffice, fewer and fewer; the last ones are all needed.

    With each set it is put that they are not gathered, and not known to be the fewest.
    """
    given = Given(program, assumed)
    best = reduced(given, lambda names: put((False, tuple(names), False)))
    put((False, tuple(best or ()), False))


def reduced(
    given: Given,
    tell: Callable[[Sequence[str]], bool],
    most: int | None = None,
    orders: Sequence[int] = range(REASON_ORDERS),
    limit: int | None = None,
    names: Sequence[str] | None = None,
) -> list[str] | None:
    """Reduce reasons to a minimal unsatisfiable core, trying several orders.

    The result is the smallest core of these orders. Of cores of one size, it is the one with the
    fewest gathered reasons of one step.

    Parameters:
        given: The program of the reasons. With all of them in force there is no map.
        tell: A function that takes the first reasons that suffice, and returns whether to go on.
        most: The largest number of reasons that is wanted. An order is left as soon as it is known
            to need more.
        orders: The numbers of the orders to try.
        limit: The number of conflicts with which a reason is tried. If they are not enough,
            ``verify`` finds out whether the reason is needed.
        names: The reasons to begin with; by default all.

    Returns:
        The reasons; None if each of the orders needs more than are wanted.
    """
    names = given.names if names is None else names
    whole = given.spare(list(names), demands=True, limit=limit)
    best: list[str] | None = None
    for number in orders:
        # The fewest kinds are not always the fewest reasons, so other orders begin with all kinds.
        kept = whole if number else given.spare(whole, demands=False, limit=limit)
        least = given.core(in_order(kept, number))
        if least is None:
            raise RuntimeError("the maps differ between two encodings")
        needed = 0  # a lower bound on the number of reasons
        # Many are tried at a time at first. If they cannot all be removed, one of them is needed.
        for size in sorted({max(1, len(least) // (2 * most if most else 8)), 1}, reverse=True):
            tried = in_order(least, number)[::-1]
            needed = 0
            for start in range(0, len(tried), size):
                if best is None and not tell(sorted(least, key=rank)):
                    raise Stopped(INTERRUPT)
                spared = set(tried[start : start + size]) & set(least)
                if not spared:
                    continue
                try:
                    core = given.core([name for name in least if name not in spared], limit)
                except Unsettled:
                    continue
                least = least if core is None else core
                needed += core is None
                if most is not None and needed > most:
                    break
            if most is not None and needed > most:
                break
        enough = most is None or len(least) <= most
        if enough and (best is None or _burden(least) < _burden(best)):
            best = sorted(least, key=rank)
        spent = given.conflicts > CONFLICTS or given.calls > CALLS
        if spent or (best is not None and len(best) <= 1):
            break
    return best


def _burden(names: Sequence[str]) -> tuple[int, int]:
    """How many reasons there are to read, and how many of these are gathered ones of one step."""
    return len(names), sum(of_one_step(name) for name in names)


def verify(
    assumed: Sequence[tuple[clingo.Symbol, bool]],
    gather: bool,
    names: Sequence[str],
    program: Program,
    put: Put,
) -> None:
    """Verify reason by reason that each is needed, and put what is found.

    For a reason that is needed, a map is put that breaks no other one of them: its dstates, what
    else it breaks, the single reasons of this one that are broken, and all that holds in the map. A
    reason that is not needed is removed.
    """
    given = Given(program, assumed)
    given.name(gather=gather)
    if given.core(names) is None:
        raise RuntimeError("the reasons do not suffice")
    left = list(names)
    for name in in_order(names, 0)[::-1]:
        rest = [other for other in left if other != name]
        if name not in left:
            continue
        if (core := given.core(rest)) is not None:
            left = core
            continue
        symbols = given.broken(rest, name)
        waived = {str(atom.arguments[0]) for atom in symbols if atom.name == "waived"}
        breaks = sorted((one for one in waived if name in given.of[one]), key=rank)
        others = {other for one in waived - {*breaks} for other in given.of[one]} - {*rest}
        if not breaks or waived & {*given.in_force(rest)}:
            raise RuntimeError(f"{name} is not what it is about")
        also = tuple(sorted(others, key=rank))
        if not put((tuple(left), name, dstates(symbols), also, tuple(breaks), symbols)):
            return
    put((tuple(left),))


def rank(name: str) -> tuple[int, tuple[int, ...]]:
    """The sort key of a reason: its kind, then its steps."""
    kind = kind_of(name)  # or it is the text of a whole rule
    first = RULE_NAMES.index(kind) if kind in RULES else [*RULES.values()].index(kind)
    return first, numbers_of(name)


def _span(name: str) -> int:
    """How far apart the steps of a reason are."""
    numbers = numbers_of(name)
    return max(numbers) - min(numbers) if numbers else 0


def in_order(names: Sequence[str], number: int) -> list[str]:
    """The reasons in one of several orders; the last ones are removed first."""
    if number == NEAR:
        return sorted(names, key=lambda name: (_span(name), rank(name)))
    if number <= 1:
        return sorted(names, key=lambda name: (max(numbers_of(name), default=0), rank(name)))
    if number == 2:
        return sorted(names, key=rank)
    mixed = sorted(names)
    random.Random(number).shuffle(mixed)
    return mixed
