"""The subcommand ``show``."""

import argparse
import os
import shutil
import sys
from typing import Any

from topomap.cli.arguments import add_scene, command
from topomap.cli.scene import scene_of

LEAST, MOST = 20, 100  # columns of a terminal


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
    from topomap.drawing.ready import ready

    scene, status = scene_of(args)
    if scene is None:
        return status
    ready()
    from topomap.drawing import terminal

    columns = shutil.get_terminal_size().columns
    coloured = sys.stdout.isatty() and os.environ.get("TERM") != "dumb"
    coloured &= not os.environ.get("NO_COLOR")
    text = terminal.text(scene, max(LEAST, min(columns, MOST)), coloured)
    try:
        "─│╴⠿→".encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        text = text.translate(terminal.ASCII)
    sys.stdout.write(text)
    return status
