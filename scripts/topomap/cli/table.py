"""The subcommand ``table``."""

from typing import Any

from topomap.cli.arguments import add_resume, command, number


def add(group: Any) -> None:
    """The parser of ``topomap table``."""
    made = command(
        group,
        "table",
        "print the paper's Figure 4 beside ours, and write it as JSON",
        "  topomap table",
    )
    made.add_argument(
        "--jobs",
        type=number(int, 1),
        metavar="N",
        help="columns, or with --beyond processes, at a time (default: one a processor)",
    )
    made.add_argument("--json", action="store_true", help="print JSON instead of the table")
    made.add_argument(
        "--timeout", type=number(float, 0.001), metavar="S", help="stop after S seconds"
    )
    made.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="file to write (default: results/figure4.json, or beyond.json)",
    )
    made.add_argument(
        "--beyond",
        action="store_true",
        help="count what the paper does not have instead: 4x4 without a bound, 4x5, 5x4, 5x5; "
        "takes an hour",
    )
    add_resume(made)
