"""What each subcommand of ``topomap`` does, and the exit status it ends with."""

import argparse
import contextlib
import json
import shlex
from pathlib import Path
from typing import Any

from topomap import environment, figure4, network
from topomap.errors import DONE, INTERRUPTED, NO, PARTIAL, InputError, say
from topomap.experience import Experience, read
from topomap.family import expand
from topomap.files import output, text
from topomap.generate import Instance, instance
from topomap.report import Report
from topomap.solver import INTERRUPT, PARTS, Query, Stopped, Watch, best, hypotheses
from topomap.statistics import KEYS, tree
from topomap.topology import TopologicalMap


def generate(args: argparse.Namespace) -> int:
    """Explore an environment and write the instance."""
    made = _instance(args)
    target = args.output
    if target and (target.endswith("/") or Path(target).is_dir()):
        target = str(Path(target) / f"{made.name}.lp")
    if target and args.truth and Path(target).resolve() == Path(args.truth).resolve():
        raise InputError(f"{target}: it cannot be both --output and --truth")
    with contextlib.ExitStack() as files:
        if args.truth:
            at = [[step, *dstate] for step, dstate in enumerate(made.truth)]
            truth = json.dumps({"maps": [{"at": at}], "complete": True})
            files.enter_context(output(args.truth)).write(truth + "\n")
        if target or not args.json:
            files.enter_context(output(target)).write(made.text())
    if args.json:
        summary = {
            "name": made.name,
            "file": target,
            "header": made.header,
            "steps": made.experience.steps,
            "facts": None if target else made.experience.facts(),
            "complete": True,
        }
        print(json.dumps(summary))
    return DONE


def _instance(args: argparse.Namespace) -> Instance:
    if args.kind == "network":
        world, warnings = network.load(args.file, args.slots, args.north)
        for warning in warnings:
            say(f"warning: {warning}")
    elif args.rows * args.columns > environment.MOST_PLACES:
        size = f"{args.rows} x {args.columns}"
        raise InputError(f"topomap generate: {size}: more than {environment.MOST_PLACES} places")
    elif args.kind == "maze":
        world = environment.maze(args.rows, args.columns, args.thin, args.seed or 0)
    elif args.kind in ("hexagons", "triangles"):
        world = environment.lattice(args.kind, args.rows, args.columns)
    else:
        world = environment.grid(args.rows, args.columns, args.kind)
    if args.route == "walk" and args.steps is None:
        raise InputError("topomap generate: --route walk needs --steps")
    return instance(
        world,
        args.route,
        steps=args.steps,
        start=args.start,
        facing=args.facing,
        signs=args.signs,
        seed=args.seed,
        name=args.name,
    )


def _query(args: argparse.Namespace) -> Query:
    parts = frozenset(part for part in PARTS if getattr(args, part, False))
    return Query(parts, args.bound, args.horizon)


def solve(args: argparse.Namespace) -> int:
    """Enumerate the maps of each instance."""
    inputs = []
    for path in args.instance:
        experience = read(path)
        truth = _truth(args.truth, experience, args.horizon) if args.truth else None
        inputs.append((path, experience, truth))
    statuses = []
    with output(args.output) as out:
        if args.json and len(inputs) > 1:
            out.write('{"results": [\n')
        for number, (path, experience, truth) in enumerate(inputs):
            if len(inputs) > 1:
                out.write(",\n" * (number > 0) if args.json else f"{path}\n")
            kind = "optimal" if args.optimal else None
            report = Report(out, path, experience, _query(args), kind, truth, args.json)
            statuses.append(_solve_one(args, experience, report))
            if statuses[-1] == INTERRUPTED:
                break
        if args.json and len(inputs) > 1:
            complete = len(statuses) == len(inputs) and max(statuses) <= NO
            out.write(f'], "complete": {json.dumps(complete)}}}\n')
    return max(statuses)


def _solve_one(args: argparse.Namespace, experience: Experience, report: Report) -> int:
    query = _query(args)
    fault, candidate = None, None
    with Watch(args.timeout) as watch:
        try:
            for found in (best if args.optimal else hypotheses)(experience, query, watch):
                if not found.proved:
                    candidate = found
                elif report.count == args.limit:
                    fault = "limit"
                    break
                else:
                    report.add(found)
        except Stopped as stopped:
            fault = str(stopped)
        if fault and candidate and not report.count:
            report.add(candidate)
        report.end(fault)
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if report.count else NO


