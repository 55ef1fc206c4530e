"""The map that ``draw``, ``show`` and ``export`` are asked for, and the time that they have."""

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from topomap.cli.calls import asked_query, parsed
from topomap.model.vocabulary import CHOSEN
from topomap.runtime.errors import InputError, say
from topomap.runtime.status import PARTIAL, exit_status

if TYPE_CHECKING:
    from topomap.drawing.scenes import Scene
    from topomap.runtime.watch import Late

SEARCH = 0.7  # the largest share of the time for the search; the rest is for the drawing


def with_scene(args: argparse.Namespace, show: "Callable[[Scene, Late], str]") -> int:
    """Search for the map and show it, both within the time limit; return the exit status.

    ``show`` gets a function that tells whether the time is over. It returns a note if the map is
    then drawn plainly. This is partial, and so is a map that may not be the best.
    """
    from topomap.api.scenes import scenes_under
    from topomap.model import words
    from topomap.runtime.extras import need
    from topomap.runtime.watch import Stopped, heeding

    need("draw", f"topomap {args.command}")
    query = asked_query(args, CHOSEN)
    number = args.map or 1
    begun = time.monotonic()
    with heeding(args.timeout * SEARCH) as watch:
        read = partial(parsed, args)
        found, fault, searched = scenes_under(watch, args.file, query, args.given, read, number)
    source = args.file if args.given is None else args.given
    if fault:
        none = "no map found yet; " if searched else "no map in it; "
        say(f"{source}: {'' if found else none}partial: {fault}")
    elif not found:
        say(f"{source}: no map {'is consistent with it' if searched else 'in it'}")
    elif number > len(found):
        many = words.number(len(found), "map")
        raise InputError(f"{source}: it has {many}, there is no map {number}")
    status = exit_status(fault, bool(found))
    if number > len(found):
        return status
    left = max(0.0, args.timeout - (time.monotonic() - begun))
    scene = found[number - 1]
    if args.like is not None:
        from topomap.api.scenes import drawn_like

        scene, told = drawn_like(scene, args.like)
        if told:
            say(f"{args.like}: {told}")
    try:
        with heeding(left, quiet=True) as watch:
            note = show(scene, watch.late)
    except Stopped as stopped:
        say(f"{source}: partial: {stopped}")
        return exit_status(str(stopped), False)
    if note:
        say(f"{source}: partial: {note} (--timeout gives it more time)")
        status = status or PARTIAL
    return status
