"""The places and ways of free space in a raster: its skeleton as a graph.

Noise is removed first: each pixel becomes what most of the nine pixels around it are, and spots
that are small compared with the corridors are filled or cleared. The skeleton is the line in the
middle of what is left. Junctions and ends of the skeleton are places. Lines that end near a wall
are pruned. Junctions whose largest free circles touch are one place. A corner is a place, too: a
point where the line turns by more than ``SHARP`` degrees within a short distance.

All lengths here are in pixels, and points are (row, column).
"""

import heapq
import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import ndimage
from skimage.morphology import skeletonize

Numbers = npt.NDArray[np.float64]
Grid = npt.NDArray[np.bool_]
Line = Numbers  # the points of a line, one in each row

SHARP = 45.0  # degrees: the least turn at a corner
SPOT = 9  # pixels: a spot of this size is noise, however wide corridors are
MOST_OF_LINES = 10**6  # the largest number of pixels of a skeleton
MOST_WORK = 4 * 10**9  # pixels times the distance of the middle from the wall: some ten seconds
ROUND = ndimage.generate_binary_structure(2, 2)  # free pixels also touch at their corners


class TooLarge(Exception):
    """A raster that would take too long; the message says why."""


@dataclass
class Net:
    """Places, and lines between them.

    ``where`` has the points of the places, ``free`` the radius of the largest free circle there,
    and ``reach`` the radius of the disc whose junctions have become this place. ``lines`` has lines
    with their two ends; ``at`` has for each place the lines that end there, twice those that lead
    back. The other numbers count what was changed.
    """

    where: dict[int, Numbers] = field(default_factory=dict)
    free: dict[int, float] = field(default_factory=dict)
    reach: dict[int, float] = field(default_factory=dict)
    lines: dict[int, tuple[int, int, Line]] = field(default_factory=dict)
    at: dict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    noise: int = 0
    spots: int = 0
    pruned: int = 0
    junctions: int = 0
    merged: int = 0
    corners: int = 0
    loops: int = 0
    rings: int = 0
    lone: int = 0
    last: int = 0

    def add_place(self, point: Numbers, free: float, reach: float) -> int:
        """Add a place."""
        self.last += 1
        self.where[self.last], self.free[self.last], self.reach[self.last] = point, free, reach
        return self.last

    def add(self, one: int, other: int, line: Line) -> int:
        """Add a line between two places."""
        self.last += 1
        self.lines[self.last] = one, other, line
        self.at[one].append(self.last)
        self.at[other].append(self.last)
        return self.last

    def remove(self, number: int) -> tuple[int, int, Line]:
        """Remove a line, and return it."""
        one, other, line = self.lines.pop(number)
        self.at[one].remove(number)
        self.at[other].remove(number)
        return one, other, line

    def drop(self, place: int) -> None:
        """Remove a place that has no line."""
        for of in (self.where, self.free, self.reach, self.at):
            of.pop(place, None)

    def leaving(self, place: int) -> Iterator[tuple[int, Line]]:
        """The lines at a place, each with its other end, in the direction away from the place."""
        for number in self.at[place]:
            one, other, line = self.lines[number]
            yield (other, line) if one == place else (one, line[::-1])

    def dissolve(self, place: int) -> None:
        """Join the two lines at a place to one line, if there are two."""
        if len(self.at[place]) != 2 or self.at[place][0] == self.at[place][1]:
            return
        (one, back), (other, line) = self.leaving(place)
        for number in (*self.at[place],):
            self.remove(number)
        # The points in the disc of the place belong to neither line, but its centre does.
        between = self.where[place][None] if self.reach[place] else back[:0]
        self.drop(place)
        self.add(one, other, _joined(back[::-1], between, line))


