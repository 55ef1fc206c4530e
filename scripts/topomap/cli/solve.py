"""The subcommand ``solve``."""

import argparse
import json
from typing import IO, TYPE_CHECKING, Any

from topomap.cli.arguments import (
    add_circumscribe,
    add_crew,
    add_encoding,
    add_instance,
    add_known,
    add_optimal,
    add_query,
    add_resume,
    command,
    number,
)
from topomap.cli.calls import asked_query, crew_of, experience_of, run_of
from topomap.model.vocabulary import PARTS
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import output
from topomap.runtime.journal import Journal
from topomap.runtime.status import INTERRUPT, exit_status

if TYPE_CHECKING:
    from topomap.model.experience import Experience
    from topomap.model.topology import TopologicalMap
    from topomap.solver.share import Crew


def add(group: Any) -> None:
    """The parser of ``topomap solve``."""
    made = command(
        group,
        "solve",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --closed
  topomap solve instances/grid-3x4-paper.lp --optimal --json
  topomap solve instances/grid-4x4-snake.lp --circumscribe --planar
  topomap solve instances/grid-4x4-snake.lp --bound 16 --jobs 2 -o maps.txt
  topomap solve instances/grid-3x3-misread.lp --optimal --planar --noise 1""",
    )
    add_instance(made, nargs="+")
    add_known(made)
    add_optimal(made)
    add_circumscribe(made)
    made.add_argument(
        "--limit", type=number(int, 1), metavar="N", help="stop after N maps (default: no limit)"
    )
    made.add_argument(
        "--truth",
        metavar="FILE",
        help="mark the maps that are the real one (from generate --truth; default: none)",
    )
    made.add_argument(
        "--by",
        choices=("auto", "clingo", "search"),
        default="auto",
        help="how to find the maps: clingo; search, in Python; or auto, whichever has less work "
        "to do, which is decided by counted work, never by time (default: %(default)s)",
    )
    add_query(made, PARTS)
    add_crew(made, "; not with --optimal, --circumscribe, --minimal or --genus")
    add_encoding(made)
    add_resume(made)
    made.add_argument(
        "--noise",
        type=number(int, 0),
        metavar="K",
        help="up to K views, as few as possible, may be wrong: gateways and landmarks were "
        "missed or imagined (default: no view is wrong)",
    )


def run(args: argparse.Namespace) -> int:
    """Enumerate the maps of each instance."""
    _combined(args)
    inputs = []
    for path in args.instance:
        experience = experience_of(args, path, args.noise is not None)
        truth = None
        if args.truth:
            from topomap.documents.maps import real_map

            truth = real_map(args.truth, experience, args.horizon)
        inputs.append((path, experience, truth))
    journal_of = run_of(args, *(experience for _, experience, _ in inputs))
    statuses, faults = [], []
    with (
        crew_of(args) as crew,
        Journal(args.output, journal_of, args.resume, True) as journal,
        output(args.output) as out,
    ):
        if args.json and len(inputs) > 1:
            out.write(json.dumps(formats.headed({}))[:-1] + ', "results": [\n')
        for number, (path, experience, truth) in enumerate(inputs):
            if len(inputs) > 1:
                out.write(",\n" * (number > 0) if args.json else f"{path}\n")
            fault, some = _solve_one(args, path, experience, truth, journal, crew, out)
            statuses.append(exit_status(fault, some))
            if fault:
                faults.append(fault)
                journal.stop()
            if fault == INTERRUPT:
                break
        if args.json and len(inputs) > 1:
            last = faults[-1] if faults else None
            out.write("], " + json.dumps(formats.ended(last))[1:] + "\n")
        journal.complete = not faults
    return max(statuses)


def _solve_one(
    args: argparse.Namespace,
    path: str,
    experience: "Experience",
    truth: "TopologicalMap | None",
    journal: Journal,
    crew: "Crew",
    out: IO[str],
) -> tuple[str | None, bool]:
    """Write the maps of an instance.

    Returns:
        Why they may not be all, or None, and whether there are any.
    """
    from topomap.api.solve import solve_under
    from topomap.documents.answers import Report
    from topomap.runtime.watch import Attempt, heeding

    with heeding(args.timeout) as watch:
        answer = solve_under(
            watch,
            experience,
            asked_query(args),
            by=args.by,
            optimal=args.optimal,
            circumscribe=args.circumscribe,
            limit=args.limit,
            journal=journal,
            crew=crew,
        )
        kind = "optimal" if args.optimal else "circumscribed" if args.circumscribe else None
        report = Report(out, path, experience, answer.query, kind, truth, args.json)
        with Attempt() as attempt:
            for one in answer.stream():
                report.add(one.found)
        fault, way = attempt.fault or answer.fault, None
        if fault is None:
            with Attempt():  # if it is cut short, nothing is claimed
                way = answer.in_the_way()
        report.end(fault, by=answer.by, least=answer.least, way=way)
    return fault, bool(report.count)


def _combined(args: argparse.Namespace) -> None:
    """Refuse a preference, or misreadings, together with what cannot be combined with them.

    Raises:
        InputError: There is such a combination.
    """
    asked = {
        "--optimal": args.optimal,
        "--minimal": args.minimal,
        "--genus": args.genus,
        "--noise": args.noise is not None,
        "--by search": args.by == "search",
        "--encoding paper": args.encoding == "paper",
        "--jobs": (args.jobs or 1) > 1,
        "--dask": args.dask,
        "--resume": args.resume,
        "--truth": args.truth,
    }
    without = {
        "--circumscribe": ("--optimal", "--minimal", "--genus", "--noise", "--encoding paper"),
        "--noise": ("--by search", "--encoding paper", "--jobs", "--dask", "--resume", "--truth"),
    }
    given = {"--circumscribe": args.circumscribe, "--noise": args.noise is not None}
    for option, others in without.items():
        for other in others:
            if given[option] and asked[other]:
                raise InputError(f"topomap solve: {option} cannot be combined with {other}")
