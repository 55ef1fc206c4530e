"""Logs that somebody wrote as a table or as JSON lines, with bearings that are put into slots.

Bearings are in degrees or compass letters. docs/logs-of-explorers.md explains this to users.

The choice of slots is as follows. With K slots the bearings *fit* if each is less than an eighth of
a slot off the direction of a slot. Then two exits that get opposite slots bend by less than a
quarter of a slot, and views of one place agree, whichever exit it is seen from. The smallest number
of slots up to MOST_CLEAR that fits, and that separates the exits of each visit, is taken. If there
is none, there are FINE slots and a tolerance, and the instance tells of pairs of exits that are
nearly opposite that they are on one path.
"""

import math
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import clingo

from topomap.model.experience import MARKER, Experience, Thing
from topomap.model.facts import Facts, range_fault, slots_fault
from topomap.model.terms import quoted, spelt
from topomap.runtime.errors import InputError, printable
from topomap.runtime.files import read_text
from topomap.runtime.limits import DRIFT, STRETCH
from topomap.worlds.courses import FEWEST, MOST, Layout, across_of, clashes, exits_of
from topomap.worlds.environment import plain
from topomap.worlds.plan import Exit, Way
from topomap.worlds.rows import NO, YES, Row, number, rows_of

MOST_CLEAR, FINE = 16, MOST  # the most slots that bearings may fit; and the slots if they fit none
CLEAR = 1 / 8  # by how many slots a bearing may be off
OFF = 10.0  # degrees: by how much the exit of arrival may be off, if it is not given
UNMEASURED = 5  # degrees: by how much bearings are taken to be off if nothing is known
MISREAD = 20.0  # degrees: a larger difference is not an error of measurement
BENDS = (10.0, 60.0)  # degrees: the range of the limit for two exits to be on one path
SHOWN = 20  # the largest number of warnings
CENTI = 0.01  # the unit of lengths if some are fractions
LETTERS = [
    *("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE"),
    *("S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"),
]
FRAMES = ("arrival", "north")
FACING = ("back", "ahead")


@dataclass(frozen=True)
class Options:
    """How a log is to be read.

    ``slots`` and ``tolerance`` are those of the instance; None if they are to be chosen. ``frame``
    tells from where bearings count; None if the log tells it. ``facing`` tells where 0 is in the
    frame of the arrival, at the way back or ahead. ``straight_ways`` is the number of degrees by
    which ways may bend from one place to the next, if the exits of arrival are to be found by that.
    ``straight`` is the number of degrees by which two exits of a place on one path may be off from
    being opposite; None if it is to be chosen. ``unit`` is the length of the log that is one unit
    of the instance; None if it is to be chosen.
    """

    slots: int | None = None
    tolerance: int | None = None
    frame: str | None = None
    facing: str = "back"
    straight_ways: float | None = None
    straight: float | None = None
    unit: float | None = None

    def call(self) -> list[str]:
        """The options of the call of ``topomap log``."""
        usual = Options()
        return [
            word
            for name, value in vars(self).items()
            if value != getattr(usual, name)
            for word in (
                f"--{name.replace('_', '-')}",
                value if isinstance(value, str) else plain(value),
            )
        ]


@dataclass(frozen=True)
class Log:
    """A log that was read.

    It has the ``experience`` and its ``name``; the ``header`` of the instance file; what was
    ``chosen``, in one line, or None; and ``warnings``, of one line each. It was read with
    ``frame``, ``slots`` (of the experience), ``north`` (where slot 0 points, in degrees clockwise
    of north; None if bearings count from the arrival), ``tolerance``, ``straight`` (degrees; None
    if exits in opposite slots are on one path) and ``unit``.
    """

    name: str
    header: tuple[str, ...]
    experience: Experience
    frame: str
    north: float | None
    straight: float | None
    unit: float
    chosen: str | None
    warnings: tuple[str, ...]

    @property
    def slots(self) -> int:
        """The number of slots."""
        return self.experience.slots

    @property
    def tolerance(self) -> int:
        """By how many slots bearings may be wrong."""
        return self.experience.tolerance

    def document(self) -> dict[str, Any]:
        """The log as ``topomap log --json`` writes it, without the name of the file."""
        return {
            "name": self.name,
            "header": self.header,
            "steps": self.experience.steps,
            "slots": self.slots,
            "tolerance": self.tolerance,
            "frame": self.frame,
            "north": self.north,
            "straight": self.straight,
            "unit": self.unit,
            "chosen": self.chosen,
            "warnings": self.warnings,
            "facts": self.experience.facts(),
        }

    def text(self) -> str:
        """The text of the instance file."""
        header = (" ".join(line.split()) for line in self.header)
        return "".join(f"% {line}\n" for line in header) + "\n" + self.experience.facts()


