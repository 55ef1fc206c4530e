"""Maps that anyone made: they are read from JSON, with what is said about them.

The file is what ``topomap solve --json`` or ``generate --truth`` writes, what ``clingo --outf=2``
writes, or a list of maps. A map needs only ``at``, ``[[T,P,S], ...]``.
"""

import json
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from clingo import parse_term

from topomap.documents.check import STEP_RULES, by_definition
from topomap.model.experience import DState, Experience, Misread
from topomap.model.found import BEST, UNPROVED
from topomap.model.topology import TopologicalMap
from topomap.model.vocabulary import PARTS, PROPERTIES, RELAXING
from topomap.runtime import files, formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_text
from topomap.runtime.limits import LARGEST
from topomap.solver.defaults import WORDS
from topomap.solver.solving import misreadings

MOST_BYTES_OF_MAPS = 2**32
LONGER = 10  # a map with so many times as many dstates as steps is not of the experience
_AT = re.compile(r"at\((-?\d+),(-?\d+),(-?\d+)\)", re.ASCII)
BEST_FIRST = "closed, best-first"
CIRCUMSCRIBED = ("circumscribed", "circumscribed so far")  # the kinds of the maps of --circumscribe
KINDS = ("consistent", "best", "optimal", "best so far", *CIRCUMSCRIBED, BEST_FIRST, UNPROVED)


@dataclass(frozen=True)
class Document:
    """Maps, and what is said of all of them.

    ``where`` names it in messages. Of clingo's answers (``by_clingo``), those numbered in
    ``worse``, from 0, cost more than others.
    """

    where: str
    maps: list[dict[str, Any]]
    claims: dict[str, Any] = field(default_factory=dict)
    by_clingo: bool = False
    worse: frozenset[int] = frozenset()

    @property
    def kind(self) -> str:
        """What the maps are said to be, or None."""
        kind = str(self.claims.get("kind") or "")
        unproved = self.claims.get("proved") is False and kind != BEST_FIRST
        return UNPROVED if unproved else kind

    @property
    def whole(self) -> bool:
        """Whether the maps are said to be all of their kind, and can be.

        They cannot be if one was removed, or if the search was best-first, which ends at the
        first map that it finds.
        """
        if self.kind in (BEST_FIRST, UNPROVED):
            return False
        count = self.claims.get("count", len(self.maps))
        return bool(self.claims.get("complete", False)) and count == len(self.maps)

    @property
    def best(self) -> list[tuple[int, dict[str, Any]]]:
        """The maps, with their numbers from 1, except those that cost more than others."""
        return [one for one in enumerate(self.maps, 1) if one[0] - 1 not in self.worse]

    def demands(self) -> Iterator[str]:
        """The demands that the maps are said to meet, as terms of ``check.lp``.

        With no_path_axiom they need not meet one.
        """
        for part in self.claims.get("parts", ()):
            if part == "euler":
                yield "planar"
            elif part in (*PROPERTIES, *RELAXING):
                yield part
        if self.claims.get("bound") is not None:
            yield f"bound({self.claims['bound']})"
        if self.claims.get("kind") in ("optimal", BEST_FIRST):
            yield "closed"


def read_maps(path: str, most: int = MOST_BYTES_OF_MAPS) -> list[Document]:
    """Read the maps in a file of at most ``most`` bytes.

    Raises:
        InputError: There is something else in it. One line.
    """
    return parse_maps(read_text(path, most), path)


def parse_maps(content: str, path: str) -> list[Document]:
    """Read the maps in a text; ``path`` names it in errors."""
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise InputError(
            f"{path}: not a JSON text, as topomap solve --json and clingo --outf=2 write it"
        ) from None
    return documents(path, data)


def documents(where: str, data: Any) -> list[Document]:
    """Read the maps in what was read from JSON; ``where`` names it in errors.

    They are of one instance or of several, by topomap or clingo, or a list.

    Raises:
        InputError: There are no maps in it. One line.
    """
    formats.demand(where, data)
    if isinstance(data, dict) and "Call" in data:
        return [_of_clingo(where, data)]
    results = data["results"] if isinstance(data, dict) and "results" in data else [data]
    if not isinstance(results, list):
        raise InputError(f"{where}: results: not a list")
    many = len(results) > 1
    return [
        document(f"{where}: result {number}" if many else where, one)
        for number, one in enumerate(results, 1)
    ]


