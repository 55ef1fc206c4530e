"""Cave surveys of Survex (.svx): stations, and legs between them by tape, compass and clino.

A place is a junction of legs (three or more) or a dead end (one). A chain of legs between two of
them is a way. ``surveys`` reads the files; here the legs become a plan. The move of a way is the
sum of its legs seen from above, and its length is the sum of their tapes.
"""

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from topomap.runtime.errors import InputError, printable
from topomap.runtime.limits import LARGEST, MOST_PLACES
from topomap.worlds.courses import exit_towards, point_along, shares
from topomap.worlds.plan import Exit, Plan, Point, Reading, Way
from topomap.worlds.surveys import Leg, Survey, survey_of

STEEP = 80.0  # degrees: a steeper leg at the end of a way does not give its direction
NEAR = 1e-6  # metres: two points that are so near are one
SHOWN = 10  # the largest number of stations in a message


def fits(name: str, content: bytes) -> bool:
    """Tell whether a file is a survey, by its name or by a command of Survex at its start."""
    if name.lower().endswith(".svx"):
        return True
    start = content[:4000].removeprefix(b"\xef\xbb\xbf")
    told = re.sub(rb"(?m)^\s*;.*$", b"", start).lstrip()
    commands = rb"\*(begin|data|fix|equate|include|title|units|calibrate|cs|case|require|flags)\b"
    return bool(re.match(commands, told, re.IGNORECASE))


def read(file: str, content: bytes, reading: Reading) -> Plan:
    """Read the plan in a survey.

    Raises:
        InputError: The file has a fault.
    """
    survey = survey_of(file, content)
    net = _Net(file, survey)
    ways, upright, loops, rings = [], [], 0, 0
    chains = [*net.chains()]
    share = shares(chain.ends for chain in chains)
    for chain in chains:
        dead = [end for end in chain.ends if len(net.at[end]) == 1]
        if dead and chain.upright:
            upright.append(net.names[dead[-1]])
            continue
        if chain.ends[0] == chain.ends[1] and not reading.loops:
            loops += 1
            rings += len(net.at[chain.ends[0]]) == 2
            continue
        ways.append(_way(file, chain, net.names, reading.along, share(*chain.ends)))
    used = {end.place for way in ways for end in way.ends}
    if len(used) > MOST_PLACES:
        raise InputError(f"{file}: more than {MOST_PLACES} junctions and dead ends")
    if loops and not ways:
        raise InputError(
            f"{file}: no ways in it but {loops} that lead back to their own place "
            "(--loops keeps them)"
        )
    left = [
        ("loops left out (--loops keeps them)", loops - rings),
        ("loops without a junction left out (--loops keeps them)", rings),
    ]
    told = [*survey.told(), *net.told]
    told += [f"{file}: {what}: {number}" for what, number in left if number]
    if upright:
        what = "ways straight up or down to a dead end left out, as they have no direction"
        told.append(f"{file}: {what}: {_listed(upright)}")
    points = {
        net.names[station]: point
        for station, point in net.points().items()
        if net.names[station] in used
    }
    ways.sort(key=lambda way: way.ends)
    notes = ("bearings: magnetic north" if survey.magnetic else "bearings: north of the survey",)
    return Plan(Path(file).stem, tuple(ways), points, notes=notes, told=tuple(told))


@dataclass
class _Chain:
    """The legs from one place to the next.

    It has its two ends, the legs in order, and whether each one is gone from its ``to`` to its
    ``of``.
    """

    ends: tuple[int, int]
    legs: list[tuple[Leg, bool]] = field(default_factory=list)

    @property
    def upright(self) -> bool:
        """Whether all its legs are steep."""
        return all(abs(leg.slope) > STEEP for leg, _ in self.legs)


class _Net:
    """Stations, of which equal ones are merged, and the legs between them.

    ``names`` has the first name of each station. ``at`` has the legs at a station.
    """

    def __init__(self, file: str, survey: Survey) -> None:
        self.told: list[str] = []
        self.survey = survey
        self.names: dict[int, str] = {}
        for name, number in survey.stations.items():
            self.names.setdefault(survey.top(number), name)
        self.at: dict[int, list[Leg]] = defaultdict(list)
        legs: list[Leg] = []
        pairs: set[tuple[int, int]] = set()
        again = same = 0
        for leg in survey.legs:
            one, other = survey.top(leg.of), survey.top(leg.to)
            leg = leg._replace(of=one, to=other)
            pair = min(one, other), max(one, other)
            if one == other:
                same += 1
            elif pair in pairs and not leg.duplicate:
                again += 1
            else:
                pairs |= set() if leg.duplicate else {pair}
                legs.append(leg)
        kept, gone = _without_duplicates(legs)
        for leg in kept:
            self.at[leg.of].append(leg)
            self.at[leg.to].append(leg)
        lone = [name for name in survey.fixed if survey.top(survey.stations[name]) not in self.at]
        equated = [
            name
            for name, number in survey.stations.items()
            if survey.top(number) not in self.at and name not in survey.fixed
        ]
        for what, number in (
            ("legs from a station to itself left out", same),
            ("legs measured again, between two stations that have one, left out", again),
            ("legs flagged duplicate left out, as other legs join what they join", gone),
        ):
            if number:
                self.told.append(f"{file}: {what}: {number}")
        for what, names in (
            ("fixed stations without a leg left out", lone),
            ("stations without a leg left out", equated),
        ):
            if names:
                self.told.append(f"{file}: {what}: {_listed(names)}")

    def chains(self) -> Iterable[_Chain]:
        """The chains of legs between junctions and dead ends.

        In a loop without any of these, the station that came first is the place.
        """
        done: set[int] = set()  # the legs that are in a chain, by number
        order = sorted(self.at)
        for first in (*(station for station in order if len(self.at[station]) != 2), *order):
            alone = len(self.at[first]) == 2
            for leg in self.at[first]:
                if leg.number in done:
                    continue
                chain, here = _Chain((first, first)), first
                while True:
                    done.add(leg.number)
                    back = leg.of != here
                    chain.legs.append((leg, back))
                    here = leg.of if back else leg.to
                    if len(self.at[here]) != 2 or (alone and here == first):
                        break
                    one, other = self.at[here]
                    leg = other if one.number == leg.number else one
                chain.ends = first, here
                yield chain

    def points(self) -> dict[int, Point]:
        """The positions of stations, along the legs from those that are fixed, without adjustment.

        In a component where none is fixed, the station that came first is, as in Survex.
        """
        where: dict[int, Point] = {}
        for name, point in self.survey.fixed.items():
            station = self.survey.top(self.survey.stations[name])
            if point is not None and station in self.at:
                where.setdefault(station, point)
        self._spread(where, [*where])
        for station in sorted(self.at):
            if station not in where:
                where[station] = (0.0, 0.0)
                self._spread(where, [station])
        return where

    def _spread(self, where: dict[int, Point], waiting: list[int]) -> None:
        """Find the positions of the stations that legs join to these."""
        while waiting:
            later = []
            for here in waiting:
                for leg in self.at[here]:
                    sign, there = (1, leg.to) if leg.of == here else (-1, leg.of)
                    if there not in where:
                        east, north = where[here]
                        where[there] = east + sign * leg.east, north + sign * leg.north
                        later.append(there)
            waiting = later


