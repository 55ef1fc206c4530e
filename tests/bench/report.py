"""Tables for the terminal and for docs/benchmark.md."""

import textwrap
import tomllib
from pathlib import Path
from typing import Any

from bench.growth import AXES, LEAST
from bench.measure import FIGURES

REFERENCE = Path(__file__).with_name("reference.toml")
HEAD = """# Benchmark

Written by `make bench`; the figures are also in `results/bench.json`. `tests/bench/rows.toml`
lists the tasks.
"""
HOW = """
Each measurement is a process of its own, on one core: Python, the package, and clingo with its
default options, except for what `phases.py` asks of it. `baseline` is `encodings/` at the git
revision `{revision}`, `work` is `encodings/` as it is now, `search` is the package's depth-first
search, in Python, which looks ahead. If a row is solved by several programs, their figures are
added up. Seconds are those from the facts to the last answer, without the start of Python; memory
is the most that the process used{start}. In each repetition the ways take turns, so that ratios
compare figures of one run; the figures given are medians. A way is measured {repeat} times at
most, and is measured again only if it has taken less than {enough:g} s so far. Our encodings are
cut after {limit:g} s, the others after {others:g} s, and all at {memory:,} MB; growth rows have
limits of their own. For a way that was cut, a lower bound is given. A way that was cut is not
tried at the harder rows of the same kind; our encodings are, where there is a goal. A row counts
only if each way that ended gave the expected answer: the number of maps is right, the real map is
among them where all are listed, and no map is given twice. A row in which an answer is wrong, or
in which the ways differ, is marked WRONG, and has no figures.
"""


def number(value: float | None, digits: int = 3) -> str:
    """A number to read: whole where it is large."""
    if value is None:
        return "-"
    if value == 0 or value >= 100 or value == int(value):
        return f"{value:,.0f}"
    return f"{value:.{digits}g}"


def ended(of: dict[str, Any] | None, key: str = "seconds") -> str:
    """A figure of a way, or why there is none."""
    if of is None:
        return ""
    if "runs" not in of:
        return "not tried" if of.get("cut") else "-"
    if "cut" not in of:
        return number(of.get(key))
    if key == "memory":
        return f"> {number(of['memory'])}"
    if key != "seconds":
        return "-"
    return f"> {of['limit']:g}" if of["cut"] == "time" else "no memory left"


def ratio(row: dict[str, Any], way: str) -> str:
    """How many times as long as our encodings a way takes."""
    known = row.get("ratios", {}).get(way)
    if not known:
        return ""
    sign = {"=": "", ">": "> ", "<": "< "}[known["is"]]
    return f"{sign}{number(known['value'], 2)}"


def goal(row: dict[str, Any]) -> str:
    """The goals of a row, and whether they are met or by how much they are missed."""
    texts = []
    for key, most in row["goal"].items():
        met = row.get("goal met", {}).get(key)
        wanted = "solved" if key == "solved" else f"{number(most)} {key.replace('seconds', 's')}"
        if met is True or (met is not False and met is not None and met <= 1):
            texts.append(f"{wanted}: met")
        elif met is False or met is None:
            texts.append(f"{wanted}: **not met**")
        else:
            texts.append(f"{wanted}: **missed** by a factor of {met:.3g}")
    return "; ".join(texts)


def answer(row: dict[str, Any]) -> str:
    """A row's answer, and how far it is known to be right."""
    verdict = row["verdict"]
    if verdict.startswith(("WRONG", "skipped")):
        return f"**{verdict}**"
    if verdict == "open":
        return "no answer"
    if row["ask"] in ("table", "command"):
        return "every figure"
    known = {"right": "", "agreed": " (the ways agree)", "one way": " (by one way)"}[verdict]
    if row["ask"] == "maps":
        known = ", the real one" + " among them" * (row["number"] > 1) + known
    return f"{row['number']:,}{known}"


def reference() -> dict[str, Any]:
    """Figures of others for the same tasks."""
    return tomllib.loads(REFERENCE.read_text(encoding="utf-8"))


def table(head: list[str], lines: list[list[str]], left: int = 1) -> str:
    marks = ["---" if column < left else "--:" for column in range(len(head))]
    return "\n".join(f"| {' | '.join(line)} |" for line in [head, marks, *lines]) + "\n"


def short(row: dict[str, Any]) -> str:
    """A row as a line for the terminal."""
    ways = ", ".join(f"{way} {ended(of)}" for way, of in row["ways"].items())
    return (
        f"{row['name']}: {answer(row).strip('*')}; seconds: {ways or 'none'}; {goal(row)}".rstrip(
            "; "
        )
    )


def _results(rows: list[dict[str, Any]]) -> str:
    head = ["task", "maps", "rules", "choices", "conflicts", "s", "MB", "search s", "baseline s"]
    head += ["search : work", "baseline : work", "goal"]
    lines = []
    for row in rows:
        ours = row["ways"].get("work")
        keys = ("rules", "choices", "conflicts", "seconds", "memory")
        wrong = row["verdict"].startswith("WRONG")
        figures = [*(ended(ours, key) for key in keys)]
        figures += [ended(row["ways"].get(way)) for way in ("search", "baseline")]
        figures += [ratio(row, way) for way in ("search", "baseline")]
        line = [row["name"], answer(row), *([""] * 9 if wrong else figures), goal(row)]
        lines.append(line)
    return table(head, lines)


