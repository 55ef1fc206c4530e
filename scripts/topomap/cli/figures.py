"""The subcommand ``figures``."""

from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """The parser of ``topomap figures``."""
    made = command(
        group,
        "figures",
        "draw the paper's figures and some more, from computed answers",
        "  topomap figures -d docs/figures\n  topomap figures figure1 figure5 -d .",
    )
    made.add_argument(
        "figure", nargs="*", default=(), metavar="FIGURE", help="these only, as figure1"
    )
    made.add_argument(
        "-d", "--directory", required=True, metavar="DIR", help="folder for FIGURE.svg"
    )
    made.add_argument(
        "--instances",
        metavar="DIR",
        help="where they are (default: those of topomap path instances)",
    )
