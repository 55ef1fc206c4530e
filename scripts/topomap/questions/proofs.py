"""Proofs that no walk tells maps apart, which a file keeps and no solver is needed to check."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from topomap.documents import bisimulation, check, maps
from topomap.documents.beginnings import beginning
from topomap.documents.bisimulation import Chart, Pair
from topomap.model import words
from topomap.model.experience import DState, Experience
from topomap.model.found import steps_json
from topomap.model.reply import Reply
from topomap.questions.plans import Planned
from topomap.runtime import files, formats
from topomap.runtime.errors import InputError


def proofs(planned: Planned) -> dict[str, Any]:
    """The proofs of a plan, as a document that ``check_proofs`` accepts."""
    return {
        "horizon": planned.among.experience.steps,
        "marker": planned.marker,
        "maps": [{"at": steps_json(one.at)} for one in planned.among.each],
        "proofs": [
            {
                "map_numbers": [pair.one + 1, pair.other + 1],
                "why": pair.why,
                "related": pair.related,
            }
            for pair in planned.plan.untold
            if pair.related
        ],
    }


@dataclass(frozen=True, repr=False)
class Checked(Reply):
    """The result of checking ``proofs`` proofs: a line for each that is ``wrong``.

    They are about the first ``steps`` of ``whole`` steps.
    """

    proofs: int
    wrong: tuple[str, ...]
    steps: int
    whole: int
    fault: None = None  # a check takes very little time, so it is never cut short

    def lines(self) -> Iterator[str]:
        """The result as the lines that ``topomap explore --check`` prints."""
        first = f", of the first {self.steps} of {self.whole} steps"
        of = first * (self.steps < self.whole)
        told = f"{words.number(self.proofs, 'proof')}, {len(self.wrong) or 'none'} wrong{of}"
        yield from self.wrong
        yield told

    def document(self) -> dict[str, Any]:
        """The result as ``topomap explore --check --json`` writes it."""
        return {"proofs": self.proofs, "wrong": list(self.wrong)}


def check_proofs(path: str, experience: Experience) -> Checked:
    """Check the proofs in a file, which are about an experience or its first steps.

    Raises:
        InputError: There are no proofs in it. One line.
    """
    try:
        data = json.loads(files.read_text(path, maps.MOST_BYTES_OF_MAPS))
        formats.demand(path, data)
        marker, proofs, steps = data["marker"], data["proofs"], data["horizon"]
        kinds = isinstance(marker, bool), isinstance(proofs, list), type(steps) is int
        if not all(kinds) or not 0 <= steps <= experience.steps:
            raise ValueError
    except (ValueError, LookupError, TypeError, RecursionError):
        raise InputError(f"{path}: not what topomap explore --proof writes") from None
    whole, experience = experience.steps, experience.cut(steps)
    document = maps.document(path, {"maps": data.get("maps")})
    charts = []
    lying = experience.put_down()
    for number, entry in enumerate(document.maps, 1):
        at = beginning(f"{path}: map {number}", entry["at"], experience, experience)
        grown = check.Grown(experience, dict(enumerate(at)), experience.steps)
        landmarks = {place: experience.landmarks[place] for place in grown.stars}
        for name in lying.keys() - {None}:
            landmarks[at[lying[name]][0]] |= {f"marker({name})"}
        lies = at[lying[None]][0] if None in lying else None
        # A compass counts only if each visit has one.
        slots = [slot for slot in experience.compass if slot is not None]
        north = {place: slots[place] for place, _ in at} if len(slots) == len(at) else {}
        rest = landmarks, lies, north, experience.across(grown.stars)
        charts.append(Chart(experience.slots, grown.stars, grown.links, at[-1], *rest))
    wrong = []
    for number, proof in enumerate(proofs, 1):
        one, other, why, related = _proof_of(f"{path}: proof {number}", proof, charts)
        found = list(bisimulation.faults(one, other, related, marker))
        if not found and why == "bisimilar" and any(bisimulation.pending(one, other, related)):
            found.append("it comes to a pending gateway, so a later walk may tell them apart")
        wrong += [f"{path}: proof {number}: {fault}" for fault in found[:1]]
    return Checked(len(proofs), tuple(wrong), steps, whole)


def _proof_of(
    where: str, proof: Any, charts: Sequence[Chart]
) -> tuple[Chart, Chart, str, list[Pair]]:
    """Read a proof of a file.

    Raises:
        InputError: It is not a proof.
    """

    def number(value: Any) -> int:
        """Read a number."""
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError
        return value

    def dstate(value: Any) -> DState:
        """Read a dstate."""
        place, slot = value
        return number(place), number(slot)

    try:
        first, second = (number(which) for which in proof["map_numbers"])
        if not 1 <= first < second <= len(charts):
            raise ValueError
        if proof["why"] not in ("bisimilar", "pending"):
            raise ValueError
        related: list[Pair] = []
        for one, other, (a, b) in proof["related"]:
            lies = None if a is None else number(a), None if b is None else number(b)
            related.append((dstate(one), dstate(other), lies))
    except (ValueError, LookupError, TypeError):
        raise InputError(f"{where}: not what topomap explore --proof writes") from None
    return charts[first - 1], charts[second - 1], proof["why"], related
