"""The subcommand ``report``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_asked, add_instance, add_known, command, number
from topomap.cli.calls import asked_query, experience_of, known_options
from topomap.model.vocabulary import CHOSEN
from topomap.runtime.errors import InputError, say
from topomap.runtime.status import exit_status


def add(group: Any) -> None:
    """The parser of ``topomap report``."""
    made = command(
        group,
        "report",
        """\
  topomap report instances/grid-3x3-snake.lp -o report.html
  topomap report instances/grid-4x4-snake.lp --bound 16 --timeout 120 -o report.html""",
    )
    add = made.add_argument
    add_instance(made, nargs="+")
    add(
        "--maps",
        type=number(int, 0),
        default=6,
        metavar="N",
        help="draw at most N of the best maps (default: %(default)s)",
    )
    add(
        "--maps-from",
        metavar="MAPS.json",
        help="show these maps instead of the best ones, from clingo --outf=2 or topomap solve "
        "--json (- is standard input; default: none)",
    )
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    add_asked(made, CHOSEN)
    add_known(made)
    made.set_defaults(timeout=60.0)


def run(args: argparse.Namespace) -> int:
    """Write the page about the instances."""
    from topomap.runtime.extras import need
    from topomap.runtime.files import output
    from topomap.runtime.watch import heeding

    need("draw", "topomap report")
    from topomap.api.report import report_under

    seen = [(path, experience_of(args, path)) for path in args.instance]
    if len(dict(seen)) < len(seen):
        raise InputError("topomap report: an instance is named twice")
    if args.maps_from is not None and len(seen) > 1:
        raise InputError("topomap report: --maps-from goes with one instance")
    query = asked_query(args, CHOSEN)
    with output(args.output) as out, heeding(args.timeout) as watch:
        told = known_options(args)
        made = report_under(watch, seen, query, args.maps, args.timeout, args.maps_from, told)
        out.write(made.html())
    for name, fault in made.faults:
        say(f"{name}: partial: {fault}")
    return exit_status(made.fault, made.has_maps)
