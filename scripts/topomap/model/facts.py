"""The facts of instance files: they are made into experiences, and their faults are found.

An instance file is data: ground facts ``slots/1``, ``view/2``, ``turn/2``, ``landmark/2``,
``start/1``, ``look/1``, ``drop/1``, ``pick/1``, ``marker/1`` (these three also with the name of a
marker), ``compass/2``, ``shift/3``, ``length/2``, ``straight/3``, ``same/2`` and ``apart/2`` (see
``encodings/topomap.lp``), and comments. Anything else is refused.
"""

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import clingo

from topomap.model.experience import (
    MARKER,
    MOST_SLOTS,
    Experience,
    Shift,
    Thing,
    marker_fault,
    marker_out,
)
from topomap.model.terms import STRING, cut_short, ground, quoted
from topomap.runtime import files
from topomap.runtime.errors import InputError
from topomap.runtime.limits import DRIFT, LARGEST, STRETCH
from topomap.runtime.near import nearest

SIGNATURES = {  # the facts of an instance
    "slots": "slots(K)",
    "view": "view(T,S)",
    "turn": "turn(T,S)",
    "landmark": "landmark(T,L)",
    **{name: f"{name}(T)" for name in MARKER},
    "compass": "compass(T,S)",
    "shift": "shift(T,X,Y)",
    "length": "length(T,D)",
    "straight": "straight(T,S,R)",
    "same": "same(T,U)",
    "apart": "apart(T,U)",
    "start": "start(T)",
    "look": "look(T)",
}
FORMS = {name: form.count(",") + 1 for name, form in SIGNATURES.items()}
WHOLE = {  # messages; in the other facts, steps are the whole numbers
    "slots": "K is a whole number",
    **dict.fromkeys(("view", "turn", "compass"), "a step and a slot are whole numbers"),
    "straight": "a step and two slots are whole numbers",
    "shift": "a step, and how far it moved, are whole numbers",
    "length": "a step and its length are whole numbers",
}
NAMED = {name: f"{name}(T,M)" for name in MARKER}  # the forms for markers that have names
RESTS = ("start", "look")  # the kinds of steps that are not a travel
PAIRS = ("same", "apart")
HINT = " (misread? solve --noise allows for that)"


def read(
    path: str | Path,
    noisy: bool = False,
    drift: int | None = None,
    stretch: int | None = None,
    tolerance: int | None = None,
) -> Experience:
    """Read the experience in an instance file.

    A ``noisy`` one may turn to gateways that were not seen, and its views may lack slot 0. Shifts
    and lengths may be wrong by ``drift`` and ``stretch`` percent, and bearings by ``tolerance``
    slots.

    Raises:
        InputError: The file cannot be read, or has a fault. The message is one line, about the
            first fault that ``Facts.faults`` finds.
    """
    return parse(files.read_text(path), str(path), noisy, drift, stretch, tolerance)


def parse(
    text: str,
    source: str,
    noisy: bool = False,
    drift: int | None = None,
    stretch: int | None = None,
    tolerance: int | None = None,
) -> Experience:
    """Make the experience of the text of an instance, which ``source`` names in errors."""
    facts = Facts(
        drift=DRIFT if drift is None else drift, stretch=STRETCH if stretch is None else stretch
    )
    for fault in facts.faults(text, noisy):
        raise InputError(fault.of(source))
    seen = facts.experience()
    if tolerance and noisy:
        raise InputError(
            f"{source}: where views may be misread, bearings must be exact: no tolerance"
        )
    return seen.within(tolerance=tolerance)


@dataclass(frozen=True)
class Fault:
    """What is wrong with an instance.

    It has the fault in words (``said``), the ``line`` that shows it (counted from 1; None if no
    line does), and the ``step``, if it is of one. A fault that ``lacks`` something may disappear
    when a fact that could not be read is corrected.
    """

    said: str
    line: int | None = None
    step: int | None = None
    lacks: bool = False

    def of(self, source: str) -> str:
        """Tell the fault in one line: file, line, step and what is wrong."""
        line = "" if self.line is None else f":{self.line}"
        step = "" if self.step is None else f" step {self.step}:"
        return f"{source}{line}:{step} {self.said}"


