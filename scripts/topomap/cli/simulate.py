"""The subcommand ``simulate``."""

import argparse
from typing import Any

from topomap.cli.arguments import (
    Parser,
    add_asked,
    add_environments,
    add_start,
    command,
    number,
)
from topomap.model.vocabulary import PRUNING
from topomap.runtime.limits import MOST_STEPS


def add(group: Any) -> None:
    """The parser of ``topomap simulate``."""
    made = command(
        group,
        "simulate",
        "let a robot explore an environment that it does not know, until it has one closed "
        "optimal map, and hold that against the truth",
        """\
  topomap simulate grid 3 3
  topomap simulate maze 4 4 --seed 2 --signs 0.3 --perpendicular
  topomap simulate network city.graphml --slots 4 --north 29 --signs 0.3 --planar
  topomap simulate list instances/worlds.txt""",
    )
    common = Parser(add_help=False)
    add = common.add_argument
    add_start(add, "the smallest")
    add("--seed", type=number(int, 0), metavar="N", help="for signs and maze (default: 0)")
    add(
        "--steps",
        type=number(int, 0, MOST_STEPS),
        metavar="N",
        help="walk N steps at most (default: 20 for each way)",
    )
    add("--marker", action="store_true", help="it carries a marker, and may put it down")
    add("--instance", metavar="FILE", help="also write what it did and saw, as an instance")
    add_asked(common, PRUNING, horizon=False)
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    kinds = add_environments(made, common, "--signs 0.3")
    help = "several of them, one a line of a file: the arguments of topomap simulate"
    listed = kinds.add_parser(
        "list",
        help=help,
        description=help,
        epilog="example:\n  topomap simulate list instances/worlds.txt",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = listed.add_argument
    add("file", metavar="FILE")
    add("--timeout", type=number(float, 0.001), metavar="S", help="stop after S seconds")
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
