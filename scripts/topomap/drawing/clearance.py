"""Whether lines pass under places that are none of their ends."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from scipy.spatial import KDTree

from topomap.drawing.mesh import Points
from topomap.model.topology import Gateway, Place, TopologicalMap

RADIUS = 0.15  # of a place's circle, where a link is of length 1
CLEAR = RADIUS + 0.02  # the least distance of a line from the middle of a place that it passes by
Passing = tuple[int, int, Place]  # a line by its number, a piece of it, and the place


def passing(
    places: Mapping[Place, Points],
    lines: Sequence[tuple[Collection[Place], Points]],
    clear: float = CLEAR,
) -> list[Passing]:
    """Which lines come nearer to the middle of a place than ``clear``; each line is given with the
    places that are its ends, to which it may come."""
    if not places or not lines:
        return []
    names = list(places)
    points = np.array([places[name] for name in names])
    pieces = np.concatenate([np.stack([line[:-1], line[1:]], 1) for _, line in lines])
    owner = np.repeat(np.arange(len(lines)), [len(line) - 1 for _, line in lines])
    first = np.concatenate([np.arange(len(line) - 1) for _, line in lines])
    start, side = pieces[:, 0], pieces[:, 1] - pieces[:, 0]
    half = np.linalg.norm(side, axis=1) / 2
    found = KDTree(points).query_ball_point(start + side / 2, half + clear)
    many = [len(near) for near in found]
    piece = np.repeat(np.arange(len(pieces)), many)
    place = np.concatenate([np.sort(near) for near in found]).astype(int)
    off = points[place] - start[piece]
    squares = np.maximum((side**2).sum(1), 1e-18)[piece]
    along = np.clip((off * side[piece]).sum(1) / squares, 0, 1)
    far = np.linalg.norm(off - along[:, None] * side[piece], axis=1)
    return [
        (int(owner[n]), int(first[n]), names[p])
        for n, p in zip(piece[far < clear], place[far < clear], strict=True)
        if names[p] not in lines[owner[n]][0]
    ]


def under(
    world: TopologicalMap, lines: Mapping[Gateway, Points], clear: float = CLEAR
) -> list[tuple[Gateway, Place]]:
    """The lines of a drawn map that pass under a place that is none of their ends, each by one of
    its gateways, with the place. Places are where their lines begin."""
    once = [out for out in lines if out not in world.links or out <= world.links[out]]
    ends = [({out[0], world.links.get(out, out)[0]}, lines[out]) for out in once]
    places = {place: line[0] for (place, _), line in lines.items()}
    met = {(once[line], place) for line, _, place in passing(places, ends, clear)}
    return sorted(met, key=lambda one: (once.index(one[0]), str(one[1])))
