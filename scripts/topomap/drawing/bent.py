"""Drawings with bent lines, of maps of genus 0.

A drawing is a mesh of triangles: places, bends of links, and in each face a ring of corners round
a centre. It starts from a drawing on a grid, in which no triangle is folded, and is bent towards
a good shape by steps that fold none, so nothing comes to cross and every rotation stays right.
"""

from collections import defaultdict
from collections.abc import Sequence
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import linalg

from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime import nx

Points = NDArray[np.float64]
Numbers = NDArray[np.int64]
# Terms f(y) of an energy, where y depends on some of the numbers x: which these are, dy/dx of each
# of them, f'(y), and f''(y) or 0 if that is negative. A column for each of the terms of a kind.
Term = tuple[Numbers, Points, Points, Points]
STUB = 0.36  # the length of a stub, where a link is of length 1
FIRST = 0.22  # the length of a link's piece at a place
LEAVING = 0.16  # what that must be, and of a stub, to be seen outside the place's circle
BENDS = 5  # inner points of a link that is not straight
PIECE, LOOP = 0.7, 1.6  # the lengths of a link's piece up to a crossing, and of a loop
# How much triangles resist, and how much places and lines keep apart, one after the other; what is
# stuck where triangles are flat comes free when they resist more again.
STAGES = (
    (1.0, 1.0),
    (0.1, 4.0),
    (0.01, 10.0),
    (1.0, 4.0),
    (0.1, 10.0),
    (0.01, 40.0),
    (0.1, 40.0),
    (0.01, 40.0),
    (0.002, 40.0),
)
ANEW = (100.0, 0.0), (10.0, 0.0)  # before these, if the drawing is not legible
AGAIN = 2  # times at most, and not in fewer steps
STEPS = 120  # of the descent, at most, with each weight
LITTLE = 1e-9  # stiffness that leaves none without any


