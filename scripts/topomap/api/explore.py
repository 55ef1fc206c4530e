"""Where to go next, so that a further walk tells the maps apart."""

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

Among = str | os.PathLike[str] | Map  # a kind of maps, a file of maps, or a map
_ONE = (str, os.PathLike, Map)
_WANTED = f"a Map, a kind of maps ({', '.join(PARTS_OF)}) or a file of maps is wanted, or several"


class NextWalk(Reply):
    """A further walk, and what each of the maps in question predicts of it.

    ``fault`` says why there may be other maps, or a better walk.
    """

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
        """What the walk achieves, or why there is none.

        It is ``apart`` if the walk refutes some map, whichever map is the real one; ``pending`` if
        no walk tells the maps apart and this one leads to a pending gateway; ``settled`` if there
        is one map, and it is closed; ``bisimilar`` if no walk can ever tell the maps apart, and no
        gateway is pending; ``no map`` if no such map is consistent; or ``not settled`` if none of
        these is known.
        """
        if self.planned is not None:
            return self.planned.kind or "not settled"
        return "not settled" if self.among.fault else "no map"

    @property
    def turns(self) -> tuple[int, ...]:
        """The turn of each step of the walk; empty if there is no walk.

        A turn is the slot of the gateway by which the agent leaves, counted clockwise from the one
        where it stands.
        """
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
        """Whether it is proved that no walk leaves fewer maps, or as few in fewer steps."""
        return self.planned.plan.proved if self.planned else False

    @property
    def predictions(self) -> tuple[tuple[Prediction | None, ...], ...]:
        """What each map predicts of each step: ``view``, ``landmarks`` and ``marker``.

        It is None from the step on that goes through a pending gateway, about which the map
        predicts nothing.
        """
        return self.planned.plan.predictions if self.planned else ()

    @property
    def untold(self) -> tuple[Untold, ...]:
        """The pairs of maps that the walk does not tell apart, and why it does not."""
        return self.planned.plan.untold if self.planned else ()

    def lines(self) -> Iterator[str]:
        """The walk and the predictions as the lines that ``topomap explore`` prints."""
        return self.planned.lines() if self.planned else iter([self.among.lack()])

    def document(self) -> dict[str, Any]:
        """The walk and the predictions as ``topomap explore --json`` writes them."""
        return self.planned.document() if self.planned else {"maps": []}

    def proofs(self) -> dict[str, Any]:
        """The bisimulations that prove that no walk tells the maps apart, for ``check_proofs``.

        They are what ``topomap explore --proof`` writes.
        """
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
    """Gather the maps that may be the real one.

    The parameters and the errors are those of ``explore``. The maps are in ``each``, and
    ``facts()`` gives them as facts for ``encodings/explore.lp``.
    """
    query = query_of(parts, bound=bound, horizon=horizon, allowed=CHOSEN)
    asked = _asked(among)
    return candidates_under(begin(experience, timeout), experience, asked, query)


def candidates_under(
    watch: Watch, experience: Experience, asked: Sequence[str | At], query: Query
) -> Candidates:
    """Gather candidate maps under the watch of a command.

    Kinds of maps and files are given by name, and maps by their dstates.
    """
    cut = experience.cut(LARGEST if query.horizon is None else query.horizon)
    return gather(experience, cut, query, asked, watch)


def _asked(among: Among | Iterable[Among]) -> list[str | At]:
    """Bring the maps in question into one form: kinds and files by name, maps by their dstates.

    Raises:
        TypeError: One is something else.
        ValueError: There is none. "No map is consistent" would not be an answer, as none was looked
            for.
    """
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
    """Say where to go next, so that as few maps as possible are left.

    The walk is the shortest further walk that tells the maps apart, or else leaves the fewest of
    them in the worst case. If no walk does, a bisimulation proves it. (This goes beyond the paper,
    which maps what was seen.)

    Parameters:
        experience: What the agent saw and did.
        among: The maps that may be the real one: ``optimal`` (those that are best so far, if none
            is closed), ``closed``, ``perpendicular`` (these are closed, too), a file of maps, or a
            map; a list of several of these; or what ``candidates`` gave, which has its own
            ``bound``, ``horizon`` and ``parts``.
        marker: Whether the agent carries a marker, which it may put down once.
        steps: The largest number of steps of the walk, from 1 to 1000.
        bound: The largest number of places that a map may have.
        horizon: The last step that counts. By default all steps count.
        timeout: The number of seconds after which the work stops.
        parts: The demands on the maps, as for ``solve``: ``planar``, ``perpendicular`` and
            ``no_path_axiom``.

    Returns:
        The walk. Its ``fault`` says why it is not proved to be the best, if so.

    Raises:
        TypeError: ``experience`` is not an Experience, or ``among`` is not one of the above.
        ValueError: A part is not known, a number is out of its range, or ``among`` is empty.
        InputError: The experience is impossible, a file cannot be read, or a map is not one of this
            experience. The message is one line.
    """
    steps, marker = whole("steps", steps, 1, MOST_WALKED), flag("marker", marker)
    query = query_of(parts, bound=bound, horizon=horizon, allowed=CHOSEN)
    asked = [] if isinstance(among, Candidates) else _asked(among)
    watch = begin(experience, timeout)
    if isinstance(among, Candidates):
        if parts or bound is not None or horizon is not None:
            raise ValueError("give bound, horizon and parts to candidates, not to explore")
    else:
        among = candidates_under(watch, experience, asked, query)
    return explore_under(watch, among, marker, steps)


def explore_under(watch: Watch, among: Candidates, marker: bool, steps: int) -> NextWalk:
    """Look for the next walk among candidates, under the watch of a command."""
    if not among.each:
        return NextWalk(among, None)
    watch.title("the next walk")
    slots = among.experience.slots
    made = plan(slots, among.standings(), watch, marker=marker, steps=steps)
    return NextWalk(among, Planned(among, made, marker, steps))


def check_proofs(
    experience: Experience, path: str | os.PathLike[str], *, horizon: int | None = None
) -> Checked:
    """Check the proofs in a file without a solver.

    Parameters:
        experience: What the agent saw and did.
        path: The file, which ``topomap explore --proof`` or ``NextWalk.proofs`` made.
        horizon: The last step that counts. By default all steps count.

    Returns:
        How many proofs there are, and what is ``wrong`` with them.

    Raises:
        TypeError: ``experience`` is not an Experience, or ``path`` is not the path of a file.
        ValueError: ``horizon`` is out of its range.
        InputError: There are no proofs in the file.
    """
    demand_experience(experience)
    last = whole_if_given("horizon", horizon, 0)
    return proofs.check_proofs(path_of(path), experience.cut(LARGEST if last is None else last))
