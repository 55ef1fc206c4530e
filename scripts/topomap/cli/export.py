"""The subcommand ``export``."""

import argparse
from typing import Any

from topomap.cli.arguments import add_scene, command
from topomap.cli.scene import scene_of
from topomap.runtime.limits import EXPORTS


def add(group: Any) -> None:
    """The parser of ``topomap export``."""
    made = command(
        group,
        "export",
        """\
  topomap export instances/grid-4x4-snake.lp --map 2 --format graphml -o map.graphml
  topomap export maps.json --format dot | neato -n2 -Tsvg -o map.svg
  topomap export maps.json --format clingraph | clingraph --engine=neato --out=render""",
    )
    add_scene(made)
    made.add_argument("--format", required=True, choices=EXPORTS)
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Write a map for other tools."""
    from topomap.api.exchange import exported
    from topomap.runtime.files import output

    scene, status = scene_of(args)
    if scene is not None:
        with output(args.output) as file:
            file.write(exported(scene, args.format))
    return status
