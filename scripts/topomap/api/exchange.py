"""Maps for other tools, and back."""

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene


def exported(scene: Scene, form: str) -> str:
    """A map as the text of a file: ``graphml``, ``json`` (node-link), ``dot``, ``clingraph``
    or ``tmap2``. Raises MemoryError."""
    ready()
    from topomap.exchange.exports import PLACED, WRITERS

    if form in WRITERS:
        return WRITERS[form](scene)
    from topomap.drawing.layout import layout

    return PLACED[form](scene, layout(scene.world, scene.ahead))


def imported(file: str) -> str:
    """What ``solve --json`` writes of the map in a file that ``export`` wrote, GraphML or
    node-link JSON. Raises InputError, one line, if there is none."""
    from topomap.exchange.imports import import_map

    return import_map(file)
