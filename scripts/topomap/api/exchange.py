"""Maps that are written for other tools, and read back."""

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene
from topomap.runtime.watch import Late, never


def exported(scene: Scene, form: str, late: Late = never) -> tuple[str, str]:
    """Write a map, with positions, as the text of a file for another tool.

    ``form`` is ``graphml``, ``json`` (node-link), ``dot``, ``clingraph`` or ``tmap2``.

    Returns:
        The text, and a note if it was ``late`` before there was a good drawing, so that the places
        are drawn plainly.

    Raises:
        MemoryError: There is not enough memory. What ``late`` raises is passed on, too.
    """
    ready()
    from topomap.drawing.layout import layout
    from topomap.exchange.exports import DRAWN

    laid = layout(scene.world, scene.ahead, late=late, where=scene.where())
    return DRAWN[form](scene, laid), laid.note


def imported(file: str) -> str:
    """Read a map that ``export`` wrote as GraphML or node-link JSON.

    Returns:
        What ``solve --json`` writes of this map.

    Raises:
        InputError: There is no such map in the file. One line.
    """
    from topomap.exchange.imports import import_map

    return import_map(file)
