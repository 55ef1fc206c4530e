"""Making instances by exploring worlds."""

from topomap.api.parts import demand_text, senses_of, world_of
from topomap.runtime.checks import share, whole_if_given
from topomap.runtime.limits import MOST_STEPS
from topomap.worlds.environment import Environment
from topomap.worlds.instance import Instance, instance


def generate(
    world: str | Environment,
    *size: int,
    route: str,
    steps: int | None = None,
    start: str | None = None,
    facing: int | None = None,
    signs: float = 0.0,
    seed: int | None = None,
    thin: float = 0.3,
    name: str | None = None,
    compass: bool = False,
    odometry: float | None = None,
    lengths: bool = False,
) -> Instance:
    """Explore a world, and note what the agent sees (the paper, section IV).

    Parameters:
        world: ``grid``, ``torus``, ``cylinder``, ``crescents``, ``maze``, ``hexagons`` or
            ``triangles``; or an environment that was made before.
        size: The rows and the columns of a world that is named.
        route: ``snake``, ``walk`` (random), ``tour`` (over every way), compass letters such as
            ``ESSENN``, or absolute slots such as ``0,3,1``.
        steps: The number of steps after which the route is cut, 100,000 at most; a random walk
            needs it.
        start: The first place, such as ``0,2``; the smallest by default.
        facing: The slot of the gateway where the agent stands at first; by default the one by which
            the route leaves.
        signs: The share of the places, from 0 to 1, that have their own name as a landmark.
        seed: The seed of what is random: walks, signs, mazes and the errors of the odometry.
        thin: The share of the ways of a maze, from 0 to 1, that are removed.
        name: The name of the instance; by default it is made from the arguments.
        compass: Whether to note, after each step, the compass slot of the gateway where the agent
            stands.
        odometry: If given, how far each step led is noted, in hundredths of a way of a grid or a
            lattice, or in the units of a file. The errors are at most so many percent of the way,
            drawn with the seed. The truth is consistent with a drift of so many percent.
        lengths: Whether to note the length of each step, in the same units.

    Returns:
        The instance, with ``experience``, ``truth`` (the dstate after each step in the real map),
        ``name``, ``header``, and ``text()``, which is the file.

    Raises:
        TypeError: ``world`` is neither a name nor an environment, or ``route`` is not a text.
        ValueError: The world is not known, its rows and columns are missing, or a number is out of
            its range.
        InputError: The route cannot be walked; the world has more than 100,000 places; a tour is
            asked for where an odd number of ways meets in more than 1500 places; or odometry is
            asked for where the ways do not fit into a plane, as on a torus.
    """
    demand_text("route", route, "ESSENN")
    thin, signs, seed = share("thin", thin), share("signs", signs), whole_if_given("seed", seed, 0)
    steps, facing = (
        whole_if_given("steps", steps, 0, MOST_STEPS),
        whole_if_given("facing", facing, 0),
    )
    senses = senses_of(compass, odometry, lengths, seed or 0)
    world = world_of(world, size, thin, seed or 0)
    if route == "walk" and steps is None:
        raise ValueError("route='walk' needs steps")
    return instance(
        world,
        route,
        steps=steps,
        start=start,
        facing=facing,
        signs=signs,
        seed=seed,
        name=name,
        senses=senses,
    )
