"""How ambiguous a walk in a known world is.

It counts how many maps remain after each step of the walk. Then the questions are which further
walk leaves only one of them, and whether the real one is preferred.
"""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

from topomap.model.experience import DState, Experience, Step
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.questions import robot
from topomap.questions.machine import Spent, Work
from topomap.questions.refuting import Refuted, refute
from topomap.questions.standings import Standing, standing
from topomap.runtime.watch import Attempt, Watch
from topomap.search.hypothesis import OFTEN
from topomap.search.living import Living, Told, Tree
from topomap.solver import solving
from topomap.worlds import route
from topomap.worlds.environment import Environment
from topomap.worlds.instance import measured
from topomap.worlds.senses import Senses

KNOWLEDGE = "all", "planar", "compass"  # what is known of maps besides views: nothing; a property
KINDS = (*KNOWLEDGE, "closed")
MOST_LIVING = 100  # maps of which the walk is sought that leaves one
MOST_WORK = 20_000_000  # moves of maps, in the search for a walk that leaves only one


@contextlib.contextmanager
def within(watch: Watch, seconds: float) -> Iterator[Attempt]:
    """Limit a part of the work to a number of seconds.

    Its ``fault`` says why it was cut. What ends the whole work is passed on.
    """
    attempt = Attempt()
    with watch.deadline.earlier(seconds), attempt:
        yield attempt
    watch.tick()


@dataclass(frozen=True)
class Walk:
    """A walk in a world: where it begins, and the slots by which it leaves places."""

    environment: Environment
    start: Gateway
    route: Sequence[int]

    def seen(self, compass: bool) -> tuple[Experience, tuple[DState, ...]]:
        """What is seen on it, and the true hypothesis."""
        return measured(self.environment, self.start, self.route, Senses(compass=compass))

    def whole(self) -> bool:
        """Whether it has gone every way, so that the true map is closed."""
        experience, truth = self.seen(False)
        return len(experience.map_of(truth).links) == len(self.environment.map.links)

    def real(self, kind: str) -> bool:
        """Whether the true map is one of the maps of a kind."""
        experience, truth = self.seen(False)
        real = experience.map_of(truth)
        if real.path_axiom_fault() is not None or (kind == "planar" and real.genus()):
            return False
        return kind != "closed" or self.whole()

    def stands(self, compass: bool) -> Standing:
        """The world, and where the agent stands in it at the end."""
        world, (place, slot) = self.environment.map, self.start
        for out in self.route:
            place, slot = world.links[place, out]
        north = dict.fromkeys(world.stars, 0) if compass else {}
        return Standing(world, (place, slot), None, north)


def until_all(world: TopologicalMap, start: Place, seed: int, most: int) -> list[int]:
    """The slots of a random walk until it has gone every way, ``most`` steps at most."""
    place, taken, left = start, [], {*world.links}
    for slot in islice(route.walk(world, start, seed), most):
        if not left:
            break
        taken.append(slot)
        end = world.links[place, slot]
        left -= {(place, slot), end}
        place = end[0]
    return taken


@dataclass(frozen=True)
class Counted:
    """How many maps remain after each step from 0, and how many of them are closed.

    If they were not counted to the end, ``why`` says why: "maps" means that after the next step
    there are more than ``most``; else it is what cut the work. ``level`` has the maps after the
    last step that was counted.
    """

    maps: tuple[int, ...]
    closed: tuple[int, ...]
    most: int
    why: str | None
    level: Sequence[Living]
    told: Told

    @property
    def living(self) -> Sequence[Living] | None:
        """The maps that remain at the end; None if they were not counted to the end."""
        return None if self.why else self.level

    def document(self) -> dict[str, Any]:
        """What is known of it, as JSON."""
        stopped = len(self.maps) if self.why else None
        return {
            "maps": list(self.maps),
            "closed": list(self.closed),
            "stopped": stopped,
            "more_than": self.most if self.why == "maps" else None,
            "why": self.why,
            "one_since": None if self.why else one_since(self.maps),
            "closed_one_since": None if self.why else one_since(self.closed),
        }


