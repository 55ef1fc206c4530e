"""The subcommand ``branching``."""

import argparse
import json
from typing import IO, TYPE_CHECKING, Any

from topomap.cli.arguments import add_instance, add_known, add_query, command
from topomap.cli.calls import asked_query, experience_of
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.api.branching import BranchingNodes


def add(group: Any) -> None:
    """The parser of ``topomap branching``."""
    made = command(
        group,
        "branching",
        "  topomap branching instances/grid-4x4-snake.lp --bound 16",
    )
    add_instance(made)
    add_known(made)
    add_query(made, ["perpendicular"])


def run(args: argparse.Namespace) -> int:
    """Check the paper's equation (1) at every branching node of the planar tree."""
    from topomap.api.branching import branching_nodes_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            nodes = branching_nodes_under(watch, experience, asked_query(args))
            if args.json:
                _write(out, args.instance, nodes)
            else:
                for _ in nodes:
                    pass
        if not args.json:
            out.writelines(f"{line}\n" for line in nodes.lines())
    return exit_status(nodes.fault, nodes.holds)


def _write(out: IO[str], instance: str, nodes: "BranchingNodes") -> None:
    """Write the nodes as JSON, each as it is found, and then their totals."""
    head = formats.headed({"instance": instance})
    out.write(json.dumps(head)[:-1] + ', "nodes": [')
    for number, node in enumerate(nodes):
        out.write(",\n" * (number > 0) + json.dumps(node.document()))
    tail = {"summary": nodes.totals, **formats.ended(nodes.fault)}
    out.write("], " + json.dumps(tail)[1:] + "\n")