class Visit(NamedTuple):
    """A row whose bearings are read.

    It has the exits, the exit that is taken and the exit of arrival; the latter are None if they
    are not known.
    """

    row: Row
    exits: tuple[float, ...]
    taken: int | None
    arrived: int | None


class Seen(NamedTuple):
    """The bearings of a visit, from 0 up to 360 degrees.

    They are those of all exits, of the exit where one stands, and of the exit that is taken. In the
    frame of the arrival the exit where one stands is at 0.
    """

    row: Row
    exits: tuple[float, ...]
    stood: float
    taken: float | None

    def ordered(self) -> list[float]:
        """How far clockwise each exit is from the one where one stands, sorted."""
        return sorted((bearing - self.stood) % 360 for bearing in self.exits)


class Again(NamedTuple):
    """A visit that is certainly to the place of an earlier one.

    ``at`` is its exit, counted clockwise from the exit where one stood first. ``off`` is the
    largest difference between two bearings of one exit, in degrees; None if the numbers of exits
    differ.
    """

    step: int
    first: int
    at: int
    off: float | None


class Choice(NamedTuple):
    """What bearings are put into.

    It has the slots, the tolerance, the limit for two exits to be on one path, in degrees (None:
    opposite slots are), and what was chosen, in words, or None.
    """

    at: Layout
    tolerance: int
    straight: float | None
    said: str | None


def load(file: str | Path, options: Options) -> Log:
    """Load the log in a file.

    Raises:
        InputError: The file cannot be read, or is not a log. One line with file, line, step and
            fault.
    """
    if options.slots is not None and (fault := slots_fault(options.slots)):
        raise InputError(f"{file}: {fault}")
    rows = rows_of(str(file), read_text(file))
    frame = options.frame or _frame(rows)
    visits = [_visit(row, frame) for row in rows]
    _demand_order(visits)
    seen = _seen(visits, frame, options)
    again = [*_certain(seen, frame)]
    choice = _choose(str(file), seen, again, frame, options)
    unit, unit_said = _unit(str(file), rows, options)
    experience = _experience(seen, frame, choice, unit)
    warnings = [
        f"{file}:{rows[one.step].line}: step {one.step}: it must be the place after step "
        f"{one.first}, as a known way leads there, but it looks different"
        for one in again
        if not experience.alike(one.first, sorted(experience.views[one.first])[one.at], one.step)
    ]
    more = len(warnings) - SHOWN
    warnings = warnings[:SHOWN] + [f"{file}: and {more} more such visits"] * (more > 0)
    said = "; ".join(one for one in (choice.said, unit_said) if one)
    name = "log" if str(file) == "-" else Path(file).stem
    header = [
        printable(name),
        f"log of an explorer: steps {experience.steps}, slots {experience.slots}, bearings from "
        + (
            f"north, slot 0 at {plain(round(choice.at.north, 3))} degrees"
            if frame == "north"
            else "the arrival"
        ),
    ]
    header += [f"chosen: {said}"] * bool(said)
    tolerance = experience.tolerance
    header += [f"to be read with: --tolerance {tolerance}"] * bool(tolerance)
    call = ["topomap", "log", Path(file).name, *options.call()]
    header.append("made by: " + printable(shlex.join(call)))
    return Log(
        name,
        tuple(header),
        experience,
        frame,
        choice.at.north if frame == "north" else None,
        choice.straight,
        unit,
        f"{file}: {said}" if said else None,
        tuple(warnings),
    )


def _frame(rows: Sequence[Row]) -> str:
    """Find out from where bearings count.

    Letters are of the compass, and numbers count from the arrival.

    Raises:
        InputError: There are both.
    """
    kinds: dict[bool, tuple[Row, str]] = {}
    for row in rows:
        for name in ("exits", "taken", "arrived"):
            for text in row.cells.get(name, ()):
                kinds.setdefault(text.upper() in LETTERS, (row, text))
        if len(kinds) == 2:
            row, text = [*kinds.values()][-1]
            raise row.fault(
                f"{quoted(text)}: compass letters and degrees are mixed; --frame north takes both, "
                "with degrees clockwise from north"
            )
    return "north" if True in kinds else "arrival"


