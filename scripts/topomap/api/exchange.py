"""Maps for other tools, and back."""

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene
from topomap.runtime.watch import Late, never


def exported(scene: Scene, form: str, late: Late = never) -> tuple[str, str]:
    """A map as the text of a file, with positions: ``graphml``, ``json`` (node-link), ``dot``,
    ``clingraph`` or ``tmap2``. If places are drawn plainly, as it is ``late`` before there is a
    better drawing, the second text says so. Raises MemoryError, and what ``late`` raises."""
    ready()
    from topomap.drawing.layout import layout
    from topomap.exchange.exports import DRAWN

    laid = layout(scene.world, scene.ahead, late=late, where=scene.where())
    return DRAWN[form](scene, laid), laid.note


def imported(file: str) -> str:
    """What ``solve --json`` writes of the map in a file that ``export`` wrote, GraphML or
    node-link JSON. Raises InputError, one line, if there is none."""
    from topomap.exchange.imports import import_map

    return import_map(file)
