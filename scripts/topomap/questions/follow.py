"""An experience that is followed: what is told after each step."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from topomap.documents.answers import map_line
from topomap.model import words
from topomap.model.exceptions import exceptions_of
from topomap.model.experience import Experience, Step
from topomap.model.found import Found, steps_json
from topomap.questions.explore import LIMITS, Plan, plan
from topomap.questions.records import Record
from topomap.questions.standings import standing
from topomap.runtime.limits import MOST_COUNTED
from topomap.runtime.watch import Watch
from topomap.solver.online import Certain, OnlineSolver, Status

SHOWN = 3  # best maps that are told in text


@dataclass(frozen=True)
class StepAnswer:
    """What is told after a step of an experience: its status; what is ``certain`` by now, and
    since the step before, ``new``; the ``plan`` of what to do next, if one was found; and why
    something is missing."""

    experience: Experience
    status: Status
    certain: Certain
    new: Certain
    plan: Plan | None
    fault: str | None

    def lines(self, seconds: float) -> Iterator[str]:
        """The same to read; it took so many seconds."""
        status = self.status
        if status.none_since is not None:
            since = f" since step {status.none_since}" if status.none_since < status.step else ""
            yield f"step {status.step}: no hypothesis is left{since} ({seconds:.2f} s)"
            return
        more = "" if status.exact else "more than "
        noun = words.number(status.hypotheses or 0, "hypothesis", "hypotheses")
        told = f"{more}{noun}" if status.hypotheses is not None else "hypotheses not counted"
        yield f"step {status.step}: {told} ({seconds:.2f} s)"
        facts = [f"same({t},{u})" for t, u in sorted(self.new.same)]
        facts += [f"new({t})" for t in sorted(self.new.new)]
        facts += [f"linked({t},{s},{u},{r})" for t, s, u, r in sorted(self.new.linked)]
        if facts:
            rest = f" and {len(facts) - words.MOST:,} more" if len(facts) > words.MOST else ""
            yield f"  certain now: {' '.join(facts[: words.MOST])}{rest}"
        for number, at in enumerate(status.best[:SHOWN], 1):
            yield f"  map {number}: {map_line(self.experience, Found(at, ''))}"
            for one in exceptions_of(self.experience, at):
                yield f"    {one.words}"
        if status.kind:
            count = words.number(len(status.best), f"{status.kind} map")
            many = "" if status.all_best else "more than "
            yield f"  {many}{count}, cost {' '.join(map(str, status.cost))}"
        if self.plan is not None:
            yield f"  next: {_next(self.plan, self.experience, status.all_best)}"
        elif status.best and self.experience.tolerance:
            yield "  next: left out, as bearings are not exact, and what maps predict is"
        elif status.best and not self.fault:
            yield "  next: a walk that tells the best maps apart is not found"
        if self.fault:
            yield f"  partial: {self.fault}"

    def document(self) -> dict[str, Any]:
        """The same as JSON; None where it is open."""
        status, made, new = self.status, self.plan, self.new
        settled = status.all_best or bool(status.best)
        return {
            "step": status.step,
            "hypotheses": status.hypotheses,
            "exact": status.exact if status.hypotheses is not None else None,
            "none_since": status.none_since,
            "best": {
                "kind": status.kind,
                "cost": list(status.cost) if settled else None,
                "count": len(status.best) if settled else None,
                "all": status.all_best if settled else None,
                "maps": [steps_json(at) for at in status.best],
                "exceptions": [
                    [one.document() for one in exceptions_of(self.experience, at)]
                    for at in status.best
                ],
            },
            "certain": {
                "same": sorted(map(list, new.same)),
                "new": sorted(new.new),
                "linked": sorted(map(list, new.linked)),
            }
            if status.certain is not None
            else None,
            "next": {
                "kind": made.kind,
                "turns": list(made.turns),
                "drop": made.drop,
                "left": made.left,
                "proved": made.proved,
            }
            if made is not None
            else None,
        }


class Following:
    """An experience that goes on, or is taken back, as its record says; and what is certain
    after each step, with or without the ``path_axiom``. ``marker``: the agent carries one; of
    more than ``most`` hypotheses it is only told that they are more."""

    def __init__(
        self,
        planar: bool = False,
        bound: int | None = None,
        marker: bool = False,
        most: int = MOST_COUNTED,
        path_axiom: bool = True,
    ):
        self.planar, self.bound, self.marker, self.most = planar, bound, marker, most
        self.path_axiom = path_axiom
        self.record = Record(one_log=planar)
        self.solver: OnlineSolver | None = None
        self._certain: list[Certain] = []  # by steps

    def take(self, record: Record) -> Iterator[int]:
        """Go to what a record says; the steps at which it stands on the way."""
        old, new = self.record.whole(), record.whole()
        self.record = record
        common = 0
        while common < min(len(old), len(new)) and old[common] == new[common]:
            common += 1
        if common < len(old):
            del self._certain[common:]
            if common:
                assert self.solver is not None
                self.solver.undo(len(old) - common)
            else:
                self.solver = None
            if common == len(new) > 0:
                yield common - 1
        for step in range(common, len(new)):
            self._go(new[step])
            yield step

    def _go(self, step: Step) -> None:
        if self.solver is None:
            record = self.record
            assert record.slots is not None
            limits = self.planar, self.bound, self.most
            measured = record.drift, record.stretch, record.tolerance
            self.solver = OnlineSolver(record.slots, step, *limits, *measured, self.path_axiom)
        else:
            self.solver.step(step)

    def answer(self, watch: Watch) -> StepAnswer:
        """What is known where it stands, after one step at least; at the time limit, what is known
        until then."""
        assert self.solver is not None
        experience = self.solver.experience
        del self._certain[experience.steps :]
        status = self.solver.status(watch)
        before = self._certain[-1] if self._certain else Certain()
        following, fault = None, status.fault
        # What maps predict is exact, and so tells nothing where bearings are not.
        if status.best and not fault and not experience.tolerance:
            following, fault = self._plan(experience, status, watch)
        certain = before if status.certain is None else status.certain
        self._certain += [before] * (status.step - len(self._certain))
        self._certain.append(certain)
        return StepAnswer(experience, status, certain, certain.since(before), following, fault)

    def _plan(
        self, experience: Experience, status: Status, watch: Watch
    ) -> tuple[Plan | None, str | None]:
        """The next best action: what explore says of the best maps; and why the planning was cut,
        if it was. None if no walk was found, and it is open whether there is one."""
        among = [standing(experience, at) for at in status.best]
        made = plan(experience.slots, among, watch, marker=self.marker)
        fault = None if made.fault in LIMITS else made.fault
        if not made.turns and made.kind not in ("settled", "bisimilar"):
            return None, fault
        return made, fault


def _next(made: Plan, experience: Experience, every: bool) -> str:
    told = [words.direction(turn, experience.slots) for turn in made.turns]
    if experience.steps == 0 and told:  # it arrived by no gateway, so there is no way back
        told[0] = "by the gateway stood at" if made.turns[0] == 0 else ""
    walk = ", ".join(
        " ".join(filter(None, [str(turn), f"({'; '.join(how)})" * bool(how)]))
        for step, (turn, word) in enumerate(zip(made.turns, told, strict=True))
        for how in [[*["the marker put down before"] * (step == made.drop), *filter(None, [word])]]
    )
    left = words.number(made.left, "map")
    return {
        "apart": f"turn {walk}: of the best maps it leaves {left} at most",
        "pending": f"turn {walk}: to a pending gateway",
        "settled": "nothing; the only best map is closed",
        "bisimilar": f"nothing; no walk tells {'the' if every else 'these'} {left} apart",
    }[made.kind]
