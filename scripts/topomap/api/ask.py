"""Whether statements hold in all maps, in some, or in none."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Unpack, overload

from topomap.api.maps import Map
from topomap.api.parts import Parts, begin, demand_text, query_of
from topomap.model.experience import Experience
from topomap.model.found import Found
from topomap.model.query import Query
from topomap.model.reply import Reply
from topomap.questions.ask import Inquiry
from topomap.questions.statements import parse_statement
from topomap.runtime.checks import flag
from topomap.runtime.limits import LARGEST
from topomap.runtime.watch import Attempt, Watch


@dataclass(frozen=True)
class StatementAnswer:
    """The answer to one statement.

    Attributes:
        statement: The statement, in one spelling.
        holds: "all" if the statement holds in all maps (it is a cautious consequence), "some" if it
            holds in some maps but not in others (it is a brave consequence), "none" if it holds in
            no map, or "not settled".
        witness: A map in which the statement holds; None if none was found.
        counter: A map in which it does not hold; None if none was found.
        note: Why it holds in no map, or in all, where the views alone show that; otherwise None.
    """

    statement: str
    holds: str
    witness: Map | None
    counter: Map | None
    note: str | None


class StatementAnswers(Reply, Sequence[StatementAnswer]):
    """The answers to several statements, in the order of the statements."""

    def __init__(
        self,
        experience: Experience,
        query: Query,
        optimal: bool,
        inquiry: Inquiry,
        fault: str | None,
    ):
        super().__init__(fault)
        self.experience, self.query, self.optimal = experience, query, optimal
        self.inquiry = inquiry

        def shown(found: Found | None) -> Map | None:
            return None if found is None else Map(experience, found)

        self._each = [
            StatementAnswer(
                known.statement.text,
                "none" if inquiry.some is False else known.holds or "not settled",
                shown(known.witness),
                shown(known.counter),
                known.statement.note,
            )
            for known in inquiry.each
        ]

    @overload
    def __getitem__(self, index: int) -> StatementAnswer: ...
    @overload
    def __getitem__(self, index: slice) -> list[StatementAnswer]: ...
    def __getitem__(self, index: int | slice) -> StatementAnswer | list[StatementAnswer]:
        return self._each[index]

    def __len__(self) -> int:
        return len(self._each)

    @property
    def has_maps(self) -> bool | None:
        """Whether there is any map; None if that is not settled.

        If there is no map, each statement is said to hold in none, and so is its opposite.
        """
        return self.inquiry.some

    @property
    def kind(self) -> str:
        """Which maps the answers are about.

        They are about the "consistent" maps; about the "best" ones, if a part is minimised; about
        the "optimal" ones, or those that are "best so far" if no map is closed. It is "not settled"
        until a map is found.
        """
        return self.inquiry.kind or "not settled"

    @property
    def cost(self) -> tuple[int, ...]:
        """What these maps cost, the most important number first; empty if nothing is minimised."""
        return self.inquiry.cost

    def lines(self) -> Iterator[str]:
        """The answers as the lines that ``topomap ask`` prints."""
        return self.inquiry.lines(self.experience, self.fault)

    def document(self) -> dict[str, Any]:
        """The answers as ``topomap ask --json`` writes them."""
        return self.inquiry.document(self.experience, self.query, self.optimal)

    def _gist(self) -> str:
        return "; ".join(f"{one.statement}: {one.holds}" for one in self)


def ask(
    experience: Experience,
    *statement: str,
    optimal: bool = False,
    bound: int | None = None,
    horizon: int | None = None,
    timeout: float | None = None,
    **parts: Unpack[Parts],
) -> StatementAnswers:
    """Say for each statement whether it holds in all consistent maps, in some or in none.

    The maps are those of the paper, sections II and III. A statement that holds in all maps is a
    cautious consequence of the experience; one that holds in some maps is a brave consequence.

    Parameters:
        experience: What the agent saw and did.
        statement: One statement or more, such as ``same(3,12)``, ``places < 12`` or ``not planar``;
            ``topomap ask --help`` lists what can be said.
        optimal: Whether to ask about the optimal maps only. These are the closed maps with the
            fewest exceptions to consistent boundaries, then the fewest paths, then the fewest
            places. If no map is closed, the question is about the maps that are best so far, which
            may have pending gateways.
        bound: The largest number of places that a map may have.
        horizon: The last step that counts. By default all steps count.
        timeout: The number of seconds after which the work stops.
        parts: The demands on the maps and the preferences among them, as for ``solve``.

    Returns:
        An answer to each statement. A statement that is not settled in time is said to be so.

    Raises:
        TypeError: ``experience`` is not an Experience, or a statement is not a text.
        ValueError: There is no statement, a part is not known, or a number is out of its range.
        InputError: The experience is impossible, or a text is not a statement about it. The message
            is one line.
    """
    query = query_of(parts, bound=bound, horizon=horizon)
    if not statement:
        raise ValueError("ask: a statement is wanted, such as same(3,12)")
    for text in statement:
        demand_text("statement", text, "same(3,12)")
    flag("optimal", optimal)
    return ask_under(begin(experience, timeout), experience, statement, query, optimal)


def ask_under(
    watch: Watch, experience: Experience, asked: Sequence[str], query: Query, optimal: bool
) -> StatementAnswers:
    """Settle statements about the maps of a query, under the watch of a command."""
    seen = experience.cut(LARGEST if query.horizon is None else query.horizon)
    inquiry = Inquiry([parse_statement(text, seen, "ask") for text in asked])
    with Attempt() as attempt:
        inquiry.settle(seen, query, optimal, watch)
    return StatementAnswers(seen, query, optimal, inquiry, attempt.fault)