@dataclass
class Facts:
    """The facts of an instance, each with the line in which it stands first.

    ``views[t]``, ``turns[t]`` and ``landmarks[t]`` have what is given for step t, ``marks`` the
    steps of each name of MARKER, and ``steps`` each step about which anything is given.
    ``known[name][t]`` has the numbers that are given by compass/2, shift/3, length/2 or straight/3,
    ``pairs[name]`` the pairs of same/2 or apart/2, ``rests[name]`` the steps of start/1 or look/1,
    and ``things`` what is done with markers that have names. ``unread`` is the number of statements
    that are not facts of an instance. ``drift`` and ``stretch`` are the percents by which shifts
    and lengths may be wrong: multiplied by them, what is given must still be a number that clingo
    can hold.
    """

    slots: dict[int, int] = field(default_factory=dict)
    views: dict[int, dict[int, int]] = field(default_factory=dict)
    turns: dict[int, dict[int, int]] = field(default_factory=dict)
    landmarks: dict[int, dict[str, int]] = field(default_factory=dict)
    marks: dict[str, dict[int, int]] = field(default_factory=lambda: {name: {} for name in MARKER})
    known: dict[str, dict[int, dict[tuple[int, ...], int]]] = field(
        default_factory=lambda: {name: {} for name in ("compass", "shift", "length", "straight")}
    )
    pairs: dict[str, dict[tuple[int, int], int]] = field(
        default_factory=lambda: {name: {} for name in PAIRS}
    )
    rests: dict[str, dict[int, int]] = field(default_factory=lambda: {name: {} for name in RESTS})
    things: dict[Thing, int] = field(default_factory=dict)
    steps: dict[int, int] = field(default_factory=dict)
    unread: int = 0
    drift: int = DRIFT
    stretch: int = STRETCH

    def faults(self, text: str, noisy: bool = False) -> Iterator[Fault]:
        """Read a text, and find all that is wrong with it.

        First come the statements that are not facts, then what is wrong with the facts together.
        What may be missing only because it stands in such a statement is not reported.
        """
        yield from self._read(text)
        yield from (fault for fault in self._checked(noisy) if not (fault.lacks and self.unread))

    def _read(self, text: str) -> Iterator[Fault]:
        if text.lstrip()[:1] in ("{", "["):
            self.unread += 1
            line = 1 + text[: -len(text.lstrip())].count("\n")
            yield Fault("the facts of an instance are wanted, not JSON or a rule", line)
            return
        for line, statement, ends in statements(text):
            # Most facts have only small numbers, and need not be read by clingo.
            if ends and (plain := _NUMBERS.fullmatch(statement)):
                name, numbers = plain[1], [*map(int, plain[2].split(","))]
                if len(numbers) == FORMS.get(name) and name != "landmark":
                    self._add(line, name, numbers)
                    continue
            fact = _fact(statement, ends)
            if said := fact if isinstance(fact, str) else misfit(fact):
                self.unread += 1
                yield Fault(said, line)
            elif isinstance(fact, clingo.Symbol):
                number = clingo.SymbolType.Number
                terms = [one.number if one.type == number else str(one) for one in fact.arguments]
                self._add(line, fact.name, terms)

    def _add(self, line: int, name: str, arguments: Sequence[Any]) -> None:
        """Add a fact that has one of the forms.

        Its arguments are numbers, or the texts of other terms.
        """
        first = arguments[0]
        if name == "slots":
            self.slots.setdefault(first, line)
            return
        self.steps.setdefault(first, line)
        if name in MARKER and len(arguments) == 2:
            self.things.setdefault((name, first, str(arguments[1])), line)
        elif name in MARKER:
            self.marks[name].setdefault(first, line)
        elif name in RESTS:
            self.rests[name].setdefault(first, line)
        elif name in PAIRS:
            other = arguments[1]
            self.steps.setdefault(other, line)
            self.pairs[name].setdefault((first, other), line)
        elif name in self.known:
            numbers = tuple(arguments[1:])
            self.known[name].setdefault(first, {}).setdefault(numbers, line)
        elif name == "landmark":
            self.landmarks.setdefault(first, {}).setdefault(str(arguments[1]), line)
        else:
            told = self.views if name == "view" else self.turns
            told.setdefault(first, {}).setdefault(arguments[1], line)

    def _checked(self, noisy: bool) -> Iterator[Fault]:
        """Find what is wrong with the facts together: first with slots(K), then step by step."""
        if not self.slots and not self.views and not self.turns:
            yield Fault("there are no facts in it", lacks=True)
            return
        slots = None
        if len(self.slots) != 1:
            second = [*self.slots.values(), None][1] if self.slots else None
            many = len(self.slots) or "no"
            yield Fault(f"{many} facts slots(K); there must be one", second, lacks=not self.slots)
        for number, line in self.slots.items():
            if fault := slots_fault(number):
                yield Fault(fault, line)
            elif len(self.slots) == 1:
                slots = number
        told = {*self.turns, *(step for steps in self.rests.values() for step in steps)}
        last = max([0, *told])
        later = sorted({0, *(step for step in told if step > 0)})
        gaps = {step + 1: after for step, after in itertools.pairwise(later)}
        names = {None, *(name for _, _, name in self.things)}
        out = dict.fromkeys(names, False)  # whether each marker lies somewhere
        whole = True  # whether ``out`` is known
        for step in sorted({0, *self.steps, *(gap for gap in gaps if gap not in told)}):
            if step < 0:
                yield Fault("steps are numbered from 0", self.steps[step], step)
                continue
            turned = step == 0 or step in told
            if step > last:
                said = f"it has no turn (the last one is {last})"
                yield Fault(said, self.steps[step], step, lacks=True)
            elif not turned:
                line = self.steps.get(step) or self.steps[gaps[step]]
                yield Fault("no turn, but there are later steps", line, step, lacks=True)
            whole = whole and turned
            yield from self._turn_faults(step, slots, noisy)
            yield from self._view_faults(step, slots, noisy, turned)
            yield from self._known_faults(step, slots)
            yield from self._pair_faults(step, slots, noisy)
            for name in sorted(names, key=str) if whole else ():
                marks = self._marks(name, step)
                if marks and (fault := marker_fault(marks, out[name], name)):
                    yield Fault(fault, min(marks.values()), step, lacks=True)
                out[name] = marker_out(marks, out[name])
        yield from self._far()

    def _marks(self, name: str | None, step: int) -> dict[str, int]:
        """List what is done with a marker after a step, each with its line."""
        if name is None:
            return {kind: self.marks[kind][step] for kind in MARKER if step in self.marks[kind]}
        told = {kind: self.things.get((kind, step, name)) for kind in MARKER}
        return {kind: line for kind, line in told.items() if line is not None}

    def _turn_faults(self, step: int, slots: int | None, noisy: bool) -> Iterator[Fault]:
        turns = self.turns.get(step, {})
        rests = {name: self.rests[name][step] for name in RESTS if step in self.rests[name]}
        if rests and step == 0:
            for name, line in rests.items():
                said = "it is already the start" if name == "start" else "there is no earlier look"
                yield Fault(said, line, step)
        elif rests and turns:
            said = "it has a turn, but begins a log" if "start" in rests else "a look has no turn"
            yield Fault(said, min(rests.values()), step)
        elif len(rests) > 1:
            yield Fault("it begins a log, and is a second look", max(rests.values()), step)
        if turns and step == 0:
            line = min(turns.values())
            yield Fault("there is a turn, but step 1 is the first with a turn", line, step)
        elif len(turns) > 1:
            yield Fault("more than one turn", sorted(turns.values())[1], step)
        for turn, line in turns.items():
            if slots is not None and not 0 <= turn < slots:
                yield Fault(f"slot {turn} is not in 0..{slots - 1}", line, step)
            elif step and not noisy and step - 1 in self.views and turn not in self.views[step - 1]:
                said = f"turn {turn}: no gateway there after step {step - 1}{HINT}"
                yield Fault(said, line, step, lacks=True)

    def _view_faults(
        self, step: int, slots: int | None, noisy: bool, turned: bool
    ) -> Iterator[Fault]:
        view = self.views.get(step, {})
        for slot, line in view.items():
            if slots is not None and not 0 <= slot < slots:
                yield Fault(f"slot {slot} is not in 0..{slots - 1}", line, step)
        if noisy:
            return
        if not view and turned:
            yield Fault(f"no view{HINT}", self.steps.get(step), step, lacks=True)
        elif view and 0 not in view:
            said = f"the view lacks slot 0, the gateway where the agent stands{HINT}"
            yield Fault(said, min(view.values()), step, lacks=True)

    def _known_faults(self, step: int, slots: int | None) -> Iterator[Fault]:
        for name, what in (("compass", "compass"), ("shift", "shift"), ("length", "length")):
            told = self.known[name].get(step, {})
            if told and step == 0 and name != "compass":
                said = f"there is a {what}, but step 1 is the first that moves"
                yield Fault(said, min(told.values()), step)
            rests = any(step in self.rests[kind] for kind in RESTS)
            if told and rests and name == "length":
                said = "there is a length, but it is not a travel step"
                yield Fault(said, min(told.values()), step)
            if len(told) > 1:
                yield Fault(f"more than one {what}", sorted(told.values())[1], step)
        for (slot,), line in self.known["compass"].get(step, {}).items():
            if slots is not None and not 0 <= slot < slots:
                yield Fault(f"compass slot {slot} is not in 0..{slots - 1}", line, step)
        for (length,), line in self.known["length"].get(step, {}).items():
            if length <= 0:
                yield Fault(f"length {length} is not above 0", line, step)
            most = LARGEST // max(100, self.stretch)
            if length > most:
                yield Fault(_too_long(length, most, self.stretch), line, step)
        if told_apart := self.pairs["apart"].get((step, step)):
            yield Fault("it is said to be at another place than itself", told_apart, step)

    def _pair_faults(self, step: int, slots: int | None, noisy: bool) -> Iterator[Fault]:
        """Find what is wrong with the pairs of gateways that are given for a step."""
        view = self.views.get(step, {})
        # For each slot the other slots of its pairs, with lines.
        told: dict[int, dict[int, tuple[int, str]]] = {}
        for (one, other), line in self.known["straight"].get(step, {}).items():
            fact = f"straight({step},{one},{other})"
            for slot, end in (one, other), (other, one):
                told.setdefault(slot, {}).setdefault(end, (line, fact))
        for slot, others in sorted(told.items()):
            line, fact = min(others.values())
            if slots is not None and not 0 <= slot < slots:
                yield Fault(f"{fact}: slot {slot} is not in 0..{slots - 1}", line, step)
            elif slot >= 0 and view and slot not in view and not noisy:
                yield Fault(f"{fact}: no gateway in slot {slot}{HINT}", line, step, lacks=True)
            if len(others) > 1:
                line = sorted(others.values())[1][0]
                yield Fault(f"gateway {slot} is in more than one pair", line, step)

    def _far(self) -> Iterator[Fault]:
        """The first step at which the sum of the shifts is too large for clingo."""
        most = LARGEST // max(100, self.drift)
        told = {*self.turns, *(step for steps in self.rests.values() for step in steps)}
        sums, step = {0}, 1
        while step in told:
            if shifts := self.known["shift"].get(step):
                more = {n + abs(x) + abs(y) for n in sums for x, y in shifts}
                sums = {n for n in more if n <= most}
                if not sums:
                    yield Fault(_too_far(min(more), most, self.drift), min(shifts.values()), step)
                    return
            step += 1

    def experience(self) -> Experience:
        """Make the experience of the facts, which must have no fault."""
        (slots,) = self.slots
        rests = {name: self.rests[name].keys() for name in RESTS}
        steps = range(max([0, *self.turns, *rests["start"], *rests["look"]]) + 1)
        return Experience(
            slots,
            tuple(frozenset(self.views.get(step, ())) for step in steps),
            tuple(next(iter(self.turns.get(step, {})), None) for step in steps[1:]),
            tuple(frozenset(self.landmarks.get(step, ())) for step in steps),
            *(frozenset(self.marks[name]) for name in MARKER),
            compass=self._each("compass", steps),
            shifts=self._each("shift", steps[1:]),
            lengths=self._each("length", steps[1:]),
            straight=self._pairs_of(steps),
            same=self.pairs["same"],
            apart=self.pairs["apart"],
            starts=rests["start"],
            looks=rests["look"],
            things=self.things,
            drift=self.drift,
            stretch=self.stretch,
        )

    def _pairs_of(self, steps: range) -> list[list[Any]]:
        """The pairs of gateways that are given for each step; nothing if none is given."""
        told = self.known["straight"]
        return [[*told.get(step, ())] for step in steps] if told else []

    def _each(self, name: str, steps: range) -> list[Any]:
        """What is given for each step, or None: a number, or all of them if there are several."""
        told = (next(iter(self.known[name].get(step, ())), None) for step in steps)
        return (
            [one[0] if one and len(one) == 1 else one for one in told] if self.known[name] else []
        )