def _truth(file: str, experience: Experience, horizon: int | None) -> TopologicalMap:
    """The real map of an experience, from a file that ``generate --truth`` wrote."""
    content = text(file)
    try:
        steps = json.loads(content)["maps"][0]["at"]
        at = tuple((place, slot) for _, place, slot in steps)
        if not all(type(number) is int for step in steps for number in step):
            raise ValueError("other than whole numbers")
    except (ValueError, LookupError, TypeError, RecursionError):
        raise InputError(f"{file}: not what generate --truth writes") from None
    if len(at) != experience.steps + 1:
        raise InputError(f"{file}: {len(at) - 1} steps, the instance has {experience.steps}")
    for step, (place, slot) in enumerate(at):
        if not 0 <= place <= step or at[place] != (place, 0):
            raise InputError(f"{file}: step {step}: there is no place {place}")
        star = {(other + slot) % experience.slots for other in experience.views[step]}
        if slot not in experience.views[place] or star != experience.views[place]:
            raise InputError(f"{file}: step {step}: what is seen is not gateway {slot} of {place}")
    truth = experience.map_of(at if horizon is None else at[: horizon + 1])
    for end, other in truth.links.items():
        if truth.links[other] != end:
            raise InputError(f"{file}: place {end[0]}: two links at gateway {end[1]}")
    return truth


def count(args: argparse.Namespace) -> int:
    """Count the search tree of an instance."""
    experience = read(args.instance)
    figures: dict[str, Any] = {}
    fault = None
    with output(args.output) as out:
        try:
            with Watch(args.timeout) as watch:
                tree(experience, _query(args), watch, figures)
        except Stopped as stopped:
            fault = str(stopped)
        if args.json:
            answer = {"instance": args.instance, **figures, "complete": not fault, "fault": fault}
            out.write(json.dumps(answer) + "\n")
        else:
            out.write("hypotheses after each step: ")
            out.write(" ".join(map(str, figures["per_step"])) + "\n")
            for key in KEYS:
                known = "not counted" if figures[key] is None else f"{figures[key]:,}"
                out.write(f"{figure4.WORDS[key]:<42}{known:>12}\n")
            if fault:
                out.write(f"partial: {fault}\n")
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if figures["final"] else NO


def table(args: argparse.Namespace) -> int:
    """Count the paper's table, print it and write it as JSON."""
    rows: list[dict[str, Any]] = []
    with output(args.output, parents=True) as file:
        try:
            for row in figure4.rows(args.jobs):
                rows = sorted([*rows, row], key=lambda row: (row["environment"], row["planarity"]))
                say(f"counted {len(rows)} of {len(figure4.COLUMNS)} columns")
        except Stopped as stopped:  # the file keeps an older, complete table
            _show_table(args, rows, complete=False)
            raise (KeyboardInterrupt if str(stopped) == INTERRUPT else MemoryError) from None
        json.dump({"complete": True, "rows": rows}, file, indent=1)
        file.write("\n")
    _show_table(args, rows, complete=True)
    return NO if any(map(figure4.differences, rows)) else DONE


def _show_table(args: argparse.Namespace, rows: list[dict[str, Any]], complete: bool) -> None:
    different = [cell for row in rows for cell in figure4.differences(row)]
    if args.json:
        print(json.dumps({"complete": complete, "rows": rows}))
        return
    if rows:
        print(figure4.text(rows))
    for cell in different:
        print(f"differs: {cell}")
    if not complete:
        print(f"partial: {len(rows)} of {len(figure4.COLUMNS)} columns")
    elif not different:
        print("Every figure is the paper's.")


def family(args: argparse.Namespace) -> int:
    """Write the call of each instance of a family where it changed, and drop what is no
    longer listed of what the last call made."""
    folder = Path(args.directory)
    calls: dict[str, list[str]] = {}
    for line, call in expand(args.file):
        try:
            with contextlib.redirect_stdout(None):
                parsed = args.parse(["generate", *call])
            if parsed.output or parsed.truth or parsed.json:
                raise InputError("-o, --truth and --json have no place in a family")
            made = _instance(parsed)
        except SystemExit:
            raise InputError(f"{args.file}:{line}: --help has no place in a family") from None
        except InputError as error:
            raise InputError(f"{args.file}:{line}: {error}") from None
        if made.name in calls:
            raise InputError(
                f"{args.file}:{line}: a second instance named {made.name}; --name can part them"
            )
        calls[made.name] = call
    # At any moment what was made is listed, so that a call that was cut short can be repeated.
    made_before = folder / ".family"
    old = text(made_before).splitlines() if made_before.exists() else []
    for name in set(old) - set(calls):
        for left in (folder / f"{name}.lp", folder / f"{name}.args"):
            if left.parent == folder:
                left.unlink(missing_ok=True)
    with output(str(made_before), parents=True) as file:
        file.writelines(f"{name}\n" for name in calls)
    for name, call in calls.items():
        path = folder / f"{name}.args"
        words = shlex.join(call) + "\n"
        if not path.exists() or text(path) != words:
            with output(str(path)) as file:
                file.write(words)
    print(
        json.dumps({"instances": list(calls), "complete": True}) if args.json else "\n".join(calls)
    )
    return DONE