def document(where: str, data: Any) -> Document:
    """Read the maps in what ``solve --json`` writes.

    Raises:
        InputError: There are no maps in it. One line.
    """
    if isinstance(data, list):
        data = {"maps": data}
    if isinstance(data, dict) and "at" in data:
        data = {"maps": [data]}
    if not isinstance(data, dict) or not isinstance(data.get("maps"), list):
        raise InputError(f"{where}: no maps in it")
    formats.demand(where, data)
    claims = {key: value for key, value in data.items() if key not in ("format", "maps")}
    for key, value in claims.items():
        if key not in CLAIMS:
            raise InputError(f"{where}: {key}: no such key")
        if not CLAIMS[key](value):
            raise InputError(f"{where}: {key}: not what topomap solve --json writes there")
    if "fault" in claims and claims.get("complete") is not (claims["fault"] is None):
        raise InputError(f"{where}: complete and fault contradict each other")
    kind, optimal = claims.get("kind"), claims.get("optimal", False)
    if (kind in BEST and not optimal) or (optimal and kind not in (None, *BEST, UNPROVED)):
        raise InputError(f"{where}: optimal and kind contradict each other")
    if kind == UNPROVED and claims.get("proved"):
        raise InputError(f"{where}: proved and kind contradict each other")
    if not data["maps"] and claims.get("count"):
        raise InputError(f"{where}: count is {claims['count']}, but there are no maps")
    for number, entry in enumerate(data["maps"], 1):
        if not isinstance(entry, dict) or not _is_at(entry.get("at")):
            raise InputError(f"{where}: map {number}: at is not a list [[T,P,S], ...] of numbers")
    return Document(where, data["maps"], claims)


def is_number(value: object) -> bool:
    """Tell whether a value is a whole number that clingo can hold."""
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) <= LARGEST


