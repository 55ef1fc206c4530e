"""Rows by ways: repetitions, limits, verdicts, ratios."""

import io
import json
import os
import shlex
import signal
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

from topomap.runtime.errors import InputError

from bench.rows import ROOT, Row

FIGURES = (
    *("rules", "atoms", "choices", "conflicts", "nodes"),
    *("seconds", "processor seconds", "memory"),
)
ENOUGH = 20.0  # seconds in which a way is measured again


class Wrong(Exception):
    """A way gave a wrong answer."""


@dataclass
class Plan:
    """How to measure: repetitions; seconds at most for our encodings, and for the others; MB
    at most; where the real maps and the baseline are; and the folder to work in."""

    repeat: int
    limit: float
    others: float
    memory: int
    networks: Path
    baseline: Path
    folder: Path
    slow: dict[tuple[str, str], str] = field(default_factory=dict)  # way, series: a row's name

    def seconds(self, row: Row, way: str) -> float:
        limit = self.limit if way == "work" else self.others
        return min(limit, row.cut or limit)


def baseline(of: dict[str, str], folder: Path) -> str:
    """Take the encodings of the baseline out of git; returns which revision they are of."""
    for revision in of.values():
        call = ["git", "archive", "--format=tar", revision, "encodings"]
        done = subprocess.run(call, cwd=ROOT, capture_output=True)
        if done.returncode == 0:
            with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
                archive.extractall(folder, filter="data")
            return revision
    raise LookupError(done.stderr.decode().strip().partition("\n")[0])


def measured(row: Row, plan: Plan, ways: list[str]) -> dict[str, Any]:
    """What is known of a row: a verdict, and for each way its runs and their medians."""
    result: dict[str, Any] = {
        "name": row.name,
        "ask": row.ask,
        "expected": row.expected,
        "why": row.why,
        "goal": row.goal,
        "growth": row.growth,
        "series": row.series,
        "cut": row.cut,
        "verdict": "",
        "ways": {},
    }
    files = _instance(row, plan)
    if isinstance(files, str):
        return result | {"verdict": f"skipped: {files}"}
    runs: dict[str, list[dict[str, Any]]] = {way: [] for way in ways if way in row.ways}
    try:
        for repetition in range(plan.repeat):
            for way, own in runs.items():
                if (way, row.series) in plan.slow and not (way == "work" and row.goal):
                    continue
                spent = sum(run.get("seconds", ENOUGH) for run in own)
                if not repetition or (spent < ENOUGH and "cut" not in own[-1]):
                    own.append(_run(row, way, plan, files, result))
                    if "cut" in own[-1] and row.series:
                        plan.slow[way, row.series] = row.name
    except Wrong as wrong:
        result["verdict"] = f"WRONG: {wrong}"
    for way, own in runs.items():
        result["ways"][way] = _medians(own) if own else {"cut": plan.slow.get((way, row.series))}
    numbers = {way: of["number"] for way, of in result["ways"].items() if "number" in of}
    if not result["verdict"]:
        if row.expected is not None:
            result["verdict"] = "right" if numbers else "open"
        elif len(set(numbers.values())) > 1:
            result["verdict"] = f"WRONG: the ways differ: {numbers}"
        else:
            result["verdict"] = "agreed" if len(numbers) > 1 else "one way" if numbers else "open"
    result["number"] = next(iter(numbers.values()), None)
    result["ratios"] = {
        way: _ratio(runs[way], runs["work"])
        for way in runs
        if way != "work" and runs[way] and runs.get("work")
    }
    if not result["verdict"].startswith("WRONG"):
        result["goal met"] = {key: _met(key, most, result) for key, most in row.goal.items()}
    return result