def range_fault(
    shifts: Iterable[Shift | None], lengths: Iterable[int | None], drift: int, stretch: int
) -> Fault | None:
    """Find the step whose shift or length is too large for clingo.

    It is too large if clingo's numbers cannot hold it when it is multiplied by 100, or by the
    percent by which it may be wrong; shifts are summed.
    """
    far, most = 0, LARGEST // max(100, drift)
    for step, shift in enumerate(shifts, 1):
        far += abs(shift[0]) + abs(shift[1]) if shift else 0
        if far > most:
            return Fault(_too_far(far, most, drift), step=step)
    most = LARGEST // max(100, stretch)
    for step, length in enumerate(lengths, 1):
        if length is not None and length > most:
            return Fault(_too_long(length, most, stretch), step=step)
    return None


def _too_far(far: int, most: int, drift: int) -> str:
    held = f"with a drift of {drift} % clingo's numbers hold {most} in all"
    return f"the shifts up to here come to {far}; {held}"


def _too_long(length: int, most: int, stretch: int) -> str:
    held = f"the most that clingo's numbers hold with a stretch of {stretch} %"
    return f"length {length} is above {most}, {held}"


def slots_fault(slots: int) -> str | None:
    """Say what is wrong with a number of slots."""
    if slots < 2 or slots % 2 or slots > MOST_SLOTS:
        return f"slots({slots}): K must be even, from 2 to {MOST_SLOTS}"
    return None


