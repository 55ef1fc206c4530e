"""The arguments that several subcommands have in common.

This module loads nothing that help does not need.
"""

import argparse
import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Any, NoReturn

from topomap.cli.subcommands import SUBCOMMANDS
from topomap.model.vocabulary import CHOSEN, FORMS, PARTS
from topomap.runtime.errors import InputError
from topomap.runtime.limits import DRAWING, DRIFT, LARGEST, STRETCH
from topomap.runtime.near import meant

STATUS = """\
exit status: 0 done; 1 the answer is no (the table differs, no map, an unsound map);
2 bad input or usage; 3 partial (a limit or time limit was reached, or memory ran out);
130 interrupted"""

NO_LIMIT = "stop after S seconds (default: no limit)"


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, with a hint of what may be meant."""

    _words: Sequence[str] = ()

    def _print_message(self, message: str, file: Any = None) -> None:
        print(message, end="")  # argparse would ignore an error in writing

    def parse_known_args(  # type: ignore[override]  # argparse has several signatures of it
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse the words of a call, as argparse does, and keep them for the hint of an error."""
        self._words = [*(args or ())]  # for the hint of an error
        return super().parse_known_args(args, namespace)

    def error(self, message: str) -> NoReturn:
        # argparse reports a misspelt option that is required as a missing one.
        """Refuse a call in one line.

        Raises:
            InputError: Always.
        """
        near = meant_option(self._words, option_names(self)) if "required:" in message else ""
        hint = f"{near} " if near else ""
        raise InputError(f"{self.prog}: {message} ({hint}see {self.prog} --help)")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a value that is not a choice, with a hint of the choice that may be meant."""
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            hint = f"{near} " if (near := meant(str(value), choices)) else ""
            known = f"{hint}choose from {', '.join(choices)}"
            raise argparse.ArgumentError(action, f"invalid choice: {value!r} ({known})")


def parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Walk through a parser and those of its subcommands, and of their subcommands.

    Parameters:
        parser: The parser to begin with.

    Yields:
        Each parser once, a command before its subcommands.
    """
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in action.choices.values():
                yield from parsers(one)


def option_names(parser: argparse.ArgumentParser) -> set[str]:
    """Collect the long options of a parser and of its subcommands.

    Parameters:
        parser: The parser.

    Returns:
        The options, such as ``--json``.
    """
    every = (action for one in parsers(parser) for action in one._actions)
    return {name for action in every for name in action.option_strings if name[:2] == "--"}


def meant_option(words: Iterable[str], known: Collection[str]) -> str:
    """Ask which option was meant by the first misspelt one of a call.

    Parameters:
        words: The words of the call.
        known: The options that there are.

    Returns:
        The question, such as "did you mean --optimal?"; an empty text if there is none to ask.
    """
    given = (word.partition("=")[0] for word in words if word[:2] == "--" and word != "--")
    strange = (word for word in given if not any(name.startswith(word) for name in known))
    return next(filter(None, (meant(word, known) for word in strange)), "")


