"""The subcommand ``explore``."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_instance, add_known, add_query, command, number
from topomap.cli.calls import asked_query, experience_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import CHOSEN
from topomap.runtime import formats
from topomap.runtime.errors import InputError, say
from topomap.runtime.files import output
from topomap.runtime.limits import LONGEST_WALK, MOST_WALKED
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.model.experience import Experience


def add(group: Any) -> None:
    """The parser of ``topomap explore``."""
    made = command(
        group,
        "explore",
        """\
  topomap explore instances/grid-4x4-snake.lp --bound 16
  topomap generate grid 4 4 --route snake --truth truth.json -o grid.lp
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --marker
  topomap explore grid.lp --bound 16 --among optimal --among truth.json --proof proof.json
  topomap explore grid.lp --check proof.json
  topomap explore grid.lp --bound 16 --facts | clingo encodings/explore.lp - -c n=3""",
    )
    add = made.add_argument
    add_instance(made)
    add(
        "--among",
        action="append",
        metavar="MAPS",
        help="the maps that may be the real one: optimal (the best so far, if no map is "
        "closed), closed, perpendicular (these are closed, too), or a file of maps of this "
        "instance; can be given several times (default: optimal)",
    )
    add(
        "--marker",
        action="store_true",
        help="the agent carries a marker, which it may put down once",
    )
    add(
        "--steps",
        type=number(int, 1, MOST_WALKED),
        default=LONGEST_WALK,
        metavar="N",
        help="look for walks of at most N steps (default: %(default)s)",
    )
    add(
        "--proof",
        metavar="FILE",
        help="write to FILE the proof that no walk tells maps apart, for --check "
        "(default: not written)",
    )
    what = made.add_mutually_exclusive_group()
    what.add_argument(
        "--check",
        metavar="FILE",
        help="check the proofs that --proof wrote to FILE (default: none)",
    )
    what.add_argument(
        "--facts", action="store_true", help="print the maps as facts for encodings/explore.lp"
    )
    add_query(made, CHOSEN)
    add_known(made)


def run(args: argparse.Namespace) -> int:
    """Say where to go next."""
    from topomap.api.explore import candidates_under, explore_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    if args.proof and args.output and Path(args.proof).resolve() == Path(args.output).resolve():
        raise InputError(f"{args.proof}: it cannot be both --output and --proof")
    if args.check:
        return _check(args, experience)
    with output(args.output) as out, heeding(args.timeout) as watch:
        asked = args.among or ["optimal"]
        among = candidates_under(watch, experience, asked, asked_query(args, CHOSEN))
        if args.facts and among.each:
            out.write(among.facts(args.marker))
            return exit_status(among.fault, True)
        made = explore_under(watch, among, args.marker, args.steps)
        if args.proof and among.each:
            with output(args.proof) as file:
                told = {"instance": args.instance, **made.proofs()}
                file.write(formats.line(told, made.fault))
        if not among.each:
            say(f"{args.instance}: {among.lack()}")
        yes = made.kind not in ("bisimilar", "no map")
        if args.json or among.each:
            return tell(args, out, made, yes, args.instance)
        return exit_status(made.fault, yes)


def _check(args: argparse.Namespace, experience: "Experience") -> int:
    """Check the proofs that ``--proof`` wrote."""
    from topomap.api.explore import check_proofs

    checked = check_proofs(experience, args.check, horizon=args.horizon)
    with output(args.output) as out:
        return tell(args, out, checked, not checked.wrong, args.instance)