def bent(world: TopologicalMap, crossings: list[Place], steps: int) -> dict[Gateway, Points]:
    """Lines with bends, in a drawing in which no triangle of the mesh is folded; they go on
    straight through the crossings."""
    mesh = _Mesh(world, crossings)
    shape = _Shape(mesh)
    points = mesh.start()
    x = np.concatenate([points.ravel(), shape.norths(points)])
    rim = np.concatenate([2 * np.array(mesh.rim), 2 * np.array(mesh.rim) + 1])
    free = np.setdiff1d(np.arange(len(x)), rim)
    for again in range(AGAIN + 1 if steps >= STEPS else 1):
        for shape.weight, shape.apart in ANEW * (again > 0) + STAGES:
            x = _descend(shape, x, free, steps)
        if shape.legible(x):
            break
    points = x[: 2 * mesh.size].reshape(-1, 2)
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
                inner = 2 if {gateway[0], end[0]} & set(crossings) else BENDS
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
    """How far a drawing is from a good one, in energy, and how each number of it would lessen it.

    Links are springs of length 1, stiff against bending; the gateways of a place are drawn to an
    even compass, which may turn; places keep apart. Each triangle resists the more, the flatter
    it is, by ``weight``. The numbers are the coordinates of the points, then the norths: the
    direction of each place's slot 0, in radians.
    """

    STRETCH, SQUEEZE, BEND, LOOP, COMPASS = 0.5, 2.0, 27.0, 0.3, 3.0
    # Places to each other, a crossing to either, a place to a line, and two lines.
    NEAR = 0.9, 0.6, 0.4, 0.25
    FIRM = 10.0  # times as firm as other pieces: where lines leave
    LEAST = 0.1  # of the compass's stiffness, where a gateway is far from its direction

    def __init__(self, mesh: _Mesh) -> None:
        world = mesh.world
        self.weight, self.apart = STAGES[0]
        self.triangles = mesh.triangles.T
        self.size, self.places = mesh.size, len(world.stars) - len(mesh.crossings)
        self.slots = world.slots
        bends: list[tuple[int, ...]] = []
        sides: list[tuple[float, ...]]
        sides = [(*mesh.lines[gateway][:2], STUB) for gateway in world.pending()]
        lines = [line for line in mesh.lines.values() if len(line) > 2]
        lines.sort(key=lambda line: line[0] >= self.places)  # those that leave crossings last
        sides += [(*line[:2], FIRST) for line in lines]
        firm = sum(side[0] < self.places for side in sides)
        for gateway, _ in world.edges():
            line = mesh.lines[gateway]
            weak = line[0] == line[-1]  # a loop cannot but bend
            whole = LOOP if weak else 1.0 if len(line) == BENDS + 2 else PIECE
            rest = (whole - 2 * FIRST) / (len(line) - 3)
            sides += [(a, b, rest) for a, b in pairwise(line[1:-1])]
            bends += [(*three, weak) for three in zip(line, line[1:], line[2:], strict=False)]
        for place in mesh.crossings:
            for slot in sorted(world.stars[place])[:2]:
                a, b = (mesh.lines[end] for end in ((place, slot), world.opposite((place, slot))))
                bends.append((a[1], a[0], b[1], False))
        self.sides = np.array([side[:2] for side in sides], int).reshape(-1, 2).T
        self.lengths = np.array([side[2] for side in sides])
        self.firm = np.where(np.arange(len(sides)) < firm, self.FIRM, 1.0)
        self.bends = np.array([bend[:3] for bend in bends], int).reshape(-1, 3).T
        self.stiff = np.array([self.LOOP if bend[3] else self.BEND for bend in bends])
        real = [gateway for gateway in world.gateways() if gateway[0] not in mesh.crossings]
        starts = [(mesh.place[p], mesh.lines[p, s][1], s) for p, s in real]
        self.gateways = np.array(starts).T
        at = defaultdict(list)
        for line in mesh.lines.values():
            at[line[0]].append(line)
        beside: dict[int, set[int]] = defaultdict(set)  # of each point those of its lines, and
        for line in mesh.lines.values():  # where they leave a place the lines that leave it
            for point in line:
                beside[point] |= set(line)
            beside[line[1]] |= {other[1] for other in at[line[0]]}
        pairs = {(p, q) for walk in mesh.walks for p in walk for q in walk if p < q}
        pairs |= set(combinations(range(len(world.stars)), 2))
        apart = [
            pair
            for pair in sorted(pairs)
            if pair[1] < len(world.stars) or pair[1] not in beside[pair[0]]
        ]
        self.pairs = np.array(apart, int).reshape(-1, 2).T
        one, other = self.pairs
        kinds = [other < self.places, other < len(world.stars), one < self.places]
        self.near = np.select(kinds, self.NEAR[:3], self.NEAR[3])

    def norths(self, points: Points) -> Points:
        """The norths that fit the gateways best."""
        place, end, slot = self.gateways
        out = points[end] - points[place]
        turned = np.arctan2(out[:, 1], out[:, 0]) + 2 * np.pi * slot / self.slots
        x, y = (np.bincount(place, f(turned), self.places) for f in (np.cos, np.sin))
        return np.arctan2(y, x)

    def legible(self, x: Points) -> bool:
        """Whether all lines leave their places, and no places lie on each other."""
        points = x[: 2 * self.size].reshape(-1, 2)
        a, b = self.sides[:, self.firm > 1]
        c, d = self.pairs[:, self.pairs[1] < self.places]
        leaving, apart = (
            np.linalg.norm(points[q] - points[p], axis=1) for p, q in ((a, b), (c, d))
        )
        return bool((leaving > LEAVING).all() and (apart > STUB).all())

    def reach(self, x: Points, step: Points) -> float:
        """How much of a step goes until a triangle is folded."""
        points, moves = (z[: 2 * self.size].reshape(-1, 2) for z in (x, step))
        a, b, c = self.triangles
        u, v, du, dv = (
            points[b] - points[a],
            points[c] - points[a],
            moves[b] - moves[a],
            moves[c] - moves[a],
        )
        # Their areas are area + t * (grow + t * bend): the first positive root in t.
        area, grow, bend = cross(u, v), cross(u, dv) + cross(du, v), cross(du, dv)
        root = np.sqrt(np.maximum(0, grow**2 - 4 * area * bend))
        real = grow**2 >= 4 * area * bend
        below = np.where(grow < 0, root - grow, -root - grow)  # that of the two which cannot cancel
        with np.errstate(divide="ignore", invalid="ignore"):
            roots = np.stack([2 * area / below, below / (2 * bend)])
        roots = roots[:, real]
        return float(np.min(roots[roots > 0], initial=np.inf))

    def __call__(self, x: Points) -> tuple[float, list[Term]]:
        """The energy, infinite if a triangle is folded, and its terms."""
        weight = self.weight
        points, norths = x[: 2 * self.size].reshape(-1, 2), x[2 * self.size :]
        total = 0.0
        terms: list[Term] = []

        def add(
            numbers: Sequence[Numbers], ways: Sequence[Points], pull: Points, stiff: Any
        ) -> None:
            columns = np.concatenate([np.stack([2 * n, 2 * n + 1]) for n in numbers])
            terms.append((columns, np.hstack(ways).T, pull, np.broadcast_to(stiff, pull.shape)))

        a, b, c = self.triangles
        u, v = points[b] - points[a], points[c] - points[a]
        area = cross(u, v)
        if area.min() <= 0:
            return np.inf, []
        squares = (u**2 + v**2 + (v - u) ** 2).sum(1)
        total += weight * (np.log(squares) - np.log(area)).sum()
        at_b = np.stack([v[:, 1], -v[:, 0]], 1) / area[:, None]
        at_c = np.stack([-u[:, 1], u[:, 0]], 1) / area[:, None]
        every = np.full(len(area), weight)
        add([a, b, c], [-at_b - at_c, at_b, at_c], -every, weight)
        for start, end, side in (a, b, u), (a, c, v), (b, c, v - u):
            for axis in np.eye(2):
                along = np.tile(axis, (len(side), 1))
                add(
                    [start, end],
                    [-along, along],
                    2 * weight * side @ axis / squares,
                    2 * weight / squares,
                )

        a, b = self.sides
        along, length = _unit(points[b] - points[a])
        stretch = length / self.lengths - 1
        force = np.where(stretch > 0, self.STRETCH, self.SQUEEZE) * self.firm
        total += (force * self.lengths * stretch**2).sum()
        add([a, b], [-along, along], 2 * force * stretch, 2 * force / self.lengths)
        aside = np.stack([-along[:, 1], along[:, 0]], 1)
        stiff = 2 * force * np.maximum(0, stretch) / length
        add([a, b], [-aside, aside], 0 * stretch, stiff)

        a, b, c = self.bends
        bend = points[a] - 2 * points[b] + points[c]
        total += (self.stiff * (bend**2).sum(1)).sum()
        for axis in np.eye(2):
            along = np.tile(axis, (len(bend), 1))
            add(
                [a, b, c],
                [along, -2 * along, along],
                2 * self.stiff * (bend @ axis),
                2 * self.stiff,
            )

        a, b = self.pairs
        side = points[b] - points[a]
        close = (side**2).sum(1) < self.near**2
        a, b = a[close], b[close]
        along, length = _unit(side[close])
        lack = self.near[close] - length
        total += self.apart * (lack**2).sum()
        add([a, b], [-along, along], -2 * self.apart * lack, 2 * self.apart)

        a, b, slot = self.gateways
        along, length = _unit(points[b] - points[a])
        aside = np.stack([-along[:, 1], along[:, 0]], 1) / length[:, None]
        off = np.arctan2(along[:, 1], along[:, 0]) - norths[a] + 2 * np.pi * slot / self.slots
        total += self.COMPASS * (1 - np.cos(off)).sum()
        stiff = self.COMPASS * np.maximum(np.cos(off), self.LEAST)
        add([a, b], [-aside, aside], self.COMPASS * np.sin(off), stiff)
        columns, ways, pull, stiff = terms.pop()
        columns = np.concatenate([columns, 2 * self.size + a[None]])
        terms.append((columns, np.vstack([ways, -np.ones(len(a))]), pull, stiff))
        return float(total), terms


