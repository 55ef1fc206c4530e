"""The subcommand ``log``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_straight, command, number, number_or_auto
from topomap.runtime import formats
from topomap.runtime.errors import say
from topomap.runtime.files import output
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import DONE


def add(group: Any) -> None:
    """The parser of ``topomap log``."""
    made = command(
        group,
        "log",
        """\
  topomap log walk.csv -o walk.lp
  topomap log walk.jsonl --frame north --straight-ways 20 -o walk.lp
  printf 'exits,taken\\nN,N\\nS E,\\n' | topomap log - --straight-ways 0""",
    )
    add = made.add_argument
    add("file", metavar="FILE", help="CSV or JSON lines, a row for each visit; - is standard input")
    add(
        "--slots",
        type=number_or_auto(int, 2),
        metavar="K",
        help="number of directions at a place, which must be even; auto: the smallest number "
        "that fits the bearings, otherwise 360 (default: auto)",
    )
    add(
        "--tolerance",
        type=number_or_auto(int, 0),
        metavar="N",
        help="bearings may be wrong by N slots; auto: 0 if they fit the slots, otherwise "
        "measured where the log certainly comes to a place again (default: auto)",
    )
    add(
        "--frame",
        choices=("arrival", "north"),
        help="from where bearings count: arrival, the exit by which one arrived; or north "
        "(default: north if there are compass letters, otherwise arrival)",
    )
    add(
        "--facing",
        choices=("back", "ahead"),
        default="back",
        help="where bearing 0 is, if bearings count from the arrival: back, at the way back; or "
        "ahead, so that the way back is at 180 (default: back)",
    )
    add(
        "--straight-ways",
        type=number(float, 0, 180),
        metavar="DEGREES",
        help="if bearings count from north: a way bends by at most DEGREES degrees from one "
        "place to the next, which determines the exit by which one arrived if the log does "
        "not name it (default: nothing is known about bends)",
    )
    add_straight(add, "; if no number of slots fits the bearings, the limit is chosen")
    add(
        "--unit",
        type=number(float, 1e-9, LARGEST),
        metavar="U",
        help="the length in the log that is one unit of the instance (default: 1, or 0.01 if "
        "some lengths are fractions)",
    )
    add("--json", action="store_true", help="print a summary as JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Read a log, and write it as an instance."""
    from topomap.api.log import read_log

    log = read_log(
        args.file,
        slots=args.slots,
        tolerance=args.tolerance,
        frame=args.frame,
        facing=args.facing,
        straight_ways=args.straight_ways,
        straight=args.straight,
        unit=args.unit,
    )
    if args.output or not args.json:
        with output(args.output) as file:
            file.write(log.text())
    for warning in log.warnings:
        say(f"warning: {warning}")
    if log.chosen:
        say(log.chosen)
    if args.json:
        print(formats.line({**log.document(), "file": args.output}), end="")
    return DONE
