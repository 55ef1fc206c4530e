"""The subcommand ``clingo``, because the wheel of clingo from PyPI has no such command.

It has clingo's own main function, options and exit statuses (10 satisfiable, 20 unsatisfiable, 30
all found, 65 bad input).
"""

from collections.abc import Sequence
from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """Add the parser of ``topomap clingo`` for its help; clingo itself reads the options."""
    command(
        group,
        "clingo",
        """\
  topomap clingo --help
  topomap clingo "$(topomap path)/topomap.lp" instances/grid-3x3-snake.lp 0 --quiet""",
    )


def run(arguments: Sequence[str]) -> int:
    """Run clingo with these arguments, and return its exit status."""
    from clingo.application import Application, clingo_main

    class Clingo(Application):
        """The application clingo, under its own name."""

        program_name = "clingo"

    return clingo_main(Clingo(), arguments)
