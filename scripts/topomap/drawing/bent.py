"""Drawings with bent lines, of maps of genus 0.

A drawing is a mesh of triangles (``mesh``). It starts from a drawing on a grid, in which no
triangle is folded, and is bent towards a good shape (``springs``) by steps that fold none, so
nothing comes to cross and every rotation stays right.
"""

from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from topomap.drawing.mesh import Mesh, Numbers, Points
from topomap.drawing.springs import Springs, Term
from topomap.model.topology import Gateway, Place, TopologicalMap

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
    mesh = Mesh(world, crossings)
    shape = Springs(mesh)
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


def _descend(shape: Springs, x: Points, free: Numbers, steps: int) -> Points:
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
