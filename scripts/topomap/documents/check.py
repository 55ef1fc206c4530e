"""Two checkers of maps: ``encodings/check.lp``, and one in Python from the definitions.

The latter uses networkx. Neither shares any code with what makes the maps.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import Any

import clingo

from topomap.model.experience import Experience
from topomap.model.topology import Gateway
from topomap.runtime import nx
from topomap.runtime.folders import ENCODINGS

At = Sequence[tuple[int, int, int]]  # at(T,P,S)
Violation = tuple[str, int]
PATH_RULES = ("path_twice", "path_circular")
NO_PATH_AXIOM = "no_path_axiom"  # with this demand a map need not keep the rules above
LATE = ("closed", "travelled", "perpendicular")  # rules that are checked after the last step only
STEP_RULES = {
    *("exactly_one", "naming", "gateway", "view", "landmark", "marker", "schema", "itself"),
    *("compass", "odometry", "length", "same", "apart", "look"),
}


def by_rules(experience: Experience, at: At, demands: Sequence[str] = ()) -> set[Violation]:
    """Find violations by ``check.lp``: rules, and the steps after which they are broken.

    ``demands`` are terms: planar, bound(B), closed, travelled, boundary, perpendicular; and
    no_path_axiom, which lifts a demand.
    """
    control = clingo.Control(experience.constants())
    control.load(str(ENCODINGS / "check.lp"))
    facts = [f"at({step},{place},{slot})." for step, place, slot in at]
    facts += [f"demand({demand})." for demand in demands]
    control.add("base", [], experience.facts() + "".join(facts))
    control.ground()
    atoms = control.symbolic_atoms.by_signature("violation", 2)
    return {(str(atom.symbol.arguments[0]), atom.symbol.arguments[1].number) for atom in atoms}


def by_definition(experience: Experience, at: At, demands: Sequence[str] = ()) -> set[Violation]:
    """Find violations by the definitions, from the map after each step."""
    found = {("exactly_one", step) for step, *_ in at if not 0 <= step <= experience.steps}
    stands: dict[int, Gateway] = {}
    last = max((0, *(step for step, *_ in at)))
    steps = range(min(last, experience.steps) + 1)
    for step in steps:
        dstates = {(place, slot) for one, place, slot in at if one == step}
        if len(dstates) != 1:
            found.add(("exactly_one", step))
        for place, slot in dstates:
            if place > step or (place, place, 0) not in at:
                found.add(("naming", step))
            if place in steps and slot not in experience.views[place]:
                found.add(("gateway", step))
            elif place in steps and len(dstates) == 1:
                stands[step] = place, slot
    for step, (place, slot) in stands.items():
        if not _same_view(experience, step, place, slot):
            found.add(("view", step))
        if experience.landmarks[step] != experience.landmarks[place]:
            found.add(("landmark", step))
    for name in experience.names():
        drops, picks, markers = experience.marks_of(name)
        for drop in drops:
            later = sorted(step for step in picks if step > drop)
            for step in range(drop + 1, min([*later, last]) + 1):
                if not {step, drop} <= stands.keys():
                    continue
                if (step in markers | picks) != (stands[step][0] == stands[drop][0]):
                    found.add(("marker", step))
    for step in experience.looks:
        if {step - 1, step} <= stands.keys() and stands[step] != stands[step - 1]:
            found.add(("look", step))
    found |= _contradictions(experience, stands)
    ends: dict[Gateway, set[Gateway]] = {}
    for step, out, arrival in _ways(experience, stands):
        ends.setdefault(out, set()).add(arrival)
        ends.setdefault(arrival, set()).add(out)
        if out == arrival:
            found.add(("itself", step))
        if max(len(ends[out]), len(ends[arrival])) > 1:
            found.add(("schema", step))
    whole = Grown(experience, stands, last)
    wanted = [demand for demand in demands if demand != NO_PATH_AXIOM]
    for rule in wanted if NO_PATH_AXIOM in demands else (*PATH_RULES, *wanted):
        name, _, number = rule.rstrip(")").partition("(")
        broken, limit = BROKEN[name], int(number or 0)
        if not broken(whole, limit):
            continue
        step = last if name in LATE else 0
        while not broken(Grown(experience, stands, step), limit):
            step += 1
        found.add((rule, step))
    return found


def _contradictions(experience: Experience, stands: dict[int, Gateway]) -> set[Violation]:
    """Find what contradicts what is known besides views, for each pair of steps."""
    found = set()
    for one, other in combinations(sorted(stands), 2):
        if stands[one][0] != stands[other][0]:
            continue
        turned = stands[other][1] - stands[one][1]
        slots = experience.compass[one : other + 1 : other - one]
        north = [slot for slot in slots if slot is not None]
        if len(north) == 2 and _off(experience, north[1] - north[0] - turned):
            found.add(("compass", other))
        moved = [shift for shift in _shifts(experience)[one:other] if shift]
        if len(moved) == other - one:
            way = sum(abs(x) + abs(y) for x, y in moved)
            apart = max(abs(sum(shift[axis] for shift in moved)) for axis in (0, 1))
            if 100 * apart > experience.drift * way:
                found.add(("odometry", other))
    for rule, pairs in (("same", experience.same), ("apart", experience.apart)):
        for one, other in pairs:
            if not {one, other} <= stands.keys():
                continue
            if (stands[one][0] == stands[other][0]) != (rule == "same"):
                found.add((rule, other))
    links = {step: {out, arrival} for step, out, arrival in _ways(experience, stands)}
    lengths = [(step, length) for step, length in enumerate(experience.lengths, 1) if length]
    for (one, length), (other, another) in combinations(lengths, 2):
        if not {one, other} <= links.keys() or links[one] != links[other]:
            continue
        if 100 * abs(length - another) > experience.stretch * max(length, another):
            found.add(("length", other))
    return found


def _shifts(experience: Experience) -> Sequence[tuple[int, int] | None]:
    """How far each step moved the agent.

    A second look does not move it, and to the start of a log the distance is not known.
    """
    shifts: list[tuple[int, int] | None] = list(experience.shifts)
    for step in experience.looks if shifts else ():
        shifts[step - 1] = shifts[step - 1] or (0, 0)
    for step in experience.starts if shifts else ():
        shifts[step - 1] = None
    return shifts


def _ways(
    experience: Experience, stands: dict[int, Gateway]
) -> Iterator[tuple[int, Gateway, Gateway]]:
    """The travels, each with the gateways by which it leaves and arrives."""
    for step, turn in enumerate(experience.turns, 1):
        if turn is not None and step in stands and step - 1 in stands:
            out = _gateway_seen(experience, step - 1, turn, stands[step - 1])
            if out is not None:
                yield step, out, stands[step]


def _off(experience: Experience, slots: int) -> bool:
    """Tell whether a difference of slots, round the circle, exceeds the tolerance of bearings."""
    return min(slots % experience.slots, -slots % experience.slots) > experience.tolerance


def _gateway_seen(experience: Experience, step: int, slot: int, stands: Gateway) -> Gateway | None:
    """The gateway of the place that is seen in this slot after a step, if there is one."""
    place, base = stands
    if not experience.tolerance:
        return place, (base + slot) % experience.slots
    star, view = sorted(experience.views[place]), sorted(experience.views[step])
    ahead = star[star.index(base) :] + star[: star.index(base)]
    number = view.index(slot) if slot in view else len(ahead)
    return (place, ahead[number]) if number < len(ahead) else None


def _same_view(experience: Experience, step: int, place: int, slot: int) -> bool:
    """Tell whether a step sees the same as the first visit of the place.

    The gateways must be the same, as far as bearings are exact, with the same ones on one path.
    """
    view, star = experience.views[step], experience.views[place]
    stands = place, slot
    there = {
        one: end[1]
        for one in view
        for end in [_gateway_seen(experience, step, one, stands)]
        if end is not None
    }
    if len(view) != len(star) or {*there.values()} != {*star}:
        return False
    if any(_off(experience, end - slot - one) for one, end in there.items()):
        return False
    lines = {frozenset(there[one] for one in line) for line in _lines(experience, step)}
    return lines == _lines(experience, place)


def _lines(experience: Experience, visit: int) -> set[frozenset[int]]:
    """The pairs of gateways on one path at a visit."""
    if experience.straight:
        return {*map(frozenset, experience.straight[visit])}
    half = experience.slots // 2
    pairs = combinations(experience.views[visit], 2)
    return {frozenset(pair) for pair in pairs if abs(pair[0] - pair[1]) == half}


class Grown:
    """The map that the steps up to ``step`` make.

    ``links`` gives the gateway at the other end of a link, and ``first`` the first step through a
    gateway. ``ahead`` gives for each gateway the gateways of arrival, in order, of a walk that
    leaves by it and goes straight on.
    """

    def __init__(self, experience: Experience, stands: dict[int, Gateway], step: int):
        self.slots, self.half, self.step = experience.slots, experience.slots // 2, step
        places = sorted({place for t, (place, _) in stands.items() if t <= step})
        self.stars = {place: sorted(experience.views[place]) for place in places}
        self.lines: dict[Gateway, Gateway] = {}
        self.told = bool(experience.straight)  # whether it is known which gateways are on one path
        for place in places if self.told else ():
            for one, other in experience.straight[place]:
                self.lines |= {(place, one): (place, other), (place, other): (place, one)}
        self.dstate = stands.get(step)
        self.links: dict[Gateway, Gateway] = {}
        self.first: dict[Gateway, int] = {}
        for t, out, arrival in _ways(experience, stands):
            if t <= step:
                self.first.setdefault(out, t)
                self.first.setdefault(arrival, t)
                self.links.setdefault(out, arrival)
                self.links.setdefault(arrival, out)
        walks: nx.DiGraph[Gateway] = nx.DiGraph()
        walks.add_edges_from((out, self.opposite(end)) for out, end in self.links.items())
        self.ahead = {
            out: [self.links[g] for g in nx.dfs_preorder_nodes(walks, out) if g in self.links]
            for out in self.links
        }

    def opposite(self, gateway: Gateway) -> Gateway:
        """The direction on the opposite side of the place.

        Where it is known which gateways are on one path, the direction of a path that ends at
        gateway S is -1 - S.
        """
        place, slot = gateway
        if self.told:
            return self.lines.get(gateway, (place, -1 - slot))
        return place, (slot + self.half) % self.slots

    def bearing(self, heading: Gateway) -> Gateway:
        """The slot of a heading."""
        place, slot = heading
        return place, slot if slot >= 0 else (self.half - 1 - slot) % self.slots

    def paths(self) -> list[list[Gateway]]:
        """Each path as its places, each with the slot of its heading."""
        paths: set[tuple[Gateway, ...]] = set()
        for place, star in self.stars.items():
            for slot in star:
                for start in (place, slot), self.opposite((place, slot)):
                    path = [start, *map(self.opposite, self.ahead.get(start, []))]
                    if path[1:] and path[-1] == start:  # the path is circular
                        paths.add(tuple(self.one_way(path[1:])))
                    elif self.opposite(start) not in self.links:
                        paths.add(tuple(self.one_way(path)))
        return [list(path) for path in sorted(paths)]

    def one_way(self, path: list[Gateway]) -> list[Gateway]:
        """The smallest of the ways to write a path down."""
        return min(self.ways(path))

    def ways(self, path: list[Gateway]) -> list[list[Gateway]]:
        """All ways to write a path down: from either end, or from any place if it is circular."""
        ways = [path, [self.opposite(heading) for heading in reversed(path)]]
        if path and self.links.get(path[-1]) == self.opposite(path[0]):
            ways = [way[n:] + way[:n] for way in ways for n in range(len(way))]
        return ways

    def forms(self) -> list[dict[tuple[Gateway, ...], tuple[Gateway, ...]]]:
        """All ways to write the paths down, with slots of headings, each with the smallest one."""
        every = ([tuple(map(self.bearing, way)) for way in self.ways(p)] for p in self.paths())
        return [dict.fromkeys(ways, min(ways)) for ways in every]

    def path_twice(self, _: int) -> bool:
        """Whether a path contains a place twice."""
        return any(
            place == out[0] and (place, slot) != self.opposite(out)
            for out, arrivals in self.ahead.items()
            for place, slot in arrivals
        )

    def path_circular(self, _: int) -> bool:
        """Whether a path is circular."""
        return any(self.opposite(out) in arrivals for out, arrivals in self.ahead.items())

    def pending(self) -> list[Gateway]:
        """The gateways without a link."""
        gateways = [(place, slot) for place, star in self.stars.items() for slot in star]
        return [gateway for gateway in gateways if gateway not in self.links]

    def untravelled(self, _: int) -> bool:
        """Whether some path has one place only."""
        pending = self.pending()
        return any(self.opposite(gateway) not in self.links for gateway in pending)

    def embedding(self) -> "nx.PlanarEmbedding[Any]":
        """The rotation system, with a node for each end of a link to separate parallel links."""
        embedding: nx.PlanarEmbedding[Any] = nx.PlanarEmbedding()
        data: dict[Any, list[Any]] = {
            place: [(place, slot) for slot in star if (place, slot) in self.links]
            for place, star in self.stars.items()
        }
        for end, other in self.links.items():
            data[end] = [end[0], other]
        embedding.set_data(data)
        return embedding

    def crossed(self, _: int) -> bool:
        """Whether the map is not planar."""
        try:
            self.embedding().check_structure()
        except nx.NetworkXException:
            return True
        return False

    def faces(self) -> list[list[Gateway]]:
        """Each face as the gateways by which its walk leaves."""
        embedding = self.embedding()
        seen: set[tuple[Any, Any]] = set()
        faces = []
        for out in self.links:
            if (out[0], out) not in seen:
                walk = embedding.traverse_face(out[0], out, mark_half_edges=seen)
                pairs = zip(walk, [*walk[1:], walk[0]], strict=True)
                faces.append([end for place, end in pairs if place in self.stars])
        return faces or [[]]

    def genus(self) -> int:
        """The genus, by Euler's formula."""
        graph: nx.Graph[Any] = nx.Graph([(out[0], end[0]) for out, end in self.links.items()])
        bare = len(self.stars) - len(graph)
        parts = bare + nx.number_connected_components(graph) if graph else bare
        faces = bare + (len(self.faces()) if self.links else 0)
        return (2 * parts - len(self.stars) + len(self.links) // 2 - faces) // 2

    def over(self, bound: int) -> bool:
        """Whether there are more places than the bound allows."""
        return len(self.stars) > bound

    def beside(self, path: list[Gateway]) -> tuple[set[int], set[int]]:
        """The places to the right and to the left of a path."""
        sides: tuple[set[int], set[int]] = set(), set()
        for heading in path:
            place, slot = self.bearing(heading)
            behind = (self.bearing(self.opposite(heading))[1] - slot) % self.slots
            for other in self.stars[place]:
                turn = (other - slot) % self.slots
                if turn not in (0, behind):
                    met = {place for place, _ in self.ahead.get((place, other), [])}
                    sides[turn > behind].update(met)
        return sides

    def across(self, gateway: Gateway) -> frozenset[Gateway]:
        """A gateway and the direction on the opposite side."""
        return frozenset((gateway, self.opposite(gateway)))

    def name(self, path: list[Gateway]) -> int | frozenset[Gateway]:
        """The first step along a path; for a path that no step travels, its gateways."""
        ends = {end for heading in path for end in self.across(heading)}
        steps = [self.first[end] for end in ends if end in self.first]
        return min(steps) if steps else self.across(path[0])

    def exceptions(self) -> Iterator[tuple[str, list[list[Gateway]], set[int]]]:
        """The exceptions to consistent boundaries: the kind, the paths and the places of each."""
        paths = [(path, Counter(place for place, _ in path)) for path in self.paths()]
        for (path, places), (another, others) in combinations(paths, 2):
            if len(shared := places.keys() & others.keys()) > 1:
                yield "meet twice", [path, another], shared
        for path, places in paths:
            if again := {place for place, times in places.items() if times > 1}:
                yield "place twice", [path], again
            for place in set.intersection(*self.beside(path)):
                yield "both sides", [path], {place}

    def slanted(self, _: int) -> bool:
        """Whether two paths share two places, or three meet pairwise at three."""
        paths = [{place for place, _ in path} for path in self.paths()]
        if any(len(a & b) > 1 for a, b in combinations(paths, 2)):
            return True
        meet = [(i, j) for i, j in combinations(range(len(paths)), 2) if paths[i] & paths[j]]
        cliques: Iterator[list[int]] = nx.enumerate_all_cliques(nx.Graph(meet))
        triples = ([paths[path] for path in clique] for clique in cliques if len(clique) == 3)
        return any(len((a & b) | (b & c) | (a & c)) == 3 for a, b, c in triples)


BROKEN: dict[str, Callable[[Grown, int], bool]] = {
    "path_twice": Grown.path_twice,
    "path_circular": Grown.path_circular,
    "planar": Grown.crossed,
    "bound": Grown.over,
    "closed": lambda grown, _: bool(grown.pending()),
    "travelled": Grown.untravelled,
    "boundary": lambda grown, _: any(grown.exceptions()),
    "perpendicular": Grown.slanted,
}
