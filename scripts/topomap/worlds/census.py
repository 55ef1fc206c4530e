"""What a world is: its size, the properties of its map, and what no walk can tell apart."""

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any, NamedTuple

from topomap.model import words
from topomap.model.topology import Gateway, Place, TopologicalMap

MOST_PATHS = 2_000  # with more paths, it is not computed which of them meet
MOST_PLACES = 20_000  # the same holds with more places


class Census(NamedTuple):
    """What is known of a world.

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
        places, ways = words.number(self.places, "place"), words.number(self.ways, "way")
        yield (
            f"{places}, {ways}, {self.slots} slots; loops: {self.loops}, "
            f"dead ends: {self.dead_ends}, components: {self.components}"
        )
        yield (
            f"planar as embedded: {_yes(self.planar)}; path axiom: "
            f"{self.path_axiom or 'holds'}; exceptions to consistent boundaries: "
            f"{'not counted' if self.exceptions is None else self.exceptions}; perpendicular: "
            f"{'not computed' if self.perpendicular is None else _yes(self.perpendicular)}"
        )
        views, dstates = words.number(self.views, "kind"), words.number(self.dstates, "dstate")
        yield (
            f"{views} of views; of {dstates}, walks tell {self.classes} apart, and "
            f"{self.with_compass} with a compass"
        )


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


def census(world: TopologicalMap) -> Census:
    """Find out what a world is."""
    fault = world.path_axiom_fault()
    paths = world.paths()
    small = fault is None and len(paths) <= MOST_PATHS and len(world.stars) <= MOST_PLACES
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
    gateways are on one path, if that is known.
    """
    landmarks = world.landmarks.get(gateway[0], frozenset())
    return world.view(gateway), landmarks, world.pairs(gateway)


def classes(world: TopologicalMap, looks: Mapping[Gateway, Any]) -> dict[Gateway, int]:
    """Divide dstates into classes of bisimilar ones.

    No walk tells two dstates of a class apart by what is seen (``looks``). This is the coarsest
    partition in which equal turns lead from one class to one class. It is found by Hopcroft's
    algorithm: when a class is split, the smaller of its two parts is used to split other classes.
    Gateways that are not linked lead nowhere.
    """
    before: dict[Gateway, list[tuple[int, Gateway]]] = {gateway: [] for gateway in looks}
    blocks: dict[Any, set[Gateway]] = {}
    for (place, slot), seen in looks.items():
        open_ = []
        for turn in world.view((place, slot)):
            end = world.links.get((place, (slot + turn) % world.slots))
            if end is None:
                open_.append(turn)
            else:
                before[end].append((turn, (place, slot)))
        blocks.setdefault((seen, tuple(sorted(open_))), set()).add((place, slot))
    parts = [*blocks.values()]
    of = {gateway: number for number, part in enumerate(parts) for gateway in part}
    waiting = {*range(len(parts))}
    while waiting:
        number = waiting.pop()
        leading: dict[int, dict[int, set[Gateway]]] = {}  # by turn and class
        for end in parts[number]:
            for turn, gateway in before[end]:
                leading.setdefault(turn, {}).setdefault(of[gateway], set()).add(gateway)
        for met in leading.values():
            for gateways in [*met.values()]:
                # They were in one class at the start of this round, which may be split by now.
                now: dict[int, set[Gateway]] = {}
                for gateway in gateways:
                    now.setdefault(of[gateway], set()).add(gateway)
                for block, inside in now.items():
                    if len(inside) == len(parts[block]):
                        continue
                    parts[block] -= inside
                    new = len(parts)
                    smaller = inside if len(inside) <= len(parts[block]) else parts[block]
                    larger = parts[block] if smaller is inside else inside
                    parts[block] = larger
                    parts.append(smaller)
                    of.update(dict.fromkeys(smaller, new))
                    waiting.add(new)
    return of


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
