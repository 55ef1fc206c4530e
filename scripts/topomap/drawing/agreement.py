"""On what the maps of one experience agree, and where they differ.

A place is named by the step of its first visit, and its gateways by the slots clockwise from the
agent's gateway at that visit, so that they can be compared between maps.
"""

from collections import Counter, defaultdict
from collections.abc import Sequence

from topomap.model import words
from topomap.model.experience import Experience
from topomap.model.topology import Gateway, Place


class Agreement:
    """What maps, each given by the dstate after each step, have in common.

    ``visits`` has for each map the steps after which the agent is at a place. ``one`` has the steps
    that are at one place in all maps, in groups of two or more. ``differ`` has the steps after
    which the agent is not at the same place and gateway in all maps, with the dstates and their
    maps.
    """

    def __init__(self, ats: Sequence[Sequence[Gateway]], seen: Experience):
        self.ats, self.slots = ats, seen.slots
        self.visits: list[dict[Place, list[int]]] = []
        self._links: Counter[tuple[Gateway, Gateway]] = Counter()
        for at in ats:
            visits = defaultdict(list)
            for step, (place, _) in enumerate(at):
                visits[place].append(step)
            self.visits.append(visits)
            self._links.update(seen.map_of(tuple(at)).links.items())
        classes: dict[tuple[Place, ...], list[int]] = defaultdict(list)
        for step, dstates in enumerate(zip(*ats, strict=True)):
            classes[tuple(place for place, _ in dstates)].append(step)
        self.one = [steps for steps in classes.values() if len(steps) > 1]
        self.differ = [
            (step, told) for step in range(seen.steps + 1) if len(told := self._told(step)) > 1
        ]

    def _told(self, step: int) -> list[tuple[str, str]]:
        """The dstates after a step, each with its maps."""
        told: dict[str, list[int]] = defaultdict(list)
        for number, (at, visits) in enumerate(zip(self.ats, self.visits, strict=True), 1):
            place, slot = at[step]
            before = [earlier for earlier in visits[place] if earlier < step]
            where = "at a new place"
            if before:
                turned = (slot - at[before[0]][1]) % self.slots
                steps = words.plural(len(before), "step")
                where = f"where it was after {steps} {words.listed(before)}"
                where += f", gateway {turned} from that of step {before[0]}"
            told[where].append(number)
        return [(where, words.listed(numbers)) for where, numbers in told.items()]

    def strange(self, number: int) -> set[Place]:
        """The places of a map, by its index, that have other visits in another map."""
        return {
            place
            for place, steps in self.visits[number].items()
            if any(visits.get(place) != steps for visits in self.visits)
        }

    def having(self, out: Gateway, end: Gateway) -> int:
        """The number of maps that have a link."""
        return self._links[out, end]
