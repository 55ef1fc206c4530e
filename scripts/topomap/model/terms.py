"""Ground terms and facts, as clingo writes them."""

import functools
import re

import clingo

DEEPEST = 100  # clingo's parser crashes on terms that are nested very deeply
STRING = r'"(?:[^"\\\n]++|\\.)*+"'
_SPACE = re.compile(rf"({STRING})|\s+", re.DOTALL)
_BRACKET = re.compile(rf"{STRING}|[(|)]", re.DOTALL)


def ground(text: str, noun: str) -> clingo.Symbol | str:
    """Read a text that should be one ground term.

    clingo must write the term in the same way, apart from blanks.

    Returns:
        The term, or in words why there is none. ``noun`` says what was wanted: a fact or a term.
    """
    if len(text) > DEEPEST and _depth(text) > DEEPEST:
        return f"{quoted(text)} is nested deeper than {DEEPEST}"
    try:
        symbol = clingo.parse_term(text, logger=lambda *_: None)
    except (RuntimeError, UnicodeError):  # clingo's message may end within a character
        return f"{quoted(text)} is not a ground {noun}"
    # clingo evaluates arithmetic, and wraps numbers that are too large, without a warning.
    if str(symbol) != _SPACE.sub(r"\1", text):
        read = cut_short(str(symbol))
        return f"{quoted(text)} is not a plain {noun}: clingo reads it as {read}"
    return symbol


@functools.lru_cache(maxsize=2**14)  # because the same landmarks occur after many steps
def spelt(text: str) -> str:
    """Spell a ground term as clingo does, without unnecessary blanks.

    Raises:
        ValueError: The text is not a ground term.
    """
    symbol = ground(text, "term")
    if isinstance(symbol, str):
        raise ValueError(symbol)
    return str(symbol)


def _depth(text: str) -> int:
    """An upper bound on how deeply the brackets of a text are nested."""
    depth = deepest = 0
    for bracket in _BRACKET.findall(text):
        depth += (bracket in "(|") - (bracket == ")")
        deepest = max(deepest, depth)
    return deepest


def quoted(text: str) -> str:
    """Quote a text in one line, for a message."""
    return repr(cut_short(text))


def cut_short(text: str) -> str:
    """Shorten a text to one line, for a message."""
    line = " ".join(text[:1000].split())
    return line if len(line) <= 40 else line[:37] + "..."
