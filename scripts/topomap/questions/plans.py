"""A further walk, as lines to read and as JSON."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from topomap.model import words
from topomap.model.experience import Experience
from topomap.model.found import steps_json
from topomap.model.topology import gid
from topomap.questions.candidates import Candidates
from topomap.questions.explore import Plan, Untold
from topomap.questions.standings import Prediction

MOST_GROUPS, MOST_PAIRS, LONGEST = 6, 12, 24  # the largest numbers of items in words
FAULTS = {
    "steps": "no walk of at most {steps} steps does better, a longer one may",
    "effort": "longer walks may do better",
    "maps": "not all of the maps were looked at when the walk was chosen",
}


@dataclass(frozen=True)
class Planned:
    """A plan for the maps in question.

    The agent may carry a ``marker``, and walks at most ``steps`` steps.
    """

    among: Candidates
    plan: Plan
    marker: bool
    steps: int

    @property
    def fault(self) -> str | None:
        """Why the maps may not be all, or the walk may not be the best; or None."""
        return self.among.fault or self.plan.fault

    @property
    def kind(self) -> str | None:
        """What the walk is for, or why there is none; None if that is open."""
        if self.plan.kind == "settled":
            return self.plan.kind if self.among.every else None
        return self.plan.kind if self.plan.turns or self.plan.kind == "bisimilar" else None

    def lines(self) -> Iterator[str]:
        """The answer as lines to read."""
        made = self.plan
        yield self.among.words()
        if made.turns:
            yield from _walk(self.among.experience, made)
        yield _verdict(self.among.each[0].of, len(self.among.each), made, self.among.every)
        for pair in made.untold[:MOST_PAIRS]:
            yield f"maps {pair.one + 1} and {pair.other + 1}: {_why(pair)}"
        if len(made.untold) > MOST_PAIRS:
            yield f"and {words.number(len(made.untold) - MOST_PAIRS, 'more pair')}: see --json"
        if 0 < (told := self.among.experience.compass_told()) <= self.among.experience.steps:
            visits = words.number(self.among.experience.steps + 1, "visit")
            yield f"the compass is left out of the plan: it is known at {told} of {visits}"
        if self.fault:
            why = FAULTS.get(self.fault, "").format(steps=self.steps)
            yield f"partial: {self.fault}{f'; {why}' * bool(why)}"

    def document(self) -> dict[str, Any]:
        """The answer as JSON; maps are numbered from 1."""
        made = self.plan
        return {
            "slots": self.among.experience.slots,
            "maps": [{"at": steps_json(one.at), "of": one.of} for one in self.among.each],
            "marker": self.marker,
            "kind": self.kind,
            "turns": made.turns,
            "drop": made.drop,
            "left": made.left,
            "proved": made.proved,
            "predictions": [[_seen(one) for one in row] for row in made.predictions],
            "classes": [[number + 1 for number in same] for same in made.classes],
            "untold": [
                {
                    "map_numbers": [pair.one + 1, pair.other + 1],
                    "why": pair.why,
                    "open": pair.open,
                    "related": pair.related,
                }
                for pair in made.untold
            ],
        }


def _seen(one: Prediction | None) -> dict[str, Any] | None:
    if one is None:
        return None
    told: dict[str, Any] = {"view": sorted(one.view), "landmarks": sorted(one.landmarks)}
    told["marker"] = one.marker
    if one.straight is not None:
        told["straight"] = _pairs(one)
    return told if one.compass is None else {**told, "compass": one.compass}


def _pairs(one: Prediction) -> list[tuple[int, int]]:
    """The pairs of gateways on one path, each with the lower slot first."""
    return sorted(pair for pair in one.straight or () if pair[0] < pair[1])


def _walk(experience: Experience, made: Plan) -> Iterator[str]:
    """Describe the walk, and what the maps predict of it."""
    groups: dict[tuple[Prediction | None, ...], list[int]] = {}
    for number, row in enumerate(made.predictions, 1):
        groups.setdefault(row, []).append(number)
    shown = list(groups.items())[:MOST_GROUPS]
    names = [f"{words.plural(len(same), 'map')} {words.listed(same, 4)}" for _, same in shown]
    table = [["step", "turn", *names]]
    for step, turn in enumerate(made.turns):
        if made.drop == step:
            table.append(["", "put the marker down", *[""] * len(names)])
        table.append(
            [str(step + 1), _turn(experience, step, turn), *(_cell(r[step]) for r, _ in shown)]
        )
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for line in table:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        yield "  ".join(cells).rstrip()
    if len(groups) > MOST_GROUPS:
        more = words.number(len(groups) - MOST_GROUPS, "more group")
        yield f"and {more} of maps that predict something else: see --json"


def _turn(experience: Experience, step: int, turn: int) -> str:
    """Describe a turn, by its number and in words."""
    slots = experience.slots
    if step == 0 and experience.steps == 0:
        return f"{turn} leave{' by the gateway where it stands' * (turn == 0)}"
    return f"{turn} {words.direction(turn, slots).partition(' (')[0]}"


def _cell(one: Prediction | None) -> str:
    """Describe what is seen.

    It has the gateways clockwise from the one of the arrival, the landmarks, the marker, where that
    gateway points by the compass, and which gateways are on one path.
    """
    if one is None:
        return "-"
    seen = " ".join(map(str, sorted(one.view)))
    signs = [words.signs(one.landmarks)] if one.landmarks else []
    north = [] if one.compass is None else [f"compass {one.compass}"]
    pairs = " ".join(f"{one}-{other}" for one, other in _pairs(one))
    paths = [f"paths {pairs}"] if pairs else []
    return ", ".join([words.short(seen, LONGEST), *signs, *["marker"] * one.marker, *north, *paths])


def _verdict(kind: str, many: int, made: Plan, every: bool) -> str:
    """Say what the walk achieves; ``kind`` is that of the first map."""
    if made.kind == "settled":
        if every:
            return f"settled: the only map that is {kind}, and it is closed"
        return "the map is closed; whether it is the real one is open: others were not looked at"
    if made.kind == "bisimilar":
        which = "the maps" if every else "these maps"
        return f"no walk can ever tell {which} apart, and no gateway is pending"
    if made.kind == "apart":
        if not made.turns:
            return "a walk that tells the maps apart is not found yet"
        best = "; no walk leaves fewer, none as few sooner" if made.proved else ""
        return f"left in the worst case: {made.left:,} of {many:,} maps{best}"
    if not made.turns:
        return "a walk to a pending gateway is not found yet"
    off = sum(row[-1] is None for row in made.predictions)
    why = f"in {off:,} of {many:,} maps" if many > 1 else "in the map"
    told = many > 1 and made.proved
    apart = "no walk leaves fewer maps in the worst case; " if told else ""
    return f"{apart}it leads to what is not known: through a pending gateway {why}"


def _why(pair: Untold) -> str:
    """Say why the walk does not tell two maps apart."""
    if pair.why == "walk":
        return "another walk tells them apart"
    proof = f"{words.number(len(pair.related), 'pair')} of dstates, checked"
    if pair.why == "bisimilar":
        return f"no walk can ever tell them apart: a bisimulation of {proof}"
    of = []
    for number, gateways in zip((pair.one, pair.other), pair.open, strict=True):
        if gateways:
            more = " and more" * (len(gateways) > 4)
            of.append(f"{', '.join(map(gid, gateways[:4]))}{more} of map {number + 1}")
    told = "no walk tells them apart by what both predict"
    return f"{told} ({proof}); pending: {'; '.join(of)}"