def _bearing(row: Row, text: str, frame: str) -> float:
    """Read a bearing as degrees from 0 up to 360."""
    word = text.upper()
    if word in LETTERS:
        if frame != "north":
            raise row.fault(f"{quoted(text)}: a compass letter, but bearings are from the arrival")
        return LETTERS.index(word) * 360 / len(LETTERS)
    value = number(text.removesuffix("\u00b0"))
    if value is None:
        letters = ", ".join(LETTERS[:6])
        raise row.fault(
            f"{quoted(text)} is not a bearing: a number of degrees or a compass letter ({letters} "
            "...) is wanted"
        )
    if not -360 <= value <= 360:
        raise row.fault(f"{quoted(text)} is not a bearing: it is not from -360 to 360 degrees")
    return value % 360 % 360  # for a tiny negative number the first % gives 360


def _visit(row: Row, frame: str) -> Visit:
    """Read the bearings of a row."""
    exits = tuple(_bearing(row, text, frame) for text in row.cells.get("exits", ()))
    if not exits:
        raise row.fault("exits: there are none; the exit by which one arrived is one of them")
    if len(exits) > MOST:
        raise row.fault(f"exits: there are {len(exits)}, more than {MOST}")
    counted = row.number("step")
    if counted is not None and counted != row.step:
        raise row.fault(f"step: {plain(counted)} is given, but rows are numbered from 0")
    ends = sorted(exits)
    for one, other in zip(ends, [*ends[1:], ends[0] + 360], strict=True):
        if len(exits) > 1 and other - one < 1e-6:
            raise row.fault(f"exits: {_degrees(one)} occurs twice")
    told = []
    for name in ("taken", "arrived"):
        text = row.one(name)
        bearing = None if text is None else _bearing(row, text, frame)
        place = None if bearing is None else _nearest(exits, bearing, 1e-6)
        if bearing is not None and place is None:
            every = ", ".join(map(_degrees, ends[:SHOWN])) + ", ..." * (len(ends) > SHOWN)
            verb = "is taken" if name == "taken" else "is that of arrival"
            raise row.fault(f"exit {quoted(text or '')} {verb}, but the exits seen are {every}")
        told.append(place)
    return Visit(row, exits, *told)


def _degrees(bearing: float) -> str:
    return f"{bearing:.6g}"


def _apart(one: float, other: float) -> float:
    """By how many degrees two bearings differ."""
    off = (one - other) % 360
    return min(off, 360 - off)


def _nearest(exits: Sequence[float], bearing: float, most: float) -> int | None:
    """The exit nearest to a bearing, or None.

    It may be off by at most so many degrees, and no other exit may be as near.
    """
    off = sorted((_apart(one, bearing), number) for number, one in enumerate(exits))
    if off[0][0] > most or (len(off) > 1 and off[1][0] - off[0][0] < 1e-6):
        return None
    return off[0][1]


def _demand_order(visits: Sequence[Visit]) -> None:
    """Check that each visit is left, or looked at again, unless it is the last one of its log."""
    if visits[0].row.flag("look"):
        raise visits[0].row.fault("look: there is no earlier look")
    for here, after in pairwise(visits):
        rests = [name for name in ("start", "look") if after.row.flag(name)]
        if len(rests) > 1:
            raise after.row.fault("it begins a log, and is a second look")
        if rests and here.taken is not None:
            kind = "begins a new log" if rests == ["start"] else "is a second look"
            raise after.row.fault(f"it {kind}, but in the row before an exit is taken")
        if not rests and here.taken is None:
            raise here.row.fault("no exit is taken, but there are later rows")
    if visits[-1].taken is not None:
        raise visits[-1].row.fault("an exit is taken, but no later row says what is seen then")
    for visit in visits:
        for name in ("length", "east", "north"):
            if visit.taken is None and visit.row.cells.get(name):
                raise visit.row.fault(f"{name}: no exit is taken here, so there is no such way")


