"""The rows of a log that somebody wrote as a table (CSV) or as JSON lines.

There is one row for each visit. The content tells which format it is. Each cell is a list of texts,
in either format.
"""

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

from topomap.model.terms import quoted
from topomap.runtime.errors import InputError
from topomap.runtime.limits import MOST_STEPS
from topomap.runtime.near import meant

COLUMNS = {
    "exits": "the bearings of the exits that are seen",
    "taken": "the bearing of the exit by which the place is left",
    "arrived": "the bearing of the exit by which one arrived",
    "length": "the length of the way that is taken",
    "east": "how far to the east this way leads",
    "north": "how far to the north this way leads",
    "displacement": "both of these, as two numbers",
    "landmarks": "what is recognised at the place",
    "drop": "markers that are put down",
    "pick": "markers that are taken up",
    "marker": "markers that are seen",
    "start": "yes, if a new log begins here",
    "look": "yes, if this is a second look from where one stands",
    "step": "the number of the row, which must be right",
    "note": "anything; it is ignored",
}
BEARINGS = ("exits", "taken", "arrived", "displacement")  # lists of numbers
LISTS = ("landmarks", "drop", "pick", "marker")
DELIMITERS = ",;\t"
NO, YES = {"", "no", "false", "0"}, {"yes", "true", "1", "x"}


@dataclass(frozen=True)
class Row:
    """A row: the line in which it begins, the number of its visit, and its cells."""

    file: str
    line: int
    step: int
    cells: dict[str, list[str]]

    def fault(self, said: str) -> InputError:
        """The error about a fault of this row, in one line."""
        return InputError(f"{self.file}:{self.line}: step {self.step}: {said}")

    def one(self, name: str) -> str | None:
        """The only value of a cell; None if it is empty."""
        values = self.cells.get(name, [])
        if len(values) > 1:
            told = quoted(" ".join(values))
            raise self.fault(f"{name}: {told} is more than one value")
        return values[0] if values else None

    def number(self, name: str) -> float | None:
        """The number in a cell; None if it is empty."""
        text = self.one(name)
        if text is None:
            return None
        value = number(text)
        if value is None:
            raise self.fault(f"{name}: {quoted(text)} is not a number")
        return value

    def flag(self, name: str) -> bool:
        """Whether a cell says yes."""
        text = (self.one(name) or "").lower()
        if text not in NO | YES:
            raise self.fault(f"{name}: {quoted(text)} is neither yes nor no")
        return text in YES


def number(text: str) -> float | None:
    """Read a finite number as people write it; None if a text is not one."""
    if len(text) > 40 or not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text, re.ASCII):
        return None
    value = float(text)
    return value if abs(value) <= 1e15 else None


def rows_of(file: str, text: str) -> list[Row]:
    """Read the rows of a log.

    Raises:
        InputError: It has a fault. One line, which names the line and the step.
    """
    first = text.lstrip()[:1]
    if first == "[":
        raise InputError(f"{file}: a JSON list; JSON lines are wanted, one object a line")
    made: list[Row] = []
    for line, cells in _json_lines(file, text) if first == "{" else _table(file, text):
        if len(made) > MOST_STEPS:
            raise InputError(f"{file}:{line}: there are more than {MOST_STEPS:,} steps")
        row = Row(file, line, len(made), cells)
        if both := cells.pop("displacement", None):
            if len(both) != 2 or {"east", "north"} & cells.keys():
                raise row.fault(
                    "displacement: there must be two numbers, east and north, in one column"
                )
            cells |= {"east": both[:1], "north": both[1:]}
        made.append(row)
    if not made:
        raise InputError(f"{file}: there are no rows in it")
    return made


