"""What is found: a hypothesis, and whether it is proved to be what it is said to be."""

from collections.abc import Sequence
from dataclasses import dataclass

from topomap.model.experience import DState, Misread
from topomap.model.topology import Gateway

Cube = tuple[DState, ...]  # the first dstates of a hypothesis
OPEN = "best so far"  # the kind of the best maps where no map is closed
BEST = ("optimal", OPEN)  # the kinds that are asked for as optimal
UNPROVED = "not proved to be best"  # the kind of a map of which it is open whether it is


@dataclass(frozen=True)
class Found:
    """A hypothesis: the dstate after each step, of what kind it is, and if the query
    minimises, its costs, most important first, and whether they are proved least; and what
    was misread."""

    at: tuple[DState, ...]
    kind: str
    cost: tuple[int, ...] = ()
    proved: bool = True
    misread: tuple[Misread, ...] = ()


def steps_json(at: Sequence[Gateway], first: int = 0) -> list[list[int]]:
    """The dstate after each step, ``[[T,P,S], ...]``, of which this is the first."""
    return [[step, place, slot] for step, (place, slot) in enumerate(at, first)]
