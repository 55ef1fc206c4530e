"""Reading instances."""

from pathlib import Path

from topomap.api.parts import path_of
from topomap.model import facts
from topomap.model.experience import Experience
from topomap.runtime.checks import flag, whole_if_given


def read(
    path: str | Path,
    noisy: bool = False,
    *,
    drift: int | None = None,
    stretch: int | None = None,
    tolerance: int | None = None,
) -> Experience:
    """Read the experience in an instance file (the paper, section II).

    Parameters:
        path: A file of the facts ``slots/1``, ``view/2``, ``turn/2``, and optionally
            ``landmark/2``, ``drop/1``, ``pick/1``, ``marker/1``, ``compass/2``, ``shift/3``,
            ``length/2``, ``straight/3``, ``same/2`` and ``apart/2``; ``-`` is standard input.
        noisy: Whether to allow what can only be a misreading, such as a turn to a gateway that was
            not seen, or a view without slot 0. ``solve(..., noise=K)`` needs it.
        drift: By how many percent of the way shifts may be wrong; 10 by default.
        stretch: By how many percent lengths of one way may differ; 10 by default.
        tolerance: By how many slots bearings may be wrong; 0 by default, and always 0 with
            ``noisy``.

    Returns:
        The experience, with the number of ``slots`` of a place, the ``views`` and ``landmarks``
        after each step from 0, and the ``turns`` of each step from 1, in slots clockwise.

    Raises:
        TypeError: ``path`` is not the path of a file.
        ValueError: ``drift``, ``stretch`` or ``tolerance`` is not a whole number of 0 or more.
        InputError: The file cannot be read, or is not an instance. The message is one line that
            names the file, the line, the step and the fault.
    """
    given = {"drift": drift, "stretch": stretch, "tolerance": tolerance}
    measured = (whole_if_given(name, value, 0) for name, value in given.items())
    return facts.read(path_of(path), flag("noisy", noisy), *measured)
