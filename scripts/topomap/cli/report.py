"""The subcommand ``report``."""

import argparse
import time
from dataclasses import replace
from typing import Any

from topomap.cli.arguments import add_asked, command, number
from topomap.cli.calls import parts_of
from topomap.model.vocabulary import PRUNING
from topomap.runtime.errors import InputError, say
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import INTERRUPT, exit_status


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
    add("instance", nargs="+", metavar="INSTANCE")
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
        "--json (- is standard input)",
    )
    add("-o", "--output", metavar="FILE", help="file to write (default: stdout)")
    add_asked(made, PRUNING)
    made.set_defaults(timeout=60.0)


def run(args: argparse.Namespace) -> int:
    """Write the page about the instances."""
    from topomap.api.parts import query_of
    from topomap.model.facts import read
    from topomap.page.exploration import Exploration, given_maps
    from topomap.page.report import Asked, page
    from topomap.runtime.extras import need
    from topomap.runtime.files import output
    from topomap.runtime.watch import heeding

    need("draw", "topomap report")
    seen = [(path, read(path)) for path in args.instance]
    if len({path for path, _ in seen}) < len(seen):
        raise InputError("topomap report: an instance is named twice")
    query = query_of(parts_of(args, PRUNING), bound=args.bound, horizon=args.horizon)
    given = None
    if args.maps_from is not None:
        if len(seen) > 1:
            raise InputError("topomap report: --maps-from goes with one instance")
        given = given_maps(args.maps_from, *seen[0], query)
    with output(args.output) as out, heeding(args.timeout) as watch:
        end = time.monotonic() + args.timeout
        made = []
        for nth, (path, one) in enumerate(seen):
            share = (end - time.monotonic()) / (len(seen) - nth)
            cut = one.cut(LARGEST if query.horizon is None else query.horizon)
            about = Exploration(path, cut, replace(query, horizon=None), args.maps, watch, given)
            about.look(max(0.0, share))
            made.append(about)
        asked = Asked(args.instance, query, args.maps, args.timeout, args.maps_from)
        out.write(page(asked, made))
    for about in made:
        for fault in about.faults:
            say(f"{about.name}: partial: {fault}")
    faults = [fault for about in made for fault in about.faults]
    fault = INTERRUPT if any(fault.endswith(INTERRUPT) for fault in faults) else "".join(faults)
    return exit_status(fault, all(about.best for about in made))