def misfit(fact: clingo.Symbol, forms: Mapping[str, str] = SIGNATURES) -> str | None:
    """Say why a fact does not belong in an instance.

    Either it has none of the ``forms``, which are given by name, or it has another term where a
    number is wanted.
    """
    name, arguments = fact.name, fact.arguments
    text = cut_short(str(fact))
    known = FORMS if forms is SIGNATURES else {n: form.count(",") + 1 for n, form in forms.items()}
    named = fact.positive and name in MARKER and len(arguments) == 2
    if named and arguments[0].type == clingo.SymbolType.Number:
        return None
    if not fact.positive or (known.get(name) != len(arguments) and not named):
        if fact.positive and name in known:
            has = "1 argument" if known[name] == 1 else f"{known[name]} arguments"
            more = f", or 2 with a name, {NAMED[name]}" if name in NAMED else ""
            return f"{text}: {name} has {has}, {forms[name]}{more}"
        near = nearest(name, known)
        if fact.positive and near:
            meant = f"did you mean {near}/{known[near]}?"
            return f"{text}: {name}/{len(arguments)} is not known; {meant}"
        every = ", ".join(f"{name}/{arity}" for name, arity in known.items())
        return f"{text} is not a fact over {every}"
    numbers = arguments[:1] if name == "landmark" else arguments
    if any(argument.type != clingo.SymbolType.Number for argument in numbers):
        return f"{text}: {WHOLE.get(name, 'a step is a whole number')}"
    return None


