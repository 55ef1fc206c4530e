"""Enumerating the maps of an experience."""

from collections.abc import Generator
from typing import Unpack

from topomap.api.answer import Answer
from topomap.api.parts import Parts, begin, demand_pairs, query_of
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.vocabulary import OPTIMIZING
from topomap.runtime.checks import flag, seconds, whole, whole_if_given
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Deadline, Watch
from topomap.solver.crews import crew as crew_of
from topomap.solver.enumeration import WAYS, every
from topomap.solver.share import ALONE, Crew


def solve(
    experience: Experience,
    *,
    optimal: bool = False,
    circumscribe: bool = False,
    bound: int | None = None,
    horizon: int | None = None,
    noise: int | None = None,
    by: str = "auto",
    encoding: str = "work",
    limit: int | None = None,
    timeout: float | None = None,
    jobs: int = 1,
    **parts: Unpack[Parts],
) -> Answer:
    """Enumerate the maps that are consistent with an experience (the paper, sections II, III).

    Parameters:
        experience: what was seen and done.
        optimal: closed maps with the fewest exceptions to consistent boundaries, then the fewest
            paths, then the fewest places; if no map is closed, the best so far, pending gateways
            allowed.
        circumscribe: of the closed maps with consistent boundaries (or of all with these, if there
            is no such map) those to which none is preferred, by set inclusion (the paper, section
            II: the circumscription policy). A map is preferred to another one if its paths are
            some but not all of the other one's, or if its paths are the same and its places are
            some but not all of the other one's.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        noise: how many views may be wrong, as few as can be.
        by: ``auto``: the way that suits, by how much work there is to do, never by time;
            ``clingo``, or ``search``, the paper's search of the tree of hypotheses.
        encoding: ``work``, or ``paper``, the rules as the paper states them (slow).
        limit: stop after so many maps.
        timeout: seconds of search after which it stops: they begin with the first map that is
            asked for, and wait while the caller has control.
        jobs: how many processes do the work; not with what minimises or circumscribes.
        parts: what the maps are to have.

    Returns:
        The maps, as they are found.

    Raises:
        TypeError: no experience.
        ValueError: an unknown part, way or encoding, a number that cannot be, or what does not go
            together.
        InputError: an experience that cannot be, one line that names step and fault.
    """
    query = query_of(parts, bound=bound, horizon=horizon, encoding=encoding, noise=noise)
    if not isinstance(by, str) or by not in WAYS:
        raise ValueError(f"{by!r} is not one of the ways {', '.join(WAYS)}")
    limit, jobs = whole_if_given("limit", limit, 1), whole("jobs", jobs, 1)
    timeout = seconds("timeout", timeout)
    if flag("circumscribe", circumscribe):
        others = {
            "optimal": optimal,
            "genus or minimal": query.parts & OPTIMIZING,
            "noise": noise is not None,
            "encoding='paper'": encoding == "paper",
        }
        for name, asked in others.items():
            if asked:
                raise ValueError(f"circumscribe does not go with {name}")
    if (flag("optimal", optimal) or circumscribe or query.optimizes) and jobs > 1:
        raise ValueError("jobs: all maps are shared out, not the best ones")
    if noise is not None and by == "search":
        raise ValueError("noise does not go with by='search'")
    if by == "search":
        demand_pairs(experience, "by='search'")
    if encoding == "paper":
        demand_pairs(experience, "encoding='paper'")
    watch = begin(experience, None, noise is not None)

    def coming() -> Generator[Found, None, None]:
        watch.deadline = Deadline(timeout)
        with crew_of(jobs) as crew:
            yield from every(experience, query, watch, by, optimal, None, crew, circumscribe, limit)

    return Answer(experience, query, coming(), limit, watch, optimal=optimal)


def solve_under(
    watch: Watch,
    experience: Experience,
    query: Query,
    *,
    by: str = "auto",
    optimal: bool = False,
    circumscribe: bool = False,
    limit: int | None = None,
    journal: Journal | None = None,
    crew: Crew = ALONE,
) -> Answer:
    """The same of the maps of a query, under the watch of a command, which may have a journal of
    the work and a crew for it."""
    coming = every(experience, query, watch, by, optimal, journal, crew, circumscribe, limit)
    return Answer(experience, query, coming, limit, watch, waits=False, optimal=optimal)
