"""Drawings with bent lines, of maps of genus 0.

A drawing is a mesh of triangles: places, bends of links, and in each face a ring of corners round
a centre. It starts from a drawing on a grid, in which no triangle is folded, and is bent towards
a good shape by steps that fold none, so nothing comes to cross and every rotation stays right.
"""

from collections import deque
from collections.abc import Callable
from itertools import combinations, pairwise

import networkx as nx
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import linalg

from topomap.topology import Gateway, Place, TopologicalMap

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
STUB = 0.36  # the length of a stub, where a link is of length 1
BENDS = 3  # inner points of a link that is not straight
PIECE = 0.7  # the length of a link's piece up to a crossing
MEMORY = 20  # steps that the descent remembers
WEIGHTS = 100.0, 10.0, 1.0, 0.1, 0.01, 0.002  # of the triangles, one after the other
STEPS = 1500  # of the descent, at most, with each weight


def bent(world: TopologicalMap, crossings: list[Place], steps: int) -> dict[Gateway, Points]:
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


def cross(u: Points, v: Points) -> Points:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


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
            half = np.tan(np.arctan2(cross(u, v), (u * v).sum(1)) / 2)
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
        w, area = v - u, cross(u, v)
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
        turned = np.bincount(a, self.COMPASS * cross(side, wish) / length, self.places)

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
