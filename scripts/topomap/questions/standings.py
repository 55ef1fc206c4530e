"""Maps with the dstate of an agent, and what each predicts that will be seen."""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from topomap.documents.bisimulation import Chart
from topomap.model.experience import DState, Experience
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.search.living import Living, Told


@dataclass(frozen=True)
class Standing:
    """A map, the dstate of the agent in it, and the place of the marker if it lies somewhere.

    ``compass``, if there is one, has the compass slot of slot 0 of each place.
    """

    world: TopologicalMap
    dstate: Gateway
    marker: Place | None = None
    compass: Mapping[Place, int] = field(default_factory=dict)

    def chart(self) -> Chart:
        """The same as plain data, for the checker."""
        world = self.world
        rest = world.landmarks, self.marker, self.compass, world.across
        return Chart(world.slots, world.stars, world.links, self.dstate, *rest)


def standing(experience: Experience, at: tuple[DState, ...]) -> Standing:
    """Make the map of a hypothesis with the dstate of the agent.

    The marker lies where it was last put down, if it was not taken up since then. A compass counts
    if each visit has one.
    """
    down = experience.put_down().get(None)
    marker = None if down is None else at[down][0]
    world = experience.map_of(at)
    return Standing(
        replace(world, landmarks=signs(experience, at)), at[-1], marker, orientation(experience, at)
    )


def standing_of(told: Told, living: Living) -> Standing:
    """Make the same of a hypothesis that is kept, in time proportional to the size of the map."""
    world, lying, visit = living.form.world(told), told.lying(), living.visit
    where = {name: visit.back(down).gateway // told.slots for name, down in lying.items()}
    landmarks = {**world.landmarks}
    for name, place in where.items():
        if name is not None:
            landmarks[place] |= {f"marker({name})"}
    compass: dict[Place, int] = {}
    if not told.without_compass:
        known = ((place, told.steps[place].compass) for place in world.stars)
        compass = {place: slot for place, slot in known if slot is not None}
    dstate = divmod(visit.gateway, told.slots)
    return Standing(replace(world, landmarks=landmarks), dstate, where.get(None), compass)


def signs(experience: Experience, at: Sequence[DState]) -> dict[Place, frozenset[str]]:
    """What is recognised at each place: its landmarks, and markers with names that lie there."""
    told = {place: experience.landmarks[place] for place, _ in at}
    for name, down in experience.put_down().items():
        if name is not None:
            told[at[down][0]] |= {f"marker({name})"}
    return told


def orientation(experience: Experience, at: Sequence[DState]) -> dict[Place, int]:
    """The compass slot of slot 0 of each place; empty unless each visit has a compass."""
    slots = [slot for slot in experience.compass[: len(at)] if slot is not None]
    if len(slots) < len(at):
        return {}
    return {place: slots[place] for place, _ in at}


@dataclass(frozen=True)
class Prediction:
    """What a map predicts that will be seen.

    It has the gateways clockwise from the one of the arrival, the landmarks, and whether the marker
    is there; the compass slot of the gateway of the arrival, if there is a compass; and which
    gateways are on one path, if that is known (each pair in both orders).
    """

    view: frozenset[int]
    landmarks: frozenset[str] = frozenset()
    marker: bool = False
    compass: int | None = None
    straight: frozenset[tuple[int, int]] | None = None

    @property
    def signs(self) -> tuple[Hashable, ...]:
        """What is seen besides gateways."""
        pairs = tuple(sorted(self.straight or ()))
        return tuple(sorted(self.landmarks)), self.marker, self.compass, pairs


def sight(standing: Standing, dstate: Gateway, marker: Place | None) -> Prediction:
    """What is seen at a dstate of a map, if the marker lies there."""
    world, (place, slot) = standing.world, dstate
    landmarks = world.landmarks.get(place, frozenset())
    north = standing.compass.get(place)
    points = None if north is None else (slot + north) % world.slots
    here = marker is not None and marker == place
    return Prediction(world.view(dstate), landmarks, here, points, world.pairs(dstate))


def predict(
    standing: Standing, turns: Sequence[int], drop: int | None = None
) -> tuple[Prediction | None, ...]:
    """What a map predicts that will be seen after each step of a walk.

    It is None once the walk goes through a pending gateway, or cannot go on.
    """
    world, dstate, marker = standing.world, standing.dstate, standing.marker
    found: list[Prediction | None] = []
    for step, turn in enumerate(turns):
        if drop == step:
            marker = dstate[0]
        out = dstate[0], (dstate[1] + turn) % world.slots
        if out not in world.links:
            break
        dstate = world.links[out]
        found.append(sight(standing, dstate, marker))
    return (*found, *[None] * (len(turns) - len(found)))


def tells(one: Sequence[Prediction | None], other: Sequence[Prediction | None]) -> bool:
    """Tell whether a walk tells maps apart, by what they predict of it."""
    return any(a and b and a != b for a, b in zip(one, other, strict=True))


def shape(standing: Standing) -> Hashable:
    """A value that two maps share if they differ only in the names of places.

    The agent must be at the same dstate, too.
    """
    world, slots = standing.world, standing.world.slots
    first = {standing.dstate[0]: (0, standing.dstate[1])}
    form = []
    for place in (waiting := [standing.dstate[0]]):
        _, base = first[place]
        ends: list[tuple[int, ...]] = []
        for turn in sorted(world.view((place, base))):
            end = world.links.get((place, (base + turn) % slots))
            if end is None:
                ends.append((turn,))
                continue
            if end[0] not in first:
                first[end[0]] = len(first), end[1]
                waiting.append(end[0])
            number, slot = first[end[0]]
            ends.append((turn, number, (end[1] - slot) % slots))
        form.append((tuple(ends), *sight(standing, (place, base), standing.marker).signs))
    return slots, tuple(form)


def facts(maps: Iterable[tuple[int, Standing]]) -> str:
    """Maps as facts for ``explore.lp`` and similar programs, with places numbered in order."""
    lines: list[str] = []
    for number, standing in maps:
        world = standing.world
        if not lines:
            lines.append(f"slots({world.slots}).")
        index = {place: count for count, place in enumerate(world.stars)}
        lines += [
            f"map_gateway({number},{index[place]},{slot})." for place, slot in world.gateways()
        ]
        lines += [
            f"map_link({number},{index[a[0]]},{a[1]},{index[b[0]]},{b[1]})."
            for a, b in world.links.items()
        ]
        lines += [
            f"map_sign({number},{index[place]},{term})."
            for place in world.stars
            for term in sorted(world.landmarks.get(place, ()))
        ]
        place, slot = standing.dstate
        lines.append(f"map_stands({number},{index[place]},{slot}).")
        lines += [
            f"map_compass({number},{index[place]},{slot})."
            for place, slot in standing.compass.items()
        ]
        lines += [
            f"map_pair({number},{index[a[0]]},{a[1]},{b[1]})."
            for a, b in (world.across or {}).items()
        ]
        if standing.marker is not None:
            lines.append(f"map_marker({number},{index[standing.marker]}).")
    return "\n".join(lines) + "\n"
