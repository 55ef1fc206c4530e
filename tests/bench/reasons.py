"""How many reasons ``explain`` gives where there is no map, and how long that takes.

    cd tests && python -m bench.reasons

Writes the table of docs/questions.md. Exit status: 0 all is right, 1 an answer is wrong. That there
is no map is compared with the search; that each reason is needed, with definitions of the rules
(``oracles.mapless``), and that they suffice, with all assignments where these are few.
"""

import json
import random
import re
import statistics
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from conftest import ROOT
from oracles.mapless import Held, candidate, wrong
from topomap.model.experience import Experience
from topomap.model.query import Query
from topomap.runtime.files import output
from topomap.runtime.watch import Stopped, Watch
from topomap.search.descent import Descent

PAGE = ROOT / "docs/questions.md"
BEGIN, END = "<!-- figures: make reasons -->\n", "<!-- end of the figures -->\n"
MANY, STEPS = 100, 20
SEARCHED = 5  # seconds of the search, for each walk
YARDSTICK = (
    "clingo -q encodings/topomap.lp encodings/bound.lp -c places=16 instances/grid-4x4-snake.lp 0"
)
Case = tuple[Experience, tuple[str, ...], int | None]


def cases() -> Iterator[Case]:
    """Walks for which the search finds no map."""
    for number in range(100 * MANY):
        case = candidate(random.Random(f"reasons {number}"), STEPS)
        if not has_map(*case):
            yield case


def has_map(seen: Experience, parts: tuple[str, ...], bound: int | None) -> bool | None:
    """Whether there is one, as the search says; None if it takes the search too long."""
    try:
        return any(Descent(seen, Query(frozenset(parts), bound)).found(Watch(SEARCHED)))
    except Stopped:
        return None


def seconds_of(words: list[str]) -> tuple[float, str]:
    """What a command takes, and what it prints."""
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "topomap", *words], cwd=ROOT, capture_output=True, text=True
    )
    return time.perf_counter() - begun, done.stdout


def row(case: Case, file: Path) -> dict[str, Any]:
    """What is reported of a case, how long it took, and whether it is right."""
    seen, parts, bound = case
    file.write_text(seen.facts())
    options = [f"--{part}" for part in parts] + [f"--bound={bound}"] * (bound is not None)
    seconds, text = seconds_of(["explain", str(file), *options, "--json", "--timeout", "300"])
    answer = json.loads(text)
    known: dict[str, Any] = {
        "answer": answer,
        "seconds": seconds,
        "yardsticks": seconds / seconds_of(YARDSTICK.split())[0],
        "searched": has_map(*case) is False,
        "fault": None,
    }
    if known["searched"] and answer["verdict"] != "no map":
        known["fault"] = answer["verdict"]
    if answer["minimal"]:
        names = [reason["reason"] for reason in answer["reasons"]]
        fault = wrong(seen, answer, bound)
        enough = Held(seen.cut(answer["horizon"]), bound).suffice(names)
        known["needed"], known["enough"] = fault is None, enough is True
        if fault not in (None, "open") or enough is False:
            known["fault"] = fault or "the reasons do not suffice"
    return known


def table(rows: list[dict[str, Any]], passed: int) -> str:
    """The figures, to be shown."""
    answers = [one["answer"] for one in rows]
    reasons = [len(answer["reasons"]) for answer in answers]
    steps = [len(reason["steps"]) for answer in answers for reason in answer["reasons"]]
    gathered = [answer for answer in answers if answer["gathered"]]
    many = {
        "reasons": reasons,
        "steps that a reason names": steps,
        "seconds of the whole command": [one["seconds"] for one in rows],
        "the same in yardsticks": [one["yardsticks"] for one in rows],
    }
    lines = ["| of each | median | largest |", "|---|--:|--:|"]
    for name, figures in many.items():
        digits = 0 if isinstance(figures[0], int) else 1
        middle = statistics.median(figures)
        shown = f"{middle:g}" if not digits else f"{middle:.1f}"
        lines.append(f"| {name} | {shown} | {max(figures):.{digits}f} |")
    minimal = sum(answer["minimal"] is True for answer in answers)
    sure = sum(answer["fewest"] is True for answer in gathered)
    searched = sum(one["searched"] for one in rows)
    needed = sum(one.get("needed", False) for one in rows)
    enough = sum(one.get("enough", False) for one in rows)
    proved = [
        "| what is found | walks |",
        "|---|--:|",
        f"| there is no map, by the search in Python within {SEARCHED} seconds | {searched} |",
        f"| no reason can be left out | {minimal} |",
        f"| each reason is needed, by the definitions of the rules and without clingo | {needed} |",
        f"| the reasons are enough, by trying all assignments of places | {enough} |",
        f"| reasons are gathered | {len(gathered)} |",
        f"| reasons are gathered, and fewer of them would not be enough | {sure} |",
    ]
    texts = (
        f"These are the figures of {len(rows)} walks of up to {STEPS} steps without a map, with "
        f"several combinations of parts. {passed} more walks were passed over: a default stands in "
        f"the way of a closed map, and `explain` says that instead of giving reasons.",
        "For the other walks it is open whether each reason is needed, or whether the reasons are "
        "enough: there are too many assignments to be tried, or a gateway has two links in some "
        "map, and planarity and the sides of paths are not defined then.",
        f"A yardstick is the time of `{YARDSTICK}`, measured after each command.",
    )
    few, tried, yardstick = (textwrap.fill(text, 120, break_on_hyphens=False) for text in texts)
    return "\n\n".join([few, "\n".join(proved), tried, "\n".join(lines), yardstick]) + "\n"


def main() -> int:
    rows: list[dict[str, Any]] = []
    passed = 0
    with tempfile.TemporaryDirectory() as folder:
        for case in cases():
            known = row(case, Path(folder) / "walk.lp")
            answer = known["answer"]
            if answer["verdict"] == "map" and not known["fault"]:
                continue
            if answer["in_the_way"] and not known["fault"]:
                passed += 1
                continue
            rows.append(known)
            told = [reason["reason"] for reason in answer["reasons"]]
            figures = f"{known['seconds']:.1f} s, {known['yardsticks']:.1f} yardsticks"
            state = "minimal" if answer["minimal"] else "not proved minimal"
            print(len(rows), case[1:], figures, state, known["fault"] or "right", *told, flush=True)
            if len(rows) == MANY:
                break
    page = PAGE.read_text()
    shown = BEGIN + table(rows, passed) + END
    page = re.sub(f"{re.escape(BEGIN)}.*{re.escape(END)}", lambda _: shown, page, flags=re.S)
    with output(str(PAGE)) as out:
        out.write(page)
    return int(any(known["fault"] for known in rows))


if __name__ == "__main__":
    sys.exit(main())
