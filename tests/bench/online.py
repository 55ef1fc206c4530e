"""What a step costs a follower, and what the same answers cost from scratch.

    cd tests && python -m bench.online

Writes docs/online.md. Exit status: 0 all is measured and the same, 1 the answers differ, 2 bad
usage. At each step the number of hypotheses and the best maps of both are compared.
"""

import argparse
import multiprocessing
import resource
import statistics
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from topomap.model.experience import Experience, Step
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.questions.follow import Following
from topomap.questions.records import Record
from topomap.runtime.files import output
from topomap.runtime.limits import MOST_COUNTED
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import online, programs, solving
from topomap.solver.online import OnlineSolver
from topomap.solver.stepwise import Asked
from topomap.worlds.environment import grid
from topomap.worlds.instance import instance
from topomap.worlds.senses import Senses

ROOT = Path(__file__).resolve().parents[2]
RUNS = [
    ("grid-3x3-snake", False, None),
    ("grid-3x3-snake", True, None),
    ("grid-3x4-paper", False, None),
    ("grid-3x4-paper", True, None),
    ("grid-4x4-snake", False, 16),
    ("grid-4x4-snake", True, 16),
    ("manhattan-tour40-signs30", True, None),
]
HEAD = f"""# A step of `topomap follow`

This page is written by `python -m bench.online` in `tests/`. A step *online* calls
`OnlineSolver.step` and `OnlineSolver.status`: each hypothesis is extended by the step, or what is
new is grounded; then the hypotheses are counted (up to {MOST_COUNTED:,}; a larger number is shown
as `> {MOST_COUNTED:,}`), and the best maps and what is certain are found. *From scratch*, the
experience up to that step is grounded and counted, and then grounded again for the best maps, as
`topomap count` and `solve --optimal` do; what is certain is not asked for. *Rules* are ground
rules: those that the step added (0 where clingo was not asked), and those of the count from
scratch. Seconds are processor time, without the start of Python. The number of hypotheses and the
best maps are compared at each step, and are the same.
"""


@dataclass(frozen=True)
class Measured:
    """One step."""

    step: int
    told: str
    online: float
    scratch: float
    rules: int
    rules_scratch: int


def from_scratch(
    experience: Experience, query: Query, seconds: float
) -> tuple[int, list[online.DState], int]:
    """The number of hypotheses, the best maps, and the ground rules of the count."""
    programs.forget()
    watch = Watch(seconds)
    number, _ = solving.count(experience, query, watch=watch, grown=False)
    program = solving._last.program
    rules = int(program.control.statistics["problem"]["lp"]["rules"]) if program else 0
    programs.forget()
    best = [one.at for one in solving.best(experience, query, watch) if one and one.proved]
    return number, sorted(best), rules


def measured(name: str, planar: bool, places: int | None, limit: float) -> Iterator[Measured]:
    """Each step, until one takes too long from scratch. Raises RuntimeError where the two
    differ."""
    experience = read(ROOT / f"instances/{name}.lp")
    query = Query(frozenset(["planar"] if planar else ()), places)
    rules = 0
    follower = None
    for step in range(experience.steps + 1):
        begun = time.process_time()
        if follower:
            view, landmarks = experience.views[step], experience.landmarks[step]
            follower.step(Step(experience.turns[step - 1], view, landmarks))
        else:
            first = Step(None, experience.views[0], experience.landmarks[0])
            follower = OnlineSolver(experience.slots, first, Asked(planar, places))
        status = follower.status(Watch())
        done = time.process_time()
        try:
            number, best, scratch = from_scratch(experience.cut(step), query, limit)
        except Stopped:
            return
        end = time.process_time()
        same = status.hypotheses == number if status.exact else status.hypotheses < number
        if not same or (status.all_best and list(status.best) != best):
            raise RuntimeError(f"{name}, step {step}: the answers differ")
        told = f"{status.hypotheses:,}" if status.exact else f"> {status.hypotheses:,}"
        yield Measured(step, told, done - begun, end - done, follower.rules - rules, scratch)
        rules = follower.rules


