"""The subcommand ``check``."""

from typing import Any

from topomap.cli.arguments import add_query, command, number
from topomap.model.vocabulary import PROPERTIES


def add(group: Any) -> None:
    """The parser of ``topomap check``."""
    made = command(
        group,
        "check",
        "check maps that anyone made, by encodings/check.lp and by a second checker "
        "(a time limit ends it between two maps)",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --json -o maps.json
  topomap check instances/grid-3x3-snake.lp maps.json --planar""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument(
        "maps",
        metavar="MAPS.json",
        help="from topomap solve --json or clingo --outf=2; a map needs at, [[T,P,S], ...], "
        "and what else it has is verified; of all the maps are verified the parts, bound, "
        "horizon, kind, cost and count, not whether they are all that there are",
    )
    made.add_argument(
        "--truth", metavar="FILE", help="the real map (from generate --truth), for the key real"
    )
    made.add_argument(
        "--noise",
        type=number(int, 0),
        metavar="K",
        help="a map may disbelieve K views (its key misread), and no more than it says itself",
    )
    add_query(made, PROPERTIES, horizon=False)
