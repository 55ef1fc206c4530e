"""What a world is: its size, the properties of its map, and what no walk can tell apart."""

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any, NamedTuple

from topomap.model.topology import Gateway, Place, TopologicalMap

MOST_PATHS = 2_000  # with more paths, it is not computed which of them meet


class Census(NamedTuple):
    """What is told of a world.

    ``planar`` tells whether it is embedded in the plane with the order of its slots. ``path_axiom``
    tells how it breaks the path axiom, or is None. ``exceptions`` is the number of exceptions to
    consistent boundaries, and ``perpendicular`` tells whether the map is qualitatively
    perpendicular (the paper, section IV); both are None if there are too many paths, or circular
    ones. ``views`` is the number of kinds of views. ``classes`` is the number of classes of
    bisimilar dstates, such that no walk in turns tells two dstates of a class apart;
    ``with_compass`` is the same number if a compass is read, too.
    """

    places: int
    ways: int
    slots: int
    components: int
    planar: bool
    path_axiom: str | None
    exceptions: int | None
    perpendicular: bool | None
    loops: int
    dead_ends: int
    dstates: int
    views: int
    classes: int
    with_compass: int

    def document(self) -> dict[str, Any]:
        """The census as JSON."""
        return self._asdict()

    def lines(self) -> Iterator[str]:
        """The census in words, with a sentence in each line."""
        yield (
            f"{self.places} places, {self.ways} ways, {self.slots} slots; loops: {self.loops}, "
            f"dead ends: {self.dead_ends}, components: {self.components}"
        )
        yield (
            f"planar as embedded: {_yes(self.planar)}; path axiom: "
            f"{self.path_axiom or 'holds'}; exceptions to consistent boundaries: "
            f"{'not counted' if self.exceptions is None else self.exceptions}; perpendicular: "
            f"{'not told' if self.perpendicular is None else _yes(self.perpendicular)}"
        )
        yield (
            f"{self.views} kinds of views; of {self.dstates} dstates, walks tell {self.classes} "
            f"apart, and {self.with_compass} with a compass"
        )


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


def census(world: TopologicalMap) -> Census:
    """Find out what a world is."""
    fault = world.path_axiom_fault()
    paths = world.paths()
    small = fault is None and len(paths) <= MOST_PATHS
    looks = {gateway: look(world, gateway) for gateway in world.gateways()}
    edges = world.edges()
    return Census(
        len(world.stars),
        len(edges),
        world.slots,
        len(world.components()),
        world.genus() == 0,
        fault,
        sum(1 for _ in world.exceptions()) if small else None,
        perpendicular(paths) if small else None,
        sum(one[0] == other[0] for one, other in edges),
        sum(len(star) == 1 for star in world.stars.values()),
        len(looks),
        len({*looks.values()}),
        len({*classes(world, looks).values()}),
        len({*classes(world, {g: (seen, g[1]) for g, seen in looks.items()}).values()}),
    )


def look(world: TopologicalMap, gateway: Gateway) -> tuple[Any, ...]:
    """What is seen at a gateway.

    It has the slots of the other gateways, clockwise from this one, the landmarks, and which of the
    gateways are on one path, if that is told.
    """
    landmarks = world.landmarks.get(gateway[0], frozenset())
    return world.view(gateway), landmarks, world.pairs(gateway)


def classes(world: TopologicalMap, looks: Mapping[Gateway, Any]) -> dict[Gateway, int]:
    """Divide dstates into classes of bisimilar ones.

    No walk tells two dstates of a class apart by what is seen (``looks``). This is the coarsest
    partition in which equal turns lead from one class to one class. It is found by refinement.
    Gateways that are not linked lead nowhere.
    """
    number: dict[Any, int] = {}
    of = {gateway: number.setdefault(seen, len(number)) for gateway, seen in looks.items()}
    many = len(number)
    turns = {gateway: sorted(world.view(gateway)) for gateway in of}
    while True:
        number = {}
        finer = {}
        for (place, slot), known in of.items():
            ends = [
                world.links.get((place, (slot + turn) % world.slots)) for turn in turns[place, slot]
            ]
            leads = tuple(-1 if end is None else of[end] for end in ends)
            finer[place, slot] = number.setdefault((known, leads), len(number))
        if len(number) == many:
            return of
        of, many = finer, len(number)


def perpendicular(paths: list[list[Gateway]]) -> bool:
    """Tell whether no two paths meet twice, and no three make a triangle."""
    on: dict[Place, list[int]] = {}
    for number, path in enumerate(paths):
        for place in {place for place, _ in path}:
            on.setdefault(place, []).append(number)
    common = Counter(pair for of in on.values() for pair in combinations(sorted(of), 2))
    if any(many > 1 for many in common.values()):
        return False
    at = {pair: place for place, of in on.items() for pair in combinations(sorted(of), 2)}
    meets: dict[int, set[int]] = {}
    for one, other in at:
        meets.setdefault(one, set()).add(other)
        meets.setdefault(other, set()).add(one)
    for (one, other), place in at.items():
        for third in meets[one] & meets[other]:
            rest = (at[min(pair), max(pair)] for pair in ((one, third), (other, third)))
            if {*rest} != {place}:
                return False
    return True
