"""What each subcommand of ``topomap`` does, and the exit status it ends with."""

import argparse
import contextlib
import dataclasses
import hashlib
import json
import os
import shlex
from array import array
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from topomap import formats
from topomap.errors import DONE, INTERRUPTED, NO, PARTIAL, InputError, say
from topomap.experience import Experience, read
from topomap.files import MOST_BYTES, output, text
from topomap.folders import ENCODINGS, INSTANCES
from topomap.journal import Journal
from topomap.options import LARGEST, MOST_PLACES
from topomap.query import Query
from topomap.share import ALONE, Crew, crew
from topomap.solver import INTERRUPT, MEMORY, UNPROVED, Cube, Found, Stopped, Watch, Way, best
from topomap.topology import TopologicalMap
from topomap.vocabulary import PARTS, PROPERTIES

# What only some subcommands need is loaded by them: most calls are done sooner than it loads.
if TYPE_CHECKING:
    from topomap.environment import Environment
    from topomap.generate import Instance
    from topomap.report import Report

STOPS = Stopped, MemoryError  # what leaves a partial answer


def path(args: argparse.Namespace) -> int:
    """Print where the encodings or the instances are."""
    found = {"encodings": str(ENCODINGS), "instances": str(INSTANCES)}
    print(formats.line(found).rstrip() if args.json else found[args.what])
    return DONE


def generate(args: argparse.Namespace) -> int:
    """Explore an environment and write the instance."""
    from topomap.report import steps_json

    made = _instance(args)
    target = args.output
    if target and (target.endswith("/") or Path(target).is_dir()):
        target = str(Path(target) / f"{made.name}.lp")
    if target and args.truth and Path(target).resolve() == Path(args.truth).resolve():
        raise InputError(f"{target}: it cannot be both --output and --truth")
    with contextlib.ExitStack() as files:
        if args.truth:
            truth = formats.line({"maps": [{"at": steps_json(made.truth)}]})
            files.enter_context(output(args.truth)).write(truth)
        if target or not args.json:
            files.enter_context(output(target)).write(made.text())
    if args.json:
        summary = {
            "name": made.name,
            "file": target,
            "header": made.header,
            "steps": made.experience.steps,
            "facts": None if target else made.experience.facts(),
        }
        print(formats.line(summary), end="")
    return DONE


def environment_of(args: argparse.Namespace) -> "Environment":
    """The environment that a call of ``generate`` or ``simulate`` names."""
    from topomap import environment, network

    if args.kind == "network":
        world, warnings = network.load(args.file, args.slots, args.north)
        for warning in warnings:
            say(f"warning: {warning}")
    elif args.rows * args.columns > MOST_PLACES:
        size = f"{args.rows} x {args.columns}"
        raise InputError(f"topomap {args.command}: {size}: more than {MOST_PLACES} places")
    elif args.kind == "maze":
        world = environment.maze(args.rows, args.columns, args.thin, args.seed or 0)
    elif args.kind in ("hexagons", "triangles"):
        world = environment.lattice(args.kind, args.rows, args.columns)
    else:
        world = environment.grid(args.rows, args.columns, args.kind)
    return world


def _instance(args: argparse.Namespace) -> "Instance":
    from topomap.generate import instance

    world = environment_of(args)
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
    encoding = getattr(args, "encoding", "fast")
    return Query(parts, args.bound, args.horizon, encoding, getattr(args, "noise", None))


def _run(args: argparse.Namespace, *experiences: Experience) -> dict[str, Any]:
    """What a run computes; a journal is resumed only by a run that computes the same."""
    from topomap import solver

    texts = [solver.digest(), *(experience.facts() for experience in experiences)]
    keys = ("by", "encoding", *PARTS, "optimal", "bound", "horizon")
    asked = {key: getattr(args, key, None) for key in keys}
    digest = hashlib.sha256("".join(texts).encode()).hexdigest()
    return {"command": args.command, **asked, "facts and encodings": digest}


