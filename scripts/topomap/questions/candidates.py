"""The maps among which the real one may be, which a further walk is to tell apart."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from topomap.documents.beginnings import beginning
from topomap.documents.maps import read_maps
from topomap.model import words
from topomap.model.experience import DState, Experience
from topomap.model.found import steps_json
from topomap.model.query import Query
from topomap.model.vocabulary import RELAXING
from topomap.questions.standings import Standing, standing
from topomap.runtime.errors import InputError, printable
from topomap.runtime.near import nearest
from topomap.runtime.watch import Attempt, Watch
from topomap.solver import solving
from topomap.solver.enumeration import best_maps

At = tuple[DState, ...]
PARTS_OF = {
    "optimal": (),
    "closed": ("closed",),
    "perpendicular": ("closed", "perpendicular"),
}  # the kinds of maps, and their parts; best_maps gives the optimal ones
GIVEN = "given"  # the kind of a map that the caller gives


@dataclass(frozen=True)
class Candidate:
    """A map in question: the dstate after each step, and the kind of the map."""

    at: At
    of: str


@dataclass(frozen=True)
class Candidates:
    """The maps in question, each once, in order.

    ``fault`` says why they may not be all. ``every`` tells that there are no others of the kinds
    that were asked for.
    """

    experience: Experience
    each: tuple[Candidate, ...]
    every: bool
    fault: str | None = None

    def standings(self) -> list[Standing]:
        """The maps, each with the dstate of the agent."""
        return [standing(self.experience, one.at) for one in self.each]

    def facts(self, marker: bool = False) -> str:
        """The maps as facts for ``encodings/explore.lp`` and similar programs.

        With ``marker`` the agent carries a marker.
        """
        lines = [self.experience.facts().rstrip()]
        for number, one in enumerate(self.each, 1):
            lines.append(f"% map {number}: {printable(one.of)}")
            at = enumerate(one.at)
            lines.append(" ".join(f"map({number},{t},{place},{slot})." for t, (place, slot) in at))
        return "\n".join(lines) + "\n" + "carried.\n" * marker

    def words(self) -> str:
        """How many there are of each kind."""
        kinds: dict[str, int] = {}
        for one in self.each:
            kinds[one.of] = kinds.get(one.of, 0) + 1
        found = " found so far" * bool(self.fault)
        of = ", ".join(f"{number:,} {printable(kind)}" for kind, number in kinds.items())
        return f"{words.number(len(self.each), 'map')}{found} ({of})"

    def lack(self) -> str:
        """The message if there are no maps."""
        if self.fault:
            return f"no map found yet; partial: {self.fault}"
        return "no such map is consistent with it"


def gather(
    whole: Experience,
    experience: Experience,
    query: Query,
    among: Sequence[str | At],
    watch: Watch,
) -> Candidates:
    """Gather the candidate maps of an experience, which is the beginning of a whole one.

    They are named by their kind (one of PARTS_OF) or by a file, or are given as maps.

    Raises:
        InputError: One is not a map of the experience; or bearings are not exact, because it is
            then not known what two maps predict differently.
    """
    if experience.tolerance:
        raise InputError(
            "topomap explore: maps predict exact bearings, so a tolerance cannot be asked for"
        )
    relaxed = sorted(query.parts & {*RELAXING})
    found: dict[At, str] = {}
    fault = None
    for number, one in enumerate(among, 1):
        if not isinstance(one, str):
            where = f"among: map {number}"
            at = beginning(where, steps_json(one), whole, experience, relaxed)
            found.setdefault(at, GIVEN)
        elif one not in PARTS_OF:
            for at in _of_file(one, whole, experience, watch, relaxed):
                found.setdefault(at, one)
        elif fault is None:
            watch.title(f"{one} maps")
            if one == "optimal":
                best, fault = best_maps(whole, query, watch)
                for one_map in best:
                    found.setdefault(one_map.at, one_map.kind)
                continue
            with Attempt() as attempt:
                for at in _of_kind(one, whole, query, watch):
                    found.setdefault(at, one)
            fault = attempt.fault
    every = not fault and all(one in PARTS_OF for one in among)
    each = tuple(Candidate(at, of) for at, of in sorted(found.items()))
    return Candidates(experience, each, every, fault)


def _of_kind(kind: str, whole: Experience, query: Query, watch: Watch) -> Iterable[At]:
    """Find all maps of a kind."""
    having = query.having(*PARTS_OF[kind])
    return (one.at for one in solving.hypotheses(whole, having, watch) if one is not None)


def _misspelt(name: str) -> str | None:
    """The kind of maps that was probably meant by a name that is not that of a file."""
    near = nearest(name, PARTS_OF, 0.8)
    return near if near and not Path(name).exists() else None


def _of_file(
    path: str, whole: Experience, experience: Experience, watch: Watch, relaxed: Sequence[str]
) -> Iterator[At]:
    """Read the maps of a file, cut to the experience.

    Raises:
        InputError: One is not a hypothesis of the experience.
    """
    if near := _misspelt(path):
        raise InputError(f"{path}: no such file or directory; did you mean {near}?")
    documents = read_maps(path)
    if not any(document.maps for document in documents):
        raise InputError(f"{path}: no maps in it")
    for document in documents:
        for number, entry in enumerate(document.maps, 1):
            watch.found += 1
            where = f"{document.where}: map {number}"
            yield beginning(where, entry["at"], whole, experience, relaxed)
