"""What a robot measures besides views: compass, odometry, and the lengths of ways."""

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from topomap.model.experience import Experience
from topomap.model.topology import Gateway, Place, TopologicalMap, label
from topomap.runtime.errors import InputError
from topomap.runtime.limits import DRIFT, STRETCH

Move = tuple[float, float]  # east and north, from one end of a way to the other
CLOSE = 1e-6  # sums of moves that differ by less, as a share of the longest way, are equal


@dataclass(frozen=True)
class Senses:
    """What is measured.

    ``odometry`` is the largest error of a shift, in percent of the way, or None without odometry;
    the errors are drawn with ``seed``. Those who use the measurements take shifts to be wrong by at
    most ``drift`` percent, and lengths by ``stretch`` percent. If these are None, they are the
    usual ones, or as large as ``odometry`` if that is larger.
    """

    compass: bool = False
    odometry: float | None = None
    lengths: bool = False
    seed: int = 0
    drift: int | None = None
    stretch: int | None = None

    def __bool__(self) -> bool:
        """Whether anything is measured."""
        return self.compass or self.lengths or self.odometry is not None

    def call(self) -> list[str]:
        """The part of a call of ``topomap generate`` that asks for these measurements."""
        words = ["--compass"] * self.compass + ["--lengths"] * self.lengths
        return [
            *words,
            *(["--odometry", f"{self.odometry:g}"] if self.odometry is not None else []),
        ]

    def parts(self) -> list[str]:
        """The measurements as parts of the name of an instance."""
        words = ["compass"] * self.compass + ["lengths"] * self.lengths
        return words + ([] if self.odometry is None else [f"odometry{self.odometry:g}"])

    def notes(self) -> list[str]:
        """The measurements as lines of the header of an instance."""
        told = ["compass: after each step"] * self.compass
        told += ["lengths: of each step"] * self.lengths
        if self.odometry is not None:
            error = f"wrong by {self.odometry:g} % of the way at most, seed {self.seed}"
            needs = f" (--drift {self._drift()})" if self._drift() > DRIFT else ""
            told.append(f"odometry: a shift for each step, {error}{needs}")
        return told

    def of(
        self,
        experience: Experience,
        dstates: Sequence[Gateway],
        route: Sequence[int],
        moves: Mapping[Gateway, Move],
    ) -> Experience:
        """The experience of a walk, with what is measured on it.

        Parameters:
            experience: What was seen.
            dstates: The gateway of the agent after each step, from 0, in the world, whose slots are
                those of the compass.
            route: The slot by which each step left.
            moves: How far the way of each gateway leads, in whole units or nearly so.

        Returns:
            The experience with the measurements.
        """
        if not self:
            return experience
        taken = (
            [moves[place, slot] for (place, _), slot in zip(dstates, route, strict=False)]
            if self.lengths or self.odometry is not None
            else []
        )
        return Experience(
            experience.slots,
            experience.views,
            experience.turns,
            experience.landmarks,
            experience.drops,
            experience.picks,
            experience.markers,
            compass=[slot for _, slot in dstates] if self.compass else (),
            lengths=[max(1, round(math.hypot(*move))) for move in taken] if self.lengths else (),
            shifts=()
            if self.odometry is None
            else [self._shift(step, move) for step, move in enumerate(taken, 1)],
            drift=self._drift() if self.drift is None else self.drift,
            stretch=STRETCH if self.stretch is None else self.stretch,
        )

    def _drift(self) -> int:
        return max(DRIFT, math.ceil(self.odometry or 0))

    def _shift(self, step: int, move: Move) -> tuple[int, int]:
        """Measure a move.

        With errors of at most p/(1+2p) of |X|+|Y| in each direction, for the share p, each error is
        at most p of the measured |X|+|Y|. So the truth stays consistent with a drift of p.
        """
        assert self.odometry is not None
        x, y = map(round, move)
        most = int(self.odometry * (abs(x) + abs(y)) / (100 + 2 * self.odometry))
        draw = random.Random(f"{self.seed} {step}")
        return x + draw.randint(-most, most), y + draw.randint(-most, most)


def demand_flat(name: str, world: TopologicalMap, moves: Mapping[Gateway, Move]) -> None:
    """Check that the ways of a world fit into a plane.

    On a torus they do not: the moves on a way round it do not sum to zero, so odometry would
    contradict the truth.

    Raises:
        InputError: They do not fit.
    """
    where: dict[Place, Move] = {}
    close = CLOSE * max((math.hypot(*move) for move in moves.values()), default=1)
    for start in world.stars:
        waiting = [start] if start not in where else []
        where.setdefault(start, (0.0, 0.0))
        while waiting:
            place = waiting.pop()
            x, y = where[place]
            for slot in sorted(world.stars[place]):
                east, north = moves[place, slot]
                there = world.links[place, slot][0]
                if there not in where:
                    where[there] = x + east, y + north
                    waiting.append(there)
                elif math.dist(where[there], (x + east, y + north)) > close:
                    raise InputError(
                        f"{name}: its ways do not fit into a plane (the way from {label(place)} to "
                        f"{label(there)}), so odometry would contradict the truth"
                    )