def _table(file: str, text: str) -> Iterator[tuple[int, dict[str, list[str]]]]:
    """The cells of each row of CSV, with the line in which the row begins."""
    lines = io.StringIO(text, newline="")
    start = next((line for line in io.StringIO(text, newline="") if line.strip()), "")
    delimiter = max(DELIMITERS, key=start.count)
    reader = csv.reader(lines, delimiter=delimiter, strict=True)
    header: list[str] = []
    line = 1
    while True:
        try:
            fields = next(reader, None)
        except csv.Error as fault:
            raise InputError(f"{file}:{line}: not a row of CSV: {fault}") from None
        if fields is None:
            return
        fields = [field.strip() for field in fields]
        at, line = line, reader.line_num + 1
        if not any(fields):
            continue
        if not header:
            header = [field.lower() for field in fields]
            _demand_columns(f"{file}:{at}", header)
            continue
        if more := [field for field in fields[len(header) :] if field]:
            columns = f"the header names {len(header)} columns"
            raise InputError(f"{file}:{at}: {columns}, but {quoted(more[0])} stands after them")
        yield (
            at,
            {
                name: _split(name, _pointed(name, field, delimiter), delimiter == ",")
                for name, field in zip(header, fields, strict=False)
                if field
            },
        )


def _demand_columns(where: str, names: Iterable[str]) -> None:
    """Check that each name is the name of a column, and stands there once."""
    seen: set[str] = set()
    for name in names:
        if name not in COLUMNS:
            hint = meant(name, COLUMNS) or f"known are {', '.join(COLUMNS)}"
            raise InputError(f"{where}: column {quoted(name)} is not known; {hint}")
        if name in seen:
            raise InputError(f"{where}: column {name} occurs twice")
        seen.add(name)
    if "exits" not in seen:
        raise InputError(f"{where}: there is no column exits")


def _pointed(name: str, text: str, delimiter: str) -> str:
    """Write the numbers of a cell with decimal points.

    They may have decimal commas in a table whose columns are not separated by commas.
    """
    if delimiter == "," or name not in (*BEARINGS, "length", "east", "north"):
        return text
    return re.sub(r"(?<=\d),(?=\d)", ".", text)


def _split(name: str, text: str, commas: bool = True) -> list[str]:
    """Split a cell into its values.

    A comma separates bearings only if it cannot be part of a number, as in a table whose columns
    are separated by commas.
    """
    if name in BEARINGS:
        return re.split(r"[\s;|/,]+" if commas else r"[\s;|/]+", text.strip(" ;|/,\t\n\r"))
    if name in LISTS:
        return [part.strip() for part in re.split(r"[;|]", text) if part.strip()]
    return [text]


def _json_lines(file: str, text: str) -> Iterator[tuple[int, dict[str, list[str]]]]:
    """The cells of each line of JSON, with the number of the line."""
    for line, words in enumerate(text.split("\n"), 1):
        if not words.strip():
            continue
        where = f"{file}:{line}"
        try:
            row = json.loads(words, object_pairs_hook=_Pairs, parse_constant=_refused)
        except json.JSONDecodeError as fault:
            said = f"{fault.msg.lower()}, at letter {fault.colno}"
            raise InputError(f"{where}: not a line of JSON: {said}") from None
        except RecursionError:
            raise InputError(f"{where}: not a line of JSON: it is nested too deep") from None
        except ValueError as fault:
            raise InputError(f"{where}: not a line of JSON: {str(fault)[:200]}") from None
        if not isinstance(row, _Pairs):
            raise InputError(f"{where}: a JSON object is wanted, one a line")
        _demand_columns(where, [name for name, _ in row])
        yield line, {name: _texts(f"{where}: {name}", name, value) for name, value in row}


class _Pairs(list[tuple[str, Any]]):
    """A JSON object as it is written, in which a name may occur twice."""


def _refused(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a number")


def _texts(where: str, name: str, value: Any) -> list[str]:
    """Read a value of JSON as a cell; the items of a list are taken as they are."""
    if value is None or value is False:
        return []
    if value is True:
        return ["yes"]
    if isinstance(value, str):
        return _split(name, value) if value.strip() else []
    if isinstance(value, int | float):
        return [repr(value)]
    if isinstance(value, list) and not isinstance(value, _Pairs):
        if all(isinstance(one, str | int | float) and not isinstance(one, bool) for one in value):
            texts = [one if isinstance(one, str) else repr(one) for one in value]
            return [one.strip() for one in texts if one.strip()]
        raise InputError(f"{where}: a list holds texts and numbers only")
    raise InputError(f"{where}: an object is not a value here")
