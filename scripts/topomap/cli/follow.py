"""The subcommand ``follow``."""

from typing import Any

from topomap.cli.arguments import command, number
from topomap.model.vocabulary import PARTS
from topomap.runtime.limits import MOST_COUNTED


def add(group: Any) -> None:
    """The parser of ``topomap follow``."""
    made = command(
        group,
        "follow",
        "follow an exploration as it happens: after each step the number of hypotheses, the best "
        "maps, what has become certain, and what to do next",
        """\
  topomap follow walk.lp --planar
  topomap follow instances/grid-3x3-snake.lp --no-wait --json
  robot | topomap follow - --log walk.log

lines: the facts of a step, as generate writes them: turn(1,0). view(1,0). view(1,2).
  or JSON: {"slots": 4, "view": [0, 1]} first, then {"turn": 2, "view": [0, 2]}; each may have
  "landmarks": ["a"], and "drop", "pick" or "marker": true. undo. or {"undo": 2} takes the last
  steps back. Facts that a line adds to the last step amend it.

what is certain: new(T), the place where the agent is after step T was not visited before;
  same(T,U) and linked(T,S,U,R) as topomap ask --help has them. It stays certain.""",
    )
    add = made.add_argument
    add(
        "file",
        nargs="?",
        default="-",
        metavar="FILE",
        help="a file that grows, followed until Ctrl-C (default: standard input, to its end)",
    )
    add(
        "--log",
        metavar="FILE",
        help="with standard input: write each line there before it is answered; if it has lines, "
        "go on after them",
    )
    add("--planar", action="store_true", help=PARTS["planar"])
    add("--bound", type=number(int, 1), metavar="B", help="at most B places")
    add("--marker", action="store_true", help="the agent carries a marker, for what to do next")
    add(
        "--count-limit",
        type=number(int, 1),
        default=MOST_COUNTED,
        metavar="N",
        help="of more hypotheses say only that they are more (default: %(default)s)",
    )
    add("--timeout", type=number(float, 0.001), metavar="S", help="at most S seconds a step")
    add(
        "--keep-going",
        action="store_true",
        help="tell of lines with a fault, and pass over them (status 0)",
    )
    add("--no-wait", dest="wait", action="store_false", help="end at the end of the file")
    add("--json", action="store_true", help="a line of JSON for each step")
