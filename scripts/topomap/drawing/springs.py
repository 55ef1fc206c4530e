"""What a good drawing with bent lines is, as an energy.

It has springs along the lines of a mesh, triangles that must not fold, and places that keep apart.
"""

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from topomap.drawing.mesh import Mesh, Numbers, Points, cross

# Terms f(y) of an energy, where y depends on some of the numbers x: the indices of these, dy/dx for
# each of them, f'(y), and f''(y) or 0 if that is negative. Each term of a kind has a column.
Term = tuple[Numbers, Points, Points, Points]
STUB = 0.36  # the length of a stub, if a link has length 1
FIRST = 0.22  # the length of a link's piece at a place
LEAVING = 0.16  # the least length of that, or of a stub, to be visible outside the circle
SIDES = (0, 1), (0, 2), (1, 2)  # the sides of a triangle, by its corners
SHORT = 0.6  # the least length of a link whose ends are known
PIECE, LOOP = 0.7, 1.6  # the lengths of a link's piece up to a crossing, and of a loop


class Springs:
    """The energy of a drawing, which is low if it is good, with its derivatives.

    Links are springs of length 1 that are stiff against bending. The gateways of a place are pulled
    towards an even compass, which may turn. Places keep apart. Each triangle resists more if it is
    flatter, with ``weight``. The numbers are the coordinates of the points, and then the norths:
    the direction of each place's slot 0, in radians.
    """

    STRETCH, SQUEEZE, BEND, LOOP, COMPASS = 0.5, 2.0, 27.0, 0.3, 3.0
    # Least distances: two places, a crossing and either, a place and a line, two lines.
    NEAR = 0.9, 0.6, 0.4, 0.25
    FIRM = 10.0  # the first pieces of lines are so many times as stiff as others
    ANCHOR = 2.0  # the stiffness that pulls a place to where it should be
    LEAST = 0.1  # the least share of the compass's stiffness, for gateways far off

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
        lines.sort(key=lambda line: line[0] >= self.places)  # those that leave crossings come last
        sides += [(*line[:2], FIRST) for line in lines]
        firm = sum(side[0] < self.places for side in sides)
        crossed = {mesh.place[place] for place in mesh.crossings}
        for gateway, other in world.edges():
            line = mesh.lines[gateway]
            weak = line[0] == line[-1]  # a loop must bend
            whole = LOOP if weak else PIECE if {line[0], line[-1]} & crossed else 1.0
            if mesh.known and not weak:
                far = float(np.hypot(*(mesh.known[gateway[0]] - mesh.known[other[0]])))
                whole = max(SHORT, far)
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
        self.neighbours = Neighbours(mesh, self.places, self.NEAR)
        anchors = [p for p in mesh.known or () if p not in mesh.crossings]
        self.anchors = np.array([mesh.place[place] for place in anchors], int)
        self.wanted = np.array([(mesh.known or {})[place] for place in anchors]).reshape(-1, 2)
        self.fixed = self._fixed_columns()

    def norths(self, points: Points) -> Points:
        """The norths that fit the gateways best."""
        place, end, slot = self.gateways
        out = points[end] - points[place]
        turned = np.arctan2(out[:, 1], out[:, 0]) + 2 * np.pi * slot / self.slots
        x, y = (np.bincount(place, f(turned), self.places) for f in (np.cos, np.sin))
        return np.arctan2(y, x)

    def legible(self, x: Points) -> bool:
        """Tell whether all lines leave their places, and no places lie on each other."""
        points = x[: 2 * self.size].reshape(-1, 2)
        a, b = self.sides[:, self.firm > 1]
        leaving = np.linalg.norm(points[b] - points[a], axis=1)
        together = KDTree(points[: self.places]).query_pairs(STUB)
        return bool((leaving > LEAVING).all() and not together)

    def reach(self, x: Points, step: Points) -> float:
        """The share of a step that is possible until a triangle is folded."""
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
        # The one of the two without cancellation.
        below = np.where(grow < 0, root - grow, -root - grow)
        with np.errstate(divide="ignore", invalid="ignore"):
            roots = np.stack([2 * area / below, below / (2 * bend)])
        roots = roots[:, real]
        return float(np.min(roots[roots > 0], initial=np.inf))

    def _fixed_columns(self) -> list[Numbers]:
        """The numbers on which the terms depend, except the last kind of terms.

        They are in the order in which a call gives the terms.
        """
        corners, ends = _both(*self.triangles), _both(*self.sides)
        edges = np.hstack([self.triangles[[n, m]] for n, m in SIDES])
        axes = [np.hstack([2 * numbers, 2 * numbers + 1]) for numbers in (edges, self.bends)]
        place, end, _ = self.gateways
        turning = np.vstack([_both(place, end), 2 * self.size + place[None]])
        held = [_both(self.anchors).reshape(1, -1)] if len(self.anchors) else []
        return [corners, axes[0], ends, ends, axes[1], turning, *held]

    def __call__(self, x: Points) -> tuple[float, list[Term]]:
        """The energy and its terms.

        The energy is infinite if a triangle is folded. The last terms are those of points that are
        near to each other.
        """
        weight = self.weight
        points, norths = x[: 2 * self.size].reshape(-1, 2), x[2 * self.size :]
        a, b, c = self.triangles
        u, v = points[b] - points[a], points[c] - points[a]
        area = cross(u, v)
        if not area.min() > 0:
            return np.inf, []
        shapes: list[tuple[Points, Points, Any]] = []  # everything of a term except the columns
        squares = (u**2 + v**2 + (v - u) ** 2).sum(1)
        total = weight * (np.log(squares) - np.log(area)).sum()
        at_b, at_c = np.stack([v[:, 1], -v[:, 0]]) / area, np.stack([-u[:, 1], u[:, 0]]) / area
        every = np.full(len(area), weight)
        shapes.append((np.vstack([-at_b - at_c, at_b, at_c]), -every, weight))
        sides = np.concatenate([u, v, v - u]).T.ravel()
        stiff = np.tile(2 * weight / squares, 6)
        shapes.append((_ways((-1, 1), len(sides)), stiff * sides, stiff))

        a, b = self.sides
        along, length = _unit(points[b] - points[a])
        stretch = length / self.lengths - 1
        force = np.where(stretch > 0, self.STRETCH, self.SQUEEZE) * self.firm
        total += (force * self.lengths * stretch**2).sum()
        shapes.append((_apart(along), 2 * force * stretch, 2 * force / self.lengths))
        stiff = 2 * force * np.maximum(0, stretch) / length
        shapes.append((_apart(_aside(along)), 0 * stretch, stiff))

        a, b, c = self.bends
        bend = points[a] - 2 * points[b] + points[c]
        total += (self.stiff * (bend**2).sum(1)).sum()
        stiff = np.tile(2 * self.stiff, 2)
        shapes.append((_ways((1, -2, 1), bend.size), stiff * bend.T.ravel(), stiff))

        a, b, slot = self.gateways
        along, length = _unit(points[b] - points[a])
        aside = _apart(_aside(along) / length[:, None])
        off = np.arctan2(along[:, 1], along[:, 0]) - norths[a] + 2 * np.pi * slot / self.slots
        total += self.COMPASS * (1 - np.cos(off)).sum()
        stiff = self.COMPASS * np.maximum(np.cos(off), self.LEAST)
        turning = np.vstack([aside, -np.ones(len(a))])
        shapes.append((turning, self.COMPASS * np.sin(off), stiff))
        if len(self.anchors):
            off_by = points[self.anchors] - self.wanted
            total += self.ANCHOR * (off_by**2).sum()
            pull = 2 * self.ANCHOR * np.concatenate([off_by.T[0], off_by.T[1]])
            # In the order of _both: all first coordinates of the places, then all second ones.
            shapes.append((np.ones((1, len(pull))), pull, np.full(len(pull), 2 * self.ANCHOR)))
        terms = [
            (columns, ways, pull, np.broadcast_to(stiff, pull.shape))
            for columns, (ways, pull, stiff) in zip(self.fixed, shapes, strict=True)
        ]

        a, b, near = self.neighbours(points)
        along, length = _unit(points[b] - points[a])
        lack = near - length
        total += self.apart * (lack**2).sum()
        firm = np.full(len(a), 2 * self.apart)
        terms.append((_both(a, b), _apart(along), -2 * self.apart * lack, firm))
        return float(total), terms


