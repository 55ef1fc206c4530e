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
    """Explore a world, and note what is seen (the paper, section IV).

    Parameters:
        world: ``grid``, ``torus``, ``cylinder``, ``crescents``, ``maze``, ``hexagons`` or
            ``triangles``, with ``size``, its rows and columns; or an environment that was made
            before.
        route: ``snake``, ``walk`` (random), ``tour`` (over every way), compass letters such as
            ``ESSENN``, or absolute slots such as ``0,3,1``.
        steps: cut the route after so many steps, 100,000 at most; a walk needs it.
        start: the first place, such as ``0,2``; the smallest by default.
        facing: the gateway stood at first, a slot; by default the one that is first left by.
        signs: the share of places, 0 to 1, that carry their own name as a landmark.
        seed: for walk, signs and maze.
        thin: the share of the ways of a maze, 0 to 1, that are taken away.
        name: of the instance; made from the arguments by default.
        compass: whether the compass slot of the gateway stood at is noted after each step.
        odometry: if given, how far each step led is noted, in hundredths of a way of a grid or a
            lattice, or in the units of a network; errors are so many percent of the way at most,
            drawn with the seed. The truth is consistent with a drift of so many percent.
        lengths: whether the length of each step is noted, in the same units.

    Returns:
        The instance: ``experience``, ``truth`` (the dstate after each step in the real map),
        ``name``, ``header``, and ``text()``, the file.

    Raises:
        TypeError: something else than a world or a route.
        ValueError: an unknown world, no rows and columns, or a number that cannot be.
        InputError: what cannot be walked, or is too large: more than 100,000 places, or a tour
            where an odd number of ways meets in more than 1500 places; odometry where the ways
            do not fit into a plane, as on a torus.
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
