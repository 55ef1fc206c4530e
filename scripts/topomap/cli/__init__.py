"""The command ``topomap``: one module for each subcommand, with its parser and what it does.

A module loads what does the work inside ``run``, so that help and the message about a mistyped call
need not wait for the solver; a test checks this.
"""

import argparse
import importlib
import os.path
import sys
from collections.abc import Collection, Sequence
from functools import cache
from typing import Any

from topomap.cli.arguments import STATUS, Parser, meant_option, option_names
from topomap.cli.completion import SHELLS, PrintCompletion
from topomap.cli.subcommands import SUBCOMMANDS
from topomap.runtime.errors import InputError, say
from topomap.runtime.near import meant
from topomap.runtime.status import BAD_INPUT, DONE, INTERRUPTED, PARTIAL
from topomap.runtime.version import VERSION


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command, and return its exit status."""
    try:
        try:
            words = sys.argv[1:] if arguments is None else [*arguments]
            if words[:1] == ["clingo"]:  # clingo parses its own options
                return int(_module("clingo").run(words[1:]))
            args = parse(words)
            status: int = _module(args.command).run(args)
        except SystemExit:  # it follows --help and --version
            status = DONE
        sys.stdout.flush()
        return status
    except InputError as error:
        say(str(error))
        return BAD_INPUT
    except KeyboardInterrupt:
        say("interrupted")
        return INTERRUPTED
    except MemoryError:
        say("topomap: out of memory")
        return PARTIAL
    except BrokenPipeError:
        return PARTIAL
    except OSError as error:
        say(f"{error.filename or 'standard output'}: {(error.strerror or str(error)).lower()}")
        return BAD_INPUT


def parse(words: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments of a call.

    Raises:
        InputError: The usage is bad.
    """
    first = words[0] if words else ""
    if first and not first.startswith("-") and first not in SUBCOMMANDS:
        hint = f"{near} " if (near := meant(first, SUBCOMMANDS)) else ""
        raise InputError(f"topomap: no such command: {first!r} ({hint}see topomap --help)")
    parser = _parser(first if first in SUBCOMMANDS else None)
    args, unknown = parser.parse_known_args(words)
    if unknown:
        command = f"topomap {args.command}"
        hint = f"{near} " if (near := meant_option(unknown, option_names(parser))) else ""
        said = f"unrecognized arguments: {' '.join(unknown)}"
        raise InputError(f"{command}: {said} ({hint}see {command} --help)")
    if [] in vars(args).values():  # what Python 3.11 makes of --name=--
        raise InputError("topomap: -- is not a value (see topomap --help)")
    _spare_inputs(args)
    return args


def _spare_inputs(args: argparse.Namespace) -> None:
    """Refuse to write a file that is to be read: a log that was written by hand is easily lost.

    Raises:
        InputError: An output is one of the inputs.
    """
    told = vars(args)
    inputs: list[Any] = []
    for name in ("instance", "file", "given", "maps", "maps_from", "among", "check", "like"):
        value = told.get(name)
        inputs += value if isinstance(value, list) else [value]
    # generate writes the file of --truth; the other commands read it.
    truth = [told.get("truth")]
    written = [told.get(name) for name in ("output", "proof", "log")]
    for name in written + truth * (args.command == "generate"):
        for other in inputs + truth * (args.command != "generate"):
            if isinstance(name, str) and isinstance(other, str) and _same(name, other):
                raise InputError(f"{name}: it is an input, so it cannot be written")


def _same(one: str, other: str) -> bool:
    try:
        return os.path.isfile(one) and os.path.samefile(one, other)  # noqa: PTH113, PTH121
    except (OSError, ValueError):
        return False


def whole_parser() -> Parser:
    """Make a parser that knows all subcommands with their arguments.

    Completion, the manual page and tests read it. A call is parsed by a parser of its own
    subcommand, so that the others need not be loaded.

    Returns:
        The parser.
    """
    return _parser_of(SUBCOMMANDS)


def _module(name: str) -> Any:
    """Load the module of a subcommand."""
    return importlib.import_module(f"topomap.cli.{'import_' if name == 'import' else name}")


@cache
def _parser(name: str | None) -> Parser:
    """Make a parser of the named subcommand, or one that knows only the names of all."""
    return _parser_of([name] if name else [])


def _parser_of(names: Collection[str]) -> Parser:
    """Make a parser of these subcommands; if there are none, it knows the names of all."""
    parser = Parser(
        prog="topomap",
        description="Exact topological map-building: every map consistent with an exploration.",
        epilog=f"example:\n  topomap solve instances/grid-3x3-snake.lp --optimal\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"topomap {VERSION}")
    parser.add_argument(
        "--print-completion",
        action=PrintCompletion,
        choices=SHELLS,
        metavar="SHELL",
        help=f"print a script by which a shell completes this command ({', '.join(SHELLS)}); it "
        "needs the extra complete (default: none)",
    )
    group = parser.add_subparsers(metavar="COMMAND", required=True)
    for name in names:
        _module(name).add(group)
    if not names:
        for name, help in SUBCOMMANDS.items():
            group.add_parser(name, help=help)
    return parser
