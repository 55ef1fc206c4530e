"""Why a statement is impossible or certain, or why there is no map."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Unpack

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, demand_text, query_of
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.reply import Reply
from topomap.model.vocabulary import DEMANDS, RELAXING
from topomap.questions.explain import Explainer, Explanation, Reason
from topomap.questions.statements import Statement, parse_statement
from topomap.runtime.limits import LARGEST
from topomap.runtime.watch import Attempt, Watch


class Explained(Reply):
    """A verdict, and the reasons for it."""

    def __init__(
        self,
        experience: Experience,
        query: Query,
        statement: Statement | None,
        explanation: Explanation,
        fault: str | None,
    ):
        super().__init__(fault)
        self.experience, self.query = experience, query
        self.explanation, self._statement = explanation, statement

    @property
    def statement(self) -> str | None:
        """The statement; None if it was asked why there is no map."""
        return self._statement.text if self._statement else None

    @property
    def verdict(self) -> str:
        """``impossible``: the statement holds in no map; ``certain``: it holds in all; ``open``:
        in some, and not in others; ``no map``: there is none at all; ``map``: there are maps,
        where no statement was asked about; or ``not settled``."""
        if self.explanation.verdict == "open" and not self._statement:
            return "map"
        return self.explanation.verdict or "not settled"

    @property
    def reasons(self) -> list[Reason]:
        """The reasons: each has a ``name``, what is ``told`` of it (``words``, ``steps``, ``walk``
        and ``places``), and ``at``, the dstates of a map that breaks it alone; empty where the
        verdict needs none, or none were found as yet."""
        return list(self.explanation.reasons)

    @property
    def in_the_way(self) -> list[str]:
        """Where there is no map, and a closed one was asked for: what, if it alone is taken away,
        lets one through, as ``Answer.in_the_way`` has it. There are no reasons then."""
        return list(self.explanation.in_the_way)

    @property
    def gathered(self) -> bool:
        """Whether reasons are whole rules, or what is seen after one step. They are where there is
        no map, and single reasons would be many. Each then has ``breaks``, the single ones that are
        broken in the map ``at``, and ``then``, the first of them in words."""
        return self.explanation.gathered

    @property
    def fewest(self) -> bool:
        """Whether it is proved that fewer gathered reasons would not be enough."""
        return self.explanation.fewest

    @property
    def minimal(self) -> bool:
        """Whether it is verified that the reasons are enough, and that none can be spared."""
        return self.explanation.minimal

    @property
    def horizon(self) -> int | None:
        """After which step it is so already; None where that is not known."""
        return self.explanation.horizon

    @property
    def witness(self) -> Map | None:
        """A map in which the statement holds, or any map if there is none, where the verdict is
        that there is one; else None."""
        return self._map(True)

    @property
    def counter(self) -> Map | None:
        """A map in which the statement does not hold, where it is open; else None."""
        return self._map(False)

    def _map(self, holds: bool) -> Map | None:
        at = self.explanation.maps.get(holds) if self.explanation.verdict == "open" else None
        return None if at is None else Map(self.experience, Found(at, "consistent"))

    def lines(self) -> Iterator[str]:
        return self.explanation.lines(self.experience, self._statement, self.fault)

    def document(self) -> dict[str, Any]:
        return self.explanation.document(self._statement, self.query)


def explain(
    experience: Experience,
    statement: str | None = None,
    *,
    bound: int | None = None,
    horizon: int | None = None,
    timeout: float | None = None,
    **parts: Unpack[Parts],
) -> Explained:
    """Tell why a statement is impossible or certain, or why there is no map: reasons none of
    which can be spared. (Each is of a rule of the paper, sections II and III, or of what was
    seen.)

    Parameters:
        experience: what was seen and done.
        statement: such as ``same(3,12)``, ``places < 12``, ``not planar``; what can be said is in
            ``topomap explain --help``. Without one: why there is no map.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        timeout: seconds after which it stops.
        parts: what the maps are to have; not ``genus`` and ``minimal``, since that another map
            is better is no reason of this kind.

    Returns:
        The verdict and the reasons; what was not found in time is said to be so.

    Raises:
        TypeError: no experience, or a statement that is no text.
        ValueError: an unknown part, or a number that cannot be.
        InputError: an experience that cannot be, or a text that is no statement about it; one
            line.
    """
    query = query_of(parts, bound=bound, horizon=horizon, allowed=(*DEMANDS, *RELAXING))
    if statement is not None:
        demand_text("statement", statement, "same(3,12)")
    return explain_under(begin(experience, timeout), experience, statement, query)


def explain_under(
    watch: Watch, experience: Experience, statement: str | None, query: Query
) -> Explained:
    """The same of the maps of a query, under the watch of a command."""
    seen = experience.cut(LARGEST if query.horizon is None else query.horizon)
    query = replace(query, horizon=None)  # which ends the experience here
    asked = None if statement is None else parse_statement(statement, seen, "explain")
    found = Explanation()
    with Attempt() as attempt:
        Explainer(seen, query, asked, watch, found).settle()
    return Explained(seen, query, asked, found, attempt.fault)