def solve(args: argparse.Namespace) -> int:
    """Enumerate the maps of each instance."""
    from topomap.report import Report

    _with_noise(args)
    inputs = []
    for path in args.instance:
        experience = read(path, args.noise is not None)
        truth = _truth(args.truth, experience, args.horizon) if args.truth else None
        inputs.append((path, experience, truth))
    run = _run(args, *(experience for _, experience, _ in inputs))
    statuses, faults = [], []
    with (
        _crew(args) as crew,
        Journal(args.output, run, args.resume, True) as journal,
        output(args.output) as out,
    ):
        if args.json and len(inputs) > 1:
            out.write(json.dumps(formats.headed({}))[:-1] + ', "results": [\n')
        for number, (path, experience, truth) in enumerate(inputs):
            if len(inputs) > 1:
                out.write(",\n" * (number > 0) if args.json else f"{path}\n")
            kind = "optimal" if args.optimal else None
            report = Report(out, path, experience, _query(args), kind, truth, args.json)
            fault = _solve_one(args, experience, report, journal, crew)
            statuses.append(exit_status(fault, bool(report.count)))
            if fault:
                faults.append(fault)
                journal.stop()
            if fault == INTERRUPT:
                break
        if args.json and len(inputs) > 1:
            last = faults[-1] if faults else None
            out.write("], " + json.dumps(formats.ended(last))[1:] + "\n")
        journal.complete = not faults
    return max(statuses)


def _with_noise(args: argparse.Namespace) -> None:
    """Choose the encoding. Raises InputError if misreadings are allowed and something is asked
    for that cannot be combined with them."""
    if args.noise is None:
        args.encoding = args.encoding or "fast"
        return
    others = {
        "--by search": args.by == "search",
        "--jobs": (args.jobs or 1) > 1,
        "--dask": args.dask,
        "--resume": args.resume,
        "--truth": args.truth,
    }
    for name, asked in others.items():
        if asked:
            raise InputError(f"topomap solve: --noise does not go with {name}")
    if args.encoding == "fast":
        say("topomap solve: --noise: the plain encoding is used, not the fast one")
    args.encoding = "plain"


def _solve_one(
    args: argparse.Namespace, experience: Experience, report: "Report", journal: Journal, crew: Crew
) -> str | None:
    """Write the maps of an instance; why they may not be all, if so."""
    fault, candidate = None, None
    with Watch(args.timeout) as watch:
        try:
            for found in _found(args, experience, watch, journal, crew):
                if not found.proved:
                    candidate = found
                elif report.count == args.limit:
                    fault = "limit"
                    break
                else:
                    report.add(found)
        except STOPS as stop:
            fault = str(stop) or MEMORY
        if fault and candidate and not report.count:
            report.add(dataclasses.replace(candidate, kind=UNPROVED))
        report.end(fault)
    return fault


def exit_status(fault: str | None, yes: bool) -> int:
    """The exit status of an answer: partial, for that reason, or else yes or no."""
    if fault:
        return INTERRUPTED if fault == INTERRUPT else PARTIAL
    return DONE if yes else NO


def _found(
    args: argparse.Namespace, experience: Experience, watch: Watch, journal: Journal, crew: Crew
) -> Iterator[Found]:
    """The maps that ``solve`` asks for; if all go to a file or there is a crew, part by part
    of the tree, each part a unit of the journal."""
    from topomap import search, solver

    query = _query(args)
    way = search.hypotheses if args.by == "search" else solver.hypotheses
    if args.optimal:
        yield from filter(None, best(experience, query, watch, way))
    elif query.optimizes or (crew is ALONE and not journal.kept):
        yield from filter(None, way(experience, query, watch))
    else:
        parts, depth = search.cubes(experience, query)
        done = 0
        known: set[Cube] = set()  # the maps of the part that was cut
        watch.rest()
        for value in journal.recorded(len(parts)):
            watch.tick()
            if value is None:
                known.clear()
                done += 1
            else:
                at = tuple((place, slot) for place, slot in value)
                known.add(at)
                watch.found += 1
                yield Found(at, query.kind)
        watch.go_on()
        if args.by == "clingo":
            solver.demand_cover(experience, query, watch, parts, depth)
        if crew is ALONE:
            left = way(experience, query, watch, cubes=parts[done:])
        else:
            left = _shared(crew, way, experience, query, watch, parts[done:])
        for found in left:
            if found is None:
                known.clear()
                journal.commit()
            elif found.at not in known:
                journal.add(found.at)
                yield found


