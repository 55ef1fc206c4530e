"""The subcommand ``simulate``: one robot, or a table of several."""

import argparse
import contextlib
import json
from collections.abc import Iterator
from typing import Any

from topomap.commands import environment_of
from topomap.model.query import Query
from topomap.model.topology import Gateway, TopologicalMap, label
from topomap.model.vocabulary import PARTS
from topomap.model.words import number
from topomap.questions.robot import ENDED, MOST_MAPS, Outcome, reached
from topomap.questions.robot import simulate as explored
from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import output
from topomap.runtime.limits import MOST_STEPS
from topomap.runtime.status import exit_status
from topomap.runtime.watch import Watch, heeding
from topomap.worlds.environment import Environment
from topomap.worlds.family import expand

STEPS = 20  # for each way
ENDS = {
    "settled": "one closed map is optimal",
    "bisimilar": "no walk can tell the optimal maps apart",
    "no map": "no map is left that has what was asked for",
    "steps": "as many steps as it may walk; partial: steps",
}


def simulate(args: argparse.Namespace) -> int:
    """Let a robot explore, or one after the other."""
    if args.kind == "list":
        return _list(args)
    environment, world, start = _world(args)
    with contextlib.ExitStack() as files:
        out = files.enter_context(output(args.output))
        instance = args.instance and files.enter_context(output(args.instance))
        with heeding(args.timeout) as watch:
            watch.title(environment.name)
            outcome = _explored(args, world, start, watch)
        if instance:
            instance.write(f"% what a robot did and saw in {environment.name}\n\n")
            instance.write(outcome.experience.facts())
        fault = None if outcome.end in ENDED else outcome.end
        if args.json:
            out.write(formats.line({"environment": environment.name, **outcome.json()}, fault))
        else:
            out.write(_text(environment, outcome, fault))
    return exit_status(fault, outcome.end == "settled" and bool(outcome.truth))


def _world(args: argparse.Namespace) -> tuple[Environment, TopologicalMap, Gateway]:
    """The environment of a call, what can be walked to in it, and where the robot begins.
    Raises InputError where it cannot be mapped."""
    environment = environment_of(args)
    if args.signs:
        environment = environment.signed(args.signs, args.seed or 0)
    stars = environment.map.stars
    place = environment.place(args.start) if args.start is not None else min(stars)
    slot = min(stars[place]) if args.facing is None else args.facing
    if slot not in stars[place]:
        raise InputError(f"{environment.name}: place {label(place)} has no gateway {slot}")
    try:
        return environment, reached(environment.map, place), (place, slot)
    except InputError as error:
        raise InputError(f"{environment.name}: {error}") from None


def _explored(
    args: argparse.Namespace, world: TopologicalMap, start: Gateway, watch: Watch
) -> Outcome:
    parts = frozenset(part for part in PARTS if getattr(args, part, False))
    most = min(STEPS * len(world.links) // 2, MOST_STEPS) if args.steps is None else args.steps
    return explored(world, start, Query(parts, args.bound), watch, most, args.marker)


def _end(outcome: Outcome) -> str:
    """How it ended, in words."""
    if outcome.end == "bisimilar" and len(outcome.maps) == MOST_MAPS:
        return f"no walk can tell {MOST_MAPS} of the optimal maps apart"
    return ENDS.get(outcome.end, f"partial: {outcome.end}")


def _text(environment: Environment, outcome: Outcome, fault: str | None) -> str:
    world = outcome.world
    ways = len(world.links) // 2
    lines = [
        f"{environment.name}: {number(len(world.stars), 'place')}, {number(ways, 'way')}, "
        f"{number(len(world.landmarks), 'sign')}",
        f"{number(outcome.steps, 'step')} walked: " + _end(outcome),
    ]
    if not world.boundaries_consistent():
        lines.append("the truth has inconsistent boundaries, and so is never optimal")
    so_far = " so far" * bool(fault)
    if outcome.maps and outcome.truth is None:
        many = number(len(outcome.maps), "best map")
        or_more = " or more" * (len(outcome.maps) == MOST_MAPS)
        lines.append(f"{many}{or_more}{so_far}; what the truth is, is open")
    elif len(outcome.maps) == 1:
        lines.append(f"the best map{so_far} is {'' if outcome.truth else 'not '}the truth")
    elif outcome.maps:
        is_there = "" if outcome.truth else "not "
        lines.append(f"{len(outcome.maps)} best maps{so_far}, the truth is {is_there}among them")
    lines.append(f"a tour over every way, by one who knows the map: {number(outcome.tour, 'step')}")
    walked = "not within reach" if outcome.random is None else number(outcome.random, "step")
    lines.append(f"a random walk over every way (median): {walked}")
    return "".join(line + "\n" for line in lines)


HEAD = "environment", "places", "ways", "signs", "steps", "tour", "random", "maps", "truth"


def _list(args: argparse.Namespace) -> int:
    """One robot for each line of a file, and what came of them in a table."""
    calls = list(_calls(args))
    rows: list[dict[str, Any]] = []
    fault = None
    with output(args.output) as out:
        with heeding(args.timeout) as watch:
            for call, parsed in calls:
                watch.title(call)
                _, world, start = _world(parsed)
                outcome = _explored(parsed, world, start, watch)
                if outcome.end not in ENDS:
                    fault = outcome.end
                    break
                rows.append({"environment": call, **outcome.json()})
        if any(row["end"] not in ENDED for row in rows):
            fault = fault or "steps"
        if args.json:
            json.dump(formats.answer({"rows": rows}, fault), out, indent=1)
            out.write("\n")
        else:
            out.write(table(rows))
            if fault:
                out.write(f"partial: {fault}; {len(rows)} of {len(calls)} lines\n")
    return exit_status(fault, all(row["truth"] for row in rows))


def _calls(args: argparse.Namespace) -> Iterator[tuple[str, argparse.Namespace]]:
    """The lines of the file, parsed. Raises InputError naming the line that is no call, or of a
    world that cannot be mapped."""
    for line, call in expand(args.file):
        try:
            with contextlib.redirect_stdout(None):
                parsed = args.parse(["simulate", *call])
            if parsed.kind == "list" or parsed.output or parsed.instance or parsed.json:
                raise InputError("list, -o, --instance and --json have no place in a list")
            _world(parsed)
        except SystemExit:
            raise InputError(f"{args.file}:{line}: --help has no place in a list") from None
        except InputError as error:
            raise InputError(f"{args.file}:{line}: {error}") from None
        yield " ".join(call), parsed


def table(rows: list[dict[str, Any]]) -> str:
    """What came of the robots, a line each; then of how many the truth."""
    lines: list[tuple[str, ...]] = [HEAD]
    for row in rows:
        maps = row["best_maps"]
        truth = {True: "yes", False: "no", None: "open"}[row["truth"]]
        truth = f"one of {maps}" if row["truth"] and maps > 1 else truth
        cells = {**row, "maps": maps, "truth": truth, "random": row["random"] or "-"}
        lines.append(tuple(str(cells[key]) for key in HEAD))
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = "".join(
        line[0].ljust(widths[0])
        + "".join(f"  {cell:>{width}}" for cell, width in zip(line[1:], widths[1:], strict=True))
        + "\n"
        for line in lines
    )
    settled = [row for row in rows if row["end"] == "settled"]
    true = sum(bool(row["truth"]) for row in settled)
    return (
        text + f"{number(len(settled), 'robot')} of {len(rows)} with one closed map, {true} true\n"
    )
