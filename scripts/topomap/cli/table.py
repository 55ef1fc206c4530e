"""The subcommand ``table``."""

import argparse
import contextlib
import json
import os
from typing import Any

from topomap.cli.arguments import add_resume, command, number
from topomap.runtime import formats
from topomap.runtime.errors import InputError, say
from topomap.runtime.files import output
from topomap.runtime.journal import Journal
from topomap.runtime.status import exit_status


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
        help="how many columns, or with --beyond processes, at a time (default: one for each "
        "processor)",
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


def run(args: argparse.Namespace) -> int:
    """Count the paper's table, or what is beyond it, print it and write it as JSON."""
    from topomap.paper import beyond, figure4
    from topomap.runtime.watch import Attempt, heeding
    from topomap.solver.crews import crew

    name = "beyond" if args.beyond else "figure4"
    path = f"results/{name}.json" if args.output is None else args.output
    jobs = args.jobs or os.cpu_count() or 1
    columns = len(beyond.COLUMNS if args.beyond else figure4.COLUMNS)
    rows: list[dict[str, Any]] = []
    if args.resume and not args.beyond:
        raise InputError("topomap table: --resume goes with --beyond")
    with (
        Attempt() as attempt,  # if it is cut, the file keeps an older, complete table
        output(path, parents=True) as file,
        contextlib.ExitStack() as stack,
    ):
        if args.beyond:
            journal_of = {"command": name, "columns": beyond.COLUMNS}
            journal = stack.enter_context(Journal(path, journal_of, args.resume))
            watch = stack.enter_context(heeding(args.timeout))
            workers = stack.enter_context(crew(jobs))
            counted = beyond.rows(workers, watch, journal)
        else:
            journal = Journal()
            watch = stack.enter_context(heeding(args.timeout, quiet=True))
            counted = figure4.rows(jobs, watch)
        for row in counted:
            rows = sorted([*rows, row], key=lambda row: (row["environment"], row["planarity"]))
            say(f"counted {len(rows)} of {columns} columns")
        json.dump(formats.answer({"rows": rows}), file, indent=1)
        file.write("\n")
        journal.complete = True
    fault = attempt.fault
    different = [cell for row in rows for cell in figure4.differences(row)]
    if args.json:
        print(formats.line({"rows": rows}, fault), end="")
        return exit_status(fault, not different)
    if rows:
        print(figure4.text(rows))
    for cell in different:
        print(f"differs: {cell}")
    if fault:
        print(f"partial: {fault}; {len(rows)} of {columns} columns")
    elif not different:
        print(beyond.VERDICT if args.beyond else "Every figure is the paper's.")
    return exit_status(fault, not different)
