"""The subcommand ``branching``."""

from typing import Any

from topomap.cli.arguments import add_query, command


def add(group: Any) -> None:
    """The parser of ``topomap branching``."""
    made = command(
        group,
        "branching",
        "check the paper's equation (1), bp/b = (pi / mean p) / (m + 1), at every branching node "
        "of the planar tree",
        "  topomap branching instances/grid-4x4-snake.lp --bound 16",
    )
    made.add_argument("instance", metavar="INSTANCE")
    add_query(made, ["perpendicular"])
