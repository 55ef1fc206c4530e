"""The subcommand ``ask``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_instance, add_known, add_optimal, add_query, command
from topomap.cli.calls import asked_query, experience_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import PARTS, VOCABULARY
from topomap.runtime.files import output


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
    add_instance(made)
    made.add_argument(
        "statement",
        nargs="+",
        metavar="STATEMENT",
        help="a statement about the maps, such as 'same(3,12)' (see below)",
    )
    add_known(made)
    add_optimal(made)
    add_query(made, PARTS)


def run(args: argparse.Namespace) -> int:
    """Settle statements."""
    from topomap.api.ask import ask_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            answers = ask_under(watch, experience, args.statement, asked_query(args), args.optimal)
        return tell(args, out, answers, bool(answers.has_maps), args.instance)
