"""Maps that are drawn into files and texts."""

import threading
from io import BytesIO
from pathlib import Path
from typing import IO

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene
from topomap.runtime.errors import InputError
from topomap.runtime.extras import need
from topomap.runtime.files import output
from topomap.runtime.watch import Late, never

FORMATS = ("svg", "png", "pdf")
_ALONE = threading.Lock()  # matplotlib has one set of settings for all threads


def form_of(file: str | Path) -> str:
    """Tell the format of a picture by the ending of the name of its file.

    Raises:
        InputError: The ending is not known. One line.
    """
    form = Path(file).suffix[1:].lower()
    if form not in FORMATS:
        raise InputError(f"{file}: a picture is {', '.join(FORMATS)}, by its last letters")
    return form


def save(scene: Scene, file: str | Path, late: Late = never) -> str:
    """Draw a map into a file.

    If it is ``late`` before there is a better drawing, the map is drawn plainly. On an error the
    file stays as it was.

    Returns:
        What the picture says if it is drawn plainly; otherwise an empty text.

    Raises:
        InputError: The file cannot be written. One line.
        MemoryError: There is not enough memory. What ``late`` raises is passed on, too.
    """
    form = form_of(file)
    need("draw", str(file))
    ready()
    with output(str(file), binary=True) as out:
        note = _write(scene, out, form, late)
        late()
    return note


def svg(scene: Scene, late: Late = never) -> str:
    """Draw a map as the text of an SVG; errors are those of ``save``."""
    need("draw", "a drawing")
    ready()
    made = BytesIO()
    _write(scene, made, "svg", late)
    return made.getvalue().decode()


def characters(
    scene: Scene, columns: int, coloured: bool, ascii: bool = False, late: Late = never
) -> tuple[str, str]:
    """Draw a map as lines of characters, each of at most so many columns.

    With ``ascii`` only characters of ASCII are used.

    Returns:
        The lines, and what ``save`` returns.

    Raises:
        MemoryError: There is not enough memory. What ``late`` raises is passed on, too.
    """
    ready()
    from topomap.drawing import terminal

    text, note = terminal.drawn(scene, columns, coloured, late)
    return text.translate(terminal.ASCII) if ascii else text, note


def _write(scene: Scene, out: IO[bytes], form: str, late: Late) -> str:
    from topomap.drawing import sheet
    from topomap.drawing.layout import layout

    laid = layout(scene.world, scene.ahead, late=late, where=scene.where())
    with _ALONE:
        sheet.write(sheet.picture([scene], laid=[laid]), out, form)
    return laid.note
