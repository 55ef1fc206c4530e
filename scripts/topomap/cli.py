"""The command ``topomap``."""

import argparse
import json
import os
import shlex
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from topomap import __version__, environment, figure4, network
from topomap.errors import BAD_INPUT, DONE, INTERRUPTED, NO, PARTIAL, InputError
from topomap.experience import Experience, read
from topomap.family import expand
from topomap.files import output
from topomap.generate import Instance, instance
from topomap.report import Report
from topomap.solver import INTERRUPT, PARTS, Query, Stopped, Watch, best, hypotheses, solving
from topomap.statistics import KEYS, tree
from topomap.topology import TopologicalMap

STATUS = """\
exit status: 0 done; 1 the answer is no (the table differs, there is no map);
2 bad input or usage; 3 partial (a limit, a time-out); 130 interrupted"""


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{self.prog}: {message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit status."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    status = BAD_INPUT
    try:
        args = _parser().parse_args(arguments)
        status = args.run(args)
        sys.stdout.flush()
    except InputError as error:
        print(error, file=sys.stderr)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        status = INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = PARTIAL
    if solving():
        sys.stderr.flush()
        os._exit(status)  # clingo still grounds, in a thread that nothing can stop
    return status


def _generate(args: argparse.Namespace) -> int:
    made = _instance(args)
    if args.truth:
        with output(args.truth) as file:
            at = [[step, *dstate] for step, dstate in enumerate(made.truth)]
            json.dump({"maps": [{"at": at}], "complete": True}, file)
            file.write("\n")
    target = args.output
    if target and (target.endswith("/") or Path(target).is_dir()):
        target = str(Path(target) / f"{made.name}.lp")
    if target or not args.json:
        with output(target) as file:
            file.write(made.text())
    if args.json:
        summary = {
            "name": made.name,
            "file": target,
            "header": made.header,
            "steps": made.experience.steps,
            "facts": None if target else made.experience.facts(),
            "complete": True,
        }
        print(json.dumps(summary))
    return DONE


def _instance(args: argparse.Namespace) -> Instance:
    if args.kind == "network":
        world, warnings = network.load(args.file, args.slots, args.north)
        for warning in warnings:
            print(f"warning: {warning}", file=sys.stderr)
    elif args.kind == "maze":
        world = environment.maze(args.rows, args.columns, args.thin, args.seed or 0)
    elif args.kind in ("hexagons", "triangles"):
        world = environment.lattice(args.kind, args.rows, args.columns)
    else:
        world = environment.grid(args.rows, args.columns, args.kind)
    if args.route == "walk" and args.steps is None:
        raise InputError("topomap generate: --route walk needs --steps")
    return instance(
        world,
        args.route,
        steps=args.steps,
        start=args.start,
        facing=args.facing,
        signs=args.signs,
        seed=args.seed,
        name=args.name,
    )


def _query(args: argparse.Namespace) -> Query:
    parts = frozenset(part for part in PARTS if getattr(args, part))
    return Query(parts, args.bound, args.horizon)


def _solve(args: argparse.Namespace) -> int:
    inputs = [(path, read(path)) for path in args.instance]
    statuses = []
    with output(args.output) as out:
        if args.json and len(inputs) > 1:
            out.write('{"results": [\n')
        for number, (path, experience) in enumerate(inputs):
            if len(inputs) > 1:
                out.write(",\n" * (number > 0) if args.json else f"{path}\n")
            truth = _truth(args.truth, experience, args.horizon) if args.truth else None
            report = Report(out, path, experience, _query(args), truth, args.json)
            statuses.append(_solve_one(args, experience, report))
            if statuses[-1] == INTERRUPTED:
                break
        if args.json and len(inputs) > 1:
            complete = len(statuses) == len(inputs) and max(statuses) <= NO
            out.write(f'], "complete": {json.dumps(complete)}}}\n')
    return max(statuses)


def _solve_one(args: argparse.Namespace, experience: Experience, report: Report) -> int:
    query = _query(args)
    fault, candidate = None, None
    with Watch(args.timeout) as watch:
        try:
            for found in (best if args.optimal else hypotheses)(experience, query, watch):
                if not found.proved:
                    candidate = found
                elif report.count == args.limit:
                    fault = "limit"
                    break
                else:
                    report.add(found)
        except Stopped as stopped:
            fault = str(stopped)
        if fault and candidate and not report.count:
            report.add(candidate)
        report.end(fault)
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if report.count else NO


def _truth(file: str, experience: Experience, horizon: int | None) -> TopologicalMap:
    """The real map of an experience, from a file that ``generate --truth`` wrote."""
    try:
        steps = json.loads(Path(file).read_text(encoding="utf-8"))["maps"][0]["at"]
        at = tuple((place, slot) for _, place, slot in steps)
    except OSError as error:
        raise InputError(f"{file}: {(error.strerror or str(error)).lower()}") from None
    except (ValueError, LookupError, TypeError):
        raise InputError(f"{file}: not what generate --truth writes") from None
    if len(at) != experience.steps + 1:
        raise InputError(f"{file}: {len(at) - 1} steps, the instance has {experience.steps}")
    return experience.map_of(at if horizon is None else at[: horizon + 1])


def _count(args: argparse.Namespace) -> int:
    experience = read(args.instance)
    figures: dict[str, Any] = {}
    fault = None
    try:
        with Watch(args.timeout) as watch:
            tree(experience, _query(args), watch, figures)
    except Stopped as stopped:
        fault = str(stopped)
    with output(args.output) as out:
        if args.json:
            answer = {"instance": args.instance, **figures, "complete": not fault, "fault": fault}
            out.write(json.dumps(answer) + "\n")
        else:
            out.write("hypotheses after each step: ")
            out.write(" ".join(map(str, figures["per_step"])) + "\n")
            for key in KEYS:
                known = "not counted" if figures[key] is None else f"{figures[key]:,}"
                out.write(f"{figure4.WORDS[key]:<42}{known:>12}\n")
            if fault:
                out.write(f"partial: {fault}\n")
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if figures["final"] else NO


def _table(args: argparse.Namespace) -> int:
    rows: list[dict[str, Any]] = []
    complete = True
    with output(args.output, parents=True) as file:
        try:
            for row in figure4.rows(args.jobs):
                rows.append(row)
                print(f"counted {len(rows)} of {len(figure4.COLUMNS)} columns", file=sys.stderr)
        except Stopped:
            complete = False
        rows.sort(key=lambda row: (row["environment"], row["planarity"]))
        result = {"complete": complete, "rows": rows}
        json.dump(result, file, indent=1)
        file.write("\n")
    different = [cell for row in rows for cell in figure4.differences(row)]
    if args.json:
        print(json.dumps(result))
    else:
        print(figure4.text(rows))
        for cell in different:
            print(f"differs: {cell}")
        if not complete:
            print("partial: interrupted")
        elif not different:
            print("Every figure is the paper's.")
    return INTERRUPTED if not complete else NO if different else DONE


def _family(args: argparse.Namespace) -> int:
    folder = Path(args.directory)
    calls: dict[str, list[str]] = {}
    parser = _parser()
    for line, call in expand(args.file):
        try:
            made = _instance(parser.parse_args(["generate", *call]))
        except InputError as error:
            raise InputError(f"{args.file}:{line}: {error}") from None
        if made.name in calls:
            raise InputError(f"{args.file}:{line}: a second instance named {made.name}")
        calls[made.name] = call
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.args"):
        if old.stem not in calls:
            old.unlink()
            old.with_suffix(".lp").unlink(missing_ok=True)
    for name, call in calls.items():
        path = folder / f"{name}.args"
        text = shlex.join(call) + "\n"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            with output(str(path)) as file:
                file.write(text)
    print(
        json.dumps({"instances": list(calls), "complete": True}) if args.json else "\n".join(calls)
    )
    return DONE


def _parser() -> Parser:
    parser = Parser(
        prog="topomap",
        description="Exact topological map-building: every map consistent with an exploration.",
        epilog=STATUS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"topomap {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_generate(commands)
    _add_solve(commands)
    _add_count(commands)
    _add_table(commands)
    _add_family(commands)
    return parser


def _command(commands: Any, name: str, run: Any, help: str, example: str) -> Parser:
    command: Parser = commands.add_parser(
        name,
        help=help,
        description=help[0].upper() + help[1:] + ".",
        epilog=f"example:\n{example}\n\n{STATUS}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    return command


def _at_least(least: int) -> Any:
    def number(text: str) -> int:
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{text} is less than {least}")
        return value

    return number


def _seconds(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a positive number of seconds")
    return value


def _rate(text: str) -> float:
    value = float(text)
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"{text} is not between 0 and 1")
    return value


def _add_generate(commands: Any) -> None:
    command = _command(
        commands,
        "generate",
        _generate,
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
        "(4 slots; with 8, apart by commas: N,NE,E); or absolute slots: 0,3,1",
    )
    add("--steps", type=_at_least(0), metavar="N", help="cut the route after N steps")
    add("--start", metavar="PLACE", help="first place, such as 0,2 (default: the smallest)")
    add(
        "--facing",
        type=int,
        metavar="SLOT",
        help="gateway stood at first (default: the one first left by)",
    )
    add(
        "--signs",
        type=_rate,
        default=0.0,
        metavar="RATE",
        help="share of places that carry their own name as a landmark",
    )
    add("--seed", type=int, metavar="N", help="for walk, signs and maze (default: 0)")
    add("--name", help="name of the instance (default: made from the arguments)")
    add("--truth", metavar="FILE", help="also write the true hypothesis, for solve --truth")
    add("--json", action="store_true", help="print a summary as JSON")
    add("-o", "--output", metavar="FILE", help="file or folder to write (default: stdout)")
    kinds = command.add_subparsers(dest="kind", metavar="ENVIRONMENT", required=True)
    for kind, help in (
        ("grid", "a grid of places, four slots, slot 0 north"),
        ("cylinder", "a grid whose rows are rings"),
        ("torus", "a grid whose rows and columns are rings"),
        ("maze", "a connected grid thinned with the seed"),
        ("hexagons", "the corners of a sheet of hexagons, six slots"),
        ("triangles", "a triangular lattice, six slots"),
    ):
        sub = kinds.add_parser(kind, parents=[common], help=help, description=help)
        sub.add_argument("rows", type=_at_least(1))
        sub.add_argument("columns", type=_at_least(1))
        if kind == "maze":
            sub.add_argument(
                "--thin",
                type=_rate,
                default=0.3,
                metavar="RATE",
                help="share of the ways to take away (default: %(default)s)",
            )
    help = "a street or corridor network with coordinates"
    sub = kinds.add_parser("network", parents=[common], help=help, description=help)
    sub.add_argument("file", metavar="FILE.graphml")
    sub.add_argument(
        "--slots",
        type=_at_least(2),
        default=4,
        metavar="K",
        help="directions at a place, even (default: %(default)s)",
    )
    sub.add_argument(
        "--north",
        type=float,
        default=0.0,
        metavar="DEGREES",
        help="bearing of slot 0, clockwise of north (default: %(default)g)",
    )


def _add_query(command: Parser) -> None:
    for part, help in PARTS.items():
        command.add_argument(f"--{part}", action="store_true", help=help)
    command.add_argument("--bound", type=_at_least(1), metavar="B", help="at most B places")
    command.add_argument(
        "--horizon", type=_at_least(0), metavar="T", help="cut the experience after step T"
    )
    command.add_argument("--timeout", type=_seconds, metavar="S", help="stop after S seconds")
    command.add_argument("--json", action="store_true", help="write JSON")
    command.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def _add_solve(commands: Any) -> None:
    command = _command(
        commands,
        "solve",
        _solve,
        "enumerate the maps that are consistent with an exploration",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --closed
  topomap solve instances/grid-3x4-paper.lp --optimal --json""",
    )
    command.add_argument("instance", nargs="+", metavar="INSTANCE")
    command.add_argument(
        "--optimal",
        action="store_true",
        help="closed maps with consistent boundaries, fewest paths and places; "
        "if there is none, the best so far: pending gateways allowed",
    )
    command.add_argument("--limit", type=_at_least(1), metavar="N", help="stop after N maps")
    command.add_argument(
        "--truth",
        metavar="FILE",
        help="mark the maps that are the real one (from generate --truth)",
    )
    _add_query(command)


def _add_count(commands: Any) -> None:
    command = _command(
        commands,
        "count",
        _count,
        "count the search tree of an exploration, as the paper's Figure 4 does",
        "  topomap count instances/grid-4x4-snake.lp --planar --bound 16",
    )
    command.add_argument("instance", metavar="INSTANCE")
    _add_query(command)


def _add_table(commands: Any) -> None:
    command = _command(
        commands,
        "table",
        _table,
        "print the paper's Figure 4 beside ours, and write it as JSON",
        "  topomap table",
    )
    command.add_argument(
        "--jobs",
        type=_at_least(1),
        metavar="N",
        help="columns counted at a time (default: one a processor)",
    )
    command.add_argument("--json", action="store_true", help="print JSON instead of the table")
    command.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        default="results/figure4.json",
        help="file to write (default: %(default)s)",
    )


def _add_family(commands: Any) -> None:
    command = _command(
        commands,
        "family",
        _family,
        "name the instances of a family file, and write the call of each where it changed",
        "  topomap family instances/batch.txt -d build/instances",
    )
    command.add_argument("file", metavar="FAMILY")
    command.add_argument(
        "-d",
        "--directory",
        required=True,
        metavar="DIR",
        help="folder for NAME.args; files of instances no longer listed go",
    )
    command.add_argument("--json", action="store_true", help="print JSON")


def run() -> None:
    """Entry point of the command."""
    sys.exit(main())