def _shared(
    crew: Crew, way: Way, experience: Experience, query: Query, watch: Watch, cubes: list[Cube]
) -> Iterator[Found | None]:
    """What a way gives, by a crew."""
    steps = experience.cut(LARGEST if query.horizon is None else query.horizon).steps
    for numbers in crew.each(partial(_numbers, way, experience, query), cubes, watch):
        dstates = list(zip(numbers[::2], numbers[1::2], strict=True))
        watch.found += len(dstates) // (steps + 1)
        for start in range(0, len(dstates), steps + 1):
            yield Found(tuple(dstates[start : start + steps + 1]), query.kind)
        yield None


def _numbers(
    way: Way, experience: Experience, query: Query, cube: Cube, watch: Watch | None
) -> "array[int]":
    """The maps that begin with a cube, as places and gateways in a row: a third of the memory
    that they take as maps."""
    numbers = array("i")
    for found in way(experience, query, watch or Watch(quiet=True), cubes=[cube]):
        for dstate in found.at if found else ():
            numbers.extend(dstate)
    return numbers


def _crew(args: argparse.Namespace) -> Crew:
    """Those who do the work."""
    shared = (args.jobs or 1) > 1 or args.dask
    if shared and (getattr(args, "optimal", False) or _query(args).optimizes):
        raise InputError("topomap solve: --jobs and --dask are for all maps, not the best ones")
    return crew(args.jobs or 1, args.dask)


def _truth(file: str, experience: Experience, horizon: int | None) -> TopologicalMap:
    """The real map of an experience, from a file that ``generate --truth`` wrote."""
    from topomap import maps
    from topomap.check import STEP_RULES

    entries = [entry for document in maps.read(file, MOST_BYTES) for entry in document.maps]
    if len(entries) != 1:
        raise InputError(f"{file}: {len(entries)} maps, but the real map must be the only one")
    at = entries[0]["at"]
    if len(at) != experience.steps + 1:
        raise InputError(f"{file}: {len(at) - 1} steps, the instance has {experience.steps}")
    last = experience.steps if horizon is None else horizon
    return experience.map_of(maps.hypothesis(file, at, experience, rules=STEP_RULES)[: last + 1])


def check(args: argparse.Namespace) -> int:
    """Check maps that anyone made, by rules and by definition."""
    from topomap import maps

    documents = maps.read(args.maps)
    said = any(document.claims.get("noise") is not None for document in documents)
    experience = read(args.instance, said or args.noise is not None)
    documents = maps.of_instance(documents, args.instance)
    number = sum(len(document.maps) for document in documents)
    if not documents:
        raise InputError(f"{args.maps}: no maps of {args.instance} in it")
    truth = _truth(args.truth, experience, None) if args.truth else None
    demands = [part for part in PROPERTIES if getattr(args, part)]
    demands += [f"bound({args.bound})"] if args.bound else []
    checked: list[maps.Verdict] = []
    fault = None
    with output(args.output) as out:
        try:
            with Watch(args.timeout) as watch:
                for verdict in maps.verdicts(experience, documents, demands, truth, args.noise):
                    checked.append(verdict)
                    watch.found += 1
                    if len(checked) < number:
                        watch.tick()
        except STOPS as stop:
            fault = str(stop) or MEMORY
        unsound = [verdict for verdict in checked if not verdict.sound]
        short = sum(verdict.short for verdict in checked)
        if args.json:
            answer = {
                "instance": args.instance,
                "demands": demands,
                "unsound": [dataclasses.asdict(verdict) for verdict in unsound],
                "checked": len(checked),
                "short": short,
                "count": number,
            }
            out.write(formats.line(answer, fault))
        else:
            for verdict in unsound:
                broken = [f"violation({rule},{step})" for rule, step in verdict.violations]
                out.write(f"{verdict.where}: {'; '.join(broken + verdict.faults)}\n")
            noun = "map" if number == 1 else "maps"
            line = f"{len(checked)} of {number} {noun} checked" if fault else f"{number} {noun}"
            line += f", {len(unsound) or 'none'}{' of these' * bool(fault)} unsound"
            if short:
                line += f"; {short} of them for only part of the {experience.steps} steps"
            out.write(line + (f"; partial: {fault}\n" if fault else "\n"))
    return exit_status(fault, not unsound)


