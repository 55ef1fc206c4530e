"""Worlds that are read from files, and written to files."""

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
    """Read the world in a file, such as a street network, for ``generate`` and ``simulate``.

    Parameters:
        path: A file of one of the formats that ``docs/files.md`` lists.
        slots: The number of directions at a place, an even number; by default the smallest at which
            no two exits of a place share a slot.
        north: Where slot 0 points, in degrees clockwise of north; by default the direction that
            leaves the widest margin before two exits of a place share a slot.
        straight: The largest number of degrees by which two exits of a place may be off from being
            opposite if they are on one path; each must be the one most nearly opposite to the
            other. By default the exits in opposite slots are on one path.
        along: How far along a bent way the point is that gives its direction at its end, in metres
            or in the units of the file.
        degrees: Whether coordinates are longitude and latitude; by default the file tells.
        two_way: Whether one-way ways are taken as two-way.
        loops: Whether ways back to their own place are kept.
        names: Whether the name of a place in the file is its landmark.
        radius: In a floor plan, the largest distance between junctions that are taken as one place,
            in metres.

    Returns:
        The world, an environment with its ``map``, and ``notes`` on how it was read. (The map is
        that of the paper, section II.)

    Raises:
        TypeError: ``path`` is not the path of a file.
        ValueError: A number is out of its range.
        InputError: The file cannot be read, has one-way ways, or no number of slots separates its
            exits. The message is one line.
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
    """Write a world to a file, from which ``world`` reads it back as it was.

    The file has positions, slots, landmarks and the names of places.

    Parameters:
        world: An environment, as ``world`` gives it and ``generate`` takes it.
        path: The file. Its name ends in ``.graphml``, ``.json`` (node-link) or ``.yaml`` (tmap2).

    Raises:
        TypeError: ``world`` is not a world, or ``path`` is not the path of a file.
        InputError: The name has another ending, the format cannot hold the name of a place, or the
            file cannot be written. The message is one line.
    """
    if not isinstance(world, Environment):
        raise TypeError(f"world must be what topomap.world gives, not {type(world).__name__}")
    path = path_of(path)
    text = world_text(world, form_of(path))
    with output(str(path)) as file:
        file.write(text)
