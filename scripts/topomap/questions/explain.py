"""``topomap explain``: why a statement is impossible or certain, or why there is no map.

``encodings/explain.lp`` makes each thing that a rule forbids a reason that may be given up. Of
the shortest beginning of the experience in which it is so already, those reasons are sought
without any one of which it would not be so: whole kinds of rules are spared first, then one
reason after the other, in several orders, of which the smallest answer is kept.
"""

import argparse
import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import clingo

from topomap.documents.answers import map_line
from topomap.model.experience import DState, Experience, read
from topomap.model.found import Found, steps_json
from topomap.model.query import Query
from topomap.model.vocabulary import DEMANDS
from topomap.questions import statements
from topomap.questions.reasons import (
    FIRST,
    KINDS,
    RULES,
    Broken,
    Told,
    told_gateway,
    told_marker,
    told_plainly,
    told_views,
)
from topomap.questions.statements import Statement
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Run, Stopped, Watch
from topomap.solver.solving import Program, calls, forget

LATE = {"closed", "travelled"}  # what a map may lack after a step and have after a later one
LASTING = ("same", "at")  # relations of which later steps tell nothing new
ORDERS = 12  # in which reasons are tried, at most
CONFLICTS, CALLS = 3_000, 500  # of the solver, until no further order is tried
MOST_OTHERS, MANY = 4, 8  # that a map breaks besides, as told; reasons, of which a sum is told
TIDYING = 100  # reasons that are tried, so that a map breaks few others
Put = Callable[[Any], bool]
Goal = bool | None  # whether the statement is to hold; None if there is none


@dataclass(frozen=True)
class Reason:
    """A reason, in words; ``at`` is a map that breaks it, and no other one of the answer, and
    ``also`` what that map breaks besides."""

    name: str
    told: Told
    at: tuple[DState, ...] = ()
    also: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        return self.name.partition("(")[0]


@dataclass
class Answer:
    """What is found: the verdict, and the reasons for it in the first ``horizon`` steps; or maps
    in which the statement holds and does not."""

    verdict: str | None = None
    horizon: int | None = None
    reasons: list[Reason] = field(default_factory=list)
    minimal: bool = False
    maps: dict[bool, tuple[DState, ...]] = field(default_factory=dict)


