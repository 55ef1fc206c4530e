"""The command: measures the rows, writes results/bench.json, docs/benchmark.md and the picture.

Exit status: 0 all is measured and right; 1 an answer is wrong, or the memory grows; 2 bad input
or usage; 130 interrupted, and what was measured is kept as partial.
"""

import argparse
import json
import os
import platform
import re
import signal
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

from topomap.runtime.errors import InputError, say
from topomap.runtime.files import output
from topomap.runtime.status import BAD_INPUT, DONE, INTERRUPTED, NO

from bench import growth, jobs, measure, memory, report, rows
from bench.rows import ROOT, WAYS

MAPS = 1_000_000


def machine() -> dict[str, str]:
    """What it is measured on."""
    try:
        found = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
        pages = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        found, pages = None, 0
    return {
        "processor": f"{found[1] if found else platform.machine()}, {os.cpu_count()} cores",
        "memory": f"{pages / 2**30:.0f} GiB",
        "system": f"{platform.system()} {platform.release()}",
        "load at the start": f"{os.getloadavg()[0]:.1f}",
        "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime()),
    }


def versions() -> dict[str, str]:
    """What is measured."""

    def git(*words: str) -> str:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
        return done.stdout.strip()

    changed = ", with changes" if git("status", "--porcelain", "encodings", "scripts") else ""
    return {
        "topomap": f"{version('topomap-asp')} at {git('rev-parse', '--short=10', 'HEAD')}{changed}",
        "clingo": version("clingo"),
        "Python": platform.python_version(),
    }


def _number(kind: type, least: float) -> Any:
    def number(text: str) -> Any:
        try:
            value = kind(text)
        except ValueError:
            value = least - 1
        if not value >= least:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number, {least:g} or more")
        return value

    return number


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="bench", description=__doc__.partition("\n")[0])
    add = parser.add_argument
    add("--repeat", type=_number(int, 1), default=3, help="repetitions (default: %(default)s)")
    add("--limit", type=_number(float, 0.001), default=120, help="seconds for our encodings")
    add("--others", type=_number(float, 0.001), help="for the others (default: a third of that)")
    add("--memory", type=_number(int, 0), default=8192, help="MB for a run, 0: no limit")
    add("--only", metavar="PATTERN", help="rows whose name matches; no report")
    add("--again", metavar="PATTERN", help="measure such rows, --jobs, --maps into what there is")
    add("--quick", action="store_true", help="the smallest rows, once; no report")
    add("--large", action="store_true", help="larger rows too")
    add("--maps", type=_number(int, 0), help=f"maps to a file, 0: none (default: {MAPS:,})")
    add(
        "--jobs",
        type=_number(int, 0),
        default=os.cpu_count(),
        help="processes beside one, where all is measured; 0: do not (default: %(default)s)",
    )
    add("--networks", type=Path, default=ROOT.parent / "shared/maps", help="the real maps' folder")
    add("--rows", type=Path, default=rows.ROWS, help="the tasks")
    add(
        "--json",
        help="the file of all figures (default: in results/, bench.json if all is measured)",
    )
    add("--docs", type=Path, help="the report's folder (default: docs, if all is measured)")
    return parser.parse_args(argv)


def main(argv: list[str] | None = None) -> int:
    try:
        args = parse(argv)
        return run(args)
    except InputError as error:
        say(f"bench: {error}")
        return BAD_INPUT


def run(args: argparse.Namespace) -> int:
    """Measure what is asked, and write it down row by row."""
    try:
        of, everything = rows.read(args.rows)
        pattern = re.compile(args.again or args.only or "")
    except (OSError, ValueError, TypeError, KeyError, AssertionError) as error:
        raise InputError(f"{args.rows}: {error!r}") from None
    chosen = [
        row
        for row in everything
        if pattern.search(row.name) and (args.large or not row.large) and row.quick >= args.quick
    ]
    if not chosen:
        raise InputError("no row has such a name")
    whole = not (args.only or args.quick) and args.rows == rows.ROWS
    file = args.json or str(ROOT / f"results/bench{'' if whole else '-selection'}.json")
    maps = args.maps if args.maps is not None else MAPS * (whole and not args.again)
    docs = args.docs or (ROOT / "docs" if whole else None)
    with tempfile.TemporaryDirectory() as folder:
        try:
            revision = measure.baseline(of, Path(folder))
        except (LookupError, OSError) as error:
            raise InputError(f"the baseline, {' or '.join(of.values())}: {error}") from None
        plan = measure.Plan(
            1 if args.quick else args.repeat,
            args.limit,
            args.others or args.limit / 3,
            args.memory,
            args.networks.resolve(),
            Path(folder) / "encodings",
            Path(folder),
        )
        ways = [*WAYS]
        document: dict[str, Any] = {
            "complete": False,
            "fault": None,
            "selection": {"only": args.only, "quick": args.quick, "large": args.large},
            "machine": machine(),
            "versions": versions(),
            "baseline": revision,
            "plan": {
                "repeat": plan.repeat,
                "limit": plan.limit,
                "others": plan.others,
                "memory": plan.memory,
                "enough": measure.ENOUGH,
            },
            "rows": [],
            "growth": [],
            "memory": None,
            "jobs": [],
            "again": [],
        }
        if args.again:
            new, document = document, _known(file)
            again = [row.name for row in chosen]
            about = {key: new[key] for key in ("machine", "versions")}
            also = {"limit": plan.limit, "maps": maps, "jobs": args.jobs * whole}
            document["again"].append(about | {"rows": again} | also)
        begun = time.monotonic()
        try:
            for row in measure.rows(chosen, plan, ways):
                names = [known["name"] for known in document["rows"]]
                place = names.index(row["name"]) if row["name"] in names else len(names)
                document["rows"][place : place + 1] = [row]
                document["growth"] = growth.curves(document["rows"])
                _write(document, file)
                print(report.short(row), flush=True)
            if maps:
                document["memory"] = memory.profile(maps)
                print(report.memory(document["memory"]), end="", flush=True)
            if args.jobs and whole:
                document["jobs"] = jobs.speedup(args.jobs)
                print(report.jobs(document["jobs"]), end="", flush=True)
            document["complete"] = True
        except KeyboardInterrupt:
            document["fault"] = "interrupted"
        seconds = round(time.monotonic() - begun)
        document["seconds"] = document.get("seconds", 0) + seconds
        _write(document, file)
    if document["fault"]:
        print(f"partial: {document['fault']}, {len(document['rows'])} of {len(chosen)} rows")
        return INTERRUPTED
    if docs:
        growth.draw(document["growth"], docs / "figures/scaling.svg")
        with output(str(docs / "benchmark.md"), parents=True) as out:
            out.write(report.text(document, "figures/scaling.svg"))
    wrong = [row for row in document["rows"] if row["verdict"].startswith("WRONG")]
    print(f"{len(chosen)} rows in {seconds} s, {len(wrong) or 'none'} wrong")
    grows = document["memory"] is not None and not document["memory"]["flat"]
    differ = not all(row["same"] for row in document["jobs"])
    return NO if wrong or grows or differ else DONE


def _known(path: str) -> dict[str, Any]:
    """What was measured before. Raises InputError if there is nothing of the kind."""
    try:
        document = json.loads(Path(path).read_text(encoding="utf-8"))
        if document["complete"]:
            return {"again": [], "jobs": [], **document}
    except (OSError, ValueError, KeyError, TypeError):
        pass
    raise InputError(f"{path}: --again: not the figures of a whole run")


def _write(document: dict[str, Any], path: str) -> None:
    with output(path, parents=True) as file:
        json.dump(document, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(main())
