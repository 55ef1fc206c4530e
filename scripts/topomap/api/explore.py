"""Where to go next, so that the maps are told apart."""

import os
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, demand_experience, path_of, query_of
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.reply import Reply
from topomap.model.vocabulary import CHOSEN
from topomap.questions import proofs
from topomap.questions.candidates import PARTS_OF, At, Candidates, gather
from topomap.questions.explore import Untold, plan
from topomap.questions.plans import Planned
from topomap.questions.proofs import Checked
from topomap.questions.standings import Prediction
from topomap.runtime.checks import flag, shown, whole, whole_if_given
from topomap.runtime.limits import LARGEST, LONGEST_WALK, MOST_WALKED
from topomap.runtime.watch import Watch

Among = str | os.PathLike[str] | Map  # a kind of maps, a file of them, or one
_ONE = (str, os.PathLike, Map)
_WANTED = f"a Map, a kind of maps ({', '.join(PARTS_OF)}) or a file of maps is wanted, or several"


class NextWalk(Reply):
    """A further walk, and what the maps in question predict of it. ``fault`` says why there may be
    other maps, or a better walk."""

    def __init__(self, among: Candidates, planned: Planned | None):
        super().__init__(planned.fault if planned else among.fault)
        self.among, self.planned = among, planned

    @cached_property
    def maps(self) -> list[Map]:
        """The maps in question, in the order in which they are numbered from 1."""
        each = self.among.each
        return [
            Map(self.among.experience, Found(one.at, one.of), number, len(each), self.among.every)
            for number, one in enumerate(each, 1)
        ]

    @property
    def kind(self) -> str:
        """``apart``: the walk refutes maps whichever is the real one; ``pending``: it leads to a
        pending gateway, as no walk tells the maps apart; ``settled``: there is one map, and it
        is closed; ``bisimilar``: no walk ever tells the maps apart, and no gateway is pending;
        ``no map``: no such map is consistent; ``not settled``: none of these is known."""
        if self.planned is not None:
            return self.planned.kind or "not settled"
        return "not settled" if self.among.fault else "no map"

    @property
    def turns(self) -> tuple[int, ...]:
        """The turn of each step of the walk: the slot of the gateway by which the agent leaves,
        clockwise of the one where it stands. Empty if there is no walk."""
        return self.planned.plan.turns if self.planned else ()

    @property
    def drop(self) -> int | None:
        """After how many steps of the walk the marker is put down; None if it is kept."""
        return self.planned.plan.drop if self.planned else None

    @property
    def left(self) -> int | None:
        """How many of the maps are left in the worst case; None if there are no maps."""
        return self.planned.plan.left if self.planned else None

    @property
    def proved(self) -> bool:
        """Whether no walk leaves fewer maps, nor as few sooner."""
        return self.planned.plan.proved if self.planned else False

    @property
    def predictions(self) -> tuple[tuple[Prediction | None, ...], ...]:
        """What each map predicts of each step: ``view``, ``landmarks`` and ``marker``; None where
        it predicts nothing, once the walk went through a pending gateway."""
        return self.planned.plan.predictions if self.planned else ()

    @property
    def untold(self) -> tuple[Untold, ...]:
        """The pairs of maps that the walk does not tell apart, and why."""
        return self.planned.plan.untold if self.planned else ()

    def lines(self) -> Iterator[str]:
        return self.planned.lines() if self.planned else iter([self.among.lack()])

    def document(self) -> dict[str, Any]:
        return self.planned.document() if self.planned else {"maps": []}

    def proofs(self) -> dict[str, Any]:
        """Why no walk tells maps apart, as ``--proof`` writes it, for ``check_proofs``."""
        return proofs.proofs(self.planned) if self.planned else {}


def candidates(
    experience: Experience,
    among: Among | Iterable[Among] = "optimal",
    *,
    bound: int | None = None,
    horizon: int | None = None,
    timeout: float | None = None,
    **parts: Unpack[Parts],
) -> Candidates:
    """The maps that may be the real one. Parameters and errors are those of ``explore``; the
    maps are in ``each``, and ``facts()`` gives them to ``encodings/explore.lp``."""
    query = query_of(parts, bound=bound, horizon=horizon, allowed=CHOSEN)
    asked = _asked(among)
    return candidates_under(begin(experience, timeout), experience, asked, query)


