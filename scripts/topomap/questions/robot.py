"""A robot in a world that it does not know, which maps the world by this program alone.

It considers the best maps of what it has seen (``solving.best``), and walks what ``explore`` plans
for them. It stops when the best map is closed and the only one, or when no walk can tell the best
ones apart. But a closed map that has exceptions to consistent boundaries is often false, because a
small map explains much. So, before it accepts one, the robot walks what is planned for the maps
without exceptions, until they are all too large (``rivals``).
"""

import contextlib
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from topomap.model.experience import DState, Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.topology import Gateway, Place, TopologicalMap, label
from topomap.model.words import number
from topomap.questions import explore
from topomap.questions.standings import Prediction, predict, standing
from topomap.runtime import nx
from topomap.runtime.errors import InputError
from topomap.runtime.watch import Attempt, Watch
from topomap.solver import choice, solving
from topomap.worlds import route
from topomap.worlds.environment import Environment
from topomap.worlds.instance import NOTHING, measured
from topomap.worlds.senses import Senses
from topomap.worlds.tours import tour as tour_of

MOST_MAPS = 100  # a walk is planned for at most so many best maps
LARGER = 50  # percent: so many more places may a rival of a closed map with exceptions have
WALKS = 101  # the number of random walks for the median
ENDED = ("settled", "bisimilar", "no map")  # the ways to end that are not a limit
ENDS = {
    "settled": "one closed map is optimal",
    "bisimilar": "no walk can tell the optimal maps apart",
    "no map": "no map is left that has what was asked for",
    "steps": "as many steps as it may walk; partial: steps",
}
HEAD = "environment", "places", "ways", "signs", "steps", "tour", "random", "maps", "truth"
OFTEN = 1000  # the number of steps of a random walk between two looks at the watch
PATIENCE = 1000  # a random walk is given up after so many steps for each way


@dataclass(frozen=True)
class Outcome:
    """How an exploration ended.

    ``end`` is "settled" (one closed map is optimal), "bisimilar" (there are several closed ones
    that no walk tells apart), "steps" (it has walked as many as it may), or why it was cut short.

    ``maps`` are the best maps at the end. ``truth`` tells whether the real hypothesis is among them
    and its map is the whole world. It is None if that is open: the robot could go no further, or
    there may be more best maps than were kept. ``whole`` tells whether the best maps are all that
    there are. ``query`` is what was taken for granted.
    """

    world: TopologicalMap
    start: Gateway
    experience: Experience
    maps: tuple[Found, ...]
    end: str
    truth: bool | None
    others: "Others"
    whole: bool
    query: Query

    @property
    def steps(self) -> int:
        """The number of steps that the robot walked."""
        return self.experience.steps

    @property
    def tour(self) -> int | None:
        """The length of a tour over every way with the map known; None if none was found."""
        return self.others.tour

    @property
    def random(self) -> int | None:
        """The median number of steps in which random walks take every way.

        It is None if most of them need more than PATIENCE steps for each way, or were not walked to
        the end.
        """
        return self.others.random

    @property
    def fault(self) -> str | None:
        """Why the robot, or what it is compared with, did not come to an end; or None."""
        return self.others.fault or (None if self.end in ENDED else self.end)

    @property
    def found(self) -> bool:
        """Whether it came to one closed map, which is the real one."""
        return self.end == "settled" and bool(self.truth)

    def document(self) -> dict[str, Any]:
        """The exploration as JSON."""
        return {
            "places": len(self.world.stars),
            "ways": len(self.world.links) // 2,
            "signs": len(self.world.landmarks),
            "end": self.end,
            "steps": self.steps,
            "best_maps": len(self.maps) if self.maps or self.end == "no map" else None,
            "truth": self.truth,
            "tour": self.tour,
            "random": self.random,
        }

    def lines(self, name: str) -> Iterator[str]:
        """The exploration as lines to read; ``name`` is the environment's."""
        world = self.world
        ways = len(world.links) // 2
        signs = number(len(world.landmarks), "sign")
        yield f"{name}: {number(len(world.stars), 'place')}, {number(ways, 'way')}, {signs}"
        yield f"{number(self.steps, 'step')} walked: {self._end()}"
        fault = world.path_axiom_fault()
        if fault and "no_path_axiom" not in self.query.parts:
            yield f"the truth breaks the path axiom, and so is not a map: {fault}; --no-path-axiom"
        elif breaks := sum(1 for _ in world.exceptions()):
            yield f"the truth has {number(breaks, 'exception')} to consistent boundaries"
        so_far = " so far" * (self.end not in ENDED)
        if self.maps and self.truth is None:
            many = number(len(self.maps), "best map")
            or_more = " or more" * (len(self.maps) == MOST_MAPS)
            yield f"{many}{or_more}{so_far}; whether the truth is one of them is open"
        elif len(self.maps) == 1:
            yield f"the best map{so_far} is {'' if self.truth else 'not '}the truth"
        elif self.maps:
            is_there = "" if self.truth else "not "
            yield f"{len(self.maps)} best maps{so_far}, the truth is {is_there}among them"
        yield from self.others.lines()

    def _end(self) -> str:
        """How the exploration ended, in words."""
        if self.end == "bisimilar" and len(self.maps) == MOST_MAPS:
            return f"no walk can tell {MOST_MAPS} of the optimal maps apart"
        return ENDS.get(self.end, f"partial: {self.end}")


