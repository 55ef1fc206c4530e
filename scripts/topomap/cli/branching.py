"""The subcommand ``branching``."""

import argparse
import json
from typing import Any

from topomap.cli.arguments import add_query, command
from topomap.cli.calls import parts_of
from topomap.runtime import formats
from topomap.runtime.files import output


def add(group: Any) -> None:
    """The parser of ``topomap branching``."""
    made = command(
        group,
        "branching",
        "  topomap branching instances/grid-4x4-snake.lp --bound 16",
    )
    made.add_argument("instance", metavar="INSTANCE")
    add_query(made, ["perpendicular"])


def run(args: argparse.Namespace) -> int:
    """Check the paper's equation (1) at every branching node of the planar tree."""
    from topomap.model.facts import read
    from topomap.model.query import Query
    from topomap.runtime.watch import Run
    from topomap.search import branching, traversal

    experience = read(args.instance)
    query = Query(frozenset(parts_of(args)), args.bound, args.horizon).having("planar")
    summary = branching.Summary()
    with output(args.output) as out:
        if args.json:
            head = formats.headed({"instance": args.instance})
            out.write(json.dumps(head)[:-1] + ', "nodes": [')
        with Run(args.timeout) as made:
            for node in branching.branching(traversal.root(experience, query), made.watch):
                if args.json:
                    out.write(",\n" * (made.watch.found > 1) + json.dumps(node.json()))
                summary.add(node)
        if args.json:
            tail = {"summary": summary.totals, **formats.ended(made.fault)}
            out.write("], " + json.dumps(tail)[1:] + "\n")
        else:
            out.write(branching.text(summary.totals))
            if made.fault:
                out.write(f"partial: {made.fault}; the figures are of the nodes met until then\n")
    return made.status(summary.holds)