def _seen(visits: Sequence[Visit], frame: str, options: Options) -> list[Seen]:
    """The bearings of all visits, and the exit where one stands at each."""
    made: list[Seen] = []
    stood = 0.0
    for step, visit in enumerate(visits):
        if visit.row.flag("look"):
            at = _nearest(visit.exits, stood, OFF)
            if at is None:
                raise visit.row.fault(
                    f"look: no exit, or more than one, is within {OFF:g} degrees of "
                    f"{_degrees(stood)}, the exit stood at"
                )
        elif visit.arrived is not None:
            at = visit.arrived
        elif step == 0 or visit.row.flag("start"):
            at = _first_stood(visits, step)
        elif frame == "arrival":
            zero = 180.0 if options.facing == "ahead" else 0.0
            at = _nearest(visit.exits, zero, OFF)
            if at is None:
                raise visit.row.fault(
                    f"no exit, or more than one, is within {OFF:g} degrees of {zero:g}, the way "
                    "back; the way back belongs to the exits (the column arrived can name it)"
                )
        else:
            at = _by_straight_way(visits[step - 1], visit, options.straight_ways)
        stood = visit.exits[at]
        zero = stood if frame == "arrival" else 0.0
        turned = tuple((bearing - zero) % 360 % 360 for bearing in visit.exits)
        taken = None if visit.taken is None else turned[visit.taken]
        made.append(Seen(visit.row, turned, turned[at], taken))
    return made


def _first_stood(visits: Sequence[Visit], step: int) -> int:
    """The exit where one stands when a log begins.

    It is the one by which the place is left, perhaps after more looks; if the place is not left, it
    is the first exit.
    """
    last = step
    while last + 1 < len(visits) and visits[last + 1].row.flag("look"):
        last += 1
    taken = visits[last].taken
    if taken is None:
        return 0
    at = _nearest(visits[step].exits, visits[last].exits[taken], OFF)
    return 0 if at is None else at


def _by_straight_way(before: Visit, here: Visit, most: float | None) -> int:
    """The exit by which one arrived, if ways are nearly straight."""
    if most is None:
        raise here.row.fault(
            "the exit by which one arrived is not known; name it in the column arrived, "
            "or say by --straight-ways DEGREES how much ways bend at most"
        )
    assert before.taken is not None
    back = (before.exits[before.taken] + 180) % 360
    at = _nearest(here.exits, back, most)
    if at is None:
        raise here.row.fault(
            f"within {most:g} degrees of {_degrees(back)}, the way straight back, there is no "
            "exit, or two are equally near; name the exit of arrival in the column arrived"
        )
    return at


def _certain(seen: Sequence[Seen], frame: str) -> Iterator[Again]:
    """The visits that are certainly to places visited before, because known ways lead there.

    An example is the way back. No loop is closed for this. A second look is such a visit, too.
    """
    links: dict[tuple[int, int], tuple[int, int]] = {}
    place, at = 0, 0  # the first visit of the place, and the exit where one stands
    for step, (before, here) in enumerate(pairwise(seen), 1):
        if here.row.flag("start"):
            place, at = step, 0
            continue
        out = None
        if before.taken is not None:
            star = seen[place].ordered()
            if len(star) != len(before.exits):
                place, at, star = step - 1, 0, before.ordered()
            leaves = before.ordered().index((before.taken - before.stood) % 360)
            out = place, (at + leaves) % len(star)
            if out not in links:
                links[out], links[step, 0] = (step, 0), out
                place, at = step, 0
                continue
            place, at = links[out]
        first = seen[place]
        yield Again(step, place, at, _differ(first, at, here, frame))


def _differ(first: Seen, at: int, here: Seen, frame: str) -> float | None:
    """By how many degrees two views of one place differ at most.

    They are seen from exit ``at`` of the first one. It is None if the numbers of exits differ.
    """
    star, view = first.ordered(), here.ordered()
    if len(star) != len(view):
        return None
    turned = [(star[(at + more) % len(star)] - star[at]) % 360 for more in range(len(star))]
    off = [_apart(one, other) for one, other in zip(turned, view, strict=True)]
    if frame == "north":
        off.append(_apart(first.stood + star[at], here.stood))
    return max(off)


