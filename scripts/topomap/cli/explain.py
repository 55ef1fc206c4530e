"""The subcommand ``explain``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_query, command
from topomap.cli.calls import parts_of
from topomap.model.vocabulary import DEMANDS, VOCABULARY
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.status import exit_status


def add(group: Any) -> None:
    """The parser of ``topomap explain``."""
    made = command(
        group,
        "explain",
        f"""\
  topomap explain instances/grid-3x3-snake.lp "same(3,12)"
  topomap explain instances/grid-4x4-snake.lp "not same(0,30)" --planar --bound 16
  topomap explain instances/manhattan-tour20.lp --closed

{VOCABULARY}""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument("statement", nargs="?", metavar="STATEMENT")
    add_query(made, DEMANDS)


def run(args: argparse.Namespace) -> int:
    """Tell why a statement is so."""
    from topomap.api.explain import explain
    from topomap.model.facts import read
    from topomap.runtime.watch import heeding

    experience = read(args.instance)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            answer = explain(
                experience,
                args.statement,
                bound=args.bound,
                horizon=args.horizon,
                watch=watch,
                **parts_of(args, DEMANDS),
            )
        if args.json:
            out.write(formats.line({"instance": args.instance, **answer.document()}, answer.fault))
        else:
            out.writelines(f"{line}\n" for line in answer.lines())
    return exit_status(answer.fault, answer.verdict not in ("open", "map"))
