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
    """What is known of a ``statement``: whether it ``holds``, in "all" maps, in "some" and not in
    others, or in "none"; else it is "not settled". ``witness`` is a map in which it holds,
    ``counter`` one in which it does not; None where none was found. ``note`` says why it holds
    in none, or in all, where what was seen tells so at once."""

    statement: str
    holds: str
    witness: Map | None
    counter: Map | None
    note: str | None


class StatementAnswers(Reply, Sequence[StatementAnswer]):
    """An answer to each statement, in their order."""

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
        """Whether there is a map at all; None if that is not settled. If there is none, each
        statement is said to hold in none, and so would its opposite be."""
        return self.inquiry.some

    @property
    def kind(self) -> str:
        """Of what maps the answers are: "consistent"; "best", if something is minimised;
        "optimal", or "best so far" if no map is closed; "not settled" until one is found."""
        return self.inquiry.kind or "not settled"

    @property
    def cost(self) -> tuple[int, ...]:
        """What these maps cost, most important first; empty if nothing is minimised."""
        return self.inquiry.cost

    def lines(self) -> Iterator[str]:
        return self.inquiry.lines(self.experience, self.fault)

    def document(self) -> dict[str, Any]:
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
    """Tell of each statement whether it holds in all maps that are consistent with an experience
    (the paper, sections II and III), in some or in none.

    Parameters:
        experience: what was seen and done.
        statement: one or more, such as ``same(3,12)``, ``places < 12``, ``not planar``; what can
            be said is in ``topomap ask --help``.
        optimal: of the closed maps with the fewest exceptions to consistent boundaries, then the
            fewest paths, then the fewest places; if no map is closed, of the best so far, pending
            gateways allowed.
        bound: the most places that a map may have.
        horizon: the last step that counts.
        timeout: seconds after which it stops.
        parts: what the maps are to have.

    Returns:
        An answer to each statement; what is not settled in time is said to be so.

    Raises:
        TypeError: no experience, or a statement that is no text.
        ValueError: no statement, an unknown part, or a number that cannot be.
        InputError: an experience that cannot be, or a text that is no statement about it; one
            line.
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
    """The same of the maps of a query, under the watch of a command."""
    seen = experience.cut(LARGEST if query.horizon is None else query.horizon)
    inquiry = Inquiry([parse_statement(text, seen, "ask") for text in asked])
    with Attempt() as attempt:
        inquiry.settle(seen, query, optimal, watch)
    return StatementAnswers(seen, query, optimal, inquiry, attempt.fault)
