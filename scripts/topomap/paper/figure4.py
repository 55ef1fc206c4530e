"""The paper's table (Figure 4) beside ours, and tables as text."""

import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from topomap.model.facts import read
from topomap.model.query import Query
from topomap.paper.statistics import KEYS, WORDS, tree
from topomap.runtime.folders import INSTANCES
from topomap.runtime.journal import Journal
from topomap.runtime.watch import Watch

COLUMNS: list[dict[str, Any]] = json.loads(
    Path(__file__).with_name("figure4.json").read_text(encoding="utf-8")
)["columns"]


def row(column: dict[str, Any], watch: Watch) -> dict[str, Any]:
    """Count one column: an environment, with or without planarity."""
    begun = time.perf_counter()
    query = Query(frozenset(["planar"] if column["planarity"] else []), column["places"])
    figures: dict[str, Any] = {}
    tree(read(INSTANCES / f"{column['instance']}.lp"), query, watch, Journal(), figures)
    return {
        "environment": column["environment"],
        "planarity": column["planarity"],
        **figures,
        "paper": column["paper"],
        "expected": column["expected"],
        "seconds": round(time.perf_counter() - begun, 2),
    }


def rows(jobs: int, watch: Watch) -> Iterator[dict[str, Any]]:
    """Count the rows of the table, and give each as soon as it is counted.

    The largest ones begin first.

    Raises:
        Stopped: The time limit has passed, or the work was interrupted.
    """
    with ThreadPoolExecutor(jobs) as pool:
        pending = [pool.submit(row, column, watch) for column in reversed(COLUMNS)]
        for done in as_completed(pending):
            yield done.result()


def differences(row: dict[str, Any]) -> list[str]:
    """Find the cells in which a row differs from the paper or from another way to count it."""
    where = f"{row['environment']} {'with' if row['planarity'] else 'without'} planarity"
    return [
        f"{where}: {key} is {row[key]}, {source} has {figure}"
        for source in ("paper", "expected", "clingo", "merging")
        for key, figure in row.get(source, {}).items()
        if row[key] is not None and row[key] != figure
    ]


def table_text(rows: list[dict[str, Any]]) -> str:
    """Write a table to read, with our figures above those of the paper."""

    def line(word: str, key: str) -> list[str]:
        """Write one line of the table."""
        cells = [row.get(key) for row in rows]
        return [word] + [_cell(cell) for cell in cells]

    lines = [line("", "environment"), line("planarity", "planarity")]
    if any(row.get("places") for row in rows):
        lines.append(line("places, at most", "places"))
    for key in KEYS:
        lines.append(line(WORDS[key], key))
        for source in "paper", "clingo", "merging":
            cells = [row.get(source, {}).get(key) for row in rows]
            if any(cells):
                lines.append([f"    {source}", *map(_cell, cells)])
    if "seconds" in rows[0]:
        lines.append(line("seconds", "seconds"))
    widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
    return "\n".join(
        "  ".join(
            [line[0].ljust(widths[0])]
            + [cell.rjust(width) for cell, width in zip(line[1:], widths[1:], strict=True)]
        ).rstrip()
        for line in lines
    )


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.1f}"
    return f"{value:,}" if isinstance(value, int) else str(value or "")
