"""Reasons none of which can be spared: the unsatisfiable cores that clingo gives, made small,
and verified by a map that breaks each."""

import random
import re
from collections.abc import Sequence
from typing import Any

import clingo

from topomap.model.experience import DState
from topomap.questions.reasons import FIRST, RULE_NAMES
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped
from topomap.solver.programs import Program
from topomap.solver.threads import Put

REASON_ORDERS = 12  # in which reasons are tried, at most
CONFLICTS, CALLS = 3_000, 500  # of the solver, until no further order is tried
TIDYING = 100  # reasons that are tried, so that a map breaks few others


def dstates(symbols: Sequence[clingo.Symbol]) -> tuple[DState, ...]:
    steps = sorted([a.number for a in atom.arguments] for atom in symbols if atom.name == "at")
    return tuple((place, slot) for _, place, slot in steps)


class Given:
    """A program in which reasons may be given up, solved with some of them in force."""

    def __init__(self, program: Program, assumed: Sequence[tuple[clingo.Symbol, bool]]):
        self.control, self.assumed = program.control, list(assumed)
        settings: Any = self.control.configuration.solve
        settings.models, settings.opt_mode = 1, "ignore"
        program.solve(())  # it grounds
        atoms = self.control.symbolic_atoms.by_signature("waived", 1)
        literals = {str(atom.symbol.arguments[0]): -atom.literal for atom in atoms}
        self.literals = {name: literals[name] for name in sorted(literals, key=rank)}
        self.conflicts = self.calls = 0

    def core(self, names: Sequence[str]) -> list[str] | None:
        """None if there is a map with these in force, else some of them with which there is
        none."""
        used: list[int] = []
        result = self.control.solve(self._assumed(names), on_core=used.extend)
        if result.satisfiable is None:
            raise Stopped(INTERRUPT)
        self.calls += 1
        self.conflicts += int(self.control.statistics["solving"]["solvers"]["conflicts"])
        if result.satisfiable:
            return None
        return [name for name in names if self.literals[name] in set(used)]

    def _assumed(self, names: Sequence[str]) -> list[tuple[clingo.Symbol, bool] | int]:
        return [*self.assumed, *(self.literals[name] for name in names)]

    def spare(self, names: list[str], kinds: Sequence[str]) -> list[str]:
        """The reasons but for kinds that can be spared, the last ones first."""
        for kind in reversed(kinds):
            spared = [name for name in names if kind_of(name) != kind]
            if len(spared) < len(names) and self.core(spared) is not None:
                names = spared
        return names

    def broken(self, names: Sequence[str], without: str) -> tuple[clingo.Symbol, ...] | None:
        """What is so in a map with these in force and another one not, and few of all others
        given up; None if there is no such map."""
        others = [name for name in self.literals if name not in names and name != without]
        given_up: list[str] = []
        while (core := self.core([*names, *others])) is not None:
            more = set(core) - set(names)
            if not more:
                return None
            given_up += sorted(more, key=rank)
            others = [name for name in others if name not in more]
        for name in given_up[:TIDYING]:
            if self.core([*names, *others, name]) is None:
                others.append(name)
        found: list[tuple[clingo.Symbol, ...]] = []

        def take(model: clingo.Model) -> None:
            found.append(tuple(model.symbols(atoms=True)))

        self.control.solve(self._assumed([*names, *others]), on_model=take)
        if not found:
            raise Stopped(INTERRUPT)
        return found[0]


def find_reasons(assumed: Sequence[tuple[clingo.Symbol, bool]], program: Program, put: Put) -> None:
    """Puts reasons that suffice, fewer and fewer; at last some of which none can be spared."""
    given = Given(program, assumed)
    whole = given.spare(list(given.literals), RULE_NAMES[FIRST:])
    best: list[str] | None = None
    for number in range(REASON_ORDERS):
        # The fewest kinds are not always the fewest reasons: later orders have all kinds.
        kept = whole if number else given.spare(whole, RULE_NAMES[:FIRST])
        least = given.core(in_order(kept, number))
        if least is None:
            raise RuntimeError("the maps differ between two encodings")
        for size in sorted({max(1, len(least) // 8), 1}, reverse=True):  # first many at a time
            tried = in_order(least, number)[::-1]
            for start in range(0, len(tried), size):
                if best is None and not put(tuple(sorted(least, key=rank))):
                    return
                spared = set(tried[start : start + size]) & set(least)
                core = (
                    given.core([name for name in least if name not in spared]) if spared else None
                )
                least = least if core is None else core
        if best is None or len(least) < len(best):
            best = sorted(least, key=rank)
        if len(best) <= 1 or given.conflicts > CONFLICTS or given.calls > CALLS:
            break
    put(tuple(best or ()))


def verify(
    assumed: Sequence[tuple[clingo.Symbol, bool]],
    names: Sequence[str],
    program: Program,
    put: Put,
) -> None:
    """Puts each reason with what is so in a map that breaks it, and no other one of them."""
    given = Given(program, assumed)
    if given.core(names) is None:
        raise RuntimeError("the reasons do not suffice")
    for name in names:
        symbols = given.broken([other for other in names if other != name], name)
        if symbols is None:
            raise RuntimeError(f"{name} is no reason")
        broken = {str(atom.arguments[0]) for atom in symbols if atom.name == "waived"}
        also = tuple(sorted(broken - {name}, key=rank))
        if name not in broken or set(also) & set(names):
            raise RuntimeError(f"{name} is not what it is about")
        if not put((name, dstates(symbols), also, symbols)):
            return


def kind_of(name: str) -> str:
    return name.partition("(")[0]


def numbers_of(name: str) -> tuple[int, ...]:
    return tuple(map(int, re.findall(r"\d+", name)))


def rank(name: str) -> tuple[int, tuple[int, ...]]:
    """Reasons by kind, and then by their steps."""
    return RULE_NAMES.index(kind_of(name)), numbers_of(name)


def in_order(names: Sequence[str], number: int) -> list[str]:
    """The reasons in one of several orders: those that come last are spared first."""
    if number <= 1:
        return sorted(names, key=lambda name: (max(numbers_of(name), default=0), rank(name)))
    if number == 2:
        return sorted(names, key=rank)
    mixed = sorted(names)
    random.Random(number).shuffle(mixed)
    return mixed
