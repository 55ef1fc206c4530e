"""The subcommand ``path``."""

import argparse
from typing import Any

from topomap.cli.arguments import command
from topomap.runtime import formats
from topomap.runtime.folders import ENCODINGS, INSTANCES
from topomap.runtime.status import DONE


def add(group: Any) -> None:
    """The parser of ``topomap path``."""
    made = command(
        group,
        "path",
        """\
  topomap path
  topomap clingo "$(topomap path)/topomap.lp" "$(topomap path instances)/grid-3x3-snake.lp" 0""",
    )
    made.add_argument(
        "what",
        nargs="?",
        choices=("encodings", "instances"),
        default="encodings",
        help="which folder (default: %(default)s)",
    )
    made.add_argument("--json", action="store_true", help="write JSON: both folders")


def run(args: argparse.Namespace) -> int:
    """Print where the encodings or the instances are."""
    found = {"encodings": str(ENCODINGS), "instances": str(INSTANCES)}
    print(formats.line(found).rstrip() if args.json else found[args.what])
    return DONE
