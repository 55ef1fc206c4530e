"""The command ``topomap``."""

import argparse
import difflib
import importlib
import math
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from topomap import __version__
from topomap.errors import BAD_INPUT, DONE, INTERRUPTED, PARTIAL, InputError, say
from topomap.options import EXPORTS, LARGEST, LONGEST_WALK, MOST_COUNTED, MOST_STEPS
from topomap.vocabulary import DEMANDS, FORMS, OPTIMIZING, PARTS, PROPERTIES, PRUNING, VOCABULARY

STATUS = """\
exit status: 0 done; 1 the answer is no (the table differs, no map, an unsound map);
2 bad input or usage; 3 partial (a limit or time limit was reached, or memory ran out);
130 interrupted"""


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line."""

    def _print_message(self, message: str, file: Any = None) -> None:
        print(message, end="")  # argparse's own passes over what cannot be written

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{self.prog}: {message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit status."""
    try:
        try:
            words = sys.argv[1:] if arguments is None else [*arguments]
            if words[:1] == ["clingo"]:  # whose options are clingo's own
                return int(_loaded("clingo_command:run")(words[1:]))
            args = parse(words)
            status: int = _loaded(args.run)(args)
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


def _loaded(name: str) -> Any:
    """The function that does what a subcommand says, ``module:function``."""
    module, _, function = name.partition(":")
    return getattr(importlib.import_module(f"topomap.{module}"), function)


