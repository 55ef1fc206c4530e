"""What may be meant by a misspelt word: the nearest of the known words."""

from collections.abc import Iterable

LONGEST = 30  # letters that are compared, because the time grows with the square of their number


def nearest(word: str, known: Iterable[str], likeness: float = 0.6) -> str | None:
    """Find the known word that is most like a misspelt one.

    Parameters:
        word: The misspelt word.
        known: The words that are known.
        likeness: How like they must be, from 0 (always) to 1 (equal), as difflib measures it.

    Returns:
        The word, or None if none is like it.
    """
    import difflib  # it is not loaded for a call without a mistake

    return next(iter(difflib.get_close_matches(word[:LONGEST], known, 1, likeness)), None)


def meant(word: str, known: Iterable[str]) -> str:
    """Ask whether the nearest known word was meant.

    Parameters:
        word: The misspelt word.
        known: The words that are known.

    Returns:
        The question, such as "did you mean planar?"; an empty text if no known word is like it.
    """
    near = nearest(word, known)
    return f"did you mean {near}?" if near else ""
