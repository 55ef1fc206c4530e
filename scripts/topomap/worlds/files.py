"""Worlds from files of each format that ``readers`` knows."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from topomap.model.topology import Gateway, label
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.worlds import readers
from topomap.worlds.courses import Layout, layout, world_of
from topomap.worlds.environment import Environment, plain
from topomap.worlds.plan import Plan, Reading, Way
from topomap.worlds.senses import Move

NAMED = 5  # the largest number of ways in a message
NARROW = 3.0  # degrees: if slots may be turned by less, there is a warning


class Loaded(NamedTuple):
    """A world from a file, the warnings about it, the plan in the file, and the slots.

    ``chosen`` says which slots were chosen, if they were.
    """

    environment: Environment
    warnings: list[str]
    plan: Plan
    layout: Layout
    chosen: str | None


def load(
    file: str | Path,
    reading: Reading | None = None,
    slots: int | None = None,
    north: float | None = None,
    straight: float | None = None,
    two_way: bool = False,
) -> Loaded:
    """Load the world in a file.

    Parameters:
        file: A file of one of the formats that ``readers`` knows.
        reading: How it is to be read.
        slots: The number of slots; None for the smallest at which no two exits of a place share
            one.
        north: Where slot 0 points, in degrees clockwise of north; None for the best turn.
        straight: By how many degrees two exits of a place on one path may be off from being
            opposite. If it is None, those in opposite slots are on one path.
        two_way: Whether one-way ways are taken as two-way.

    Returns:
        The world.

    Raises:
        InputError: The file cannot be read. One line.
    """
    reading = reading or Reading()
    plan = readers.read(file, reading)
    alone = [way for way in plan.ways if way.one_way]
    if alone and not two_way:
        raise InputError(
            f"{file}: {len(alone)} of {len(plan.ways)} ways can be gone one way only "
            f"({_named(alone)}); --two-way takes them as two-way"
        )
    told = [*plan.told]
    if alone:
        told.append(f"{file}: one-way ways taken as two-way: {len(alone)}")
    try:
        at = layout(str(file), plan, slots, north)
    except InputError as error:
        if not plan.guessed:
            raise
        raise InputError(f"{error} ({plan.guessed})") from None
    if slots is None and at.margin < NARROW:
        told.append(
            f"{file}: exits are separated by only {at.margin:.2g} degrees; --slots says how many "
            "slots there are, and --straight which exits are on one path"
        )
    world = world_of(plan, at, straight)
    graph = nx.Graph((one[0], other[0]) for one, other in world.links.items())
    if (parts := nx.number_connected_components(graph)) > 1:
        told.append(f"{file}: not connected; an exploration stays in its part, of: {parts}")
    call = ["world", Path(file).name, "--slots", str(at.slots), "--north", plain(at.north)]
    call += [] if straight is None else ["--straight", plain(straight)]
    call += _options(reading) + ["--two-way"] * bool(alone)
    notes = (f"slot 0 at {plain(at.north)} degrees clockwise of north", *plan.notes)
    made = Environment(
        plan.name,
        tuple(call),
        world,
        None,
        notes,
        _moves(plan, at),
        plan.points,
        plan.names,
        at.north,
    )
    kept = plan.slots and slots is None  # the slots are those of the file
    asked = slots is not None and north is not None
    chosen = None if kept or asked else f"{file}: {_chosen(at)}"
    return Loaded(made, told, plan, at, chosen)


def _options(reading: Reading) -> list[str]:
    """The options of a call with which a file is read in this way."""
    usual = Reading()
    call = [] if reading.along == usual.along else ["--along", plain(reading.along)]
    call += {None: [], True: ["--degrees"], False: ["--plane"]}[reading.degrees]
    call += ["--loops"] * reading.loops + ["--names"] * reading.landmarks
    return call + ([] if reading.radius is None else ["--radius", plain(reading.radius)])


def _named(ways: Iterable[Way]) -> str:
    """Name some ways by their ends."""
    names = [" to ".join(label(end.place) for end in way.ends) for way in ways]
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" * (len(names) > NAMED))


def _chosen(at: Layout) -> str:
    turned = f"slot 0 at {at.north:.6g} degrees clockwise of north"
    free = f"they may be turned by {at.margin:.3g} degrees either way before two exits share one"
    if math.isinf(at.margin):
        free = "no two exits share one, however they are turned"
    return f"{at.slots} slots chosen, {turned}; {free}"


def _moves(plan: Plan, at: Layout) -> dict[Gateway, Move]:
    """The moves of the ways, if the file tells them."""
    moves: dict[Gateway, Move] = {}
    for way in plan.ways:
        if way.move is None:
            continue
        (east, north), ends = way.move, way.ends
        for (place, bearing), sign in zip(ends, (1, -1), strict=True):
            moves[place, at.slot(bearing)] = (sign * east, sign * north)
    return {out: move for out, move in moves.items() if all(map(math.isfinite, move))}