def _is_list_of(kind: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and all(map(kind, value))


def _is_number_or_none(value: object) -> bool:
    return value is None or is_number(value)


def _is_text(value: object) -> bool:
    return value is None or isinstance(value, str)


def _is_truth(value: object) -> bool:
    return isinstance(value, bool)


CLAIMS: dict[str, Callable[[Any], bool]] = {
    "instance": _is_text,
    "slots": is_number,
    "parts": _is_list_of(lambda part: isinstance(part, str) and part in PARTS),
    "bound": _is_number_or_none,
    "horizon": _is_number_or_none,
    "optimal": _is_truth,
    "circumscribe": _is_truth,
    "noise": lambda value: value is None or (is_number(value) and value >= 0),
    "rests": _is_list_of(is_number),
    "kind": lambda kind: kind is None or kind in KINDS,
    "count": is_number,
    "cost": _is_list_of(is_number),
    "proved": _is_truth,
    "nodes": lambda value: is_number(value) and value > 0,
    "least": _is_list_of(is_number),
    "by": lambda value: value in ("clingo", "search"),
    "in_the_way": _is_list_of(lambda name: isinstance(name, str) and name in WORDS),
    "complete": _is_truth,
    "fault": _is_text,
}


def _is_at(at: object) -> bool:
    return isinstance(at, list) and all(
        isinstance(dstate, list) and len(dstate) == 3 and all(map(is_number, dstate))
        for dstate in at
    )


def noisy(given: list[Document]) -> bool:
    """Tell whether some of the maps are said to be allowed to contradict views."""
    return any(one.claims.get("noise") is not None for one in given)


def of_instance(documents: list[Document], instance: str) -> list[Document]:
    """Select the documents of an instance, by the name of its file, if there are several."""
    if len(documents) == 1:
        return documents
    name = Path(instance).name
    return [one for one in documents if Path(str(one.claims.get("instance"))).name == name]


def hypothesis(
    where: str,
    at: Any,
    experience: Experience,
    demands: Sequence[str] = (),
    rules: Collection[str] | None = None,
) -> tuple[DState, ...]:
    """Check that ``at``, ``[[T,P,S], ...]``, breaks none of the rules of ``check.lp``.

    By default all rules are checked.

    Returns:
        The dstate after each step.

    Raises:
        InputError: It breaks one. One line.
    """
    steps = sorted((step, place, slot) for step, place, slot in at)
    wrong = [
        (step, rule)
        for rule, step in by_definition(experience, steps, demands)
        if rules is None or rule in rules
    ]
    if wrong:
        step, rule = min(wrong)
        raise InputError(f"{where}: step {step}: it breaks the rule {rule} of check.lp")
    return tuple((place, slot) for _, place, slot in steps)


def _of_clingo(path: str, data: dict[str, Any]) -> Document:
    maps = []
    costs: list[list[int]] = []
    again = False
    seen = set()
    try:
        for witness in (w for call in data["Call"] for w in call.get("Witnesses", [])):
            atoms = [_AT.fullmatch(atom) for atom in witness["Value"] if atom[:3] == "at("]
            at = tuple(sorted(tuple(map(int, match.groups())) for match in atoms if match))
            if not all(atoms) or not _is_at([list(dstate) for dstate in at]):
                raise ValueError
            wrong = [parse_term(atom) for atom in witness["Value"] if atom[:8] == "misread("]
            misread = misreadings(atom.arguments for atom in wrong)
            # When clingo optimises and lists all best maps, it gives the first of them twice.
            if "Costs" in witness and (at, misread) in seen:
                again = True
            else:
                kinds = ("gateway" if isinstance(what, int) else "landmark" for _, what in misread)
                said = [{"step": t, k: what} for k, (t, what) in zip(kinds, misread, strict=True)]
                maps.append({"at": at, **({"misread": said} if said else {})})
                costs.append([int(cost) for cost in witness.get("Costs", [])])
            seen.add((at, misread))
    except (LookupError, TypeError, ValueError, AttributeError, RuntimeError):
        raise InputError(f"{path}: not what clingo --outf=2 writes") from None
    # If clingo lists all answers within a bound, it mentions no optimum.
    least = min(costs, default=[])
    listed = isinstance(models := data.get("Models"), dict) and "Optimum" not in models
    worse = frozenset(n for n, cost in enumerate(costs) if cost != least and not listed)
    fault = _lacking(data, len(maps) - len(worse), again)
    return Document(path, maps, formats.ended(fault), True, worse)


def _lacking(data: dict[str, Any], many: int, again: bool) -> str | None:
    """Say why these may not be all answers of clingo, or None.

    ``again`` tells that one of the best answers was given twice.
    """
    models = data.get("Models")
    models = models if isinstance(models, dict) else {}
    if models.get("More") != "no" or {"Brave", "Cautious"} & models.keys():
        return "clingo was not asked for all, or did not end"
    optimal = models.get("Optimal")
    if optimal is None:
        return None if models.get("Number") == many else "clingo did not print all"
    # Without --opt-mode=optN it ends at the first best answer, in the same words.
    if models.get("Optimum") != "yes" or optimal != many or not (again or optimal > 1):
        return "clingo was not asked for all of the best"
    return None


def misread_of(seen: Experience, entry: dict[str, Any]) -> frozenset[Misread]:
    """Read what a map says was misread.

    Raises:
        LookupError: There is no such step or gateway.
        TypeError: Something has another type.
        ValueError: Something has an impossible value.
    """
    said = entry.get("misread", [])
    signs = frozenset[str]().union(*seen.landmarks)
    found: set[Misread] = set()
    for one in list_of(said):
        what = one["gateway"] if "gateway" in one else one["landmark"]
        step, gateway = one["step"], "gateway" in one
        known = range(seen.slots) if gateway else signs
        views = seen.views if gateway else seen.landmarks
        if not (is_number(step) and step >= 0 and what in known) or isinstance(what, bool | float):
            raise ValueError
        if one.keys() - {"seen"} != {"step", "gateway" if gateway else "landmark"}:
            raise ValueError
        if "seen" in one and one["seen"] is not (what in views[step]):
            raise ValueError
        found.add((step, what))
    if len(found) < len(said):
        raise ValueError
    return frozenset(found)


def list_of(said: Any) -> list[Any]:
    """Check that what is said is a list.

    Raises:
        ValueError: It is not a list.
    """
    if not isinstance(said, list):
        raise ValueError
    return said


def real_map(file: str, experience: Experience, horizon: int | None) -> TopologicalMap:
    """Read the real map of an experience from a file that ``generate --truth`` wrote."""
    entries = [entry for document in read_maps(file, files.MOST_BYTES) for entry in document.maps]
    if len(entries) != 1:
        raise InputError(f"{file}: {len(entries)} maps, but the real map must be the only one")
    at = entries[0]["at"]
    if len(at) != experience.steps + 1:
        raise InputError(f"{file}: {len(at) - 1} steps, but the instance has {experience.steps}")
    last = experience.steps if horizon is None else horizon
    return experience.map_of(hypothesis(file, at, experience, rules=STEP_RULES)[: last + 1])
