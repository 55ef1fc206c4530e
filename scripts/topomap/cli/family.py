"""The subcommand ``family``."""

from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """The parser of ``topomap family``."""
    made = command(
        group,
        "family",
        "name the instances of a family file, and write the call of each where it changed",
        "  topomap family instances/batch.txt -d build/instances",
    )
    made.add_argument("file", metavar="FAMILY")
    made.add_argument(
        "-d",
        "--directory",
        required=True,
        metavar="DIR",
        help="folder for NAME.args; files of instances no longer listed go",
    )
    made.add_argument("--json", action="store_true", help="print JSON")
