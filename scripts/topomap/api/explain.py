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
        """The statement; None if the question was why there is no map."""
        return self._statement.text if self._statement else None

    @property
    def verdict(self) -> str:
        """The verdict in one word or two.

        It is ``impossible`` if the statement holds in no map; ``certain`` if it holds in all maps;
        ``open`` if it holds in some and not in others; ``no map`` if there is no map at all;
        ``map`` if there are maps and the question was about no statement; or ``not settled``.
        """
        if self.explanation.verdict == "open" and not self._statement:
            return "map"
        return self.explanation.verdict or "not settled"

    @property
    def reasons(self) -> list[Reason]:
        """The reasons, which together are an unsatisfiable core; empty if the verdict needs none.

        Each reason has a ``name``, what is ``told`` of it (``words``, ``steps``, ``walk`` and
        ``places``), and ``at``, the dstates of a map that breaks only this reason. It is empty,
        too, if no reasons have been found.
        """
        return list(self.explanation.reasons)

    @property
    def in_the_way(self) -> list[str]:
        """What alone stands in the way of a closed map, as ``Answer.in_the_way`` has it.

        It is given where closed maps were asked for and there is no map. Then there are no reasons.
        """
        return list(self.explanation.in_the_way)

    @property
    def gathered(self) -> bool:
        """Whether each reason is a whole rule, or all that was seen after one step.

        Reasons are gathered like this where there is no map and single reasons would be many. Each
        reason then has ``breaks``, the single reasons that the map ``at`` breaks, and ``then``, the
        first of them in words.
        """
        return self.explanation.gathered

    @property
    def fewest(self) -> bool:
        """Whether it is proved that fewer gathered reasons would not be enough."""
        return self.explanation.fewest

    @property
    def minimal(self) -> bool:
        """Whether it is verified that the reasons are enough, and that each of them is needed.

        If bearings are not exact, and visits see different numbers of gateways, this is not so: the
        reasons are then enough if all visits of a place see equally many gateways.
        """
        return self.explanation.minimal

    @property
    def horizon(self) -> int | None:
        """The first step after which the verdict holds; None if that is not known."""
        return self.explanation.horizon

    @property
    def witness(self) -> Map | None:
        """A map in which the statement holds, or None.

        It is None unless the verdict says that there is such a map. If the question was about no
        statement, it is any map.
        """
        return self._map(True)

    @property
    def counter(self) -> Map | None:
        """A map in which the statement does not hold; None unless the verdict is ``open``."""
        return self._map(False)

    def _map(self, holds: bool) -> Map | None:
        at = self.explanation.maps.get(holds) if self.explanation.verdict == "open" else None
        return None if at is None else Map(self.experience, Found(at, "consistent"))

    def lines(self) -> Iterator[str]:
        """The verdict and the reasons as the lines that ``topomap explain`` prints."""
        return self.explanation.lines(self.experience, self._statement, self.fault)

    def document(self) -> dict[str, Any]:
        """The verdict and the reasons as ``topomap explain --json`` writes them."""
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
    """Tell why a statement is impossible or certain, or why there is no map.

    The reasons form a minimal unsatisfiable core: each of them is needed. Each is a rule of the
    paper, sections II and III, applied to certain steps, or something that was seen.

    Parameters:
        experience: What the agent saw and did.
        statement: A statement, such as ``same(3,12)``, ``places < 12`` or ``not planar``; ``topomap
            explain --help`` lists what can be said. Without one, the question is why there is no
            map.
        bound: The largest number of places that a map may have.
        horizon: The last step that counts. By default all steps count.
        timeout: The number of seconds after which the work stops.
        parts: The demands on the maps, as for ``solve``; not ``genus``, ``exceptions`` and
            ``minimal``, because a better map is not a reason of this kind.

    Returns:
        The verdict and the reasons. What was not found in time is said to be so.

    Raises:
        TypeError: ``experience`` is not an Experience, or the statement is not a text.
        ValueError: A part is not known, or a number is out of its range.
        InputError: The experience is impossible, or the text is not a statement about it. The
            message is one line.
    """
    query = query_of(parts, bound=bound, horizon=horizon, allowed=(*DEMANDS, *RELAXING))
    if statement is not None:
        demand_text("statement", statement, "same(3,12)")
    return explain_under(begin(experience, timeout), experience, statement, query)


def explain_under(
    watch: Watch, experience: Experience, statement: str | None, query: Query
) -> Explained:
    """Explain a statement about the maps of a query, under the watch of a command."""
    seen = experience.cut(LARGEST if query.horizon is None else query.horizon)
    query = replace(query, horizon=None)  # the experience has been cut there
    asked = None if statement is None else parse_statement(statement, seen, "explain")
    found = Explanation()
    with Attempt() as attempt:
        Explainer(seen, query, asked, watch, found).settle()
    return Explained(seen, query, asked, found, attempt.fault)
