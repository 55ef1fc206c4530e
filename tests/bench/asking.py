"""What the commands that ask of maps take, as whole processes.

    cd tests && python -m bench.asking

Writes docs/asking.md. Exit status: 0 if all is measured and right; 1 if an answer is wrong.
The right answer is found in another way, from the maps that the search enumerates, or it is the
real map.
"""

import json
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from oracles import walks
from topomap.model.experience import DState
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.questions.standings import Standing
from topomap.runtime.files import output
from topomap.runtime.watch import Watch
from topomap.search import traversal
from topomap.solver import solving
from topomap.worlds.environment import grid
from topomap.worlds.instance import Instance, instance

ROOT = Path(__file__).resolve().parents[2]
TIMES = 3
SNAKE = "instances/grid-4x4-snake.lp"
HEAD = """# What it takes to ask

Written by `make bench` (`python -m bench.asking` in `tests/`). Seconds are those of whole commands,
including the start of Python; each figure is the median of {times} runs on one core. Each answer is
compared with one that was found in another way. Only the minimality of reasons is not: here it is
what `explain` itself says.

| command | answer | s |
| --- | --- | --: |
"""


@dataclass(frozen=True)
class Task:
    """A command, what its answer (as JSON) comes to, and what it should come to."""

    call: str
    told: Callable[[Any], str]
    right: Callable[[], str]


def maps(parts: tuple[str, ...], places: int | None) -> list[tuple[DState, ...]]:
    """The hypotheses of the 4x4 snake, by search."""
    query = Query(frozenset(parts), places)
    found = traversal.hypotheses(read(ROOT / SNAKE), query, Watch())
    return [one.at for one in found if one]


def held(holds: list[bool]) -> str:
    return "all" if all(holds) else "some" if any(holds) else "none"


def asked() -> str:
    experience, found = read(ROOT / SNAKE), maps(("planar",), 16)
    return ", ".join(
        held([*map(test, found)])
        for test in (
            lambda at: at[3][0] == at[12][0],
            lambda at: len({place for place, _ in at}) < 12,
            lambda at: not experience.map_of(at).genus(),
            lambda at: at[5][0] != at[9][0],
        )
    )


def in_question(made: Instance) -> list[Standing]:
    """The optimal maps, by search, and the real one."""
    found = solving.best(made.experience, Query(), Watch(), traversal.hypotheses)
    ats = [one.at for one in found if one and one.proved]
    return [walks.standing(made.experience, at) for at in (*ats, made.truth)]


def settled(walked: Path) -> str:
    """What the optimal maps of a walk through the 4x4 grid are, by search."""
    experience = read(walked)
    found = solving.best(experience, Query(), Watch(), traversal.hypotheses)
    maps = [experience.map_of(one.at) for one in found if one and one.proved]
    real = replace(grid(4, 4).map, landmarks={})
    same = [replace(one, landmarks={}).isomorphic(real) for one in maps]
    return f"{len(maps)} optimal map, the truth: {any(same)}"


def tasks(folder: Path) -> Iterator[Task]:
    """What is measured; files are written into the folder."""
    made = instance(grid(4, 4), "snake")
    truth = folder / "truth.json"
    at = [[step, *dstate] for step, dstate in enumerate(made.truth)]
    truth.write_text(json.dumps({"maps": [{"at": at}], "complete": True}))
    misread = folder / "misread.lp"
    corrupted = made.experience.corrected([(20, 2)])
    misread.write_text(corrupted.facts())

    yield Task(
        f"ask {SNAKE} same(3,12) 'places < 12' planar 'not same(5,9)' --planar --bound 16",
        lambda answer: ", ".join(one["holds"] for one in answer["statements"]),
        asked,
    )
    yield Task(
        f"explain {SNAKE} same(13,17) --planar --bound 16",
        lambda answer: f"{answer['verdict']}, minimal: {answer['minimal']}",
        lambda: (
            "impossible, minimal: True"
            if held([at[13][0] == at[17][0] for at in maps(("planar",), 16)]) == "none"
            else "not so"
        ),
    )
    yield Task(
        f"explore {SNAKE} --among optimal --among {truth}",
        lambda answer: f"{len(answer['turns'])} travels, {answer['left']} of 3 left",
        lambda: "{1} travels, {0} of 3 left".format(*walks.best(in_question(made))[0]),
    )
    yield Task(
        f"explore {SNAKE} --among optimal --among {truth} --marker",
        lambda answer: f"{answer['left']} of 3 left",
        lambda: f"{walks.best(in_question(made), carried=True)[0][0]} of 3 left",
    )
    yield Task(
        f"solve {misread} --noise 1 --closed --planar --perpendicular",
        lambda answer: f"the real map only: {[one['at'] for one in answer['maps']] == [at]}",
        lambda: "the real map only: True",
    )
    walked = folder / "walked.lp"
    yield Task(
        f"simulate grid 4 4 --signs 0.3 --instance {walked}",
        lambda answer: f"{answer['best_maps']} optimal map, the truth: {answer['truth']}",
        lambda: settled(walked),
    )


def main() -> int:
    wrong = False
    lines = []
    with tempfile.TemporaryDirectory() as name:
        for task in tasks(Path(name)):
            call = [sys.executable, "-m", "topomap", *shlex.split(task.call), "--json"]
            seconds, told = [], ""
            for _ in range(TIMES):
                begun = time.perf_counter()
                done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True)
                seconds.append(time.perf_counter() - begun)
                if not done.stdout:
                    raise RuntimeError(f"{task.call}: {done.stderr}")
                told = task.told(json.loads(done.stdout))
            right = task.right()
            wrong |= told != right
            answer = told if told == right else f"**WRONG**: {told}; it is {right}"
            shown = task.call.replace(f"{name}/", "")
            lines.append(f"| `{shown}` | {answer} | {statistics.median(seconds):.2f} |\n")
            print(lines[-1], end="", flush=True)
    with output(str(ROOT / "docs/asking.md")) as out:
        out.write(HEAD.format(times=TIMES) + "".join(lines))
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
