"""The subcommand ``follow``."""

import argparse
import time
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_measured, add_tolerance, command, number
from topomap.model.vocabulary import PARTS
from topomap.runtime import formats
from topomap.runtime.errors import InputError, say
from topomap.runtime.limits import MOST_COUNTED
from topomap.runtime.status import DONE, INTERRUPT, NO, PARTIAL

if TYPE_CHECKING:
    from topomap.api.follow import Follower
    from topomap.questions.lines import Log


def add(group: Any) -> None:
    """The parser of ``topomap follow``."""
    made = command(
        group,
        "follow",
        """\
  topomap follow walk.lp --planar
  topomap follow instances/grid-3x3-snake.lp --no-wait --json
  topomap follow walk.lp --no-path-axiom
  robot | topomap follow - --log walk.log

lines: the facts of a step, as generate writes them: turn(1,0). view(1,0). view(1,2).
  or JSON: {"slots": 4, "view": [0, 1]} first, then {"turn": 2, "view": [0, 2]}; each may have
  "landmarks": ["a"], and "drop", "pick" or "marker": true, or the name of a marker; "compass": 2,
  "shift": [3, -1], "length": 12, "straight": [[0, 5]], the pairs of gateways that are on one
  path (given from the first line on, or not at all), and "same": [4] or "apart": [4], the
  earlier steps after which the agent was at this place, or at another one. In the place of a
  turn there may be "start": true, where a new log begins, or "look": true, a second look.
  undo. or {"undo": 2} takes the last steps back. Facts that a line adds to the last step amend it.
what is certain: new(T), the place where the agent is after step T was not visited before;
  same(T,U) and linked(T,S,U,R) as in topomap ask --help. What is certain stays certain.""",
    )
    add = made.add_argument
    add(
        "file",
        nargs="?",
        default="-",
        metavar="FILE",
        help="a file that grows, read until Ctrl-C (default: standard input, to its end)",
    )
    add(
        "--log",
        metavar="FILE",
        help="with standard input: write each line to FILE before it is answered (default: not "
        "written); if FILE has lines already, go on after them",
    )
    add("--planar", action="store_true", help=f"{PARTS['planar']}; of one log only (no start)")
    add("--no-path-axiom", action="store_true", help=PARTS["no_path_axiom"])
    add("--bound", type=number(int, 1), metavar="B", help="at most B places (default: no bound)")
    add(
        "--marker",
        action="store_true",
        help="the agent carries a marker, which the next steps may use",
    )
    add(
        "--count-limit",
        type=number(int, 1),
        default=MOST_COUNTED,
        metavar="N",
        help="if there are more than N hypotheses, report only "
        '"more than N" (default: %(default)s)',
    )
    add_measured(made)
    add_tolerance(made)
    add(
        "--timeout",
        type=number(float, 0.001),
        metavar="S",
        help="take at most S seconds for each step (default: no limit)",
    )
    add(
        "--keep-going",
        action="store_true",
        help="report lines with a fault, and go on with the next line (the status is then 0)",
    )
    add("--no-wait", dest="wait", action="store_false", help="stop at the end of the file")
    add("--json", action="store_true", help="a line of JSON for each step")


def run(args: argparse.Namespace) -> int:
    """Follow an exploration, and tell after each step what is known."""
    from topomap.api.follow import follow
    from topomap.questions.lines import Log, arriving, decoded
    from topomap.runtime.watch import Stopped, heeding

    if args.log is not None and args.file != "-":
        raise InputError("topomap follow: --log is for standard input; a FILE is its own log")
    follower = follow(
        planar=args.planar,
        no_path_axiom=args.no_path_axiom,
        bound=args.bound,
        marker=args.marker,
        count_limit=args.count_limit,
        drift=args.drift,
        stretch=args.stretch,
        tolerance=args.tolerance,
    )
    log = Log(args.log) if args.log is not None else None
    source = "standard input" if args.file == "-" else args.file
    status = DONE
    with heeding(quiet=True) as outer:
        coming = arriving(args.file, args.wait, outer.tick)
        try:
            if log:
                status = _replay(args, follower, log)
            for line_number, line in enumerate(coming, 1):
                begun = time.monotonic()
                try:
                    text = decoded(line, source, line_number)
                    record = follower.record.with_line(text, source, line_number)
                except InputError as error:
                    if not args.keep_going:
                        raise
                    say(str(error))
                    continue
                if log and record != follower.record:
                    log.add(text)
                for _ in follower.take(record):
                    status = _tell(args, follower, begun, status)
                    begun = time.monotonic()
                    outer.tick()
        except Stopped:
            raise KeyboardInterrupt from None
    if (lack := follower.record.lack()) or not follower.record.steps:
        raise InputError(f"{source}: {lack or 'no step in it'}")
    return status


def _replay(args: argparse.Namespace, follower: "Follower", log: "Log") -> int:
    """Go to the end of a log, say what is known there, and return the exit status so far."""
    from topomap.questions.lines import decoded

    record = follower.record
    for line_number, line in log.lines():
        record = record.with_line(decoded(line, log.path, line_number), log.path, line_number)
    begun = time.monotonic()
    for _ in follower.take(record):
        pass
    return _tell(args, follower, begun, DONE) if follower.record.whole() else DONE


def _tell(args: argparse.Namespace, follower: "Follower", begun: float, before: int) -> int:
    """Print what is known now, and return the exit status.

    ``before`` is the exit status so far; once it is partial, it stays so.
    """
    from topomap.runtime.watch import Stopped, heeding

    with heeding(args.timeout) as watch:
        known = follower.status(watch)
    if known.fault == INTERRUPT:
        raise Stopped(INTERRUPT)
    seconds = time.monotonic() - begun
    if args.json:
        answer = {**known.document(), "seconds": round(seconds, 4)}
        print(formats.line(answer, known.fault), end="", flush=True)
    else:
        print("\n".join(known.lines(seconds)), flush=True)
    if known.fault or before == PARTIAL:
        return PARTIAL
    return DONE if known.none_since is None else NO
