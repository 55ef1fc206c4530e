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
CLOSE = 1e-6  # of the longest way: sums of moves that differ by less are equal


@dataclass(frozen=True)
class Senses:
    """What is measured. ``odometry`` is the largest error of a shift, in percent of the way, or
    None if there is no odometry; the errors are drawn with ``seed``. Who reads the measures takes
    shifts to be wrong by ``drift`` percent at most, and lengths by ``stretch`` percent; None for
    the usual, or as much as ``odometry`` where that is more."""

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
        """The part of a call of ``topomap generate`` that asks for it."""
        words = ["--compass"] * self.compass + ["--lengths"] * self.lengths
        return [
            *words,
            *(["--odometry", f"{self.odometry:g}"] if self.odometry is not None else []),
        ]

    def parts(self) -> list[str]:
        """The same as parts of the name of an instance."""
        words = ["compass"] * self.compass + ["lengths"] * self.lengths
        return words + ([] if self.odometry is None else [f"odometry{self.odometry:g}"])

    def notes(self) -> list[str]:
        """The same as lines of the header of an instance."""
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
            experience: what was seen.
            dstates: the gateway stood at after each step, from 0, in the world, whose slots are
                those of the compass.
            route: the slot by which each step left.
            moves: how far each gateway's way leads, in whole units or nearly so.
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
        """A move as it is measured. With errors of at most p/(1+2p) of |X|+|Y| in each direction,
        for the share p, each is at most p of what is measured as |X|+|Y|; so the truth stays
        consistent with a drift of p."""
        assert self.odometry is not None
        x, y = map(round, move)
        most = int(self.odometry * (abs(x) + abs(y)) / (100 + 2 * self.odometry))
        draw = random.Random(f"{self.seed} {step}")
        return x + draw.randint(-most, most), y + draw.randint(-most, most)


def demand_flat(name: str, world: TopologicalMap, moves: Mapping[Gateway, Move]) -> None:
    """Raises InputError if the ways of a world do not fit into a plane, as on a torus: on the way
    round, the moves do not sum to nothing, and odometry would contradict the truth."""
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
