"""The exceptions of a map to consistent boundaries, with the names of the paths.

A path is named by the first step that travels along it. A path that no step travels is named by a
gateway of its only place, as in ``4.1``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from topomap.model.experience import DState, Experience
from topomap.model.topology import TopologicalMap, gid
from topomap.model.words import plural

Name = int | str  # the name of a path


@dataclass(frozen=True)
class NamedException:
    """An exception to consistent boundaries (docs/exceptions.md, "What an exception is").

    It has its ``kind`` (``meet twice``, ``place twice`` or ``both sides``), the names of its
    ``paths``, and its ``places``.
    """

    kind: str
    paths: tuple[Name, ...]
    places: tuple[int, ...]

    @property
    def words(self) -> str:
        """The exception in words, such as "paths 2 and 6 meet twice, at places 1 and 4"."""
        paths, places = _listed(self.paths), _listed(self.places)
        noun = plural(len(self.places), "place")
        if self.kind == "meet twice":
            return f"paths {paths} meet twice, at {noun} {places}"
        if self.kind == "place twice":
            return f"path {paths} holds {noun} {places} twice"
        return f"place {places} is left and right of path {paths}"

    def document(self) -> dict[str, Any]:
        """The exception as JSON."""
        return {"kind": self.kind, "paths": self.paths, "places": self.places}


def exceptions_of(experience: Experience, at: Sequence[DState]) -> list[NamedException]:
    """Find the exceptions of the map of a hypothesis, given by its dstate after each step."""
    steps: dict[DState, int] = {}
    travels = zip(
        experience.turns, pairwise(at), strict=False
    )  # the beginning of an experience has more turns than steps
    for step, (turn, (before, arrival)) in enumerate(travels, 1):
        if turn is not None:
            steps.setdefault(experience.way_out(step, before), step)
            steps.setdefault(arrival, step)
    return named_exceptions(experience.map_of(tuple(at)), steps)


def named_exceptions(world: TopologicalMap, steps: Mapping[DState, int]) -> list[NamedException]:
    """Find the exceptions of a map.

    ``steps`` gives, for each gateway that has a link, the step that first came to it.
    """
    found = list(world.exceptions())
    if not found:
        return []
    across: dict[DState, int] = {}  # the first step along each axis, in either direction
    for gateway, step in steps.items():
        for end in (gateway, world.opposite(gateway)):
            across[end] = min(step, across.get(end, step))
    names: list[Name] = [
        min((across[dstate] for dstate in path if dstate in across), default=0) or gid(path[0])
        for path in world.paths()
    ]
    return [
        NamedException(one.kind, tuple(names[path] for path in one.paths), one.places)
        for one in found
    ]


def _listed(names: Sequence[Name]) -> str:
    """List names, as in "1, 3 and 4"."""
    *first, last = map(str, names)
    return f"{', '.join(first)} and {last}" if first else last
