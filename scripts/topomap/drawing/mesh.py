"""The mesh of a drawing with bent lines, of a map of genus 0: triangles between the places, the
bends of links, and in each face a ring of corners round a centre. It starts on a grid, where no
triangle is folded."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import linalg

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx
from topomap.runtime.watch import Late, never

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
BENDS = 5  # inner points of a link that is not straight
PASSING = 3  # of a piece of one that goes to a crossing


class TooLong(Exception):
    """A better drawing would take too long; the plain one is taken."""


def faces_of(world: TopologicalMap) -> tuple[list[list[Gateway]], int]:
    """The faces, and which is the outer one: that whose walk turns left most, at places as
    even as a compass; among equals the longest."""
    faces, half = world.faces(), world.slots // 2

    def turning(face: list[Gateway]) -> int:
        """To the right, in slots."""
        total = 0
        for place, slot in face:
            end, arrival = world.links[place, slot]
            _, leaving = world.next((place, slot))
            total += half - (arrival - leaving - 1) % world.slots - 1
            if end == place:  # a loop turns by itself, round the lesser angle
                between = (arrival - slot) % world.slots
                right = between < half or (between == half and slot < arrival)
                total += half + between if right else between - world.slots - half
        return total

    return faces, min(range(len(faces)), key=lambda n: (turning(faces[n]), -len(faces[n]), n))


def cross(u: Points, v: Points) -> Points:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


class Mesh:
    """Points by number: places, ends and bends of lines, then those that are not drawn; and the
    triangles between them, counter-clockwise. ``rim`` are the points of the outline, fixed on a
    circle. A ``fine`` mesh has so many times as many bends."""

    def __init__(self, world: TopologicalMap, crossings: list[Place], fine: int = 1) -> None:
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
                inner = fine * (PASSING if {gateway[0], end[0]} & set(crossings) else BENDS)
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

    def start(self, late: Late = never) -> Points:
        """A drawing in which no triangle is folded, with the rim on a circle: each other point is
        the mean of its neighbours by the weights (Floater, Mean value coordinates, 2003) that
        it has in a drawing on a grid, where nothing is too small for the numbers to hold. Raises
        TooLong when it is late."""
        points = self._on_a_grid(late)
        if late():
            raise TooLong
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

    def _on_a_grid(self, late: Late) -> Points:
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
        if late():
            raise TooLong
        embedding: nx.PlanarEmbedding[int] = nx.PlanarEmbedding()
        embedding.set_data(around)
        found = nx.combinatorial_embedding_to_pos(embedding)
        return np.array([found[point] for point in range(self.size)], float)
