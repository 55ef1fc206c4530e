"""The subcommand ``explore``."""

from typing import Any

from topomap.cli.arguments import add_query, command, number
from topomap.model.vocabulary import PRUNING
from topomap.runtime.limits import LONGEST_WALK


def add(group: Any) -> None:
    """The parser of ``topomap explore``."""
    made = command(
        group,
        "explore",
        "say where to go next: the shortest further walk that tells the maps apart, or leaves the "
        "fewest in the worst case; if there is none, to a pending gateway; or the proof that no "
        "walk ever tells them",
        """\
  topomap explore instances/grid-4x4-snake.lp --bound 16
  topomap generate grid 4 4 --route snake --truth truth.json -o grid.lp
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --marker
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --proof proof.json
  topomap explore grid.lp --check proof.json
  topomap explore grid.lp --bound 16 --facts | clingo encodings/explore.lp - -c n=3""",
    )
    add = made.add_argument
    add("instance", metavar="INSTANCE")
    add(
        "--among",
        action="append",
        metavar="MAPS",
        help="the maps that may be the real one: optimal (the best so far, where nothing is "
        "closed), closed, perpendicular (and closed), or a file of maps of this instance; more "
        "than once for all of them (default: optimal)",
    )
    add("--marker", action="store_true", help="the agent carries a marker, to be dropped once")
    add(
        "--steps",
        type=number(int, 1, 1000),
        default=LONGEST_WALK,
        metavar="N",
        help="walks of at most N steps (default: %(default)s)",
    )
    add("--proof", metavar="FILE", help="write there why no walk tells maps apart, for --check")
    what = made.add_mutually_exclusive_group()
    what.add_argument("--check", metavar="FILE", help="check the proofs that --proof wrote there")
    what.add_argument(
        "--facts", action="store_true", help="print the maps as facts for encodings/explore.lp"
    )
    add_query(made, PRUNING)
