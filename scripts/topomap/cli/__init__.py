"""The command ``topomap``: one module for each subcommand, with its parser and what it does.

A module loads what does the work inside ``run``, so that help and a mistyped call need not wait
for the solver; a test sees to that.
"""

import argparse
import importlib
import sys
from collections.abc import Sequence
from functools import cache
from typing import Any

from topomap.cli.arguments import STATUS, Parser
from topomap.runtime.errors import InputError, say
from topomap.runtime.status import BAD_INPUT, DONE, INTERRUPTED, PARTIAL
from topomap.runtime.version import VERSION

SUBCOMMANDS = (
    "generate",
    "validate",
    "solve",
    "ask",
    "explain",
    "explore",
    "follow",
    "simulate",
    "count",
    "search",
    "branching",
    "check",
    "table",
    "family",
    "draw",
    "show",
    "report",
    "figures",
    "export",
    "import",
    "path",
    "clingo",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit status."""
    try:
        try:
            words = sys.argv[1:] if arguments is None else [*arguments]
            if words[:1] == ["clingo"]:  # whose options are clingo's own
                return int(_module("clingo").run(words[1:]))
            args = parse(words)
            status: int = _module(args.command).run(args)
        except SystemExit:  # --help and --version
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
    """The arguments of a call. Raises InputError on bad usage."""
    args = _parser(words[0] if words and words[0] in SUBCOMMANDS else None).parse_args(words)
    if [] in vars(args).values():  # what Python 3.11 makes of --name=--
        raise InputError("topomap: -- is not a value (see topomap --help)")
    return args


def _module(name: str) -> Any:
    """The module of a subcommand."""
    return importlib.import_module(f"topomap.cli.{'import_' if name == 'import' else name}")


@cache
def _parser(name: str | None) -> Parser:
    """A parser of the subcommand of that name, or of all."""
    parser = Parser(
        prog="topomap",
        description="Exact topological map-building: every map consistent with an exploration.",
        epilog=f"example:\n  topomap solve instances/grid-3x3-snake.lp --optimal\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"topomap {VERSION}")
    group = parser.add_subparsers(metavar="COMMAND", required=True)
    for one in [name] if name else SUBCOMMANDS:
        _module(one).add(group)
    return parser