# Outside a block comment: its beginning, a line comment, the two stops of an interval, a
# string, a full stop, or other text. Block comments are nested.
_TOKEN = re.compile(rf'%\*|%[^\n]*|\.\.|{STRING}|\.|[^%".]+|"', re.DOTALL)
_COMMENT = re.compile(r"%\*|\*%|[^%*]+|[%*]", re.DOTALL)
_FACT = re.compile(r"-?[a-z]\w*\(.*\)", re.DOTALL)
# A fact that a decimal point has cut short.
_DECIMAL = re.compile(r"[a-z]\w*\([^()]*,\s*-?[0-9]+", re.DOTALL)
_NUMBERS = re.compile(r"([a-z]\w*)\(((?:0|-?[1-9][0-9]{0,8})(?:,(?:0|-?[1-9][0-9]{0,8}))*)\)")
_NO_STOP = re.compile(r"\)\s+[a-z]\w*\(")


def ground_facts(text: str, line: int = 1) -> Iterator[tuple[int, clingo.Symbol | str]]:
    """Read the ground facts of a text, each with the line in which it begins.

    The first line has the number ``line``. In the place of a statement that is not a ground fact
    there is a text that says what it is.
    """
    told = statements(text, line)
    return ((begins, _fact(statement, ends)) for begins, statement, ends in told)