def steps_of(experience: Experience) -> Iterator[Step]:
    """The steps of an experience that tells nothing but views, landmarks, pairs and a compass."""
    for step, view in enumerate(experience.views):
        yield Step(
            turn=experience.turns[step - 1] if step else None,
            view=view,
            landmarks=experience.landmarks[step],
            compass=experience.compass[step] if experience.compass else None,
            straight=frozenset(experience.straight[step]) if experience.straight else None,
        )


def counted(
    experience: Experience, planar: bool, most: int, seconds: float, watch: Watch
) -> Counted:
    """Count the maps after each step, breadth-first.

    It ends when there are more than ``most``, or when the time for it is over.
    """
    first, *steps = steps_of(experience)
    told = Told(experience.slots, first, experience.drift, experience.stretch, experience.tolerance)
    tree = Tree(told, planar)
    level = [tree.root()]
    maps, closed, why = [1], [_closed(level)], None
    with within(watch, seconds) as attempt:
        for step in steps:
            told.add(step)
            following: list[Living] = []
            for number, one in enumerate(level):
                if number % OFTEN == 0:
                    watch.tick()
                following += [tree.enter(one, arrival) for arrival in tree.children(one)]
                if len(following) > most:
                    why = "maps"
                    break
            if why:
                break
            level = following
            maps.append(len(level))
            closed.append(_closed(level))
    return Counted(tuple(maps), tuple(closed), most, why or attempt.fault, level, told)


def _closed(level: Sequence[Living]) -> int:
    return sum(one.form.closed for one in level)


def one_since(numbers: Sequence[int]) -> int | None:
    """The step from which on there is one map, to the end; None if there is not one at the end."""
    since = None
    for step, number in enumerate(numbers):
        since = (step if since is None else since) if number == 1 else None
    return since


def unfolding(experience: Experience) -> tuple[DState, ...]:
    """Make the map in which each step along a new way came to a new place.

    No walk refutes it, as long as each further step along a new way comes to a new place, too.
    """
    slots = experience.slots
    links: dict[Gateway, Gateway] = {}
    at = [(0, 0)]
    for step, turn in enumerate(experience.turns, 1):
        assert turn is not None
        place, slot = at[-1]
        out, new = (place, (slot + turn) % slots), (step, 0)
        if out not in links:
            links[out], links[new] = new, out
        at.append(links[out])
    return tuple(at)


@dataclass(frozen=True)
class Settled:
    """Which further walk leaves only one of the maps of a kind that remain at the end of a walk.

    ``kind`` is "one" if there is one map, the real one; "walk" if ``refuted.walk`` leaves only the
    real one; "never" if ``refuted.never`` of the others cannot be refuted by any walk; "others" if
    the real one is not among them, however many there are; "no map" if it is known that there is
    none; None if that is open, as ``why`` says. ``met`` is the number of these maps that were
    found, ``living`` the number of all of them, and ``others`` the number of those that are not the
    real one (both None if they were not counted). ``tried`` is the number of others for which it
    was found out what refutes them.
    """

    kind: str | None
    met: int
    living: int | None = None
    others: int | None = None
    tried: int = 0
    refuted: Refuted | None = None
    why: str | None = None

    def document(self) -> dict[str, Any]:
        """What is known of it, as JSON."""
        found = self.refuted
        walk = found.walk if found and self.kind == "walk" else None
        return {
            "kind": self.kind,
            "met": self.met,
            "living": self.living,
            "others": self.others,
            "tried": self.tried,
            "never": found.never if found else None,
            "walk": None if walk is None else list(walk),
            "at_least": found.at_least if found and walk is not None else None,
            "shortest": bool(found and found.shortest and self.tried == self.others)
            if walk is not None
            else None,
            "why": self.why,
        }


