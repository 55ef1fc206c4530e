"""What the public functions have in common: keyword arguments, and checks of arguments."""

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
    """The demands on maps and the preferences among them (the paper, sections II to IV).

    Each is a part of ``encodings/``.

    Attributes:
        planar: Each new link joins two gateways of one face.
        euler: The map is planar by Euler's formula.
        closed: No gateway is pending.
        travelled: Every path has two places or more.
        boundary: No place is both left and right of a path, or both on it and beside it.
        perpendicular: Two paths meet at most once, and no three make a triangle.
        genus: Maps with the least genus are preferred.
        exceptions: Of these, maps with the fewest exceptions to consistent boundaries are
            preferred.
        minimal: Of these, maps with the fewest paths, then the fewest places, are preferred.
        no_path_axiom: A path may contain a place twice, and may be circular.
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
    """The demands on maps that are followed step by step; ``Parts`` explains them."""

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
    """Make the query that asks for the parts that are true.

    Raises:
        ValueError: A part is not among those that are allowed (the message names these), or another
            argument is out of its range.
    """
    asked = frozenset(asked_of(parts, allowed))
    if encoding not in FORMS:
        raise ValueError(f"encoding={encoding!r}: it must be {' or '.join(FORMS)}")
    if encoding == "paper" and (others := unstated(asked)):
        raise ValueError(f"encoding='paper' has no rules for {', '.join(others)}")
    if encoding == "paper" and noise is not None:
        raise ValueError("encoding='paper' cannot be combined with noise")
    return Query(
        asked,
        whole_if_given("bound", bound, 1),
        whole_if_given("horizon", horizon, 0),
        encoding,
        whole_if_given("noise", noise, 0),
    )


def asked_of(parts: Mapping[str, Any], allowed: Collection[str]) -> list[str]:
    """List the parts that are true.

    Raises:
        ValueError: A part is not among those that are allowed (the message names these), or is
            neither true nor false.
    """
    for part in parts:
        if part not in allowed:
            near = meant(part, allowed)
            hint = f"; {near}" if near else ""
            known = ", ".join(allowed)
            raise ValueError(f"{part!r} is not one of the parts {known}{hint}")
    return [part for part, value in parts.items() if flag(part, value)]


def demand_experience(experience: object) -> None:
    """Refuse what is not an experience, such as the name of a file.

    Raises:
        TypeError: It is not an experience.
    """
    if not isinstance(experience, Experience):
        told = shown(experience)
        raise TypeError(f"an Experience is wanted, which topomap.read(path) gives, not {told}")


def demand_pairs(experience: object, where: str) -> None:
    """Refuse assumptions other than which visits are of one place.

    The encodings get all other assumptions, and what ``where`` names does not use the encodings.

    Raises:
        ValueError: There is another assumption.
    """
    if isinstance(experience, Experience) and experience.assumed:
        known = "same(T,U) and not same(T,U)"
        raise ValueError(f"{where}: only {known} can be taken for granted")


def begin(experience: Experience, timeout: float | None, noisy: bool = False) -> Watch:
    """Check an experience, which may have been made in Python, and make the watch of the call.

    Raises:
        TypeError: It is not an experience.
        InputError: The experience is impossible; ``noisy`` allows what may be a misreading. The
            message is one line.
        ValueError: The time limit is not a number of seconds.
    """
    demand_experience(experience)
    limit = seconds("timeout", timeout)
    measured = experience.drift, experience.stretch, experience.tolerance
    parse(experience.facts(), "the experience, as facts", noisy, *measured)
    for term, holds in sorted(experience.assumed):
        parse_statement(statement_text(term, holds), experience, "assumed")
    return Watch(limit)


def demand_text(name: str, value: object, example: str) -> None:
    """Refuse what is not a text.

    Raises:
        TypeError: It is not a text.
    """
    if not isinstance(value, str):
        raise TypeError(f"{name}: a text is wanted, such as {example!r}, not {shown(value)}")


def path_of(path: object) -> str:
    """Check the path of a file.

    Raises:
        TypeError: It is not a path.
    """
    if isinstance(path, str):
        return path
    if isinstance(path, os.PathLike) and isinstance(named := os.fspath(path), str):
        return named
    raise TypeError(f"the path of a file is wanted, not {shown(path)}")


def senses_of(compass: bool, odometry: float | None, lengths: bool, seed: int) -> Senses:
    """Collect what is measured besides views.

    Raises:
        ValueError: A number is out of its range.
    """
    error = None if odometry is None else percent("odometry", odometry)
    return Senses(flag("compass", compass), error, flag("lengths", lengths), seed)


def world_of(world: str | Environment, size: Sequence[int], thin: float, seed: int) -> Environment:
    """Make the environment that is named, or return the one that was given.

    Raises:
        TypeError: It is neither a name nor an environment.
        ValueError: The name is not known, or the size is impossible.
        InputError: The environment is too large.
    """
    if isinstance(world, Environment):
        return world
    if not isinstance(world, str):
        told = shown(world)
        raise TypeError(f"world: the name of a world, or an environment, is wanted, not {told}")
    if len(size) != 2:
        raise ValueError(f"{world}: rows and columns are wanted, not {len(size)} numbers")
    rows, columns = size
    return environment(world, rows, columns, thin, seed)
