"""An experience as it happens: what is known after each step.

It tells how many hypotheses there are, the best maps, and what is certain.

While there are few hypotheses, all of them are kept, each with its map, and a step enters the
children of each (``search/living.py``). The cost of this does not grow with the log. If there are
too many (LIVING), clingo takes over (``stepwise.py``) until they have become few again. Both give
the same answers.

But clingo's program grows with each step. If it also becomes too large (MOST_ATOMS), only SOME of
the hypotheses are kept, those with the fewest paths and places. Then little is proved, and the
answers are partial, but a step costs no more than before.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from topomap.model.compact import CompactMap, Numbering
from topomap.model.exceptions import NamedException, exceptions_of
from topomap.model.experience import DState, Experience, Step
from topomap.model.found import UNPROVED
from topomap.runtime.watch import Attempt, Watch
from topomap.search.certainty import Certain, Certainty
from topomap.search.hypothesis import OFTEN
from topomap.search.living import Living, Told, Tree
from topomap.solver.stepwise import MAPS, Asked, Stepwise

LIVING = 200_000  # places of all hypotheses together: up to so many, all are kept with their maps
FEWER = 4  # clingo is no longer asked when there are so many times fewer
MOST_ATOMS = 30_000  # ground atoms: if clingo's program has more, it is no longer asked
SOME = 20_000  # places of the hypotheses that are kept in that case
KEPT, KEPT_STEPS = 5_000, 500  # hypotheses, and steps, that are kept in case steps are taken back
TOO_MANY = "too many hypotheses"  # why an answer is partial if only some are kept

__all__ = ["Certain", "LivingMap", "OnlineSolver", "ReadMap", "Status"]

Sizes = tuple[int, int, int, int, int]  # places, links, paths, genus, pending gateways


class ReadMap:
    """A best map, as the dstates of its hypothesis after each step."""

    def __init__(self, experience: Experience, at: tuple[DState, ...]):
        self.experience, self.at = experience, at

    @cached_property
    def sizes(self) -> Sizes:
        """The numbers of places, links and paths, the genus, and the number of pending gateways."""
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
        """The exceptions to consistent boundaries."""
        return exceptions_of(self.experience, self.at)

    def way(self, most: int) -> list[DState]:
        """The dstates after the last steps, at most so many."""
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
        """The dstates after the last steps, at most so many."""
        visit = self.living.visit
        last = visit.gateways(max(0, visit.step + 1 - most))
        return [divmod(gateway, self.slots) for gateway in last]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ReadMap | LivingMap) and self.at == other.at

    def __hash__(self) -> int:
        return hash(self.at)


@dataclass(frozen=True)
class Status:
    """What is known after a step.

    ``exact`` is false if there are more hypotheses than ``hypotheses``. ``none_since`` is the first
    step after which there is none. ``maps`` are the best maps, and ``best`` has the dstates of
    each; ``all_best`` tells whether they are all. ``fault`` is why something is missing.
    """

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


EVERY = Asked()  # all hypotheses


class OnlineSolver:
    """An exploration that goes on from its start; steps can be taken back."""

    def __init__(
        self,
        slots: int,
        first: Step,
        asked: Asked = EVERY,
        living: int = LIVING,
        most_atoms: int = MOST_ATOMS,
    ):
        """Begin at the start, where the first view was seen.

        If the hypotheses have more than ``living`` places, clingo is asked (from the start, if that
        is 0), until its program has more than ``most_atoms`` atoms.
        """
        self.told = Told(slots, first, asked.drift, asked.stretch, asked.tolerance)
        self.most, self._living, self._most_atoms = asked.most, living, most_atoms
        self._asked = asked
        self._tree = Tree(self.told, asked.planar, asked.bound, asked.path_axiom)
        self._rules: Stepwise | None = None
        self._searching = living > 0
        self._large: int | None = None  # the step after which clingo's program was too large
        self._some = False  # whether only some of the hypotheses are kept
        self._certainty = Certainty(self.told)
        self._experience: Experience | None = None
        self._begin()

    def _begin(self) -> None:
        """Put the search at the start."""
        self._none: int | None = None
        self._level = [self._tree.root()]
        self._done = 0  # the step to which the hypotheses of ``_level`` belong
        # The last step of which all hypotheses were kept, and these, and these.
        self._whole = 0, self._level
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
        """The number of ground rules so far; 0 if clingo was not asked."""
        return 0 if self._rules is None else self._rules.rules

    @property
    def searching(self) -> bool:
        """Whether the hypotheses after the last answer were found by search, and are all kept."""
        return self._searching

    def step(self, step: Step) -> None:
        """Go a step on.

        The caller has checked that the turn leads to a gateway, and that the marker is not put down
        twice.
        """
        self.told.add(step)
        self._experience = None

    def undo(self, steps: int = 1) -> None:
        """Take the last steps back; there must be as many."""
        last = self.told.last - steps
        self.told.cut(last)
        self._experience = None
        if self._rules is not None and self._rules.experience.steps > last:
            self._rules.undo(self._rules.experience.steps - last)
        if self._none is not None and last < self._none:
            self._none = None
        if self._some and self._large is not None and last < self._large:
            self._some, self._searching, self._large = False, self._living > 0, None
            self._done = last + 1  # so they are found again
        if last >= self._done:
            return
        for step in [step for step in self._kept if step > last]:
            self._many_kept -= len(self._kept.pop(step))
        if (self._searching or self._some) and last in self._kept:
            self._level, self._done = self._kept[last], last
            if not self._some:
                self._certainty.undo(self._level, last)
                self._whole = last, self._level
        elif self._some:
            self._done, self._level = self._whole
        else:  # they are found again when they are asked for
            origin = self._certainty.origin
            self._certainty = Certainty(self.told)
            self._certainty.origin = origin
            self._begin()

    def status(self, watch: Watch) -> Status:
        """Tell what is known now; at the time limit, what is known so far."""
        known = Status(self.told.last)
        with Attempt() as attempt:
            rules = self._program(watch)
            if rules is None:
                return self._partial(watch) if self._some else self._status(watch)
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
        """Count the hypotheses.

        Returns:
            Their number and True; or False and a number that they exceed (-1 if none has been
            found).
        """
        rules = self._program(watch)
        if rules is not None:
            return rules.count(watch)
        if self._some:
            return min(len(self._level) - 1, self.most), False
        if self._none is not None:
            return 0, True
        return min(len(self._level), self.most), len(self._level) <= self.most

    def _advance(self, watch: Watch) -> None:
        """Find the hypotheses after the last step by search, unless they are too many."""
        tree = self._tree
        while self._none is None and self._done < self.told.last:
            if not self._searching and not self._some:
                return
            level: list[Living] = []
            plain, places = True, 0
            for number, one in enumerate(self._level):
                if number % OFTEN == 0:
                    watch.tick()
                children = tree.children(one)
                plain &= len(children) == 1
                for arrival in children:
                    level.append(tree.enter(one, arrival))
                    places += len(level[-1].form.number)
                if places > self._living and not self._some:
                    self._searching = False
                    return
            if self._some and places > SOME:
                level = _simplest(level)
            if level or self._some:
                self._done += 1
                self._level = level
                if not self._some:
                    self._certainty.step(level, plain)
                    self._whole = self._done, level
                self._keep()
            else:
                self._none = self._done + 1

    def _keep(self) -> None:
        """Keep the hypotheses after this step in case later steps are taken back."""
        kept = self._kept
        kept[self._done] = self._level
        self._many_kept += len(self._level)
        while len(kept) > 1 and (self._many_kept > KEPT or len(kept) > KEPT_STEPS):
            self._many_kept -= len(kept.pop(next(iter(kept))))

    def _status(self, watch: Watch) -> Status:
        """The status, if all hypotheses are known."""
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

    def _partial(self, watch: Watch) -> Status:
        """The status, if only some of the hypotheses are kept."""
        known = Status(self.told.last, fault=TOO_MANY)
        if not self._level:
            return known
        number, exact = self.count(watch)
        _, cost, best = self._best(watch)
        maps = tuple(LivingMap(one, self.told) for one in best[:MAPS])
        return replace(known, hypotheses=number, exact=exact, kind=UNPROVED, cost=cost, maps=maps)

    def _best(self, watch: Watch) -> tuple[str, tuple[int, ...], list[Living]]:
        """The best maps: their kind, and their cost."""
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
            if least[0] == 0:  # other maps without exceptions have more paths or places
                break
        return "optimal" if closed else "best so far", least, best

    def _program(self, watch: Watch) -> Stepwise | None:
        """The program, if clingo is to be asked; it knows all steps.

        It is None if the hypotheses after the last step are known, or some of them.
        """
        self._advance(watch)
        told = self.told
        if self._searching or self._some:
            return None
        if self._rules is None:
            self._rules = Stepwise(told.slots, told.steps[0], self._asked)
            self._rules.begin([tuple(one.visit.gateways()) for one in self._whole[1]])
        rules = self._rules
        while rules.size <= self._most_atoms:
            if rules.experience.steps == told.last:
                return rules
            watch.tick()
            rules.step(told.steps[rules.experience.steps + 1])
        self._rules, self._some, self._large = None, True, told.last
        self._done, self._level = self._whole
        self._advance(watch)
        return None

    def _return(self, rules: Stepwise, watch: Watch) -> None:
        """Go back to the search if clingo's hypotheses have become few."""
        found, slots = rules.level, self.told.slots
        if found is None:
            return
        places = sum(gateway == step * slots for at in found for step, gateway in enumerate(at))
        if places * FEWER > self._living:
            return
        level: list[Living] = []
        way = [self._tree.root()]  # the way to the hypothesis before
        before: tuple[int, ...] = (0,)
        for number, at in enumerate(sorted(found)):
            if number % OFTEN == 0:
                watch.tick()
            pairs = enumerate(zip(before, at, strict=False))
            common = next((step for step, (one, other) in pairs if one != other), len(before))
            del way[common:]
            for arrival in at[common:]:
                way.append(self._tree.enter(way[-1], arrival))
            level.append(way[-1])
            before = at
        self._level, self._done, self._none = level, self.told.last, None
        self._kept, self._many_kept = {self._done: level}, len(level)
        self._whole = self._done, level
        self._certainty.begin(level, self._done)
        self._searching = True


def _simplest(level: Sequence[Living]) -> list[Living]:
    """The hypotheses with the fewest paths, then the fewest places, in their order.

    They have at most SOME places together.
    """
    order = sorted(range(len(level)), key=lambda number: level[number].form.cost)
    places = 0
    chosen: list[int] = []
    for number in order:
        places += len(level[number].form.number)
        if places > SOME and chosen:
            break
        chosen.append(number)
    return [level[number] for number in sorted(chosen)]
