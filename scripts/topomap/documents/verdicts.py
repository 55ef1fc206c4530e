"""What is wrong with maps, by two checkers, and whether what is said about them is true."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from topomap.documents.check import (
    NO_PATH_AXIOM,
    PATH_RULES,
    STEP_RULES,
    At,
    Grown,
    Violation,
    by_definition,
    by_rules,
)
from topomap.documents.maps import (
    BEST_FIRST,
    LONGER,
    Document,
    is_number,
    list_of,
    misread_of,
)
from topomap.model import words
from topomap.model.exceptions import NamedException, exceptions_of
from topomap.model.experience import DState, Experience, Misread
from topomap.model.found import BEST
from topomap.model.reply import Reply
from topomap.model.topology import Gateway, TopologicalMap
from topomap.model.vocabulary import PROPERTIES
from topomap.runtime.errors import InputError

PATH_AXIOM = "path axiom"
RULES_OF = {PATH_AXIOM: PATH_RULES, **{part: (part,) for part in PROPERTIES}}  # by axiom


@dataclass(frozen=True)
class Axioms:
    """Which of the axioms and defaults of the theory a map ``breaks``.

    Each comes with the violations that show it. It also has the genus and the number of pending
    gateways.
    """

    breaks: dict[str, list[Violation]]
    genus: int
    pending: int

    @property
    def keeps(self) -> list[str]:
        """The axioms and defaults that the map does not break."""
        return [one for one in RULES_OF if one not in self.breaks]

    @property
    def words(self) -> str:
        """All of them in words, such as "breaks closed (3 pending); keeps path axiom, planar"."""
        details = {"planar": f" (genus {self.genus})", "closed": f" ({self.pending} pending)"}
        told = ", ".join(f"{r} after step {step}" for r, step in self.breaks.get(PATH_AXIOM, ()))
        details[PATH_AXIOM] = f" ({told})"
        broken = ", ".join(f"{name}{details.get(name, '')}" for name in self.breaks)
        return f"breaks {broken or 'none'}; keeps {', '.join(self.keeps) or 'none'}"

    def document(self) -> dict[str, Any]:
        """All of them as JSON."""
        return {
            "breaks": self.breaks,
            "keeps": self.keeps,
            "genus": self.genus,
            "pending": self.pending,
        }


def axioms(grown: Grown, violations: Iterable[Violation]) -> Axioms:
    """Find out which axioms and defaults a map breaks.

    ``violations`` are all that there are if each part is demanded of the map.
    """
    found = [*violations]
    broken = {
        name: _by_step(one for one in found if one[0] in some) for name, some in RULES_OF.items()
    }
    breaks = {name: each for name, each in broken.items() if each}
    return Axioms(breaks, grown.genus(), len(grown.pending()))


def axioms_of(experience: Experience, at: Sequence[DState]) -> Axioms:
    """Find out by definition which axioms and defaults a hypothesis breaks.

    It is given by its dstate after each step.
    """
    steps = [(step, *dstate) for step, dstate in enumerate(at)]
    grown = Grown(experience, dict(enumerate(at)), len(steps) - 1)
    return axioms(grown, by_definition(experience, steps, PROPERTIES))


@dataclass(frozen=True)
class Verdict:
    """What is wrong with a map: the rules that are broken, with steps, and other faults in words.

    If its steps break no rule, it may say which ``axioms`` and defaults the map breaks, and
    which ``exceptions`` to consistent boundaries it has; None means that this is not known.
    """

    where: str
    violations: list[Violation]
    faults: list[str]
    short: bool = False  # the map is of a part of the steps only
    axioms: Axioms | None = None
    exceptions: list[NamedException] | None = None

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong."""
        return not self.violations and not self.faults

    def document(self) -> dict[str, Any]:
        """What is wrong, as JSON."""
        keys = ("where", "violations", "faults", "short")
        return {key: getattr(self, key) for key in keys}

    def told(self) -> dict[str, Any]:
        """What else is known of the map, as JSON."""
        told: dict[str, Any] = {
            "where": self.where,
            **(self.axioms.document() if self.axioms else {}),
        }
        if self.exceptions is not None:
            told["exceptions"] = [one.document() for one in self.exceptions]
        return told

    def lines(self) -> Iterator[str]:
        """What is wrong, and what else is known, as lines to read."""
        if not self.sound:
            broken = [f"violation({rule},{step})" for rule, step in self.violations]
            yield f"{self.where}: {'; '.join(broken + self.faults)}"
        if self.axioms:
            yield f"{self.where}: {self.axioms.words}"
        if self.exceptions:
            many = words.number(len(self.exceptions), "exception")
            yield f"{self.where}: {many} to consistent boundaries"
            for one in self.exceptions:
                yield f"  {one.words}"


