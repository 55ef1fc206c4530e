"""A chapter of the page: what it tells of one exploration.

It has the best maps, the replay, drawings, and counts by clingo, all found within a time limit.
"""

import time
from collections.abc import Iterator
from dataclasses import replace

from topomap.documents import maps
from topomap.documents.beginnings import beginning
from topomap.drawing import scenes, shapes
from topomap.drawing.ready import ready
from topomap.drawing.scenes import MOST_DRAWN, Scene
from topomap.drawing.shapes import Drawing
from topomap.model.experience import Experience
from topomap.model.found import Cube
from topomap.model.query import Query
from topomap.page.replay import SHOWN, Step, replay
from topomap.runtime.errors import InputError
from topomap.runtime.limits import LARGEST
from topomap.runtime.watch import Attempt, Late, Watch
from topomap.solver import solving
from topomap.solver.enumeration import best_maps

SHARE = 0.2  # the share of the time for pictures that one picture may take
SMALL = 100  # the largest number of places in a small picture


def given_maps(file: str, path: str, whole: Experience, query: Query) -> list[Scene]:
    """Read the maps of an instance in a file, which the page is to show.

    Raises:
        InputError: They are not among the hypotheses that the page counts. One line.
    """
    cut = whole.cut(LARGEST if query.horizon is None else query.horizon)
    demands = sorted(query.parts)
    demands += [] if query.places is None else [f"bound({query.places})"]
    documents = maps.of_instance(maps.read_maps(file), path)
    made: list[Scene] = []
    for document in documents:
        many = len(document.best)
        for number, (place, entry) in enumerate(document.best, 1):
            where = f"{document.where}: map {place}"
            if entry.get("misread"):
                raise InputError(
                    f"{where}: it contradicts views, but the page is about all that was seen"
                )
            at = beginning(where, entry["at"], whole, cut, demands)
            rest = path, number, many, document.kind
            rests = cut.starts | cut.looks
            made.append(
                Scene(cut.map_of(at), at, *rest, whole=document.whole, rests=rests, seen=cut)
            )
    if len({scene.at for scene in made}) < len(made):
        raise InputError(f"{file}: a map occurs twice")
    if not made:
        raise InputError(f"{file}: no maps of {path} in it")
    return made


