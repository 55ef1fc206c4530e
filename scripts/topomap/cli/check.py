"""The subcommand ``check``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_instance, add_known, add_query, command, number
from topomap.cli.calls import asked_query, experience_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import PROPERTIES, RELAXING
from topomap.runtime.errors import InputError
from topomap.runtime.files import output


def add(group: Any) -> None:
    """The parser of ``topomap check``."""
    made = command(
        group,
        "check",
        """\
  topomap solve instances/grid-3x3-snake.lp --planar --json -o maps.json
  topomap check instances/grid-3x3-snake.lp maps.json --planar
  topomap check --all instances/grid-3x3-snake.lp maps.json""",
    )
    add_instance(made)
    made.add_argument(
        "maps",
        metavar="MAPS.json",
        help="maps from topomap solve --json or clingo --outf=2; a map needs the key at, "
        "[[T,P,S], ...], and its other keys are verified. The parts, bound, horizon, kind, "
        "cost and count of the file are verified, too. Whether the list is complete is "
        "not verified",
    )
    made.add_argument(
        "--truth",
        metavar="FILE",
        help="the real map (from generate --truth), to verify the key real (default: none)",
    )
    made.add_argument(
        "--noise",
        type=number(int, 0),
        metavar="K",
        help="a map may contradict up to K views, which its key misread names, and at most as "
        "many as its file allows (default: as many as its file allows)",
    )
    made.add_argument(
        "--all",
        action="store_true",
        help="report for each map which axioms and defaults it breaks, and name its exceptions to "
        "consistent boundaries; breaking an axiom, also the path axiom, is then an error only "
        "if it is demanded here or claimed in the file",
    )
    add_query(made, (*PROPERTIES, *RELAXING), horizon=False)
    add_known(made)


def run(args: argparse.Namespace) -> int:
    """Check maps that anyone made, by rules and by definition."""
    from topomap.api.check import check_under
    from topomap.documents import maps
    from topomap.runtime.watch import heeding

    documents = maps.read_maps(args.maps)
    noisy = maps.noisy(documents) or args.noise is not None
    experience = experience_of(args, args.instance, noisy)
    documents = maps.of_instance(documents, args.instance)
    if not documents:
        raise InputError(f"{args.maps}: no maps of {args.instance} in it")
    truth = maps.real_map(args.truth, experience, None) if args.truth else None
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            query = asked_query(args, (*PROPERTIES, *RELAXING))
            judged = check_under(watch, experience, documents, query, truth, args.all)
        return tell(args, out, judged, not judged.unsound, args.instance)
