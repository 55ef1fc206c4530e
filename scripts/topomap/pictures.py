"""The subcommands that show maps, and the exit status each ends with."""

import argparse
from pathlib import Path

from topomap import scenes
from topomap.errors import DONE, INTERRUPTED, PARTIAL, InputError, say
from topomap.files import output
from topomap.scenes import Scene
from topomap.solver import INTERRUPT, PARTS, Query, Watch

FORMATS = ("svg", "png", "pdf")


def draw(args: argparse.Namespace) -> int:
    """Draw a map into a file."""
    form = Path(args.output).suffix[1:].lower()
    if form not in FORMATS:
        raise InputError(f"{args.output}: a picture is {', '.join(FORMATS)}, by its last letters")
    with output(args.output, binary=True) as file:
        scene, status = _scene(args)
        if scene is None:
            raise InputError(f"{args.file}: no map to draw")
        from topomap import draw  # matplotlib takes its time

        draw.save(draw.picture([scene]), file, form)
    return status


def _scene(args: argparse.Namespace) -> tuple[Scene | None, int]:
    """The map that is asked for, and the exit status: partial, if it may not be the best."""
    parts = frozenset(part for part in PARTS if getattr(args, part, False))
    with Watch(args.timeout) as watch:
        found, fault = scenes.read(args.file, Query(parts, args.bound, args.horizon), watch)
    if fault:
        say(f"{args.file}: partial: {fault}")
    number = args.map or 1
    if number > len(found) and (found or not fault):
        raise InputError(f"{args.file}: it has {len(found)} maps, there is no map {number}")
    status = (INTERRUPTED if fault == INTERRUPT else PARTIAL) if fault else DONE
    return (found[number - 1] if found else None), status


def figures(args: argparse.Namespace) -> int:
    """Draw the paper's figures, and some more, into a folder."""
    from topomap import draw
    from topomap.figures import figures

    folder = Path(args.directory)
    with Watch() as watch:
        made = figures(Path(args.instances), watch)
        chosen = args.figure or list(made)
        for name in chosen:
            if name not in made:
                raise InputError(f"{name}: the figures are {', '.join(made)}")
        for name in chosen:
            watch.title(name)
            file = folder / f"{name}.svg"
            with output(str(file), parents=True, binary=True) as out:
                draw.save(made[name](), out, "svg")
            print(file)
    return DONE
