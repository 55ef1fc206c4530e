"""A learner of automata without reset in a world: AALpy's hW, from the extra ``peers``.

The learner walks through the world as a robot does, and ends with one automaton. An input is a
turn. If there is a gateway in this direction, the agent leaves by it and sees what is beyond; if
there is none, it stays where it is and sees that. So the states of the world are its dstates, and a
smallest automaton has one state for each class of dstates that no walk tells apart.
"""

import random
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from topomap.model.topology import Gateway, TopologicalMap
from topomap.questions.ambiguity import within
from topomap.runtime.extras import lacking
from topomap.runtime.watch import Watch
from topomap.worlds.census import classes, look

MOST_INPUTS = 500_000
PATIENCE = 4  # a learner may take so many times as long as other parts of the work
TESTED = 200  # random inputs after which a hypothesis is accepted: AALpy's default
BLOCKED = "no gateway there"
INPUTS, ALIKE = "inputs", "all alike"  # why a learner is stopped, other than by lack of time


@dataclass(frozen=True)
class Learned:
    """The result of a learner of automata.

    ``inputs`` is the number of inputs that it gave; of these, ``moves`` led along a way, and
    ``tests`` tested a hypothesis, which was then kept or refuted. ``states`` is the number of
    states that it learned, ``dstates`` the number of dstates of the world, and ``least`` the number
    of states of the smallest automaton that predicts the world. ``right`` is whether what was
    learned predicts the world. If the learner did not end, ``why`` gives the reason, and what it
    learned is None.
    """

    inputs: int
    moves: int
    tests: int
    states: int | None
    dstates: int
    least: int
    right: bool | None
    why: str | None = None

    def document(self) -> dict[str, Any]:
        """What is known of it, as JSON."""
        return {**vars(self)}


def peer() -> str | None:
    """The version of AALpy, if it is installed."""
    return None if lacking("peers") else version("aalpy")


def learned(
    world: TopologicalMap, start: Gateway, compass: bool, seed: int, seconds: float, watch: Watch
) -> Learned:
    """Let AALpy's hW learn a world, from a gateway on."""
    from aalpy import SUL, RandomhWOracle, run_hW

    looks: dict[Gateway, Hashable] = {
        gateway: (look(world, gateway), gateway[1] if compass else None)
        for gateway in world.gateways()
    }
    dstates, least = len(looks), len({*classes(world, looks).values()})

    class Agent(SUL):  # type: ignore[misc]
        """An agent in the world, as AALpy needs it. It is never reset."""

        inputs = moves = 0
        dstate = start

        def pre(self) -> None:
            """A reset, which this agent does not have."""

        def post(self) -> None:
            """The end of a test, where nothing has to be done."""

        def step(self, turn: int) -> Hashable:
            watch.tick()
            if self.inputs >= MOST_INPUTS:
                raise _Enough(INPUTS)
            self.inputs += 1
            place, slot = self.dstate
            end = world.links.get((place, (slot + turn) % world.slots))
            if end is None:
                return BLOCKED
            self.dstate = end
            self.moves += 1
            return looks[end]

    class Tests(RandomhWOracle):  # type: ignore[misc]
        """AALpy's tests of a hypothesis.

        The first hypothesis has one state. Where its test finds nothing against it, AALpy 2.0 ends
        with an error of its own, so the work is stopped before that.
        """

        begun = False

        def find_cex(self, hypothesis: Any) -> Any:
            found = super().find_cex(hypothesis)
            if found is None and not self.begun:
                raise _Enough(ALIKE)
            self.begun = True
            return found

    agent, oracle = Agent(), Tests(TESTED)

    def made(states: int | None, right: bool | None, why: str | None = None) -> Learned:
        counts = agent.inputs, agent.moves, oracle.num_steps
        return Learned(*counts, states, dstates, least, right, why)

    alphabet = list(range(world.slots))
    why = None
    with within(watch, PATIENCE * seconds) as attempt, _drawn(seed):
        try:
            automaton = run_hW(
                alphabet, agent, oracle, "mealy", query_for_initial_state=False, print_level=0
            )
        except _Enough as enough:
            why = str(enough)
    if why := why or attempt.fault:
        return made(None, None, why)
    return made(automaton.size, _right(world, looks, agent.dstate, automaton))


class _Enough(Exception):
    """The learner is stopped; the message says why."""


@contextmanager
def _drawn(seed: int) -> Iterator[None]:
    """Seed Python's random module, from which AALpy draws."""
    state = random.getstate()
    random.seed(seed)
    try:
        yield
    finally:
        random.setstate(state)


def _right(
    world: TopologicalMap, looks: dict[Gateway, Hashable], dstate: Gateway, automaton: Any
) -> bool:
    """Tell whether an automaton predicts all that is seen in the world from a dstate on.

    It does so from the state in which it is.
    """
    met = {(dstate, automaton.current_state)}
    waiting = [*met]
    for (place, slot), state in waiting:
        for turn in range(world.slots):
            end = world.links.get((place, (slot + turn) % world.slots))
            seen = BLOCKED if end is None else looks[end]
            if state.output_fun[turn] != seen:
                return False
            pair = end or (place, slot), state.transitions[turn]
            if pair not in met:
                met.add(pair)
                waiting.append(pair)
    return True
