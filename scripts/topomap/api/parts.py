"""The parts of the theory, as keyword arguments of the public functions."""

import difflib
from collections.abc import Collection, Mapping
from typing import TypedDict

from topomap.model.experience import Experience
from topomap.model.facts import parse
from topomap.model.query import Query
from topomap.model.vocabulary import FORMS, PARTS, STATED
from topomap.runtime.watch import Watch


class Parts(TypedDict, total=False):
    """What maps are to have (the paper, sections II to IV). Each is a part of ``encodings/``:

    ``planar``: a new link joins two gateways of one face; ``euler``: the same, by Euler's
    formula; ``closed``: no gateway is pending; ``travelled``: every path holds two places or
    more; ``boundary``: no place is left and right of a path, or on it and beside it;
    ``perpendicular``: two paths meet once at most, and no three make a triangle; ``genus``:
    the least genus is preferred; ``minimal``: the fewest paths are preferred, then the fewest
    places.
    """

    planar: bool
    euler: bool
    closed: bool
    travelled: bool
    boundary: bool
    perpendicular: bool
    genus: bool
    minimal: bool


def query_of(
    parts: Mapping[str, object],
    *,
    bound: int | None = None,
    horizon: int | None = None,
    encoding: str = "work",
    noise: int | None = None,
    allowed: Collection[str] = tuple(PARTS),
) -> Query:
    """The query that asks for the parts that are true. Raises ValueError, naming the known ones,
    if one is not among those that are allowed."""
    for part in parts:
        if part not in allowed:
            near = difflib.get_close_matches(part, allowed, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            known = ", ".join(allowed)
            raise ValueError(f"{part!r} is not one of the parts {known}{hint}")
    for name, value, least in (("bound", bound, 1), ("horizon", horizon, 0), ("noise", noise, 0)):
        if value is not None and value < least:
            raise ValueError(f"{name}={value}: it must be {least} or more")
    if encoding not in FORMS:
        raise ValueError(f"encoding={encoding!r}: it is {' or '.join(FORMS)}")
    asked = frozenset(part for part, value in parts.items() if value)
    if encoding == "paper" and (others := sorted(asked - STATED)):
        raise ValueError(f"encoding='paper' does not state {', '.join(others)}")
    if encoding == "paper" and noise is not None:
        raise ValueError("encoding='paper' does not go with noise")
    return Query(asked, bound, horizon, encoding, noise)


def begin(
    experience: Experience, timeout: float | None, watch: Watch | None, noisy: bool = False
) -> Watch:
    """The watch of a call: that of a command, which has read the experience and so checked it;
    or a new one, once an experience that may have been made in Python is checked. Raises
    InputError, one line, if it cannot be; ``noisy`` allows what may be a misreading."""
    if watch is not None:
        return watch
    parse(experience.facts(), "the experience, as facts", noisy)
    return Watch(timeout)
