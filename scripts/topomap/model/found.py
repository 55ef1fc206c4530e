"""What is found: a hypothesis, and whether it is proved to be what it is said to be."""

from collections.abc import Sequence
from dataclasses import dataclass

from topomap.model.experience import DState, Misread
from topomap.model.topology import Gateway

Cube = tuple[DState, ...]  # the first dstates of hypotheses
OPTIMAL, BEST_SO_FAR = "optimal", "best so far"  # the second if no map is closed
BEST = (OPTIMAL, BEST_SO_FAR)  # the kinds of the answers to a question about optimal maps
UNPROVED = "not proved to be best"  # the kind of a map that may not be one of the best


@dataclass(frozen=True)
class Found:
    """A hypothesis that was found.

    It has the dstate after each step, and its kind. If the query minimises, it has its costs, the
    most important one first, and whether they are proved to be least. It has what was misread.
    ``open`` is true if an optimal map is asked for and this one has pending gateways: it is given
    as long as no closed map is found.
    """

    at: tuple[DState, ...]
    kind: str
    cost: tuple[int, ...] = ()
    proved: bool = True
    misread: tuple[Misread, ...] = ()
    open: bool = False


def steps_json(at: Sequence[Gateway], first: int = 0) -> list[list[int]]:
    """Convert the dstate after each step to ``[[T,P,S], ...]``, from step ``first`` on."""
    return [[step, place, slot] for step, (place, slot) in enumerate(at, first)]