def _choose(
    file: str, seen: Sequence[Seen], again: Sequence[Again], frame: str, options: Options
) -> Choice:
    """Choose the slots for the bearings.

    Raises:
        InputError: Two exits of a visit share a slot.
    """
    ways, exits = _ways(seen)
    bearings = sorted({bearing for visit in seen for bearing in visit.exits})
    told = options.tolerance
    tries = [*range(FEWEST, MOST_CLEAR + 1, 2)] if options.slots is None else [options.slots]
    if told and not options.slots:  # with the given slots, the tolerance is reported in degrees
        tries = []
    for slots in tries:
        at, off = _fit(bearings, slots, frame)
        if off < CLEAR * 360 / slots and not clashes(ways, exits, at):
            how = f"all bearings are within {_rounded_up(off)} degrees of those of slots"
            said = []
            if options.slots is None:
                said = [f"{slots} slots and tolerance {told or 0}: {how}"]
            elif told is None:
                said = [f"tolerance 0: {how}"]
            return Choice(at, told or 0, options.straight, _said(said, options))
    slots = options.slots or FINE
    at, off = _fit(bearings, slots, frame) if options.slots else (Layout(FINE, 0.0, 0.0), 1.0)
    for clash in clashes(ways, exits, at):
        assert isinstance(clash.place, tuple)
        one, other = (_degrees(bearing) for _, bearing in (clash.one, clash.other))
        where = "" if frame == "north" else " from the arrival"
        raise seen[clash.place[0]].row.fault(
            f"the exits at {one} and {other} degrees{where} share a slot, of {slots}"
        )
    said = []
    if options.slots is None:
        most = f"no number up to {MOST_CLEAR} fits the bearings"
        said.append(f"{slots} slots: {f'one a degree, for --tolerance {told}' if told else most}")
    measured = [one.off for one in again if one.off is not None and one.off <= MISREAD]
    tolerance = told
    if tolerance is None:
        width = 360 / slots
        whole = all(abs(one / width - round(one / width)) < 1e-6 for one in bearings)
        off = 2 * max(measured) if measured else UNMEASURED
        # To compare two views, three bearings are rounded, each by half a slot at most.
        tolerance = math.ceil(off / width - 1e-6) if whole else math.floor(off / width + 1.5)
        why = (
            f"twice the {_rounded_up(max(measured))} degrees by which bearings of one exit differ"
            if measured
            else f"a guess of {UNMEASURED} degrees, as no exit is surely seen twice"
        )
        said.append(f"tolerance {tolerance}: {why}" + ", and rounding" * (not whole))
    straight = options.straight
    if straight is None:
        straight = _limit(seen, ways)
        said.append(f"exits on one path if they bend by {_degrees(straight)} degrees at most")
    return Choice(at, tolerance, straight, _said(said, options))


def _said(said: Sequence[str], options: Options) -> str | None:
    """Say what was chosen, and how to choose something else."""
    if not said:
        return None
    names = [name for name in ("slots", "tolerance") if getattr(options, name) is None]
    names += ["straight"] * any("one path" in one for one in said)
    *most, last = (f"--{name}" for name in names)
    choose = f"{', '.join(most)} and {last}" if most else last
    return f"{'; '.join(said)} ({choose} choose{'s' * (len(names) == 1)} otherwise)"


def _rounded_up(degrees: float) -> str:
    return f"{math.ceil(degrees * 10 - 1e-6) / 10:g}"


def _ways(
    seen: Sequence[Seen],
) -> tuple[tuple[Way, ...], dict[object, list[tuple[float, int, int]]]]:
    """Each visit as a place of its own, whose ways lead nowhere else, for ``courses``."""
    ways = tuple(
        Way((Exit((step,), bearing), Exit((step, number), 0.0)))
        for step, visit in enumerate(seen)
        for number, bearing in enumerate(visit.exits)
    )
    return ways, dict(exits_of(ways))


def _fit(bearings: Sequence[float], slots: int, frame: str) -> tuple[Layout, float]:
    """So many slots, turned so that bearings are off as little as possible.

    Slots are not turned if bearings count from the arrival.

    Returns:
        The slots, and by how many degrees bearings are off at most.
    """
    width = 360 / slots
    rests = sorted({bearing % width for bearing in bearings})
    if frame == "arrival":
        off = max(min(rest, width - rest) for rest in rests)
        return Layout(slots, 0.0, width / 2 - off), off
    gaps = [*pairwise(rests), (rests[-1], rests[0] + width)]
    begin, end = max(gaps, key=lambda gap: gap[1] - gap[0])
    off = (width - (end - begin)) / 2
    turn = round((end + off) % width, 6)
    turn -= width if turn > width / 2 else 0
    return Layout(slots, turn, width / 2 - off), off


def _limit(seen: Sequence[Seen], ways: tuple[Way, ...]) -> float:
    """The middle of the widest gap between the bends of exits that are most nearly opposite.

    It lies within BENDS. So the fewest pairs are near the limit.
    """
    bends = {*BENDS}
    fine = Layout(10**6, 0.0, 0.0)  # with so many slots, slots are as good as bearings
    for out, other in across_of(ways, fine, BENDS[1]).items():
        bend = abs((out[1] - other[1]) * 360 / fine.slots % 360 - 180)
        if BENDS[0] < bend < BENDS[1]:
            bends.add(round(bend, 3))
    begin, end = max(pairwise(sorted(bends)), key=lambda gap: gap[1] - gap[0])
    return round((begin + end) / 2, 3)


