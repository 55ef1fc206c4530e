"""A robot that explores a world which it does not know."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import Parts, query_of, senses_of, world_of
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.model.reply import Reply
from topomap.model.vocabulary import CHOSEN
from topomap.questions.robot import Outcome, start_of
from topomap.questions.robot import simulate as explored
from topomap.runtime.checks import flag, seconds, share, whole, whole_if_given
from topomap.runtime.limits import MOST_STEPS
from topomap.runtime.watch import Watch
from topomap.worlds.environment import Environment
from topomap.worlds.instance import NOTHING
from topomap.worlds.senses import Senses

STEPS = 20  # for each way


@dataclass(frozen=True, repr=False)
class Simulation(Reply):
    """What came of a robot in the environment of that name. It is ``complete`` if the robot came to
    an end, so that more walking would tell it nothing, and the walks for comparison did, too."""

    name: str
    outcome: Outcome

    @property
    def experience(self) -> Experience:
        """What the robot did and saw."""
        return self.outcome.experience

    @cached_property
    def maps(self) -> list[Map]:
        """The best maps of that, in order."""
        found, whole = self.outcome.maps, self.outcome.whole
        return [
            Map(self.experience, one, number, len(found), whole, name=self.name)
            for number, one in enumerate(found, 1)
        ]

    @property
    def end(self) -> str:
        """How it ended: "settled" (one closed map is optimal), "bisimilar" (several, which no
        walk tells apart), "no map", "steps" (as many as it may walk), or why it was cut."""
        return self.outcome.end

    @property
    def truth(self) -> bool | None:
        """Whether the real map is among the maps; None if that is open, as the robot could go no
        further."""
        return self.outcome.truth

    @property
    def steps(self) -> int:
        """How many steps it walked."""
        return self.outcome.steps

    @property
    def tour(self) -> int | None:
        """How many steps a tour over every way takes, by one who knows the map; None if the
        world is too large for that, or it was cut."""
        return self.outcome.tour

    @property
    def random(self) -> int | None:
        """How many steps random walks take until they have gone every way: the median; None if
        most are too long to be walked to the end, or it was cut."""
        return self.outcome.random

    @property
    def fault(self) -> str | None:
        """Why the robot did not come to an end, or why ``tour`` or ``random`` is missing; None if
        neither is so."""
        return self.outcome.fault

    def document(self) -> dict[str, Any]:
        return {"environment": self.name, **self.outcome.document()}

    def lines(self) -> Iterator[str]:
        return self.outcome.lines(self.name)


def simulate(
    world: str | Environment,
    *size: int,
    start: str | None = None,
    facing: int | None = None,
    signs: float = 0.0,
    seed: int = 0,
    thin: float = 0.3,
    steps: int | None = None,
    marker: bool = False,
    bound: int | None = None,
    timeout: float | None = None,
    compass: bool = False,
    odometry: float | None = None,
    lengths: bool = False,
    drift: int | None = None,
    stretch: int | None = None,
    **parts: Unpack[Parts],
) -> Simulation:
    """Let a robot explore a world until it has one closed optimal map, or no walk can tell its
    best maps apart; then hold these against the truth (the paper, section IV).

    Parameters:
        world: ``grid``, ``torus``, ``cylinder``, ``crescents``, ``maze``, ``hexagons`` or
            ``triangles``, with ``size``, its rows and columns; or an environment that was made
            before.
        start: the first place, such as ``0,2``; the smallest by default.
        facing: the gateway stood at first, a slot; the smallest by default.
        signs: the share of places, 0 to 1, that carry their own name as a landmark.
        seed: for signs and maze.
        thin: the share of the ways of a maze, 0 to 1, that are taken away.
        steps: walk so many at most, 100,000 or fewer; 20 for each way by default.
        marker: whether the robot carries a marker that it may put down.
        bound: what it takes for granted: so many places at most.
        timeout: stop after so many seconds, the walks for comparison too.
        compass: whether it has a compass, as in ``generate``.
        odometry: whether and how well it measures where steps lead, as in ``generate``.
        lengths: whether it measures how long steps are, as in ``generate``.
        drift: how far it takes its shifts to be wrong, in percent of the way; 10 by default, or
            as much as ``odometry``.
        stretch: how far it takes lengths of one way to differ, in percent; 10 by default.
        parts: what it takes for granted: ``planar``, ``perpendicular``; and ``no_path_axiom``, that
            a path may hold a place twice, and may be circular.

    Returns:
        What came of it: ``end``, ``maps``, ``truth``, ``experience``, ``steps``, and for
        comparison ``tour`` and ``random``. Where something was cut, ``fault`` says why.

    Raises:
        TypeError: something else than a world.
        ValueError: an unknown world or part, no rows and columns, or a number that cannot be.
        InputError: a world that is too large (more than 100,000 places); no such place or
            gateway.
    """
    query = query_of(parts, bound=bound, allowed=CHOSEN)
    thin, signs, seed = share("thin", thin), share("signs", signs), whole("seed", seed, 0)
    steps, facing = (
        whole_if_given("steps", steps, 0, MOST_STEPS),
        whole_if_given("facing", facing, 0),
    )
    marker, watch = flag("marker", marker), Watch(seconds("timeout", timeout))
    world = world_of(world, size, thin, seed)
    if signs:
        world = world.signed(signs, seed)
    senses = senses_of(compass, odometry, lengths, seed)
    percents = whole_if_given("drift", drift, 0), whole_if_given("stretch", stretch, 0)
    senses = replace(senses, drift=percents[0], stretch=percents[1])
    return simulate_under(watch, world, query, start, facing, steps, marker, senses)


def simulate_under(
    watch: Watch,
    world: Environment,
    query: Query,
    start: str | None,
    facing: int | None,
    steps: int | None,
    marker: bool,
    senses: Senses = NOTHING,
) -> Simulation:
    """The same in an environment that was made, under the watch of a command."""
    there, dstate = start_of(world, start, facing)
    most = min(STEPS * len(there.map.links) // 2, MOST_STEPS) if steps is None else steps
    return Simulation(world.name, explored(there, dstate, query, watch, most, marker, senses))
