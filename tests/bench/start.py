"""What the command takes to begin, beside Python with the modules that it cannot do without.

    PYTHONPATH=tests python -m bench.start

Writes docs/start.md. Exit status: 0 if each goal is met; 1 if one is missed.
"""

import os
import statistics
import subprocess
import sys
from pathlib import Path

from topomap.runtime.files import output

ROOT = Path(__file__).resolve().parents[2]
TIMES = 21
MOST = 3  # times what Python takes
PARSER, SOLVER = "import argparse", "import argparse, clingo"
CALLS = {
    "--version": PARSER,
    "--help": PARSER,
    "solve --help": PARSER,
    "solve --fly": PARSER,
    "fly": PARSER,
    "solve instances/grid-3x3-snake.lp": SOLVER,
}
HEAD = f"""# What it takes to begin

Written by `make bench` (`python -m bench.start`). Each call of `topomap` is compared with Python
that only imports what the call cannot do without. The figures are processor milliseconds of whole
processes, the median of {TIMES} runs in which the two take turns. The goal is a ratio of at
most {MOST}.

| `topomap` | ms | compared with `python -c` | ms | ratio |
| --- | --: | --- | --: | --: |
"""


def milliseconds(call: list[str]) -> float:
    """What a process takes of the processor."""
    with subprocess.Popen(
        call, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return 1000 * (used.ru_utime + used.ru_stime)


def main() -> int:
    lines, missed = [], False
    for words, beside in CALLS.items():
        command = [str(Path(sys.executable).with_name("topomap")), *words.split()]
        python = [sys.executable, "-c", beside]
        pairs = [(milliseconds(command), milliseconds(python)) for _ in range(TIMES)]
        ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
        missed |= ours > MOST * theirs
        ratio = f"{ours / theirs:.2f}" + " **missed**" * (ours > MOST * theirs)
        lines.append(f"| `{words}` | {ours:.0f} | `{beside}` | {theirs:.0f} | {ratio} |\n")
        print(lines[-1], end="", flush=True)
    with output(str(ROOT / "docs/start.md")) as out:
        out.write(HEAD + "".join(lines))
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
