"""What a good drawing with bent lines is: the energy of springs along the lines of a mesh, of
triangles that must not fold, and of places that keep apart."""

from collections import defaultdict
from collections.abc import Sequence
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from topomap.drawing.mesh import BENDS, Mesh, Numbers, Points, cross

# Terms f(y) of an energy, where y depends on some of the numbers x: which these are, dy/dx of each
# of them, f'(y), and f''(y) or 0 if that is negative. A column for each of the terms of a kind.
Term = tuple[Numbers, Points, Points, Points]
STUB = 0.36  # the length of a stub, where a link is of length 1
FIRST = 0.22  # the length of a link's piece at a place
LEAVING = 0.16  # what that must be, and of a stub, to be seen outside the place's circle
PIECE, LOOP = 0.7, 1.6  # the lengths of a link's piece up to a crossing, and of a loop


class Springs:
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

    def __init__(self, mesh: Mesh) -> None:
        world = mesh.world
        self.weight = self.apart = 1.0
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