def net_of(free: Grid, radius: float | None = None, loops: bool = False) -> Net:
    """Find the places and ways of free space.

    Two junctions are one place if they are at most ``radius`` apart along a line, or, if it is
    None, if their largest free circles touch. ``loops`` tells whether lines back to their own place
    are kept.

    Raises:
        TooLarge: It would take too long.
    """
    used = [np.flatnonzero(free.any(axis=axis)) for axis in (1, 0)]
    if not used[0].size:
        return Net()
    (top, bottom), (left, right) = ((int(some[0]), int(some[-1]) + 1) for some in used)
    clean, noise, spots = _clean(np.pad(free[top:bottom, left:right], 2))
    corner = np.array([top - 2, left - 2])
    net = Net(noise=noise, spots=spots)
    if clean.any():
        room = ndimage.distance_transform_edt(clean)
        _trace(net, _skeleton(clean), room)
        net.junctions = sum(len(of) > 2 for of in net.at.values())
        while _prune(net) | _merge(net, radius):
            pass
        _leave_out_loops(net, room, loops)
        _split_at_corners(net, room)
    for number in [number for number, (one, other, _) in net.lines.items() if one == other]:
        if not loops:
            net.remove(number)
            net.loops += 1
    for place in [place for place in net.where if not net.at[place]]:
        net.lone += 1
        net.drop(place)
    for place, point in net.where.items():
        net.where[place] = point + corner
    for number, (one, other, line) in net.lines.items():
        net.lines[number] = one, other, line + corner
    return net


def _clean(free: Grid) -> tuple[Grid, int, int]:
    """Remove noise from free space.

    A spot is small if it is not larger than a square a third as wide as the corridors.

    Returns:
        The free space, and how many pixels and spots were changed.
    """
    around = ndimage.convolve(free.astype(np.uint8), np.ones((3, 3), np.uint8), mode="constant")
    clean: Grid = around >= 5
    if not clean.any():
        return clean, int(free.sum()), 0
    # The width of the corridors is the median distance from wall to wall along their middle.
    room = ndimage.distance_transform_edt(clean)
    if (far := float(room.max())) * clean.size > MOST_WORK:
        raise TooLarge(f"free space {2 * far:.0f} pixels wide, among {clean.size:,} pixels")
    width = 2 * float(np.median(room[clean & (room >= ndimage.maximum_filter(room, 3))]))
    del room
    spots = 0
    for grid, touching, most in (
        (~clean, None, max(SPOT, (width / 3) ** 2)),
        (clean, ROUND, max(SPOT, width**2)),
    ):
        labels, _ = ndimage.label(grid, touching)
        sizes = np.bincount(labels.ravel())
        small = sizes <= most
        small[[0, labels[0, 0]]] = False  # the rim surrounds all free space
        spots += int(small.sum())
        clean ^= small[labels]
    return clean, int((clean != free).sum()), spots


def _skeleton(free: Grid) -> Grid:
    thin: Grid = skeletonize(free)  # type: ignore[no-untyped-call]
    return thin


def _trace(net: Net, skeleton: Grid, room: Numbers) -> None:
    """Add the lines of a skeleton to the net."""
    pixels = np.argwhere(skeleton)
    if len(pixels) > MOST_OF_LINES:
        raise TooLarge(f"lines of {len(pixels):,} pixels in the middle of free space")
    number = np.full(skeleton.shape, -1, np.int32)
    number[skeleton] = np.arange(len(pixels))
    near: list[list[int]] = [[] for _ in pixels]
    # Pixels that touch only at a corner are neighbours if the skeleton has no pixel beside both.
    one, other = skeleton[:-1, :], skeleton[1:, :]
    pairs = [(number[:-1, :][one & other], number[1:, :][one & other])]
    one, other = skeleton[:, :-1], skeleton[:, 1:]
    pairs.append((number[:, :-1][one & other], number[:, 1:][one & other]))
    a, b, c, d = skeleton[:-1, :-1], skeleton[:-1, 1:], skeleton[1:, :-1], skeleton[1:, 1:]
    pairs.append((number[:-1, :-1][a & d & ~b & ~c], number[1:, 1:][a & d & ~b & ~c]))
    pairs.append((number[:-1, 1:][b & c & ~a & ~d], number[1:, :-1][b & c & ~a & ~d]))
    for ones, others in pairs:
        for i, j in zip(ones.tolist(), others.tolist(), strict=True):
            near[i].append(j)
            near[j].append(i)
    points = pixels.astype(np.float64)
    widths = room[skeleton]
    places = {
        i: net.add_place(points[i], float(widths[i]), 0.0)
        for i, of in enumerate(near)
        if len(of) != 2
    }
    done = bytearray(len(near))

    def chain(first: int, second: int) -> list[int]:
        """Follow a line from a pixel to its end."""
        found = [first, second]
        while found[-1] not in places:
            done[found[-1]] = True
            left, right = near[found[-1]]
            found.append(right if left == found[-2] else left)
        return found

    for i in [*places]:
        for j in near[i]:
            if j in places:
                if i < j:
                    net.add(places[i], places[j], points[[i, j]])
            elif not done[j]:
                line = chain(i, j)
                net.add(places[i], places[line[-1]], points[line])
    for i in range(len(near)):
        if i not in places and not done[i]:  # this is a ring
            places[i] = net.add_place(points[i], float(widths[i]), 0.0)
            net.add(places[i], places[i], points[chain(i, near[i][0])])


