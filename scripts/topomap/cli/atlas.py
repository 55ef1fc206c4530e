"""The subcommand ``atlas``."""

import argparse
import contextlib
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import Parser, add_environments, add_start, command, number
from topomap.cli.calls import environment_of
from topomap.cli.tell import tell
from topomap.runtime.errors import InputError, say
from topomap.runtime.files import output
from topomap.runtime.limits import MOST_STEPS

if TYPE_CHECKING:
    from topomap.api.atlas import World

MOST, SECONDS, STEPS = 10_000, 10.0, 200


def add(group: Any) -> None:
    """The parser of ``topomap atlas``."""
    made = command(
        group,
        "atlas",
        """\
  topomap atlas instances/atlas.txt --json -o atlas.json
  topomap atlas --from atlas.json -o atlas.md""",
    )
    add = made.add_argument
    add(
        "file",
        nargs="?",
        metavar="WORLDS",
        help="a file in which each line names a world by the arguments of topomap generate, such "
        "as: maze 4 4 --seed {0..2}; files of worlds are looked for from its folder",
    )
    add(
        "--from",
        dest="given",
        metavar="FILE",
        help="make the page from a file that --json wrote before (default: none)",
    )
    add(
        "--most",
        type=number(int, 1, 10**6),
        metavar="N",
        help=f"stop a count where there are more than N maps (default: {MOST:,})",
    )
    add(
        "--seconds",
        type=number(float, 0.001),
        metavar="S",
        help="each count, and each search for a further walk or for the best maps, takes S seconds "
        f"at most, and a learner four times as long (default: {SECONDS:g})",
    )
    add(
        "--steps",
        type=number(int, 0, MOST_STEPS),
        metavar="N",
        help=f"the random walk has N steps at most (default: {STEPS})",
    )
    add("--seed", type=number(int, 0), metavar="N", help="seed for random walks (default: 0)")
    add("--no-peers", action="store_true", help="do not run AALpy, even if it is installed")
    add(
        "--timeout",
        type=number(float, 0.001),
        metavar="S",
        help="stop after S seconds (default: no limit)",
    )
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Make the atlas, or its page."""
    from topomap.api.atlas import Atlas, atlas_under
    from topomap.documents.atlas import read_atlas
    from topomap.runtime.watch import heeding

    if (args.file is None) == (args.given is None):
        raise InputError("topomap atlas: give either a file of WORLDS or --from FILE")
    if args.given is not None:
        for name in ("most", "seconds", "steps", "seed", "timeout"):
            if getattr(args, name) is not None:
                raise InputError(f"topomap atlas: --{name} cannot be used with --from")
        if args.no_peers or args.json:
            raise InputError("topomap atlas: --no-peers and --json cannot be used with --from")
        data = read_atlas(args.given)
        with output(args.output) as out:
            return tell(args, out, Atlas(data, data["fault"]), True)
    worlds = list(_worlds(args.file))
    if not worlds:
        raise InputError(f"{args.file}: it has no worlds")
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            made = atlas_under(
                watch,
                worlds,
                most=args.most or MOST,
                seconds=args.seconds or SECONDS,
                steps=STEPS if args.steps is None else args.steps,
                seed=args.seed or 0,
                learner=not args.no_peers,
            )
        if made.document()["peers"] is None and not args.no_peers:
            say("AALpy is not installed, so its columns are missing; it comes with the extra peers")
        return tell(args, out, made, True)


def _worlds(file: str) -> "Iterator[World]":
    """Read the worlds of a file, and where the agent stands first.

    Raises:
        InputError: A line does not name a world. The message names the line.
    """
    from topomap.questions.robot import start_of
    from topomap.worlds.family import expand

    for line, call in expand(file):
        try:
            with contextlib.redirect_stdout(None):
                args, unknown = _parser().parse_known_args(call)
            if unknown:
                raise InputError(f"unrecognized arguments: {' '.join(unknown)}")
            if args.kind in ("world", "network") and file != "-":
                args.file = str(Path(file).parent / args.file)
            environment = environment_of(args)
            if args.signs:
                environment = environment.signed(args.signs, args.seed or 0)
            environment, start = start_of(environment, args.start, args.facing)
        except SystemExit:
            raise InputError(f"{file}:{line}: --help cannot be used in a list") from None
        except InputError as error:
            raise InputError(f"{file}:{line}: {error}") from None
        yield shlex.join(call), _name(call), environment, start


def _name(call: list[str]) -> str:
    """What a world is called in tables: its call, or the name of its file."""
    return Path(call[1]).stem if call[0] in ("world", "network") else " ".join(call)


@cache
def _parser() -> Parser:
    """The parser of a line of a list of worlds."""
    common = Parser(add_help=False)
    add_start(common.add_argument, "the smallest")
    common.add_argument("--seed", type=number(int, 0), metavar="N")
    made = Parser(prog="topomap atlas")
    add_environments(made, common, "")
    return made
