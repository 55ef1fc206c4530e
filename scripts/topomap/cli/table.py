"""The subcommand ``table``."""

import argparse
import sys
from typing import Any

from topomap.cli.arguments import NO_LIMIT, add_resume, command, number
from topomap.cli.tell import tell
from topomap.runtime.errors import InputError, say


def add(group: Any) -> None:
    """The parser of ``topomap table``."""
    made = command(
        group,
        "table",
        "  topomap table",
    )
    made.add_argument(
        "--jobs",
        type=number(int, 1),
        metavar="N",
        help="number of columns, or with --beyond of processes, at a time (default: one for "
        "each processor)",
    )
    made.add_argument("--json", action="store_true", help="print JSON instead of the table")
    made.add_argument(
        "--timeout",
        type=number(float, 0.001),
        metavar="S",
        help=NO_LIMIT,
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
        help="count instead what lies beyond the paper's table: 4x4 without a bound, 4x5, 5x4, "
        "5x5; this takes an hour",
    )
    add_resume(made)


def run(args: argparse.Namespace) -> int:
    """Count the paper's table, or what lies beyond it, print it and write it as JSON."""
    from topomap.api.table import table_beyond_under, table_under
    from topomap.runtime.watch import heeding

    if args.resume and not args.beyond:
        raise InputError("topomap table: --resume goes with --beyond")
    name = "beyond" if args.beyond else "figure4"
    path = f"results/{name}.json" if args.output is None else args.output
    with heeding(args.timeout, quiet=not args.beyond) as watch:
        if args.beyond:
            table = table_beyond_under(watch, path, args.jobs, args.resume, _note)
        else:
            table = table_under(watch, path, args.jobs, _note)
    return tell(args, sys.stdout, table, not table.differences)


def _note(done: int, many: int) -> None:
    say(f"counted {done} of {many} columns")
