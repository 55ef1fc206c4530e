"""The paper's table (Figure 4), and what lies beyond it."""

import json
import os
from collections.abc import Callable, Iterator
from typing import IO, Any

from topomap.model.reply import Reply
from topomap.paper import beyond, figure4
from topomap.runtime import formats
from topomap.runtime.files import output
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Attempt, Watch
from topomap.solver.crews import crew as crew_of

Row = dict[str, Any]
Noted = Callable[[int, int], None]  # called with how many of all columns are counted


class Table(Reply):
    """The columns of a table that were counted, each a dictionary.

    ``many`` is the number of all columns. ``verdict`` is what is said if all were counted and
    nothing differs.
    """

    def __init__(self, rows: list[Row], many: int, verdict: str, fault: str | None):
        super().__init__(fault)
        self.rows, self._many, self._verdict = rows, many, verdict

    @property
    def differences(self) -> list[str]:
        """The figures that differ from the paper, or from another way to count them."""
        return [cell for row in self.rows for cell in figure4.differences(row)]

    def lines(self) -> Iterator[str]:
        """The table as the lines that ``topomap table`` prints."""
        if self.rows:
            yield from figure4.table_text(self.rows).splitlines()
        yield from (f"differs: {cell}" for cell in self.differences)
        if self.fault:
            yield f"partial: {self.fault}; {len(self.rows)} of {self._many} columns"
        elif not self.differences:
            yield self._verdict

    def document(self) -> dict[str, Any]:
        """The table as ``topomap table --json`` writes it."""
        return {"rows": self.rows}


def table_under(watch: Watch, path: str, jobs: int | None, noted: Noted) -> Table:
    """Count the paper's table and write it to a file as JSON, under the watch of a command.

    ``jobs`` columns are counted at a time. If the work is cut short, the file keeps an older,
    complete table.
    """
    rows: list[Row] = []
    many = len(figure4.COLUMNS)
    with Attempt() as attempt, output(path, parents=True) as file:
        _take(figure4.rows(jobs or _processors(), watch), rows, many, noted)
        _write(file, rows)
    return Table(rows, many, "Every figure is the paper's.", attempt.fault)


def table_beyond_under(
    watch: Watch, path: str, jobs: int | None, resume: bool, noted: Noted
) -> Table:
    """Count larger grids and write the table to a file as JSON, under the watch of a command.

    ``jobs`` processes share the work. A journal beside the file tells what is done; ``resume`` goes
    on from there.
    """
    rows: list[Row] = []
    many = len(beyond.COLUMNS) + len(beyond.MERGED)
    run = {"command": "beyond", "columns": [beyond.COLUMNS, beyond.MERGED]}
    with (
        Attempt() as attempt,
        output(path, parents=True) as file,
        Journal(path, run, resume) as journal,
        crew_of(jobs or _processors()) as crew,
    ):
        _take(beyond.rows(crew, watch, journal), rows, many, noted)
        _write(file, rows)
        journal.complete = True
    return Table(rows, many, beyond.VERDICT, attempt.fault)


def _processors() -> int:
    return os.cpu_count() or 1


def _take(counted: Iterator[Row], rows: list[Row], many: int, noted: Noted) -> None:
    """Collect the columns as they are counted, and keep them in order."""
    for row in counted:
        rows.append(row)
        rows.sort(key=lambda row: (row["environment"], row["planarity"], row.get("way", "")))
        noted(len(rows), many)


def _write(file: IO[str], rows: list[Row]) -> None:
    json.dump(formats.answer({"rows": rows}), file, indent=1)
    file.write("\n")
