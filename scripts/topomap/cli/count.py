"""The subcommand ``count``."""

import argparse
from typing import Any

from topomap.cli.arguments import (
    add_circumscribe,
    add_crew,
    add_instance,
    add_known,
    add_query,
    add_resume,
    command,
)
from topomap.cli.calls import asked_query, crew_of, experience_of, run_of
from topomap.cli.tell import tell
from topomap.model.vocabulary import OPTIMIZING, PARTS
from topomap.runtime.errors import InputError
from topomap.runtime.files import output
from topomap.runtime.journal import Journal


def add(group: Any) -> None:
    """The parser of ``topomap count``."""
    made = command(
        group,
        "count",
        """\
  topomap count instances/grid-4x4-snake.lp --planar --bound 16
  topomap count instances/grid-4x4-snake.lp --jobs 2
  topomap count instances/grid-3x4-paper.lp --circumscribe
  topomap generate grid 4 5 --route snake | topomap count - --merging""",
    )
    add_instance(made)
    add_known(made)
    add_query(made, [part for part in PARTS if part not in OPTIMIZING])
    add_circumscribe(made)
    made.add_argument(
        "--merging",
        action="store_true",
        help="count by merging hypotheses that have the same future, if there are too many maps "
        "to list: all maps, the closed ones, and those that are closed and perpendicular",
    )
    add_crew(made)
    add_resume(made)


def run(args: argparse.Namespace) -> int:
    """Count the search tree of an instance, by clingo."""
    from topomap.api.count import count_under, merged_under
    from topomap.runtime.watch import heeding

    experience = experience_of(args, args.instance)
    if args.merging and (args.circumscribe or args.dask or (args.jobs or 1) > 1 or args.resume):
        other = "--circumscribe, --jobs, --dask or --resume"
        raise InputError(f"topomap count: --merging cannot be combined with {other}")
    with (
        crew_of(args) as crew,
        Journal(args.output, run_of(args, experience), args.resume) as journal,
        output(args.output) as out,
    ):
        with heeding(args.timeout) as watch:
            query = asked_query(args)
            if args.merging:
                counts = merged_under(watch, experience, query)
            else:
                counts = count_under(watch, experience, query, journal, crew, args.circumscribe)
        status = tell(args, out, counts, bool(counts["final"]), args.instance)
        journal.complete = counts.complete
    return status
