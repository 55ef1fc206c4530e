"""The subcommand ``export``."""

import argparse
from typing import TYPE_CHECKING, Any

from topomap.cli.arguments import add_scene, command
from topomap.cli.scene import with_scene
from topomap.runtime.limits import EXPORTS

if TYPE_CHECKING:
    from topomap.drawing.scenes import Scene
    from topomap.runtime.watch import Late


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
    made.add_argument(
        "--format", required=True, choices=EXPORTS, help="the format to write (required)"
    )
    made.add_argument("-o", "--output", metavar="FILE", help="file to write (default: stdout)")


def run(args: argparse.Namespace) -> int:
    """Write a map for other tools."""
    from topomap.api.exchange import exported
    from topomap.runtime.files import output

    def show(scene: "Scene", late: "Late") -> str:
        """Write the map, and return a note if it is drawn plainly."""
        text, note = exported(scene, args.format, late)
        with output(args.output) as file:
            file.write(text)
        return note

    return with_scene(args, show)
