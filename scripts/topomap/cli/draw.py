"""The subcommand ``draw``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_scene, command
from topomap.cli.scene import with_scene


def add(group: Any) -> None:
    """The parser of ``topomap draw``."""
    made = command(
        group,
        "draw",
        """\
  topomap draw instances/grid-4x4-snake.lp --map 2 -o map.svg
  topomap solve instances/grid-3x3-snake.lp --closed --json -o maps.json
  topomap draw maps.json --map 3 -o map.png""",
    )
    add_scene(made)
    made.add_argument(
        "-o", "--output", required=True, metavar="FILE", help="FILE.svg, FILE.png or FILE.pdf"
    )


def run(args: argparse.Namespace) -> int:
    """Draw a map into a file."""
    from topomap.api.draw import form_of, save

    form_of(args.output)
    return with_scene(args, lambda scene, late: save(scene, args.output, late))
