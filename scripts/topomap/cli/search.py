"""The subcommand ``search``."""

from typing import Any

from topomap.cli.arguments import add_query, command
from topomap.model.vocabulary import PRUNING


def add(group: Any) -> None:
    """The parser of ``topomap search``."""
    made = command(
        group,
        "search",
        "search the tree of an exploration, as the paper does, without clingo",
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
        help="breadth: step by step, counts the whole tree; depth: the same in little memory; "
        "best: by the optimality policy, until a closed map is found (default: %(default)s)",
    )
    add_query(made, PRUNING)