class Explainer:
    """The way to an answer."""

    def __init__(
        self,
        experience: Experience,
        query: Query,
        statement: Statement | None,
        watch: Watch,
        answer: Answer,
    ):
        self.experience, self.query, self.watch, self.answer = experience, query, watch, answer
        self.fact, self.term, self.positive, self.first = "", None, True, 0
        self.lasting = True
        self.seen = bool(statement and statement.note)
        if statement:
            self.fact, self.term = statement.fact, clingo.parse_term(statement.term)
            self.positive = statement.positive
            self.lasting = self.term.name in LASTING
            self.first = max(a.number for a in self.term.arguments[:2]) if self.lasting else 0

    def settle(self) -> None:
        """Find the verdict, then the reasons. Raises Stopped at the time limit, or out of
        memory."""
        answer = self.answer
        self.watch.title("is there a map")
        if self.term is None or self.seen:  # what was seen is no rule that can be spared
            cut = self._beginning(None)
            verdict = "open" if self.term is None else "impossible" if self.positive else "certain"
            self._conclude(verdict if cut is None else "no map", None, cut)
            if self.seen and cut is None:
                answer.minimal = True
                answer.horizon = self.first if self.lasting else self.experience.steps
            return
        cut = self._beginning(True)
        other = self._beginning(None if cut else False)
        if cut and other:
            self._conclude("no map", None, other)
        elif cut:
            self._conclude("impossible", True, cut)
        elif other:
            self._conclude("certain", False, other)
        else:
            answer.verdict = "open"

    def _beginning(self, goal: Goal) -> tuple[int, Query] | None:
        """The shortest beginning that has no map of the kind, and what it is to demand; None if
        even the whole has one, which is then kept. What a beginning cannot have, no longer one
        has, if it is of the lasting kind (a map of the longer one holds a map of the shorter)."""
        last = self.experience.steps
        lasting = replace(self.query, parts=self.query.parts - LATE)
        if goal is None or self.lasting:
            high = 0 if goal is None else self.first  # the statement is about no earlier step
            low, stride = high - 1, 1
            while self._has_map(high, lasting, goal):
                if high == last:
                    break
                low, high, stride = high, min(last, high + stride), 2 * stride
            else:
                while high - low > 1:
                    middle = (low + high) // 2
                    if self._has_map(middle, lasting, goal):
                        low = middle
                    else:
                        high = middle
                return high, lasting
            if lasting == self.query:
                return None
        return None if self._has_map(last, self.query, goal) else (last, self.query)

    def _has_map(self, steps: int, query: Query, goal: Goal) -> bool:
        """Whether there is a map of so many steps, which is kept if it is of all."""
        if goal is not None:
            query = query.having("query")
        experience, facts = self.experience.cut(steps), self.fact * (goal is not None)
        self.watch.phase(f"{steps} steps")
        found: list[tuple[DState, ...]] = []
        work = partial(_one, self._assumed(goal), found)
        for _ in calls(experience, query, facts, self.watch, work):
            pass
        if found and steps == self.experience.steps and query.parts >= self.query.parts:
            self.answer.maps[goal is not False] = found[0]
        return bool(found)

    def _assumed(self, goal: Goal) -> list[tuple[clingo.Symbol, bool]]:
        if goal is None:
            return []
        assert self.term is not None
        return [(clingo.Function("holds", [self.term]), goal == self.positive)]

    def _conclude(self, verdict: str, goal: Goal, cut: tuple[int, Query] | None) -> None:
        self.answer.verdict = verdict
        if cut is None:
            return
        steps, query = cut
        self.answer.horizon = steps
        experience = self.experience.cut(steps)
        parts = ("explain",) if goal is None else ("explain", "query")
        query = replace(query, encoding="plain").having(*parts)
        facts = self.fact * (goal is not None)
        self.watch.title(f"reasons in {steps} steps")
        assumed = self._assumed(goal)
        names: tuple[str, ...] = ()
        work: Callable[[Program, Put], None] = partial(_reasons, assumed)
        for names in calls(experience, query, facts, self.watch, work):
            self.answer.reasons = [Reason(name, _plainly(experience, name)) for name in names]
        forget()  # what the solver has learnt: the answer is verified anew
        self.watch.phase("verified")
        told = []
        work = partial(_verified, assumed, names)
        for name, at, also, symbols in calls(experience, query, facts, self.watch, work):
            told.append(Reason(name, _told(experience, name, at, symbols), at, also))
            self.answer.reasons[len(told) - 1] = told[-1]
        forget()
        if len(told) != len(names):
            raise RuntimeError("the reasons were not verified")
        self.answer.minimal = True


def _one(
    assumed: Sequence[tuple[clingo.Symbol, bool]],
    found: list[tuple[DState, ...]],
    program: Program,
    put: Put,
) -> None:
    """Find a map."""

    def take(model: clingo.Model) -> bool:
        found.append(_dstates(model.symbols(shown=True)))
        return False

    if program.solve((), assumed, on_model=take).satisfiable is None:
        raise Stopped(INTERRUPT)
    put(True)


def _dstates(symbols: Sequence[clingo.Symbol]) -> tuple[DState, ...]:
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
        literals = {name: literals[name] for name in literals if not _doubled(name)}
        self.literals = {name: literals[name] for name in sorted(literals, key=_rank)}
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
            spared = [name for name in names if _kind(name) != kind]
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
            given_up += sorted(more, key=_rank)
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


