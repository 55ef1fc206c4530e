"""The subcommand ``figures``."""

import argparse
from pathlib import Path
from typing import Any

from topomap.cli.arguments import command
from topomap.runtime.errors import InputError, say
from topomap.runtime.status import DONE, INTERRUPTED


def add(group: Any) -> None:
    """The parser of ``topomap figures``."""
    made = command(
        group,
        "figures",
        "  topomap figures -d docs/figures\n  topomap figures figure1 figure5 -d .",
    )
    made.add_argument(
        "figure",
        nargs="*",
        default=(),
        metavar="FIGURE",
        help="draw only these figures, such as figure1",
    )
    made.add_argument(
        "-d", "--directory", required=True, metavar="DIR", help="folder for FIGURE.svg"
    )
    made.add_argument(
        "--instances",
        metavar="DIR",
        help="folder of the instances (default: that of topomap path instances)",
    )


def run(args: argparse.Namespace) -> int:
    """Draw the paper's figures, and some more, into a folder."""
    from topomap.drawing.ready import ready
    from topomap.runtime.extras import need
    from topomap.runtime.files import output
    from topomap.runtime.folders import INSTANCES
    from topomap.runtime.watch import Stopped, heeding

    need("draw", "topomap figures")
    ready()
    from topomap.drawing import sheet
    from topomap.paper.figures import figures

    folder = Path(args.directory)
    with heeding() as watch:
        made = figures(Path(args.instances or INSTANCES), watch)
        chosen = args.figure or list(made)
        for name in chosen:
            if name not in made:
                raise InputError(f"{name}: the figures are {', '.join(made)}")
        try:
            for name in chosen:
                watch.title(name)
                figure = made[name]()
                watch.tick()
                with output(str(folder / f"{name}.svg"), parents=True, binary=True) as out:
                    sheet.save(figure, out, "svg")
                print(folder / f"{name}.svg")
        except Stopped as stop:
            say(f"{folder}: partial: {stop}")
            return INTERRUPTED
    return DONE
