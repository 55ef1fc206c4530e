"""An experience as it happens: after each step how many hypotheses there are, the best maps,
and what is certain.

While few hypotheses live, all of them are kept, each with its map, and a step enters the children
of each (``search/living.py``): what that costs does not grow with the log. Where there are more
than LIVING, clingo takes over (``stepwise.py``), until they have become few again. Both give the
same answers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from topomap.model.compact import CompactMap, Numbering
from topomap.model.exceptions import NamedException, exceptions_of
from topomap.model.experience import DState, Experience, Step
from topomap.runtime.limits import DRIFT, MOST_COUNTED, STRETCH
from topomap.runtime.watch import Attempt, Watch
from topomap.search.certainty import Certain, Certainty
from topomap.search.hypothesis import OFTEN
from topomap.search.living import Living, Told, Tree
from topomap.solver.stepwise import MAPS, Stepwise

LIVING = 2_000  # hypotheses of which each is kept with its map
FEWER = 4  # times fewer than these there are to be, before clingo is asked no longer
KEPT = 500  # hypotheses of earlier steps that are kept, to be there when steps are taken back

__all__ = ["Certain", "LivingMap", "OnlineSolver", "ReadMap", "Status"]

Sizes = tuple[int, int, int, int, int]  # places, links, paths, genus, pending gateways


class ReadMap:
    """A best map, as the dstates of its hypothesis after each step."""

    def __init__(self, experience: Experience, at: tuple[DState, ...]):
        self.experience, self.at = experience, at

    @cached_property
    def sizes(self) -> Sizes:
        """How many places, links and paths it has, its genus, and how many pending gateways."""
        one = CompactMap(Numbering(self.experience, path_axiom=False), self.at)
        return (
            len(one.places),
            len(one.link) // 2,
            one.number_of_paths(),
            one.genus(),
            one.number_of_pending(),
        )

    @property
    def exceptions(self) -> Sequence[NamedException]:
        """Its exceptions to consistent boundaries."""
        return exceptions_of(self.experience, self.at)

    def way(self, most: int) -> list[DState]:
        """The dstates after the last steps, so many at most."""
        return [*self.at[-most:]]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ReadMap | LivingMap) and self.at == other.at

    def __hash__(self) -> int:
        return hash(self.at)


class LivingMap:
    """A best map, as a hypothesis that is kept."""

    def __init__(self, living: Living, told: Told):
        self.living, self.slots = living, told.slots
        self.sizes: Sizes = living.form.sizes
        self.exceptions: Sequence[NamedException] = living.form.exceptions(told)

    @cached_property
    def at(self) -> tuple[DState, ...]:
        """The dstates of its hypothesis after each step."""
        return tuple(divmod(gateway, self.slots) for gateway in self.living.visit.gateways())

    def way(self, most: int) -> list[DState]:
        """The dstates after the last steps, so many at most."""
        visit = self.living.visit
        last = visit.gateways(max(0, visit.step + 1 - most))
        return [divmod(gateway, self.slots) for gateway in last]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ReadMap | LivingMap) and self.at == other.at

    def __hash__(self) -> int:
        return hash(self.at)


@dataclass(frozen=True)
class Status:
    """What is known after a step. ``exact`` is false if there are more hypotheses than
    ``hypotheses``; ``none_since`` is the first step after which there is none. ``maps`` are the
    best maps, and ``best`` the dstates of each of them; ``all_best`` tells whether they are all.
    ``fault`` is why something is missing."""

    step: int
    hypotheses: int | None = None
    exact: bool = False
    none_since: int | None = None
    kind: str | None = None
    cost: tuple[int, ...] = ()
    maps: tuple[ReadMap | LivingMap, ...] = ()
    all_best: bool = False
    certain: Certain | None = None
    fault: str | None = None

    @property
    def best(self) -> tuple[tuple[DState, ...], ...]:
        """The dstates of each of the best maps."""
        return tuple(one.at for one in self.maps)


class OnlineSolver:
    """An exploration that goes on, from its start; steps can be taken back."""

    def __init__(
        self,
        slots: int,
        first: Step,
        planar: bool = False,
        bound: int | None = None,
        most: int = MOST_COUNTED,
        drift: int = DRIFT,
        stretch: int = STRETCH,
        tolerance: int = 0,
        path_axiom: bool = True,
        living: int = LIVING,
    ):
        """Begin where the first view was seen; ``drift`` and ``stretch`` tell, in percent, how far
        shifts and lengths may be wrong, and ``tolerance``, in slots, how far bearings may be. Of
        more than ``living`` hypotheses clingo is asked, from the start if that is 0."""
        self.told = Told(slots, first, drift, stretch, tolerance)
        self.most, self._living = most, living
        self._asked = planar, bound, most, drift, stretch, tolerance, path_axiom
        self._tree = Tree(self.told, planar, bound, path_axiom)
        self._rules: Stepwise | None = None
        self._searching = living > 0
        self._certainty = Certainty(self.told)
        self._experience: Experience | None = None
        self._begin()

    def _begin(self) -> None:
        """Stand at the start, as far as the search goes."""
        self._none: int | None = None
        self._level = [self._tree.root()]
        self._done = 0  # the step after which these are the hypotheses
        self._kept = {0: self._level}
        self._many_kept = 1
        self._certainty.step(self._level, False)

    @property
    def experience(self) -> Experience:
        """What was seen and done so far."""
        if self._experience is None:
            self._experience = self.told.experience()
        return self._experience

    @property
    def rules(self) -> int:
        """The ground rules so far; 0 if clingo was not asked."""
        return 0 if self._rules is None else self._rules.rules

    def step(self, step: Step) -> None:
        """Go a step on. The caller has seen to it that the turn leads to a gateway, and the marker
        is not out twice."""
        self.told.add(step)
        self._experience = None

    def undo(self, steps: int = 1) -> None:
        """Take the last steps back; there are as many."""
        last = self.told.last - steps
        self.told.cut(last)
        self._experience = None
        if self._rules is not None and self._rules.experience.steps > last:
            self._rules.undo(self._rules.experience.steps - last)
        if self._none is not None and last < self._none:
            self._none = None
        if last >= self._done:
            return
        for step in [step for step in self._kept if step > last]:
            self._many_kept -= len(self._kept.pop(step))
        if self._searching and last in self._kept:
            self._level, self._done = self._kept[last], last
            self._certainty.undo(self._level, last)
        else:  # what they were is found again, when it is asked for
            origin = self._certainty.origin
            self._certainty = Certainty(self.told)
            self._certainty.origin = origin
            self._begin()

    def status(self, watch: Watch) -> Status:
        """What is known now; at the time limit, what is known until then."""
        known = Status(self.told.last)
        with Attempt() as attempt:
            self._advance(watch)
            if self._searching:
                return self._status(watch)
            rules = self._stepwise(watch)
            kind, cost, best = rules.best(watch)
            maps = tuple(ReadMap(self.experience, at) for at in best[:MAPS])
            every = len(best) <= MAPS
            known = replace(known, kind=kind, cost=cost, maps=maps, all_best=every)
            certain = rules.certain(watch)
            known = replace(known, certain=certain)
            number, exact, none = rules.number(certain, watch)
            if number >= 0:
                known = replace(known, hypotheses=number, exact=exact, none_since=none)
            self._return(rules, watch)
        return replace(known, fault=attempt.fault)

    def count(self, watch: Watch) -> tuple[int, bool]:
        """How many hypotheses there are, and true; or a number that they are more than (-1 if
        none was found as yet), and false."""
        self._advance(watch)
        if not self._searching:
            return self._stepwise(watch).count(watch)
        if self._none is not None:
            return 0, True
        return min(len(self._level), self.most), len(self._level) <= self.most

    def _advance(self, watch: Watch) -> None:
        """Find the hypotheses after the last step by search, unless they are too many."""
        tree = self._tree
        while self._searching and self._none is None and self._done < self.told.last:
            level: list[Living] = []
            plain = True
            for number, one in enumerate(self._level):
                if number % OFTEN == 0:
                    watch.tick()
                children = tree.children(one)
                plain &= len(children) == 1
                level += [tree.enter(one, arrival) for arrival in children]
                if len(level) > self._living:
                    self._searching = False
                    return
            if level:
                self._done += 1
                self._level = level
                self._certainty.step(level, plain)
                self._keep()
            else:
                self._none = self._done + 1

    def _keep(self) -> None:
        """Keep the hypotheses after this step for when later ones are taken back."""
        self._kept[self._done] = self._level
        self._many_kept += len(self._level)
        while self._many_kept > KEPT and len(self._kept) > 1:
            self._many_kept -= len(self._kept.pop(next(iter(self._kept))))

    def _status(self, watch: Watch) -> Status:
        """The status, where the hypotheses are at hand."""
        step = self.told.last
        if self._none is not None:
            return Status(step, 0, True, self._none, all_best=True, certain=Certain())
        number, exact = self.count(watch)
        known = Status(step, number, exact, certain=self._certainty.after(step))
        with Attempt() as attempt:
            kind, cost, best = self._best(watch)
            maps = tuple(LivingMap(one, self.told) for one in best[:MAPS])
            known = replace(known, kind=kind, cost=cost, maps=maps, all_best=len(best) <= MAPS)
        return replace(known, fault=attempt.fault)

    def _best(self, watch: Watch) -> tuple[str, tuple[int, ...], list[Living]]:
        """The best maps: of what kind they are, and their cost."""
        closed = [one for one in self._level if one.form.closed]
        costs: dict[tuple[int, int], list[Living]] = {}
        for one in closed or self._level:
            costs.setdefault(one.form.cost, []).append(one)
        least: tuple[int, ...] = ()
        best: list[Living] = []
        for paths, places in sorted(costs):
            for number, one in enumerate(costs[paths, places]):
                if number % OFTEN == 0:
                    watch.tick()
                cost = len(one.form.exceptions(self.told)), paths, places
                if not best or cost < least:
                    least, best = cost, []
                if cost == least:
                    best.append(one)
            if least[0] == 0:  # and others with none have more paths, or places
                break
        return "optimal" if closed else "best so far", least, best

    def _stepwise(self, watch: Watch) -> Stepwise:
        """The program, which knows all steps."""
        told = self.told
        if self._rules is None:
            self._rules = Stepwise(told.slots, told.steps[0], *self._asked)
        rules = self._rules
        if rules.experience.steps < told.last:
            while rules.experience.steps < told.last:
                watch.tick()
                rules.step(told.steps[rules.experience.steps + 1])
        return rules

    def _return(self, rules: Stepwise, watch: Watch) -> None:
        """Go on by search, if clingo's hypotheses have become few."""
        found = rules.level
        if found is None or len(found) * FEWER > self._living:
            return
        level: list[Living] = []
        way = [self._tree.root()]  # to the hypothesis before
        for number, at in enumerate(sorted(found)):
            if number % OFTEN == 0:
                watch.tick()
            while tuple(one.visit.gateway for one in way) != at[: len(way)]:
                way.pop()
            for arrival in at[len(way) :]:
                way.append(self._tree.enter(way[-1], arrival))
            level.append(way[-1])
        self._level, self._done, self._none = level, self.told.last, None
        self._kept, self._many_kept = {self._done: level}, len(level)
        self._certainty.begin(level, self._done)
        self._searching = True
