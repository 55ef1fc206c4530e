"""What several readers need: the texts, names, numbers and landmarks in files."""

import functools
import json
import math
import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import clingo

from topomap.model.terms import spelt
from topomap.model.topology import Place, label
from topomap.runtime.errors import InputError, printable
from topomap.runtime.limits import LARGEST, MOST_PLACES
from topomap.worlds.plan import Plan

LONGEST = 1000  # the largest number of letters of a name
_WHOLE = re.compile(r"0|-?[1-9][0-9]{0,8}", re.ASCII)


@functools.lru_cache(maxsize=1)  # all readers look at one file
def json_of(content: bytes) -> Any:
    """Read a JSON text; the result is the error if it is not one."""
    try:
        return json.loads(content.decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        return InputError(f"{error.lineno}: not a whole JSON text: {error.msg.lower()}")
    except UnicodeDecodeError:
        return InputError(" not a text file")
    except RecursionError:
        return InputError(" JSON that is nested too deep")
    except ValueError:
        return InputError(" JSON with a number that is too long")


def is_xml_with(content: bytes, name: bytes) -> bool:
    """Tell whether a file is XML with an element of this name; XML may be written in UTF-16."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        content = content.decode("utf-16", "ignore").encode()
    begins = content[:100].removeprefix(b"\xef\xbb\xbf").lstrip()
    return begins[:1] == b"<" and b"<" + name in content.lower()


def looks_like_json(content: bytes) -> bool:
    """Tell whether a file begins like JSON."""
    return content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in (b"{", b"[")


def demand_json(file: str, content: bytes) -> Any:
    """Read a file of JSON.

    Raises:
        InputError: It is not JSON. One line.
    """
    told = json_of(content)
    if isinstance(told, InputError):
        raise InputError(f"{file}:{told}")
    return told


def shown(name: object) -> str:
    """A name as messages show it, in one line, and not too long."""
    text = printable(str(name)[:100])
    return text if len(text) <= 60 else text[:57] + "..."


def name_of(file: str, what: str, told: object) -> str:
    """Read a name or a number as text.

    Raises:
        InputError: It is neither.
    """
    if not isinstance(told, str | int | float) or isinstance(told, bool):
        raise InputError(f"{file}: {what}: its name is neither a text nor a number")
    text = str(told)
    if len(text) > LONGEST:
        raise InputError(f"{file}: {what}: a name of more than {LONGEST} letters")
    if "\0" in text or (not text.isprintable() and any("\ud800" <= c <= "\udfff" for c in text)):
        said = f"a name with a character that is not allowed: {shown(text)}"
        raise InputError(f"{file}: {what}: {said}")
    return text


def number_of(told: object) -> float | None:
    """Read a finite number that clingo could hold, from a number or a text; None if it is none."""
    try:
        number = float(told) if isinstance(told, str | int | float) else math.nan
    except (ValueError, OverflowError):
        return None
    return number if abs(number) <= LARGEST and not isinstance(told, bool) else None


def numbered(names: Collection[str]) -> dict[str, Place]:
    """The places of these names: whole numbers if all names are, otherwise the names."""
    whole = all(_WHOLE.fullmatch(name) for name in names)
    return {name: int(name) if whole else name for name in names}


def demand_few(file: str, places: int) -> None:
    """Check that there are not too many places.

    Raises:
        InputError: There are too many.
    """
    if places > MOST_PLACES:
        raise InputError(f"{file}: {places} places; at most {MOST_PLACES} are read")


def landmarks_of(file: str, what: str, told: object) -> frozenset[str]:
    """Read landmarks, which are given as a list of texts, as terms of clingo.

    Raises:
        InputError: They are not such a list.
    """
    if not isinstance(told, list) or not all(isinstance(text, str) for text in told):
        raise InputError(f"{file}: {what}: its landmarks are not a list of texts")
    try:
        return frozenset(spelt(text) for text in told)
    except ValueError as error:
        raise InputError(f"{file}: {what}: landmark {error}") from None


def with_names(plan: Plan) -> Plan:
    """The plan in which the name of each place is one of its landmarks."""
    landmarks: dict[Place, frozenset[str]] = dict(plan.landmarks)
    names: Mapping[Place, str] = plan.names
    for place in sorted({end.place for way in plan.ways for end in way.ends}):
        if name := names.get(place, label(place)):
            sign = str(clingo.String(name))
            landmarks[place] = landmarks.get(place, frozenset()) | {sign}
    return replace(plan, landmarks=landmarks)
