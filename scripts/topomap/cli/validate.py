"""The subcommand ``validate``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_measured, command
from topomap.runtime import formats
from topomap.runtime.errors import printable
from topomap.runtime.status import BAD_INPUT, DONE


def add(group: Any) -> None:
    """The parser of ``topomap validate``."""
    made = command(
        group,
        "validate",
        """\
  topomap validate walk.lp
  topomap validate instances/*.lp --json
  echo 'slots(4). veiw(0,0). turn(1,0).' | topomap validate -""",
    )
    add = made.add_argument
    add("file", nargs="+", metavar="FILE", help="an instance; - is standard input")
    add_measured(made)
    add("--json", action="store_true", help="write JSON")


def run(args: argparse.Namespace) -> int:
    """Tell what is wrong with each file; the status is 2 if anything is."""
    from topomap.api.validate import validate

    given = {"drift": args.drift, "stretch": args.stretch}
    measured = {name: value for name, value in given.items() if value is not None}
    judged = (validate(path, **measured) for path in args.file)
    if args.json:
        whole = list(judged)
        print(formats.line({"files": [one.document() for one in whole]}), end="")
        return DONE if all(one.valid for one in whole) else BAD_INPUT
    status = DONE
    for one in judged:
        print(*map(printable, one.lines()), sep="\n", flush=True)
        status = status if one.valid else BAD_INPUT
    return status