def command(group: Any, name: str, example: str) -> Parser:
    """Make the parser of a subcommand, with its help and an example, but no arguments yet."""
    help = SUBCOMMANDS[name]
    made: Parser = group.add_parser(
        name,
        help=help,
        description=help[0].upper() + help[1:] + ".",
        epilog=f"example:\n{example}\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    made.set_defaults(command=name)
    return made


def number(kind: type, least: float, most: float = LARGEST) -> Any:
    """Make an argument type: a finite number between bounds, or a plain message."""

    def number(text: str) -> Any:
        """Read the number from the text of an argument."""
        try:
            value = kind(text) if re.fullmatch(r"[!-^a-~]+", text) else math.nan
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            least_only = most >= LARGEST and not value > most
            bounds = f"{least} or more" if least_only else f"from {least} to {most}"
            noun = "a whole number" if kind is int else "a number"
            raise argparse.ArgumentTypeError(f"{text!r} is not {noun}, {bounds}")
        return value

    return number


def number_or_auto(kind: type, least: float) -> Any:
    """Make an argument type: a number as above, or ``auto``, which becomes None."""
    plain = number(kind, least)
    return lambda text: None if text == "auto" else plain(text)


def add_start(add: Any, facing: str) -> None:
    """Add the options that tell where an exploration starts, and which landmarks there are."""
    add(
        "--start",
        metavar="PLACE",
        help="place to start at, such as 0,2 (default: the smallest)",
    )
    add(
        "--facing",
        type=number(int, 0),
        metavar="SLOT",
        help=f"gateway to stand at first (default: {facing})",
    )
    add(
        "--signs",
        type=number(float, 0, 1),
        default=0.0,
        metavar="RATE",
        help="share of the places that have their own name as a landmark (default: %(default)g)",
    )


def add_senses(add: Any) -> None:
    """Add the options that tell what is measured besides views."""
    add(
        "--compass",
        action="store_true",
        help="note the compass slot of the gateway where the agent stands",
    )
    add(
        "--odometry",
        type=number(float, 0, 1000),
        metavar="PERCENT",
        help="note how far each step led, with errors of at most PERCENT percent of the way, "
        "drawn with --seed; the true map is consistent with a --drift of this number, "
        "rounded up (default: not noted)",
    )
    add("--lengths", action="store_true", help="note how long each step was")


def add_environments(command: Parser, common: Parser, rest: str) -> Any:
    """Add the worlds that can be explored; ``rest`` goes into their examples."""
    name = command.prog.split()[-1]
    kinds = command.add_subparsers(dest="kind", metavar="ENVIRONMENT", required=True)
    for kind, help in (
        ("grid", "a grid of places, four slots, slot 0 north"),
        ("cylinder", "a grid whose rows are rings"),
        ("torus", "a grid whose rows and columns are rings"),
        ("crescents", "a grid whose columns are joined in pairs by ways round their ends"),
        ("maze", "a grid from which ways are removed at random; it stays connected"),
        ("hexagons", "the corners of a sheet of hexagons, six slots"),
        ("triangles", "a triangular lattice, six slots"),
    ):
        sub = environment(kinds, kind, common, help, f"{name} {kind} 3 4 {rest}")
        of = "of hexagons" if kind == "hexagons" else "of places"
        if kind == "triangles":
            of = "of triangles, as networkx counts them"
        sub.add_argument("rows", type=number(int, 1), help=f"rows {of}")
        sub.add_argument("columns", type=number(int, 1), help=f"columns {of}")
        if kind == "maze":
            sub.add_argument(
                "--thin",
                type=number(float, 0, 1),
                default=0.3,
                metavar="RATE",
                help="share of the ways to remove (default: %(default)s)",
            )
    help = "a world from a file, such as a street network: see docs/files.md for the formats"
    for kind in ("world", "network"):  # "network" is the older name
        example = f"{name} {kind} city.graphml --slots 4 --north 29 {rest}"
        _add_file(environment(kinds, kind, common, help, example))
    return kinds


def add_straight(add: Any, otherwise: str = "") -> None:
    """Add the option that tells which exits are on one path.

    ``otherwise`` completes the sentence about what is so without the option.
    """
    add(
        "--straight",
        type=number(float, 0, 180),
        metavar="DEGREES",
        help="two exits of a place are on one path if each is the one most nearly opposite to "
        "the other, and if they are off from being opposite by at most DEGREES degrees "
        f"(default: exits in opposite slots are on one path{otherwise})",
    )


def _add_file(command: Parser) -> None:
    """Add the options that tell how a file with a world is read."""
    add = command.add_argument
    add("file", metavar="FILE", help="the file of the world")
    add(
        "--slots",
        type=number_or_auto(int, 2),
        metavar="K",
        help="number of directions at a place, which must be even; auto: the smallest number at "
        "which no two exits of a place share a slot (default: auto)",
    )
    add(
        "--north",
        type=number_or_auto(float, -LARGEST),
        metavar="DEGREES",
        help="bearing of slot 0, clockwise of north; auto: the bearing that leaves the widest "
        "margin before two exits of a place share a slot (default: auto)",
    )
    add_straight(add)
    add(
        "--along",
        type=number(float, 0),
        default=10.0,
        metavar="METRES",
        help="the direction of a bent way at its end is that of the point METRES along it, in "
        "metres or in the units of the file (default: %(default)g)",
    )
    units = command.add_mutually_exclusive_group()
    units.add_argument(
        "--plane", action="store_true", help="coordinates are those of a plane, such as metres"
    )
    units.add_argument(
        "--degrees", action="store_true", help="coordinates are longitude and latitude"
    )
    add("--two-way", action="store_true", help="treat one-way ways as two-way")
    add(
        "--loops",
        action="store_true",
        help="keep ways back to their own place, which the path axiom forbids (--no-path-axiom)",
    )
    add("--names", action="store_true", help="the name of a place in the file is its landmark")
    add(
        "--radius",
        type=number(float, 0),
        metavar="METRES",
        help="in a floor plan, junctions that are at most METRES apart are one place (default: "
        "as far as the free space around them reaches)",
    )


def environment(kinds: Any, kind: str, common: Parser, help: str, example: str) -> Parser:
    """Add the parser of a kind of world."""
    added: Parser = kinds.add_parser(
        kind,
        parents=[common],
        help=help,
        description=help,
        epilog=f"example:\n  topomap {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return added


def add_asked(
    command: Parser,
    parts: Iterable[str],
    horizon: bool = True,
    limit: str = NO_LIMIT,
) -> None:
    """Add the options that tell which maps are asked for, and how long the search may take."""
    add = command.add_argument
    for part in parts:
        add(f"--{part.replace('_', '-')}", action="store_true", help=PARTS[part])
    add("--bound", type=number(int, 1), metavar="B", help="at most B places (default: no bound)")
    if horizon:
        add(
            "--horizon",
            type=number(int, 0),
            metavar="T",
            help="cut the experience after step T (default: the last step)",
        )
    add("--timeout", type=number(float, 0.001), metavar="S", help=limit)


def add_instance(command: Parser, nargs: str | None = None) -> None:
    """Add the instance, or the instances, that a command is about."""
    help = "an instance, the facts of an exploration; - is standard input"
    command.add_argument("instance", nargs=nargs, metavar="INSTANCE", help=help)


def add_known(command: Parser) -> None:
    """Add the options that tell what is known of an instance besides its facts."""
    add = command.add_argument
    add(
        "--assume",
        action="append",
        metavar="STATEMENT",
        help="take a statement for granted, such as 'same(3,12)', 'not same(3,12)' or "
        "'places < 12', as in topomap ask --help; can be given several times (default: nothing)",
    )
    add_measured(command)
    add_tolerance(command)


def add_tolerance(command: Parser) -> None:
    """Add the option that tells by how much bearings may be wrong."""
    command.add_argument(
        "--tolerance",
        type=number(int, 0),
        metavar="N",
        help="bearings may be wrong by N slots; a place keeps the bearings of its first visit "
        "(default: 0)",
    )


def add_measured(command: Parser) -> None:
    """Add the options that tell by how much measurements may be wrong."""
    add = command.add_argument
    add(
        "--drift",
        type=number(int, 0),
        metavar="P",
        help=f"shifts may be wrong by P percent of the way (default: {DRIFT})",
    )
    add(
        "--stretch",
        type=number(int, 0),
        metavar="P",
        help=f"lengths of one way may differ by P percent (default: {STRETCH})",
    )


def add_query(command: Parser, parts: Iterable[str], horizon: bool = True) -> None:
    """Add the options of a query, and those of the output."""
    add_asked(command, parts, horizon)
    add = command.add_argument
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def add_optimal(command: Parser) -> None:
    """Add the option for optimal maps."""
    command.add_argument(
        "--optimal",
        action="store_true",
        help="only the optimal maps: the closed maps with the fewest exceptions to consistent "
        "boundaries, then the fewest paths, then the fewest places; if no map is closed, "
        "the maps that are best so far, which may have pending gateways",
    )


def add_circumscribe(command: Parser) -> None:
    """Add the option for circumscribed maps."""
    command.add_argument(
        "--circumscribe",
        action="store_true",
        help="only the circumscribed maps: of the closed maps with consistent boundaries (or of "
        "all maps with consistent boundaries, if none of them is closed), those to which "
        "no other one is preferred by set inclusion. A map is preferred to another one if "
        "its paths are a proper subset of the paths of the other one, or if the paths are "
        "the same and its places are a proper subset of the places of the other one",
    )


def add_encoding(command: Parser) -> None:
    """Add the option that chooses the rules that clingo gets."""
    command.add_argument(
        "--encoding",
        choices=FORMS,
        default="work",
        help="which rules clingo gets: work, those of encodings/; or paper, those of "
        "encodings/paper/, which state the theory as briefly as possible, and are slow "
        "(default: work)",
    )


def add_resume(command: Parser) -> None:
    """Add the option that goes on with an earlier run."""
    command.add_argument(
        "--resume",
        action="store_true",
        help="go on where the last run with this output file was cut short; that run left "
        "FILE.part",
    )


def add_crew(command: Parser, but: str = "") -> None:
    """Add the options that share the work out among processes."""
    group = command.add_mutually_exclusive_group()
    group.add_argument(
        "--jobs",
        type=number(int, 1),
        metavar="N",
        help=f"share the work out among N processes{but} (default: 1)",
    )
    group.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="share the work out among the workers of a running Dask cluster, such as "
        "tcp://127.0.0.1:8786; they need the same version of topomap, and this computer needs the "
        "extra dask: pip install '.[dask]' in the folder of topomap (default: none)",
    )


def add_scene(command: Parser) -> None:
    """Add the arguments of commands that show a map."""
    add = command.add_argument
    add(
        "file",
        metavar="INSTANCE|MAPS.json",
        help="an instance, to show one of its optimal maps or, if no map is closed, one of the "
        "best so far (the options below choose which); or a file of maps, from topomap "
        "solve --json",
    )
    add(
        "given",
        nargs="?",
        metavar="MAPS.json",
        help="a file of maps of that instance, to be shown instead, from clingo --outf=2 or "
        "topomap solve --json (- is standard input)",
    )
    add(
        "--map",
        type=number(int, 1),
        metavar="N",
        help="take the N-th map; if more than 1000 maps are optimal, the N-th one that is found "
        "(default: 1)",
    )
    add(
        "--like",
        metavar="WORLD",
        help="draw the places at their positions in this file of a world, as for topomap generate, "
        "with north up; the links, or landmarks that are names of places in the world, "
        "tell which place is which (default: none)",
    )
    add_known(command)
    add_asked(
        command,
        CHOSEN,
        limit="take about S seconds in all: if the search for optimal maps has not ended by then, "
        "a map is taken that is not proved to be best; and what cannot be drawn well in the time "
        f"that is left is drawn plainly (default: {DRAWING:g})",
    )
    command.set_defaults(timeout=DRAWING)
