"""The subcommand ``generate``."""

from typing import Any

from topomap.cli.arguments import Parser, add_environments, add_start, command, number
from topomap.runtime.limits import MOST_STEPS


def add(group: Any) -> None:
    """The parser of ``topomap generate``."""
    made = command(
        group,
        "generate",
        "explore an environment and write what is seen as an instance",
        """\
  topomap generate grid 3 4 --route snake -o grid-3x4-snake.lp
  topomap generate torus 3 3 --route walk --steps 20 --seed 1
  topomap generate network city.graphml --slots 4 --north 29 --route tour --signs 0.3""",
    )
    common = Parser(add_help=False)
    add = common.add_argument
    add(
        "--route",
        required=True,
        metavar="ROUTE",
        help="snake; walk (random); tour (over every way); compass letters such as ESSENN "
        "(4 slots; with 8, apart by commas: N,NE,E); or absolute slots: 0,3,1",
    )
    add("--steps", type=number(int, 0, MOST_STEPS), metavar="N", help="cut the route after N steps")
    add_start(add, "the one first left by")
    add("--seed", type=number(int, 0), metavar="N", help="for walk, signs and maze (default: 0)")
    add("--name", help="name of the instance (default: made from the arguments)")
    add("--truth", metavar="FILE", help="also write the true hypothesis, for solve --truth")
    add("--json", action="store_true", help="print a summary as JSON")
    add("-o", "--output", metavar="FILE", help="file or folder to write (default: stdout)")
    add_environments(made, common, "--route tour")
