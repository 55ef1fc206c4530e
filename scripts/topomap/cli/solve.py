"""The subcommand ``solve``."""

from typing import Any

from topomap.cli.arguments import (
    add_crew,
    add_encoding,
    add_optimal,
    add_query,
    add_resume,
    command,
    number,
)
from topomap.model.vocabulary import PARTS


def add(group: Any) -> None:
    """The parser of ``topomap solve``."""
    made = command(
        group,
        "solve",
        "enumerate the maps that are consistent with an exploration",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --closed
  topomap solve instances/grid-3x4-paper.lp --optimal --json
  topomap solve instances/grid-4x4-snake.lp --bound 16 --jobs 2 -o maps.txt
  topomap solve instances/grid-3x3-misread.lp --optimal --planar --noise 1""",
    )
    made.add_argument("instance", nargs="+", metavar="INSTANCE")
    add_optimal(made)
    made.add_argument("--limit", type=number(int, 1), metavar="N", help="stop after N maps")
    made.add_argument(
        "--truth",
        metavar="FILE",
        help="mark the maps that are the real one (from generate --truth)",
    )
    made.add_argument(
        "--by",
        choices=("clingo", "search"),
        default="clingo",
        help="which of the two ways gives the answer (default: %(default)s)",
    )
    add_query(made, PARTS)
    add_crew(made, "; not with --optimal, --minimal or --genus")
    add_encoding(made)
    made.set_defaults(encoding=None)  # the plain one with --noise, else the fast one
    add_resume(made)
    made.add_argument(
        "--noise",
        type=number(int, 0),
        metavar="K",
        help="allow up to K wrong views, as few as can be: gateways and landmarks missed or "
        "imagined; by the plain encoding",
    )
