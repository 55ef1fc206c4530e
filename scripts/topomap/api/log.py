"""Reading logs that somebody wrote as a table or as JSON lines."""

from pathlib import Path

from topomap.api.parts import path_of
from topomap.runtime.checks import degrees, positive, whole_if_given
from topomap.worlds.logs import FACING, FRAMES, Log, Options, load


def read_log(
    path: str | Path,
    *,
    slots: int | None = None,
    tolerance: int | None = None,
    frame: str | None = None,
    facing: str = "back",
    straight_ways: float | None = None,
    straight: float | None = None,
    unit: float | None = None,
) -> Log:
    """Read a log of bearings: CSV, or JSON lines, with one row for each visit.

    ``docs/logs-of-explorers.md`` names the columns. (The experience is that of the paper, section
    II.)

    Parameters:
        path: The file; ``-`` is standard input.
        slots: The number of directions at a place, an even number; by default the smallest that
            fits the bearings, or 360 if none does.
        tolerance: By how many slots bearings may be wrong; by default 0 if the bearings fit the
            slots, otherwise it is measured where the log surely comes to a place again.
        frame: ``arrival`` if bearings count from the exit by which one arrived, ``north`` if they
            count from north; by default ``north`` if there are compass letters, otherwise
            ``arrival``.
        facing: Where bearing 0 is in the frame ``arrival``: ``back`` or ``ahead``.
        straight_ways: By how many degrees a way bends at most from one place to the next. In the
            frame ``north`` this determines the exit of arrival, where the log does not.
        straight: By how many degrees two exits of a place may be off from being opposite if they
            are on one path. By default those in opposite slots are on one path, or the limit is
            chosen if no number of slots fits.
        unit: Which length of the log is one unit of the instance; by default 1, or 0.01 if some
            lengths are fractions.

    Returns:
        The log, with ``experience``, ``chosen`` (what was chosen, in words, or None), ``warnings``,
        and ``text()``, which is the instance file.

    Raises:
        TypeError: ``path`` is not the path of a file.
        ValueError: A number is out of its range, or ``frame`` or ``facing`` is not known.
        InputError: The file cannot be read, or is not a log. The message is one line that names the
            file, the line, the step and the fault.
    """
    if frame not in (None, *FRAMES):
        raise ValueError(f"frame={frame!r}: it must be {' or '.join(FRAMES)}")
    if facing not in FACING:
        raise ValueError(f"facing={facing!r}: it must be {' or '.join(FACING)}")
    return load(
        path_of(path),
        Options(
            whole_if_given("slots", slots, 2),
            whole_if_given("tolerance", tolerance, 0),
            frame,
            facing,
            degrees("straight_ways", straight_ways),
            degrees("straight", straight),
            positive("unit", unit),
        ),
    )
