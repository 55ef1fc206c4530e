"""What several subcommands make of their arguments."""

import argparse
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from topomap.model.vocabulary import OPTIMIZING, PARTS, unstated
from topomap.runtime.errors import InputError, say

if TYPE_CHECKING:
    from topomap.model.experience import Experience
    from topomap.model.query import Query
    from topomap.solver.share import Crew
    from topomap.worlds.environment import Environment
    from topomap.worlds.senses import Senses


# Commands about the maps of each beginning of an experience, or about the maps in a file.
ONLY_PAIRS = ("branching", "check", "count", "report", "search")


def experience_of(args: argparse.Namespace, path: str, noisy: bool = False) -> "Experience":
    """Read the experience in an instance file, and add what is taken for granted.

    Raises:
        InputError: The file is not an instance, or an assumption is not a statement about it.
    """
    from topomap.model import facts

    return known(args, facts.read(path, noisy, *_measured(args)))


def _measured(args: argparse.Namespace) -> tuple[int | None, int | None, int | None]:
    return args.drift, args.stretch, args.tolerance


def known_options(args: argparse.Namespace) -> list[str]:
    """List the options of a call that tell what is known besides the facts of instances."""
    told = [("--assume", text) for text in args.assume or ()]
    told += [
        (f"--{name}", str(value))
        for name in ("drift", "stretch", "tolerance")
        if (value := getattr(args, name)) is not None
    ]
    return [word for pair in told for word in pair]


def parsed(args: argparse.Namespace, text: str, source: str) -> "Experience":
    """Make the experience from the text of an instance, which ``source`` names in errors."""
    from topomap.model import facts

    return known(args, facts.parse(text, source, False, *_measured(args)))


def known(args: argparse.Namespace, experience: "Experience") -> "Experience":
    """Add to an experience what is taken for granted.

    Raises:
        InputError: An assumption is not a statement about the experience, or cannot be used here.
    """
    if not args.assume:
        return experience
    from topomap.api.assume import assumed

    name = f"topomap {args.command}: --assume"
    horizon = getattr(args, "horizon", None)
    seen = experience if horizon is None else experience.cut(horizon)
    told = assumed(name, seen, tuple(args.assume))
    if told.assumed and args.command in ONLY_PAIRS:
        raise InputError(f"{name}: here it can only be same(T,U) or not same(T,U)")
    if told.assumed and getattr(args, "encoding", "work") == "paper":
        raise InputError(f"{name}: with --encoding paper it can only be same(T,U) or not same(T,U)")
    if told.assumed and getattr(args, "by", "auto") == "search":
        raise InputError(f"{name}: with --by search it can only be same(T,U) or not same(T,U)")
    return told


def parts_of(args: argparse.Namespace, of: Iterable[str] = PARTS) -> dict[str, bool]:
    """List the parts that are asked for.

    Raises:
        InputError: The encoding does not state one of them.
    """
    parts = {part: True for part in of if getattr(args, part, False)}
    if getattr(args, "encoding", None) == "paper" and (others := unstated(parts.keys())):
        name = f"--{others[0].replace('_', '-')}"
        raise InputError(f"topomap {args.command}: --encoding paper has no rules for {name}")
    return parts


def asked_query(args: argparse.Namespace, of: Iterable[str] = PARTS) -> "Query":
    """Make the query that asks for these parts, within the bound and the horizon of the call."""
    from topomap.api.parts import query_of

    return query_of(
        parts_of(args, of),
        bound=args.bound,
        horizon=getattr(args, "horizon", None),
        encoding=getattr(args, "encoding", "work"),
        noise=getattr(args, "noise", None),
    )


def crew_of(args: argparse.Namespace) -> "Crew":
    """Make the crew that shares the work: processes, or the workers of a Dask cluster."""
    from topomap.solver.crews import crew

    shared = (args.jobs or 1) > 1 or args.dask
    some = any(getattr(args, name, False) for name in ("optimal", "circumscribe"))
    if shared and args.command == "solve" and (some or OPTIMIZING & set(parts_of(args))):
        raise InputError("topomap solve: --jobs and --dask are for all maps, not the best ones")
    return crew(args.jobs or 1, args.dask)


def run_of(args: argparse.Namespace, *experiences: "Experience") -> dict[str, Any]:
    """Describe what a run that writes to a file computes; its journal resumes only this run."""
    if args.output is None:
        return {}
    from topomap.solver.solving import digest

    keys = ("by", "encoding", *PARTS, "optimal", "circumscribe", "bound", "horizon")
    asked = {key: getattr(args, key, None) for key in keys}
    return {"command": args.command, **asked, "facts and encodings": digest(*experiences)}


def senses_of(args: argparse.Namespace) -> "Senses":
    """Collect what a robot measures besides views."""
    from topomap.worlds.senses import Senses

    measured = getattr(args, "drift", None), getattr(args, "stretch", None)
    return Senses(args.compass, args.odometry, args.lengths, args.seed or 0, *measured)


def environment_of(args: argparse.Namespace) -> "Environment":
    """Make the environment that a call of ``generate`` or ``simulate`` names."""
    from topomap.worlds import environment

    if args.kind in ("world", "network"):
        from topomap.worlds import files
        from topomap.worlds.plan import Reading

        degrees = True if args.degrees else False if args.plane else None
        loops = args.loops or getattr(args, "no_path_axiom", False)
        reading = Reading(args.along, degrees, loops, args.names, args.radius)
        how = args.slots, args.north, args.straight, args.two_way
        loaded = files.load(args.file, reading, *how)
        for warning in loaded.warnings:
            say(f"warning: {warning}")
        if loaded.chosen:
            say(loaded.chosen)
        return loaded.environment
    thinned: dict[str, Any] = (
        {"thin": args.thin, "seed": args.seed or 0} if args.kind == "maze" else {}
    )
    return environment.environment(args.kind, args.rows, args.columns, **thinned)