def _unit(side: Points) -> tuple[Points, Points]:
    """Directions, and lengths."""
    length = np.linalg.norm(side, axis=1)
    return side / length[:, None], length


def _descend(shape: _Shape, x: Points, free: Numbers, steps: int) -> Points:
    """Numbers of less energy, by Newton's method, the free ones changed. The curvature of each
    term is taken for no less than nothing; steps go only to where the energy is finite, so that
    what was never folded is not."""
    number = np.full(len(x), -1)
    number[free] = np.arange(len(free))
    value, terms = shape(x)
    idle = 0
    for _ in range(steps):
        slope, curvature = _system(terms, number, len(free))
        step = np.zeros(len(x))
        step[free] = linalg.splu(curvature, "MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(
            -slope
        )
        gain = slope @ step[free]
        length = min(1.0, 0.9 * shape.reach(x, step))
        while (new := shape(x + length * step))[0] > value + 1e-4 * length * gain:
            length /= 2
            if length < 1e-10:
                return x
        idle = idle + 1 if value - new[0] < 1e-4 * (1 + abs(value)) else 0
        x = x + length * step
        value, terms = new
        if idle > 9:
            break
    return x


def _system(terms: list[Term], number: Numbers, size: int) -> tuple[Points, Any]:
    """The slope of the energy by the numbers, and its curvature, a matrix."""
    pull, stiff = (np.concatenate([term[n] for term in terms]) for n in (2, 3))
    ends = np.cumsum([len(term[2]) for term in terms])
    rows = [
        np.tile(np.arange(end - len(p), end), len(of))
        for end, (of, _, p, _) in zip(ends, terms, strict=True)
    ]
    row = np.concatenate(rows)
    column = np.concatenate([number[of].ravel() for of, *_ in terms])
    entry = np.concatenate([ways.ravel() for _, ways, *_ in terms])
    kept = column >= 0
    by = sparse.csr_matrix((entry[kept], (row[kept], column[kept])), (len(pull), size))
    curvature = by.T @ sparse.diags(stiff) @ by + LITTLE * sparse.identity(size)
    return by.T @ pull, curvature.tocsc()
