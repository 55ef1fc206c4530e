"""The language of Survex: what its files say of stations and of the legs between them.

Files are read line by line. A command begins with an asterisk, and any other line is a leg, in the
order of readings that ``*data`` gives. A command that is not known, or a style of data that is not
read, is refused with its file and line. What is known but left out is counted.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from topomap.runtime.errors import InputError, of_file, printable
from topomap.runtime.files import MOST_BYTES
from topomap.runtime.limits import LARGEST
from topomap.worlds.plan import Point

# Depths may differ by more than the length of the tape, because tapes sag, but only by this share.
TOO_DEEP = 0.1
MOST_FILES = 1000  # the largest number of files of one survey
DEEPEST = 50  # the deepest nesting of files, and of blocks
LONGEST = 400  # the largest number of characters of a station's name, with those of its blocks

METRES = {"yards": 0.9144, "feet": 0.3048, "metric": 1.0, "metres": 1.0, "meters": 1.0}
DEGREES = {"degs": 1.0, "degrees": 1.0, "grads": 0.9, "mils": 0.9, "minutes": 1 / 60}
QUADRANTS = {"quads", "quadrants"}
PERCENT = {"percent", "percentage"}
QUANTITIES = {
    **dict.fromkeys(("tape", "length"), "tape"),
    **dict.fromkeys(("backtape", "backlength"), "backtape"),
    **dict.fromkeys(("compass", "bearing"), "compass"),
    **dict.fromkeys(("backcompass", "backbearing"), "backcompass"),
    **dict.fromkeys(("clino", "gradient"), "clino"),
    **dict.fromkeys(("backclino", "backgradient"), "backclino"),
    **dict.fromkeys(("count", "counter"), "count"),
    **dict.fromkeys(("dx", "easting"), "dx"),
    **dict.fromkeys(("dy", "northing"), "dy"),
    **dict.fromkeys(("dz", "altitude"), "dz"),
    **dict.fromkeys(("up", "ceiling"), "up"),
    **dict.fromkeys(("down", "floor"), "down"),
    **{name: name for name in ("depth", "declination", "left", "right")},
}
ANGLES = {"compass", "backcompass", "clino", "backclino", "declination"}
SLOPES = {"clino", "backclino"}
READINGS = {  # the readings of the styles of data that are read
    "normal": {"tape", "compass", "clino", "backtape", "backcompass", "backclino"},
    "cartesian": {"dx", "dy", "dz"},
    # With these two styles the tape is along the line, or level, and depths are measured.
    "diving": {"tape", "compass", "backtape", "backcompass", "fromdepth", "todepth", "depthchange"},
    "cylpolar": {
        *("tape", "compass", "backtape", "backcompass", "fromdepth", "todepth", "depthchange"),
    },
}
STYLES = {"topofil": "normal"}  # older names of styles
NO_LEGS = {"passage", "ignore", "nosurvey"}  # styles whose lines are not legs, or give no direction
USUAL = ("from", "to", "tape", "compass", "clino")
# Commands that do not matter for which stations are joined, and in which direction.
IGNORED = {
    *("copyright", "date", "entrance", "export", "instrument", "ref", "require", "sd", "solve"),
    *("team", "title"),
}
CHARACTERS = {
    "blank": "\t ,",
    "comment": ";",
    "decimal": ".",
    "keyword": "*",
    "minus": "-",
    "names": "_-",
    "omit": "-",
    "plus": "+",
    "root": "\\",
    "separator": ".",
}
FLAGS = {"duplicate", "splay", "surface"}


class Leg(NamedTuple):
    """A leg between two stations.

    It has how far it leads east and north, in metres; its slope in degrees; its length by the tape;
    and whether it measures a passage a second time.
    """

    number: int
    of: int
    to: int
    east: float
    north: float
    slope: float
    length: float
    duplicate: bool


@dataclass
class Survey:
    """What a survey says.

    ``stations`` has the number of each name, ``equal`` tells which stations are the same one, and
    ``fixed`` has those that ``*fix`` names, with their positions. ``left`` counts what was left
    out, and ``magnetic`` tells whether a declination would have to be computed.
    """

    stations: dict[str, int] = field(default_factory=dict)
    equal: list[int] = field(default_factory=list)
    legs: list[Leg] = field(default_factory=list)
    fixed: dict[str, Point | None] = field(default_factory=dict)
    systems: set[str] = field(default_factory=set)
    left: Counter[str] = field(default_factory=Counter)
    magnetic: bool = False
    file: str = ""

    def station(self, name: str) -> int:
        """The number of the station with a name."""
        if name not in self.stations:
            self.stations[name] = self.new()
        return self.stations[name]

    def new(self) -> int:
        """Make the number of a new station."""
        self.equal.append(len(self.equal))
        return len(self.equal) - 1

    def top(self, station: int) -> int:
        """The number that stands for all stations which are equal to this one."""
        while self.equal[station] != station:
            self.equal[station] = self.equal[self.equal[station]]
            station = self.equal[station]
        return station

    def join(self, one: int, other: int) -> None:
        """Make two stations equal; the one that came first gives the number."""
        tops = self.top(one), self.top(other)
        self.equal[max(tops)] = min(tops)

    def told(self) -> list[str]:
        """What was left out, with a line for each kind."""
        return [f"{self.file}: {what}: {number}" for what, number in self.left.items()]


@dataclass(frozen=True)
class _Settings:
    """The settings that ``*begin`` keeps and ``*end`` restores."""

    style: str = "normal"
    order: tuple[str, ...] = USUAL
    units: Mapping[str, float] = field(default_factory=dict)
    quadrants: frozenset[str] = frozenset()  # the quantities that are given as quadrants
    percent: frozenset[str] = frozenset()
    corrected: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    declination: float = 0.0
    flags: frozenset[str] = frozenset()
    case: str = "tolower"
    truncate: int | None = None
    splay: bool = False  # whether the station "-" is the end of a splay
    plumbs: bool = False
    equates: bool = False
    system: str = ""
    prefix: tuple[str, ...] = ()
    characters: Mapping[str, str] = field(default_factory=lambda: CHARACTERS)


class _Word(NamedTuple):
    text: str
    quoted: bool


def survey_of(file: str, content: bytes) -> Survey:
    """Read what a file, and those that it includes, say.

    Raises:
        InputError: A file has a fault.
    """
    survey = Survey(file=file)
    reader = _Reader(survey)
    reader.read(file, content)
    if len(survey.systems) > 1 or any(
        re.match(r"long-?lat|lat-?long|epsg:(4326|4258)\b", system) for system in survey.systems
    ):
        survey.fixed = dict.fromkeys(survey.fixed)
        survey.left["fixed stations whose coordinates are not used (not all in one plane)"] = len(
            survey.fixed
        )
    return survey


class _Reader:
    """A reader of files into a survey; ``where`` is the current file and line."""

    def __init__(self, survey: Survey) -> None:
        self.survey = survey
        self.now = _Settings()
        self.opened: list[Path] = []
        self.files = self.bytes = 0
        self.where = self.file = ""
        self.folder: Path | None = None
        self.pattern: tuple[str, re.Pattern[str]] | None = None
        self.handlers: dict[str, Callable[[list[_Word]], None]] = {
            "alias": self._alias,
            "calibrate": self._calibrate,
            "cartesian": self._cartesian,
            "case": self._case,
            "cs": self._cs,
            "data": self._data,
            "declination": self._declination,
            "default": self._default,
            "equate": self._equate,
            "fix": self._fix,
            "flags": self._flags,
            "include": self._include,
            "infer": self._infer,
            "set": self._set,
            "truncate": self._truncate,
            "units": self._units,
        }

    def fault(self, said: str) -> InputError:
        """The error about what is wrong at this line."""
        return InputError(f"{self.where}: {said}")

    # Files.

    def read(self, file: str, content: bytes) -> None:
        """Read a file, whose blocks must end in it."""
        self.files += 1
        self.bytes += len(content)
        if self.bytes > MOST_BYTES:
            raise InputError(f"{file}: with what it includes, larger than {MOST_BYTES >> 20} MiB")
        if b"\0" in content:
            raise InputError(f"{file}: not a text file")
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")
            self.survey.left["files that are not UTF-8, read as Latin-1"] += 1
        self.opened.append(Path(file).resolve())
        before = self.file, self.where
        blocks: list[tuple[tuple[str, ...], _Settings, int]] = []
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
            self.file, self.where = file, f"{file}:{number}"
            words = self._words(line)
            if not words:
                continue
            first = words[0].text
            if words[0].quoted or first[0] not in self.now.characters["keyword"]:
                self._line(words, number)
                continue
            rest = [_Word(first[1:], False)] * (len(first) > 1) + words[1:]
            if not rest:
                raise self.fault("a command must follow the asterisk")
            name, words = rest[0].text.lower(), rest[1:]
            if name == "begin":
                if len(blocks) == DEEPEST:
                    raise self.fault(f"more than {DEEPEST} nested blocks")
                names = self._parts(words[0]) if words else ()
                self._only(words, 1)
                blocks.append((names, self.now, number))
                self.now = replace(self.now, prefix=(*self.now.prefix, *names))
            elif name == "end":
                if not blocks:
                    raise self.fault("*end, but no block has begun in this file")
                names, kept, line_of = blocks.pop()
                self.now = kept
                self._only(words, 1)
                if (self._parts(words[0]) if words else ()) != names:
                    said = f"*end of another block than that of line {line_of}"
                    raise self.fault(f"{said}, *begin {printable('.'.join(names))}".rstrip())
            elif name in self.handlers:
                self.handlers[name](words)
            elif name not in IGNORED:
                raise self.fault(f"the command *{printable(name)[:40]} is not read")
        if blocks:
            name = printable(".".join(blocks[-1][0]))
            raise InputError(f"{file}:{blocks[-1][2]}: *begin {name}".rstrip() + " has no *end")
        self.file, self.where = before
        self.opened.pop()

    def _include(self, words: list[_Word]) -> None:
        """Read another file, in the folder of the first one or below it."""
        if len(words) != 1:
            raise self.fault("*include names one file, in quotes if there are blanks in its name")
        asked = words[0].text
        said = f"*include {printable(asked)[:200]}"
        if self.opened[0] == Path("/dev/stdin") or self.file == "-":
            raise self.fault(f"{said}: the survey must be given by the name of its file")
        folder = self.opened[0].parent
        name = asked.replace("\\", "/")
        tried = [name, f"{name}.svx", name.lower(), f"{name.lower()}.svx"]
        for form in tried:
            shown = Path(self.file).parent / form
            try:
                path = shown.resolve()
                if not path.is_relative_to(folder):
                    raise self.fault(f"{said}: outside of the folder of the survey")
                if not path.is_file():
                    continue
                if path in self.opened:
                    raise self.fault(f"{said}: this file is being read, so it includes itself")
                if self.files == MOST_FILES or len(self.opened) == DEEPEST:
                    most = f"{MOST_FILES} files, or {DEEPEST} nested in each other"
                    raise self.fault(f"{said}: more than {most}")
                if path.suffix.lower() in (".dat", ".mak", ".clp", ".srv", ".wpj", ".plt"):
                    raise self.fault(f"{said}: only files of Survex are read")
                with path.open("rb") as opened:
                    content = opened.read(MOST_BYTES - self.bytes + 1)
            except OSError as error:
                raise self.fault(str(of_file(said, error))) from None
            except (ValueError, RuntimeError):
                raise self.fault(f"{said}: not the name of a file") from None
            prefix = self.now.prefix
            self.read(str(shown), content)
            self.now = replace(self.now, prefix=prefix)
            return
        raise self.fault(f"{said}: there is no such file")

    # Words and names.

    def _words(self, line: str) -> list[_Word]:
        """Split a line into words, without its comment."""
        key = self.now.characters["blank"] + "\0" + self.now.characters["comment"]
        if self.pattern is None or self.pattern[0] != key:
            blank, comment = (re.escape(part) for part in key.split("\0"))
            ends = f"[^{blank}{comment}]" if blank or comment else "."
            form = rf'(?P<quoted>"[^"]*("|$))|(?P<word>{ends}+)'
            self.pattern = (
                key,
                re.compile((rf"(?P<comment>[{comment}])|" if comment else "") + form),
            )
        found = []
        for match in self.pattern[1].finditer(line):
            if match.lastgroup == "comment":
                break
            text = match[0]
            if text[0] == '"':
                if len(text) == 1 or text[-1] != '"':
                    raise self.fault("a quotation mark is not closed")
                found.append(_Word(text[1:-1], True))
            else:
                found.append(_Word(text, False))
        return found

    def _only(self, words: list[_Word], most: int) -> None:
        if len(words) > most:
            raise self.fault(f"{printable(words[most].text)[:40]!r} is more than is wanted here")

    def _parts(self, word: _Word) -> tuple[str, ...]:
        """The parts of a name, with the names of its blocks."""
        signs = self.now.characters
        if not word.quoted and word.text[0] in signs["root"]:
            raise self.fault(f"{printable(word.text)[:40]}: names from the root are not read")
        if word.quoted:
            parts = [word.text]
        elif signs["separator"]:
            parts = re.split(f"[{re.escape(signs['separator'])}]", word.text)
        else:
            parts = [word.text]
        made = []
        for part in parts:
            part = part[: self.now.truncate]
            case = {"tolower": str.lower, "toupper": str.upper}.get(self.now.case, str)
            made.append(case(part))
            strange = [c for c in part if not c.isalnum() and c not in signs["names"]]
            if not part or "." in part or (strange and not word.quoted):
                text = printable(word.text)[:40]
                raise self.fault(f"{text!r} is not the name of a station or a block")
        if sum(map(len, (*self.now.prefix, *made))) + len(self.now.prefix) > LONGEST:
            raise self.fault(f"a name of more than {LONGEST} characters")
        return tuple(made)

    def _name(self, word: _Word) -> str:
        return ".".join((*self.now.prefix, *self._parts(word)))

    def _number(self, word: _Word) -> float:
        """Read a number.

        Raises:
            InputError: It is not a number.
        """
        signs, text = self.now.characters, word.text
        sign = 1.0
        if text[:1] and text[0] in signs["minus"] + signs["plus"]:
            sign, text = (-1.0 if text[0] in signs["minus"] else 1.0), text[1:]
        decimals = [c for c in text if c in signs["decimal"]]
        strange = "." in text and "." not in decimals
        for decimal in decimals:
            text = text.replace(decimal, ".")
        if (
            word.quoted
            or not re.fullmatch(r"[0-9]+\.?[0-9]*|\.[0-9]+", text)
            or strange
            or float(text) > LARGEST
        ):
            told = printable(word.text)[:40]
            raise self.fault(f"{told!r} is not a number of at most {LARGEST}")
        return sign * float(text)

    # Legs.

    def _line(self, words: list[_Word], line: int) -> None:
        """Read a line of data."""
        now = self.now
        if now.style in NO_LEGS:
            self.survey.left[f"lines of *data {now.style} left out"] += 1
            return
        told: dict[str, _Word] = {}
        for place, name in enumerate(now.order):
            if name == "ignoreall":
                break
            if place >= len(words):
                raise self.fault(
                    f"no {name}: this line has {len(words)} of {len(now.order)} readings"
                )
            if name != "ignore":
                told[name] = words[place]
        else:
            self._only(words, len(now.order))
        ends = self._end(told["from"], line), self._end(told["to"], line)
        by = {"normal": self._normal, "cartesian": self._by_axes}.get(now.style, self._by_depths)
        made = by(told)
        east, north, slope, length = made
        if None in ends or "splay" in now.flags:
            self.survey.left["splay legs left out"] += 1
        elif "surface" in now.flags:
            self.survey.left["surface legs left out"] += 1
        else:
            one, other = (self.survey.station(str(end)) for end in ends)
            if length == 0:
                self.survey.left["legs of length 0, whose ends are taken as one station"] += 1
                self.survey.join(one, other)
                return
            number = len(self.survey.legs)
            duplicate = "duplicate" in now.flags
            leg = Leg(number, one, other, east, north, slope, length, duplicate)
            self.survey.legs.append(leg)

    def _end(self, word: _Word, line: int) -> str | None:
        """The name of the station at the end of a leg; None if the leg is a splay."""
        signs = self.now.characters
        if not word.quoted:
            if word.text == "-" and self.now.splay:
                return None
            if all(c in signs["separator"] for c in word.text):
                if len(word.text) > 3:
                    raise self.fault("an anonymous station has one to three points")
                if len(word.text) < 3:
                    return None
                # Each such station is a new one. No name in a file has two points in a row.
                return ".".join((*self.now.prefix, f"..{self.survey.new()}"))
            if len(word.text) == 1 and word.text in signs["omit"]:
                raise self.fault("a station is left out; after *alias station - .. it is a splay")
        return self._name(word)

    def _omitted(self, word: _Word | None) -> bool:
        if word is None:
            return True
        return not word.quoted and len(word.text) == 1 and word.text in self.now.characters["omit"]

    def _measured(self, told: Mapping[str, _Word], name: str) -> float | None:
        """Read a length or an angle, corrected; None if it is left out."""
        word = told.get(name)
        if word is None or self._omitted(word):
            return None
        now = self.now
        if name in now.quadrants:
            number = self._quadrant(word)
        elif name in now.percent:
            number = math.degrees(math.atan(self._number(word) / 100))
        else:
            number = self._number(word) * now.units.get(name, 1.0)
        scale, offset = now.corrected.get(name, (1.0, 0.0))
        if name in ("compass", "backcompass") and not 0 <= number <= 360:
            self.survey.left["compass readings below 0 or above 360 degrees"] += 1
        number = number * scale - offset
        if not abs(number) <= LARGEST:
            raise self.fault(f"{name} is more than {LARGEST}")
        return number

    def _quadrant(self, word: _Word) -> float:
        """Read a bearing such as S34E."""
        text = word.text.upper()
        if text in (ways := {"N": 0.0, "E": 90.0, "S": 180.0, "W": 270.0}):
            return ways[text]
        match = re.fullmatch(r"([NS])(.+)([EW])", text)
        number = self._number(_Word(match[2], False)) if match else math.nan
        if not match or not 0 <= number <= 90:
            raise self.fault(f"{printable(word.text)[:40]!r} is not a bearing such as S34E")
        return {"NE": number, "SE": 180 - number, "SW": 180 + number, "NW": -number}[
            match[1] + match[3]
        ]

    def _slope(self, told: Mapping[str, _Word], name: str) -> float | None:
        """Read a slope in degrees; it is 90 or -90 if it was plumbed, None if it is left out."""
        if name in told:
            text = told[name].text.lower()
            if text in ("u", "up", "+v"):
                return 90.0
            if text in ("d", "down", "-v"):
                return -90.0
            if text in ("h", "level"):
                return 0.0
            if self.now.plumbs and not self._omitted(told[name]) and name not in self.now.percent:
                plain = self._number(told[name]) * self.now.units.get(name, 1.0)
                if abs(plain) == 90:
                    return plain
        slope = self._measured(told, name)
        if slope is not None and abs(slope) > 90:
            raise self.fault(f"a {name} of more than 90 degrees")
        return slope

    def _normal(self, told: Mapping[str, _Word]) -> tuple[float, float, float, float]:
        """Read a leg by tape, compass and clino: east, north, its slope and its length.

        If it was measured from both ends, the mean is taken.
        """
        length = self._tape(told)
        ahead, back = self._slope(told, "clino"), self._slope(told, "backclino")
        slopes = [
            number for number in (ahead, None if back is None else -back) if number is not None
        ]
        slope = sum(slopes) / len(slopes) if slopes else 0.0
        if abs(slope) == 90 or length == 0:
            return 0.0, 0.0, slope, length
        flat = length * math.cos(math.radians(slope))
        return (*self._towards(told, flat), slope, length)

    def _tape(self, told: Mapping[str, _Word]) -> float:
        """Read how long a leg is.

        If it was measured from both ends, the mean is taken.
        """
        tapes = [self._measured(told, name) for name in ("tape", "backtape")]
        known = [tape for tape in tapes if tape is not None]
        if not known:
            raise self.fault("no tape")
        length = sum(known) / len(known)
        if self.now.equates and any(
            name in told and not self._omitted(told[name]) and self._number(told[name]) == 0
            for name in ("tape", "backtape")
        ):
            length = 0.0
        if length < 0:
            raise self.fault("the corrected tape is below 0")
        return length

    def _towards(self, told: Mapping[str, _Word], flat: float) -> Point:
        """Read the compass, and compute how far east and north a level length leads.

        If the bearing was measured from both ends, the mean is taken.
        """
        compass, behind = (self._measured(told, name) for name in ("compass", "backcompass"))
        if compass is None and behind is None:
            raise self.fault("no compass, though the leg is not plumbed")
        if behind is not None:
            off = 0.0 if compass is None else (behind + 180 - compass + 180) % 360 - 180
            compass = behind + 180 if compass is None else compass + off / 2
        bearing = math.radians((compass or 0.0) + self.now.declination)
        return flat * math.sin(bearing), flat * math.cos(bearing)

    def _by_depths(self, told: Mapping[str, _Word]) -> tuple[float, float, float, float]:
        """Read a leg by tape, compass and depths: east, north, its slope and its length.

        The tape of a diver runs along the line; the tape of cylindrical polar data is level.
        """
        length = self._tape(told)
        depths = [self._depth(told, name) for name in ("fromdepth", "todepth", "depthchange")]
        before, after, change = depths
        if change is None and before is not None and after is not None:
            change = after - before
        down = change or 0.0
        if self.now.style == "diving":
            if abs(down) > length > 0 and abs(down) > length * (1 + TOO_DEEP):
                raise self.fault("the depths differ by more than the length of the tape")
            flat = math.sqrt(max(0.0, length**2 - down**2))
        else:
            flat, length = length, math.hypot(length, down)
        if flat == 0:
            return 0.0, 0.0, math.copysign(90, -down), length
        return (*self._towards(told, flat), math.degrees(math.atan2(-down, flat)), length)

    def _depth(self, told: Mapping[str, _Word], name: str) -> float | None:
        """Read a depth in metres, or a change of it, corrected; None if it is left out."""
        word = told.get(name)
        if word is None or self._omitted(word):
            return None
        scale, offset = self.now.corrected.get("depth", (1.0, 0.0))
        number = self._number(word) * self.now.units.get("depth", 1.0) * scale
        number -= 0.0 if name == "depthchange" else offset
        if not abs(number) <= LARGEST:
            raise self.fault(f"{name} is more than {LARGEST}")
        return number

    def _by_axes(self, told: Mapping[str, _Word]) -> tuple[float, float, float, float]:
        """Read a leg that is given by how far it leads east, north and up."""
        east, north = (self._measured(told, name) for name in ("dx", "dy"))
        if east is None or north is None:
            raise self.fault("no easting or no northing")
        up = self._measured(told, "dz") or 0.0
        flat = math.hypot(east, north)
        return east, north, math.degrees(math.atan2(up, flat)), math.hypot(flat, up)

    # Commands.

    def _data(self, words: list[_Word]) -> None:
        if not words:
            return
        style = words[0].text.lower()
        if style == "default":
            self._only(words, 1)
            self.now = replace(self.now, style="normal", order=USUAL)
            return
        style = STYLES.get(style, style)
        if style in NO_LEGS:
            self.now = replace(self.now, style=style, order=())
            return
        if style not in READINGS:
            known = " and ".join(READINGS)
            raise self.fault(f"data style {printable(style)[:40]} is not read, only {known} are")
        order: list[str] = []
        for word in words[1:]:
            name = word.text.lower()
            if name in ("newline", "station", "direction"):
                raise self.fault(f"*data {style} with {name}: legs on several lines are not read")
            name = (
                name
                if name in ("from", "to", "ignore", "ignoreall")
                else QUANTITIES.get(name, name)
            )
            if name not in {*READINGS[style], "from", "to", "ignore", "ignoreall"}:
                raise self.fault(f"*data {style}: the reading {printable(name)[:40]} is not read")
            if name != "ignore" and name in order:
                raise self.fault(f"*data {style}: the reading {name} occurs twice")
            if order[-1:] == ["ignoreall"]:
                raise self.fault("*data: ignoreall must be the last of the readings")
            order.append(name)
        wanted = ("dx", "dy") if style == "cartesian" else ()
        missing = [name for name in ("from", "to", *wanted) if name not in order]
        if style != "cartesian" and not {"tape", "backtape"} & {*order}:
            missing.append("tape")
        if style != "cartesian" and not {"compass", "backcompass"} & {*order}:
            missing.append("compass")
        if missing:
            raise self.fault(f"*data {style} without: {', '.join(missing)}")
        self.now = replace(self.now, style=style, order=tuple(order))

    def _quantities(self, words: list[_Word], command: str) -> tuple[list[str], list[_Word]]:
        """Split a command into the quantities with which it begins, and the other words."""
        found = []
        rest = [*words]
        while rest and (name := QUANTITIES.get(rest[0].text.lower())):
            found.append(name)
            rest.pop(0)
        if not found:
            text = printable(words[0].text)[:40] if words else "nothing"
            raise self.fault(f"*{command}: {text!r} is not a quantity")
        return found, rest

    def _unit(self, word: _Word, names: Iterable[str]) -> float:
        """The number of metres or degrees of a unit, which must fit all these quantities."""
        unit = word.text.lower()
        for name in names:
            known = DEGREES if name in ANGLES else METRES
            if unit not in known:
                raise self.fault(f"{printable(unit)[:40]!r} is not a unit of {name}")
        return DEGREES.get(unit) or METRES[unit]

    def _units(self, words: list[_Word]) -> None:
        if [word.text.lower() for word in words] == ["default"]:
            self.now = replace(self.now, units={}, quadrants=frozenset(), percent=frozenset())
            return
        names, rest = self._quantities(words, "units")
        factor = self._number(rest.pop(0)) if len(rest) == 2 else 1.0
        if len(rest) != 1 or factor == 0:
            raise self.fault("*units: a unit is wanted, and a number before it must not be 0")
        unit, told = rest[0].text.lower(), frozenset(names)
        quadrants, percent = self.now.quadrants - told, self.now.percent - told
        units = dict(self.now.units)
        if unit in QUADRANTS and told <= ANGLES - SLOPES - {"declination"}:
            quadrants |= told
        elif unit in PERCENT and told <= SLOPES:
            percent |= told
        else:
            units.update(dict.fromkeys(names, factor * self._unit(rest[0], names)))
        self.now = replace(self.now, units=units, quadrants=quadrants, percent=percent)

    def _calibrate(self, words: list[_Word]) -> None:
        if [word.text.lower() for word in words] == ["default"]:
            self.now = replace(self.now, corrected={}, declination=0.0)
            return
        names, rest = self._quantities(words, "calibrate")
        if not 1 <= len(rest) <= 3:
            raise self.fault("*calibrate: a zero error is wanted, then a unit and a scale, if any")
        zero = self._number(rest[0])
        unit = None
        if len(rest) > 1 and (rest[1].text.lower() in {*METRES, *DEGREES}):
            unit = self._unit(rest.pop(1), names)
        if len(rest) > 2:
            raise self.fault(f"*calibrate: {printable(rest[1].text)[:40]!r} is not a unit")
        scale = self._number(rest[1]) if len(rest) == 2 else 1.0
        corrected = dict(self.now.corrected)
        for name in names:
            error = zero * (self.now.units.get(name, 1.0) if unit is None else unit)
            if name == "declination":
                if len(names) > 1 or len(rest) == 2:
                    raise self.fault("*calibrate declination: one number, and no other quantity")
                self.now = replace(self.now, declination=-error)
                return
            corrected[name] = scale, error * scale if unit is None else error
        self.now = replace(self.now, corrected=corrected)

    def _declination(self, words: list[_Word]) -> None:
        if words and words[0].text.lower() == "auto":
            self.survey.magnetic = True
            self.survey.left[
                "commands *declination auto, which is not computed: bearings stay magnetic"
            ] += 1
            self.now = replace(self.now, declination=0.0)
            return
        if len(words) != 2:
            raise self.fault("*declination: a number and a unit are wanted")
        angle = self._number(words[0]) * self._unit(words[1], ["declination"])
        self.now = replace(self.now, declination=angle)

    def _default(self, words: list[_Word]) -> None:
        names = [word.text.lower() for word in words]
        if len(names) != 1 or names[0] not in ("calibrate", "data", "units"):
            raise self.fault("*default: calibrate, data or units are wanted")
        self.handlers[names[0]]([_Word("default", False)])

    def _equate(self, words: list[_Word]) -> None:
        if len(words) < 2:
            raise self.fault("*equate names two stations or more")
        first, *others = (self.survey.station(self._name(word)) for word in words)
        for other in others:
            self.survey.join(first, other)

    def _fix(self, words: list[_Word]) -> None:
        if not words:
            raise self.fault("*fix names a station")
        name, rest = self._name(words[0]), words[1:]
        if rest and rest[0].text.lower() == "reference":
            rest = rest[1:]
        numbers = [self._number(word) for word in rest]
        if len(numbers) in (1, 2):
            raise self.fault("*fix: three coordinates are wanted, or none")
        self.survey.station(name)
        self.survey.systems.add(self.now.system)
        self.survey.fixed.setdefault(name, (numbers[0], numbers[1]) if numbers else (0.0, 0.0))

    def _flags(self, words: list[_Word]) -> None:
        flags, no = set(self.now.flags), False
        for word in words:
            name = word.text.lower()
            if name == "not":
                no = True
                continue
            if name not in FLAGS:
                raise self.fault(f"*flags: {printable(name)[:40]!r} is not a flag")
            (flags.discard if no else flags.add)(name)
            no = False
        if no or not words:
            raise self.fault("*flags: a flag is wanted")
        self.now = replace(self.now, flags=frozenset(flags))

    def _alias(self, words: list[_Word]) -> None:
        texts = [word.text.lower() for word in words]
        if texts[:2] != ["station", "-"] or texts[2:] not in ([], [".."]):
            raise self.fault("*alias: only *alias station - .. is read, and *alias station -")
        self.now = replace(self.now, splay=len(texts) == 3)

    def _case(self, words: list[_Word]) -> None:
        case = words[0].text.lower() if len(words) == 1 else ""
        if case not in ("preserve", "toupper", "tolower"):
            raise self.fault("*case: preserve, toupper or tolower is wanted")
        self.now = replace(self.now, case=case)

    def _truncate(self, words: list[_Word]) -> None:
        text = words[0].text.lower() if len(words) == 1 else ""
        if text != "off" and not re.fullmatch(r"[1-9][0-9]{0,2}", text):
            raise self.fault("*truncate: a number of characters, or off, is wanted")
        self.now = replace(self.now, truncate=None if text == "off" else int(text))

    def _cs(self, words: list[_Word]) -> None:
        if not words:
            raise self.fault("*cs: a system of coordinates is wanted")
        if words[0].text.lower() != "out":
            self.now = replace(self.now, system=" ".join(word.text.lower() for word in words))

    def _cartesian(self, words: list[_Word]) -> None:
        texts = [word.text.lower() for word in words]
        if texts not in (["true"], ["grid"]):
            raise self.fault("*cartesian: only *cartesian true and *cartesian grid are read")

    def _infer(self, words: list[_Word]) -> None:
        texts = [word.text.lower() for word in words]
        if len(texts) != 2 or texts[1] not in ("on", "off"):
            raise self.fault("*infer: plumbs, equates or exports, then on or off, are wanted")
        on = texts[1] == "on"
        if texts[0] == "plumbs":
            self.now = replace(self.now, plumbs=on)
        elif texts[0] == "equates":
            self.now = replace(self.now, equates=on)
        elif texts[0] != "exports":
            raise self.fault(f"*infer: {printable(texts[0])[:40]!r} is not read")

    def _set(self, words: list[_Word]) -> None:
        name = words[0].text.lower() if words else ""
        if name not in CHARACTERS:
            raise self.fault(f"*set: {printable(name)[:40]!r} is not read")
        text = "".join(word.text for word in words[1:])
        text = re.sub(r"[xX]([0-9a-fA-F]{2})", lambda match: chr(int(match[1], 16)), text)
        if any(c.isalnum() or c in '\r\n\0"' for c in text):
            raise self.fault("*set: letters, digits, quotation marks and ends of lines are refused")
        self.now = replace(self.now, characters={**self.now.characters, name: text})
