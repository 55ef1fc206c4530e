"""The subcommand ``count``."""

from typing import Any

from topomap.cli.arguments import add_crew, add_encoding, add_query, add_resume, command
from topomap.model.vocabulary import OPTIMIZING, PARTS


def add(group: Any) -> None:
    """The parser of ``topomap count``."""
    made = command(
        group,
        "count",
        "count the search tree of an exploration, as the paper's Figure 4 does",
        """\
  topomap count instances/grid-4x4-snake.lp --planar --bound 16
  topomap count instances/grid-4x4-snake.lp --jobs 2""",
    )
    made.add_argument("instance", metavar="INSTANCE")
    add_query(made, [part for part in PARTS if part not in OPTIMIZING])
    add_crew(made)
    add_encoding(made)
    add_resume(made)
