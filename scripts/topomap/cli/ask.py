"""The subcommand ``ask``."""

from typing import Any

from topomap.cli.arguments import add_encoding, add_optimal, add_query, command
from topomap.model.vocabulary import PARTS, VOCABULARY


def add(group: Any) -> None:
    """The parser of ``topomap ask``."""
    made = command(
        group,
        "ask",
        "tell of each statement whether it holds in all maps that are consistent with an "
        "exploration, in some or in none, with maps that show it",
        f"""\
  topomap ask instances/grid-4x4-snake.lp "same(3,12)" "places < 12" --planar --closed
  topomap ask instances/grid-3x3-snake.lp "linked(3,2,12,0)" "not planar" --optimal --json

{VOCABULARY}""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument("statement", nargs="+", metavar="STATEMENT")
    add_optimal(made)
    add_query(made, PARTS)
    add_encoding(made)
