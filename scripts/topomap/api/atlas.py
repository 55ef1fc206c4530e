"""The atlas of aliasing: how ambiguous walks in known worlds are."""

from collections.abc import Iterable, Iterator
from typing import Any

from topomap.documents.atlas import page
from topomap.model.reply import Reply
from topomap.model.topology import Gateway
from topomap.questions import peers
from topomap.questions.ambiguity import (
    KINDS,
    KNOWLEDGE,
    MOST_LIVING,
    Walk,
    counted,
    preferred,
    settled,
    until_all,
)
from topomap.runtime.watch import Attempt, Watch
from topomap.worlds.environment import Environment
from topomap.worlds.tours import tour

World = tuple[str, str, Environment, Gateway]  # its call, its name, what it is, and where to start


class Atlas(Reply):
    """What was found in worlds, as JSON and as a page."""

    def __init__(self, data: dict[str, Any], fault: str | None):
        super().__init__(fault)
        self._data = data

    def document(self) -> dict[str, Any]:
        """The atlas as JSON."""
        return self._data

    def lines(self) -> Iterator[str]:
        """The atlas as the lines of a page."""
        return page({**self._data, "fault": self.fault})


def atlas_under(
    watch: Watch,
    worlds: Iterable[World],
    most: int,
    seconds: float,
    steps: int,
    seed: int,
    learner: bool,
) -> Atlas:
    """Count the maps of a tour and of a random walk in each of some worlds.

    This runs under the watch of a command. What was found is kept when the time is over, except for
    the world that was begun.

    Parameters:
        worlds: The worlds, each with its call, its name, and where the walks begin.
        most: The largest number of maps that is counted. If there are more, only that is reported.
        seconds: The number of seconds that each part of the work may take.
        steps: The largest number of steps of the random walk.
        seed: The seed of the random walk.
        learner: Whether AALpy is to learn the worlds, if it is installed.
    """
    worlds = [*worlds]
    version = peers.peer() if learner else None
    rows: list[dict[str, Any]] = []
    with Attempt() as attempt:
        for call, name, environment, start in worlds:
            watch.title(name)
            row: dict[str, Any] = {"world": call, "name": name, **_size(environment)}
            row["walks"] = [
                {"walk": which, **_walked(watch, walk, most, seconds)}
                for which, walk in _walks(watch, environment, start, steps, seed)
            ]
            row["peer"] = _peer(watch, environment, start, seed, seconds) if version else None
            rows.append(row)
    data = {
        "worlds": len(worlds),
        "most": most,
        "seconds": seconds,
        "steps": steps,
        "seed": seed,
        "living": MOST_LIVING,
        "peers": {
            "aalpy": version,
            "tested": peers.TESTED,
            "seconds": peers.PATIENCE * seconds,
        }
        if version
        else None,
        "rows": rows,
    }
    return Atlas(data, attempt.fault)


def _size(environment: Environment) -> dict[str, int]:
    world = environment.map
    return {
        "places": len(world.stars),
        "ways": len(world.links) // 2,
        "slots": world.slots,
        "dstates": len(world.links),
    }


def _walks(
    watch: Watch, environment: Environment, start: Gateway, steps: int, seed: int
) -> Iterator[tuple[str, Walk]]:
    yield "tour", Walk(environment, start, tour(environment.map, start[0], watch))
    yield "random", Walk(environment, start, until_all(environment.map, start[0], seed, steps))


def _walked(watch: Watch, walk: Walk, most: int, seconds: float) -> dict[str, Any]:
    """What the atlas says about a walk."""
    counts = {}
    for kind in KNOWLEDGE:
        watch.phase(f"{len(walk.route)} steps, {kind}")
        experience, _ = walk.seen(kind == "compass")
        counts[kind] = counted(experience, kind == "planar", most, seconds, watch)
    watch.phase("further walks")
    settling = {
        kind: settled(walk, kind, counts["all" if kind == "closed" else kind], seconds, watch)
        for kind in KINDS
    }
    watch.phase("the best maps")
    best = {kind: preferred(walk, kind, seconds, watch) for kind in KNOWLEDGE}
    return {
        "steps": len(walk.route),
        "turns": list(walk.seen(False)[0].turns),
        "whole": walk.whole(),
        "maps": {kind: one.document() for kind, one in counts.items()},
        "settling": {kind: one.document() for kind, one in settling.items()},
        "preferred": {kind: one.document() for kind, one in best.items()},
    }


def _peer(
    watch: Watch, environment: Environment, start: Gateway, seed: int, seconds: float
) -> dict[str, Any]:
    """What AALpy learns about a world."""
    watch.phase("a learner")
    return {
        how: peers.learned(
            environment.map, start, how == "compass", seed, seconds, watch
        ).document()
        for how in ("turns", "compass")
    }
