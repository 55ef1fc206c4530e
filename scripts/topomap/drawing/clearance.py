"""Lines that pass under places which are not their ends."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from scipy.spatial import KDTree

from topomap.drawing.mesh import Points, cross
from topomap.model.topology import Gateway, Place, TopologicalMap

RADIUS = 0.15  # the radius of a place's circle, if a link has length 1
CLEAR = RADIUS + 0.02  # the least distance of a line from the middle of another place
DETOURS = 60  # the largest number of detours in a drawing
AROUND = 1.05, 1.2, 1.5  # distances of a detour from a place, in least distances
Passing = tuple[int, int, Place]  # the number of a line, a piece of it, and the place


def passing(
    places: Mapping[Place, Points],
    lines: Sequence[tuple[Collection[Place], Points]],
    clear: float = CLEAR,
) -> list[Passing]:
    """Find which lines come nearer to the middle of a place than ``clear``.

    Each line is given with the places that are its ends, to which it may come.
    """
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
    """Find the lines of a drawn map that pass under a place that is not one of their ends.

    Each is given by one of its gateways, with the place. Places are where their lines begin.
    """
    once = [out for out in lines if out not in world.links or out <= world.links[out]]
    ends = [({out[0], world.links.get(out, out)[0]}, lines[out]) for out in once]
    places = {place: line[0] for (place, _), line in lines.items()}
    met = {(once[line], place) for line, _, place in passing(places, ends, clear)}
    return sorted(met, key=lambda one: (once.index(one[0]), str(one[1])))


def led_round(world: TopologicalMap, lines: Mapping[Gateway, Points]) -> dict[Gateway, Points]:
    """Lead the lines of a drawn map round the places under which they would pass.

    This is done where they then cross nothing that they did not cross before. Their first and last
    pieces stay as they are.
    """
    led = dict(lines)
    once = [out for out, _ in world.edges() if out in lines]
    ends = [{out[0], world.links[out][0]} for out in once]
    places = {place: line[0] for (place, _), line in lines.items()}
    for _ in range(DETOURS):
        met = passing(places, list(zip(ends, (led[out] for out in once), strict=True)))
        done = False
        for number, piece, place in met:
            out = once[number]
            line = led[out]
            if not 0 < piece < len(line) - 2:
                continue
            a, b = line[piece], line[piece + 1]
            others = np.concatenate(
                [
                    np.stack([one[:-1], one[1:]], 1)
                    for end, one in led.items()
                    if end not in (out, world.links[out])
                ]
                + [np.stack([line[:piece], line[1 : piece + 1]], 1)]
                + [np.stack([line[piece + 1 : -1], line[piece + 2 :]], 1)]
            )
            for spot in _spots(a, b, places[place]):
                if not _cross(a, spot, others) and not _cross(spot, b, others):
                    led[out] = np.insert(line, piece + 1, spot, axis=0)
                    led[world.links[out]] = led[out][::-1]
                    done = True
                    break
            if done:
                break
        if not done:
            break
    return led


def _spots(a: Points, b: Points, place: Points) -> Iterator[Points]:
    """Points beside a place by which a piece from one point to another may be led round it."""
    way = (b - a) / max(1e-9, float(np.hypot(*(b - a))))
    near = a + np.clip((place - a) @ way, 0, np.hypot(*(b - a))) * way
    aside = near - place
    far = float(np.hypot(*aside))
    aside = aside / far if far > 1e-6 else np.array([-way[1], way[0]])
    for angle in (0.0, 0.4, -0.4, 0.8, -0.8):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        for times in AROUND:
            yield place + times * CLEAR * (aside @ turn)


def _cross(a: Points, b: Points, pieces: Points) -> bool:
    """Tell whether a piece of a line meets any of others that do not share an end with it."""
    c, d = pieces[:, 0], pieces[:, 1]
    shared = [(abs(p - q) < 1e-9).all(-1) for p in (a, b) for q in (c, d)]
    side = cross(b - a, c - a) * cross(b - a, d - a)
    over = cross(d - c, a - c) * cross(d - c, b - c)
    return bool(((side <= 0) & (over <= 0) & ~np.any(shared, axis=0)).any())