def _instance(row: Row, plan: Plan) -> tuple[str, str] | str:
    """The files of a row's instance and of its real map, or why there are none."""
    if not row.generate:
        return "", ""
    words = shlex.split(row.generate.replace("{networks}", shlex.quote(str(plan.networks))))
    if words[0] == "network" and not Path(words[1]).is_file():
        return f"{Path(words[1]).name} is not there"
    instance, truth = (str(plan.folder / name) for name in ("instance.lp", "truth.json"))
    call = [sys.executable, "-m", "topomap", "generate", *words, "-o", instance, "--truth", truth]
    done = subprocess.run(call, capture_output=True, text=True)
    if done.returncode:
        raise InputError(f"{row.name}: {done.stderr.strip()}")
    return instance, truth


def _run(
    row: Row, way: str, plan: Plan, files: tuple[str, str], result: dict[str, Any]
) -> dict[str, Any]:
    """One measurement. Raises Wrong on a wrong answer."""
    limit = plan.seconds(row, way)
    task = {
        "way": way,
        "ask": row.ask,
        "instance": files[0],
        "truth": files[1],
        "parts": row.parts,
        "places": row.places,
        "baseline": str(plan.baseline),
        "memory": plan.memory,
        "limit": limit,
    }
    with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as out:
        given.write(json.dumps(task).encode())
        given.seek(0)
        call = [sys.executable, "-m", "bench.task"]
        folder = Path(__file__).resolve().parents[1]
        process = subprocess.Popen(call, stdin=given, stdout=out, cwd=folder)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:
            process.kill()
            process.wait()
            raise
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        lines = [json.loads(line) for line in out.read().splitlines()]
    if lines:
        result["about"] = lines[0]
    if process.returncode == -signal.SIGALRM:
        return {"cut": "time", "limit": limit, "memory": usage.ru_maxrss / 1024}
    if process.returncode in (-signal.SIGABRT, -signal.SIGKILL):
        lines.append({"cut": "memory"})  # C++ could not even say so, or the system ended it
    elif process.returncode or len(lines) < 2:
        raise Wrong(f"{way} failed, status {process.returncode}")
    answer: dict[str, Any] = lines[1]
    if answer.get("cut"):
        return {"cut": "memory", "limit": limit, "memory": usage.ru_maxrss / 1024}
    if row.expected not in (None, answer["number"]):
        raise Wrong(f"{way} has {answer['number']:,}, expected are {row.expected:,}")
    if answer["faults"]:
        raise Wrong(f"{way}: {answer['faults'][0]}")
    return answer


def _medians(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """The medians of a way's runs, and the runs; where one was cut, why, and no more."""
    cut = [run for run in runs if "cut" in run]
    if cut:
        return {**cut[0], "runs": runs}
    figures = {key: median(run[key] for run in runs) for key in FIGURES if key in runs[0]}
    return {"number": runs[0]["number"], **figures, "runs": runs}


def _ratio(runs: list[dict[str, Any]], ours: list[dict[str, Any]]) -> dict[str, Any] | None:
    """How many times as long as our encodings a way takes: the median over the repetitions,
    exact or, where one of the two was cut by time, a bound."""
    cuts = [any("cut" in run for run in own) for own in (runs, ours)]
    if all(cuts) or any(run.get("cut") == "memory" for run in (*runs, *ours)):
        return None
    times = [
        run.get("seconds", run.get("limit")) / other.get("seconds", other.get("limit"))
        for run, other in zip(runs, ours, strict=False)
    ]
    return {"value": median(times), "is": ">" if cuts[0] else "<" if cuts[1] else "="}


def _met(key: str, most: Any, result: dict[str, Any]) -> float | bool | None:
    """A figure of our encodings by the goal, so that 1 or less is met; whether it is solved;
    None where it is not known."""
    ours = result["ways"].get("work", {})
    if key == "solved":
        return "number" in ours
    return ours[key] / most if key in ours and "cut" not in ours else None


def rows(chosen: list[Row], plan: Plan, ways: list[str]) -> Iterator[dict[str, Any]]:
    """What is known of each row, as soon as it is measured."""
    for row in chosen:
        yield measured(row, plan, ways)
