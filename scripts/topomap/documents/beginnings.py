"""Maps of an experience of which only the first steps count."""

from collections.abc import Sequence
from typing import Any

from topomap.documents import maps
from topomap.model.experience import DState, Experience
from topomap.runtime.errors import InputError


def beginning(
    where: str, at: Any, whole: Experience, experience: Experience, demands: Sequence[str] = ()
) -> tuple[DState, ...]:
    """The dstate after each step of the experience, if ``at``, ``[[T,P,S], ...]``, is a hypothesis
    of it, or of the whole of which it is the beginning. Raises InputError, one line that begins
    with ``where``, if it is none."""
    if len(at) - 1 not in (whole.steps, experience.steps):
        raise InputError(f"{where}: {len(at) - 1} steps, the instance has {experience.steps}")
    return maps.hypothesis(where, at, whole, demands)[: experience.steps + 1]