def _prune(net: Net) -> bool:
    """Remove lines that end near the wall of the corridor which they leave, the shortest first.

    They are those that reach no further from its middle than the corridor is wide.

    Returns:
        Whether there were any.
    """
    found = net.pruned

    def spur(number: int) -> tuple[float, int, int] | None:
        """The length of a line that is to be pruned, its free end and its other end; or None."""
        one, other, line = net.lines[number]
        for end, root in ((one, other), (other, one)):
            if len(net.at[end]) == 1 and len(net.at[root]) > 2:
                start = net.where[root] if net.reach[root] else line[0]
                long = max(_length(line), math.dist(net.where[end], start)) + net.free[end]
                if long <= 2 * net.free[root] + 1:
                    return long, end, root
        return None

    waiting = [(told[0], number) for number in net.lines if (told := spur(number))]
    heapq.heapify(waiting)
    while waiting:
        _, number = heapq.heappop(waiting)
        if number not in net.lines or not (told := spur(number)):
            continue
        _, end, root = told
        net.remove(number)
        net.drop(end)
        net.pruned += 1
        net.dissolve(root)
        if net.last in net.lines and (more := spur(net.last)):
            heapq.heappush(waiting, (more[0], net.last))
    return net.pruned > found


def _merge(net: Net, radius: float | None) -> bool:
    """Merge junctions that are near each other to one place, and tell whether there were any."""
    group = {place: place for place in net.where}

    def top(place: int) -> int:
        """The place into which a place was merged."""
        while group[place] != place:
            group[place] = place = group[group[place]]
        return place

    short = []
    for number, (one, other, line) in net.lines.items():
        near = net.free[one] + net.free[other] if radius is None else radius
        if (
            one != other
            and len(net.at[one]) > 2
            and len(net.at[other]) > 2
            and _length(line) <= near
        ):
            short.append(number)
            group[top(one)] = top(other)
    if not short:
        return False
    for number in short:
        net.remove(number)
    groups = defaultdict(list)
    for place in group:
        groups[top(place)].append(place)
    for members in groups.values():
        if len(members) == 1:
            continue
        middle = np.mean([net.where[place] for place in members], axis=0)
        wide = max(net.free[place] for place in members)
        far = max(math.dist(middle, net.where[place]) + net.free[place] for place in members)
        made = net.add_place(middle, wide, far)
        net.merged += len(members) - 1
        for place in members:
            for number in dict.fromkeys(net.at[place]):
                one, other, line = net.remove(number)
                net.add(made if one == place else one, made if other == place else other, line)
            net.drop(place)
        if len(net.at[made]) == 2:
            net.dissolve(made)
    return True


def _leave_out_loops(net: Net, room: Numbers, loops: bool) -> None:
    """Treat rings and lines that lead back to their own place.

    A ring without a junction begins at one of its corners. A ring without a corner is left out, and
    so are lines without a corner that lead back to their own place, unless loops are kept.
    """
    waiting = [*net.lines]
    while waiting:
        number = waiting.pop()
        one, other, line = net.lines.get(number, (0, 1, None))
        if line is None or one != other:
            continue
        ring = len(net.at[one]) == 2
        bends = _corners(line, room, ring)
        if ring and bends:
            net.remove(number)
            net.drop(one)
            turned = np.concatenate([line[bends[0] :], line[1 : bends[0] + 1]])
            place = _corner(net, turned[0], room)
            net.add(place, place, turned)
        elif not bends and not loops:
            net.remove(number)
            if ring:
                net.rings += 1
                net.drop(one)
            else:
                net.loops += 1
                net.dissolve(one)  # this may make a line that leads back to another place
                waiting.append(net.last)


