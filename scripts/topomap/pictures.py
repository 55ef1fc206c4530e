"""The subcommands that show maps, and the exit status each ends with."""

import argparse
import mmap
import os
import shutil
import sys
from pathlib import Path

from topomap import exports, scenes, words
from topomap.commands import exit_status
from topomap.errors import DONE, INTERRUPTED, InputError, say
from topomap.extras import need
from topomap.files import output
from topomap.folders import INSTANCES
from topomap.query import Query
from topomap.scenes import Scene
from topomap.solver import Stopped, Watch
from topomap.vocabulary import PARTS

FORMATS = ("svg", "png", "pdf")
LEAST, MOST = 20, 100  # columns of a terminal
MEMORY = 300 << 20  # what numpy, scipy and matplotlib map when they are loaded, and some more


def ready() -> None:
    """Before numpy is loaded: OpenBLAS would wait without end for memory that is not there, and
    a library that does not fit into it is an ImportError. One thread will do. Raises
    MemoryError."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        mmap.mmap(-1, MEMORY, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ).close()
    except OSError:
        raise MemoryError from None


def draw(args: argparse.Namespace) -> int:
    """Draw a map into a file."""
    form = Path(args.output).suffix[1:].lower()
    if form not in FORMATS:
        raise InputError(f"{args.output}: a picture is {', '.join(FORMATS)}, by its last letters")
    need("draw", f"topomap {args.command}")
    scene, status = _scene(args)
    if scene is not None:
        ready()
        from topomap import draw  # matplotlib takes its time

        with output(args.output, binary=True) as file:
            draw.save(draw.picture([scene]), file, form)
    return status


def show(args: argparse.Namespace) -> int:
    """Print a map."""
    need("draw", f"topomap {args.command}")
    scene, status = _scene(args)
    if scene is None:
        return status
    ready()
    from topomap import terminal  # scipy, too

    columns = shutil.get_terminal_size().columns
    coloured = sys.stdout.isatty() and os.environ.get("TERM") != "dumb"
    coloured &= not os.environ.get("NO_COLOR")
    text = terminal.text(scene, max(LEAST, min(columns, MOST)), coloured)
    try:
        "─│╴⠿→".encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        text = text.translate(terminal.ASCII)
    sys.stdout.write(text)
    return status


def export(args: argparse.Namespace) -> int:
    """Write a map for other tools."""
    need("draw", f"topomap {args.command}")
    scene, status = _scene(args)
    if scene is None:
        return status
    ready()
    with output(args.output) as file:
        file.write(exports.FORMATS[args.format](scene))
    return status


def import_(args: argparse.Namespace) -> int:
    """Read a map that ``export`` wrote, and write it as ``solve --json`` does."""
    content = exports.read(args.file)
    with output(args.output) as file:
        file.write(content)
    return DONE


def _scene(args: argparse.Namespace) -> tuple[Scene | None, int]:
    """The map that is asked for, and the exit status: partial, if it may not be the best."""
    parts = frozenset(part for part in PARTS if getattr(args, part, False))
    with Watch(args.timeout) as watch:
        query = Query(parts, args.bound, args.horizon)
        found, fault = scenes.read(args.file, query, watch, args.given)
    number = args.map or 1
    source = args.file if args.given is None else args.given
    if fault:
        none = "" if found else "no map found yet; "
        say(f"{args.file}: {none}partial: {fault}")
    elif not found:
        say(f"{args.file}: no map is consistent with it")
    elif number > len(found):
        many = words.number(len(found), "map")
        raise InputError(f"{source}: it has {many}, there is no map {number}")
    return (found[number - 1] if number <= len(found) else None), exit_status(fault, bool(found))


def figures(args: argparse.Namespace) -> int:
    """Draw the paper's figures, and some more, into a folder."""
    need("draw", "topomap figures")
    ready()
    from topomap import draw
    from topomap.figures import figures

    folder = Path(args.directory)
    with Watch() as watch:
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
                    draw.save(figure, out, "svg")
                print(folder / f"{name}.svg")
        except Stopped as stop:
            say(f"{folder}: partial: {stop}")
            return INTERRUPTED
    return DONE
