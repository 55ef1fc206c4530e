"""What callers of the public functions give as numbers, shares, seconds and answers to yes or no:
checked, and as plain Python has it. Each check raises ValueError, one line that names the argument
and says what it may be; ``collection`` raises TypeError."""

import math
import operator
import reprlib
from collections.abc import Iterable
from numbers import Real
from typing import Any, TypeVar

from topomap.runtime.limits import LARGEST

T = TypeVar("T")


def integer(name: str, value: Any) -> int:
    """A whole number of any type that has whole numbers, such as those of numpy, as an int. True
    and False are none."""
    if not isinstance(value, bool):
        try:
            return operator.index(value)
        except TypeError:
            pass
    raise ValueError(f"{said(name, value)}: a whole number is wanted")


def whole(name: str, value: Any, least: int, most: int = LARGEST) -> int:
    """A whole number between bounds."""
    try:
        number = integer(name, value)
    except ValueError:
        number = least - 1
    if not least <= number <= most:
        open_ended = most >= LARGEST and number < least
        bounds = f"{least} or more" if open_ended else f"from {least} to {most}"
        raise ValueError(f"{said(name, value)}: it must be a whole number, {bounds}")
    return number


def whole_if_given(name: str, value: Any, least: int, most: int = LARGEST) -> int | None:
    """The same; None, where an argument was not given, stays None."""
    return None if value is None else whole(name, value, least, most)


def seconds(name: str, value: Any) -> float | None:
    """A number of seconds, 0 or more and finite; None, for no limit, stays None."""
    if value is None:
        return None
    number = _real(value)
    if not 0 <= number <= LARGEST:
        raise ValueError(
            f"{said(name, value)}: it must be a number of seconds, from 0 to {LARGEST}, or None"
        )
    return number


def number_if_given(name: str, value: Any, least: float = -LARGEST) -> float | None:
    """A finite number, not below the least one; None, where it was not given, stays None."""
    if value is None:
        return None
    number = _real(value)
    if not least <= number <= LARGEST:
        raise ValueError(f"{said(name, value)}: it must be a number from {least:g} to {LARGEST}")
    return number


def share(name: str, value: Any) -> float:
    """A share of something, from 0 to 1."""
    number = _real(value)
    if not 0 <= number <= 1:
        raise ValueError(f"{said(name, value)}: it must be a number from 0 to 1")
    return number


def percent(name: str, value: Any) -> float:
    """A number of percent, 0 to 1000."""
    number = _real(value)
    if not 0 <= number <= 1000:
        raise ValueError(f"{said(name, value)}: it must be a number of percent, from 0 to 1000")
    return number


def degrees(name: str, value: Any) -> float | None:
    """An angle in degrees, 0 to 180; None, where it was not given, stays None."""
    number = 0.0 if value is None else _real(value)
    if not 0 <= number <= 180:
        raise ValueError(f"{said(name, value)}: it must be a number of degrees, from 0 to 180")
    return None if value is None else number


def positive(name: str, value: Any) -> float | None:
    """A number above 0, which is neither tiny nor without end; None, where it was not given, stays
    None."""
    number = 1.0 if value is None else _real(value)
    if not 1e-9 <= number <= LARGEST:
        raise ValueError(f"{said(name, value)}: it must be a number from 1e-09 to {LARGEST}")
    return None if value is None else number


def flag(name: str, value: Any) -> bool:
    """True or False, and nothing else that Python takes for one of them."""
    if not isinstance(value, bool):
        raise ValueError(f"{said(name, value)}: it must be True or False")
    return value


def collection(name: str, given: Iterable[T]) -> Iterable[T]:
    """What was given as a collection. Raises TypeError if it is none, or is a text, whose letters
    nobody means."""
    if isinstance(given, str | bytes) or not isinstance(given, Iterable):
        raise TypeError(f"{name}: a collection is wanted, such as a list, not {shown(given)}")
    return given


def _real(value: object) -> float:
    """A number as a float; not a number (nan) if it is none."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def said(name: str, value: object) -> str:
    """An argument and what was given for it, in one line."""
    return f"{name}={shown(value)}"


def shown(value: object) -> str:
    """A value that was given, in one line that is not long."""
    return " ".join(reprlib.repr(value).split())