def _corner(net: Net, point: Numbers, room: Numbers) -> int:
    net.corners += 1
    return net.add_place(point, float(room[int(point[0]), int(point[1])]), 0.0)


def _split_at_corners(net: Net, room: Numbers) -> None:
    """Make places of the corners of lines."""
    for number in [*net.lines]:
        bends = _corners(net.lines[number][2], room)
        if not bends:
            continue
        one, other, line = net.remove(number)
        begin = 0
        for bend in bends:
            place = _corner(net, line[bend], room)
            net.add(one, place, line[begin : bend + 1])
            one, begin = place, bend
        net.add(one, other, line[begin:])


def _corners(line: Line, room: Numbers, ring: bool = False) -> list[int]:
    """Find where a line turns by more than SHARP degrees.

    The turn is that from the arm before to the arm after a point; each arm is three times as long
    as the point is far from the wall. Of points that are nearer together than an arm, the one with
    the largest turn is taken.
    """
    near = room[line[:, 0].astype(int), line[:, 1].astype(int)]
    wide = float(np.median(near))
    arm = max(8, round(3 * wide))
    step = np.hypot(*np.diff(line, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(step)])
    total = float(along[-1])
    if total < 2 * arm:
        return []
    course = smooth(line, max(2, round(wide)), ring)
    at = np.arange(0, total)  # points along the line, one pixel apart
    even = np.stack([np.interp(at, along, course[:, axis]) for axis in (0, 1)], axis=1)
    if ring:
        even = np.concatenate([even[-arm:], even, even[:arm]])
    before = even[arm:-arm] - even[: -2 * arm]
    after = even[2 * arm :] - even[arm:-arm]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.degrees(np.abs(np.arctan2(cross, (before * after).sum(axis=1))))
    found = []
    first = 0 if ring else arm  # the point of the first turn
    around = len(turns)
    while around and turns[best := int(np.argmax(turns))] > SHARP:
        # Where the turn is about the same along a part of the line, its middle is the corner.
        level = turns >= turns[best] - 3
        low = high = best
        while low > 0 and level[low - 1]:
            low -= 1
        while high + 1 < around and level[high + 1]:
            high += 1
        best = (low + high) // 2
        found.append(int(np.searchsorted(along, best + first)))
        gone = np.arange(min(low, best - arm), max(high, best + arm) + 1)
        turns[gone % around if ring else gone[(gone >= 0) & (gone < around)]] = 0
    return sorted({min(max(index, 0), len(line) - 1) for index in found})


def smooth(line: Line, width: int, ring: bool = False) -> Line:
    """Remove the steps of the pixels from a line.

    Each point becomes the mean of up to ``width`` points before it and as many after it; the ends
    stay.
    """
    many = len(line)
    if ring:
        body = np.concatenate([line[-1 - width : -1], line, line[1 : 1 + width]])
        sums = np.concatenate([np.zeros((1, 2)), np.cumsum(body, axis=0)])
        return np.asarray((sums[2 * width + 1 :] - sums[: -2 * width - 1]) / (2 * width + 1))
    index = np.arange(many)
    half = np.minimum(width, np.minimum(index, many - 1 - index))
    sums = np.concatenate([np.zeros((1, 2)), np.cumsum(line, axis=0)])
    return np.asarray((sums[index + half + 1] - sums[index - half]) / (2 * half + 1)[:, None])


def _length(line: Line) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def _joined(*parts: Any) -> Line:
    """Join lines one after the other; a point at which two meet occurs once."""
    joined: Line = np.concatenate(parts)
    apart = np.any(np.diff(joined, axis=0) != 0, axis=1)
    kept: Line = joined[np.concatenate([[True], apart])]
    return kept