@dataclass(repr=False)
class Judged(Reply):
    """The verdicts on ``count`` maps of an experience of ``steps`` steps.

    ``demands`` has the demands on the maps. ``fault`` says why not all maps were judged, or is
    None. In an ``if`` it is true when all were judged, and none is unsound.
    """

    count: int
    steps: int
    demands: list[str]
    verdicts: list[Verdict] = field(default_factory=list)
    fault: str | None = None

    @property
    def unsound(self) -> list[Verdict]:
        """The verdicts on the maps with which something is wrong."""
        return [verdict for verdict in self.verdicts if not verdict.sound]

    def __bool__(self) -> bool:
        return self.complete and not self.unsound

    @property
    def short(self) -> int:
        """The number of maps that are of a part of the steps."""
        return sum(verdict.short for verdict in self.verdicts)

    def document(self) -> dict[str, Any]:
        """The verdicts as ``topomap check --json`` writes them."""
        return {
            "demands": self.demands,
            "unsound": [verdict.document() for verdict in self.unsound],
            "judged": [one.told() for one in self.verdicts if one.exceptions is not None],
            "checked": len(self.verdicts),
            "short": self.short,
            "count": self.count,
        }

    def lines(self) -> Iterator[str]:
        """The verdicts as the lines that ``topomap check`` prints."""
        for verdict in self.verdicts:
            yield from verdict.lines()
        many = words.number(self.count, "map").replace(",", "")
        line = f"{len(self.verdicts)} of {many} checked" if self.fault else many
        line += f", {len(self.unsound) or 'none'}{' of these' * bool(self.fault)} unsound"
        if self.short:
            line += f"; {self.short} of them for only part of the {self.steps} steps"
        yield line + (f"; partial: {self.fault}" if self.fault else "")


def verdicts(
    seen: Experience,
    documents: list[Document],
    demands: Sequence[str],
    truth: TopologicalMap | None,
    noise: int | None = None,
    every: bool = False,
) -> Iterator[Verdict]:
    """Judge each map by ``check.lp`` and by definition.

    A map is compared with what was seen, corrected by what the map says was misread: after at most
    ``noise`` steps, and at most as many as its document allows. With ``every`` the verdict says for
    each axiom and default whether the map breaks it. Breaking one is then not a violation, unless
    it is among the ``demands``, or the document says that the map does not.

    Raises:
        InputError: A map is much longer than the experience.
    """
    for document in documents:
        for number, entry in enumerate(document.maps, 1):
            if len(entry["at"]) > LONGER * (seen.steps + 1):
                fault = f"at has {len(entry['at'])} dstates, the instance {seen.steps + 1}"
                raise InputError(f"{document.where}: map {number}: {fault}")
    for document in documents:
        wanted = {*demands, *document.demands()}
        if every and "parts" not in document.claims:
            wanted.add(NO_PATH_AXIOM)
        asked = {*wanted, *PROPERTIES} - {NO_PATH_AXIOM} if every else wanted
        kept = {*STEP_RULES, *wanted, *(() if NO_PATH_AXIOM in wanted else PATH_RULES)}
        named = every or "boundary" in wanted or document.claims.get("kind") in BEST
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
                rules = by_rules(experience, at, sorted(asked))
                definition = by_definition(experience, at, sorted(asked))
            told = exceptions = None
            if not found and not STEP_RULES & {rule for rule, _ in rules | definition}:
                found = list(faults(experience, document, entry, at))
                if rules != definition:
                    found.append("check.lp and the check by definition do not agree on it")
                whole = Grown(experience, {t: (p, s) for t, p, s in at}, len(at) - 1)
                if named:
                    exceptions = exceptions_of(experience, [(p, s) for _, p, s in at])
                    plain = [one.document() for one in exceptions]
                    if not _exceptions(whole, experience, plain):
                        found.append("the exceptions are not those by definition")
                told = axioms(whole, rules | definition) if every else None
                if truth and "real" in entry:
                    real = experience.map_of(tuple((p, s) for _, p, s in at)).isomorphic(truth)
                    if real != entry["real"]:
                        found.append(f"real: it is {'not ' * (not real)}the real map")
            if numbers.setdefault((at, misread), number) != number:
                found.append(f"the same as map {numbers[at, misread]}")
            violations = _by_step(one for one in rules | definition if one[0] in kept)
            said = document.claims.get("count", len(document.maps))
            if number == 1 and said != len(document.maps):
                found.append(f"count is {said}, but there are {len(document.maps)} maps")
            if truth is None and "real" in entry:
                found.append("real: only --truth can tell")
            short = len(at) <= seen.steps
            where = f"{document.where}: map {number}"
            yield Verdict(where, violations, found, short, told, exceptions)


def _by_step(violations: Iterable[Violation]) -> list[Violation]:
    return sorted(violations, key=lambda violation: violation[::-1])


