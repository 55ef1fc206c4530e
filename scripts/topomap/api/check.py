"""Checking maps that anyone made."""

from collections.abc import Iterable
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, query_of
from topomap.documents.maps import Document, document
from topomap.documents.verdicts import Judged, verdicts
from topomap.model.experience import Experience
from topomap.model.topology import TopologicalMap
from topomap.model.vocabulary import PROPERTIES
from topomap.runtime.watch import Attempt, Watch


def check(
    experience: Experience,
    maps: Iterable[Document | Map | dict[str, Any]],
    *,
    bound: int | None = None,
    noise: int | None = None,
    truth: TopologicalMap | None = None,
    timeout: float | None = None,
    watch: Watch | None = None,
    **parts: Unpack[Parts],
) -> Judged:
    """Judge maps by two checkers that share no rule with the theory (the paper, sections II, III).

    Parameters:
        experience: what was seen and done.
        maps: what is to be judged: maps of ``solve``; dictionaries with the key ``at``, a list of
            ``[step, place, slot]``, as ``solve --json`` writes them; or documents that were read.
        bound: the most places that a map may have.
        noise: how many views a map may disbelieve.
        truth: the real map, for documents that say which map it is.
        timeout: seconds after which no further map is begun.
        watch: that of a command; then ``timeout`` is not used.
        parts: what the maps are to have; genus, minimal and euler are none that one map has.

    Returns:
        The verdicts; ``unsound`` are those of maps with which something is wrong.

    Raises:
        ValueError: an unknown part.
        InputError: what is to be judged is no map.
    """
    query = query_of(parts, bound=bound, noise=noise, allowed=PROPERTIES)
    documents = [
        one
        if isinstance(one, Document)
        else document("map", {"maps": [{"at": [[*at] for at in _at(one)]}]})
        for one in maps
    ]
    watch = begin(experience, timeout, watch, noise is not None)
    demands = [part for part in PROPERTIES if part in query.parts]
    demands += [f"bound({bound})"] if bound else []
    judged = Judged(sum(len(one.maps) for one in documents), experience.steps, demands)
    with Attempt() as attempt:
        for verdict in verdicts(experience, documents, demands, truth, noise):
            judged.verdicts.append(verdict)
            watch.found += 1
            if len(judged.verdicts) < judged.count:
                watch.tick()
    judged.fault = attempt.fault
    return judged


def _at(one: Map | dict[str, Any]) -> list[tuple[int, int, int]]:
    """The place and gateway after each step."""
    if isinstance(one, Map):
        return [(step, place, slot) for step, (place, slot) in enumerate(one.at)]
    return [(step, place, slot) for step, place, slot in one["at"]]
