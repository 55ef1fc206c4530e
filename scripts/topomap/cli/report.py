"""The subcommand ``report``."""

from typing import Any

from topomap.cli.arguments import add_asked, command, number
from topomap.model.vocabulary import PRUNING


def add(group: Any) -> None:
    """The parser of ``topomap report``."""
    made = command(
        group,
        "report",
        "tell all about explorations in one page to be opened in a browser: the log, how many "
        "hypotheses, what was refused, the best maps, and a replay step by step; what is not "
        "counted or drawn within --timeout (default: 60) says so",
        """\
  topomap report instances/grid-3x3-snake.lp -o report.html
  topomap report instances/grid-4x4-snake.lp --bound 16 --timeout 120 -o report.html""",
    )
    add = made.add_argument
    add("instance", nargs="+", metavar="INSTANCE")
    add(
        "--maps",
        type=number(int, 0),
        default=6,
        metavar="N",
        help="draw N of the best maps at most (default: %(default)s)",
    )
    add(
        "--maps-from",
        metavar="MAPS.json",
        help="tell of these maps instead of the best ones, from clingo --outf=2 or topomap solve "
        "--json (- is standard input)",
    )
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    add_asked(made, PRUNING)
    made.set_defaults(timeout=60.0)
