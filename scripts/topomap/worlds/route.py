"""Explorations of a world, as the absolute slots by which places are left."""

import itertools
import random
import re
from collections.abc import Iterator

from topomap.model.topology import Place, TopologicalMap, label
from topomap.runtime.errors import InputError
from topomap.worlds.environment import EAST, NORTH, SOUTH, WEST, Environment

COMPASS = {
    4: ["N", "E", "S", "W"],
    8: ["N", "NE", "E", "SE", "S", "SW", "W", "NW"],
}


def snake(environment: Environment) -> list[int]:
    """The paper's exploration (section IV).

    It walks along the rows from the north-west corner, in alternate directions, and then along the
    columns from where the last row ends.
    """
    if environment.shape is None:
        raise InputError(f"{environment.name}: a snake needs rows and columns")
    rows, columns = environment.shape
    route = _sweep(rows, columns, EAST, WEST, SOUTH)
    if rows % 2:
        return route + _sweep(columns, rows, NORTH, SOUTH, WEST)
    return route + _sweep(columns, rows, NORTH, SOUTH, EAST)


def _sweep(lanes: int, length: int, first: int, second: int, across: int) -> list[int]:
    route = []
    for lane in range(lanes):
        route += [second if lane % 2 else first] * (length - 1)
        route += [across] * (lane < lanes - 1)
    return route


def letters(text: str, slots: int) -> list[int]:
    """Read the slots of a route, given as compass letters (4 or 8 slots) or as numbers.

    Words are separated by commas. A word that is not a direction is read letter by letter.
    """
    words = [word.strip() for word in text.split(",")]
    if all(re.fullmatch("[0-9]{1,9}", word) for word in words):
        return [int(word) for word in words]
    shown = text if len(text) <= 40 else text[:37] + "..."
    names = COMPASS.get(slots)
    if names is None:
        raise InputError(
            f"route {shown!r}: with {slots} slots a route is numbers separated by commas "
            "(compass letters need 4 or 8)"
        )
    route: list[int] = []
    for word in words:
        for direction in [word] if word in names or not word else word:
            if direction not in names:
                raise InputError(
                    f"route {shown!r}: step {len(route) + 1}: {direction!r} is not one of "
                    + " ".join(names)
                )
            route.append(names.index(direction))
    return route


def walk(world: TopologicalMap, start: Place, seed: int) -> Iterator[int]:
    """An endless random walk, which takes any way at each place, also the way back."""
    generator = random.Random(seed)
    place = start
    while True:
        slot = generator.choice(sorted(world.stars[place]))
        yield slot
        place = world.links[place, slot][0]


def checked(
    world: TopologicalMap, start: Place, route: Iterator[int] | list[int], steps: int | None
) -> list[int]:
    """The first ``steps`` slots of a route (by default all), each of which must be a way.

    Raises:
        InputError: A step is not a way; the message names it.
    """
    place = start
    checked = []
    for step, slot in enumerate(itertools.islice(route, steps), 1):
        if (place, slot) not in world.links:
            names = COMPASS.get(world.slots)
            direction = names[slot] if names and 0 <= slot < len(names) else f"slot {slot}"
            raise InputError(f"route: step {step}: no way {direction} from place {label(place)}")
        checked.append(slot)
        place = world.links[place, slot][0]
    if steps is not None and len(checked) < steps:
        raise InputError(f"route: it ends after {len(checked)} steps, {steps} were asked for")
    return checked
