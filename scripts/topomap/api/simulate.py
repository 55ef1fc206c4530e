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

STEPS = 20  # the default number of steps for each way


@dataclass(frozen=True, repr=False)
class Simulation(Reply):
    """The result of a robot in an environment.

    It is ``complete`` if the robot came to an end, so that more walking would tell it nothing, and
    if the walks for comparison came to an end, too.
    """

    name: str
    outcome: Outcome

    @property
    def experience(self) -> Experience:
        """What the robot did and saw."""
        return self.outcome.experience

    @cached_property
    def maps(self) -> list[Map]:
        """The best maps of the experience, in order."""
        found, whole = self.outcome.maps, self.outcome.whole
        return [
            Map(self.experience, one, number, len(found), whole, name=self.name)
            for number, one in enumerate(found, 1)
        ]

    @property
    def end(self) -> str:
        """How the exploration ended.

        It is "settled" if one closed map is optimal, "bisimilar" if there are several that no walk
        tells apart, "no map", "steps" if the robot walked as many steps as it may, or the reason
        why it was cut short.
        """
        return self.outcome.end

    @property
    def truth(self) -> bool | None:
        """Whether the real map is among the maps; None if that is open.

        It is open where the robot could go no further.
        """
        return self.outcome.truth

    @property
    def steps(self) -> int:
        """How many steps the robot walked."""
        return self.outcome.steps

    @property
    def tour(self) -> int | None:
        """How many steps a tour over every way takes an agent that knows the map.

        It is None if the world is too large for that, or if the computation was cut short.
        """
        return self.outcome.tour

    @property
    def random(self) -> int | None:
        """The median number of steps that random walks take to travel along every way.

        It is None if most of them are too long to be walked to the end, or if the computation was
        cut short.
        """
        return self.outcome.random

    @property
    def fault(self) -> str | None:
        """Why the simulation is not whole; None if it is.

        The robot did not come to an end, or ``tour`` or ``random`` is missing.
        """
        return self.outcome.fault

    def document(self) -> dict[str, Any]:
        """The simulation as ``topomap simulate --json`` writes it."""
        return {"environment": self.name, **self.outcome.document()}

    def lines(self) -> Iterator[str]:
        """The simulation as the lines that ``topomap simulate`` prints."""
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
    """Let a robot explore a world that it does not know (the paper, section IV, has such worlds).

    It explores until it has one closed optimal map, or until no walk can tell its best maps apart.
    Then these maps are compared with the real one.

    Parameters:
        world: ``grid``, ``torus``, ``cylinder``, ``crescents``, ``maze``, ``hexagons`` or
            ``triangles``; or an environment that was made before.
        size: The rows and the columns of a world that is named.
        start: The first place, such as ``0,2``; the smallest by default.
        facing: The slot of the gateway where the robot stands at first; the smallest by default.
        signs: The share of the places, from 0 to 1, that have their own name as a landmark.
        seed: The seed of what is random: signs, mazes and the errors of the odometry.
        thin: The share of the ways of a maze, from 0 to 1, that are removed.
        steps: The largest number of steps that the robot walks, 100,000 at most; by default 20 for
            each way.
        marker: Whether the robot carries a marker, which it may put down.
        bound: The largest number of places, which the robot takes for granted.
        timeout: The number of seconds after which the work stops; the walks for comparison are
            included.
        compass: Whether the robot notes the compass slot of the gateway where it stands, as for
            ``generate``.
        odometry: If given, the robot notes how far each step led, with errors of at most so many
            percent of the way, as for ``generate``.
        lengths: Whether the robot notes the length of each step, as for ``generate``.
        drift: By how many percent of the way the robot takes its shifts to be wrong; by default 10,
            or as many as ``odometry``.
        stretch: By how many percent the robot takes its lengths of one way to differ; 10 by
            default.
        parts: What the robot takes for granted: ``planar``, ``perpendicular``; and
            ``no_path_axiom``, by which a path may contain a place twice, and may be circular.

    Returns:
        The result, with ``end``, ``maps``, ``truth``, ``experience``, ``steps``, and for
        comparison ``tour`` and ``random``. If something was cut short, ``fault`` says why.

    Raises:
        TypeError: ``world`` is neither a name nor an environment.
        ValueError: The world or a part is not known, rows and columns are missing, or a number is
            out of its range.
        InputError: The world has more than 100,000 places, or there is no such place or gateway.
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
    """Simulate a robot in an environment under the watch of a command."""
    there, dstate = start_of(world, start, facing)
    most = min(STEPS * len(there.map.links) // 2, MOST_STEPS) if steps is None else steps
    return Simulation(world.name, explored(there, dstate, query, watch, most, marker, senses))
