"""What the public functions have in common: the parts of the theory, as keyword arguments, and
the checks of what they are given."""

import os
from collections.abc import Collection, Mapping, Sequence
from typing import Any, TypedDict

from topomap.model.experience import Experience
from topomap.model.facts import parse
from topomap.model.query import Query
from topomap.model.vocabulary import FORMS, PARTS, unstated
from topomap.questions.statements import parse_statement, statement_text
from topomap.runtime.checks import flag, percent, seconds, shown, whole_if_given
from topomap.runtime.near import meant
from topomap.runtime.watch import Watch
from topomap.worlds.environment import Environment, environment
from topomap.worlds.senses import Senses


class Parts(TypedDict, total=False):
    """What maps are to have (the paper, sections II to IV). Each is a part of ``encodings/``:

    ``planar``: a new link joins two gateways of one face; ``euler``: the same, by Euler's
    formula; ``closed``: no gateway is pending; ``travelled``: every path holds two places or
    more; ``boundary``: no place is left and right of a path, or on it and beside it;
    ``perpendicular``: two paths meet once at most, and no three make a triangle; ``genus``:
    the least genus is preferred; ``exceptions``: then the fewest exceptions to consistent
    boundaries; ``minimal``: then the fewest paths, then the fewest places. And ``no_path_axiom``: a
    path may hold a place twice, and may be circular.
    """

    planar: bool
    euler: bool
    closed: bool
    travelled: bool
    boundary: bool
    perpendicular: bool
    genus: bool
    exceptions: bool
    minimal: bool
    no_path_axiom: bool


class OnlineParts(TypedDict, total=False):
    """What maps are to have that are followed step by step; see ``Parts``."""

    planar: bool
    no_path_axiom: bool


def query_of(
    parts: Mapping[str, Any],
    *,
    bound: int | None = None,
    horizon: int | None = None,
    encoding: str = "work",
    noise: int | None = None,
    allowed: Collection[str] = tuple(PARTS),
) -> Query:
    """The query that asks for the parts that are true. Raises ValueError, naming the known ones,
    if one is not among those that are allowed, and if something else is not what it may be."""
    asked = frozenset(asked_of(parts, allowed))
    if encoding not in FORMS:
        raise ValueError(f"encoding={encoding!r}: it is {' or '.join(FORMS)}")
    if encoding == "paper" and (others := unstated(asked)):
        raise ValueError(f"encoding='paper' does not state {', '.join(others)}")
    if encoding == "paper" and noise is not None:
        raise ValueError("encoding='paper' does not go with noise")
    return Query(
        asked,
        whole_if_given("bound", bound, 1),
        whole_if_given("horizon", horizon, 0),
        encoding,
        whole_if_given("noise", noise, 0),
    )


def asked_of(parts: Mapping[str, Any], allowed: Collection[str]) -> list[str]:
    """The parts that are true. Raises ValueError, naming the known ones, if one is not among those
    that are allowed, or is neither true nor false."""
    for part in parts:
        if part not in allowed:
            near = meant(part, allowed)
            hint = f"; {near}" if near else ""
            known = ", ".join(allowed)
            raise ValueError(f"{part!r} is not one of the parts {known}{hint}")
    return [part for part, value in parts.items() if flag(part, value)]


def demand_experience(experience: object) -> None:
    """Raises TypeError if what was given is no experience, such as the name of a file."""
    if not isinstance(experience, Experience):
        told = shown(experience)
        raise TypeError(f"an Experience is wanted, which topomap.read(path) gives, not {told}")


def demand_pairs(experience: object, where: str) -> None:
    """Raises ValueError if more is taken for granted than which visits are of one place: the rest
    is put to the encodings, and what ``where`` names does not ask them."""
    if isinstance(experience, Experience) and experience.assumed:
        known = "same(T,U) and not same(T,U)"
        raise ValueError(f"{where} knows no statement that is taken for granted but {known}")


def begin(experience: Experience, timeout: float | None, noisy: bool = False) -> Watch:
    """The watch of a call, once an experience that may have been made in Python is checked. Raises
    TypeError if it is no experience; InputError, one line, if it cannot be, where ``noisy``
    allows what may be a misreading; ValueError if the time limit is no number of seconds."""
    demand_experience(experience)
    limit = seconds("timeout", timeout)
    measured = experience.drift, experience.stretch, experience.tolerance
    parse(experience.facts(), "the experience, as facts", noisy, *measured)
    for term, holds in sorted(experience.assumed):
        parse_statement(statement_text(term, holds), experience, "assumed")
    return Watch(limit)


def demand_text(name: str, value: object, example: str) -> None:
    """Raises TypeError if what was given is no text."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: a text is wanted, such as {example!r}, not {shown(value)}")


def path_of(path: object) -> str:
    """The path of a file. Raises TypeError if it is none."""
    if isinstance(path, str):
        return path
    if isinstance(path, os.PathLike) and isinstance(named := os.fspath(path), str):
        return named
    raise TypeError(f"the path of a file is wanted, not {shown(path)}")


def senses_of(compass: bool, odometry: float | None, lengths: bool, seed: int) -> Senses:
    """What is measured besides views. Raises ValueError."""
    error = None if odometry is None else percent("odometry", odometry)
    return Senses(flag("compass", compass), error, flag("lengths", lengths), seed)


def world_of(world: str | Environment, size: Sequence[int], thin: float, seed: int) -> Environment:
    """The environment that is named, or that was made before. Raises TypeError if it is neither,
    ValueError if it is not known or of a size that cannot be, InputError if it is too large."""
    if isinstance(world, Environment):
        return world
    if not isinstance(world, str):
        told = shown(world)
        raise TypeError(f"world: the name of a world, or an environment, is wanted, not {told}")
    if len(size) != 2:
        raise ValueError(f"{world}: rows and columns are wanted, not {len(size)} numbers")
    rows, columns = size
    return environment(world, rows, columns, thin, seed)
