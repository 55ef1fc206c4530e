"""What a step costs a follower, and what the same answers cost from scratch.

    cd tests && python -m bench.online

Writes docs/online.md. Exit status: 0 all is measured and the same, 1 the answers differ, 2 bad
usage. At each step the number of hypotheses and the best maps of both are compared.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from topomap.model.experience import Experience, Step
from topomap.model.facts import read
from topomap.model.query import Query
from topomap.runtime.files import output
from topomap.runtime.watch import Stopped, Watch
from topomap.solver import online, programs, solving
from topomap.solver.online import OnlineSolver

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

Written by `python -m bench.online` in `tests/`. A step *online* is `OnlineSolver.step` and
`OnlineSolver.status`: what is new is ground, then the number of hypotheses (up to
{online.MOST_COUNTED:,}; of
more it says so), the best maps, and what is certain. *From scratch* the experience up to that
step is ground and counted, then ground again for the best maps, as `topomap count` and `solve
--optimal` do; what is certain is not asked for. *Rules* are ground rules: those that the step
added, and those of the count from scratch. Seconds are those of the processor, without the
start of Python. The number of hypotheses and the best maps are compared at each step, and are
the same.
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
            follower = OnlineSolver(experience.slots, first, planar, places)
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


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench.online", description=__doc__.partition("\n")[0])
    parser.add_argument("--limit", type=float, default=60, help="seconds for a step from scratch")
    parser.add_argument("-o", "--output", default=str(ROOT / "docs/online.md"))
    args = parser.parse_args()
    tables = []
    for run in RUNS:
        try:
            steps = list(measured(*run, args.limit))
        except RuntimeError as error:
            print(error, file=sys.stderr)
            return 1
        tables.append(table(run, steps))
        print(tables[-1].strip().splitlines()[2], flush=True)
    with output(args.output) as out:
        out.write(HEAD + "".join(tables))
    return 0


if __name__ == "__main__":
    sys.exit(main())
