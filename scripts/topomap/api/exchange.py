"""Maps for other tools, and back."""

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene


def exported(scene: Scene, form: str) -> str:
    """A map as the text of a file: ``graphml``, ``json`` (node-link), ``dot`` or ``clingraph``.
    Raises MemoryError."""
    ready()
    from topomap.exchange.exports import WRITERS

    return WRITERS[form](scene)


def imported(file: str) -> str:
    """What ``solve --json`` writes of the map in a file that ``export`` wrote, GraphML or
    node-link JSON. Raises InputError, one line, if there is none."""
    from topomap.exchange.imports import import_map

    return import_map(file)