def _reference(rows: list[dict[str, Any]]) -> str:
    others = reference()
    lines = []
    for row in rows:
        if row["name"] in others["rows"]:
            ours = row["ways"].get("work", {})
            told = ended(ours)
            if ours.get("runs"):
                told += " s"
            if "rules" in ours:
                told += f", {number(ours['rules'])} rules, {number(ours['conflicts'])} conflicts"
            if row["verdict"].startswith(("WRONG", "skipped")):
                told = row["verdict"].partition(":")[0]
            lines.append([row["name"], *others["rows"][row["name"]], told])
    head = ["task", *others["columns"], "our encodings"]
    return f"{others['source']}\n\n" + table(head, lines, 5)


def _sources(rows: list[dict[str, Any]]) -> str:
    tasks: dict[str, list[str]] = {}
    for row in rows:
        if row["why"]:
            tasks.setdefault(row["why"], []).append(f"{row['name']}: {row['expected']:,}")
    return "".join(f"- {why[0].upper()}{why[1:]}. {'; '.join(of)}.\n" for why, of in tasks.items())


def _growth(found: list[dict[str, Any]], picture: str) -> str:
    lines = []
    for curve in found:
        known = "exponent" in curve
        lines.append(
            [
                curve["series"],
                f"{curve['figure']} by {AXES[curve['x']]}",
                curve["way"],
                f"{curve['exponent']:.2f}" if known else "-",
                f"{curve['explained']:.3f}" if known else "-",
                f"{curve['from']:.0f} to {curve['to']:.0f}" if known else "-",
                str(curve["fitted"]),
            ]
        )
    head = ["series", "figure", "way", "exponent", "R²", "fitted from", "points"]
    least = [f"{number(value)} {figure}" for figure, value in LEAST.items() if value != 1]
    least_of_all = f"{', '.join(least[:-1])} or {least[-1]}"
    return (
        f"![rules, conflicts and seconds as tasks grow]({picture})\n\n"
        "Exponents are those of y = a x^exponent, fitted by least squares of the logarithms to "
        f"the points with at least {least_of_all}. A triangle is a run that the time limit cut.\n\n"
        + table(head, lines, 3)
    )


def _all(rows: list[dict[str, Any]]) -> str:
    lines = []
    for row in rows:
        if row["verdict"].startswith("WRONG"):
            lines.append([row["name"], answer(row), *[""] * 10])
            continue
        for number_of_way, (way, of) in enumerate(row["ways"].items()):
            first = [row["name"], str(row.get("about", {}).get("steps", ""))]
            figures = [ended(of, key) if key in of or key == "seconds" else "-" for key in FIGURES]
            lines.append(
                [
                    *(["", ""] if number_of_way else first),
                    way,
                    *figures,
                    str(len(of.get("runs", ()))),
                ]
            )
    head = ["task", "steps", "way", "rules", "atoms", "choices", "conflicts", "nodes"]
    head += ["s", "of the processor", "MB"]
    return table([*head, "runs"], lines)


def text(document: dict[str, Any], picture: str) -> str:
    """The whole report."""
    rows, machine = document["rows"], document["machine"]
    starts = [
        run["memory before"]
        for row in rows
        for of in row["ways"].values()
        for run in of.get("runs", ())
        if "memory before" in run
    ]
    start = f", of which Python and the package are {number(min(starts))} MB" if starts else ""
    how = HOW.format(**document["plan"], revision=document["baseline"], start=start)
    how = "\n" + textwrap.fill(how.strip(), 98, break_on_hyphens=False) + "\n"
    parts = [
        HEAD,
        table(
            ["machine", ""],
            [[key, f"{value}"] for key, value in (machine | document["versions"]).items()],
            2,
        ),
        how,
        *map(_again, document["again"]),
        "## What our encodings take\n",
        _results([row for row in rows if row["cut"] is None]),
        "## Compared with a trial\n",
        _reference(rows),
        "## Growth\n",
        _growth(document["growth"], picture),
        "## Very many maps to a file\n" if document["memory"] else "",
        memory(document["memory"]) if document["memory"] else "",
        "## More processes\n" if document["jobs"] else "",
        jobs(document["jobs"]) if document["jobs"] else "",
        "## Every figure\n",
        _all(rows),
        "## Where the expected numbers come from\n",
        _sources(rows),
    ]
    return "\n".join(part for part in parts if part)


def _again(made: dict[str, Any]) -> str:
    """A later run for some rows."""
    date, load = (made["machine"][key] for key in ("date", "load at the start"))
    also = ["; and what more processes gain"] if made.get("jobs", True) else []
    also += [f"; and {made['maps']:,} maps to a file"] if made.get("maps") else []
    return (
        f"Measured again on {date}, at a load of {load}, cut after {made['limit']:g} s, "
        f"with topomap {made['versions']['topomap']}: {'; '.join(made['rows'])}{''.join(also)}.\n"
    )


def memory(found: dict[str, Any]) -> str:
    tenths = [f"{mb:.0f}" for mb in found["tenths"]]
    flat = "The memory does not grow." if found["flat"] else "**The memory grows.**"
    return (
        f"`topomap solve --output` of {found['maps']:,} maps of the 5x4 grid, with at most 20 "
        f"places, takes {number(found['seconds'])} s. The most memory used, in MB, until each "
        "tenth of the file was "
        f"written: {', '.join(tenths)}. {flat}\n"
    )


def jobs(rows: list[dict[str, Any]]) -> str:
    lines = [
        [
            row["task"],
            number(row["nodes"]),
            number(row["alone"]),
            number(row["shared"]),
            f"{row['ratio']:.2f}" if row["same"] else "**WRONG: the figures differ**",
        ]
        for row in rows
    ]
    head = ["task", "nodes of the tree", "s, one process", f"s, {rows[0]['jobs']} processes"]
    return table([*head, "ratio"], lines)
