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
    """Read a log of bearings: CSV, or JSON lines, one row for each visit
    (``docs/logs-of-explorers.md`` names the columns).

    Parameters:
        path: the file; ``-`` is standard input.
        slots: the number of directions at a place, even; by default the fewest that fit the
            bearings, or 360.
        tolerance: by how many slots bearings may be wrong; by default 0 if the bearings fit the
            slots, else it is measured where the log surely comes to a place again.
        frame: ``arrival`` if bearings count from the way back, ``north`` if they count from north;
            by default ``north`` if there are compass letters.
        facing: where bearing 0 is in the frame of the arrival: ``back`` or ``ahead``.
        straight_ways: by how many degrees a way bends at most from one place to the next; by this
            the exits of arrival are found in the frame ``north``, where they are not told.
        straight: by how many degrees two exits of a place that are on one path may be off being
            opposite; by default those in opposite slots are on one path, or the limit is chosen
            where no slots fit.
        unit: how much of the lengths of the log is one unit of the instance; by default 1, or 0.01
            if some are fractions.

    Returns:
        The log: ``experience``, ``chosen`` (what was chosen, in words, or None), ``warnings``, and
        ``text()``, the instance file.

    Raises:
        TypeError: no path.
        ValueError: a number that cannot be, an unknown frame.
        InputError: the file cannot be read, or is no log; one line with file, line, step and fault.
    """
    if frame not in (None, *FRAMES):
        raise ValueError(f"frame={frame!r}: it is {' or '.join(FRAMES)}")
    if facing not in FACING:
        raise ValueError(f"facing={facing!r}: it is {' or '.join(FACING)}")
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