def settled(walk: Walk, kind: str, counted: Counted, seconds: float, watch: Watch) -> Settled:
    """The further walk that leaves only one of the maps of one of KINDS."""
    compass = kind == "compass"
    experience, truth = walk.seen(compass)
    found: list[tuple[DState, ...]] = []
    many, met, why = None, 0, counted.why
    if (living := counted.living) is not None:
        level = [one for one in living if one.form.closed or kind != "closed"]
        many = met = len(level)
        found = [_at(one, experience.slots) for one in level[: MOST_LIVING + 1]]
    elif kind == "closed":
        with within(watch, seconds) as attempt:
            query = Query(frozenset({"closed"}))
            for one_map in solving.hypotheses(experience, query, watch):
                if one_map is not None:
                    met += 1
                    found += [one_map.at] * (len(found) <= MOST_LIVING)
                if met > counted.most:
                    break
            else:
                many = met
        why = attempt.fault
    if many == 0:
        return Settled("no map", 0, 0, 0)
    real = walk.real(kind)
    others = None if many is None else many - real
    if not real:
        return Settled("others", met, many, others, why=None if many is not None else why)
    if others == 0:
        return Settled("one", met, many, 0)
    # The unfolding is consistent with whatever else is known, but it is not closed if the world is
    # not a tree.
    first = [unfolding(experience)] if kind != "closed" else []
    tried = [at for at in dict.fromkeys([*first, *found]) if at != truth][:MOST_LIVING]
    if not tried:
        return Settled(None, met, many, others, why=why)
    try:
        with within(watch, seconds) as attempt:
            standings = [standing(experience, at) for at in tried]
            refuted = refute(walk.stands(compass), standings, Work(watch, MOST_WORK))
    except Spent:
        return Settled(None, met, many, others, why="effort")
    if attempt.fault:
        return Settled(None, met, many, others, why=attempt.fault)
    return Settled("never" if refuted.never else "walk", met, many, others, len(tried), refuted)


def _at(one: Living, slots: int) -> tuple[DState, ...]:
    return tuple(divmod(gateway, slots) for gateway in one.visit.gateways())


@dataclass(frozen=True)
class Preferred:
    """What minimality prefers at the end of a walk.

    It has the ``kind`` of the best maps, their number (with ``more``, there may be others), what
    each costs, whether the ``truth`` is among them, and what the truth costs. What is open is None,
    and ``why`` gives the reason.
    """

    kind: str | None
    maps: int | None
    more: bool
    cost: tuple[int, ...]
    truth: bool | None
    true_cost: tuple[int, int, int] | None
    why: str | None = None

    def document(self) -> dict[str, Any]:
        """What is known of it, as JSON."""
        return {
            "kind": self.kind,
            "maps": self.maps,
            "more": self.more,
            "cost": list(self.cost),
            "truth": self.truth,
            "true_cost": None if self.true_cost is None else list(self.true_cost),
            "why": self.why,
        }


def preferred(walk: Walk, knowledge: str, seconds: float, watch: Watch) -> Preferred:
    """What minimality prefers at the end of a walk, with one of KNOWLEDGE."""
    experience, truth = walk.seen(knowledge == "compass")
    query = Query(frozenset({"planar"} if knowledge == "planar" else ()))
    real, cost = experience.map_of(truth), None
    if real.path_axiom_fault() is None:
        exceptions = sum(1 for _ in real.exceptions())
        cost = exceptions, len(real.paths()), len(real.stars)
    best: list[Found] = []
    with within(watch, seconds) as attempt:
        best = robot.best(experience, query, watch)
    if attempt.fault:
        return Preferred(None, None, False, (), None, cost, attempt.fault)
    if not best:
        return Preferred("no map", 0, False, (), False, cost)
    more = len(best) == robot.MOST_MAPS
    among = any(one.at == truth for one in best)
    return Preferred(
        best[0].kind,
        len(best),
        more,
        best[0].cost,
        among or (None if more else False),
        cost,
    )
