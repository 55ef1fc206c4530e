"""How far a compass and odometry narrow what is consistent with a walk: the figures and the plot of
docs/knowledge.md. Each count is clingo's; up to SEARCHED maps the search must count as many."""

import argparse
import re
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from conftest import ROOT
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.files import output
from topomap.runtime.watch import Stopped, Watch
from topomap.search.descent import Descent
from topomap.solver.solving import count
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance
from topomap.worlds.senses import Senses

PAGE = ROOT / "docs/knowledge.md"
PICTURE = ROOT / "docs/figures/knowledge.svg"
BEGIN, END = "<!-- figures: make knowledge -->\n", "<!-- end of the figures -->\n"
WORLDS = (
    ("3x3", (3, 3), "snake"),
    ("3x4", (3, 4), "ESSENNESSWWWNEEENWWWS"),
    ("4x4", (4, 4), "snake"),
    ("5x5", (5, 5), "snake"),
)
KNOWN: dict[str, tuple[Senses, int]] = {  # and the drift
    "views alone": (Senses(), 10),
    "a compass": (Senses(compass=True), 10),
    "odometry, drift 20": (Senses(odometry=0), 20),
    "odometry, drift 10": (Senses(odometry=0), 10),
    "odometry, drift 5": (Senses(odometry=0), 5),
    "drift 10 and a compass": (Senses(compass=True, odometry=0), 10),
}
ASKED = {"final": (), "planar": ("planar",), "closed": ("closed",), "both": ("closed", "planar")}
SEARCHED = 10_000


def experience(size: tuple[int, int], route: str, known: str) -> Experience:
    """What is known of a walk, without errors."""
    senses, drift = KNOWN[known]
    return instance(grid(*size), route, senses=senses).experience.within(drift)


def counted(seen: Experience, parts: tuple[str, ...], limit: float) -> int | None:
    """How many maps there are; None if that is not settled in so many seconds. Raises RuntimeError
    if the search counts another number."""
    query = Query(frozenset(parts))
    try:
        number, _ = count(seen, query, watch=Watch(limit), grown=False)
    except Stopped:
        return None
    if number <= SEARCHED:
        try:
            other = sum(1 for one in Descent(seen, query).found(Watch(limit)) if one)
        except Stopped:
            return number
        if other != number:
            raise RuntimeError(f"clingo counts {number} maps, the search {other}")
    return number


def rows(limit: float, only: str) -> Iterator[tuple[str, str, dict[str, int | None]]]:
    """For each world and what is known of it, the counts."""
    for name, size, route in WORLDS:
        for known in KNOWN:
            if re.search(only, f"{name} {known}"):
                seen = experience(size, route, known)
                begun = time.monotonic()
                found = {asked: counted(seen, parts, limit) for asked, parts in ASKED.items()}
                print(name, known, found, f"{time.monotonic() - begun:.0f} s", file=sys.stderr)
                yield name, known, found


def table(found: list[tuple[str, str, dict[str, int | None]]], limit: float) -> str:
    """The counts as a table of Markdown."""

    def cell(counts: dict[str, int | None], one: str, closed: str) -> str:
        told = [
            "not settled" if counts[key] is None else f"{counts[key]:,}" for key in (one, closed)
        ]
        return f"{told[0]} ({told[1]})"

    lines = [
        "| world | what is known | all maps (closed) | planar maps (closed) |",
        "|---|---|--:|--:|",
    ]
    for name, known, counts in found:
        both = cell(counts, "final", "closed"), cell(counts, "planar", "both")
        lines.append(f"| {name} | {known} | {both[0]} | {both[1]} |")
    note = f"A count that takes more than {limit:g} seconds is not settled."
    return "\n".join(lines) + f"\n\n{note}\n"


def draw(found: list[tuple[str, str, dict[str, int | None]]], path: Path) -> None:
    """The same as a picture: the number of maps by what is known."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    matplotlib.rcParams.update({"svg.hashsalt": "topomap", "font.size": 9})
    worlds = [name for name, *_ in WORLDS if any(name == row[0] for row in found)]
    figure, axes = pyplot.subplots(1, len(worlds), figsize=(3 * len(worlds), 4.4), sharey=True)
    styles: dict[str, dict[str, Any]] = {
        "final": {"color": "#0055aa", "marker": "o", "label": "all maps"},
        "planar": {"color": "#0055aa", "marker": "s", "ls": "--", "label": "planar maps"},
        "closed": {"color": "#cc5500", "marker": "o", "label": "closed maps"},
        "both": {"color": "#cc5500", "marker": "s", "ls": "--", "label": "closed planar maps"},
    }
    for axis, world in zip([axes] if len(worlds) == 1 else axes, worlds, strict=True):
        for asked, style in styles.items():
            points = [
                (list(KNOWN).index(known), counts[asked])
                for name, known, counts in found
                if name == world and counts[asked]
            ]
            axis.plot(*zip(*points, strict=True) if points else ([], []), **style)
        axis.set_title(world)
        axis.set_yscale("log")
        axis.set_xticks(range(len(KNOWN)), list(KNOWN), rotation=60, ha="right")
        axis.grid(axis="y", color="#dddddd")
    figure.axes[0].set_ylabel("consistent maps")
    figure.axes[-1].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main() -> int:
    parser = argparse.ArgumentParser(description="Count the maps of docs/knowledge.md.")
    parser.add_argument("--limit", type=float, default=600, help="seconds for a count")
    parser.add_argument("--only", default="", help="a regular expression, such as 3x3; no page")
    options = parser.parse_args()
    found = list(rows(options.limit, options.only))
    text = table(found, options.limit)
    if options.only:
        print(text, end="")
        return 0
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    with output(str(PAGE)) as page:
        page.write(before + BEGIN + text + END + after)
    draw(found, PICTURE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
