"""Plans: what a file says about a world, as places and the ways between them, with directions.

``courses`` makes a world of a plan, and chooses the slots.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from topomap.model.topology import Place

Point = tuple[float, float]  # east and north, in metres or in the unit of the file


class Exit(NamedTuple):
    """Where a way leaves a place, and in which direction, in degrees clockwise of north."""

    place: Place
    bearing: float


class Way(NamedTuple):
    """A way between two places, or from a place back to itself.

    ``ends`` are its two exits. ``move`` is how far it leads from the first place to the second,
    east and north, and ``length`` is how long it is; both are None if the file does not tell.
    ``one_way`` says that it can be gone only from the first place to the second.
    """

    ends: tuple[Exit, Exit]
    move: Point | None = None
    length: float | None = None
    one_way: bool = False


@dataclass(frozen=True)
class Plan:
    """What a file says about a world.

    ``points`` tells where places are, as far as that is known. ``landmarks`` has what is recognised
    at a place, as terms of clingo. ``names`` tells how a place is called, if that is not its own
    name. ``slots`` is the number of directions in the file, if all ways lead in one of them, and
    slot 0 has the direction ``north``, in degrees clockwise of north; it is None if bearings may be
    any. ``straight`` has the pairs of exits of a place that are on one path; it is None if opposite
    ones are. ``notes`` go into the header of an instance. ``told`` has warnings of one line each,
    which name the file. ``guessed`` tells what the coordinates were taken for, if the file does not
    say it.
    """

    name: str
    ways: tuple[Way, ...]
    points: Mapping[Place, Point] = field(default_factory=dict)
    landmarks: Mapping[Place, frozenset[str]] = field(default_factory=dict)
    names: Mapping[Place, str] = field(default_factory=dict)
    slots: int | None = None
    north: float = 0.0
    straight: tuple[tuple[Exit, Exit], ...] | None = None
    notes: tuple[str, ...] = ()
    told: tuple[str, ...] = ()
    guessed: str = ""


@dataclass(frozen=True)
class Reading:
    """How a file is to be read.

    ``along`` is how far along a bent way the point is that gives its bearing at an end, in metres
    or units. ``degrees`` tells whether coordinates are longitude and latitude; None if the file
    tells it. ``loops`` tells whether ways back to their own place are kept, and ``landmarks``
    whether the names of places are their landmarks. ``radius`` is the distance within which
    junctions of a raster are one place, in metres; None if it is estimated from the width of the
    corridors.
    """

    along: float = 10.0
    degrees: bool | None = None
    loops: bool = False
    landmarks: bool = False
    radius: float | None = None
