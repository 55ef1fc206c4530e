"""The subcommand ``import``."""

from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """The parser of ``topomap import``."""
    made = command(
        group,
        "import",
        "read a map that export wrote, and write it as solve --json does",
        """\
  topomap export instances/grid-4x4-snake.lp --format graphml -o map.graphml
  topomap import map.graphml -o maps.json
  topomap check instances/grid-4x4-snake.lp maps.json""",
    )
    made.add_argument("file", metavar="FILE.graphml|FILE.json")
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
