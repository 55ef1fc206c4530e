"""The subcommand ``search``."""

import argparse
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_instance, add_known, add_query, command
from topomap.cli.calls import asked_query, experience_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import PRUNING
from topomap.runtime.files import output
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.model.experience import Experience


def add(group: Any) -> None:
    """The parser of ``topomap search``."""
    made = command(
        group,
        "search",
        """\
  topomap search instances/grid-4x4-snake.lp --planar --bound 16
  topomap search instances/grid-4x4-snake.lp --order depth
  topomap search instances/grid-4x4-snake.lp --order best --planar --perpendicular""",
    )
    add_instance(made)
    add_known(made)
    made.add_argument(
        "--order",
        choices=("breadth", "depth", "best"),
        default="breadth",
        help="breadth: count the whole tree step by step; depth: count it with little memory; "
        "best: the best map first, until a closed map is found (default: %(default)s)",
    )
    add_query(made, PRUNING)


def run(args: argparse.Namespace) -> int:
    """Search the tree of an instance: count it, or find a closed map best-first."""
    from topomap.api.search import count_by_search_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    if args.order == "best":
        return _best_first(args, experience)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            counts = count_by_search_under(watch, experience, asked_query(args), args.order)
        return tell(args, out, counts, bool(counts["final"]), args.instance)


def _best_first(args: argparse.Namespace, experience: "Experience") -> int:
    """Find a closed map best-first, and write it as ``solve`` does."""
    from topomap.api.search import first_closed_under
    from topomap.documents.answers import Report
    from topomap.documents.maps import BEST_FIRST
    from topomap.runtime.watch import heeding

    query = asked_query(args)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            first = first_closed_under(watch, experience, query)
        report = Report(out, args.instance, experience, query, BEST_FIRST, None, args.json)
        if first.found:
            report.add(first.found)
        report.end(first.fault, nodes=first.nodes)
    return exit_status(first.fault, bool(first.found))
