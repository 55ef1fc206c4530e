"""What is known of an experience that is told line by line.

Each line is a step, in JSON or in facts, or takes steps back; it is read on top of what is
known, so that a line with a fault changes nothing.
"""

import json
import re
from dataclasses import dataclass, replace
from typing import Any

import clingo

from topomap.documents.maps import is_number
from topomap.model import words
from topomap.model.experience import MARKER, marker_fault, marker_out
from topomap.model.facts import SIGNATURES, ground_facts, misfit, slots_fault
from topomap.model.terms import cut_short
from topomap.runtime.errors import InputError

KNOWN = {**SIGNATURES, "undo": "undo(N)"}  # of which undo is a line by itself
_UNDO = re.compile(r"undo(?:\(\s*([0-9]{1,9})\s*\))?\s*\.\s*(?:%.*)?", re.ASCII | re.DOTALL)


class LineFault(ValueError):
    """What is wrong with a line, or with a step."""


@dataclass(frozen=True)
class Step:
    """What is known of a step, which may not be all as yet."""

    turn: int | None = None
    view: frozenset[int] = frozenset()
    landmarks: frozenset[str] = frozenset()
    marks: frozenset[str] = frozenset()  # of MARKER


@dataclass(frozen=True)
class Record:
    """What was read. Of the last step something may be missing."""

    slots: int | None = None
    steps: tuple[Step, ...] = ()

    def lack(self) -> str | None:
        """What the last step lacks."""
        if not self.steps:
            return None
        last, step = self.steps[-1], len(self.steps) - 1
        if self.slots is None:
            return "no slots(K)"
        if step and last.turn is None:
            return f"step {step}: no turn"
        if not last.view:
            return f"step {step}: no view"
        if 0 not in last.view:
            return f"step {step}: the view lacks slot 0, the gateway where the agent stands"
        return None

    def whole(self) -> tuple[Step, ...]:
        """The steps of which all is known."""
        return self.steps[:-1] if self.lack() else self.steps

    def with_line(self, line: str, source: str, number: int) -> "Record":
        """The record with one more line. Raises InputError if the line has a fault."""
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
            return record._marked()
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
        if name in MARKER:
            return self._seen(first, mark=name)
        return self._seen(first, landmark=str(arguments[1]))

    def _marked(self) -> "Record":
        """The record, if what is told of the marker can be."""
        out = False
        for number, step in enumerate(self.steps):
            if step.marks:
                if fault := marker_fault(step.marks, out):
                    raise LineFault(f"step {number}: {fault}")
                out = marker_out(step.marks, out)
        return self

    def with_slots(self, slots: int) -> "Record":
        """The record with the number of slots. Raises LineFault."""
        if self.slots is not None:
            raise LineFault("slots are told twice")
        if fault := slots_fault(slots):
            raise LineFault(fault)
        if self.steps:
            raise LineFault("slots are to be told before the first step")
        return replace(self, slots=slots)

    def _seen(
        self,
        step: int,
        turn: int | None = None,
        view: int | None = None,
        landmark: str | None = None,
        mark: str | None = None,
    ) -> "Record":
        """The record with one more fact: of the last step, or of the next one."""
        if self.slots is None:
            raise LineFault("no slots(K) before the first step")
        last = len(self.steps) - 1
        if step not in (last, last + 1) or step < 0:
            may = f"{last} or {last + 1}" if last >= 0 else "0"
            raise LineFault(f"step {step}: it is {may} now")
        if step > last and (lack := self.lack()):
            raise LineFault(f"{lack}, but there is a later step")
        known = self.steps[step] if step == last else Step()
        for slot in (turn, view):
            if slot is not None and not 0 <= slot < self.slots:
                raise LineFault(f"step {step}: slot {slot} is not in 0..{self.slots - 1}")
        if turn is not None:
            if step == 0:
                raise LineFault("step 0: there is a turn, but step 1 is the first with a turn")
            if known.turn not in (None, turn):
                raise LineFault(f"step {step}: more than one turn")
            if turn not in self.steps[step - 1].view:
                raise LineFault(f"step {step}: turn {turn}: no gateway there after step {step - 1}")
            known = replace(known, turn=turn)
        if view is not None:
            known = replace(known, view=known.view | {view})
        if landmark is not None:
            known = replace(known, landmarks=known.landmarks | {landmark})
        if mark is not None:
            known = replace(known, marks=known.marks | {mark})
        return replace(self, steps=(*self.steps[:step], known))

    def undone(self, steps: int) -> "Record":
        """The record without its last steps. Raises LineFault if there are not as many."""
        last = len(self.steps) - 1
        if not 0 < steps <= last:
            has = words.number(max(last, 0), "step")
            raise LineFault(f"undo of {words.number(steps, 'step')}: to take back: {has}")
        return replace(self, steps=self.steps[:-steps])

    def with_object(self, data: dict[str, Any]) -> "Record":
        """The record with what a JSON object says: a step, whole, or how many to take back.
        Raises LineFault."""
        begins = self.slots is None
        known = {"slots" if begins else "turn", "view", "landmarks", *MARKER}
        if data.keys() == {"undo"}:
            if not is_number(data["undo"]):
                raise LineFault("undo: a whole number is wanted")
            return self.undone(data["undo"])
        for key in data:
            if key not in known:
                known_keys = ", ".join(sorted(known))
                raise LineFault(f"{cut_short(json.dumps(key))}: not one of {known_keys}")
        first = "slots" if begins else "turn"
        if not begins and not self.steps:
            first, known = "view", known - {"turn"}
        for key in dict.fromkeys((first, "view")):
            if key not in data:
                raise LineFault(f"{key} is missing")
        view, landmarks = data["view"], data.get("landmarks", [])
        if not isinstance(view, list) or not all(map(is_number, view)):
            raise LineFault("view: a list of slots is wanted")
        if not isinstance(landmarks, list) or not all(isinstance(one, str) for one in landmarks):
            raise LineFault("landmarks: a list of terms, as text, is wanted")
        for name in MARKER:
            if not isinstance(data.get(name, False), bool):
                raise LineFault(f"{name}: true or false is wanted")
        if first != "view" and not is_number(data[first]):
            raise LineFault(f"{first}: a whole number is wanted")
        record = self.with_slots(data["slots"]) if begins else self
        step = len(record.steps)
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
        for name in MARKER:
            if data.get(name):
                record = record._seen(step, mark=name)
        if lack := record.lack():
            raise LineFault(lack)
        return record._marked()


def _parsed(text: str) -> dict[str, Any]:
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        raise LineFault("no JSON text") from None
    if not isinstance(data, dict):
        raise LineFault("a JSON object is wanted")
    return data