def count(args: argparse.Namespace) -> int:
    """Count the search tree of an instance, by clingo."""
    from topomap.statistics import tree

    experience = read(args.instance)
    figures: dict[str, Any] = {}
    fault = None
    with (
        _crew(args) as crew,
        Journal(args.output, _run(args, experience), args.resume) as journal,
        output(args.output) as out,
    ):
        try:
            with Watch(args.timeout) as watch:
                tree(experience, _query(args), watch, journal, figures, crew)
        except STOPS as stop:
            fault = str(stop) or MEMORY
        _write_figures(args, out, figures, fault)
        journal.complete = not fault
    return exit_status(fault, bool(figures["final"]))


def search_tree(args: argparse.Namespace) -> int:
    """Search the tree of an instance: count it, or find a closed map best-first."""
    from topomap import search
    from topomap.statistics import KEYS, Tally

    experience = read(args.instance)
    query = _query(args)
    if args.order == "best":
        return _best_first(args, experience, query)
    node = search.root(experience, query)
    tally = Tally(node.experience.steps)
    fault = None
    with output(args.output) as out:
        try:
            with Watch(args.timeout) as watch:
                for _ in search.ORDERS[args.order](node, watch):
                    tally.add(node)
                    watch.found = tally.per_step[-1]
        except STOPS as stop:
            fault = str(stop) or MEMORY
        figures = tally.figures()
        if fault and args.order == "breadth":  # in the midst of the last level with a node
            whole = sum(map(bool, tally.per_step)) - 1
            figures = dict.fromkeys(KEYS) | {"per_step": tally.per_step[: max(0, whole)]}
        elif fault:  # of no step all nodes are known; others may be better than the best so far
            least = {key: figures[key] for key in (*KEYS, "per_step") if key != "optimal"}
            figures = dict.fromkeys((*KEYS, "per_step")) | {"at_least": least}
        _write_figures(args, out, figures, fault)
    return exit_status(fault, bool(tally.per_step[-1]))


def _best_first(args: argparse.Namespace, experience: Experience, query: Query) -> int:
    """The paper's best-first search, with backtracking while the map is not closed."""
    from topomap import maps, search
    from topomap.report import Report

    fault = None
    nodes = 0
    with output(args.output) as out, Watch(args.timeout) as watch:
        report = Report(out, args.instance, experience, query, maps.BEST_FIRST, None, args.json)
        try:
            for node in search.best_first(search.root(experience, query), watch):
                nodes += 1
                if node.steps == node.experience.steps and node.closed():
                    report.add(Found(node.dstates, maps.BEST_FIRST, node.cost, proved=False))
                    break
        except STOPS as stop:
            fault = str(stop) or MEMORY
        report.end(fault, nodes=nodes)
    return exit_status(fault, bool(report.count))


def _write_figures(
    args: argparse.Namespace,
    out: IO[str],
    figures: dict[str, Any],
    fault: str | None,
) -> None:
    """Write what ``count`` gives, or ``search``; of a search that was cut, ``at_least`` holds
    what the nodes met until then come to."""
    from topomap import figure4
    from topomap.statistics import KEYS

    if args.json:
        out.write(formats.line({"instance": args.instance, **figures}, fault))
        return
    least = figures.get("at_least")
    told, more = (least, "at least ") if least else (figures, "")
    steps = " ".join(map(str, told["per_step"])) or "not counted"
    out.write(f"hypotheses after each step: {more}{steps}\n")
    for key in KEYS:
        known = "not counted" if told.get(key) is None else f"{more}{told[key]:,}"
        out.write(f"{figure4.WORDS[key]:<42}{known:>12}\n")
    if fault:
        out.write(f"partial: {fault}\n")