def _unit(file: str, rows: Sequence[Row], options: Options) -> tuple[float, str | None]:
    """Find which length of the log is one unit of the instance, and say so if it was chosen."""
    if options.unit is not None:
        return options.unit, None
    values = (row.number(name) for row in rows for name in ("length", "east", "north"))
    if all(value is None or value == int(value) for value in values):
        return 1.0, None
    return CENTI, f"lengths in units of {CENTI:g}, as some are fractions (--unit chooses otherwise)"


def _experience(seen: Sequence[Seen], frame: str, choice: Choice, unit: float) -> Experience:
    """Make the experience.

    Raises:
        InputError: Something cannot be expressed, or is impossible.
    """
    at = choice.at
    pairs: list[list[tuple[int, int]]] = [[] for _ in seen]
    stood = [at.slot(visit.stood) for visit in seen]
    if choice.straight is not None:
        for out, other in across_of(_ways(seen)[0], at, choice.straight).items():
            if isinstance(out[0], tuple) and out < other:
                (step,) = out[0]
                one, two = ((end[1] - stood[step]) % at.slots for end in (out, other))
                pairs[step].append((one, two))
    rows = [visit.row for visit in seen]
    rests = {name: [row.step for row in rows if row.flag(name)] for name in ("start", "look")}
    turns = [
        None if visit.taken is None else (at.slot(visit.taken) - here) % at.slots
        for visit, here in zip(seen[:-1], stood, strict=False)
    ]
    lengths = [_length(row, unit) for row in rows[:-1]]
    shifts = [_shift(row, unit) for row in rows[:-1]]
    if fault := range_fault(shifts, lengths, DRIFT, STRETCH):
        assert fault.step is not None
        raise rows[fault.step - 1].fault(fault.said)
    marks: dict[str, list[int]] = {name: [] for name in MARKER}
    things: list[Thing] = []
    for row in rows:
        for name in MARKER:
            for text in row.cells.get(name, ()):
                if text.lower() in YES:
                    marks[name].append(row.step)
                elif text.lower() not in NO:
                    things.append((name, row.step, _term(row, name, text)))
    experience = Experience(
        at.slots,
        [
            [(at.slot(bearing) - here) % at.slots for bearing in visit.exits]
            for visit, here in zip(seen, stood, strict=True)
        ],
        turns,
        [
            [_term(row, "landmarks", text) for text in row.cells.get("landmarks", ())]
            for row in rows
        ],
        *marks.values(),
        things=things,
        compass=stood if frame == "north" else (),
        shifts=shifts,
        lengths=lengths,
        starts=[step for step in rests["start"] if step],
        looks=rests["look"],
        straight=pairs if choice.straight is not None else (),
        tolerance=choice.tolerance,
    )
    for fault in Facts().faults(experience.facts()):
        raise rows[fault.step or 0].fault(fault.said)
    return experience


def _length(row: Row, unit: float) -> int | None:
    """The length of the way that is taken, in units."""
    value = row.number("length")
    if value is None:
        return None
    whole = round(value / unit)
    if whole <= 0:
        least = "" if value <= 0 else f" when it is rounded to units of {unit:g} (--unit)"
        raise row.fault(f"length: {value:g} is not above 0{least}")
    return whole


def _shift(row: Row, unit: float) -> tuple[int, int] | None:
    """How far the way that is taken leads, in units."""
    east, north = row.number("east"), row.number("north")
    if east is None and north is None:
        return None
    if east is None or north is None:
        missing = "north" if north is None else "east"
        raise row.fault(f"{missing}: it is empty, but the other one of east and north is given")
    return round(east / unit), round(north / unit)


def _term(row: Row, name: str, text: str) -> str:
    """Write a landmark, or the name of a marker, as a term of clingo.

    If it is a term already, it stays as it is; otherwise it becomes a text in quotes.
    """
    try:
        return spelt(text)
    except ValueError:
        pass
    made = str(clingo.String(text)) if _is_plain(text) else ""
    try:
        return spelt(made)
    except ValueError:
        raise row.fault(f"{name}: {quoted(text)} cannot be written as a term") from None


def _is_plain(text: str) -> bool:
    """Tell whether a text can be written to a file, and has only printable characters and lines."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return all(letter.isprintable() or letter in "\n\t" for letter in text)
