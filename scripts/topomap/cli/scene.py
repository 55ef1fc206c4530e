"""The map that ``draw``, ``show`` and ``export`` are asked for."""

import argparse
from functools import partial
from typing import TYPE_CHECKING

from topomap.cli.calls import asked_query, parsed
from topomap.model.vocabulary import CHOSEN
from topomap.runtime.errors import InputError, say
from topomap.runtime.status import exit_status

if TYPE_CHECKING:
    from topomap.drawing.scenes import Scene


def scene_of(args: argparse.Namespace) -> "tuple[Scene | None, int]":
    """The map, and the exit status: partial, if it may not be the best."""
    from topomap.api.scenes import scenes_under
    from topomap.model import words
    from topomap.runtime.extras import need
    from topomap.runtime.watch import heeding

    need("draw", f"topomap {args.command}")
    query = asked_query(args, CHOSEN)
    with heeding(args.timeout) as watch:
        read = partial(parsed, args)
        found, fault, searched = scenes_under(watch, args.file, query, args.given, read)
    number = args.map or 1
    source = args.file if args.given is None else args.given
    if fault:
        none = "no map found yet; " if searched else "no map in it; "
        say(f"{source}: {'' if found else none}partial: {fault}")
    elif not found:
        say(f"{source}: no map {'is consistent with it' if searched else 'in it'}")
    elif number > len(found):
        many = words.number(len(found), "map")
        raise InputError(f"{source}: it has {many}, there is no map {number}")
    return (found[number - 1] if number <= len(found) else None), exit_status(fault, bool(found))
