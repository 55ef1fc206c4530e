"""Worlds from files, and back."""

from pathlib import Path

from topomap.api.parts import path_of
from topomap.exchange.worlds import form_of, world_text
from topomap.runtime.checks import flag, number_if_given, whole_if_given
from topomap.runtime.files import output
from topomap.worlds import files
from topomap.worlds.environment import Environment
from topomap.worlds.plan import Reading


def world(
    path: str | Path,
    *,
    slots: int | None = None,
    north: float | None = None,
    straight: float | None = None,
    along: float = Reading.along,
    degrees: bool | None = None,
    two_way: bool = False,
    loops: bool = False,
    names: bool = False,
    radius: float | None = None,
) -> Environment:
    """The world in a file, such as a street network, to be given to ``generate`` or ``simulate``.

    Parameters:
        path: a file of one of the formats that docs/files.md lists.
        slots: how many directions there are at a place, an even number; by default the fewest at
            which no two exits of a place share one.
        north: where slot 0 points, in degrees clockwise of north; by default as may be off the most
            before two exits of a place share a slot.
        straight: two exits of a place are on one path if each is the one most nearly opposite to
            the other, and they are off by at most so many degrees; by default opposite slots are.
        along: the direction of a bent way at its end is that of the point so far along it, in
            metres or in the units of the file.
        degrees: whether coordinates are longitude and latitude; by default as the file tells.
        two_way: whether ways that can be gone one way only are taken as two-way.
        loops: whether ways back to their own place are kept.
        names: whether the name of a place in the file is its landmark.
        radius: of a picture of a floor: how far apart junctions are at most that are one place.

    Returns:
        The world: an environment with its ``map``, and ``notes`` on how it was read.

    Raises:
        TypeError, ValueError: something else than a path, or a number that cannot be.
        InputError: the file cannot be read, has one-way ways, or no slots part its ways; one line.
    """
    if degrees is not None:
        degrees = flag("degrees", degrees)
    reading = Reading(
        number_if_given("along", along, 0) or 0.0,
        degrees,
        flag("loops", loops),
        flag("names", names),
        number_if_given("radius", radius, 0),
    )
    return files.load(
        path_of(path),
        reading,
        whole_if_given("slots", slots, 2),
        number_if_given("north", north),
        number_if_given("straight", straight, 0),
        flag("two_way", two_way),
    ).environment


def write_world(world: Environment, path: str | Path) -> None:
    """Write a world to a file, with positions, slots, landmarks and the names of places; ``world``
    reads it back as it was.

    Parameters:
        world: what ``world`` or ``generate`` takes.
        path: the file; its name ends in ``.graphml``, ``.json`` (node-link) or ``.yaml`` (tmap2).

    Raises:
        TypeError: something else than a world or a path.
        InputError: another end of the name, a name of a place that the format cannot hold, or a
            file that cannot be written; one line.
    """
    if not isinstance(world, Environment):
        raise TypeError(f"world must be what topomap.world gives, not {type(world).__name__}")
    path = path_of(path)
    text = world_text(world, form_of(path))
    with output(str(path)) as file:
        file.write(text)
