"""Enumerating the maps that are consistent with an experience."""

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
    """Enumerate the maps that are consistent with an experience (the paper, sections II and III).

    Parameters:
        experience: What the agent saw and did.
        optimal: Whether to give only the optimal maps. These are the closed maps with the fewest
            exceptions to consistent boundaries, then the fewest paths, then the fewest places. If
            no map is closed, the maps that are best so far are given; these may have pending
            gateways.
        circumscribe: Whether to give only the circumscribed maps (the paper, section II: the
            circumscription policy). Of the closed maps with consistent boundaries, or of all maps
            with consistent boundaries if none of them is closed, these are the ones to which no
            other is preferred, by set inclusion. A map is preferred to another one if its paths are
            a proper subset of the paths of the other one, or if the paths are the same and its
            places are a proper subset of the places of the other one.
        bound: The largest number of places that a map may have.
        horizon: The last step that counts. By default all steps count.
        noise: The largest number of views that may be wrong. As few as possible are taken to be
            wrong.
        by: The way to find the maps: ``clingo``; ``search``, which is the paper's search of the
            tree of hypotheses; or ``auto``, which chooses the way that has less work to do, by
            counted work and never by time.
        encoding: The rules that clingo gets: ``work``, or ``paper``, which states the rules as the
            paper does and is slow.
        limit: The number of maps after which the search stops.
        timeout: The number of seconds of search after which it stops. The time begins with the
            first map that is asked for, and does not run while the caller has control.
        jobs: The number of processes that share the work. Work that minimises or circumscribes
            cannot be shared.
        parts: The demands on the maps and the preferences among them, as keyword arguments such as
            ``planar=True``; ``topomap.api.parts.Parts`` lists them.

    Returns:
        The maps, which can be read while further maps are being found.

    Raises:
        TypeError: ``experience`` is not an Experience.
        ValueError: A part, ``by`` or ``encoding`` is not known, a number is out of its range, or
            two arguments cannot be combined.
        InputError: The experience is impossible. The message is one line that names the step and
            the fault.
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
                raise ValueError(f"circumscribe cannot be combined with {name}")
    if (flag("optimal", optimal) or circumscribe or query.optimizes) and jobs > 1:
        raise ValueError("jobs: the search for all maps can be shared, not that for the best ones")
    if noise is not None and by == "search":
        raise ValueError("noise cannot be combined with by='search'")
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
    """Enumerate the maps of a query under the watch of a command.

    The command may have a journal of the work, and a crew that shares it. Otherwise this is
    ``solve``.
    """
    coming = every(experience, query, watch, by, optimal, journal, crew, circumscribe, limit)
    return Answer(experience, query, coming, limit, watch, waits=False, optimal=optimal)
