"""The subcommand ``figures``."""

import argparse
from pathlib import Path
from typing import Any

from topomap.cli.arguments import command
from topomap.runtime.errors import say
from topomap.runtime.status import exit_status


def add(group: Any) -> None:
    """The parser of ``topomap figures``."""
    made = command(
        group,
        "figures",
        "  topomap figures -d docs/figures\n  topomap figures figure1 figure5 -d .",
    )
    made.add_argument(
        "figure",
        nargs="*",
        default=(),
        metavar="FIGURE",
        help="draw only these figures, such as figure1 (default: all figures)",
    )
    made.add_argument(
        "-d", "--directory", required=True, metavar="DIR", help="folder for FIGURE.svg"
    )
    made.add_argument(
        "--instances",
        metavar="DIR",
        help="folder of the instances (default: that of topomap path instances)",
    )


def run(args: argparse.Namespace) -> int:
    """Draw the paper's figures, and some more, into a folder."""
    from topomap.api.figures import figures_under
    from topomap.runtime.watch import Attempt, heeding

    folder = Path(args.directory)
    with heeding() as watch, Attempt() as attempt:
        for path in figures_under(watch, folder, args.figure, args.instances):
            print(path)
    if attempt.fault:
        say(f"{folder}: partial: {attempt.fault}")
    return exit_status(attempt.fault, True)
