"""Statements about the maps of an exploration, as the commands accept them.

Examples are ``same(3,12)``, ``places < 12`` and ``not planar``. ``encodings/query.lp`` says what
they mean.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from topomap.model.vocabulary import FIGURES, QUALITIES, RELATIONS
from topomap.model.words import number, short
from topomap.runtime.errors import InputError
from topomap.runtime.limits import LARGEST
from topomap.runtime.near import meant

if TYPE_CHECKING:  # parsing a call must not load the solver
    from topomap.model.experience import Experience

SIGNS = {"number": ("=", "!="), "least": (">=", "<"), "most": ("<=", ">")}
_NOT = re.compile(r"not\s+(?=\S)")
_RELATION = re.compile(r"([a-z]\w*)\s*\(([^()]*)\)", re.ASCII)
_COMPARISON = re.compile(r"([a-z]\w*)\s*(<=|>=|!=|<|>|=)\s*(.*)", re.ASCII | re.DOTALL)
_WORD = re.compile(r"[a-z]\w*", re.ASCII)
_NUMBER = re.compile(r"[0-9]+")


@dataclass(frozen=True)
class Statement:
    """A statement: ``holds(term)`` is true, or false if the statement is not ``positive``.

    ``note`` says why ``holds(term)`` is impossible, if that is plain without reasoning.
    """

    text: str
    term: str
    positive: bool = True
    note: str | None = None

    @property
    def fact(self) -> str:
        """The fact that asks for it in ``encodings/query.lp``."""
        return f"ask({self.term})."


def parse_statement(text: str, experience: "Experience", command: str) -> Statement:
    """Read the statement in a text, about an experience of which all steps count.

    Raises:
        InputError: It is not a statement. One line that begins with the command.
    """
    try:
        return _parsed(text, experience)
    except ValueError as fault:
        raise InputError(f'{command}: "{_short(text)}": {fault}') from None


def _parsed(text: str, experience: "Experience") -> Statement:
    rest, positive = text.strip(), True
    while match := _NOT.match(rest):
        rest, positive = rest[match.end() :], not positive
    spelt = " ".join(rest.split())
    said = spelt if positive else f"not {spelt}"
    if match := _RELATION.fullmatch(rest):
        name, arguments = match[1], [argument.strip() for argument in match[2].split(",")]
        term, note = _relation(name, arguments, experience)
        return Statement(said, term, positive, note)
    if match := _COMPARISON.fullmatch(rest):
        term, agrees = _comparison(match[1], match[2], match[3].strip())
        return Statement(said, term, positive == agrees)
    if not _WORD.fullmatch(rest):
        raise ValueError("not a statement, such as same(3,12), places < 12, planar, not planar")
    if rest not in QUALITIES:
        raise ValueError(f"{_short(rest)}: {_unknown(rest)}")
    return Statement(said, rest, positive)


def _unknown(word: str) -> str:
    """Say what is wrong with a word."""
    if word in RELATIONS:
        return f"its arguments are {', '.join(RELATIONS[word])}: {word}(...)"
    if word in FIGURES:
        return f"it is a number, to be compared: {word} < 12"
    if word in QUALITIES:
        return "it is about the whole map, so it has no arguments"
    if word == "apart":
        return "no such word; write not same(T,U)"
    known = dict.fromkeys([*RELATIONS, *FIGURES, *QUALITIES])
    return f"no such word; {meant(word, known) or 'there are ' + ', '.join(known)}"


def _relation(name: str, arguments: list[str], experience: "Experience") -> tuple[str, str | None]:
    """Make the term of such a statement, and say why it cannot hold, if that is plain."""
    kinds = RELATIONS.get(name)
    if kinds is None:
        raise ValueError(f"{_short(name)}: {_unknown(name)}")
    if len(arguments) != len(kinds):
        raise ValueError(f"{name}: {_unknown(name)}; there are {len(arguments)} arguments")
    numbers = [_number(argument, kind) for argument, kind in zip(arguments, kinds, strict=True)]
    for kind, argument in zip(kinds, numbers, strict=True):
        if kind == "slot" and argument >= experience.slots:
            raise ValueError(f"slot {argument}: slots are 0 to {experience.slots - 1}")
        if kind != "slot" and argument > experience.steps:
            steps = number(experience.steps, "step")
            raise ValueError(f"{kind} {argument}: the experience has {steps}")
    term = f"{name}({','.join(map(str, numbers))})"
    return term, next(_plain(name, numbers, experience), None)


def _plain(name: str, numbers: list[int], experience: "Experience") -> Iterator[str]:
    """Find what is plainly wrong: a gateway that was not seen, or a place of a later step."""
    if name == "at":
        step, place, slot = numbers
        if place > step:
            yield f"place {place} is named by a later step than {step}"
        numbers = [place, slot]
    if name != "same":
        for step, slot in zip(numbers[::2], numbers[1::2], strict=True):
            if slot not in experience.views[step]:
                yield f"no gateway was seen {number(slot, 'slot')} clockwise after step {step}"


def statement_text(term: str, positive: bool) -> str:
    """Write the statement of a term of ``encodings/query.lp``.

    The statement of ``most(place,8)`` is ``places <= 8``.
    """
    name, _, arguments = term.rstrip(")").partition("(")
    if name not in SIGNS:
        return term if positive else f"not {term}"
    counted, _, count = arguments.partition(",")
    figure = next(word for word, of in FIGURES.items() if of == counted)
    return f"{figure} {SIGNS[name][not positive]} {count}"


def _comparison(figure: str, sign: str, text: str) -> tuple[str, bool]:
    """Make the term of a comparison, and tell whether it says the same or the opposite."""
    if figure not in FIGURES:
        hint = meant(figure, FIGURES) or f"there are {', '.join(FIGURES)}"
        raise ValueError(f"{_short(figure)}: not a number of a map; {hint}")
    count = _number(text, "number")
    if sign in ("=", "!="):
        return f"number({FIGURES[figure]},{count})", sign == "="
    if sign in ("<", ">="):
        return f"least({FIGURES[figure]},{count})", sign == ">="
    return f"most({FIGURES[figure]},{count})", sign == "<="


def _number(text: str, kind: str) -> int:
    if not _NUMBER.fullmatch(text) or len(text) > len(str(LARGEST)) or int(text) > LARGEST:
        raise ValueError(f"{kind} {_short(text)!r}: a whole number is wanted, 0 to {LARGEST}")
    return int(text)


def _short(text: str) -> str:
    return short(" ".join(text[:1000].split()), 60)
