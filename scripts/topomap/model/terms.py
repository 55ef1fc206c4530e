"""Ground terms and facts, as clingo writes them."""

import functools
import re

import clingo

DEEPEST = 100  # clingo's parser crashes on terms that are very deep
STRING = r'"(?:[^"\\\n]++|\\.)*+"'
_SPACE = re.compile(rf"({STRING})|\s+", re.DOTALL)
_BRACKET = re.compile(rf"{STRING}|[(|)]", re.DOTALL)


def ground(text: str, noun: str) -> clingo.Symbol | str:
    """What a text denotes, if it is one ground term that clingo writes in the same way but for
    blanks; or else, in words, why it is none. ``noun`` says what was wanted: a fact or a term."""
    if len(text) > DEEPEST and _depth(text) > DEEPEST:
        return f"{quoted(text)} is nested deeper than {DEEPEST}"
    try:
        symbol = clingo.parse_term(text, logger=lambda *_: None)
    except (RuntimeError, UnicodeError):  # clingo's message may cut a letter in two
        return f"{quoted(text)} is not a ground {noun}"
    # clingo computes, and wraps numbers that are too large, without a word.
    if str(symbol) != _SPACE.sub(r"\1", text):
        read = cut_short(str(symbol))
        return f"{quoted(text)} is not a plain {noun}: clingo reads it as {read}"
    return symbol


@functools.lru_cache(maxsize=2**14)  # landmarks are the same after many steps
def spelt(text: str) -> str:
    """A ground term as clingo writes it: without the blanks that it passes over. Raises
    ValueError if the text is no ground term."""
    symbol = ground(text, "term")
    if isinstance(symbol, str):
        raise ValueError(symbol)
    return str(symbol)


def _depth(text: str) -> int:
    """How deep the brackets of a text are nested, or more."""
    depth = deepest = 0
    for bracket in _BRACKET.findall(text):
        depth += (bracket in "(|") - (bracket == ")")
        deepest = max(deepest, depth)
    return deepest


def quoted(text: str) -> str:
    """A text in quotes and in one line, for a message."""
    return repr(cut_short(text))


def cut_short(text: str) -> str:
    """A text in one line for a message."""
    line = " ".join(text[:1000].split())
    return line if len(line) <= 40 else line[:37] + "..."
