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
    """Judge maps by two checkers that share no rule with the theory (the paper, sections II, III);
    and whatever is said of a map beside its dstates, as ``topomap check`` does.

    Parameters:
        experience: what was seen and done.
        maps: what is to be judged: a map, as ``solve`` gives it, or a dictionary as ``solve
            --json`` writes it, with at least the key ``at``, a list of ``[step, place, slot]``;
            several of these, of which none may be twice; a dictionary with the key ``maps``, a
            list of such dictionaries, and what is said of them all; the path of a file; or
            documents that were read.
        bound: the most places that a map may have.
        noise: how many views a map may disbelieve.
        truth: the real map, for maps that say whether they are it (the key ``real``).
        timeout: seconds after which no further map is begun.
        every: tell of each map which axioms and defaults it breaks and keeps (``axioms`` of its
            verdict), and its ``exceptions``. What is not demanded, nor said of the maps, is then
            nothing wrong, the path axiom included.
        parts: what the maps are to have; genus, exceptions, minimal and euler are none that one map
            has. With no_path_axiom they need not keep the path axiom.

    Returns:
        The verdicts, in the order of the maps; ``unsound`` are those of maps with which something
        is wrong. In an ``if`` it is true when all maps were judged, and none is unsound.

    Raises:
        TypeError: no experience, no maps, or a truth that is no map of a world.
        ValueError: an unknown part, or a number that cannot be.
        InputError: an experience that cannot be; a file that cannot be read; or what is to be
            judged is no map: one line, which says the how many-th.
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
    """The same of documents that were read, under the watch of a command."""
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
    """What is to be judged, in the form in which the command reads it from a file. Maps that are
    given one by one make one document, so that none of them may be there twice. Raises TypeError
    or InputError if there are no maps in it."""
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
    """What was given, as it is read from JSON: of lists, dictionaries and plain numbers. Raises
    InputError, one line that begins with ``where``, if JSON cannot hold it."""

    def plain(value: Any) -> Any:
        if isinstance(value, Map):
            return value.document()
        return dict(value) if isinstance(value, Mapping) else integer("a number", value)

    try:
        return json.loads(json.dumps(given, default=plain))
    except (TypeError, ValueError, RecursionError):
        raise InputError(f"{where}: not what JSON can hold") from None
