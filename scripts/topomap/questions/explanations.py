"""What is told of why a statement is so: the verdict, and the reasons for it."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from topomap.documents.answers import map_line
from topomap.model import words
from topomap.model.experience import DState, Experience
from topomap.model.found import Found, steps_json
from topomap.model.query import Query
from topomap.model.vocabulary import DEMANDS
from topomap.questions.reasons import RULES, Told
from topomap.questions.statements import Statement

MOST_OTHERS, MANY = 4, 8  # that a map breaks besides, as told; reasons, of which a sum is told
VERDICTS = {
    "impossible": "impossible",
    "certain": "certain",
    "open": "so in some maps, and not in others",
    "no map": "no map is consistent with the experience",
}


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
        """The rule that it is of."""
        return self.name.partition("(")[0]

    def lines(self) -> Iterator[str]:
        """The reason to read, and a map without it."""
        yield f"  {self.name}: {RULES[self.kind]}: {self.told.words}"
        if self.at:
            line = " ".join(f"{place}.{slot}" for place, slot in self.at)
            others = " ".join(self.also[:MOST_OTHERS])
            more = len(self.also) - MOST_OTHERS
            others += f" and {more} more" if more > 0 else ""
            also = f" (which breaks {others}, too)" if others else ""
            yield f"    without it: {line}{also}"

    def document(self) -> dict[str, Any]:
        """The reason as JSON."""
        return {
            "reason": self.name,
            "rule": RULES[self.kind],
            "words": self.told.words,
            "steps": self.told.steps,
            "walk": self.told.walk,
            "places": self.told.places,
            "without": steps_json(self.at),
            "also": self.also,
        }


@dataclass
class Explanation:
    """What is found: the verdict, and the reasons for it in the first ``horizon`` steps; or maps
    in which the statement holds and does not."""

    verdict: str | None = None
    horizon: int | None = None
    reasons: list[Reason] = field(default_factory=list)
    minimal: bool = False
    maps: dict[bool, tuple[DState, ...]] = field(default_factory=dict)

    def lines(
        self, experience: Experience, statement: Statement | None, fault: str | None
    ) -> Iterator[str]:
        """What was found of a statement about an experience, to read; ``fault`` says why not all
        was."""
        head = f"{statement.text}: " if statement else ""
        if self.verdict is None:
            yield f"{head}not settled"
        elif self.verdict == "open":
            yield f"{head}{VERDICTS['open']}" if statement else "there are maps"
            for holds, at in sorted(self.maps.items(), reverse=True):
                does = "" if not statement else f" in which it {'holds' if holds else 'does not'}"
                yield f"  a map{does}: {map_line(experience, Found(at, 'consistent'))}"
        else:
            yield f"{head}{VERDICTS[self.verdict]}" + self._where(experience)
            if statement and statement.note and self.verdict != "no map":
                yield f"  {statement.note}"
            for reason in self.reasons:
                yield from reason.lines()
            yield self._sum()
        if fault:
            yield f"partial: {fault}"

    def _where(self, experience: Experience) -> str:
        if self.horizon in (None, experience.steps):
            return ""
        return f", already after step {self.horizon}"

    def _sum(self) -> str:
        many = len(self.reasons)
        if not self.minimal:
            enough = f"{many} {words.plural(many, 'reason')}: enough, but some may be spared"
            return enough if many else "the reasons are not found yet"
        if not many:
            return "it is so whatever the map: no rule is needed"
        if many == 1:
            return "this one reason is enough"
        kinds = Counter(RULES[reason.kind] for reason in self.reasons)
        told = ", ".join(f"{times} of {kind}" for kind, times in kinds.most_common())
        which = f" ({told})" if many > MANY else ""
        return f"these {many} reasons{which} are enough, and without any one of them it is not so"

    def document(self, statement: Statement | None, query: Query) -> dict[str, Any]:
        """What was found, as JSON."""
        verdict = self.verdict
        if verdict == "open" and not statement:
            verdict = "map"
        maps = self.maps if verdict in ("open", "map") else {}
        return {
            "statement": statement and statement.text,
            "note": statement and statement.note,
            "demands": [part for part in DEMANDS if part in query.parts],
            "bound": query.places,
            "verdict": verdict,
            "horizon": self.horizon,
            "reasons": [reason.document() for reason in self.reasons],
            "minimal": self.minimal or None,
            "witness": steps_json(maps.get(True, ())),
            "counter": steps_json(maps.get(False, ())),
        }
