"""Every map of a query, by clingo, by the search, or by whichever has less work to do. The maps are
found in one run, or branch by branch of the tree: then each branch is a unit of a journal, and a
crew may share the branches out."""

from array import array
from collections.abc import Generator, Iterator
from dataclasses import replace
from functools import partial

from topomap.model.experience import Experience
from topomap.model.found import UNPROVED, Cube, Found
from topomap.model.query import Query
from topomap.runtime.journal import Journal
from topomap.runtime.limits import LARGEST
from topomap.runtime.watch import Attempt, Stopped, Watch
from topomap.search import traversal
from topomap.solver import choice, solving
from topomap.solver.choice import AUTO, CLINGO, SEARCH, Trial
from topomap.solver.circumscription import circumscribed
from topomap.solver.share import ALONE, Crew
from topomap.solver.solving import Way

WAYS: dict[str, Way] = {
    AUTO: choice.hypotheses,
    CLINGO: solving.hypotheses,
    SEARCH: traversal.hypotheses,
}


def every(
    experience: Experience,
    query: Query,
    watch: Watch,
    by: str = AUTO,
    optimal: bool = False,
    journal: Journal | None = None,
    crew: Crew = ALONE,
    circumscribe: bool = False,
    limit: int | None = None,
) -> Generator[Found, None, None]:
    """The maps of a query, as they are found.

    Parameters:
        experience, query: what was seen and done, and which maps are asked for.
        watch: what may end the work; its ``by`` is set to the way that gives the maps.
        by: one of WAYS.
        optimal: only the best maps; better and better ones come before those that are proved.
        journal, crew: with either of them, and if all maps are asked for, the maps are found
            branch by branch of the tree, unless ``auto`` has found them by the search before that.
        circumscribe: only the circumscribed maps.
        limit: how many maps the caller takes at most, not counting one more by which it sees that
            there are others.

    Raises:
        Stopped: the work was cut short, or ``limit`` maps were found and the search given up.
    """
    journal = journal or Journal()
    watch.by = CLINGO if by == AUTO else by
    if circumscribe:
        yield from circumscribed(experience, query, watch, watch.by)
    elif optimal:
        yield from filter(None, solving.best(experience, query, watch, WAYS[by]))
    elif query.optimizes:
        yield from filter(None, WAYS[by](experience, query, watch))
    elif by == AUTO:
        yield from _by_what_suits(experience, query, watch, journal, crew, limit)
    elif crew is ALONE and not journal.kept:
        yield from filter(None, WAYS[by](experience, query, watch))
    else:
        way = WAYS[by]
        branches, depth = traversal.cubes(experience, query)
        done = 0
        known: set[Cube] = set()  # the maps of the branch that was cut
        with watch.deadline.waiting():
            for value in journal.recorded(len(branches)):
                watch.tick()
                if value is None:
                    known.clear()
                    done += 1
                else:
                    at = tuple((place, slot) for place, slot in value)
                    known.add(at)
                    watch.found += 1
                    yield Found(at, query.kind)
        if by == "clingo":
            solving.demand_cover(experience, query, watch, branches, depth)
        if crew is ALONE:
            left = way(experience, query, watch, cubes=branches[done:])
        else:
            left = _shared(crew, way, experience, query, watch, branches[done:])
        for one in left:
            if one is None:
                known.clear()
                journal.commit()
            elif one.at not in known:
                journal.add(one.at)
                yield one


def _by_what_suits(
    experience: Experience,
    query: Query,
    watch: Watch,
    journal: Journal,
    crew: Crew,
    limit: int | None,
) -> Iterator[Found]:
    """All maps of a query, as ``every`` gives them, by the way that has less work to do."""
    trial = Trial(experience, query, watch, limit=limit)
    if trial.whole or trial.fault:
        yield from trial.maps
        if trial.fault:
            raise Stopped(trial.fault)
    elif trial.rest and crew is ALONE and not journal.kept:
        yield from trial.maps
        yield from filter(None, trial.rest)
    else:
        some = False
        watch.found = 0  # a journal or a crew needs the maps branch by branch, and so anew
        try:
            for found in every(experience, query, watch, trial.by, False, journal, crew):
                some = True
                yield found
        except Stopped:
            if not some and trial.maps:
                watch.by = SEARCH
                yield from trial.maps
            raise


def proved_or_last(coming: Iterator[Found]) -> Iterator[Found]:
    """Of maps that come, those that are proved to be what they are said to be; or the last of the
    others, which is the best until then, if the work is cut before one is proved. Raises Stopped
    after that."""
    last, some = None, False
    with Attempt() as attempt:
        for found in coming:
            if found.proved:
                some = True
                yield found
            else:
                last = found
    if attempt.fault:
        if last and not some:
            yield replace(last, kind=UNPROVED)
        raise Stopped(attempt.fault)


def best_maps(experience: Experience, query: Query, watch: Watch) -> tuple[list[Found], str | None]:
    """The optimal maps, or the best so far, in order; and why they may not be all, if so."""
    found = []
    with Attempt() as attempt:
        for one in proved_or_last(every(experience, query, watch, optimal=True)):
            found.append(one)
    return sorted(found, key=lambda one: one.at), attempt.fault


def _shared(
    crew: Crew, way: Way, experience: Experience, query: Query, watch: Watch, cubes: list[Cube]
) -> Iterator[Found | None]:
    """What a way gives, by a crew."""
    steps = experience.cut(LARGEST if query.horizon is None else query.horizon).steps
    for numbers in crew.each(partial(_numbers, way, experience, query), cubes, watch):
        dstates = list(zip(numbers[::2], numbers[1::2], strict=True))
        watch.found += len(dstates) // (steps + 1)
        for start in range(0, len(dstates), steps + 1):
            yield Found(tuple(dstates[start : start + steps + 1]), query.kind)
        yield None


def _numbers(
    way: Way, experience: Experience, query: Query, cube: Cube, watch: Watch | None
) -> "array[int]":
    """The maps that begin with a cube, as places and gateways in a row: a third of the memory
    that they take as maps."""
    numbers = array("i")
    for found in way(experience, query, watch or Watch(), cubes=[cube]):
        for dstate in found.at if found else ():
            numbers.extend(dstate)
    return numbers