class Neighbours:
    """The points of a mesh that are nearer to each other than they should be.

    These are places and crossings, and points of lines with whatever else is on a walk with them,
    except what is on the same line, or leaves a place beside it. The points that are not far are
    looked for again only when some point has moved far enough.
    """

    ROOM = 0.3  # additional distance within which points count as not far

    def __init__(self, mesh: Mesh, places: int, near: tuple[float, float, float, float]) -> None:
        self.near, self.places, self.stars = near, places, len(mesh.world.stars)
        self.size = 1 + max(max(walk, default=0) for walk in mesh.walks)
        on = {(point, number) for number, walk in enumerate(mesh.walks) for point in walk}
        self.many = len(mesh.walks)
        self.on = np.array(sorted(point * self.many + number for point, number in on))
        self.walks = np.full((2, self.size), -1)  # for each point of a line
        for point, number in sorted(on):
            if point >= self.stars:
                self.walks[int(self.walks[0, point] >= 0), point] = number
        first = defaultdict(set)
        beside = set()
        for line in mesh.lines.values():
            first[line[0]].add(line[1])
            beside |= {(p, q) for p in line for q in line if p < q}
        for ends in first.values():
            beside |= {(p, q) for p in ends for q in ends if p < q}
        self.beside = np.array(sorted(p * self.size + q for p, q in beside), int)
        self.at: Points | None = None

    def __call__(self, points: Points) -> tuple[Numbers, Numbers, Points]:
        """Pairs of points, and how far apart they should be."""
        points = points[: self.size]
        if self.at is None or abs(points - self.at).max() > self.ROOM / 3:
            self.at, self.pairs, self.apart = points.copy(), *self._not_far(points)
        a, b = self.pairs
        side = points[b] - points[a]
        close = (side**2).sum(1) < self.apart**2
        return a[close], b[close], self.apart[close]

    def _not_far(self, points: Points) -> tuple[Numbers, Points]:
        stars = KDTree(points[: self.stars])
        far = self.near[0] + self.ROOM
        one, other = stars.query_pairs(far, output_type="ndarray").T
        three, four = KDTree(points).query_pairs(self.near[2] + self.ROOM, output_type="ndarray").T
        line = four >= self.stars  # otherwise the pair is there already
        three, four = three[line], four[line]
        shared = np.zeros(len(three), bool)
        for walks in self.walks:
            shared |= (walks[four] >= 0) & np.isin(three * self.many + walks[four], self.on)
        shared &= ~np.isin(three * self.size + four, self.beside)
        pairs = np.hstack([[one, other], [three[shared], four[shared]]])
        pairs = pairs[:, np.lexsort(pairs)]
        one, other = pairs
        kinds = [other < self.places, other < self.stars, one < self.places]
        return pairs, np.select(kinds, self.near[:3], self.near[3])


def _both(*points: Numbers) -> Numbers:
    """The numbers of points, with both coordinates of each."""
    return np.concatenate([np.stack([2 * n, 2 * n + 1]) for n in points])


def _ways(factors: Sequence[int], size: int) -> Points:
    return np.repeat(np.array(factors, float)[:, None], size, axis=1)


def _apart(along: Points) -> Points:
    """The derivatives of the distance of two points by their coordinates."""
    return np.vstack([-along.T, along.T])


def _aside(along: Points) -> Points:
    return np.stack([-along[:, 1], along[:, 0]], 1)


def _unit(side: Points) -> tuple[Points, Points]:
    """The directions of vectors, and their lengths."""
    length = np.linalg.norm(side, axis=1)
    return side / length[:, None], length
