"""The mesh of a drawing with bent lines, of a map of genus 0.

It consists of triangles between the places, the bends of links, and in each face a ring of corners
round a centre. It starts on a grid, where no triangle is folded.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import linalg

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx
from topomap.runtime.watch import Late, never

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
BENDS = 5  # the number of inner points of a link that is not straight
ROUNDS = 30  # rounds in which crossings are put in the middle of their neighbours
PASSING = 3  # the number of inner points of a piece of a link up to a crossing


class TooLong(Exception):
    """A better drawing would take too long, so the plain one is taken."""


def faces_of(world: TopologicalMap) -> tuple[list[list[Gateway]], int]:
    """The faces, and which is the outer one.

    The outer face is the one whose walk turns left most, if the gateways of each place are spaced
    evenly; of equal ones it is the longest.
    """
    faces, half = world.faces(), world.slots // 2

    def turning(face: list[Gateway]) -> int:
        """How far the walk turns to the right, in slots."""
        total = 0
        for place, slot in face:
            end, arrival = world.links[place, slot]
            _, leaving = world.next((place, slot))
            total += half - (arrival - leaving - 1) % world.slots - 1
            if end == place:  # a loop turns by itself, round the smaller angle
                between = (arrival - slot) % world.slots
                right = between < half or (between == half and slot < arrival)
                total += half + between if right else between - world.slots - half
        return total

    return faces, min(range(len(faces)), key=lambda n: (turning(faces[n]), -len(faces[n]), n))


def cross(u: Points, v: Points) -> Points:
    """The cross product of two vectors."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def outer_of(outlines: Sequence[Points]) -> int:
    """Find the outer face by the outlines of faces, each walked with its face on the right.

    It is the one that is walked in the other direction than the others.
    """
    areas = [cross(line, np.roll(line, -1, axis=0)).sum() for line in outlines]
    return max(range(len(outlines)), key=lambda n: round(float(areas[n]), 9))


def _with_crossings(world: TopologicalMap, known: Mapping[Place, Points]) -> dict[Place, Points]:
    """Where places should be, and crossings, each in the middle of its neighbours."""
    found = {place: known.get(place, np.zeros(2)) for place in world.stars}
    for _ in range(ROUNDS if len(known) < len(found) else 0):
        for place in found:
            if place not in known:
                ends = [world.links[place, slot][0] for slot in world.stars[place]]
                found[place] = np.mean([found[end] for end in ends], axis=0)
    return found


class Mesh:
    """The points of a drawing, by number, and the triangles between them, counter-clockwise.

    The points are places, ends and bends of lines, and then those that are not drawn. ``rim`` has
    the points of the outline, which are fixed on a circle. A ``fine`` mesh has so many times as
    many bends. ``known`` tells where places should be, if that is known.
    """

    def __init__(
        self,
        world: TopologicalMap,
        crossings: list[Place],
        fine: int = 1,
        known: Mapping[Place, Points] | None = None,
    ) -> None:
        self.world, self.crossings = world, crossings
        faces, outer = faces_of(world)
        self.known = known and _with_crossings(world, known)
        if self.known and world.links:
            outlines = [np.array([self.known[place] for place, _ in face]) for face in faces]
            outer = outer_of(outlines)
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
        """The points around a face, with the stubs in it; the face is on the right."""
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
        """Make a drawing in which no triangle is folded, with the rim on a circle.

        Each other point is the mean of its neighbours, with the weights (Floater, Mean value
        coordinates, 2003) that it has in a drawing on a grid, in which nothing is too small for
        floating-point numbers.

        Raises:
            TooLong: It is late.
        """
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
        if self.known:
            radius = max(radius, 2 + 1.3 * max(float(np.hypot(*p)) for p in self.known.values()))
        turn = 2 * np.pi * np.arange(len(self.rim)) / len(self.rim)
        points[self.rim] = radius * np.stack([np.cos(turn), np.sin(turn)], 1)
        free = np.setdiff1d(np.arange(self.size), self.rim)
        total = sparse.diags(np.asarray(pull.sum(1)).ravel()[free])
        fixed = pull[free][:, self.rim] @ points[self.rim]
        points[free] = linalg.spsolve((total - pull[free][:, free]).tocsc(), fixed)
        return self._turned(points)

    def _turned(self, points: Points) -> Points:
        """Turn the points so that places are nearer to where they should be."""
        if not self.known:
            return points
        drawn = np.array([points[self.place[place]] for place in self.known])
        wanted = np.array([*self.known.values()])
        drawn, wanted = drawn - drawn.mean(0), wanted - wanted.mean(0)
        angle = np.arctan2(cross(drawn, wanted).sum(), (drawn * wanted).sum())
        x, y = np.cos(angle), np.sin(angle)
        return np.asarray(points @ np.array([[x, y], [-y, x]]))

    def _on_a_grid(self, late: Late) -> Points:
        """Draw the mesh with whole numbers as coordinates (Chrobak and Payne 1995)."""
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