def _without_duplicates(legs: list[Leg]) -> tuple[list[Leg], int]:
    """Leave out legs that are flagged as duplicates, which measure a passage a second time.

    Those without which stations would not be connected are kept.

    Returns:
        The legs, and how many were left out.
    """
    group: dict[int, int] = {}

    def top(station: int) -> int:
        """The station that stands for all those connected with this one."""
        group.setdefault(station, station)
        while group[station] != station:
            group[station] = group[group[station]]
            station = group[station]
        return station

    kept = []
    for leg in sorted(legs, key=lambda leg: (leg.duplicate, leg.number)):
        if leg.duplicate and top(leg.of) == top(leg.to):
            continue
        group[top(leg.of)] = top(leg.to)
        kept.append(leg)
    at: dict[int, set[int]] = defaultdict(set)
    by_number = {leg.number: leg for leg in kept}
    for leg in kept:
        at[leg.of].add(leg.number)
        at[leg.to].add(leg.number)
    # The rest of a chain of duplicates, after one of its legs was left out, is not a dead end.
    gone = [leg for leg in legs if leg.number not in by_number]
    cut = {end for leg in gone for end in (leg.of, leg.to)}
    waiting = [station for station in cut if len(at[station]) == 1]
    while waiting:
        station = waiting.pop()
        if len(at[station]) != 1 or not by_number[next(iter(at[station]))].duplicate:
            continue
        leg = by_number.pop(at[station].pop())
        there = leg.to if leg.of == station else leg.of
        at[there].discard(leg.number)
        waiting.append(there)
    return sorted(by_number.values(), key=lambda leg: leg.number), len(legs) - len(by_number)


def _way(file: str, chain: _Chain, names: Mapping[int, str], along: float, share: float) -> Way:
    """The way of a chain of legs."""
    steps = [(-leg.east, -leg.north) if back else (leg.east, leg.north) for leg, back in chain.legs]
    course = [(0.0, 0.0)]
    for east, north in steps:
        course.append((course[-1][0] + east, course[-1][1] + north))
    steep = [abs(leg.slope) > STEEP for leg, _ in chain.legs]
    ends = []
    for station, line, is_steep in (
        (chain.ends[0], course, steep),
        (chain.ends[1], course[::-1], steep[::-1]),
    ):
        ends.append(_exit(file, chain, names, station, line, is_steep, along, share))
    length = sum(leg.length for leg, _ in chain.legs)
    if not all(abs(number) <= LARGEST for number in (*course[-1], length)):
        raise InputError(f"{file}: {_between(chain, names)} is longer than {LARGEST} metres")
    return Way((ends[0], ends[1]), course[-1], length)


def _exit(
    file: str,
    chain: _Chain,
    names: Mapping[int, str],
    station: int,
    line: list[Point],
    steep: list[bool],
    along: float,
    share: float,
) -> Exit:
    """The exit by which a way leaves a station.

    Its direction is that of the point so far along it, seen from above, from its first leg that is
    not steep.
    """
    if all(steep):
        raise InputError(
            f"{file}: {_between(chain, names)} has only legs steeper than {STEEP:g} degrees, so it "
            f"has no direction at {printable(names[station])}; *equate makes its ends one place"
        )
    line = line[steep.index(False) :]
    if chain.ends[0] == chain.ends[1] and len(line) > 2:
        long = sum(math.dist(*pair) for pair in pairwise(line))
        along = min(along, long / 3)
    there = point_along(line, along, share)
    if math.dist(there, line[0]) < NEAR:
        raise InputError(
            f"{file}: {_between(chain, names)} is at {printable(names[station])} again "
            f"{along:g} metres along, so it has no direction there"
        )
    return exit_towards(names[station], line[0], there)


def _between(chain: _Chain, names: Mapping[int, str]) -> str:
    one, other = (printable(names[end]) for end in chain.ends)
    return f"the way from {one} to {other}"


def _listed(names: list[str]) -> str:
    """The number of stations, and the first of their names."""
    shown = ", ".join(map(printable, names[:SHOWN]))
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{len(names)} ({shown}{more})"