def branching_nodes(args: argparse.Namespace) -> int:
    """Check the paper's equation (1) at every branching node of the planar tree."""
    from topomap import branching, search

    experience = read(args.instance)
    query = _query(args).having("planar")
    summary = branching.Summary()
    fault = None
    with output(args.output) as out:
        if args.json:
            head = formats.headed({"instance": args.instance})
            out.write(json.dumps(head)[:-1] + ', "nodes": [')
        try:
            with Watch(args.timeout) as watch:
                for node in branching.branching(search.root(experience, query), watch):
                    if args.json:
                        out.write(",\n" * (watch.found > 1) + json.dumps(node.json()))
                    summary.add(node)
        except STOPS as stop:
            fault = str(stop) or MEMORY
        if args.json:
            tail = {"summary": summary.totals, **formats.ended(fault)}
            out.write("], " + json.dumps(tail)[1:] + "\n")
        else:
            out.write(branching.text(summary.totals))
            if fault:
                out.write(f"partial: {fault}; the figures are of the nodes met until then\n")
    return exit_status(fault, summary.holds)


def table(args: argparse.Namespace) -> int:
    """Count the paper's table, or what is beyond it, print it and write it as JSON."""
    from topomap import beyond, figure4

    name = "beyond" if args.beyond else "figure4"
    path = f"results/{name}.json" if args.output is None else args.output
    jobs = args.jobs or os.cpu_count() or 1
    columns = len(beyond.COLUMNS if args.beyond else figure4.COLUMNS)
    rows: list[dict[str, Any]] = []
    fault = None
    if args.resume and not args.beyond:
        raise InputError("topomap table: --resume goes with --beyond")
    try:
        with output(path, parents=True) as file, contextlib.ExitStack() as stack:
            if args.beyond:
                run = {"command": name, "columns": beyond.COLUMNS}
                journal = stack.enter_context(Journal(path, run, args.resume))
                watch = stack.enter_context(Watch(args.timeout))
                workers = stack.enter_context(crew(jobs))
                counted = beyond.rows(workers, watch, journal)
            else:
                journal = Journal()
                counted = figure4.rows(jobs, args.timeout)
            for row in counted:
                rows = sorted([*rows, row], key=lambda row: (row["environment"], row["planarity"]))
                say(f"counted {len(rows)} of {columns} columns")
            json.dump(formats.answer({"rows": rows}), file, indent=1)
            file.write("\n")
            journal.complete = True
    except STOPS as stop:  # the file keeps an older, complete table
        fault = str(stop) or MEMORY
    different = [cell for row in rows for cell in figure4.differences(row)]
    if args.json:
        print(formats.line({"rows": rows}, fault), end="")
        return exit_status(fault, not different)
    if rows:
        print(figure4.text(rows))
    for cell in different:
        print(f"differs: {cell}")
    if fault:
        print(f"partial: {fault}; {len(rows)} of {columns} columns")
    elif not different:
        print(beyond.VERDICT if args.beyond else "Every figure is the paper's.")
    return exit_status(fault, not different)


def family(args: argparse.Namespace) -> int:
    """Write the call of each instance of a family where it changed, and drop what is no
    longer listed of what the last call made."""
    from topomap.family import expand

    folder = Path(args.directory)
    calls: dict[str, str] = {}
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
                f"{args.file}:{line}: a second instance named {made.name}; give it another --name"
            )
        calls[made.name] = shlex.join(call) + "\n"
        if parsed.kind == "network":  # make sees by this line that the map was changed
            is_now = Path(parsed.file).stat()
            calls[made.name] += f"# {is_now.st_size} bytes, changed {is_now.st_mtime_ns}\n"
    # At any moment what was made is listed, so that a call that was cut short can be repeated.
    made_before = folder / ".family"
    old = text(made_before).splitlines() if made_before.exists() else []
    for name in set(old) - set(calls):
        for left in (folder / f"{name}.lp", folder / f"{name}.args"):
            if left.parent == folder:
                left.unlink(missing_ok=True)
    with output(str(made_before), parents=True) as file:
        file.writelines(f"{name}\n" for name in calls)
    for name, written in calls.items():
        path = folder / f"{name}.args"
        if not path.exists() or text(path) != written:
            with output(str(path)) as file:
                file.write(written)
    if args.json:
        print(formats.line({"instances": list(calls)}), end="")
    else:
        print("\n".join(calls))
    return DONE
