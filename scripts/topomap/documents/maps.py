"""Maps that anyone made, read from JSON, and what is said of them held against ``at``.

Read: what ``topomap solve --json`` writes, or ``generate --truth``; what ``clingo --outf=2``
writes; or a list of maps. A map needs only ``at``, ``[[T,P,S], ...]``.
"""

import json
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from clingo import parse_term

from topomap.documents.check import STEP_RULES, At, Grown, Violation, by_definition, by_rules
from topomap.model import words
from topomap.model.experience import DState, Experience, Misread
from topomap.model.found import UNPROVED
from topomap.model.topology import Gateway, TopologicalMap
from topomap.model.vocabulary import PARTS, PROPERTIES
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import text
from topomap.runtime.limits import LARGEST
from topomap.solver.solving import misreadings

MOST_BYTES = 2**32
LONGER = 10  # times as many dstates as steps: no map of the experience
_AT = re.compile(r"at\((-?\d+),(-?\d+),(-?\d+)\)", re.ASCII)
BEST_FIRST = "closed, best-first"
KINDS = ("consistent", "best", "optimal", "best so far", BEST_FIRST, UNPROVED)
BEST = ("optimal", "best so far")  # what --optimal gives


@dataclass(frozen=True)
class Document:
    """Maps, and what is said of all of them; ``where`` names it in messages. Of clingo's answers
    (``by_clingo``) those numbered in ``worse``, from 0, cost more than others."""

    where: str
    maps: list[dict[str, Any]]
    claims: dict[str, Any] = field(default_factory=dict)
    by_clingo: bool = False
    worse: frozenset[int] = frozenset()

    @property
    def kind(self) -> str:
        """What the maps are said to be, if anything is."""
        kind = str(self.claims.get("kind") or "")
        unproved = self.claims.get("proved") is False and kind != BEST_FIRST
        return UNPROVED if unproved else kind

    @property
    def whole(self) -> bool:
        """Whether the maps are said to be all of their kind, and may be: none was taken away,
        and the search was no best-first one, which ends at the first map that it finds."""
        if self.kind in (BEST_FIRST, UNPROVED):
            return False
        count = self.claims.get("count", len(self.maps))
        return bool(self.claims.get("complete", False)) and count == len(self.maps)

    @property
    def best(self) -> list[tuple[int, dict[str, Any]]]:
        """The maps, by number from 1, but for those that cost more than others."""
        return [one for one in enumerate(self.maps, 1) if one[0] - 1 not in self.worse]

    def demands(self) -> Iterator[str]:
        """What the maps are said to have, as terms of ``check.lp``."""
        for part in self.claims.get("parts", ()):
            if part == "euler":
                yield "planar"
            elif part in PROPERTIES:
                yield part
        if self.claims.get("bound") is not None:
            yield f"bound({self.claims['bound']})"
        if self.claims.get("optimal"):
            yield "boundary"
        if self.claims.get("kind") in ("optimal", BEST_FIRST):
            yield "closed"


def read(path: str, most: int = MOST_BYTES) -> list[Document]:
    """The maps in a file of ``most`` bytes at most. Raises InputError, one line, where it
    holds something else."""
    return parse(text(path, most), path)


def parse(content: str, path: str) -> list[Document]:
    """The maps in a text; ``path`` names it in errors."""
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise InputError(
            f"{path}: not a JSON text, as topomap solve --json and clingo --outf=2 write it"
        ) from None
    formats.demand(path, data)
    if isinstance(data, dict) and "Call" in data:
        return [_of_clingo(path, data)]
    documents = data["results"] if isinstance(data, dict) and "results" in data else [data]
    if not isinstance(documents, list):
        raise InputError(f"{path}: results: no list")
    many = len(documents) > 1
    return [
        document(f"{path}: result {number}" if many else path, one)
        for number, one in enumerate(documents, 1)
    ]


