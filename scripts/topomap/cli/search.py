"""The subcommand ``search``."""

import argparse
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_query, command
from topomap.cli.calls import parts_of
from topomap.model.vocabulary import PRUNING
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.model.experience import Experience
    from topomap.model.query import Query


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
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument(
        "--order",
        choices=("breadth", "depth", "best"),
        default="breadth",
        help="breadth: count the whole tree step by step; depth: the same in little memory; best: "
        "best map first, until a closed map is found (default: %(default)s)",
    )
    add_query(made, PRUNING)


def run(args: argparse.Namespace) -> int:
    """Search the tree of an instance: count it, or find a closed map best-first."""
    from topomap.model.facts import read
    from topomap.model.query import Query
    from topomap.paper import statistics
    from topomap.runtime.watch import Run
    from topomap.search import traversal

    experience = read(args.instance)
    query = Query(frozenset(parts_of(args)), args.bound, args.horizon)
    if args.order == "best":
        return _best_first(args, experience, query)
    node = traversal.root(experience, query)
    tally = statistics.Tally(node.experience.steps)
    with output(args.output) as out:
        with Run(args.timeout) as made:
            for _ in traversal.ORDERS[args.order](node, made.watch):
                tally.add(node)
                made.watch.found = tally.per_step[-1]
        figures = tally.told(made.fault, args.order)
        if args.json:
            out.write(formats.line({"instance": args.instance, **figures}, made.fault))
        else:
            out.write(statistics.text(figures, made.fault))
    return made.status(bool(tally.per_step[-1]))


def _best_first(args: argparse.Namespace, experience: "Experience", query: "Query") -> int:
    """The paper's best-first search, with backtracking while the map is not closed."""
    from topomap.documents.answers import Report
    from topomap.documents.maps import BEST_FIRST
    from topomap.model.found import Found
    from topomap.runtime.watch import Attempt, heeding
    from topomap.search import traversal

    nodes = 0
    with output(args.output) as out, heeding(args.timeout) as watch:
        report = Report(out, args.instance, experience, query, BEST_FIRST, None, args.json)
        with Attempt() as attempt:
            for node in traversal.best_first(traversal.root(experience, query), watch):
                nodes += 1
                if node.steps == node.experience.steps and node.closed():
                    report.add(Found(node.dstates, BEST_FIRST, node.cost, proved=False))
                    break
        report.end(attempt.fault, nodes=nodes)
    return exit_status(attempt.fault, bool(report.count))
