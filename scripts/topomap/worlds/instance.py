"""Instances: one record determines name, header and facts.

The same record always gives the same bytes.
"""

import re
import shlex
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from topomap.model.experience import DState, Experience, observe
from topomap.model.topology import Gateway, Place, label
from topomap.runtime.errors import InputError
from topomap.worlds.environment import Environment, plain
from topomap.worlds.route import checked, letters, snake, walk
from topomap.worlds.senses import Senses, demand_flat
from topomap.worlds.tours import tour

NOTHING = Senses()


@dataclass(frozen=True)
class Instance:
    """An exploration of an environment.

    It has its name, how it was made, what was seen, the true hypothesis, and how the environment's
    own map breaks the path axiom, if it does.
    """

    name: str
    header: tuple[str, ...]
    experience: Experience
    truth: tuple[DState, ...]
    fault: str | None = None

    def text(self) -> str:
        """The text of the instance file."""
        header = (" ".join(line.split()) for line in self.header)
        return "".join(f"% {line}\n" for line in header) + "\n" + self.experience.facts()


def instance(
    environment: Environment,
    route: str,
    *,
    steps: int | None = None,
    start: str | None = None,
    facing: int | None = None,
    signs: float = 0.0,
    seed: int | None = None,
    name: str | None = None,
    senses: Senses = NOTHING,
) -> Instance:
    """Explore an environment.

    ``route`` is ``snake``, ``walk``, ``tour``, or a list of directions, and ``steps`` cuts it.
    ``start`` names the first place (by default the smallest). ``facing`` is the slot of the gateway
    where the agent stands at first (by default the one by which it leaves). ``signs`` is the share
    of the places that have a sign. ``senses`` tells what is measured besides views.

    Raises:
        InputError: The route cannot be walked, or what is asked for cannot be measured.
    """
    if signs:
        environment = environment.signed(signs, seed or 0)
    world = environment.map
    first: Place = environment.place(start) if start is not None else min(world.stars)
    slots: Iterable[int]
    if route == "snake":
        slots = snake(environment)
    elif route == "tour":
        slots = tour(world, first)
    elif route == "walk":
        slots = walk(world, first, seed or 0)
    else:
        slots = letters(route, world.slots)
    taken = checked(world, first, slots, steps)
    if facing is None:
        facing = taken[0] if taken else min(world.stars[first])
    elif facing not in world.stars[first]:
        raise InputError(f"{environment.name}: place {label(first)} has no gateway {facing}")

    call = ["topomap", "generate", *environment.call, "--route", route]
    parts = [_word(environment.name), _part(route, len(taken), steps)]
    if steps is not None:
        call += ["--steps", str(steps)]
    if start is not None:
        call += ["--start", start]
        parts += ["from" + _word(start)]
    if facing != (taken[0] if taken else None):
        call += ["--facing", str(facing)]
        parts += [f"facing{facing}"]
    if signs:
        call += ["--signs", plain(signs)]
        parts += [f"signs{100 * signs:g}"]
    call += senses.call()
    parts += senses.parts()
    if seed is not None:
        call += ["--seed", str(seed)]
        parts += [f"seed{seed}"]
    if name is not None:
        if not re.fullmatch(r"[\w+][\w.+-]*", name):
            raise InputError(f"name {name!r}: letters, digits and _ . + - only")
        call += ["--name", name]
    title = name or "-".join(parts)

    header = [
        title,
        f"environment: {environment.name} (places {len(world.stars)}, "
        f"ways {len(world.links) // 2}, slots {world.slots})",
        *environment.notes,
        f"exploration: {route} from place {label(first)} (steps {len(taken)})",
    ]
    if signs:
        header.append(
            f"signs: {100 * signs:g} % of the places "
            f"({len(environment.map.landmarks)} of {len(world.stars)}), seed {seed or 0}"
        )
    header += senses.notes()
    fault = world.path_axiom_fault()
    if fault:
        header.append(f"the environment's own map breaks the path axiom: {fault}")
    header.append("made by: " + shlex.join(call))
    seen, truth = measured(environment, (first, facing), taken, senses)
    return Instance(title, tuple(header), seen, truth, fault)


def measured(
    environment: Environment,
    start: Gateway,
    route: Sequence[int],
    senses: Senses,
    drops: Iterable[int] = (),
) -> tuple[Experience, tuple[DState, ...]]:
    """Find what is seen and measured along a route, and the true hypothesis.

    Raises:
        InputError: Odometry is asked for, and the world is not flat.
    """
    seen, truth = observe(environment.map, start, route, drops)
    if not senses:
        return seen, truth
    if senses.odometry is not None:
        demand_flat(environment.name, environment.map, environment.moves)
    dstates = [start]
    for slot in route:
        dstates.append(environment.map.links[dstates[-1][0], slot])
    return senses.of(seen, dstates, route, environment.moves), truth


def _part(route: str, taken: int, steps: int | None) -> str:
    """The part of an instance's name that tells the route."""
    if route in ("tour", "walk"):
        return f"{route}{taken}"
    word = _word(route)
    if len(word) > 40:
        word = f"{word[:31]}-{zlib.crc32(route.encode()):08x}"
    return word if steps is None else f"{word}{taken}"


def _word(text: str) -> str:
    """Make a text usable as a part of the name of a file."""
    return re.sub(r"[^\w.]+", "-", text).strip("-.")
