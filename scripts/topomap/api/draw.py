"""Maps drawn into files and texts."""

import threading
from io import BytesIO
from pathlib import Path
from typing import IO

from topomap.drawing.ready import ready
from topomap.drawing.scenes import Scene
from topomap.runtime.errors import InputError
from topomap.runtime.extras import need
from topomap.runtime.files import output

FORMATS = ("svg", "png", "pdf")
_ALONE = threading.Lock()  # the settings of matplotlib are the process's, not a thread's


def form_of(file: str | Path) -> str:
    """What a picture in a file is, by the ending of its name. Raises InputError, one line."""
    form = Path(file).suffix[1:].lower()
    if form not in FORMATS:
        raise InputError(f"{file}: a picture is {', '.join(FORMATS)}, by its last letters")
    return form


def save(scene: Scene, file: str | Path) -> None:
    """Draw a map into a file. Raises InputError, one line, where that cannot be, and
    MemoryError."""
    form = form_of(file)
    need("draw", str(file))
    ready()
    with output(str(file), binary=True) as out:
        _write(scene, out, form)


def svg(scene: Scene) -> str:
    """A map as the text of an SVG. Raises as ``save`` does."""
    need("draw", "a drawing")
    ready()
    made = BytesIO()
    _write(scene, made, "svg")
    return made.getvalue().decode()


def characters(scene: Scene, columns: int, coloured: bool, ascii: bool = False) -> str:
    """A map as lines of characters, at most so many in a line; of ASCII alone, if asked for.
    Raises MemoryError."""
    ready()
    from topomap.drawing import terminal

    text = terminal.drawn(scene, columns, coloured)
    return text.translate(terminal.ASCII) if ascii else text


def _write(scene: Scene, out: IO[bytes], form: str) -> None:
    from topomap.drawing import sheet

    with _ALONE:
        sheet.write(sheet.picture([scene]), out, form)