def statements(text: str, line: int = 1) -> Iterator[tuple[int, str, bool]]:
    """Split a text into statements, without comments and full stops.

    Each comes with the line in which it begins (the first line has the number ``line``), and with
    whether it ends, as the last one may not. A script is not read, nor is what follows it, because
    the text of a script is not made of statements.
    """
    fact: list[str] = []
    begins = line
    position = depth = 0
    while match := (_COMMENT if depth else _TOKEN).match(text, position):
        token, position = match[0], match.end()
        if token == "%*":
            depth += 1
        elif depth:
            depth -= token == "*%"
        elif token == ".":
            statement = "".join(fact).strip()
            yield begins, statement, True
            if statement.startswith("#script"):
                return
            fact = []
        elif not token.startswith("%") and (fact or token.strip()):
            if not fact:
                begins = line + token[: -len(token.lstrip())].count("\n")
            fact.append(token)
        line += token.count("\n")
    if fact or depth:
        yield begins, "".join(fact), False


def _fact(text: str, ends: bool) -> clingo.Symbol | str:
    """Read the ground fact of a statement, or say why there is none."""
    if not ends:
        return f"{quoted(text) if text else 'a comment'} does not end"
    if _DECIMAL.fullmatch(text):
        return f"{quoted(text)} is not a ground fact: numbers are whole, without a decimal point"
    if not _FACT.fullmatch(text):
        return f"{quoted(text)} is not a ground fact"
    read = ground(text, "fact")
    if isinstance(read, str) and _NO_STOP.search(text):
        return f"{read} (is a full stop missing?)"
    return read
