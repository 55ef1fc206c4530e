"""What is known of an experience that arrives line by line.

Each line is a step, in JSON or in facts, or takes steps back. It makes a new record from what is
known, so that a line with a fault changes nothing.
"""

import json
import re
from dataclasses import dataclass, field, replace
from typing import Any

import clingo

from topomap.documents.maps import is_number
from topomap.model import words
from topomap.model.experience import MARKER, Step, marker_fault, marker_out
from topomap.model.facts import (
    PAIRS,
    RESTS,
    SIGNATURES,
    ground_facts,
    misfit,
    range_fault,
    slots_fault,
)
from topomap.model.growing import Growing
from topomap.model.terms import cut_short, spelt
from topomap.runtime.errors import InputError
from topomap.runtime.limits import DRIFT, STRETCH

KNOWN = {**SIGNATURES, "undo": "undo(N)"}  # "undo" stands alone in its line
KNOWN_KEYS = {  # the keys of a step in JSON, with the values that each accepts
    "compass": "a slot",
    "shift": "a list of two whole numbers",
    "length": "a whole number",
    "same": "a list of steps",
    "apart": "a list of steps",
    "straight": "a list of pairs of slots",
}
State = tuple[frozenset[str | None], int]
_UNDO = re.compile(r"undo(?:\(\s*([0-9]{1,9})\s*\))?\s*\.\s*(?:%.*)?", re.ASCII | re.DOTALL)


class LineFault(ValueError):
    """What is wrong with a line, or with a step."""