def table(run: tuple[str, bool, int | None], steps: list[Measured]) -> str:
    """The steps of one run."""
    name, planar, places = run
    title = name + (", planar" if planar else "") + (f", at most {places} places" * bool(places))
    both = [sum(one.online for one in steps), sum(one.scratch for one in steps)]
    lines = [
        f"\n## {title}\n",
        f"All {len(steps)} steps: {both[0]:.2f} s online, {both[1]:.2f} s from scratch, "
        f"{both[1] / both[0]:.1f} times as long.\n",
        "| step | hypotheses | online s | scratch s | ratio | rules added | rules from scratch |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {one.step} | {one.told} | {one.online:.3f} | {one.scratch:.3f} "
        f"| {one.scratch / one.online:.1f} | {one.rules:,} | {one.rules_scratch:,} |"
        for one in steps
    ]
    return "\n".join(lines) + "\n"


# Random walks through grids: the side, the steps, whether each place has a landmark of its own, and
# whether there are a compass and facts that say which earlier place each place is; planar; the most
# places.
LONG = [
    (12, 2000, True, True, False, None),
    (12, 2000, True, False, False, None),
    (4, 240, False, False, True, 16),
]


def long_walk(
    side: int, steps: int, signed: bool, known: bool, planar: bool, bound: int | None
) -> str:
    """What a step of a long walk takes, and how much memory, early and at the end: a row."""
    made = instance(
        grid(side, side),
        "walk",
        steps=steps,
        signs=float(signed),
        seed=1,
        senses=Senses(compass=known),
    )
    record = Record(one_log=planar)
    following = Following(planar, bound)
    seconds, memory, answer = [], [], None
    first: dict[frozenset[str], int] = {}
    for number, line in enumerate(filter(None, made.experience.facts().splitlines())):
        step = number - 1
        text = line
        if known and step >= 0:
            place = made.experience.landmarks[step]
            text += f" same({first.setdefault(place, step)},{step})."
        begun = time.process_time()
        record = record.with_line(text, "walk", number)
        for _ in following.take(record):
            answer = following.answer(Watch())
            "\n".join(answer.lines(0.0))
            seconds.append(time.process_time() - begun)
            memory.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    assert answer is not None
    early, late = (1000 * statistics.median(of) for of in (seconds[150:200], seconds[-50:]))
    status = answer.status
    told = "not counted" if status.hypotheses is None else f"{status.hypotheses:,}"
    told = told if status.exact or status.hypotheses is None else f"> {told}"
    name = f"{side}x{side}" + ", signed" * signed + ", places known" * known + ", planar" * planar
    name += f", at most {bound} places" * bool(bound)
    cells = [name, f"{len(seconds) - 1:,}", told, status.fault or "no"]
    cells += [f"{early:.1f}", f"{late:.1f}", f"{late / early:.2f}"]
    cells += [f"{memory[200]:.0f}", f"{memory[-1]:.0f}", f"{memory[-1] / memory[200]:.2f}"]
    return f"| {' | '.join(cells)} | {max(seconds):.1f} |\n"


LONG_HEAD = """
## Long walks

These are random walks through grids. In a *signed* grid each place has a landmark of its own. The
theory does not assume that two visits with the same landmark are to the same place, so hypotheses
multiply. Where *places are known*, each step has a compass, and a fact `same(T,U)` that names the
first visit to its place; then one hypothesis is left. *Partial* gives the reason if the answer at
the end is partial: then only some hypotheses are kept. The time of a step covers reading a line,
finding the new hypotheses, the answer and its text. Milliseconds are medians: *early* of the steps
from 150 to 199, *late* of the last fifty. Memory is the most that was in use: *early* up to step
200, *late* up to the end. The last column is the longest step.

| walk | steps | hypotheses | partial | ms early | late | ratio | MB early | late | ratio | s |
|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|
"""


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.online", description=__doc__.partition("\n")[0])
    parser.add_argument("--limit", type=float, default=60, help="seconds for a step from scratch")
    parser.add_argument("-o", "--output", default=str(ROOT / "docs/online.md"))
    parser.add_argument("--long", action="store_true", help="print the table of long walks alone")
    args = parser.parse_args()
    tables = []
    long = [LONG_HEAD]
    for walk in LONG:
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as alone:
            long.append(alone.submit(long_walk, *walk).result())
        print(long[-1], end="", flush=True)
    if args.long:
        return 0
    for run in RUNS:
        try:
            steps = list(measured(*run, args.limit))
        except RuntimeError as error:
            print(error, file=sys.stderr)
            return 1
        tables.append(table(run, steps))
        print(tables[-1].strip().splitlines()[2], flush=True)
    with output(args.output) as out:
        out.write(HEAD + "".join(long + tables))
    return 0


if __name__ == "__main__":
    sys.exit(main())
