"""The subcommand ``show``."""

from typing import Any

from topomap.cli.arguments import add_scene, command


def add(group: Any) -> None:
    """The parser of ``topomap show``."""
    made = command(
        group,
        "show",
        "print a map in the lines of a terminal, then in words",
        """\
  topomap show instances/grid-4x4-snake.lp --perpendicular
  topomap show maps.json --map 3 | less -S
  clingo encodings/topomap.lp encodings/closed.lp instances/grid-3x3-snake.lp 0 --outf=2 \\
    | topomap show instances/grid-3x3-snake.lp -""",
    )
    add_scene(made)
