"""What is found: a hypothesis, and whether it is proved to be what it is said to be."""

from collections.abc import Sequence
from dataclasses import dataclass

from topomap.model.experience import DState, Misread
from topomap.model.topology import Gateway

Cube = tuple[DState, ...]  # the first dstates of a hypothesis
OPTIMAL, BEST_SO_FAR = "optimal", "best so far"  # the best maps, and where no map is closed
BEST = (OPTIMAL, BEST_SO_FAR)  # the kinds that are asked for as optimal
UNPROVED = "not proved to be best"  # the kind of a map of which it is open whether it is


@dataclass(frozen=True)
class Found:
    """A hypothesis: the dstate after each step, of what kind it is, and if the query
    minimises, its costs, most important first, and whether they are proved least; and what
    was misread. ``open`` says that an optimal map is asked for, and that this one has pending
    gateways: it is given as long as no closed map is found."""

    at: tuple[DState, ...]
    kind: str
    cost: tuple[int, ...] = ()
    proved: bool = True
    misread: tuple[Misread, ...] = ()
    open: bool = False


def steps_json(at: Sequence[Gateway], first: int = 0) -> list[list[int]]:
    """The dstate after each step, ``[[T,P,S], ...]``, of which this is the first."""
    return [[step, place, slot] for step, (place, slot) in enumerate(at, first)]