def _mistaken(
    corrected: Experience, misread: frozenset[Misread], steps: int, most: int | None
) -> Iterator[str]:
    """Find what is wrong with what a map of so many steps says was misread."""
    wrong = {step for step, _ in misread}
    if wrong and most is None:
        yield "misread: the file does not say how many views may be wrong (noise)"
    elif len(wrong) > (most or 0):
        yield f"misread: {words.number(len(wrong), 'view')}, more than {most}"
    if late := [step for step in wrong if step >= steps]:
        yield f"misread: step {min(late)} is not in at"
    if left := corrected.cut(max(0, steps - 1)).misled():
        yield f"misread: the agent still stands at no gateway or leaves by none, step {left[0]}"


def faults(
    experience: Experience, document: Document, entry: dict[str, Any], at: At
) -> Iterator[str]:
    """Find what is said about a map, alone or with others, but does not follow from ``at``."""
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
    rests = sorted(experience.starts | experience.looks)
    if "rests" in claims and sorted(claims["rests"]) != rests:
        yield f"rests: they are {rests}"
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
    """What was minimised, the most important number first."""
    parts = claims.get("parts", ())
    optimal = claims.get("optimal", False)
    minimal = "minimal" in parts or optimal or claims.get("kind") == BEST_FIRST
    cost = [grown.genus()] if "genus" in parts else []
    cost += [sum(1 for _ in grown.exceptions())] if "exceptions" in parts or optimal else []
    return cost + ([len(grown.paths()), len(grown.stars)] if minimal else [])


def _places(grown: Grown, experience: Experience, said: Any) -> bool:
    def in_order(places: Any) -> list[dict[str, Any]]:
        """Put the places, their gateways and their landmarks in order."""
        numbers = (number for place in places for number in (place["place"], *place["gateways"]))
        if not all(map(is_number, numbers)):
            raise ValueError
        lists = ("gateways", "landmarks")
        ordered = [{**place, **{key: sorted(place[key]) for key in lists}} for place in places]
        return sorted(ordered, key=lambda place: int(place["place"]))

    ours = [
        {"place": place, "gateways": star, "landmarks": list(experience.landmarks[place])}
        for place, star in grown.stars.items()
    ]
    return in_order(list_of(said)) == in_order(ours)


def _links(grown: Grown, _: Experience, said: Any) -> bool:
    ours = {tuple(sorted(link)) for link in grown.links.items()}
    return sorted(tuple(sorted(_gateways(link))) for link in list_of(said)) == sorted(ours)


def _paths(grown: Grown, _: Experience, said: Any) -> bool:
    forms = grown.forms()
    least = {way: of for form in forms for way, of in form.items()}
    theirs = sorted(least[tuple(_gateways(path))] for path in list_of(said))
    return theirs == sorted(next(iter(form.values())) for form in forms)


def _faces(grown: Grown, _: Experience, said: Any) -> bool:
    def from_least(face: list[Gateway]) -> list[Gateway]:
        """Begin a face at its smallest gateway."""
        start = face.index(min(face)) if face else 0
        return face[start:] + face[:start]

    ours = sorted(map(from_least, grown.faces()))
    return sorted(from_least(_gateways(face)) for face in list_of(said)) == ours


def _exceptions(grown: Grown, _: Experience, said: Any) -> bool:
    def named(name: Any) -> Any:
        """The step that names a path; for one not travelled, its gateway and the opposite."""
        if is_number(name):
            return name
        place, slot = name.split(".")
        return grown.across((int(place), int(slot)))

    def plain(one: Any) -> Any:
        """Convert an exception to numbers and texts."""
        if one.keys() != {"kind", "paths", "places"} or not all(map(is_number, one["places"])):
            raise ValueError
        return one["kind"], frozenset(map(named, one["paths"])), frozenset(one["places"])

    theirs = Counter(map(plain, list_of(said)))
    return theirs == Counter(
        (kind, frozenset(map(grown.name, paths)), frozenset(places))
        for kind, paths, places in grown.exceptions()
    )


def _gateways(said: Any) -> list[Gateway]:
    return [_gateway(gateway) for gateway in list_of(said)]


def _gateway(said: Any) -> Gateway:
    place, slot = list_of(said)
    if not (is_number(place) and is_number(slot)):
        raise ValueError
    return place, slot


KEYS: dict[str, Callable[[Grown, Experience, Any], bool]] = {
    "places": _places,
    "links": _links,
    "paths": _paths,
    "faces": _faces,
    "genus": lambda grown, _, said: is_number(said) and grown.genus() == said,
    "exceptions": _exceptions,
    "pending": lambda grown, _, said: sorted(_gateways(said)) == sorted(grown.pending()),
    "dstate": lambda grown, _, said: _gateway(said) == grown.dstate,
}
