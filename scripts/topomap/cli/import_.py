"""The subcommand ``import``."""

import argparse
from typing import Any

from topomap.cli.arguments import command
from topomap.runtime.status import DONE


def add(group: Any) -> None:
    """The parser of ``topomap import``."""
    made = command(
        group,
        "import",
        """\
  topomap export instances/grid-4x4-snake.lp --format graphml -o map.graphml
  topomap import map.graphml -o maps.json
  topomap check instances/grid-4x4-snake.lp maps.json""",
    )
    made.add_argument(
        "file", metavar="FILE.graphml|FILE.json", help="a map that topomap export wrote"
    )
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Read a map that ``export`` wrote, and write it as ``solve --json`` does."""
    from topomap.api.exchange import imported
    from topomap.runtime.files import output

    content = imported(args.file)
    with output(args.output) as file:
        file.write(content)
    return DONE
