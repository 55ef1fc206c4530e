"""What several readers need: texts, names, numbers and landmarks that a file may hold."""

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

LONGEST = 1000  # letters of a name
_WHOLE = re.compile(r"0|-?[1-9][0-9]{0,8}", re.ASCII)


@functools.lru_cache(maxsize=1)  # each reader looks at the same file
def json_of(content: bytes) -> Any:
    """What a JSON text says; the error if it is none."""
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


def beginning(content: bytes) -> bytes:
    """The first letters of a file of text, small ones, for what a format is known by. XML may be
    written in UTF-16."""
    start = content[:4000]
    if start[:2] in (b"\xff\xfe", b"\xfe\xff"):
        start = start.decode("utf-16", "ignore").encode()
    return start.removeprefix(b"\xef\xbb\xbf").lstrip().lower()


def looks_like_json(content: bytes) -> bool:
    """Whether a file begins as JSON does."""
    return content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in (b"{", b"[")


def demand_json(file: str, content: bytes) -> Any:
    """What a file of JSON says. Raises InputError, one line."""
    told = json_of(content)
    if isinstance(told, InputError):
        raise InputError(f"{file}:{told}")
    return told


def shown(name: object) -> str:
    """A name as messages have it: in one line, and not too long."""
    text = printable(str(name)[:100])
    return text if len(text) <= 60 else text[:57] + "..."


def name_of(file: str, what: str, told: object) -> str:
    """A name or a number, as text. Raises InputError if that can be none."""
    if not isinstance(told, str | int | float) or isinstance(told, bool):
        raise InputError(f"{file}: {what}: its name is no text and no number")
    text = str(told)
    if len(text) > LONGEST:
        raise InputError(f"{file}: {what}: a name of more than {LONGEST} letters")
    if "\0" in text or (not text.isprintable() and any("\ud800" <= c <= "\udfff" for c in text)):
        raise InputError(f"{file}: {what}: a name with a sign that is no letter: {shown(text)}")
    return text


def number_of(told: object) -> float | None:
    """A finite number that clingo could hold, given as a number or as text; None if it is none."""
    try:
        number = float(told) if isinstance(told, str | int | float) else math.nan
    except (ValueError, OverflowError):
        return None
    return number if abs(number) <= LARGEST and not isinstance(told, bool) else None


def numbered(names: Collection[str]) -> dict[str, Place]:
    """The places of these names: whole numbers if all names are, else the names."""
    whole = all(_WHOLE.fullmatch(name) for name in names)
    return {name: int(name) if whole else name for name in names}


def demand_few(file: str, places: int) -> None:
    """Raises InputError if there are too many places."""
    if places > MOST_PLACES:
        raise InputError(f"{file}: {places} places; at most {MOST_PLACES} are read")


def landmarks_of(file: str, what: str, told: object) -> frozenset[str]:
    """Landmarks as terms of clingo, given as a list of texts. Raises InputError."""
    if not isinstance(told, list) or not all(isinstance(text, str) for text in told):
        raise InputError(f"{file}: {what}: its landmarks are no list of texts")
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
