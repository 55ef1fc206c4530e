"""The subcommand ``ask``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_optimal, add_query, command
from topomap.cli.calls import parts_of
from topomap.model.vocabulary import PARTS, VOCABULARY
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.status import exit_status


def add(group: Any) -> None:
    """The parser of ``topomap ask``."""
    made = command(
        group,
        "ask",
        f"""\
  topomap ask instances/grid-4x4-snake.lp "same(3,12)" "places < 12" --planar --closed
  topomap ask instances/grid-3x3-snake.lp "linked(3,2,12,0)" "not planar" --optimal --json

{VOCABULARY}""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument("statement", nargs="+", metavar="STATEMENT")
    add_optimal(made)
    add_query(made, PARTS)


def run(args: argparse.Namespace) -> int:
    """Settle statements."""
    from topomap.api.ask import ask
    from topomap.model.facts import read
    from topomap.runtime.watch import heeding

    experience = read(args.instance)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            answers = ask(
                experience,
                *args.statement,
                optimal=args.optimal,
                bound=args.bound,
                horizon=args.horizon,
                watch=watch,
                **parts_of(args),
            )
        if args.json:
            out.write(
                formats.line({"instance": args.instance, **answers.document()}, answers.fault)
            )
        else:
            out.writelines(f"{line}\n" for line in answers.lines())
    return exit_status(answers.fault, bool(answers.has_maps))
