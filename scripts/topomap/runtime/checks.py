"""Checks of what callers of the public functions give, which is converted to plain Python.

Each check raises a ValueError, in one line that names the argument and says what it may be;
``collection`` raises a TypeError.
"""

import math
import operator
import reprlib
from collections.abc import Iterable
from numbers import Real
from typing import Any, TypeVar

from topomap.runtime.limits import LARGEST

T = TypeVar("T")


def integer(name: str, value: Any) -> int:
    """Convert a whole number of any type, such as those of numpy, to int; bool is refused."""
    if not isinstance(value, bool):
        try:
            return operator.index(value)
        except TypeError:
            pass
    raise ValueError(f"{said(name, value)}: a whole number is wanted")


def whole(name: str, value: Any, least: int, most: int = LARGEST) -> int:
    """Check a whole number between bounds."""
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
    """Check a whole number between bounds, or None if it was not given."""
    return None if value is None else whole(name, value, least, most)


def seconds(name: str, value: Any) -> float | None:
    """Check a number of seconds, 0 or more and finite, or None for no limit."""
    if value is None:
        return None
    number = _real(value)
    if not 0 <= number <= LARGEST:
        raise ValueError(
            f"{said(name, value)}: it must be a number of seconds, from 0 to {LARGEST}, or None"
        )
    return number


def number_if_given(name: str, value: Any, least: float = -LARGEST) -> float | None:
    """Check a finite number, which must not be below the least one, or None if it was not given."""
    if value is None:
        return None
    number = _real(value)
    if not least <= number <= LARGEST:
        raise ValueError(f"{said(name, value)}: it must be a number from {least:g} to {LARGEST}")
    return number


def share(name: str, value: Any) -> float:
    """Check a share of something, from 0 to 1."""
    number = _real(value)
    if not 0 <= number <= 1:
        raise ValueError(f"{said(name, value)}: it must be a number from 0 to 1")
    return number


def percent(name: str, value: Any) -> float:
    """Check a number of percent, from 0 to 1000."""
    number = _real(value)
    if not 0 <= number <= 1000:
        raise ValueError(f"{said(name, value)}: it must be a number of percent, from 0 to 1000")
    return number


def degrees(name: str, value: Any) -> float | None:
    """Check an angle in degrees, from 0 to 180, or None if it was not given."""
    number = 0.0 if value is None else _real(value)
    if not 0 <= number <= 180:
        raise ValueError(f"{said(name, value)}: it must be a number of degrees, from 0 to 180")
    return None if value is None else number


def positive(name: str, value: Any) -> float | None:
    """Check a number above 0, neither tiny nor infinite, or None if it was not given."""
    number = 1.0 if value is None else _real(value)
    if not 1e-9 <= number <= LARGEST:
        raise ValueError(f"{said(name, value)}: it must be a number from 1e-09 to {LARGEST}")
    return None if value is None else number


def flag(name: str, value: Any) -> bool:
    """Check that a value is True or False, and nothing else that Python takes for one of them."""
    if not isinstance(value, bool):
        raise ValueError(f"{said(name, value)}: it must be True or False")
    return value


def collection(name: str, given: Iterable[T]) -> Iterable[T]:
    """Check that a value is a collection.

    Raises:
        TypeError: It is not one, or it is a text, where nobody means the single letters.
    """
    if isinstance(given, str | bytes) or not isinstance(given, Iterable):
        raise TypeError(f"{name}: a collection is wanted, such as a list, not {shown(given)}")
    return given


def _real(value: object) -> float:
    """Convert a number to a float; what is not a number becomes nan."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def said(name: str, value: object) -> str:
    """Name an argument and the value that was given for it, in one line."""
    return f"{name}={shown(value)}"


def shown(value: object) -> str:
    """Show a value that was given, in one short line."""
    return " ".join(reprlib.repr(value).split())
