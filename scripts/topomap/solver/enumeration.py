"""All maps of a query, by clingo, by the search, or by whichever has less work to do.

The maps are found in one run, or branch by branch of the tree. In the latter case each branch is a
unit of a journal, and a crew may share the branches.
"""

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
    """Find the maps of a query, and give each when it is found.

    Parameters:
        experience: What the agent saw and did.
        query: Which maps are asked for.
        watch: What may end the work; its ``by`` is set to the way that finds the maps.
        by: One of WAYS.
        optimal: Whether only the best maps are wanted. Better and better ones come before those
            that are proved to be best.
        journal: A journal of the work. With it, or with a crew, and if all maps are asked for, the
            maps are found branch by branch of the tree, unless ``auto`` has found them by the
            search before.
        crew: A crew that shares the work.
        circumscribe: Whether only the circumscribed maps are wanted.
        limit: The largest number of maps that the caller takes, not counting one more that shows
            that there are others.

    Yields:
        The maps.

    Raises:
        Stopped: The work was cut short, or ``limit`` maps were found and the search was given up.
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
        known: set[Cube] = set()  # the maps of the branch that was cut short short
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
    """Find all maps of a query, as ``every`` does, by the way that has less work to do."""
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
        # A journal or a crew needs the maps branch by branch, so they are found anew.
        watch.found = 0
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
    """Select the maps that are proved to be what they are said to be.

    If the work is cut short before one is proved, the last of the others is given, which is the
    best one so far.

    Raises:
        Stopped: The work was cut short; this comes after that map.
    """
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
    """Find the optimal maps, or those that are best so far, in order.

    Returns:
        The maps, and why they may not be all, or None.
    """
    found = []
    with Attempt() as attempt:
        for one in proved_or_last(every(experience, query, watch, optimal=True)):
            found.append(one)
    return sorted(found, key=lambda one: one.at), attempt.fault


def _shared(
    crew: Crew, way: Way, experience: Experience, query: Query, watch: Watch, cubes: list[Cube]
) -> Iterator[Found | None]:
    """Find maps by a way that a crew shares."""
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
    """The maps that begin with a cube, as rows of places and gateways.

    This takes a third of the memory that the maps would take.
    """
    numbers = array("i")
    for found in way(experience, query, watch or Watch(), cubes=[cube]):
        for dstate in found.at if found else ():
            numbers.extend(dstate)
    return numbers
