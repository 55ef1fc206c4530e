"""The maps that ``draw``, ``show`` and ``export`` choose from.

They are the best maps of an instance, or those in a file of maps.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, overload

from topomap.api.answer import Answer
from topomap.api.solve import solve_under
from topomap.documents import maps
from topomap.drawing import scenes
from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene
from topomap.model.experience import Experience
from topomap.model.facts import parse
from topomap.model.found import UNPROVED, Found
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_text
from topomap.runtime.watch import Watch
from topomap.worlds.files import Loaded, load
from topomap.worlds.plan import Reading

MANY = 1000  # if there are more optimal maps, not all of them are looked for
# The share of the time for the search for optimal maps. If none is found, this is the share of the
# rest of the time for the search for a closed map, before any map is taken.
OPTIMAL, CLOSED = 0.6, 0.6


@dataclass(frozen=True)
class Searched(Sequence[Scene]):
    """The maps that were found in an experience, each made into a scene when it is asked for.

    They are all that there are if ``whole`` is true. ``many`` is their number (0 if it is not
    known).
    """

    experience: Experience
    name: str
    found: Sequence[Found]
    many: int
    whole: bool

    def __len__(self) -> int:
        return len(self.found)

    @overload
    def __getitem__(self, index: int) -> Scene: ...
    @overload
    def __getitem__(self, index: slice) -> list[Scene]: ...
    def __getitem__(self, index: int | slice) -> Scene | list[Scene]:
        places = range(len(self.found))[index]
        if isinstance(places, range):
            return [self._scene(place) for place in places]
        return self._scene(places)

    def _scene(self, place: int) -> Scene:
        one = self.found[place]
        return scenes.one_found(
            *(self.experience, self.name, one, place + 1, self.many, self.whole)
        )


class Choice(NamedTuple):
    """The maps to choose from.

    ``fault`` says why they may not be all; for maps in a file it does so only if there is none.
    ``searched`` tells whether they were searched for, and not read.
    """

    scenes: Sequence[Scene]
    fault: str | None
    searched: bool


def scenes_under(
    watch: Watch,
    path: str,
    query: Query,
    given: str | None = None,
    read: Callable[[str, str], Experience] = parse,
    number: int = 1,
) -> Choice:
    """Find the maps of a file under the watch of a command.

    For an instance these are the optimal maps, or those that are best so far, that have the parts
    of the query; or, with a file of maps ``given``, those in it. For a file that ``solve --json``
    wrote they are the maps in it. ``read`` makes the experience from the text of an instance and
    its name.

    If no optimal map is found in time, some map is taken that is not proved to be best. The maps of
    an instance are in order. If there are more than ``MANY``, they are in the order in which they
    were found, and only as many as are needed for the map of that ``number``.

    Raises:
        InputError: The file cannot be read, or is neither an instance nor a file of maps. One line.
    """
    if given is not None:
        return _given(path, query, given)
    content = read_text(path, maps.MOST_BYTES_OF_MAPS)
    if content.lstrip()[:1] in ("{", "["):
        _refuse(path, query)
        documents = maps.parse_maps(content, path)
        found = [scene for document in documents for scene in scenes.of_document(document)]
        return Choice(found, _missing(documents, found), False)
    experience = read(content, path)
    limit = max(MANY, number)
    with watch.deadline.sooner(OPTIMAL):
        answer = solve_under(watch, experience, query, optimal=True, limit=limit)
        best = [one.found for one in answer]
    if not best and answer.fault == "timeout":
        best = _some(watch, experience, query)
    if answer.fault == "limit" or len(best) > MANY:
        return Choice(Searched(experience, path, best, 0, False), _unless_limit(answer), True)
    best.sort(key=lambda one: one.at)
    shown = Searched(experience, path, best, len(best), answer.complete)
    return Choice(shown, answer.fault, True)


def drawn_like(scene: Scene, file: str) -> tuple[Scene, str]:
    """Place a scene like the file of a world, and say what there is to say about that.

    If it is not known which place is which, the scene stays as it is.

    Raises:
        InputError: The file cannot be read. One line.
    """
    ready()
    from topomap.drawing.likeness import likeness

    tried = []
    for loaded in _readings(file, scene.world.slots):
        world = loaded.environment.map
        tried.append(likeness(scene.world, world, loaded.plan, scene.where()))
        if tried[-1].laid:
            break
    found = max(tried, key=lambda one: (one.laid, one.where is not None))
    told = f"map {scene.number}: {found.note}" if found.note else ""
    if found.where is None:
        return scene, f"{told}; it is drawn as usual"
    return replace(scene, like=found.where), told


def _readings(file: str, slots: int) -> Iterator[Loaded]:
    """Read the world in a file in each way in which it may have been read for the map.

    The number of slots is the one that is chosen, or ``slots``; and the world has its loops, or has
    none.

    Raises:
        InputError: The file can be read in none of these ways. One line.
    """
    faults, given = [], 0
    for number in range(4):
        chosen, loops = number % 2 == 0, number > 1
        try:
            loaded = load(file, Reading(loops=loops), None if chosen else slots, two_way=True)
        except InputError as fault:  # a loop may have no course, and the slots may be too few
            faults.append(fault)
            continue
        given += 1
        yield loaded
        if loaded.layout.slots == slots and not any("loops" in one for one in loaded.warnings):
            return
    if not given:
        raise faults[0]


def _some(watch: Watch, experience: Experience, query: Query) -> list[Found]:
    """Find a map that need not be the best, or none; it is closed if time allows."""
    for parts, share in (("closed",), CLOSED), ((), 1.0):
        with watch.deadline.sooner(share):
            answer = solve_under(watch, experience, query.having(*parts), limit=1)
            for one in answer:
                return [replace(one.found, kind=UNPROVED, proved=False)]
        if answer.fault not in (None, "timeout"):
            break
    return []


def _unless_limit(answer: Answer) -> str | None:
    """Say why an answer is partial, unless only maps are missing that nobody asked for."""
    return None if answer.fault == "limit" else answer.fault


def _given(path: str, query: Query, given: str) -> Choice:
    """Read the maps of an instance that are given in a file."""
    _refuse(given, query)
    if path == given == "-":
        raise InputError("-: standard input is the instance or the maps, not both")
    documents = maps.of_instance(maps.read_maps(given), path)
    if not documents:
        raise InputError(f"{given}: no maps of {path} in it")
    noisy = any("misread" in entry for document in documents for entry in document.maps)
    seen = parse(read_text(path), path, noisy)
    found = [scene for one in documents for scene in scenes.of_instance(seen, path, one)]
    return Choice(found, _missing(documents, found), False)


def _refuse(path: str, query: Query) -> None:
    """Refuse demands on maps that were given.

    Raises:
        InputError: There is such a demand.
    """
    if query != Query():
        raise InputError(f"{path}: these are maps, so parts, bound and horizon cannot be used")


def _missing(documents: Sequence[maps.Document], found: Sequence[Scene]) -> str | None:
    """Say why there is no map in documents, unless it is known that there is none to find."""
    if found:
        return None
    cut = [document for document in documents if not document.whole]
    told = [str(document.claims["fault"]) for document in cut if document.claims.get("fault")]
    return (told or ["its file does not say that it is complete"])[0] if cut else None
