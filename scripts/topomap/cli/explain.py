"""The subcommand ``explain``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_instance, add_known, add_query, command
from topomap.cli.calls import asked_query, experience_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import DEMANDS, RELAXING, VOCABULARY
from topomap.runtime.files import output


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
    add_instance(made)
    made.add_argument(
        "statement",
        nargs="?",
        metavar="STATEMENT",
        help="the statement to explain, such as 'same(3,12)' (see below; default: explain "
        "why there is no map)",
    )
    add_known(made)
    add_query(made, (*DEMANDS, *RELAXING))


def run(args: argparse.Namespace) -> int:
    """Tell why a statement is impossible or certain."""
    from topomap.api.explain import explain_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            answer = explain_under(watch, experience, args.statement, asked_query(args))
        return tell(args, out, answer, answer.verdict not in ("open", "map"), args.instance)
