"""The subcommand ``show``."""

import argparse
import os
import shutil
import sys
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_scene, command
from topomap.cli.scene import with_scene

if TYPE_CHECKING:
    from topomap.drawing.scenes import Scene
    from topomap.runtime.watch import Late

LEAST, MOST = 20, 100  # numbers of columns


def add(group: Any) -> None:
    """The parser of ``topomap show``."""
    made = command(
        group,
        "show",
        """\
  topomap show instances/grid-4x4-snake.lp --perpendicular
  topomap show maps.json --map 3 | less -S
  clingo encodings/topomap.lp encodings/closed.lp instances/grid-3x3-snake.lp 0 --outf=2 \\
    | topomap show instances/grid-3x3-snake.lp -""",
    )
    add_scene(made)


def run(args: argparse.Namespace) -> int:
    """Print a map."""
    from topomap.api.draw import characters

    def show(scene: "Scene", late: "Late") -> str:
        """Print the map, and return a note if it is drawn plainly."""
        columns = max(LEAST, min(shutil.get_terminal_size().columns, MOST))
        text, note = characters(scene, columns, _is_coloured(), not _has_signs(), late)
        sys.stdout.write(text)
        return note

    return with_scene(args, show)


def _is_coloured() -> bool:
    """Whether standard output shows colours."""
    is_terminal = sys.stdout.isatty() and os.environ.get("TERM") != "dumb"
    return is_terminal and not os.environ.get("NO_COLOR")


def _has_signs() -> bool:
    """Whether standard output can show the signs that links are drawn with."""
    try:
        "─│╴⠿→".encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        return False
    return True