@dataclass(frozen=True)
class Record:
    """What was read; the last step may be incomplete, and those before it are ``done``."""

    slots: int | None = None
    done: Growing[Step] = field(default_factory=Growing)
    last: Step | None = None
    drift: int = DRIFT
    stretch: int = STRETCH
    tolerance: int = 0
    one_log: bool = False  # whether no new log may begin
    # For each complete step: the markers that lie somewhere, and the sum of the shifts.
    _states: Growing[State] = field(default_factory=Growing, compare=False, repr=False)

    @property
    def steps(self) -> Growing[Step]:
        """The steps, of which the last may be incomplete."""
        return self.done if self.last is None else self.done.then(self.last)

    def lack(self) -> str | None:
        """What is missing from the last step."""
        if self.last is None:
            return None
        last, step = self.last, len(self.done)
        if self.slots is None:
            return "no slots(K)"
        if step and last.turn is None and not (last.start or last.look):
            return f"step {step}: no turn"
        if not last.view:
            return f"step {step}: no view"
        if 0 not in last.view:
            return f"step {step}: the view lacks slot 0, the gateway where the agent stands"
        for one, other in sorted(last.straight or ()):
            if not {one, other} <= last.view:
                slot = one if one not in last.view else other
                return f"step {step}: straight({step},{one},{other}): no gateway in slot {slot}"
        return None

    def whole(self) -> Growing[Step]:
        """The steps that are complete."""
        return self.done if self.lack() else self.steps

    def with_line(self, line: str, source: str, number: int) -> "Record":
        """Add one more line.

        Raises:
            InputError: The line has a fault.
        """
        text = line.strip()
        try:
            if text.startswith(("{", "[")):
                return self.with_object(_parsed(text))
            if match := _UNDO.fullmatch(text):
                return self.undone(int(match[1] or 1))
            record = self
            for _, fact in ground_facts(text):
                if isinstance(fact, str):
                    raise LineFault(fact)
                record = record._with(fact)
            record._state()
            return record
        except LineFault as fault:
            raise InputError(f"{source}:{number}: {fault}") from None

    def _with(self, fact: clingo.Symbol) -> "Record":
        if fault := misfit(fact, KNOWN):
            raise LineFault(fault)
        name, arguments = fact.name, fact.arguments
        if name == "undo":
            raise LineFault(f"{fact}: undo is a line by itself")
        first = arguments[0].number
        if name == "slots":
            return self.with_slots(first)
        if name == "view":
            return self._seen(first, view=arguments[1].number)
        if name == "turn":
            return self._seen(first, turn=arguments[1].number)
        if name in MARKER and len(arguments) == 2:
            return self._with_thing(first, name, str(arguments[1]))
        if name in MARKER:
            return self._seen(first, mark=name)
        if name in RESTS:
            return self._rested(first, name)
        numbers = tuple(argument.number for argument in arguments[1:] if name != "landmark")
        if name in PAIRS:
            return self._paired(name, first, *numbers)
        if name in ("compass", "length"):
            return self._known(first, name, *numbers)
        if name == "shift":
            return self._known(first, name, numbers)
        if name == "straight":
            return self._on_one_path(first, *numbers)
        return self._seen(first, landmark=str(arguments[1]))

    def _state(self) -> State:
        """What holds after the last step.

        Raises:
            LineFault: What is said of markers is impossible, or a sum of shifts or lengths is too
                large for clingo.
        """
        out, far = self._states[-1] if self.done else (frozenset(), 0)
        last, number = self.last, len(self.done)
        if last is None:
            return out, far
        marks: dict[str | None, set[str]] = {None: {*last.marks}} if last.marks else {}
        for kind, name in last.things:
            marks.setdefault(name, set()).add(kind)
        for which, done in marks.items():
            if fault := marker_fault(done, which in out, which):
                raise LineFault(f"step {number}: {fault}")
            out = out - {which} | ({which} if marker_out(done, which in out) else set())
        if last.shift or last.length:
            told = [(far, 0), last.shift]
            wrong = range_fault(told, [last.length], self.drift, self.stretch)
            if wrong:
                raise LineFault(replace(wrong, step=number).of("").lstrip(": "))
        x, y = last.shift or (0, 0)
        return out, far + abs(x) + abs(y)

    def _with_last(self, **changed: Any) -> "Record":
        """Change what is known of the last step."""
        assert self.last is not None
        return replace(self, last=replace(self.last, **changed))

    def with_slots(self, slots: int) -> "Record":
        """Set the number of slots.

        Raises:
            LineFault: It is impossible.
        """
        if self.slots is not None:
            raise LineFault("slots are given twice")
        if fault := slots_fault(slots):
            raise LineFault(fault)
        if self.last is not None:
            raise LineFault("slots must be given before the first step")
        return replace(self, slots=slots)

    def _with_thing(self, step: int, kind: str, name: str) -> "Record":
        """Add what is done with a marker that has a name."""
        record = self._seen(step)
        assert record.last is not None
        return record._with_last(things=record.last.things | {(kind, name)})

    def _rested(self, step: int, kind: str) -> "Record":
        """Add a step that is not a travel."""
        record = self._seen(step)
        assert record.last is not None
        known = record.last
        if step == 0:
            said = "it is already the start" if kind == "start" else "there is no earlier look"
            raise LineFault(f"step 0: {said}")
        if kind == "start" and self.one_log:
            raise LineFault(f"step {step}: a new log is not followed if maps are to be planar")
        if known.turn is not None:
            said = "it has a turn, but begins a log" if kind == "start" else "a look has no turn"
            raise LineFault(f"step {step}: {said}")
        if known.length is not None:
            raise LineFault(f"step {step}: there is a length, but it is not a travel step")
        if (kind == "start" and known.look) or (kind == "look" and known.start):
            raise LineFault(f"step {step}: it begins a log, and is a second look")
        return record._with_last(**{kind: True})

    def _known(self, step: int, name: str, value: Any) -> "Record":
        """Add what is known besides views of the last step, or of the next one."""
        record = self._seen(step)
        assert record.slots is not None
        assert record.last is not None
        known = record.last
        if getattr(known, name) not in (None, value):
            raise LineFault(f"step {step}: more than one {name}")
        if name == "compass" and not 0 <= value < record.slots:
            raise LineFault(f"step {step}: compass slot {value} is not in 0..{record.slots - 1}")
        if name != "compass" and step == 0:
            raise LineFault(f"step 0: there is a {name}, but step 1 is the first that moves")
        if name == "length" and (known.start or known.look):
            raise LineFault(f"step {step}: there is a length, but it is not a travel step")
        if name == "length" and value <= 0:
            raise LineFault(f"step {step}: length {value} is not above 0")
        return record._with_last(**{name: value})

    def _paired(self, name: str, one: int, other: int) -> "Record":
        """Add two steps after which the agent was at one place, or at two."""
        earlier, step = sorted((one, other))
        if earlier < 0:
            raise LineFault(f"step {earlier}: steps are numbered from 0")
        record = self._seen(step)
        if earlier == step and name == "apart":
            raise LineFault(f"step {step}: it is said to be at another place than itself")
        return record._with_last(**{name: getattr(record.last, name) | {earlier}})

    def _on_one_path(self, step: int, one: int, other: int) -> "Record":
        """Add two gateways of a visit that are on one path.

        A gateway that ends its path is given as a pair with itself.
        """
        record = self._seen(step)
        assert record.slots is not None
        if record.done and record.done[0].straight is None:
            said = "the gateways that are on one path must be given from step 0 on, or not at all"
            raise LineFault(f"step {step}: {said}")
        assert record.last is not None
        known = record.last
        pairs = known.straight or frozenset()
        for slot in (one, other):
            if not 0 <= slot < record.slots:
                raise LineFault(f"step {step}: slot {slot} is not in 0..{record.slots - 1}")
            if any(slot in pair and pair != (min(one, other), max(one, other)) for pair in pairs):
                raise LineFault(f"step {step}: gateway {slot} is in more than one pair")
        if one != other:
            pairs |= {(min(one, other), max(one, other))}
        return record._with_last(straight=pairs)

    def _seen(
        self,
        step: int,
        turn: int | None = None,
        view: int | None = None,
        landmark: str | None = None,
        mark: str | None = None,
    ) -> "Record":
        """Add one more fact about the last step, or about the next one."""
        if self.slots is None:
            raise LineFault("no slots(K) before the first step")
        last = len(self.done) - (self.last is None)
        if step not in (last, last + 1) or step < 0:
            now = f"is at step {last}, and goes on with that or with step {last + 1}"
            raise LineFault(f"step {step}: the log {now if last >= 0 else 'begins with step 0'}")
        if step > last and (lack := self.lack()):
            raise LineFault(f"{lack}, but there is a later step")
        known = Step()
        if self.last is not None and step == last:
            known = self.last
        for slot in (turn, view):
            if slot is not None and not 0 <= slot < self.slots:
                raise LineFault(f"step {step}: slot {slot} is not in 0..{self.slots - 1}")
        if turn is not None:
            if step == 0:
                raise LineFault("step 0: there is a turn, but step 1 is the first with a turn")
            if known.turn not in (None, turn):
                raise LineFault(f"step {step}: more than one turn")
            if known.start or known.look:
                raise LineFault(f"step {step}: it has a turn, but is not a travel step")
            before = self.done[step - 1] if step == last or self.last is None else self.last
            if turn not in before.view:
                raise LineFault(f"step {step}: turn {turn}: no gateway there after step {step - 1}")
            known = replace(known, turn=turn)
        if view is not None:
            known = replace(known, view=known.view | {view})
        if landmark is not None:
            known = replace(known, landmarks=known.landmarks | {landmark})
        if mark is not None:
            known = replace(known, marks=known.marks | {mark})
        if self.last is None or step == last:
            return replace(self, last=known)
        states = self._states.then(self._state())
        return replace(self, done=self.done.then(self.last), last=known, _states=states)

    def undone(self, steps: int) -> "Record":
        """Take the last steps back.

        Raises:
            LineFault: There are not as many.
        """
        last = len(self.done) - (self.last is None)
        if not 0 < steps <= last:
            has = words.number(max(last, 0), "step")
            raise LineFault(f"undo of {words.number(steps, 'step')}: to take back: {has}")
        left = last - steps
        return replace(
            self,
            done=self.done.first(left),
            last=self.done[left],
            _states=self._states.first(left),
        )

    def with_object(self, data: dict[str, Any]) -> "Record":
        """Add what a JSON object says: a complete step, or how many steps to take back.

        Raises:
            LineFault: It is impossible.
        """
        # Null means that it is not given.
        data = {key: value for key, value in data.items() if value is not None}
        begins = self.slots is None
        known = {"slots" if begins else "turn", "view", "landmarks", *MARKER, *KNOWN_KEYS, *RESTS}
        if data.keys() == {"undo"}:
            if not is_number(data["undo"]):
                raise LineFault("undo: a whole number is wanted")
            return self.undone(data["undo"])
        for key in data:
            if key not in known:
                known_keys = ", ".join(sorted(known))
                raise LineFault(f"{cut_short(json.dumps(key))}: not one of {known_keys}")
        first = "slots" if begins else "turn"
        rests = [name for name in RESTS if data.get(name)]
        if (not begins and self.last is None) or (rests and not begins and "turn" not in data):
            first = "view"
        for key in dict.fromkeys((first, "view")):
            if key not in data:
                raise LineFault(f"{key} is missing")
        view, landmarks = data["view"], data.get("landmarks", [])
        if not isinstance(view, list) or not all(map(is_number, view)):
            raise LineFault("view: a list of slots is wanted")
        if not isinstance(landmarks, list) or not all(isinstance(one, str) for one in landmarks):
            raise LineFault("landmarks: a list of terms, as text, is wanted")
        for name in RESTS:
            if not isinstance(data.get(name, False), bool):
                raise LineFault(f"{name}: true or false is wanted")
        if first != "view" and not is_number(data[first]):
            raise LineFault(f"{first}: a whole number is wanted")
        record = self.with_slots(data["slots"]) if begins else self
        step = len(record.done) + (record.last is not None)
        if lack := record.lack():
            raise LineFault(f"{lack}, but there is a later step")
        if step and "turn" in data:
            record = record._seen(step, turn=data["turn"])
        elif "turn" in data:
            raise LineFault("step 0: there is a turn, but step 1 is the first with a turn")
        for slot in view:
            record = record._seen(step, view=slot)
        for term in landmarks:
            facts = [fact for _, fact in ground_facts(f"landmark({step},{term}).")]
            for fact in facts:
                if isinstance(fact, str):
                    raise LineFault(fact)
                if len(facts) != 1 or len(fact.arguments) != 2:
                    told = cut_short(json.dumps(term))
                    raise LineFault(f"landmarks: {told} is not a ground term")
                record = record._with(fact)
        for kind in MARKER:
            for which in _names(kind, data.get(kind, False)):
                if which is None:
                    record = record._seen(step, mark=kind)
                else:
                    record = record._with_thing(step, kind, which)
        for name in rests:
            record = record._rested(step, name)
        for name in KNOWN_KEYS:
            value: Any = data.get(name)
            if name in data and not _fits(name, value):
                raise LineFault(f"{name}: {KNOWN_KEYS[name]} is wanted")
            if name == "straight" and name in data:
                # Without pairs each gateway ends its path; this says so of gateway 0.
                for pair in value or [[0, 0]]:
                    record = record._on_one_path(step, *pair)
                continue
            for other in value or () if name in PAIRS else ():
                if other > step:
                    raise LineFault(f"{name}: step {other} is later than step {step}")
                record = record._paired(name, other, step)
            if name in data and name not in PAIRS:
                record = record._known(step, name, tuple(value) if name == "shift" else value)
        if lack := record.lack():
            raise LineFault(lack)
        record._state()
        return record


def _names(kind: str, value: Any) -> list[str | None]:
    """Read which markers are put down, taken up or seen.

    True means the marker that has no name, a text is the name of a marker, and a list has several.
    """
    found: list[str | None] = []
    for one in value if isinstance(value, list) else [value]:
        if isinstance(one, bool):
            found += [None] * one
        elif isinstance(one, str):
            try:
                found.append(spelt(one))
            except ValueError as fault:
                raise LineFault(f"{kind}: {fault}") from None
        else:
            raise LineFault(f"{kind}: true or false is wanted, or the names of markers")
    return found


def _fits(name: str, value: Any) -> bool:
    """Tell whether a value of a JSON object is what its key wants."""
    if name in ("compass", "length"):
        return is_number(value)
    if name == "straight":
        pairs = value if isinstance(value, list) else [0]
        return all(isinstance(one, list) and _fits("shift", one) for one in pairs)
    whole = isinstance(value, list) and all(
        isinstance(one, int) and not isinstance(one, bool) for one in value
    )
    return whole and (name != "shift" or len(value) == 2)


def _parsed(text: str) -> dict[str, Any]:
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        raise LineFault("not a JSON text") from None
    if not isinstance(data, dict):
        raise LineFault("a JSON object is wanted")
    return data