def document(where: str, data: Any) -> Document:
    """The maps in what ``solve --json`` writes. Raises InputError, one line."""
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
        raise InputError(f"{where}: count is {claims['count']}, there are no maps")
    for number, entry in enumerate(data["maps"], 1):
        if not isinstance(entry, dict) or not _is_at(entry.get("at")):
            raise InputError(f"{where}: map {number}: at is not a list [[T,P,S], ...] of numbers")
    return Document(where, data["maps"], claims)


def _is_number(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) <= LARGEST


def _is_list_of(kind: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and all(map(kind, value))


def _is_number_or_none(value: object) -> bool:
    return value is None or _is_number(value)


def _is_text(value: object) -> bool:
    return value is None or isinstance(value, str)


def _is_truth(value: object) -> bool:
    return isinstance(value, bool)


CLAIMS: dict[str, Callable[[Any], bool]] = {
    "instance": _is_text,
    "slots": _is_number,
    "parts": _is_list_of(lambda part: isinstance(part, str) and part in PARTS),
    "bound": _is_number_or_none,
    "horizon": _is_number_or_none,
    "optimal": _is_truth,
    "noise": lambda value: value is None or (_is_number(value) and value >= 0),
    "kind": lambda kind: kind is None or kind in KINDS,
    "count": _is_number,
    "cost": _is_list_of(_is_number),
    "proved": _is_truth,
    "nodes": lambda value: _is_number(value) and value > 0,
    "complete": _is_truth,
    "fault": _is_text,
}


def _is_at(at: object) -> bool:
    return isinstance(at, list) and all(
        isinstance(dstate, list) and len(dstate) == 3 and all(map(_is_number, dstate))
        for dstate in at
    )


def of_instance(documents: list[Document], instance: str) -> list[Document]:
    """Those of an instance, by the name of its file, where there are several."""
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
    """The dstate after each step of ``at``, ``[[T,P,S], ...]``, if it breaks none of the rules of
    ``check.lp`` (of all, unless told). Raises InputError, one line, where it does."""
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
            # Under optimisation clingo gives the first of the best maps twice, if asked for all.
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
    least = min(costs, default=[])
    worse = frozenset(number for number, cost in enumerate(costs) if cost != least)
    fault = _lacking(data, len(maps) - len(worse), again)
    return Document(path, maps, formats.ended(fault), True, worse)


def _lacking(data: dict[str, Any], many: int, again: bool) -> str | None:
    """Why so many answers of clingo may not be all that there are, if so; ``again``: one of the
    best ones was given twice."""
    models = data.get("Models")
    models = models if isinstance(models, dict) else {}
    if models.get("More") != "no" or {"Brave", "Cautious"} & models.keys():
        return "clingo was not asked for all, or did not end"
    optimal = models.get("Optimal")
    if optimal is None:
        return None if models.get("Number") == many else "clingo did not print all"
    # Without --opt-mode=optN it ends at the first best answer, and tells of one in the same words.
    if models.get("Optimum") != "yes" or optimal != many or not (again or optimal > 1):
        return "clingo was not asked for all of the best"
    return None


@dataclass(frozen=True)
class Verdict:
    """What is wrong with a map: rules broken, with steps, and other faults in words."""

    where: str
    violations: list[Violation]
    faults: list[str]
    short: bool = False  # the map is of part of the steps

    @property
    def sound(self) -> bool:
        return not self.violations and not self.faults


def verdicts(
    seen: Experience,
    documents: list[Document],
    demands: Sequence[str],
    truth: TopologicalMap | None,
    noise: int | None = None,
) -> Iterator[Verdict]:
    """A verdict on each map, by ``check.lp`` and by definition, of what was seen but for what
    the map says was misread: after ``noise`` steps at most, and as many as its document allows.
    Raises InputError if one is much longer than the experience."""
    for document in documents:
        for number, entry in enumerate(document.maps, 1):
            if len(entry["at"]) > LONGER * (seen.steps + 1):
                fault = f"at has {len(entry['at'])} dstates, the instance {seen.steps + 1}"
                raise InputError(f"{document.where}: map {number}: {fault}")
    for document in documents:
        wanted = sorted({*demands, *document.demands()})
        numbers: dict[tuple[At, frozenset[Misread]], int] = {}
        bounds = [k for k in (noise, document.claims.get("noise")) if k is not None]
        for number, entry in enumerate(document.maps, 1):
            at = tuple(sorted((step, place, slot) for step, place, slot in entry["at"]))
            rules: set[Violation] = set()
            definition: set[Violation] = set()
            found = []
            try:
                misread = misread_of(seen, entry)
                experience = seen.corrected(misread)
                found = list(_mistaken(experience, misread, len(at), min(bounds, default=None)))
            except (LookupError, TypeError, ValueError):
                misread, found = frozenset(), ["misread: not what topomap solve --json writes"]
            if not found:
                rules = by_rules(experience, at, wanted)
                definition = by_definition(experience, at, wanted)
            if not found and not STEP_RULES & {rule for rule, _ in rules | definition}:
                found = list(faults(experience, document, entry, at))
                if rules != definition:
                    found.append("check.lp and the check by definition do not agree on it")
                if truth and "real" in entry:
                    real = experience.map_of(tuple((p, s) for _, p, s in at)).isomorphic(truth)
                    if real != entry["real"]:
                        found.append(f"real: it is {'not ' * (not real)}the real map")
            if numbers.setdefault((at, misread), number) != number:
                found.append(f"the same as map {numbers[at, misread]}")
            violations = sorted(rules | definition, key=lambda violation: violation[::-1])
            said = document.claims.get("count", len(document.maps))
            if number == 1 and said != len(document.maps):
                found.append(f"count is {said}, there are {len(document.maps)} maps")
            if truth is None and "real" in entry:
                found.append("real: only --truth can tell")
            short = len(at) <= seen.steps
            yield Verdict(f"{document.where}: map {number}", violations, found, short)


def misread_of(seen: Experience, entry: dict[str, Any]) -> frozenset[Misread]:
    """What a map says was misread. Raises a LookupError, TypeError or ValueError where it cannot
    be."""
    said = entry.get("misread", [])
    signs = frozenset[str]().union(*seen.landmarks)
    found: set[Misread] = set()
    for one in _list(said):
        what = one["gateway"] if "gateway" in one else one["landmark"]
        step, gateway = one["step"], "gateway" in one
        known = range(seen.slots) if gateway else signs
        views = seen.views if gateway else seen.landmarks
        if not (_is_number(step) and step >= 0 and what in known) or isinstance(what, bool | float):
            raise ValueError
        if one.keys() - {"seen"} != {"step", "gateway" if gateway else "landmark"}:
            raise ValueError
        if "seen" in one and one["seen"] is not (what in views[step]):
            raise ValueError
        found.add((step, what))
    if len(found) < len(said):
        raise ValueError
    return frozenset(found)


def _mistaken(
    corrected: Experience, misread: frozenset[Misread], steps: int, most: int | None
) -> Iterator[str]:
    """What is wrong with what is said to be misread, in a map of so many steps."""
    wrong = {step for step, _ in misread}
    if wrong and most is None:
        yield "misread: it is not said how many views may be wrong (noise)"
    elif len(wrong) > (most or 0):
        yield f"misread: {words.number(len(wrong), 'view')}, more than {most}"
    if late := [step for step in wrong if step >= steps]:
        yield f"misread: step {min(late)} is not in at"
    if left := corrected.cut(max(0, steps - 1)).misled():
        yield f"misread: the agent still stands at no gateway or leaves by none, step {left[0]}"


def faults(
    experience: Experience, document: Document, entry: dict[str, Any], at: At
) -> Iterator[str]:
    """What is said of a map, by itself or with the others, and does not follow from ``at``."""
    grown = Grown(experience, {step: (place, slot) for step, place, slot in at}, len(at) - 1)
    for key, said in entry.items():
        if key in ("at", "real", "misread"):
            continue
        if key not in KEYS:
            yield f"{key}: no such key of a map"
            continue
        try:
            same = KEYS[key](grown, experience, said)
        except (LookupError, TypeError, ValueError):
            same = False
        if not same:
            yield f"{key}: not what at says"
    claims = document.claims
    last = claims.get("horizon")
    if "horizon" in claims and grown.step != (
        experience.steps if last is None else min(last, experience.steps)
    ):
        yield f"horizon: at ends after step {grown.step}"
    cost = _noise(entry, claims) + _cost(grown, claims)
    if "cost" in claims and claims["cost"] != cost:
        yield f"cost: it is {cost}"


def _noise(entry: dict[str, Any], claims: dict[str, Any]) -> list[int]:
    """How many views are wrong, and how much was misread, if that was minimised."""
    misread = entry.get("misread", [])
    return [] if claims.get("noise") is None else [len({m["step"] for m in misread}), len(misread)]


def _cost(grown: Grown, claims: dict[str, Any]) -> list[int]:
    """What was minimised, most important first."""
    parts = claims.get("parts", ())
    minimal = "minimal" in parts or claims.get("optimal") or claims.get("kind") == BEST_FIRST
    genus = [grown.genus()] if "genus" in parts else []
    return genus + ([len(grown.paths()), len(grown.stars)] if minimal else [])


def _places(grown: Grown, experience: Experience, said: Any) -> bool:
    def in_order(places: Any) -> list[dict[str, Any]]:
        numbers = (number for place in places for number in (place["place"], *place["gateways"]))
        if not all(map(_is_number, numbers)):
            raise ValueError
        lists = ("gateways", "landmarks")
        ordered = [{**place, **{key: sorted(place[key]) for key in lists}} for place in places]
        return sorted(ordered, key=lambda place: int(place["place"]))

    ours = [
        {"place": place, "gateways": star, "landmarks": list(experience.landmarks[place])}
        for place, star in grown.stars.items()
    ]
    return in_order(_list(said)) == in_order(ours)


def _links(grown: Grown, _: Experience, said: Any) -> bool:
    ours = {tuple(sorted(link)) for link in grown.links.items()}
    return sorted(tuple(sorted(_gateways(link))) for link in _list(said)) == sorted(ours)


def _paths(grown: Grown, _: Experience, said: Any) -> bool:
    return sorted(grown.one_way(_gateways(path)) for path in _list(said)) == grown.paths()


def _faces(grown: Grown, _: Experience, said: Any) -> bool:
    def from_least(face: list[Gateway]) -> list[Gateway]:
        start = face.index(min(face)) if face else 0
        return face[start:] + face[:start]

    ours = sorted(map(from_least, grown.faces()))
    return sorted(from_least(_gateways(face)) for face in _list(said)) == ours


def _list(said: Any) -> list[Any]:
    if not isinstance(said, list):
        raise ValueError
    return said


def _gateways(said: Any) -> list[Gateway]:
    return [_gateway(gateway) for gateway in _list(said)]


def _gateway(said: Any) -> Gateway:
    place, slot = _list(said)
    if not (_is_number(place) and _is_number(slot)):
        raise ValueError
    return place, slot


KEYS: dict[str, Callable[[Grown, Experience, Any], bool]] = {
    "places": _places,
    "links": _links,
    "paths": _paths,
    "faces": _faces,
    "genus": lambda grown, _, said: _is_number(said) and grown.genus() == said,
    "pending": lambda grown, _, said: sorted(_gateways(said)) == sorted(grown.pending()),
    "dstate": lambda grown, _, said: _gateway(said) == grown.dstate,
}
