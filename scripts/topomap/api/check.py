"""Checking maps that anyone made."""

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, demand_pairs, path_of, query_of
from topomap.documents import maps as read
from topomap.documents.maps import Document
from topomap.documents.verdicts import Judged, verdicts
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.model.topology import TopologicalMap
from topomap.model.vocabulary import PROPERTIES, RELAXING
from topomap.runtime.checks import flag, integer, shown
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Attempt, Watch

Given = Map | Mapping[str, Any]  # a map, or what ``solve --json`` writes of one


def check(
    experience: Experience,
    maps: str | os.PathLike[str] | Given | Iterable[Given | Document],
    *,
    bound: int | None = None,
    noise: int | None = None,
    truth: TopologicalMap | None = None,
    timeout: float | None = None,
    every: bool = False,
    **parts: Unpack[Parts],
) -> Judged:
    """Judge maps by two checkers that share no rule with the theory (the paper, sections II, III).

    All other claims about a map besides its dstates are judged, too, as ``topomap check`` does.

    Parameters:
        experience: What the agent saw and did.
        maps: The maps to judge. They are a map that ``solve`` gave; a dictionary that ``solve
            --json`` writes of a map, with at least the key ``at``, a list of ``[step, place,
            slot]``; several of these, no two of which are equal; a dictionary with the key
            ``maps``, a list of such dictionaries, and what is said of them all; the path of a file;
            or documents that were read.
        bound: The largest number of places that a map may have.
        noise: The largest number of views that a map may contradict.
        truth: The real map, for maps that say whether they are the real one (the key ``real``).
        timeout: The number of seconds after which no further map is judged.
        every: Whether to report for each map which axioms and defaults it keeps and breaks
            (``axioms`` of its verdict), and its ``exceptions``. Then a map is not wrong because
            it breaks what is neither demanded here nor said of it; this includes the path axiom.
        parts: The demands on the maps, as for ``solve``. The parts ``genus``, ``exceptions``,
            ``minimal`` and ``euler`` cannot be judged of a single map. With ``no_path_axiom`` maps
            need not keep the path axiom.

    Returns:
        The verdicts, in the order of the maps; ``unsound`` has those of the maps with which
        something is wrong. In an ``if`` it is true when all maps were judged, and none is unsound.

    Raises:
        TypeError: ``experience`` is not an Experience, ``maps`` is none of the above, or ``truth``
            is not a TopologicalMap.
        ValueError: A part is not known, or a number is out of its range.
        InputError: The experience is impossible, a file cannot be read, or an entry is not a map.
            The message is one line that gives the number of the entry.
    """
    query = query_of(parts, bound=bound, noise=noise, allowed=(*PROPERTIES, *RELAXING))
    every = flag("every", every)
    if truth is not None and not isinstance(truth, TopologicalMap):
        raise TypeError(f"truth: a TopologicalMap is wanted, not {shown(truth)}")
    documents = _documents(maps)
    demand_pairs(experience, "check")
    watch = begin(experience, timeout, noise is not None or read.noisy(documents))
    return check_under(watch, experience, documents, query, truth, every)


def check_under(
    watch: Watch,
    experience: Experience,
    documents: list[Document],
    query: Query,
    truth: TopologicalMap | None,
    every: bool = False,
) -> Judged:
    """Judge the maps of documents under the watch of a command."""
    demands = [part for part in (*PROPERTIES, *RELAXING) if part in query.parts]
    demands += [f"bound({query.places})"] if query.places else []
    judged = Judged(sum(len(one.maps) for one in documents), experience.steps, demands)
    with Attempt() as attempt:
        for verdict in verdicts(experience, documents, demands, truth, query.noise, every):
            judged.verdicts.append(verdict)
            watch.found += 1
            if len(judged.verdicts) < judged.count:
                watch.tick()
    judged.fault = attempt.fault
    return judged


def _documents(given: Any) -> list[Document]:
    """Bring what is to be judged into the form that the command reads from a file.

    Maps that are given one by one make one document, so that no map may occur in it twice.

    Raises:
        TypeError: This cannot contain maps.
        InputError: There are no maps in it.
    """
    if isinstance(given, str | os.PathLike):
        return read.read_maps(path_of(given))
    if isinstance(given, Map):
        given = [given]
    if isinstance(given, Mapping):
        return read.documents("maps", _plain("maps", given))
    if not isinstance(given, Iterable) or isinstance(given, bytes):
        wanted = "a Map, a dictionary, the path of a file or several maps are wanted"
        raise TypeError(f"maps: {wanted}, not {shown(given)}")
    documents: list[Document] = []
    entries: list[Any] = []
    for number, one in enumerate(given, 1):
        if isinstance(one, Document):
            documents.append(one)
        elif isinstance(one, Map | Mapping):
            entries.append(_plain(f"maps: map {number}", one))
        else:
            wanted = "a Map, or a dictionary with the key at, is wanted"
            raise InputError(f"maps: map {number}: {wanted}, not {shown(one)}")
    if entries or not documents:
        documents.append(read.document("maps", {"maps": entries}))
    return documents


def _plain(where: str, given: Given) -> Any:
    """Convert what was given to what is read from JSON: lists, dictionaries and plain numbers.

    Raises:
        InputError: JSON cannot hold it; one line that begins with ``where``.
    """

    def plain(value: Any) -> Any:
        if isinstance(value, Map):
            return value.document()
        return dict(value) if isinstance(value, Mapping) else integer("a number", value)

    try:
        return json.loads(json.dumps(given, default=plain))
    except (TypeError, ValueError, RecursionError):
        raise InputError(f"{where}: JSON cannot hold it") from None
