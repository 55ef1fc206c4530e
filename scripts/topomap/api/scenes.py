"""The maps that ``draw``, ``show`` and ``export`` choose from: the best ones of an instance, or
those in a file of maps."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from topomap.api.solve import solve_under
from topomap.documents import maps
from topomap.drawing import scenes
from topomap.drawing.scenes import Scene
from topomap.model.experience import Experience
from topomap.model.facts import parse
from topomap.model.query import Query
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_text
from topomap.runtime.watch import Watch


class Choice(NamedTuple):
    """The maps to choose from; ``fault`` says why they may not be all of them, of maps in a file
    only where there is none. ``searched``: they were searched for, and not read."""

    scenes: list[Scene]
    fault: str | None
    searched: bool


def scenes_under(
    watch: Watch,
    path: str,
    query: Query,
    given: str | None = None,
    read: Callable[[str, str], Experience] = parse,
) -> Choice:
    """The maps of a file, under the watch of a command.

    Of an instance they are the optimal ones, or the best so far, that have the parts of the
    query, or with a file of maps ``given`` those in it; of a text of ``solve --json`` those in it.
    ``read`` makes the experience of the text of an instance and its name. Raises InputError, one
    line.
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
    answer = solve_under(watch, experience, query, optimal=True)
    best = [one.found for one in sorted(answer, key=lambda one: one.at)]
    shown = scenes.of_found(experience, path, best, answer.complete)
    return Choice(shown, answer.fault, True)


def _given(path: str, query: Query, given: str) -> Choice:
    """The maps of an instance that are given in a file."""
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
    """Raise InputError if anything is asked of maps that are there."""
    if query != Query():
        raise InputError(f"{path}: these are maps, so parts, bound and horizon cannot be used")


def _missing(documents: Sequence[maps.Document], found: Sequence[Scene]) -> str | None:
    """Why there is no map in documents, unless that is all that there is to find."""
    if found:
        return None
    cut = [document for document in documents if not document.whole]
    told = [str(document.claims["fault"]) for document in cut if document.claims.get("fault")]
    return (told or ["it is not said to be complete"])[0] if cut else None
