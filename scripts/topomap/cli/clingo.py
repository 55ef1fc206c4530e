"""The subcommand ``clingo``."""

from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """The parser of ``topomap clingo``."""
    command(
        group,
        "clingo",
        "run clingo itself, with its options and exit statuses",
        """\
  topomap clingo --help
  topomap clingo "$(topomap path)/topomap.lp" instances/grid-3x3-snake.lp 0 --quiet""",
    )
