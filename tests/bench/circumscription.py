"""How the two readings of the preference differ: by set inclusion, and by number.

    cd tests && python -m bench.circumscription

Writes the tables of docs/circumscription.md, between the lines that mark them. Exit status: 0 all
is counted, 1 two ways differ. The maps that are least by inclusion are found by clingo, and again
by the search and the definition; those by number by clingo.
"""

import json
import random
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from oracles.worlds import random_experience
from topomap.model.experience import Experience
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.runtime.files import output
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver.circumscription import circumscribed
from topomap.solver.solving import hypotheses
from tqdm import tqdm

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/circumscription.md"
COLUMNS = ROOT / "scripts/topomap/paper/figure4.json"
EXPERIENCES, STEPS = 1000, 14
MARKS = "<!-- written by `make circumscription`: -->\n", "<!-- end -->\n"
HEAD = "| | admitted | by inclusion | by number | in both |\n|---|--:|--:|--:|--:|\n"


@dataclass(frozen=True)
class Row:
    """How many maps are admitted, and preferred by inclusion, by number, and in both ways."""

    admitted: int
    inclusion: int
    number: int
    both: int
    kind: str

    def __str__(self) -> str:
        figures = self.admitted, self.inclusion, self.number, self.both
        return " | ".join(f"{figure:,}" for figure in figures)


def compared(experience: Experience, query: Query) -> Row:
    """The figures of one experience. Raises RuntimeError if two ways differ."""
    found = list(circumscribed(experience, query, Watch()))
    again = {one.at for one in circumscribed(experience, query, Watch(), "search")}
    inclusion = {one.at for one in found}
    if inclusion != again or len(inclusion) != len(found):
        raise RuntimeError("clingo and the search differ")
    kind = found[0].kind if found else ""
    query = query.having("boundary", *["closed"] * (kind == "circumscribed"))
    best = hypotheses(experience, query.having("minimal"), Watch())
    number = {one.at for one in best if one and one.proved}
    if not number <= inclusion:
        raise RuntimeError("a best map is not circumscribed")
    admitted = sum(map(bool, traversal.hypotheses(experience, query, Watch())))
    return Row(admitted, len(inclusion), len(number), len(inclusion & number), kind)


def figure4() -> Iterator[tuple[str, Row]]:
    """The six columns of the paper's table."""
    for column in json.loads(COLUMNS.read_text())["columns"]:
        planar = ("planar",) if column["planarity"] else ()
        query = Query(frozenset(planar), column["places"])
        experience = read(ROOT / f"instances/{column['instance']}.lp")
        name = column["environment"] + (", planar" if planar else "")
        yield name, compared(experience, query)


def drawn(numbers: Iterable[int]) -> Iterator[Row]:
    """Random experiences."""
    for number in numbers:
        draw = random.Random(f"circumscription {number}")
        experience = random_experience(draw, STEPS)
        yield compared(experience, Query(frozenset(["planar"] if number % 2 else [])))


def tables() -> str:
    """Both tables, as the page has them."""
    lines = [f"| {name} | {row} |" for name, row in tqdm(figure4(), "Figure 4", 6)]
    text = HEAD + "\n".join(lines) + "\n"
    rows = list(tqdm(drawn(range(EXPERIENCES)), "random", EXPERIENCES))
    groups = {
        "with a closed map": [row for row in rows if row.kind == "circumscribed"],
        "without one": [row for row in rows if row.kind != "circumscribed"],
        "all": rows,
    }
    text += (
        f"\nThe next table has sums over {EXPERIENCES:,} random experiences of up to {STEPS} "
        "steps. Every other one is with planarity.\n\n"
        "| experiences | how many | admitted | by inclusion | by number | in both "
        "| they differ in |\n"
        "|---|--:|--:|--:|--:|--:|--:|\n"
    )
    for name, group in groups.items():
        keys = ("admitted", "inclusion", "number", "both")
        sums = " | ".join(f"{sum(getattr(row, key) for row in group):,}" for key in keys)
        differ = sum(row.inclusion != row.number for row in group)
        text += f"| {name} | {len(group):,} | {sums} | {differ:,} |\n"
    return text


def main() -> int:
    """Write the tables."""
    begin, end = MARKS
    before, _, rest = PAGE.read_text().partition(begin)
    after = rest.partition(end)[2]
    try:
        text = tables()
    except RuntimeError as error:
        print(f"circumscription: {error}", file=sys.stderr)
        return 1
    with output(str(PAGE)) as out:
        out.write(f"{before}{begin}{text}{end}{after}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
