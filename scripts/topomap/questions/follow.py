"""An experience that is followed, and what is reported after each step."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from topomap.documents.answers import line_of
from topomap.model import words
from topomap.model.experience import Experience, Step
from topomap.model.found import UNPROVED, steps_json
from topomap.model.growing import Growing
from topomap.questions.explore import LIMITS, Plan, plan
from topomap.questions.records import Record
from topomap.questions.standings import Standing, predict, standing, standing_of
from topomap.runtime.limits import LONGEST_WALK, MOST_COUNTED
from topomap.runtime.watch import Watch
from topomap.search.certainty import Certain
from topomap.search.living import Living, Told, experience_of
from topomap.solver.online import LivingMap, OnlineSolver, ReadMap, Status
from topomap.solver.stepwise import Asked

SHOWN = 3  # the largest number of best maps in the text
WAY = 201  # so many of the last dstates of a map are shown: all those of 200 steps


@dataclass(frozen=True)
class StepAnswer:
    """What is reported after a step of an experience.

    It has the status; what is ``certain`` by now, and what is ``new`` since the step before; the
    ``plan`` of what to do next, if one was found; and why something is missing.
    """

    record: Record
    done: Growing[Step]
    status: Status
    certain: Certain
    new: Certain
    plan: Plan | None
    fault: str | None

    @cached_property
    def experience(self) -> Experience:
        """The experience up to this step; making it takes time in proportion to its length."""
        record = self.record
        assert record.slots is not None
        return experience_of(
            record.slots, self.done, record.drift, record.stretch, record.tolerance
        )

    def lines(self, seconds: float) -> Iterator[str]:
        """The report as lines to read; it took so many seconds."""
        status = self.status
        if status.none_since is not None:
            since = f" since step {status.none_since}" if status.none_since < status.step else ""
            yield f"step {status.step}: no hypothesis is left{since} ({seconds:.2f} s)"
            return
        more = "" if status.exact else "more than "
        noun = words.number(status.hypotheses or 0, "hypothesis", "hypotheses")
        told = f"{more}{noun}" if status.hypotheses is not None else "hypotheses not counted"
        yield f"step {status.step}: {told} ({seconds:.2f} s)"
        pairs, number = self.new.pairs(words.MOST)
        facts = [f"same({t},{u})" for t, u in pairs]
        facts += [f"new({t})" for t in sorted(self.new.new)]
        facts += [f"linked({t},{s},{u},{r})" for t, s, u, r in sorted(self.new.linked)]
        if facts:
            left = number - len(pairs) + len(facts) - words.MOST
            rest = f" and {left:,} more" if left > 0 else ""
            yield f"  certain now: {' '.join(facts[: words.MOST])}{rest}"
        for which, one in enumerate(status.maps[:SHOWN], 1):
            way = " ".join([f"{place}.{slot}" for place, slot in one.way(WAY)])
            earlier = "... " * (status.step >= WAY)
            yield f"  map {which}: {line_of(one.sizes, earlier + way)}"
            for exception in one.exceptions:
                yield f"    {exception.words}"
        if status.kind == UNPROVED:
            count = words.number(len(status.maps), "map")
            yield f"  {count}, {UNPROVED}, cost {' '.join(map(str, status.cost))}"
        elif status.kind:
            count = words.number(len(status.maps), f"{status.kind} map")
            many = "" if status.all_best else "more than "
            yield f"  {many}{count}, cost {' '.join(map(str, status.cost))}"
        if self.plan is not None:
            yield f"  next: {_next(self.plan, self.record, status)}"
        elif status.maps and self.record.tolerance:
            yield "  next: left out, as maps predict exact bearings, and those seen are not exact"
        elif status.maps and not self.fault:
            yield "  next: a walk that tells the best maps apart is not found"
        if self.fault:
            yield f"  partial: {self.fault}"

    def document(self) -> dict[str, Any]:
        """The report as JSON; None stands for what is open."""
        status, made, new = self.status, self.plan, self.new
        settled = status.all_best or bool(status.maps)
        first = max(0, status.step + 1 - WAY)
        return {
            "step": status.step,
            "hypotheses": status.hypotheses,
            "exact": status.exact if status.hypotheses is not None else None,
            "none_since": status.none_since,
            "best": {
                "kind": status.kind,
                "cost": list(status.cost) if settled else None,
                "count": len(status.maps) if settled else None,
                "all": status.all_best if settled else None,
                "maps": [steps_json(one.way(WAY), first) for one in status.maps],
                "exceptions": [
                    [exception.document() for exception in one.exceptions] for one in status.maps
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
    """An experience that goes on, or is taken back, as its record says.

    It tells what is certain after each step, with or without the ``path_axiom``. With ``marker``
    the agent carries a marker. If there are more than ``most`` hypotheses, only that is reported.
    """

    def __init__(
        self,
        planar: bool = False,
        bound: int | None = None,
        marker: bool = False,
        most: int = MOST_COUNTED,
        path_axiom: bool = True,
        living: int | None = None,
    ):
        self.planar, self.bound, self.marker, self.most = planar, bound, marker, most
        self.path_axiom = path_axiom
        self.record = Record(one_log=planar)
        self._living = () if living is None else (living,)
        self.solver: OnlineSolver | None = None
        self._certain: list[Certain] = []  # one entry for each step

    def take(self, record: Record) -> Iterator[int]:
        """Go to what a record says, and give the number of each step at which it stops."""
        old, new = self.record.whole(), record.whole()
        self.record = record
        common = old.common(new)
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
            measured = record.drift, record.stretch, record.tolerance
            asked = Asked(self.planar, self.bound, self.most, *measured, self.path_axiom)
            self.solver = OnlineSolver(record.slots, step, asked, *self._living)
        else:
            self.solver.step(step)

    def answer(self, watch: Watch) -> StepAnswer:
        """Tell what is known at this step, which must exist.

        At the time limit it is what is known so far.
        """
        assert self.solver is not None
        step, record = self.solver.told.last, self.record
        del self._certain[step:]
        status = self.solver.status(watch)
        before = self._certain[-1] if self._certain else Certain()
        following, fault = None, status.fault
        # The predictions of maps are exact, so they are of no use if bearings are not exact.
        if status.maps and not fault and not record.tolerance:
            following, fault = self._plan(self.solver, status, watch)
        certain = before if status.certain is None else status.certain
        self._certain += [before] * (step - len(self._certain))
        self._certain.append(certain)
        done, new = record.whole().first(step + 1), certain.since(before)
        return StepAnswer(record, done, status, certain, new, following, fault)

    def _plan(
        self, solver: OnlineSolver, status: Status, watch: Watch
    ) -> tuple[Plan | None, str | None]:
        """Plan what to do next: what explore says of the best maps.

        Returns:
            The plan, which is None if no walk was found and it is open whether there is one; and
            why the planning was cut short, or None.
        """
        told, one = solver.told, status.maps[0]
        if len(status.maps) == 1 and isinstance(one, LivingMap):
            return _plan_for(told, one.living), None
        among = [_standing(solver, one) for one in status.maps]
        made = plan(told.slots, among, watch, marker=self.marker)
        fault = None if made.fault in LIMITS else made.fault
        if not made.turns and made.kind not in ("settled", "bisimilar"):
            return None, fault
        return made, fault


def _standing(solver: OnlineSolver, one: ReadMap | LivingMap) -> Standing:
    if isinstance(one, LivingMap):
        return standing_of(solver.told, one.living)
    return standing(solver.experience, one.at)


def _plan_for(told: Told, living: Living) -> Plan | None:
    """Plan for one map: the shortest walk to a pending gateway, with the fewest turns.

    It is None if the walk is too long.
    """
    links, slots = living.form.links, told.slots
    # For each gateway, the one before it, and the turn there.
    reached: dict[int, tuple[int, int]] = {}
    start = living.visit.gateway
    level, seen, out = [start], {start}, None
    for _ in range(LONGEST_WALK):
        following = []
        for gateway in level:
            place, slot = divmod(gateway, slots)
            ways = sorted((other - gateway) % slots for other in told.star(place).face)
            for turn in ways:
                way = place * slots + (slot + turn) % slots
                end = links.get(way)
                if end is None:
                    out = gateway, turn
                    break
                if end not in seen:
                    seen.add(end)
                    reached[end] = gateway, turn
                    following.append(end)
            if out is not None:
                break
        if out is not None or not following:
            break
        level = following
    else:
        return None
    turns: list[int] = []
    while out is not None:
        gateway, turn = out
        turns.append(turn)
        out = reached.get(gateway)
    turns.reverse()
    predicted = predict(standing_of(told, living), turns)
    kind = "pending" if turns else "settled"
    return Plan(kind, tuple(turns), None, 1, True, None, (predicted,), ((0,),), ())


def _next(made: Plan, record: Record, status: Status) -> str:
    assert record.slots is not None
    told, every = [words.direction(turn, record.slots) for turn in made.turns], status.all_best
    if status.step == 0 and told:  # the agent arrived by no gateway, so there is no way back
        told[0] = "by the gateway where it stands" if made.turns[0] == 0 else ""
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
