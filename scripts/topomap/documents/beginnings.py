"""Maps of the first steps of an experience."""

from collections.abc import Sequence
from typing import Any

from topomap.documents import maps
from topomap.model.experience import DState, Experience
from topomap.runtime.errors import InputError


def beginning(
    where: str, at: Any, whole: Experience, experience: Experience, demands: Sequence[str] = ()
) -> tuple[DState, ...]:
    """Check that ``at``, ``[[T,P,S], ...]``, is a hypothesis of the experience or of the whole.

    The experience is the beginning of the whole.

    Returns:
        The dstate after each step of the experience.

    Raises:
        InputError: It is not a hypothesis of either. One line that begins with ``where``.
    """
    if len(at) - 1 not in (whole.steps, experience.steps):
        raise InputError(f"{where}: {len(at) - 1} steps, but the instance has {experience.steps}")
    return maps.hypothesis(where, at, whole, demands)[: experience.steps + 1]
