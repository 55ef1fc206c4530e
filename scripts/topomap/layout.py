"""Where the places, links and pending gateways of a map are drawn.

A map of genus 0 is drawn without crossings; of one of higher genus a planar part is, and the
other links are led through its faces, across as few links as can be. Around each place the
gateways leave in their order, clockwise as the agent turns. If all links can be straight and in
the directions of one compass, they are. Else the drawing is a mesh of triangles: places,
crossings, bends of links, and in each face a ring of corners round a centre. It starts from a
drawing on a grid, in which no triangle is folded, and is bent towards a good shape by steps that
fold none, so nothing else comes to cross and every rotation stays right.
"""

import random
from collections import defaultdict, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import networkx as nx
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import linalg

from topomap.topology import Gateway, Place, TopologicalMap

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
ORDERS = 30  # of links, for a planar part
STUB = 0.36  # the length of a stub, where a link is of length 1
BENDS = 3  # inner points of a link that is not straight
PIECE = 0.7  # the length of a link's piece up to a crossing
SHORTEST = 0.4  # link in a drawing by the compass
MEMORY = 20  # steps that the descent remembers
WEIGHTS = 100.0, 10.0, 1.0, 0.1, 0.01, 0.002  # of the triangles, one after the other
STEPS = 1500  # of the descent, at most, with each weight


@dataclass(frozen=True)
class Layout:
    """A drawing, y upwards, links about 1 long.

    ``places``: a point each. ``lines``: of each gateway the line that leaves by it: to the place
    at the other end, or to the end of a stub. ``faces``: those of a planar map, each as the
    gateways that its walk leaves by, the face on their right; ``outer``: the number of the outer
    one. ``crossing``: of another map the links that are not in the planar part.
    """

    places: dict[Place, Points]
    lines: dict[Gateway, Points]
    faces: list[list[Gateway]]
    outer: int
    crossing: list[tuple[Gateway, Gateway]]

    def outline(self, face: list[Gateway]) -> Points:
        """The line round a face."""
        return np.concatenate([self.lines[gateway][:-1] for gateway in face])


def layout(world: TopologicalMap, ahead: Gateway | None = None, steps: int = STEPS) -> Layout:
    """A drawing of a connected map. ``ahead`` is a gateway that is left to the right of the
    picture (else the first one); fewer ``steps`` do for a small picture."""
    part = planar_part(world)
    lines = _by_compass(part) if part is world else None
    if lines is None:
        lines = _bent(*routed(part, lacking(part, world)), steps)
    return _layout(world, part, lines, ahead)


def straight(world: TopologicalMap, ahead: Gateway | None = None) -> Layout | None:
    """A drawing by the compass, if there is one; of the links that are not in the planar part
    only the beginning and the end, as stubs."""
    part = planar_part(world)
    lines = _by_compass(part)
    return None if lines is None else _layout(world, part, lines, ahead)


def _layout(
    world: TopologicalMap,
    part: TopologicalMap,
    lines: Mapping[Gateway, Points],
    ahead: Gateway | None,
) -> Layout:
    """The drawing, turned so that ``ahead`` leads to the right."""
    crossing = lacking(part, world)
    faces, outer = ([], -1) if crossing else faces_of(world)
    first = ahead or next(world.gateways(), None)
    if first is None:
        return Layout({place: np.zeros(2) for place in world.stars}, {}, faces, outer, [])
    x, y = lines[first][1] - lines[first][0]
    turn = np.array([[x, -y], [y, x]]) / np.hypot(x, y)
    lines = {gateway: line @ turn for gateway, line in lines.items()}
    places = {place: line[0] for (place, _), line in lines.items()}
    return Layout(places, lines, faces, outer, crossing)


def planar_part(world: TopologicalMap) -> TopologicalMap:
    """The map with links enough to be connected, and all further ones that leave it planar.
    Which these are depends on the order of the links; of some orders the one by which the
    rest cross the fewest links counts."""
    if not world.genus():
        return world
    draws = (random.Random(seed) for seed in range(ORDERS))
    parts = (_planar(world, draw.sample(world.edges(), len(world.edges()))) for draw in draws)

    def crossed(part: TopologicalMap) -> tuple[int, int]:
        return len(routed(part, lacking(part, world))[1]), -len(part.links)

    return min(parts, key=crossed)