def candidates_under(
    watch: Watch, experience: Experience, asked: Sequence[str | At], query: Query
) -> Candidates:
    """The same of kinds of maps and files, by name, and maps, by their dstates, under the watch of
    a command."""
    cut = experience.cut(LARGEST if query.horizon is None else query.horizon)
    return gather(experience, cut, query, asked, watch)


def _asked(among: Among | Iterable[Among]) -> list[str | At]:
    """The maps in question: kinds and files by name, maps by their dstates. Raises TypeError if one
    is something else, and ValueError if there is none: that no map is consistent would be no
    answer, as none was looked for."""
    if isinstance(among, _ONE):
        among = [among]
    if not isinstance(among, Iterable):
        raise TypeError(f"among: {_WANTED}, not {shown(among)}")
    asked: list[str | At] = []
    for number, one in enumerate(among, 1):
        if not isinstance(one, _ONE):
            raise TypeError(f"among: number {number}: {_WANTED}, not {shown(one)}")
        asked.append(one.at if isinstance(one, Map) else path_of(one))
    if not asked:
        raise ValueError(f"among: {_WANTED}, but it is empty")
    return asked


def explore(
    experience: Experience,
    among: Among | Iterable[Among] | Candidates = "optimal",
    *,
    marker: bool = False,
    steps: int = LONGEST_WALK,
    bound: int | None = None,
    horizon: int | None = None,
    timeout: float | None = None,
    **parts: Unpack[Parts],
) -> NextWalk:
    """Say where to go next: the shortest further walk that tells the maps apart, or leaves the
    fewest in the worst case; or the proof that no walk does. (It goes beyond the paper, which
    maps what was seen.)

    Parameters:
        experience: what was seen and done.
        among: the maps that may be the real one: ``optimal`` (the best so far, where none is
            closed), ``closed``, ``perpendicular`` (and closed), a file of maps, or a map;
            several for all of them; or what ``candidates`` gave, which was told already what
            ``bound``, ``horizon`` and ``parts`` are.
        marker: whether the agent carries a marker, which it may drop once.
        steps: the most steps of the walk, 1 to 1000.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        timeout: seconds after which it stops.
        parts: what the maps are to have: ``planar`` and ``perpendicular``.

    Returns:
        The walk; its ``fault`` says why it is not proved to be the best.

    Raises:
        TypeError: no experience, or no maps.
        ValueError: an unknown part, a number that cannot be, or not one map to tell apart.
        InputError: an experience that cannot be, a file that cannot be read, or a map that is none
            of this experience.
    """
    steps, marker = whole("steps", steps, 1, MOST_WALKED), flag("marker", marker)
    query = query_of(parts, bound=bound, horizon=horizon, allowed=CHOSEN)
    asked = [] if isinstance(among, Candidates) else _asked(among)
    watch = begin(experience, timeout)
    if isinstance(among, Candidates):
        if parts or bound is not None or horizon is not None:
            raise ValueError("bound, horizon and parts are told to candidates, not to explore")
    else:
        among = candidates_under(watch, experience, asked, query)
    return explore_under(watch, among, marker, steps)


def explore_under(watch: Watch, among: Candidates, marker: bool, steps: int) -> NextWalk:
    """The same of the maps in question, under the watch of a command."""
    if not among.each:
        return NextWalk(among, None)
    watch.title("the next walk")
    slots = among.experience.slots
    made = plan(slots, among.standings(), watch, marker=marker, steps=steps)
    return NextWalk(among, Planned(among, made, marker, steps))


def check_proofs(
    experience: Experience, path: str | os.PathLike[str], *, horizon: int | None = None
) -> Checked:
    """Check the proofs in a file, which ``--proof`` or ``NextWalk.proofs`` made, without a solver.

    Parameters:
        experience: what was seen and done.
        path: the name of the file.
        horizon: the last step that counts.

    Returns:
        How many proofs there are, and what is ``wrong`` with them.

    Raises:
        TypeError: no experience, or no path.
        ValueError: a horizon that cannot be.
        InputError: there are no proofs in the file.
    """
    demand_experience(experience)
    last = whole_if_given("horizon", horizon, 0)
    return proofs.check_proofs(path_of(path), experience.cut(LARGEST if last is None else last))
