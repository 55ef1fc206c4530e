"""Making instances by exploring worlds."""

from topomap.worlds.environment import Environment
from topomap.worlds.environment import environment as environment_of
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
) -> Instance:
    """Explore a world, and note what is seen (the paper, section IV).

    Parameters:
        world: ``grid``, ``torus``, ``cylinder``, ``maze``, ``hexagons`` or ``triangles``, with
            ``size``, its rows and columns; or an environment that was made before.
        route: ``snake``, ``walk`` (random), ``tour`` (over every way), compass letters such as
            ``ESSENN``, or absolute slots such as ``0,3,1``.
        steps: cut the route after so many steps; a walk needs it.
        start: the first place, such as ``0,2``; the smallest by default.
        facing: the gateway stood at first, a slot; by default the one that is first left by.
        signs: the share of places, 0 to 1, that carry their own name as a landmark.
        seed: for walk, signs and maze.
        thin: the share of the ways of a maze, 0 to 1, that are taken away.
        name: of the instance; made from the arguments by default.

    Returns:
        The instance: ``experience``, ``truth`` (the dstate after each step in the real map),
        ``name``, ``header``, and ``text()``, the file.

    Raises:
        ValueError: an unknown world, or no rows and columns.
        InputError: what cannot be walked.
    """
    if isinstance(world, str):
        if len(size) != 2:
            raise ValueError(f"{world}: rows and columns are wanted, not {len(size)} numbers")
        world = environment_of(world, *size, thin=thin, seed=seed or 0)
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
    )
