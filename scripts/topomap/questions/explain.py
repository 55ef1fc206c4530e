"""Why a statement is impossible or certain, or why there is no map.

``encodings/explain.lp`` makes a reason, which may be given up, of each thing that a rule forbids.
First the shortest beginning of the experience for which the verdict already holds is found. Then a
minimal unsatisfiable core of reasons is sought for it: whole kinds of rules are removed first, then
one reason after the other, in several orders, and the smallest core is kept. If there is no map at
all, and more than a few reasons would be needed, they are gathered (``cores``): each is a whole
rule, or all that was seen after one step. If no map is closed and a default stands in the way
(``defaults.in_the_way``), that is said instead of reasons.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import clingo

from topomap.documents.answers import map_line
from topomap.model import words
from topomap.model.experience import DState, Experience
from topomap.model.found import Found, steps_json
from topomap.model.query import Query
from topomap.model.vocabulary import DEMANDS, RELAXING
from topomap.questions.cores import dstates, find_reasons, verify
from topomap.questions.few import find_few
from topomap.questions.reasons import (
    KNOWN,
    RULES,
    Broken,
    Told,
    is_gathered,
    kind_of,
    numbers_of,
    told_assumed,
    told_gateway,
    told_gathered,
    told_known,
    told_marker,
    told_plainly,
    told_views,
)
from topomap.questions.statements import Statement
from topomap.runtime.status import INTERRUPT
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import defaults
from topomap.solver.programs import Program, calls, forget
from topomap.solver.threads import Put

# So many other reasons that a map breaks are listed; more reasons than MANY are summed up.
MOST_OTHERS, MANY = 4, 8
VERDICTS = {
    "impossible": "impossible",
    "certain": "certain",
    "open": "so in some maps, and not in others",
    "no map": "no map is consistent with the experience",
}
NOTHING = "there are maps, so there is nothing to explain"
LATE = {"closed", "travelled"}  # demands that a map may meet only after a later step
LASTING = ("same", "at")  # relations about which later steps tell nothing new
AS_MANY = "if all visits of a place see equally many gateways"
Goal = bool | None  # whether the statement is to hold; None if there is none


@dataclass(frozen=True)
class Reason:
    """A reason, in words.

    ``at`` is a map that breaks this reason and no other one of the answer, and ``also`` says what
    else that map breaks. If the reason is gathered from single ones, ``breaks`` has those that the
    map breaks, and ``then`` the first of them in words.
    """

    name: str
    told: Told
    at: tuple[DState, ...] = ()
    also: tuple[str, ...] = ()
    breaks: tuple[str, ...] = ()
    then: Told | None = None

    @property
    def kind(self) -> str:
        """The name of the reason without its steps."""
        return kind_of(self.name)

    @property
    def rule(self) -> str:
        """The rule behind the reason, in words."""
        return RULES.get(self.kind, self.kind)

    def lines(self) -> Iterator[str]:
        """The reason as lines to read, and a map without it."""
        name = "" if self.name == self.rule else f"{self.name}: "
        yield f"  {name}{self.rule}: {self.told.words}"
        if self.at:
            line = " ".join(f"{place}.{slot}" for place, slot in self.at)
            others = " ".join(self.also[:MOST_OTHERS])
            more = len(self.also) - MOST_OTHERS
            others += f" and {more} more" if more > 0 else ""
            also = f" (which breaks {others}, too)" if others else ""
            yield f"    without it: {line}{also}"
        if self.then:
            more = len(self.breaks) - 1
            yield f"    {self.then.words}" + f", and {more} more of this kind" * bool(more)

    def document(self) -> dict[str, Any]:
        """The reason as JSON."""
        return {
            "reason": self.name,
            "rule": self.rule,
            "words": self.told.words,
            "steps": self.told.steps,
            "walk": self.told.walk,
            "places": self.told.places,
            "without": steps_json(self.at),
            "also": self.also,
            "breaks": self.breaks,
            "then": self.then and self.then.words,
        }


@dataclass
class Explanation:
    """What was found.

    It has the verdict; the reasons for it in the first ``horizon`` steps, or what is ``in_the_way``
    of a closed map; or maps in which the statement holds and does not hold. ``gathered`` tells
    whether reasons are whole rules, or all that is known of one step; ``fewest`` tells whether it
    is proved that no fewer of these suffice. ``verified`` tells whether it was checked that the
    reasons suffice, and that each of them is needed; ``as_many``, whether this is proved only for
    maps in which all visits of a place see equally many gateways.
    """

    verdict: str | None = None
    horizon: int | None = None
    reasons: list[Reason] = field(default_factory=list)
    verified: bool = False
    gathered: bool = False
    fewest: bool = False
    as_many: bool = False
    in_the_way: list[str] = field(default_factory=list)
    maps: dict[bool, tuple[DState, ...]] = field(default_factory=dict)

    @property
    def minimal(self) -> bool:
        """Whether it is verified that the reasons suffice, whatever the map, and are all needed."""
        return self.verified and not self.as_many

    def lines(
        self, experience: Experience, statement: Statement | None, fault: str | None
    ) -> Iterator[str]:
        """What was found about a statement, as lines; ``fault`` says why not everything was."""
        head = f"{statement.text}: " if statement else ""
        if self.verdict is None:
            yield f"{head}not settled"
        elif self.verdict == "open":
            yield f"{head}{VERDICTS['open']}" if statement else NOTHING
            for holds, at in sorted(self.maps.items(), reverse=True):
                does = "" if not statement else f" in which it {'holds' if holds else 'does not'}"
                yield f"  a map{does}: {map_line(experience, Found(at, 'consistent'))}"
        else:
            if self.in_the_way:
                yield defaults.told(self.in_the_way)
            yield f"{head}{VERDICTS[self.verdict]}" + self._where(experience)
            if statement and statement.note and self.verdict != "no map":
                yield f"  {statement.note}"
            for reason in self.reasons:
                yield from reason.lines()
            if not self.in_the_way:
                yield self._sum()
        if fault:
            yield f"partial: {fault}"

    def _where(self, experience: Experience) -> str:
        if self.horizon in (None, experience.steps):
            return ""
        return f", already after step {self.horizon}"

    def _sum(self) -> str:
        many = len(self.reasons)
        if not many:
            condition = f", {AS_MANY}" * self.as_many
            so = f"it is so whatever the map{condition}: no rule is needed"
            return so if self.verified else "the reasons are not found yet"
        if not self.minimal:
            condition = f" {AS_MANY}" if self.as_many else ""
            which = "some" if many > 1 else "it"
            return (
                f"{many} {words.plural(many, 'reason')}: enough{condition}, "
                f"but {which} may not be needed"
            )
        if many == 1:
            return "this one reason is enough"
        kinds = Counter(reason.rule for reason in self.reasons)
        told = ", ".join(f"{times} of {kind}" for kind, times in kinds.most_common())
        which = f" ({told})" if many > MANY and not self.gathered else ""
        fewest = "; fewer of this sort would not be enough" * self.fewest
        enough = f"these {many} reasons{which} are enough, and without any one of them it is not so"
        return enough + fewest

    def document(self, statement: Statement | None, query: Query) -> dict[str, Any]:
        """What was found, as JSON."""
        verdict = self.verdict
        if verdict == "open" and not statement:
            verdict = "map"
        maps = self.maps if verdict in ("open", "map") else {}
        return {
            "statement": statement and statement.text,
            "note": statement and statement.note,
            "demands": [part for part in (*DEMANDS, *RELAXING) if part in query.parts],
            "bound": query.places,
            "verdict": verdict,
            "horizon": self.horizon,
            "reasons": [reason.document() for reason in self.reasons],
            "minimal": self.minimal or None,
            "gathered": self.gathered,
            "fewest": self.fewest or None,
            "in_the_way": self.in_the_way,
            "witness": steps_json(maps.get(True, ())),
            "counter": steps_json(maps.get(False, ())),
        }


class Explainer:
    """The search for an explanation."""

    def __init__(
        self,
        experience: Experience,
        query: Query,
        statement: Statement | None,
        watch: Watch,
        found: Explanation,
    ):
        self.experience, self.query, self.watch, self.found = experience, query, watch, found
        self.fact, self.term, self.positive, self.first = "", None, True, 0
        self.lasting = True
        self.seen = bool(statement and statement.note)
        if statement:
            self.fact, self.term = statement.fact, clingo.parse_term(statement.term)
            self.positive = statement.positive
            self.lasting = self.term.name in LASTING
            self.first = max(a.number for a in self.term.arguments[:2]) if self.lasting else 0

    def settle(self) -> None:
        """Find the verdict, then the reasons.

        Raises:
            Stopped: The time limit has passed, or memory ran out.
        """
        answer = self.found
        self.watch.title("is there a map")
        if self.term is None or self.seen:  # what was seen is not a rule that can be removed
            cut = self._beginning(None)
            if cut and "closed" in cut[1].parts:
                answer.verdict, answer.horizon = "no map", cut[0]
                answer.in_the_way = defaults.in_the_way(self.experience, self.query, self.watch)
                if answer.in_the_way:
                    return
            verdict = "open" if self.term is None else "impossible" if self.positive else "certain"
            self._conclude(verdict if cut is None else "no map", None, cut)
            if self.seen and cut is None:
                answer.verified = True
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
        """Find the shortest beginning that has no map of the kind, and what it must demand.

        It is None if even the whole has such a map, which is then kept. If a beginning has no map
        of a lasting kind, then no longer beginning has one, because the map of the longer one
        contains a map of the shorter one.
        """
        last = self.experience.steps
        # Assumptions are about the whole, and say nothing about a beginning.
        if self.experience.assumed:
            return None if self._has_map(last, self.query, goal) else (last, self.query)
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
        """Tell whether there is a map of so many steps; if they are all, it is kept."""
        if goal is not None:
            query = query.having("query")
        experience, facts = self.experience.cut(steps), self.fact * (goal is not None)
        self.watch.phase(f"{steps} steps")
        found: list[tuple[DState, ...]] = []
        work = partial(_one, self._assumed(goal), found)
        for _ in calls(experience, query, facts, self.watch, work):
            pass
        if found and steps == self.experience.steps and query.parts >= self.query.parts:
            self.found.maps[goal is not False] = found[0]
        return bool(found)

    def _assumed(self, goal: Goal) -> list[tuple[clingo.Symbol, bool]]:
        if goal is None:
            return []
        assert self.term is not None
        return [(clingo.Function("holds", [self.term]), goal == self.positive)]

    def _conclude(self, verdict: str, goal: Goal, cut: tuple[int, Query] | None) -> None:
        self.found.verdict = verdict
        if cut is None:
            return
        steps, query = cut
        self.found.horizon = steps
        experience = self.experience.cut(steps)
        # Where bearings are not exact, and a view is given up that has another number of gateways
        # than the place, it is not defined which gateway is which.
        inexact = experience.tolerance > 0
        self.found.as_many = inexact and len({*map(len, experience.views)}) > 1
        parts = ("explain",) if goal is None else ("explain", "query")
        query = query.having(*parts)
        facts = self.fact * (goal is not None)
        self.watch.title(f"reasons in {steps} steps")
        assumed = self._assumed(goal)
        names: tuple[str, ...] = ()
        work: Callable[[Program, Put], None]
        work = find_few if goal is None else partial(find_reasons, assumed)
        for told in calls(experience, query, facts, self.watch, work):
            if told:
                self.found.gathered, names, self.found.fewest = told
                self.found.reasons = [self._reason(experience, name) for name in names]
        forget()  # the answer is verified without what the solver has learnt
        self.watch.phase("verified")
        reasons = {reason.name: reason for reason in self.found.reasons}
        work = partial(verify, assumed, self.found.gathered, names)
        for left, *told in calls(experience, query, facts, self.watch, work):
            if told:
                reasons[told[0]] = self._reason(experience, *told)
            self.found.reasons = [reasons[name] for name in names if name in left]
        forget()
        if not all(reason.at for reason in self.found.reasons):
            raise RuntimeError("the reasons were not verified")
        self.found.verified = True

    def _reason(
        self,
        experience: Experience,
        name: str,
        at: tuple[DState, ...] = (),
        also: tuple[str, ...] = (),
        breaks: tuple[str, ...] = (),
        symbols: Sequence[clingo.Symbol] = (),
    ) -> Reason:
        """Put a reason into words, and describe a map that breaks it, if such a map is given."""
        if not self.found.gathered or not is_gathered(name):
            told = _told(experience, name, at, symbols) if at else _plainly(experience, name)
            return Reason(name, told, at, also)
        then = _told(experience, breaks[0], at, symbols) if breaks else None
        told = told_gathered(experience, name, self.query.places)
        return Reason(name, told, at, also, breaks, then)


def _one(
    assumed: Sequence[tuple[clingo.Symbol, bool]],
    found: list[tuple[DState, ...]],
    program: Program,
    put: Put,
) -> None:
    """Find a map."""

    def take(model: clingo.Model) -> bool:
        """Put the map."""
        found.append(dstates(model.symbols(shown=True)))
        return False

    if program.solve((), assumed, on_model=take).satisfiable is None:
        raise Stopped(INTERRUPT)
    put(True)


def _told(
    experience: Experience, name: str, at: tuple[DState, ...], symbols: Sequence[clingo.Symbol]
) -> Told:
    """Put a reason into words, described from a map that breaks it."""
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
    return broken.tell(kind_of(name), numbers_of(name), common)


def _plainly(experience: Experience, name: str) -> Told:
    """Put a reason into words without a map that breaks it."""
    kind, numbers = kind_of(name), numbers_of(name)
    if kind == "view":
        return told_views(experience, numbers)
    if kind == "marker":
        return told_marker(experience, numbers[0])
    if kind in KNOWN:
        return told_known(experience, kind, numbers)
    if kind == "assumed":
        return told_assumed(experience, numbers[0])
    if kind in ("closed", "travelled"):
        return told_gateway(kind, *numbers)
    return told_plainly(kind, numbers)