@dataclass(frozen=True)
class Others:
    """What a robot is compared with, in steps.

    It has a tour by an agent that knows the map, and random walks. What is missing is None: it is
    out of reach, or was cut short if ``fault`` says why.
    """

    tour: int | None
    random: int | None
    fault: str | None = None

    def lines(self) -> Iterator[str]:
        """The comparison as lines to read."""
        missing = f"not known; partial: {self.fault}" if self.fault else "not within reach"
        tour = missing if self.tour is None else number(self.tour, "step")
        yield f"a tour over every way, by one who knows the map: {tour}"
        walked = missing if self.random is None else number(self.random, "step")
        yield f"a random walk over every way (median): {walked}"


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Write a table of several robots, one in each line, and how many found the real map."""
    lines: list[tuple[str, ...]] = [HEAD]
    for row in rows:
        maps = row["best_maps"]
        truth = {True: "yes", False: "no", None: "open"}[row["truth"]]
        truth = f"one of {maps}" if row["truth"] and maps > 1 else truth
        cells = {**row, "maps": maps, "truth": truth, "random": row["random"] or "-"}
        cells["tour"] = "-" if row["tour"] is None else row["tour"]
        lines.append(tuple(str(cells[key]) for key in HEAD))
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = "".join(
        line[0].ljust(widths[0])
        + "".join(f"  {cell:>{width}}" for cell, width in zip(line[1:], widths[1:], strict=True))
        + "\n"
        for line in lines
    )
    settled = [row for row in rows if row["end"] == "settled"]
    true = sum(bool(row["truth"]) for row in settled)
    return (
        text + f"{number(len(settled), 'robot')} of {len(rows)} with one closed map, {true} true\n"
    )


def start_of(
    environment: Environment, place: str | None = None, facing: int | None = None
) -> tuple[Environment, Gateway]:
    """Find the part of an environment that can be reached from a place, and the first gateway.

    By default it is the smallest place, and its smallest gateway.

    Raises:
        InputError: There is no such place or gateway.
    """
    stars = environment.map.stars
    start = environment.place(place) if place is not None else min(stars)
    slot = min(stars[start]) if facing is None else facing
    if slot not in stars[start]:
        raise InputError(f"{environment.name}: place {label(start)} has no gateway {slot}")
    return replace(environment, map=reached(environment.map, start)), (start, slot)


def reached(world: TopologicalMap, start: Place) -> TopologicalMap:
    """The part of a world that can be reached."""
    graph = nx.Graph((a[0], b[0]) for a, b in world.edges())
    there = nx.node_connected_component(graph, start)
    return TopologicalMap(
        world.slots,
        {place: star for place, star in world.stars.items() if place in there},
        {gateway: end for gateway, end in world.links.items() if gateway[0] in there},
        {place: signs for place, signs in world.landmarks.items() if place in there},
    )


def others(world: TopologicalMap, start: Place, watch: Watch) -> Others:
    """Find what a robot in a world is compared with; the watch may end the work."""
    tour = random = None
    with Attempt() as attempt:
        watch.phase("a tour")
        with contextlib.suppress(InputError):  # the world may be too large
            tour = len(tour_of(world, start, watch))
        watch.phase("random walks")
        random = random_walk(world, start, watch=watch)
    return Others(tour, random, attempt.fault)


def random_walk(
    world: TopologicalMap, start: Place, walks: int = WALKS, watch: Watch | None = None
) -> int | None:
    """The median number of steps until random walks have travelled along every way."""
    lengths = [_length(world, start, seed, watch or Watch()) for seed in range(walks)]
    median = statistics.median_low(lengths)
    return None if median == float("inf") else int(median)


def _length(world: TopologicalMap, start: Place, seed: int, watch: Watch) -> float:
    """How many steps a random walk takes to go along every way; infinite if it is given up."""
    ways = len(world.links) // 2
    taken: set[Gateway] = set()
    place = start
    for steps, slot in enumerate(islice(route.walk(world, start, seed), PATIENCE * ways), 1):
        if steps % OFTEN == 1:
            watch.tick()
        there = world.links[place, slot]
        taken |= {(place, slot), there}
        if len(taken) == 2 * ways:
            return steps
        place = there[0]
    return float("inf")


class Robot:
    """Where a robot is in the world, what it did, and what it saw."""

    def __init__(self, environment: Environment, start: Gateway, senses: Senses):
        self.environment, self.world, self.start = environment, environment.map, start
        self.senses = senses
        self.dstate = start
        self.route: list[int] = []
        self.drops: list[int] = []

    def step(self, turn: int) -> None:
        """Turn so many slots clockwise, and travel."""
        place, slot = self.dstate
        self.route.append((slot + turn) % self.world.slots)
        self.dstate = self.world.links[place, self.route[-1]]

    def experience(self) -> Experience:
        """What the robot did and saw."""
        return self._measured()[0]

    def _measured(self) -> tuple[Experience, tuple[DState, ...]]:
        """What the robot did and saw, and the true hypothesis."""
        return measured(self.environment, self.start, self.route, self.senses, self.drops)

    def sight(self) -> Prediction:
        """What the robot sees where it is."""
        world, place = self.world, self.dstate[0]
        marker = len(self.route) in self.experience().markers
        points = self.dstate[1] if self.senses.compass else None
        landmarks = world.landmarks.get(place, frozenset())
        return Prediction(world.view(self.dstate), landmarks, marker, points)

    def mapped(self, maps: Sequence[Found]) -> bool:
        """Tell whether one of the maps is the whole world, with the robot where it really is."""
        experience, truth = self._measured()
        whole = len(experience.map_of(truth).links) == len(self.world.links)
        return whole and any(one.at == truth for one in maps)


def simulate(
    environment: Environment,
    start: Gateway,
    query: Query,
    watch: Watch,
    most: int,
    marker: bool = False,
    senses: Senses = NOTHING,
) -> Outcome:
    """Let a robot explore a world, from a gateway, for at most ``most`` steps.

    It must be possible to walk to every place of the world (see ``reached``). The parts of the
    query are taken for granted; ``senses`` tells what the robot measures besides views.
    """
    robot, world = Robot(environment, start, senses), environment.map
    maps: list[Found] = []
    end = ""
    with Attempt() as attempt:
        while not end:
            watch.phase(f"step {len(robot.route)}")
            maps = best(robot.experience(), query, watch)
            end = _go_on(robot, maps, query, watch, most, marker)
    if attempt.fault:
        end = attempt.fault
        maps = [one for one in maps if len(one.at) == len(robot.route) + 1]
    whole = end in ENDED and len(maps) < MOST_MAPS
    truth = robot.mapped(maps) or (False if whole else None)
    told = others(world, start[0], watch)
    return Outcome(world, start, robot.experience(), tuple(maps), end, truth, told, whole, query)


def _go_on(
    robot: Robot, maps: Sequence[Found], query: Query, watch: Watch, most: int, marker: bool
) -> str:
    """Walk what is planned for the best maps, or for their rivals.

    The walk ends when one of them is refuted, or when there is something new.

    Returns:
        Why the robot does not walk; an empty text if it does.
    """
    if not maps:
        return "no map"
    experience = robot.experience()
    others = rivals(experience, query, maps, watch)
    if len(maps) == 1 and maps[0].kind == "optimal" and not others:
        return "settled"
    if len(robot.route) == most:
        return "steps"
    standings = [standing(experience, one.at) for one in others or maps]
    carried = marker and not robot.drops
    slots = robot.world.slots
    plan = explore.plan(slots, standings, watch, proofs=False)
    if plan.kind == "bisimilar":
        # With proofs, in case it stays so.
        plan = explore.plan(slots, standings, watch, marker=carried)
    if plan.kind in ("settled", "bisimilar") and not others:
        return plan.kind
    if not plan.turns:
        return "a walk was not found" if plan.fault in explore.LIMITS else str(plan.fault)
    walks = [predict(one, plan.turns, plan.drop) for one in standings]
    for nth, turn in enumerate(plan.turns):
        if len(robot.route) == most or turn not in robot.world.view(robot.dstate):
            # If the turn is not possible, the real map is another one, distinguished from these.
            break
        if nth == plan.drop:
            robot.drops.append(len(robot.route))
        robot.step(turn)
        seen = robot.sight()
        if any(nth >= len(walk) or walk[nth] != seen for walk in walks):
            break
    return ""


def best(experience: Experience, query: Query, watch: Watch) -> list[Found]:
    """Find the optimal maps, or those that are best so far, in order; at most MOST_MAPS."""
    return _first(solving.best(experience, query, watch, choice.hypotheses))


def rivals(
    experience: Experience, query: Query, maps: Sequence[Found], watch: Watch
) -> list[Found]:
    """Find the rivals of best maps that are closed and have exceptions.

    They are the maps without any exception, with the fewest paths, then the fewest places, that
    have at most LARGER percent more places; in order, and at most MOST_MAPS. They have pending
    gateways, so a walk can test them. As long as there are some, the best maps are not accepted.

    There is a limit because the map in which every step came to a new place is never refuted, and
    mostly has no exceptions. The limit is less than twice the number of places: a map that is a
    double cover of the closed one often has no exceptions, either, and no walk separates the two.
    """
    if maps[0].kind != "optimal" or not maps[0].cost[0]:
        return []
    most = maps[0].cost[-1] * (100 + LARGER) // 100
    bounded = replace(query, places=min(most, query.places or most))
    asked = bounded.having("boundary", "minimal")
    return _first(choice.hypotheses(experience, asked, watch, "best so far"))


def _first(coming: Iterator[Found | None]) -> list[Found]:
    """The best maps in order; at most MOST_MAPS."""
    proved = (one for one in coming if one and one.proved)
    return sorted(islice(proved, MOST_MAPS), key=lambda one: one.at)
