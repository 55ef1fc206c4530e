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
    """The experience in an instance file (the paper, section II).

    Parameters:
        path: a file of facts ``slots/1``, ``view/2``, ``turn/2``, and optionally ``landmark/2``,
            ``drop/1``, ``pick/1``, ``marker/1``, ``compass/2``, ``shift/3``, ``length/2``,
            ``straight/3``, ``same/2`` and ``apart/2``; ``-`` is standard input.
        noisy: allow what can only be a misreading: a turn to a gateway that was not seen, a view
            without slot 0. For ``solve(..., noise=K)``.
        drift: how far shifts may be wrong, in percent of the way; 10 by default.
        stretch: how far lengths of one way may differ, in percent; 10 by default.
        tolerance: by how many slots bearings may be wrong; 0 by default, and with ``noisy``.

    Returns:
        The experience: ``slots`` directions a place, ``views`` and ``landmarks`` after each step
        from 0, ``turns`` of each step from 1, in slots clockwise.

    Raises:
        TypeError: no path.
        ValueError: a drift, a stretch or a tolerance that is no whole number, 0 or more.
        InputError: the file cannot be read or is no instance; the message is one line that names
            file, line, step and fault.
    """
    given = {"drift": drift, "stretch": stretch, "tolerance": tolerance}
    measured = (whole_if_given(name, value, 0) for name, value in given.items())
    return facts.read(path_of(path), flag("noisy", noisy), *measured)
