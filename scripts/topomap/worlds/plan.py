"""Plans: what a file tells of a world, places and the ways between them with their directions.
``courses`` makes a world of a plan, and chooses the slots.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from topomap.model.topology import Place

Point = tuple[float, float]  # east and north, in metres or in a unit of the file's own


class Exit(NamedTuple):
    """Where a way leaves a place, and in which direction: degrees clockwise of north."""

    place: Place
    bearing: float


class Way(NamedTuple):
    """A way between two places, or from a place back to itself.

    ``ends`` are its two exits; ``move`` is how far it leads from the first place to the second,
    east and north, and ``length`` how long it is, both None if the file does not tell. ``one_way``
    says that it can be gone from the first place to the second only.
    """

    ends: tuple[Exit, Exit]
    move: Point | None = None
    length: float | None = None
    one_way: bool = False


@dataclass(frozen=True)
class Plan:
    """What a file tells of a world.

    ``points`` holds where places are, as far as that is told; ``landmarks`` what is recognised at a
    place, as terms of clingo; ``names`` what a place is called, if that is not its own name.
    ``slots`` is the number of directions that the file knows, all ways leading in one of them, slot
    0 in the direction ``north``, in degrees clockwise of north; None if bearings may be any.
    ``straight`` holds the pairs of exits of a place that are on one path; None if opposite ones
    are. ``notes`` go into the header of an instance, and ``told`` are warnings, each one line that
    names the file; ``guessed`` says what the coordinates were taken for, if the file does not tell.
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

    ``along`` says how far along a bent way the point is to which its bearing at an end is taken, in
    metres or units; ``degrees`` whether coordinates are longitude and latitude, None if the file is
    to tell; ``loops`` whether ways back to their own place are kept; ``landmarks`` whether the
    names of places are their landmarks; ``radius`` within which junctions of a raster are one, in
    metres, None for a guess by the width of the corridors.
    """

    along: float = 10.0
    degrees: bool | None = None
    loops: bool = False
    landmarks: bool = False
    radius: float | None = None
