"""The subcommand ``explain``."""

from typing import Any

from topomap.cli.arguments import add_query, command
from topomap.model.vocabulary import DEMANDS, VOCABULARY


def add(group: Any) -> None:
    """The parser of ``topomap explain``."""
    made = command(
        group,
        "explain",
        "tell why a statement about the maps is impossible, or certain, or why there is no map: "
        "reasons none of which can be spared. (Of all maps, not of the optimal ones: that "
        "another map is better is no reason of this kind)",
        f"""\
  topomap explain instances/grid-3x3-snake.lp "same(3,12)"
  topomap explain instances/grid-4x4-snake.lp "not same(0,30)" --planar --bound 16
  topomap explain instances/manhattan-tour20.lp --closed

{VOCABULARY}""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    made.add_argument("statement", nargs="?", metavar="STATEMENT")
    add_query(made, DEMANDS)
