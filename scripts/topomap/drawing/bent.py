"""Drawings with bent lines, of maps of genus 0.

A drawing is a mesh of triangles (``mesh``). It starts from a drawing on a grid, in which no
triangle is folded, and is bent towards a good shape (``springs``) by steps that fold no triangle.
So no crossing arises, and every rotation stays right.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from topomap.drawing.clearance import Passing, passing
from topomap.drawing.mesh import Mesh, Numbers, Points, TooLong
from topomap.drawing.springs import Springs, Term
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.runtime.watch import Late, never

# The weights of triangles, and of places and lines that keep apart, for one descent after the
# other. What is stuck where triangles are flat comes free when they resist more again.
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
ANEW = (100.0, 0.0), (10.0, 0.0)  # they come first if the drawing is not legible
# They are added if a line still passes under a place.
FREE = (0.1, 80.0), (0.01, 200.0), (0.002, 600.0)
AGAIN = 2  # the largest number of repetitions, if ``steps`` is not reduced
STEPS = 120  # the largest number of steps of the descent with each weight
WORK = 600_000  # numbers changed by all steps together, after which no drawing is begun again
MOST_POINTS = 20_000  # the largest number of points of a mesh
FINE = 3_000  # the largest number of points of a mesh that is made finer
LITTLE = 1e-9  # a little stiffness, so that no number is without any
# A positive definite matrix is solved without exchanging rows.
PIVOTS: Any = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


def bent(
    world: TopologicalMap,
    crossings: list[Place],
    steps: int,
    late: Late = never,
    known: Mapping[Place, Points] | None = None,
) -> dict[Gateway, Points]:
    """Draw lines with bends, in a drawing in which no triangle of the mesh is folded.

    Lines go straight through the crossings, and places are near to where they are ``known`` to be.
    If a line passes under a place, more bends are tried.

    Raises:
        TooLong: The drawing is not legible when the time is over.
    """
    mesh, x = _drawn(Mesh(world, crossings, 1, known), steps, late)
    if steps >= STEPS and not late() and mesh.size <= FINE and not _clear(mesh, x):
        with suppress(TooLong):
            finer, y = _drawn(Mesh(world, crossings, 2, known), steps, late)
            if len(_under(finer, y)) < len(_under(mesh, x)):
                mesh, x = finer, y
    return _lines(mesh, x)


def _drawn(mesh: Mesh, steps: int, late: Late) -> tuple[Mesh, Points]:
    """Make a mesh, and find the numbers of a good drawing of it."""
    if mesh.size > MOST_POINTS or late():
        raise TooLong
    points = mesh.start(late)
    shape = Springs(mesh)
    x = np.concatenate([points.ravel(), shape.norths(points)])
    rim = np.concatenate([2 * np.array(mesh.rim), 2 * np.array(mesh.rim) + 1])
    curves = Curvature(shape.fixed, np.setdiff1d(np.arange(len(x)), rim), len(x))
    for again in range(AGAIN + 1 if steps >= STEPS else 1):
        for shape.weight, shape.apart in ANEW * (again > 0) + STAGES:
            x = _descend(shape, x, curves, steps, late)
        if shape.legible(x) or curves.solved * len(x) > WORK:
            break
        if late():
            raise TooLong
    for shape.weight, shape.apart in FREE if steps >= STEPS else ():
        if not late() and not _clear(mesh, x):
            x = _descend(shape, x, curves, steps, late)
    if late() and not shape.legible(x):
        raise TooLong
    return mesh, x


def _clear(mesh: Mesh, x: Points) -> bool:
    """Tell whether no line passes under a place that is not one of its ends."""
    return not _under(mesh, x)


def _under(mesh: Mesh, x: Points) -> list[Passing]:
    lines = _lines(mesh, x)
    ends = [({out[0], _end(mesh, out)[0]}, line) for out, line in lines.items()]
    return passing({out[0]: line[0] for out, line in lines.items()}, ends)


def _end(mesh: Mesh, out: Gateway) -> Gateway:
    """The gateway at the end of a line, which goes straight through crossings.

    The end of a stub is its own gateway.
    """
    world, end = mesh.world, mesh.world.links.get(out, out)
    while end[0] in mesh.crossings:
        end = world.links[world.opposite(end)]
    return end


def _lines(mesh: Mesh, x: Points) -> dict[Gateway, Points]:
    """The line that leaves by each gateway of a place."""
    world, crossings = mesh.world, mesh.crossings
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


def _descend(shape: Springs, x: Points, curves: "Curvature", steps: int, late: Late) -> Points:
    """Minimise the energy over the free numbers by Newton's method.

    A negative curvature of a term is replaced by 0. Steps lead only to where the energy is finite,
    so that no triangle is folded.
    """
    value, terms = shape(x)
    idle = 0
    for _ in range(steps):
        if late():
            break
        slope = curves.slope(terms)
        step = np.zeros(len(x))
        step[curves.free] = curves.solve(terms, -slope)
        gain = slope @ step[curves.free]
        length = min(1.0, 0.9 * shape.reach(x, step))
        while (new := shape(x + length * step))[0] > value + 1e-4 * length * gain:
            length /= 2
            if length < 1e-10:
                return x
        idle = idle + 1 if value - new[0] < 1e-4 * (1 + abs(value)) else 0
        x = x + length * step
        value, terms = new
        if idle > 9:
            return x
    return x


class Curvature:
    """The Hessian of an energy with respect to the ``free`` numbers: a symmetric matrix.

    The positions of its entries are computed once, except for the last kind of terms, which changes
    each time.
    """

    def __init__(self, fixed: Sequence[Numbers], free: Numbers, total: int) -> None:
        self.total, self.free = total, free
        self.solved = 0  # the number of solutions
        self.number = np.full(self.total, -1)
        self.number[free] = np.arange(len(free))
        places = [self._places(columns) for columns in fixed]
        place = np.concatenate(places)
        self.kept = place >= 0
        # The diagonal is always in the matrix.
        size = len(free)
        keys, at = np.unique(
            np.concatenate([place[self.kept], np.arange(size) * (size + 1)]), return_inverse=True
        )
        self.at = at[:-size]
        self.diagonal = at[-size:]
        self.rows = keys % size
        self.starts = np.searchsorted(keys // size, np.arange(size + 1))

    def _places(self, columns: Numbers) -> Numbers:
        """The position in the matrix of each pair of numbers of each term, column by column.

        It is -1 if one of them is not free.
        """
        of = self.number[columns]
        one, other = of[:, None, :], of[None, :, :]
        place = one + len(self.free) * other
        return np.where((one >= 0) & (other >= 0), place, -1).ravel()

    def _matrix(self, entries: Points) -> Any:
        data = np.asarray(np.bincount(self.at, entries, len(self.rows)), float)
        data[self.diagonal] += LITTLE
        size = len(self.free)
        return sparse.csc_matrix((data, self.rows, self.starts), (size, size))

    def slope(self, terms: list[Term]) -> Points:
        """The gradient of the energy by the free numbers."""
        column = np.concatenate([columns.ravel() for columns, *_ in terms])
        pull = np.concatenate([(ways * pull).ravel() for _, ways, pull, _ in terms])
        return np.asarray(np.bincount(column, pull, self.total)[self.free], float)

    def solve(self, terms: list[Term], slope: Points) -> Points:
        """The step that would change the gradient by so much."""
        self.solved += 1
        *fixed, last = (_products(ways, stiff) for _, ways, _, stiff in terms)
        curvature = self._matrix(np.concatenate(fixed)[self.kept])
        place = self._places(terms[-1][0])
        kept = place >= 0
        size = len(self.free)
        column, row = np.divmod(place[kept], size)
        curvature = curvature + sparse.csc_matrix((last[kept], (row, column)), (size, size))
        solved: Points = linalg.splu(curvature, "MMD_AT_PLUS_A", **PIVOTS).solve(slope)
        return solved


def _products(ways: Points, stiff: Points) -> Points:
    return (ways[:, None, :] * (stiff * ways)[None, :, :]).ravel()