def lacking(part: TopologicalMap, world: TopologicalMap) -> list[tuple[Gateway, Gateway]]:
    """The links of a map that a part of it lacks."""
    return [(out, end) for out, end in world.edges() if out not in part.links]


def _planar(world: TopologicalMap, edges: list[tuple[Gateway, Gateway]]) -> TopologicalMap:
    """The planar part by the links in this order."""
    part = TopologicalMap(world.slots, world.stars, {}, world.landmarks)
    joined = nx.utils.UnionFind(world.stars)
    tree: list[tuple[Gateway, Gateway]] = []
    others: list[tuple[Gateway, Gateway]] = []
    for link in edges:
        (p, _), (q, _) = link
        (others if joined[p] == joined[q] else tree).append(link)
        joined.union(p, q)
    for out, end in tree + others:
        links = {**part.links, out: end, end: out}
        more = TopologicalMap(world.slots, world.stars, links, world.landmarks)
        if (out, end) in tree or more.genus() == 0:
            part = more
    return part


def routed(
    part: TopologicalMap, further: Sequence[tuple[Gateway, Gateway]]
) -> tuple[TopologicalMap, list[Place]]:
    """A map of genus 0 that has the further links as well, and of it the places that are not
    the map's: each is where a further link crosses a link, and straight through it go both.
    A link is led through as few faces as can be, one after the other."""
    stars, links = dict(part.stars), dict(part.links)
    half = part.slots // 2
    right, left = max(1, half // 2), half + max(1, half // 2)
    crossings: list[Place] = []
    for out, end in further:
        at = out
        for gateway in _crossed(TopologicalMap(part.slots, stars, links), out, end):
            back = links[gateway]
            crossings.append(place := f"x{len(crossings)}")
            stars[place] = frozenset([0, right, half, left])
            for a, b in (gateway, (place, half)), ((place, 0), back), (at, (place, right)):
                links[a], links[b] = b, a
            at = place, left
        links[at], links[end] = end, at
    return TopologicalMap(part.slots, stars, links, part.landmarks), crossings


def _crossed(world: TopologicalMap, out: Gateway, end: Gateway) -> list[Gateway]:
    """The links that a line between two pending gateways crosses, from their right to their
    left: as few as can be."""
    face = {gateway: n for n, walk in enumerate(world.faces()) for gateway in walk}
    beside: dict[int, list[Gateway]] = defaultdict(list)
    for gateway, number in face.items():
        beside[number].append(gateway)

    def lies(gateway: Gateway) -> int:
        place, slot = gateway
        while (place, slot) not in world.links:
            slot = (slot - 1) % world.slots
        return face[place, slot]

    lines: dict[int, list[Gateway]] = {lies(out): []}
    for number in (waiting := list(lines)):
        for gateway in beside[number]:
            over = face[world.links[gateway]]
            if over not in lines:
                lines[over] = [*lines[number], gateway]
                waiting.append(over)
    return lines[lies(end)]


def compass(world: TopologicalMap) -> tuple[dict[Place, int], bool]:
    """The direction of each place's slot 0, in slots clockwise from that of the first place,
    if links arrive as they leave; and whether that can be so for every link."""
    north = {next(iter(world.stars)): 0}
    for place in (waiting := list(north)):
        for slot in sorted(world.stars[place]):
            if (place, slot) in world.links:
                other, arrival = world.links[place, slot]
                if other not in north:
                    north[other] = (north[place] + slot + world.slots // 2 - arrival) % world.slots
                    waiting.append(other)
    fits = all(
        (north[p] + s + world.slots // 2 - north[q] - r) % world.slots == 0
        for (p, s), (q, r) in world.links.items()
    )
    return north, fits


def faces_of(world: TopologicalMap) -> tuple[list[list[Gateway]], int]:
    """The faces, and which is the outer one: that whose walk turns left most, at places as
    even as a compass; among equals the longest."""
    faces = world.faces()

    def turning(face: list[Gateway]) -> int:
        """To the right, in slots."""
        total = 0
        for gateway in face:
            _, arrival = world.links[gateway]
            _, leaving = world.next(gateway)
            total += world.slots // 2 - (arrival - leaving - 1) % world.slots - 1
        return total

    return faces, min(range(len(faces)), key=lambda n: (turning(faces[n]), -len(faces[n]), n))


def _direction(angle: float, slots: int) -> Points:
    """A step in a direction, in slots clockwise from the right."""
    turn = -2 * np.pi * angle / slots
    return np.array([np.cos(turn), np.sin(turn)])


def _by_compass(world: TopologicalMap) -> dict[Gateway, Points] | None:
    """Lines in the directions of the compass, as near as can be to length 1; None if they
    would bend, become short, meet or cross."""
    north, fits = compass(world)
    if not fits:
        return None
    number = {place: index for index, place in enumerate(world.stars)}
    rows, sides = [np.eye(2, 2 * len(number))[n] for n in (0, 1)], [0.0, 0.0]
    for (p, s), (q, _) in world.edges():
        along = _direction(north[p] + s, world.slots)
        for axis, length in (along, 1.0), (100 * along[::-1] * [-1, 1], 0.0):
            row = np.zeros((len(number), 2))
            row[number[q]] += axis
            row[number[p]] -= axis
            rows.append(row.ravel())
            sides.append(length)
    found = np.linalg.lstsq(np.array(rows), np.array(sides), rcond=None)[0].reshape(-1, 2)
    lines = {}
    for p, s in world.gateways():
        along, here = _direction(north[p] + s, world.slots), found[number[p]]
        end = here + STUB * along
        if (p, s) in world.links:
            end = found[number[world.links[p, s][0]]]
            if (end - here) @ along < SHORTEST or np.linalg.norm(
                (end - here) - (end - here) @ along * along
            ) > 0.01 * SHORTEST:
                return None
        lines[p, s] = np.array([here, end])
    return None if _meet(world, lines) else lines


def _meet(world: TopologicalMap, lines: Mapping[Gateway, Points]) -> bool:
    """Whether straight lines meet elsewhere than at their places."""
    once = [g for g in lines if g not in world.links or g < world.links[g]]
    ends = [{g[0], world.links[g][0]} if g in world.links else {g[0]} for g in once]
    a, b = (np.array([lines[g][n] for g in once]) for n in (0, 1))
    for n in range(len(once)):
        # The distance of each line's ends from this line, and the other way round.
        near = _distance(a[n + 1 :], a[n], b[n]), _distance(b[n + 1 :], a[n], b[n])
        other = _distance(a[n], a[n + 1 :], b[n + 1 :]), _distance(b[n], a[n + 1 :], b[n + 1 :])
        least = np.min([*near, *other], axis=0)
        side = [_cross(b[n] - a[n], p[n + 1 :] - a[n]) for p in (a, b)]
        over = [_cross(b[n + 1 :] - a[n + 1 :], p[n] - a[n + 1 :]) for p in (a, b)]
        crossed = (side[0] * side[1] < 0) & (over[0] * over[1] < 0)
        apart = np.array([not ends[n] & ends[m] for m in range(n + 1, len(once))], dtype=bool)
        if (apart & (crossed | (least < 0.05))).any():
            return True
    return False


def _cross(u: Points, v: Points) -> Points:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def _distance(p: Points, a: Points, b: Points) -> Points:
    """Of points from line segments."""
    along = ((p - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
    return np.asarray(np.linalg.norm(p - a - np.clip(along, 0, 1)[..., None] * (b - a), axis=-1))


class _Mesh:
    """Points by number: places, ends and bends of lines, then those that are not drawn; and the
    triangles between them, counter-clockwise. ``rim`` are the points of the outline, fixed on a
    circle."""

    def __init__(self, world: TopologicalMap, crossings: list[Place]) -> None:
        self.world, self.crossings = world, crossings
        faces, outer = faces_of(world)
        self.size = 0
        self.place = {place: self._point() for place in world.stars}
        self.lines: dict[Gateway, list[int]] = {}
        for gateway in world.gateways():
            end = world.links.get(gateway)
            start = self.place[gateway[0]]
            if end is None:
                self.lines[gateway] = [start, self._point()]
            elif gateway not in self.lines:
                inner = 1 if {gateway[0], end[0]} & set(crossings) else BENDS
                line = [start, *(self._point() for _ in range(inner)), self.place[end[0]]]
                self.lines[gateway], self.lines[end] = line, line[::-1]
        triangles = []
        self.walks = [self._walk(face) for face in faces]
        for number, walk in enumerate(self.walks):
            ring = [self._point() for _ in walk]
            if number == outer:
                rim = self.rim = [self._point() for _ in walk]
            else:
                rim = [self._point()] * len(walk)
            for n in range(len(walk)):
                m = (n + 1) % len(walk)
                triangles += [(walk[n], ring[n], walk[m]), (walk[m], ring[n], ring[m])]
                triangles.append((ring[n], rim[n], ring[m]))
                if number == outer:
                    triangles.append((rim[n], rim[m], ring[m]))
        self.triangles: Numbers = np.array(triangles)

    def _point(self) -> int:
        self.size += 1
        return self.size - 1

    def _walk(self, face: list[Gateway]) -> list[int]:
        """The points round a face, with the stubs in it; the face on the right."""
        world = self.world
        found: list[int] = []
        if not face:
            (place,) = world.stars
            for slot in sorted(world.stars[place], reverse=True):
                found += self.lines[place, slot]
        for gateway in face:
            found += self.lines[gateway][:-1]
            place, slot = world.links[gateway]
            _, leaving = world.next(gateway)
            while (slot := (slot - 1) % world.slots) != leaving:
                if slot in world.stars[place]:
                    found += self.lines[place, slot]
        return found

    def start(self) -> Points:
        """A drawing in which no triangle is folded, with the rim on a circle: each other point is
        the mean of its neighbours by the weights (Floater, Mean value coordinates, 2003) that
        it has in a drawing on a grid, where nothing is too small for the numbers to hold."""
        points = self._on_a_grid()
        entries: list[tuple[Numbers, Numbers, Points]] = []
        for corners in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
            a, b, c = self.triangles[:, corners].T
            u, v = points[b] - points[a], points[c] - points[a]
            half = np.tan(np.arctan2(_cross(u, v), (u * v).sum(1)) / 2)
            entries += [(a, b, half / np.linalg.norm(u, axis=1))]
            entries += [(a, c, half / np.linalg.norm(v, axis=1))]
        rows, columns, weights = (np.concatenate(part) for part in zip(*entries, strict=True))
        pull = sparse.coo_matrix((weights, (rows, columns)), (self.size, self.size)).tocsr()
        number = len(self.world.stars)
        radius = 2 + 1.5 * number**0.5 + 0.12 * number
        turn = 2 * np.pi * np.arange(len(self.rim)) / len(self.rim)
        points[self.rim] = radius * np.stack([np.cos(turn), np.sin(turn)], 1)
        free = np.setdiff1d(np.arange(self.size), self.rim)
        total = sparse.diags(np.asarray(pull.sum(1)).ravel()[free])
        fixed = pull[free][:, self.rim] @ points[self.rim]
        points[free] = linalg.spsolve((total - pull[free][:, free]).tocsc(), fixed)
        return points

    def _on_a_grid(self) -> Points:
        """A drawing of the mesh with whole numbers as coordinates (Chrobak and Payne 1995)."""
        follows: dict[int, dict[int, int]] = {point: {} for point in range(self.size)}
        for corners in self.triangles.tolist():
            for n in range(3):
                here, right, left = corners[n:] + corners[:n]
                follows[here][right] = left
        around = {}
        for point, left_of in follows.items():
            first = min(set(left_of) - set(left_of.values()), default=min(left_of))
            order = [first]
            while (following := left_of.get(order[-1], first)) != first:
                order.append(following)
            around[point] = order[::-1]
        embedding: nx.PlanarEmbedding[int] = nx.PlanarEmbedding()
        embedding.set_data(around)
        found = nx.combinatorial_embedding_to_pos(embedding)
        return np.array([found[point] for point in range(self.size)], float)


class _Shape:
    """How far a drawing is from a good one, in energy, and how each point would lessen it.

    Links are springs of length 1, stiff against bending; the gateways of a place are
    drawn to an even compass, which may turn; places keep apart. Each triangle resists
    the more, the flatter it is, by ``weight``."""

    LENGTH, BEND, COMPASS, APART = 1.0, 8.0, 1.5, 4.0
    NEAR = 0.9, 0.6, 0.4  # to a place: a place, a crossing, another point of a line

    def __init__(self, mesh: _Mesh) -> None:
        world = mesh.world
        self.triangles = mesh.triangles.T
        self.size, self.places = mesh.size, len(world.stars) - len(mesh.crossings)
        self.slots = world.slots
        bends: list[tuple[int, ...]] = []
        sides: list[tuple[float, ...]]
        sides = [(*mesh.lines[gateway][:2], STUB) for gateway in world.pending()]
        for gateway, _ in world.edges():
            line = mesh.lines[gateway]
            whole = 1.0 if len(line) == BENDS + 2 else PIECE
            sides += [(a, b, whole / (len(line) - 1)) for a, b in pairwise(line)]
            bends += list(zip(line, line[1:], line[2:], strict=False))
        for place in mesh.crossings:
            for slot in sorted(world.stars[place])[:2]:
                a, b = (mesh.lines[end] for end in ((place, slot), world.opposite((place, slot))))
                bends.append((a[1], a[0], b[1]))
        self.sides = np.array([side[:2] for side in sides], int).reshape(-1, 2).T
        self.lengths = np.array([side[2] for side in sides])
        self.bends = np.array(bends).reshape(-1, 3).T
        real = [gateway for gateway in world.gateways() if gateway[0] not in mesh.crossings]
        starts = [(mesh.place[p], mesh.lines[p, s][1], s) for p, s in real]
        self.gateways = np.array(starts).T
        own = {(p, q) for line in mesh.lines.values() for p in line for q in line}
        pairs = {(p, q) for walk in mesh.walks for p in walk for q in walk if p < q}
        pairs = {pair for pair in pairs if pair[0] < self.places} - own
        pairs |= set(combinations(range(len(world.stars)), 2))
        self.pairs = np.array(sorted(pairs)).reshape(-1, 2).T
        kinds = [self.pairs[1] < self.places, self.pairs[1] < len(world.stars)]
        self.near = np.select(kinds, self.NEAR[:2], self.NEAR[2])

    def norths(self, points: Points) -> Points:
        """The direction of each place's slot 0 that fits its gateways best, in radians."""
        place, end, slot = self.gateways
        out = points[end] - points[place]
        turned = np.arctan2(out[:, 1], out[:, 0]) + 2 * np.pi * slot / self.slots
        x, y = (np.bincount(place, f(turned), self.places) for f in (np.cos, np.sin))
        return np.arctan2(y, x)

    def __call__(
        self, points: Points, norths: Points, weight: float
    ) -> tuple[float, Points, Points]:
        """The energy, and its slope by point and by north; infinite if a triangle is folded."""
        total = 0.0
        moved: list[tuple[Numbers, Points]] = []
        a, b, c = self.triangles
        u, v = points[b] - points[a], points[c] - points[a]
        w, area = v - u, _cross(u, v)
        squares = (u**2 + v**2 + w**2).sum(1)
        if area.min() <= 0:
            return np.inf, points, norths
        total += weight * (np.log(squares) - np.log(area)).sum()
        by_area, by_squares = -weight / area[:, None], 2 * weight / squares[:, None]
        at_b = by_area * np.stack([v[:, 1], -v[:, 0]], 1) + by_squares * (u - w)
        at_c = by_area * np.stack([-u[:, 1], u[:, 0]], 1) + by_squares * (v + w)
        moved += [(b, at_b), (c, at_c), (a, -at_b - at_c)]

        a, b = self.sides
        side = points[b] - points[a]
        length = np.linalg.norm(side, axis=1)
        stretch = length / self.lengths - 1
        total += self.LENGTH * (self.lengths * stretch**2).sum()
        pull = (2 * self.LENGTH * stretch / length)[:, None] * side
        moved += [(b, pull), (a, -pull)]

        a, b, c = self.bends
        bend = points[a] - 2 * points[b] + points[c]
        total += self.BEND * (bend**2).sum()
        moved += [(a, 2 * self.BEND * bend), (b, -4 * self.BEND * bend), (c, 2 * self.BEND * bend)]

        a, b, slot = self.gateways
        angle = norths[a] - 2 * np.pi * slot / self.slots
        wish = np.stack([np.cos(angle), np.sin(angle)], 1)
        side = points[b] - points[a]
        length = np.linalg.norm(side, axis=1)
        cosine = (side * wish).sum(1) / length
        total += self.COMPASS * (1 - cosine).sum()
        pull = self.COMPASS * ((cosine / length**2)[:, None] * side - wish / length[:, None])
        moved += [(b, pull), (a, -pull)]
        turned = np.bincount(a, self.COMPASS * _cross(side, wish) / length, self.places)

        a, b = self.pairs
        side = points[b] - points[a]
        length = np.linalg.norm(side, axis=1)
        lack = np.maximum(0, self.near - length)
        total += self.APART * (lack**2).sum()
        pull = (-2 * self.APART * lack / length)[:, None] * side
        moved += [(b, pull), (a, -pull)]

        number = np.concatenate([number for number, _ in moved])
        force = np.concatenate([force for _, force in moved])
        slopes = [np.bincount(number, force[:, axis], self.size) for axis in (0, 1)]
        return float(total), np.stack(slopes, 1), np.asarray(turned, float)


def _bent(world: TopologicalMap, crossings: list[Place], steps: int) -> dict[Gateway, Points]:
    """Lines with bends, in a drawing in which no triangle of the mesh is folded; they go on
    straight through the crossings."""
    mesh = _Mesh(world, crossings)
    shape = _Shape(mesh)
    points = mesh.start()
    free = np.setdiff1d(np.arange(mesh.size), mesh.rim)

    def drawing(x: Points) -> Points:
        points[free] = x[: 2 * len(free)].reshape(-1, 2)
        return points

    def energy(weight: float) -> Callable[[Points], tuple[float, Points]]:
        def at(x: Points) -> tuple[float, Points]:
            total, slope, turned = shape(drawing(x), x[2 * len(free) :], weight)
            return total, np.concatenate([slope[free].ravel(), turned])

        return at

    x = np.concatenate([points[free].ravel(), shape.norths(points)])
    for weight in WEIGHTS:
        x = _descend(energy(weight), x, steps)
    points = drawing(x)
    lines = {}
    for start in world.gateways():
        if start[0] not in crossings:
            gateway, line = start, mesh.lines[start]
            while (end := world.links.get(gateway)) and end[0] in crossings:
                gateway = world.opposite(end)
                line = line + mesh.lines[gateway][1:]
            lines[start] = points[line]
    return lines


def _descend(energy: Callable[[Points], tuple[float, Points]], x: Points, steps: int) -> Points:
    """A point of less energy, by L-BFGS (Nocedal 1980). Unlike that of a library its steps
    only ever go to where the energy is finite, so that what was never folded is not."""
    value, slope = energy(x)
    past: deque[tuple[Points, Points]] = deque(maxlen=MEMORY)
    idle = 0
    for _ in range(steps):
        step = -slope
        factors = []
        for s, y in reversed(past):
            factors.append((s @ step) / (s @ y))
            step = step - factors[-1] * y
        if past:
            s, y = past[-1]
            step = step * (s @ y) / (y @ y)
        for s, y in past:
            step = step + (factors.pop() - (y @ step) / (s @ y)) * s
        if not past or step @ slope >= 0:
            past.clear()
            step = -slope * 0.01 / np.abs(slope).max()
        length = 1.0
        while True:
            new, new_slope = energy(x + length * step)
            if new <= value + 1e-4 * length * (step @ slope):
                break
            length /= 2
            if length < 1e-12:
                return x
        s, y = length * step, new_slope - slope
        if s @ y > 1e-12:
            past.append((s, y))
        idle = 0 if value - new > 1e-6 * (1 + abs(value)) else idle + 1
        x, value, slope = x + s, new, new_slope
        if idle > 3:
            break
    return x
