"""The subcommand ``validate``."""

from typing import Any

from topomap.cli.arguments import command


def add(group: Any) -> None:
    """The parser of ``topomap validate``."""
    made = command(
        group,
        "validate",
        "tell all that is wrong with instances, and what in them looks like a mistake, without "
        "solving anything; status 2 if one of them has a fault (a warning is none)",
        """\
  topomap validate walk.lp
  topomap validate instances/*.lp --json
  echo 'slots(4). veiw(0,0). turn(1,0).' | topomap validate -""",
    )
    add = made.add_argument
    add("file", nargs="+", metavar="FILE", help="an instance; - is standard input")
    add("--json", action="store_true", help="write JSON")
