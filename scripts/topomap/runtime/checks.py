"""What callers of the public functions give as numbers, shares, seconds and answers to yes or no:
checked, and as plain Python has it. Each check raises ValueError, one line that names the argument
and says what it may be."""

import math
import operator
import reprlib
from numbers import Real
from typing import Any, overload

from topomap.runtime.limits import LARGEST


def integer(name: str, value: Any) -> int:
    """A whole number of any type that has whole numbers, such as those of numpy, as an int. True
    and False are none."""
    if not isinstance(value, bool):
        try:
            return operator.index(value)
        except TypeError:
            pass
    raise ValueError(f"{said(name, value)}: a whole number is wanted")


@overload
def whole(name: str, value: None, least: int, most: int = LARGEST) -> None: ...
@overload
def whole(name: str, value: int, least: int, most: int = LARGEST) -> int: ...
@overload
def whole(name: str, value: int | None, least: int, most: int = LARGEST) -> int | None: ...
def whole(name: str, value: int | None, least: int, most: int = LARGEST) -> int | None:
    """A whole number between bounds; None, where an argument was not given, stays None."""
    if value is None:
        return None
    try:
        number = integer(name, value)
    except ValueError:
        number = least - 1
    if not least <= number <= most:
        bounds = f"{least} or more" if most >= LARGEST else f"from {least} to {most}"
        if number > most >= LARGEST:
            bounds = f"from {least} to {most}"
        raise ValueError(f"{said(name, value)}: it must be a whole number, {bounds}")
    return number


def seconds(name: str, value: float | None) -> float | None:
    """A number of seconds, 0 or more and finite; None, for no limit, stays None."""
    if value is None:
        return None
    number = _real(value)
    if not 0 <= number <= LARGEST:
        raise ValueError(
            f"{said(name, value)}: it must be a number of seconds, from 0 to {LARGEST}, or None"
        )
    return number


def share(name: str, value: float) -> float:
    """A share of something, from 0 to 1."""
    number = _real(value)
    if not 0 <= number <= 1:
        raise ValueError(f"{said(name, value)}: it must be a number from 0 to 1")
    return number


def flag(name: str, value: bool) -> bool:
    """True or False, and nothing else that Python takes for one of them."""
    if not isinstance(value, bool):
        raise ValueError(f"{said(name, value)}: it must be True or False")
    return value


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
