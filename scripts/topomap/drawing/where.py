"""Where the places of a map are, by what was measured: a compass, lengths, odometry.

Each travel tells roughly how far, and in which direction, its end is from its beginning. Places are
where they fit all travels best, by least squares; a travel that fits badly counts less. North,
which is the compass's slot 0, is up; without a compass it is the second axis of the odometry.
"""

import cmath
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from statistics import median
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from topomap.drawing.mesh import Points
from topomap.model.experience import DState, Experience
from topomap.model.topology import Place

ROUNDS = 8  # rounds of the least squares, with new weights in each
USUAL = 1.5  # a travel with more than so many times the median error counts less
UNKNOWN = 0.02  # the weight of a travel of which nothing is known


class Travel(NamedTuple):
    """A step between two places: its gateways, and its shift and its length if they are known."""

    out: DState
    arrival: DState
    shift: complex | None
    length: float | None


def measured(seen: Experience, at: Sequence[DState]) -> dict[Place, tuple[float, float]]:
    """Where the places of a hypothesis are; empty if no direction was measured."""
    if not (seen.compass or seen.shifts) or not at:
        return {}
    travels = _travels(seen, at)
    norths = _by_compass(seen, at)
    travels = _in_its_frame(travels, norths, seen.slots)
    norths |= {
        place: turn
        for place, turn in _by_shifts(travels, seen.slots).items()
        if place not in norths
    }
    moves = [_move(travel, norths, seen.slots) for travel in travels]
    lengths = [abs(move) for move, _ in moves if move]
    if not lengths:
        return {}
    told = [abs(move) for move, known in moves if move and known]
    usual = median(told) if told else 1.0
    places = list(dict.fromkeys(place for place, _ in at))
    number = {place: n for n, place in enumerate(places)}
    rows: list[tuple[int, int, complex, float]] = []
    for travel, (move, known) in zip(travels, moves, strict=True):
        one, other = number[travel.out[0]], number[travel.arrival[0]]
        if one != other:
            way = move if known or not move else usual * move / abs(move)
            weight = 1 / max(abs(way), usual / 10) if move else UNKNOWN / usual
            rows.append((one, other, way, weight))
    points = _fitted(rows, len(places))
    return {place: (float(x), float(y)) for place, (x, y) in zip(places, points, strict=True)}


def _travels(seen: Experience, at: Sequence[DState]) -> list[Travel]:
    found = []
    for step in range(1, len(at)):
        if seen.turns[step - 1] is not None:
            shift = seen.shifts[step - 1] if seen.shifts else None
            length = seen.lengths[step - 1] if seen.lengths else None
            moved = None if shift is None or shift == (0, 0) else complex(*shift)
            found.append(Travel(seen.way_out(step, at[step - 1]), at[step], moved, length))
    return found


def _turn(slot: float, slots: int) -> complex:
    """The rotation by so many slots clockwise."""
    return cmath.exp(-2j * math.pi * slot / slots)


def _by_compass(seen: Experience, at: Sequence[DState]) -> dict[Place, complex]:
    """The direction of slot 0 of each place at which the compass was read."""
    found: dict[Place, complex] = defaultdict(complex)
    for (place, slot), north in zip(at, seen.compass, strict=False):
        if north is not None:
            found[place] += 1j * _turn(north - slot, seen.slots)
    return {place: turn / abs(turn) for place, turn in found.items() if abs(turn) > 1e-9}


def _sums(travels: Sequence[Travel], slots: int) -> dict[Place, complex]:
    """For each place the sum of the directions of its slot 0 by the shifts of travels."""
    sums: dict[Place, complex] = defaultdict(complex)
    for out, arrival, shift, _ in travels:
        if shift is not None:
            sums[out[0]] += shift / abs(shift) / _turn(out[1], slots)
            sums[arrival[0]] -= shift / abs(shift) / _turn(arrival[1], slots)
    return sums


def _by_shifts(travels: Sequence[Travel], slots: int) -> dict[Place, complex]:
    sums = _sums(travels, slots).items()
    return {place: turn / abs(turn) for place, turn in sums if abs(turn) > 1e-9}


def _in_its_frame(
    travels: Sequence[Travel], norths: Mapping[Place, complex], slots: int
) -> list[Travel]:
    """The travels with their shifts turned so that they agree with the compass.

    Their second axis may lead north or south, which the order of the gateways tells. Their unit
    need not be that of the lengths; it is converted if both are known of a travel.
    """
    both = [
        abs(travel.shift) / travel.length for travel in travels if travel.shift and travel.length
    ]
    unit = median(both) if both else 1.0
    fits = []
    for mirrored in (False, True):
        those = [
            travel._replace(
                shift=None
                if travel.shift is None
                else (travel.shift.conjugate() if mirrored else travel.shift) / unit
            )
            for travel in travels
        ]
        sums = _sums(those, slots)
        agreed = sum((norths[p] * one.conjugate() for p, one in sums.items() if p in norths), 0j)
        weight = sum(map(abs, sums.values()))
        turn = agreed / abs(agreed) if norths and abs(agreed) > 1e-9 else 1
        turned = [one._replace(shift=one.shift and one.shift * turn) for one in those]
        fits.append((round(weight, 6) + (round(abs(agreed), 6) if norths else 0), turned))
    return fits[1][1] if fits[1][0] > fits[0][0] else fits[0][1]


def _move(travel: Travel, norths: Mapping[Place, complex], slots: int) -> tuple[complex, bool]:
    """How far a travel leads, and whether its length is known; 0 if its direction is not known.

    A way whose ends are not in line is taken to be an arc, which is longer than its chord.
    """
    if travel.shift is not None:
        return travel.shift, True
    ways = []
    for (place, slot), sign in ((travel.out, 1), (travel.arrival, -1)):
        if place in norths:
            ways.append(sign * norths[place] * _turn(slot, slots))
    if not ways:
        return 0j, False
    bend = abs(cmath.phase(ways[-1] / ways[0])) / 2
    mean = sum(ways, 0j)
    if abs(mean) < 1e-6:
        return 0j, False
    chord = math.sin(bend) / bend if bend > 1e-6 else 1.0
    return mean / abs(mean) * chord * (travel.length or 1.0), travel.length is not None


def _fitted(rows: Sequence[tuple[int, int, complex, float]], many: int) -> Points:
    """Points with such differences, by least squares, in which what fits badly counts less."""
    if not rows:
        return np.zeros((many, 2))
    one, other, ways, base = (np.array(column) for column in zip(*rows, strict=True))
    size = np.arange(len(rows))
    weight = base.astype(float)
    points = np.zeros((many, 2))
    for _ in range(ROUNDS):
        entries = np.concatenate([weight, -weight])
        ends = np.concatenate([other, one])
        by = sparse.csr_matrix((entries, (np.tile(size, 2), ends)), (len(rows), many))
        sides = weight[:, None] * np.stack([ways.real, ways.imag], 1)
        points = np.stack(
            [
                linalg.lsqr(by, side, atol=1e-12, btol=1e-12, iter_lim=20 * many + 100)[0]
                for side in sides.T
            ],
            1,
        )
        off = base * np.linalg.norm(
            points[other] - points[one] - np.stack([ways.real, ways.imag], 1), axis=1
        )
        usual = USUAL * max(float(np.median(off)), 1e-3)
        weight = base * np.minimum(1, usual / np.maximum(off, 1e-12)) ** 0.5
    return points