def _reasons(assumed: Sequence[tuple[clingo.Symbol, bool]], program: Program, put: Put) -> None:
    """Puts reasons that suffice, fewer and fewer; at last some of which none can be spared."""
    given = Given(program, assumed)
    whole = given.spare(list(given.literals), KINDS[FIRST:])
    best: list[str] | None = None
    for number in range(ORDERS):
        # The fewest kinds are not always the fewest reasons: later orders have all kinds.
        kept = whole if number else given.spare(whole, KINDS[:FIRST])
        least = given.core(_order(kept, number))
        if least is None:
            raise RuntimeError("the maps differ between two encodings")
        for size in sorted({max(1, len(least) // 8), 1}, reverse=True):  # first many at a time
            tried = _order(least, number)[::-1]
            for start in range(0, len(tried), size):
                if best is None and not put(tuple(sorted(least, key=_rank))):
                    return
                spared = set(tried[start : start + size]) & set(least)
                core = (
                    given.core([name for name in least if name not in spared]) if spared else None
                )
                least = least if core is None else core
        if best is None or len(least) < len(best):
            best = sorted(least, key=_rank)
        if len(best) <= 1 or given.conflicts > CONFLICTS or given.calls > CALLS:
            break
    put(tuple(best or ()))


def _verified(
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
        waived = {str(atom.arguments[0]) for atom in symbols if atom.name == "waived"}
        broken = {reason for reason in waived if not _doubled(reason)}
        also = tuple(sorted(broken - {name}, key=_rank))
        if name not in broken or set(also) & set(names):
            raise RuntimeError(f"{name} is not what it is about")
        if not put((name, _dstates(symbols), also, symbols)):
            return


def _kind(name: str) -> str:
    return name.partition("(")[0]


def _numbers(name: str) -> tuple[int, ...]:
    inside = name.partition("(")[2].rstrip(")")
    return tuple(map(int, inside.split(","))) if inside else ()


def _doubled(name: str) -> bool:
    """Whether a reason is the same as another one: that two paths cross, told from both."""
    numbers = _numbers(name)
    return _kind(name) == "crossed" and numbers[0] > numbers[1]


def _rank(name: str) -> tuple[int, tuple[int, ...]]:
    """Reasons by kind, and then by their steps."""
    return KINDS.index(_kind(name)), _numbers(name)


def _order(names: Sequence[str], number: int) -> list[str]:
    """The reasons in one of several orders: those that come last are spared first."""
    if number <= 1:
        return sorted(names, key=lambda name: (max(_numbers(name), default=0), _rank(name)))
    if number == 2:
        return sorted(names, key=_rank)
    mixed = sorted(names)
    random.Random(number).shuffle(mixed)
    return mixed


def _told(
    experience: Experience, name: str, at: tuple[DState, ...], symbols: Sequence[clingo.Symbol]
) -> Told:
    """A reason in words, spelled out from a map that breaks it."""
    common = [
        [a.number for a in atom.arguments]
        for atom in symbols
        if atom.name == "common" and len(atom.arguments) == 3
    ]
    euler = [
        atom.arguments[0].number
        for atom in symbols
        if atom.name == "euler" and len(atom.arguments) == 1
    ]
    broken = Broken(experience, at, euler[0] if len(euler) == 1 else None)
    return broken.tell(_kind(name), _numbers(name), common)


def _plainly(experience: Experience, name: str) -> Told:
    """A reason in words, without a map that breaks it."""
    kind, numbers = _kind(name), _numbers(name)
    if kind == "view":
        return told_views(experience, numbers)
    if kind == "marker":
        return told_marker(experience, numbers[0])
    if kind in ("closed", "travelled"):
        return told_gateway(kind, *numbers)
    return told_plainly(kind, numbers)


def explain(args: argparse.Namespace) -> int:
    """Settle why a statement is so, and write what was found."""
    experience = read(args.instance).cut(LARGEST if args.horizon is None else args.horizon)
    statement = None
    if args.statement is not None:
        statement = statements.parse(args.statement, experience, args.command)
    query = Query(frozenset(part for part in DEMANDS if getattr(args, part)), args.bound)
    answer = Answer()
    with output(args.output) as out:
        with Run(args.timeout) as run:
            Explainer(experience, query, statement, run.watch, answer).settle()
        if args.json:
            out.write(_json(args, experience, statement, answer, run.fault))
        else:
            out.writelines(f"{line}\n" for line in _lines(experience, statement, answer, run.fault))
    return run.status(answer.verdict != "open")


VERDICTS = {
    "impossible": "impossible",
    "certain": "certain",
    "open": "so in some maps, and not in others",
    "no map": "no map is consistent with the experience",
}


def _lines(
    experience: Experience, statement: Statement | None, answer: Answer, fault: str | None
) -> Iterator[str]:
    """The answer to read."""
    head = f"{statement.text}: " if statement else ""
    if answer.verdict is None:
        yield f"{head}not settled"
    elif answer.verdict == "open":
        yield f"{head}{VERDICTS['open']}" if statement else "there are maps"
        for holds, at in sorted(answer.maps.items(), reverse=True):
            does = "" if not statement else f" in which it {'holds' if holds else 'does not'}"
            yield f"  a map{does}: {map_line(experience, Found(at, 'consistent'))}"
    else:
        yield f"{head}{VERDICTS[answer.verdict]}" + _where(experience, answer)
        if statement and statement.note and answer.verdict != "no map":
            yield f"  {statement.note}"
        for reason in answer.reasons:
            yield f"  {reason.name}: {RULES[reason.kind]}: {reason.told.words}"
            if reason.at:
                line = " ".join(f"{place}.{slot}" for place, slot in reason.at)
                others = " ".join(reason.also[:MOST_OTHERS])
                more = len(reason.also) - MOST_OTHERS
                others += f" and {more} more" if more > 0 else ""
                also = f" (which breaks {others}, too)" if others else ""
                yield f"    without it: {line}{also}"
        yield _sum(answer)
    if fault:
        yield f"partial: {fault}"


def _where(experience: Experience, answer: Answer) -> str:
    if answer.horizon in (None, experience.steps):
        return ""
    return f", already after step {answer.horizon}"


def _sum(answer: Answer) -> str:
    number = len(answer.reasons)
    if not answer.minimal:
        enough = f"{number} reason{'s' * (number != 1)}: enough, but some may be spared"
        return enough if number else "the reasons are not found yet"
    if not number:
        return "it is so whatever the map: no rule is needed"
    if number == 1:
        return "this one reason is enough"
    kinds = Counter(RULES[reason.kind] for reason in answer.reasons)
    told = ", ".join(f"{times} of {kind}" for kind, times in kinds.most_common())
    which = f" ({told})" if number > MANY else ""
    return f"these {number} reasons{which} are enough, and without any one of them it is not so"


def _json(
    args: argparse.Namespace,
    experience: Experience,
    statement: Statement | None,
    answer: Answer,
    fault: str | None,
) -> str:
    verdict = answer.verdict
    if verdict == "open" and not statement:
        verdict = "map"
    reasons = [
        {
            "reason": reason.name,
            "rule": RULES[reason.kind],
            "words": reason.told.words,
            "steps": reason.told.steps,
            "walk": reason.told.walk,
            "places": reason.told.places,
            "without": steps_json(reason.at),
            "also": reason.also,
        }
        for reason in answer.reasons
    ]
    maps = answer.maps if verdict in ("open", "map") else {}
    return formats.line(
        {
            "instance": args.instance,
            "statement": statement and statement.text,
            "note": statement and statement.note,
            "demands": [part for part in DEMANDS if getattr(args, part)],
            "bound": args.bound,
            "verdict": verdict,
            "horizon": answer.horizon,
            "reasons": reasons,
            "minimal": answer.minimal or None,
            "witness": steps_json(maps.get(True, ())),
            "counter": steps_json(maps.get(False, ())),
        },
        fault,
    )