def parse(words: Sequence[str]) -> argparse.Namespace:
    """The arguments of a call. Raises InputError on bad usage."""
    first = words[0] if words else ""
    if first and not first.startswith("-") and first not in SUBCOMMANDS:
        near = difflib.get_close_matches(first, SUBCOMMANDS, 1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise InputError(f"topomap: no such command: {first!r} ({hint}see topomap --help)")
    parser = _parser(first if first in SUBCOMMANDS else None)
    args, unknown = parser.parse_known_args(words)
    if unknown:
        command = f"topomap {args.command}"
        said = f"unrecognized arguments: {' '.join(unknown)}"
        raise InputError(f"{command}: {said} (see {command} --help)")
    if [] in vars(args).values():  # what Python 3.11 makes of --name=--
        raise InputError("topomap: -- is not a value (see topomap --help)")
    _spare_inputs(args)
    return args


def _spare_inputs(args: argparse.Namespace) -> None:
    """Raise InputError if what is to be written is a file that is to be read: a log that was
    written by hand is easily lost."""
    told = vars(args)
    inputs: list[Any] = []
    for name in ("instance", "file", "given", "maps", "maps_from", "among", "check"):
        value = told.get(name)
        inputs += value if isinstance(value, list) else [value]
    # What generate writes as the truth, others read.
    truth = [told.get("truth")]
    written = [told.get(name) for name in ("output", "proof", "log")]
    for name in written + truth * (args.command == "generate"):
        for other in inputs + truth * (args.command != "generate"):
            if isinstance(name, str) and isinstance(other, str) and _same(name, other):
                raise InputError(f"{name}: it is to be read, and cannot be written, too")


def _same(one: str, other: str) -> bool:
    try:
        return Path(one).is_file() and Path(one).samefile(other)
    except (OSError, ValueError):
        return False


@cache
def _parser(name: str | None) -> Parser:
    """A parser of the subcommand of that name, or of all."""
    parser = Parser(
        prog="topomap",
        description="Exact topological map-building: every map consistent with an exploration.",
        epilog=f"example:\n  topomap solve instances/grid-3x3-snake.lp --optimal\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"topomap {__version__}")
    group = parser.add_subparsers(metavar="COMMAND", required=True)
    for add in [SUBCOMMANDS[name]] if name else SUBCOMMANDS.values():
        add(group)
    return parser


def _command(group: Any, name: str, run: Any, help: str, example: str) -> Parser:
    command: Parser = group.add_parser(
        name,
        help=help,
        description=help[0].upper() + help[1:] + ".",
        epilog=f"example:\n{example}\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run, command=name)
    return command


def _number(kind: type, least: float, most: float = LARGEST) -> Any:
    """An argument type: a finite number between bounds, with a plain word on what is not."""

    def number(text: str) -> Any:
        try:
            value = kind(text) if re.fullmatch(r"[!-^a-~]+", text) else math.nan
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            bounds = f"{least} or more" if most >= LARGEST else f"from {least} to {most}"
            noun = "a whole number" if kind is int else "a number"
            raise argparse.ArgumentTypeError(f"{text!r} is not {noun}, {bounds}")
        return value

    return number


def _add_generate(group: Any) -> None:
    command = _command(
        group,
        "generate",
        "commands:generate",
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
        "(4 slots; with 8, separated by commas: N,NE,E); or absolute slots: 0,3,1",
    )
    add(
        "--steps", type=_number(int, 0, MOST_STEPS), metavar="N", help="cut the route after N steps"
    )
    _add_start(add, "the one by which the route leaves")
    add(
        "--seed",
        type=_number(int, 0),
        metavar="N",
        help="seed for walk, signs and maze (default: 0)",
    )
    add("--name", help="name of the instance (default: made from the arguments)")
    add("--truth", metavar="FILE", help="also write the true hypothesis, for solve --truth")
    add("--json", action="store_true", help="print a summary as JSON")
    add("-o", "--output", metavar="FILE", help="file or folder to write (default: stdout)")
    _add_environments(command, common, "--route tour")


def _add_start(add: Any, facing: str) -> None:
    """Where an exploration starts, and what it can see."""
    add(
        "--start",
        metavar="PLACE",
        help="place to start at, such as 0,2 (default: the smallest)",
    )
    add(
        "--facing",
        type=_number(int, 0),
        metavar="SLOT",
        help=f"gateway to stand at first (default: {facing})",
    )
    add(
        "--signs",
        type=_number(float, 0, 1),
        default=0.0,
        metavar="RATE",
        help="share of places that carry their own name as a landmark",
    )


def _add_environments(command: Parser, common: Parser, rest: str) -> Any:
    """The worlds that can be explored; ``rest`` goes into their examples."""
    name = command.prog.split()[-1]
    kinds = command.add_subparsers(dest="kind", metavar="ENVIRONMENT", required=True)
    for kind, help in (
        ("grid", "a grid of places, four slots, slot 0 north"),
        ("cylinder", "a grid whose rows are rings"),
        ("torus", "a grid whose rows and columns are rings"),
        ("maze", "a grid from which ways are taken away at random; it stays connected"),
        ("hexagons", "the corners of a sheet of hexagons, six slots"),
        ("triangles", "a triangular lattice, six slots"),
    ):
        sub = _environment(kinds, kind, common, help, f"{name} {kind} 3 4 {rest}")
        of = "of hexagons" if kind == "hexagons" else "of places"
        if kind == "triangles":
            of = "of triangles, as networkx counts them"
        sub.add_argument("rows", type=_number(int, 1), help=f"rows {of}")
        sub.add_argument("columns", type=_number(int, 1), help=f"columns {of}")
        if kind == "maze":
            sub.add_argument(
                "--thin",
                type=_number(float, 0, 1),
                default=0.3,
                metavar="RATE",
                help="share of the ways to take away (default: %(default)s)",
            )
    help = (
        "a street or corridor network with coordinates: each way is a straight line between "
        "its ends, and can be gone both ways; loops are left out"
    )
    example = f"{name} network city.graphml --slots 4 --north 29 {rest}"
    sub = _environment(kinds, "network", common, help, example)
    sub.add_argument("file", metavar="FILE.graphml")
    sub.add_argument(
        "--slots",
        type=_number(int, 2),
        default=4,
        metavar="K",
        help="directions at a place, even (default: %(default)s)",
    )
    sub.add_argument(
        "--north",
        type=_number(float, -LARGEST),
        default=0.0,
        metavar="DEGREES",
        help="bearing of slot 0, clockwise of north (default: %(default)g)",
    )
    return kinds


def _environment(kinds: Any, kind: str, common: Parser, help: str, example: str) -> Parser:
    added: Parser = kinds.add_parser(
        kind,
        parents=[common],
        help=help,
        description=help,
        epilog=f"example:\n  topomap {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return added


def _add_asked(
    command: Parser, parts: Iterable[str], horizon: bool = True, limit: str = "stop after S seconds"
) -> None:
    """Which maps are asked for, and how long."""
    add = command.add_argument
    for part in parts:
        add(f"--{part}", action="store_true", help=PARTS[part])
    add("--bound", type=_number(int, 1), metavar="B", help="at most B places")
    if horizon:
        add("--horizon", type=_number(int, 0), metavar="T", help="cut the experience after step T")
    add("--timeout", type=_number(float, 0.001), metavar="S", help=limit)


def _add_query(command: Parser, parts: Iterable[str], horizon: bool = True) -> None:
    _add_asked(command, parts, horizon)
    add = command.add_argument
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def _add_validate(group: Any) -> None:
    command = _command(
        group,
        "validate",
        "validate:validate",
        "report all that is wrong with instances, and what looks like a mistake, without solving "
        "anything; the status is 2 if one of them has a fault (a warning is not a fault)",
        """\
  topomap validate walk.lp
  topomap validate instances/*.lp --json
  echo 'slots(4). veiw(0,0). turn(1,0).' | topomap validate -""",
    )
    add = command.add_argument
    add("file", nargs="+", metavar="FILE", help="an instance; - is standard input")
    add("--json", action="store_true", help="write JSON")


def _add_solve(group: Any) -> None:
    command = _command(
        group,
        "solve",
        "commands:solve",
        "enumerate the maps that are consistent with an exploration",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --closed
  topomap solve instances/grid-3x4-paper.lp --optimal --json
  topomap solve instances/grid-4x4-snake.lp --bound 16 --jobs 2 -o maps.txt
  topomap solve instances/grid-3x3-misread.lp --optimal --planar --noise 1""",
    )
    command.add_argument("instance", nargs="+", metavar="INSTANCE")
    _add_optimal(command)
    command.add_argument("--limit", type=_number(int, 1), metavar="N", help="stop after N maps")
    command.add_argument(
        "--truth",
        metavar="FILE",
        help="mark the maps that are the real one (from generate --truth)",
    )
    command.add_argument(
        "--by",
        choices=("clingo", "search"),
        default="clingo",
        help="how to find the maps: clingo, or the search in Python (default: %(default)s)",
    )
    _add_query(command, PARTS)
    _add_crew(command, "; not with --optimal, --minimal or --genus")
    _add_encoding(command)
    command.set_defaults(encoding=None)  # settled when it is known whether there is --noise
    _add_resume(command)
    command.add_argument(
        "--noise",
        type=_number(int, 0),
        metavar="K",
        help="allow up to K views to be wrong, as few as possible: gateways and landmarks were "
        "missed or imagined; this uses the plain encoding",
    )


def _add_optimal(command: Parser) -> None:
    command.add_argument(
        "--optimal",
        action="store_true",
        help="closed maps with consistent boundaries, the fewest paths, then the fewest places; "
        "if there is none, the best so far, in which gateways may be pending",
    )


def _add_encoding(command: Parser) -> None:
    command.add_argument(
        "--encoding",
        choices=FORMS,
        default="fast",
        help="which rules clingo gets: those of encodings/fast/, or the plain ones, which state "
        "the theory (default: fast)",
    )


def _add_resume(command: Parser) -> None:
    command.add_argument(
        "--resume",
        action="store_true",
        help="go on where the last run with this output file was cut short; it left FILE.part",
    )


def _add_crew(command: Parser, but: str = "") -> None:
    group = command.add_mutually_exclusive_group()
    group.add_argument(
        "--jobs",
        type=_number(int, 1),
        metavar="N",
        help=f"share the work out among N processes{but} (default: 1)",
    )
    group.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="share the work out among the workers of a running Dask cluster, such as "
        "tcp://127.0.0.1:8786; they need the same version of topomap, and this computer needs the "
        "extra dask: pip install '.[dask]' in the folder of topomap",
    )


def _add_ask(group: Any) -> None:
    command = _command(
        group,
        "ask",
        "ask:ask",
        "say of each statement whether it holds in all maps that are consistent with an "
        "exploration, in some or in none, with maps as witnesses",
        f"""\
  topomap ask instances/grid-4x4-snake.lp "same(3,12)" "places < 12" --planar --closed
  topomap ask instances/grid-3x3-snake.lp "linked(3,2,12,0)" "not planar" --optimal --json

{VOCABULARY}""",
    )
    command.add_argument("instance", metavar="INSTANCE")
    command.add_argument("statement", nargs="+", metavar="STATEMENT")
    _add_optimal(command)
    _add_query(command, PARTS)
    _add_encoding(command)


def _add_explain(group: Any) -> None:
    command = _command(
        group,
        "explain",
        "explain:explain",
        "say why a statement about the maps is impossible, or certain, or why there is no map, by "
        "reasons each of which is needed. (The statement is about all maps, not only the optimal "
        "ones: that another map is better is not such a reason)",
        f"""\
  topomap explain instances/grid-3x3-snake.lp "same(3,12)"
  topomap explain instances/grid-4x4-snake.lp "not same(0,30)" --planar --bound 16
  topomap explain instances/manhattan-tour20.lp --closed

{VOCABULARY}""",
    )
    command.add_argument("instance", metavar="INSTANCE")
    command.add_argument("statement", nargs="?", metavar="STATEMENT")
    _add_query(command, DEMANDS)


def _add_count(group: Any) -> None:
    command = _command(
        group,
        "count",
        "commands:count",
        "count the search tree of an exploration, as the paper's Figure 4 does",
        """\
  topomap count instances/grid-4x4-snake.lp --planar --bound 16
  topomap count instances/grid-4x4-snake.lp --jobs 2""",
    )
    command.add_argument("instance", metavar="INSTANCE")
    _add_query(command, [part for part in PARTS if part not in OPTIMIZING])
    _add_crew(command)
    _add_encoding(command)
    _add_resume(command)


def _add_check(group: Any) -> None:
    command = _command(
        group,
        "check",
        "commands:check",
        "check maps, whoever made them, by encodings/check.lp and by a second checker "
        "(a time limit ends the check between two maps)",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --json -o maps.json
  topomap check instances/grid-3x3-snake.lp maps.json --planar""",
    )
    command.add_argument("instance", metavar="INSTANCE")
    command.add_argument(
        "maps",
        metavar="MAPS.json",
        help="from topomap solve --json or clingo --outf=2; a map needs the key at, "
        "[[T,P,S], ...], and its other keys are verified; so are the parts, bound, horizon, kind, "
        "cost and count of the file, but not that there are no other maps",
    )
    command.add_argument(
        "--truth", metavar="FILE", help="the real map (from generate --truth), for the key real"
    )
    command.add_argument(
        "--noise",
        type=_number(int, 0),
        metavar="K",
        help="a map may disbelieve up to K views, named in its key misread, and no more than its "
        "file allows",
    )
    _add_query(command, PROPERTIES, horizon=False)


def _add_search(group: Any) -> None:
    command = _command(
        group,
        "search",
        "commands:search_tree",
        "search the tree of an exploration without clingo, as the paper does",
        """\
  topomap search instances/grid-4x4-snake.lp --planar --bound 16
  topomap search instances/grid-4x4-snake.lp --order depth
  topomap search instances/grid-4x4-snake.lp --order best --planar --perpendicular""",
    )
    command.add_argument("instance", metavar="INSTANCE")
    command.add_argument(
        "--order",
        choices=("breadth", "depth", "best"),
        default="breadth",
        help="breadth: count the whole tree step by step; depth: the same in little memory; best: "
        "best map first, until a closed map is found (default: %(default)s)",
    )
    _add_query(command, PRUNING)


def _add_branching(group: Any) -> None:
    command = _command(
        group,
        "branching",
        "commands:branching_nodes",
        "check the paper's equation (1), bp/b = (pi / mean p) / (m + 1), at every branching node "
        "of the planar tree",
        "  topomap branching instances/grid-4x4-snake.lp --bound 16",
    )
    command.add_argument("instance", metavar="INSTANCE")
    _add_query(command, ["perpendicular"])


def _add_table(group: Any) -> None:
    command = _command(
        group,
        "table",
        "commands:table",
        "print the paper's Figure 4 beside our numbers, and write them as JSON",
        "  topomap table",
    )
    command.add_argument(
        "--jobs",
        type=_number(int, 1),
        metavar="N",
        help="how many columns, or with --beyond processes, at a time (default: one for each "
        "processor)",
    )
    command.add_argument("--json", action="store_true", help="print JSON instead of the table")
    command.add_argument(
        "--timeout", type=_number(float, 0.001), metavar="S", help="stop after S seconds"
    )
    command.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="file to write (default: results/figure4.json, or beyond.json)",
    )
    command.add_argument(
        "--beyond",
        action="store_true",
        help="count what the paper does not have instead: 4x4 without a bound, 4x5, 5x4, 5x5; "
        "takes an hour",
    )
    _add_resume(command)


def _add_family(group: Any) -> None:
    command = _command(
        group,
        "family",
        "commands:family",
        "print the names of the instances of a family file, and write the arguments of each that "
        "changed",
        "  topomap family instances/batch.txt -d build/instances",
    )
    command.set_defaults(parse=parse)
    command.add_argument("file", metavar="FAMILY")
    command.add_argument(
        "-d",
        "--directory",
        required=True,
        metavar="DIR",
        help="folder for NAME.args; files of instances that are no longer listed are removed",
    )
    command.add_argument("--json", action="store_true", help="print JSON")


def _add_scene(command: Parser) -> None:
    """Arguments of what shows a map."""
    add = command.add_argument
    add(
        "file",
        metavar="INSTANCE|MAPS.json",
        help="an instance, of which an optimal map is shown, or one of the best so far, with the "
        "options below; or a file of maps, from topomap solve --json",
    )
    add(
        "given",
        nargs="?",
        metavar="MAPS.json",
        help="a file of maps of that instance, to be shown instead, from clingo --outf=2 or "
        "topomap solve --json (- is standard input)",
    )
    add("--map", type=_number(int, 1), metavar="N", help="take the N-th map (default: 1)")
    _add_asked(
        command, PRUNING, limit="stop the search for maps after S seconds, and take what was found"
    )


def _add_draw(group: Any) -> None:
    command = _command(
        group,
        "draw",
        "pictures:draw",
        "draw a map, as SVG, PNG or PDF",
        """\
  topomap draw instances/grid-4x4-snake.lp --map 2 -o map.svg
  topomap solve instances/grid-3x3-snake.lp --closed --json -o maps.json
  topomap draw maps.json --map 3 -o map.png""",
    )
    _add_scene(command)
    command.add_argument(
        "-o", "--output", required=True, metavar="FILE", help="FILE.svg, FILE.png or FILE.pdf"
    )


def _add_report(group: Any) -> None:
    command = _command(
        group,
        "report",
        "page:report",
        "write one page about explorations, to be opened in a browser: the log, how many "
        "hypotheses there are, what was refused, the best maps, and a replay step by step; the "
        "page marks what could not be counted or drawn within --timeout (default: 60)",
        """\
  topomap report instances/grid-3x3-snake.lp -o report.html
  topomap report instances/grid-4x4-snake.lp --bound 16 --timeout 120 -o report.html""",
    )
    add = command.add_argument
    add("instance", nargs="+", metavar="INSTANCE")
    add(
        "--maps",
        type=_number(int, 0),
        default=6,
        metavar="N",
        help="draw at most N of the best maps (default: %(default)s)",
    )
    add(
        "--maps-from",
        metavar="MAPS.json",
        help="show these maps instead of the best ones, from clingo --outf=2 or topomap solve "
        "--json (- is standard input)",
    )
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    _add_asked(command, PRUNING)
    command.set_defaults(timeout=60.0)


def _add_figures(group: Any) -> None:
    command = _command(
        group,
        "figures",
        "pictures:figures",
        "draw the paper's figures and some more, from computed answers",
        "  topomap figures -d docs/figures\n  topomap figures figure1 figure5 -d .",
    )
    command.add_argument(
        "figure",
        nargs="*",
        default=(),
        metavar="FIGURE",
        help="draw only these figures, such as figure1",
    )
    command.add_argument(
        "-d", "--directory", required=True, metavar="DIR", help="folder for FIGURE.svg"
    )
    command.add_argument(
        "--instances",
        metavar="DIR",
        help="folder of the instances (default: that of topomap path instances)",
    )


def _add_simulate(group: Any) -> None:
    command = _command(
        group,
        "simulate",
        "simulating:simulate",
        "let a robot explore an environment that it does not know, until it has one closed "
        "optimal map, and compare this map with the real one",
        """\
  topomap simulate grid 3 3
  topomap simulate maze 4 4 --seed 2 --signs 0.3 --perpendicular
  topomap simulate network city.graphml --slots 4 --north 29 --signs 0.3 --planar
  topomap simulate list instances/worlds.txt""",
    )
    common = Parser(add_help=False)
    add = common.add_argument
    _add_start(add, "the smallest")
    add("--seed", type=_number(int, 0), metavar="N", help="seed for signs and maze (default: 0)")
    add(
        "--steps",
        type=_number(int, 0, MOST_STEPS),
        metavar="N",
        help="walk at most N steps (default: 20 for each way)",
    )
    add("--marker", action="store_true", help="the robot carries a marker, and may put it down")
    add("--instance", metavar="FILE", help="also write what the robot did and saw, as an instance")
    _add_asked(common, PRUNING, horizon=False)
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    kinds = _add_environments(command, common, "--signs 0.3")
    help = "several environments: each line of a file has the arguments of topomap simulate"
    listed = kinds.add_parser(
        "list",
        help=help,
        description=help,
        epilog="example:\n  topomap simulate list instances/worlds.txt",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    listed.set_defaults(parse=parse)
    add = listed.add_argument
    add("file", metavar="FILE")
    add("--timeout", type=_number(float, 0.001), metavar="S", help="stop after S seconds")
    add("--json", action="store_true", help="write JSON")
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def _add_show(group: Any) -> None:
    command = _command(
        group,
        "show",
        "pictures:show",
        "print a map, drawn in the terminal and then described in words",
        """\
  topomap show instances/grid-4x4-snake.lp --perpendicular
  topomap show maps.json --map 3 | less -S
  clingo encodings/topomap.lp encodings/closed.lp instances/grid-3x3-snake.lp 0 --outf=2 \\
    | topomap show instances/grid-3x3-snake.lp -""",
    )
    _add_scene(command)


def _add_export(group: Any) -> None:
    command = _command(
        group,
        "export",
        "pictures:export",
        "write a map for other tools: GraphML, JSON (node-link), DOT, or facts for clingraph",
        """\
  topomap export instances/grid-4x4-snake.lp --map 2 --format graphml -o map.graphml
  topomap export maps.json --format dot | neato -n2 -Tsvg -o map.svg
  topomap export maps.json --format clingraph | clingraph --engine=neato --out=render""",
    )
    _add_scene(command)
    command.add_argument("--format", required=True, choices=EXPORTS)
    command.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def _add_import(group: Any) -> None:
    command = _command(
        group,
        "import",
        "pictures:import_",
        "read a map that export wrote, and write it as solve --json does",
        """\
  topomap export instances/grid-4x4-snake.lp --format graphml -o map.graphml
  topomap import map.graphml -o maps.json
  topomap check instances/grid-4x4-snake.lp maps.json""",
    )
    command.add_argument("file", metavar="FILE.graphml|FILE.json")
    command.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def _add_follow(group: Any) -> None:
    command = _command(
        group,
        "follow",
        "following:follow",
        "follow an exploration as it happens, and print after each step how many hypotheses there "
        "are, the best maps, what has become certain, and what to do next",
        """\
  topomap follow walk.lp --planar
  topomap follow instances/grid-3x3-snake.lp --no-wait --json
  robot | topomap follow - --log walk.log

lines: the facts of a step, as generate writes them: turn(1,0). view(1,0). view(1,2).
  or JSON: {"slots": 4, "view": [0, 1]} first, then {"turn": 2, "view": [0, 2]}; each may have
  "landmarks": ["a"], and "drop", "pick" or "marker": true. undo. or {"undo": 2} takes the last
  steps back. Facts that a line adds to the last step amend it.

what is certain: new(T), the place where the agent is after step T was not visited before;
  same(T,U) and linked(T,S,U,R) as in topomap ask --help. What is certain stays certain.""",
    )
    add = command.add_argument
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
        help="with standard input: write each line to FILE before it is answered; if FILE has "
        "lines already, go on after them",
    )
    add("--planar", action="store_true", help=PARTS["planar"])
    add("--bound", type=_number(int, 1), metavar="B", help="at most B places")
    add(
        "--marker",
        action="store_true",
        help="the agent carries a marker, which the next steps may use",
    )
    add(
        "--count-limit",
        type=_number(int, 1),
        default=MOST_COUNTED,
        metavar="N",
        help="if there are more than N hypotheses, say only that (default: %(default)s)",
    )
    add(
        "--timeout", type=_number(float, 0.001), metavar="S", help="at most S seconds for each step"
    )
    add(
        "--keep-going",
        action="store_true",
        help="report lines with a fault, and go on with the next line (status 0)",
    )
    add("--no-wait", dest="wait", action="store_false", help="stop at the end of the file")
    add("--json", action="store_true", help="a line of JSON for each step")


def _add_explore(group: Any) -> None:
    command = _command(
        group,
        "explore",
        "exploring:explore",
        "say where to go next: by the shortest further walk that tells the maps apart, or leaves "
        "the fewest of them in the worst case; if there is no such walk, by one to a pending "
        "gateway; or prove that no walk can ever tell the maps apart",
        """\
  topomap explore instances/grid-4x4-snake.lp --bound 16
  topomap generate grid 4 4 --route snake --truth truth.json -o grid.lp
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --marker
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --proof proof.json
  topomap explore grid.lp --check proof.json
  topomap explore grid.lp --bound 16 --facts | clingo encodings/explore.lp - -c n=3""",
    )
    add = command.add_argument
    add("instance", metavar="INSTANCE")
    add(
        "--among",
        action="append",
        metavar="MAPS",
        help="the maps that may be the real one: optimal (the best so far, if none is optimal), "
        "closed, perpendicular (and closed), or a file of maps of this instance; can be given "
        "several times (default: optimal)",
    )
    add(
        "--marker",
        action="store_true",
        help="the agent carries a marker, which it may put down once",
    )
    add(
        "--steps",
        type=_number(int, 1, 1000),
        default=LONGEST_WALK,
        metavar="N",
        help="look for walks of at most N steps (default: %(default)s)",
    )
    add(
        "--proof",
        metavar="FILE",
        help="write to FILE the proof that no walk tells maps apart, for --check",
    )
    what = command.add_mutually_exclusive_group()
    what.add_argument("--check", metavar="FILE", help="check the proofs that --proof wrote to FILE")
    what.add_argument(
        "--facts", action="store_true", help="print the maps as facts for encodings/explore.lp"
    )
    _add_query(command, PRUNING)


def _add_path(group: Any) -> None:
    command = _command(
        group,
        "path",
        "commands:path",
        "print the folder of the encodings, for clingo, or that of the instances",
        """\
  topomap path
  topomap clingo "$(topomap path)/topomap.lp" "$(topomap path instances)/grid-3x3-snake.lp" 0""",
    )
    command.add_argument(
        "what",
        nargs="?",
        choices=("encodings", "instances"),
        default="encodings",
        help="which folder (default: %(default)s)",
    )
    command.add_argument("--json", action="store_true", help="write JSON: both folders")


def _add_clingo(group: Any) -> None:
    _command(
        group,
        "clingo",
        "clingo_command:run",
        "run clingo itself, with its options and exit statuses",
        """\
  topomap clingo --help
  topomap clingo "$(topomap path)/topomap.lp" instances/grid-3x3-snake.lp 0 --quiet""",
    )


SUBCOMMANDS: dict[str, Callable[[Any], None]] = {
    "generate": _add_generate,
    "validate": _add_validate,
    "solve": _add_solve,
    "ask": _add_ask,
    "explain": _add_explain,
    "explore": _add_explore,
    "follow": _add_follow,
    "simulate": _add_simulate,
    "count": _add_count,
    "search": _add_search,
    "branching": _add_branching,
    "check": _add_check,
    "table": _add_table,
    "family": _add_family,
    "draw": _add_draw,
    "show": _add_show,
    "report": _add_report,
    "figures": _add_figures,
    "export": _add_export,
    "import": _add_import,
    "path": _add_path,
    "clingo": _add_clingo,
}
