"""The subcommand ``simulate``."""

import argparse
import contextlib
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import (
    NO_LIMIT,
    Parser,
    add_asked,
    add_environments,
    add_measured,
    add_senses,
    add_start,
    command,
    number,
)
from topomap.cli.calls import asked_query, environment_of, senses_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import CHOSEN
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import output
from topomap.runtime.limits import MOST_STEPS
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.api.simulate import Simulation
    from topomap.runtime.watch import Watch
    from topomap.worlds.environment import Environment


def add(group: Any) -> None:
    """The parser of ``topomap simulate``."""
    made = command(
        group,
        "simulate",
        """\
  topomap simulate grid 3 3
  topomap simulate maze 4 4 --seed 2 --signs 0.3 --perpendicular
  topomap simulate torus 3 3 --no-path-axiom --signs 0.5
  topomap simulate world city.graphml --slots 4 --north 29 --signs 0.3 --planar
  topomap simulate list instances/worlds.txt""",
    )
    common = Parser(add_help=False)
    add = common.add_argument
    add_start(add, "the smallest")
    add(
        "--seed",
        type=number(int, 0),
        metavar="N",
        help="seed for signs, maze and odometry (default: 0)",
    )
    add(
        "--steps",
        type=number(int, 0, MOST_STEPS),
        metavar="N",
        help="walk at most N steps (default: 20 for each way)",
    )
    add_senses(add)
    add_measured(common)
    add("--marker", action="store_true", help="the robot carries a marker, and may put it down")
    add(
        "--instance",
        metavar="FILE",
        help="also write what the robot did and saw, as an instance (default: not written)",
    )
    add_asked(common, CHOSEN, horizon=False)
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    kinds = add_environments(made, common, "--signs 0.3")
    help = "several environments: each line of a file has the arguments of topomap simulate"
    listed = kinds.add_parser(
        "list",
        help=help,
        description=help,
        epilog="example:\n  topomap simulate list instances/worlds.txt",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = listed.add_argument
    add("file", metavar="FILE", help="a file in which each line is one environment")
    add(
        "--timeout",
        type=number(float, 0.001),
        metavar="S",
        help=NO_LIMIT,
    )
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Let a robot explore a world, or robots explore a list of worlds."""
    if args.kind == "list":
        return _list(args)
    from topomap.runtime.watch import heeding

    environment = _environment(args)
    with contextlib.ExitStack() as files:
        out = files.enter_context(output(args.output))
        instance = args.instance and files.enter_context(output(args.instance))
        with heeding(args.timeout) as watch:
            watch.title(environment.name)
            made = _simulated(args, environment, watch)
        if instance:
            instance.write(f"% what a robot did and saw in {made.name}\n\n")
            instance.write(made.experience.facts())
        return tell(args, out, made, made.outcome.found)


def _environment(args: argparse.Namespace) -> "Environment":
    """Make the environment of a call.

    Raises:
        InputError: There is no such environment, or no such start in it.
    """
    from topomap.questions.robot import start_of

    environment = environment_of(args)
    if args.signs:
        environment = environment.signed(args.signs, args.seed or 0)
    start_of(environment, args.start, args.facing)
    return environment


def _simulated(
    args: argparse.Namespace, environment: "Environment", watch: "Watch"
) -> "Simulation":
    from topomap.api.simulate import simulate_under

    query = asked_query(args, CHOSEN)
    how = args.start, args.facing, args.steps, args.marker, senses_of(args)
    return simulate_under(watch, environment, query, *how)


def _list(args: argparse.Namespace) -> int:
    """Let a robot explore the world of each line of a file, and write a table."""
    from topomap.questions.robot import ENDED, ENDS, table
    from topomap.runtime.watch import heeding

    calls = list(_calls(args))
    rows: list[dict[str, Any]] = []
    fault = None
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            for call, parsed, environment in calls:
                watch.title(call)
                made = _simulated(parsed, environment, watch)
                if made.end not in ENDS or made.outcome.others.fault:
                    fault = made.fault
                    break
                rows.append({**made.document(), "environment": call})
        if any(row["end"] not in ENDED for row in rows):
            fault = fault or "steps"
        if args.json:
            json.dump(formats.answer({"rows": rows}, fault), out, indent=1)
            out.write("\n")
        else:
            out.write(table(rows))
            if fault:
                out.write(f"partial: {fault}; {len(rows)} of {len(calls)} lines\n")
    return exit_status(fault, all(row["truth"] for row in rows))


def _calls(args: argparse.Namespace) -> "Iterator[tuple[str, argparse.Namespace, Environment]]":
    """Parse the lines of the file, each with its environment.

    Raises:
        InputError: A line is not a call, or its start is not in its world; the message names the
            line.
    """
    from topomap.cli import parse
    from topomap.worlds.family import expand

    for line, call in expand(args.file):
        try:
            with contextlib.redirect_stdout(None):
                parsed = parse(["simulate", *call])
            if parsed.kind == "list" or parsed.output or parsed.instance or parsed.json:
                raise InputError("list, -o, --instance and --json cannot be used in a list")
            environment = _environment(parsed)
        except SystemExit:
            raise InputError(f"{args.file}:{line}: --help cannot be used in a list") from None
        except InputError as error:
            raise InputError(f"{args.file}:{line}: {error}") from None
        yield " ".join(call), parsed, environment