class Chapter:
    """What the page tells of an exploration.

    It is about the best maps, or about those that are ``given``. ``faults`` says what is missing,
    and why. ``whole`` tells whether the maps are all of their kind.
    """

    def __init__(
        self,
        name: str,
        seen: Experience,
        query: Query,
        most: int,
        watch: Watch,
        given: list[Scene] | None = None,
    ):
        self.name, self.seen, self.query, self.watch = name, seen, query, watch
        self.most = most  # the largest number of maps to draw
        self.faults: list[str] = []
        self.given = given is not None
        self.best: list[Scene] = given or []
        self.whole = all(scene.whole for scene in self.best)
        self.steps: list[Step] = []
        self.shapes: dict[Cube, Drawing] = {}  # small drawings, except those of the best maps
        self.counts: dict[str, list[int | None]] = {
            which: [None] * (seen.steps + 1) for which in ("without planarity", "with planarity")
        }

    def look(self, seconds: float) -> None:
        """Find out what can be found in that time; no part of the work takes all of it."""
        now = time.monotonic()
        self.watch.deadline.at = now + seconds / 3
        if not self.given:
            found, fault = best_maps(self.seen, self.query, self.watch)
            self.whole = not fault
            self.best = scenes.of_found(self.seen, self.name, found, self.whole)
            if fault:
                self.faults.append(f"the best maps: {fault}")
        self.watch.deadline.at = now + seconds / 2
        ats = [tuple(scene.at) for scene in self.best]
        self.steps, fault = replay(self.seen, self.query, ats, self.watch)
        if fault:
            self.faults.append(f"what was refused: {fault}")
        self.watch.deadline.at = now + seconds * 2 / 3
        self._until("pictures", self._draw())
        self.watch.deadline.at = now + seconds
        self._until("counts by clingo", self._count())
        self.watch.title("")

    def _until(self, what: str, work: Iterator[None]) -> None:
        with Attempt() as attempt:
            self.watch.tick()
            for _ in work:
                self.watch.tick()
        if attempt.fault:
            self.faults.append(f"{what}: {attempt.fault}")

    def _count(self) -> Iterator[None]:
        """Count the hypotheses after each step by clingo."""
        found = self.watch.found
        parts = [self.query.parts - {"planar"}, self.query.parts | {"planar"}]
        queries = [replace(self.query, parts=some) for some in parts]
        for step in range(self.seen.steps + 1):
            self.watch.title(f"counts after step {step} of {self.seen.steps}")
            for query, numbers in zip(queries, self.counts.values(), strict=True):
                asked = replace(query, horizon=step)
                numbers[step], _ = solving.count(self.seen, asked, (), self.watch, grown=False)
                self.watch.found = found
                yield
            self._agree(step)

    @property
    def counted(self) -> list[int | None]:
        """The number of hypotheses after each step of the replay, by clingo."""
        return self.counts[f"with{'' if 'planar' in self.query.parts else 'out'} planarity"]

    def _agree(self, step: int) -> None:
        ours, theirs = self.steps[step].alive, self.counted[step]
        if ours is not None and ours != theirs:
            raise RuntimeError(f"{self.name}: step {step}: the search has {ours}, clingo {theirs}")

    def alive(self, step: int) -> int | None:
        """How many hypotheses there are after a step, if that is known."""
        by_clingo = self.counted[step]
        return self.steps[step].alive if by_clingo is None else by_clingo

    def _keep(self, at: Cube, drawn: Drawing | None) -> None:
        if drawn:
            self.shapes[at] = drawn

    def _draw(self) -> Iterator[None]:
        """Draw the best maps, and small maps of the replay: one for each step, then others."""
        ready()
        yield from self._draw_best(self.best[: min(1, self.most)])
        yield from self._draw_shown(0)
        yield from self._draw_best(self.best[1 : self.most])
        for rank in range(1, SHOWN):
            yield from self._draw_shown(rank)

    def _late(self) -> Late:
        """Make the function that tells whether a picture has had its share of the time."""
        at = self.watch.deadline.at
        left = 0.0 if at is None else at - time.monotonic()
        end = time.monotonic() + left * SHARE
        return lambda: self.watch.late() or time.monotonic() > end

    def _draw_best(self, some: list[Scene]) -> Iterator[None]:
        for scene in some:
            self.watch.title(f"picture of map {scene.number}")
            if len(scene.world.stars) <= MOST_DRAWN:
                drawn = shapes.drawing(
                    scene.world, scene.ahead, late=self._late(), where=scene.where()
                )
                self._keep(tuple(scene.at), drawn)
                if drawn and drawn.note:
                    self.faults.append(f"picture of map {scene.number}: {drawn.note}")
                yield

    def _draw_shown(self, rank: int) -> Iterator[None]:
        """Draw one hypothesis of each step, from the last step back.

        The drawing of a map that grows into another one that is shown is a part of the other
        drawing.
        """
        last = self.seen.steps
        for number in range(last, -1, -1):
            self.watch.title(f"pictures of step {number} of {last}")
            for at in self.steps[number].shown[rank : rank + 1]:
                world = self.seen.map_of(at)
                if at in self.shapes or len(world.stars) > SMALL:
                    continue
                later = self.steps[number + 1].shown if number < last else []
                grown = (self.shapes.get(more) for more in later if more[: number + 1] == at)
                parts = (shapes.part_of(whole, world) for whole in grown if whole)
                drawn = next((part for part in parts if part), None)
                if drawn is None:
                    scene = Scene(
                        world,
                        at,
                        self.name,
                        rests=self.seen.starts | self.seen.looks,
                        seen=self.seen,
                    )
                    drawn = shapes.drawing(
                        world, scene.ahead, small=True, late=self._late(), where=scene.where()
                    )
                self._keep(at, drawn)
                yield
