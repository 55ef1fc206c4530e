"""What the subcommand ``explore`` does: the next walk in words, and proofs to be checked."""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from topomap.documents import bisimulation, check, maps
from topomap.documents.bisimulation import Chart, Pair
from topomap.drawing import scenes
from topomap.model import words
from topomap.model.experience import DState, Experience, read
from topomap.model.found import steps_json
from topomap.model.query import Query
from topomap.model.topology import gid
from topomap.model.vocabulary import PARTS
from topomap.questions.explore import Plan, Prediction, Untold, plan, standing
from topomap.runtime import files, formats
from topomap.runtime.errors import InputError, printable, say
from topomap.runtime.limits import LARGEST
from topomap.runtime.status import NO, exit_status
from topomap.runtime.watch import Attempt, Watch, heeding
from topomap.solver import solving

At = tuple[DState, ...]
KINDS = {
    "optimal": (),
    "closed": ("closed",),
    "perpendicular": ("closed", "perpendicular"),
}  # what --among may say, and the parts that such maps have; of optimal ones see scenes.best
MOST_GROUPS, MOST_PAIRS, LONGEST = 6, 12, 24  # that are told in words
FAULTS = {
    "steps": "no walk of at most {steps} steps does better, a longer one may",
    "effort": "longer walks may do better",
    "maps": "not all of the maps were looked at when the walk was chosen",
}


@dataclass(frozen=True)
class Asked:
    """A map in question: the dstate after each step, and what it is."""

    at: At
    of: str


def explore(args: argparse.Namespace) -> int:
    """Say where to go next."""
    whole = read(args.instance)
    experience = whole.cut(LARGEST if args.horizon is None else args.horizon)
    if args.proof and args.output and Path(args.proof).resolve() == Path(args.output).resolve():
        raise InputError(f"{args.proof}: it cannot be both --output and --proof")
    if args.check:
        return _check(args, experience)
    with (
        files.output(args.output) as out,
        heeding(args.timeout) as watch,
    ):
        among, fault = _among(args, whole, experience, watch)
        if not among:
            none = f"no map found yet; partial: {fault}" if fault else "no such map is consistent"
            say(f"{args.instance}: {none}{'' if fault else ' with it'}")
            if args.json:
                out.write(formats.line({"instance": args.instance, "maps": []}, fault))
            return exit_status(fault, False)
        if args.facts:
            out.write(_facts(experience, among) + "carried.\n" * args.marker)
            return exit_status(fault, True)
        standings = [standing(experience, one.at) for one in among]
        watch.title("the next walk")
        made = plan(experience.slots, standings, watch, marker=args.marker, steps=args.steps)
        cut = bool(fault)
        every = not cut and all(name in KINDS for name in args.among or ["optimal"])
        fault = fault or made.fault
        if args.proof:
            with files.output(args.proof) as file:
                file.write(formats.line(_proof(args, experience, among, made), fault))
        if args.json:
            out.write(formats.line(_json(args, experience, among, made, every), fault))
        else:
            found = " found so far" * cut
            out.write(f"{words.number(len(among), 'map')}{found} ({_kinds(among)})\n")
            _write(out, args, experience, among, made, every, fault)
    return exit_status(fault, made.kind != "bisimilar")


def _among(
    args: argparse.Namespace, whole: Experience, experience: Experience, watch: Watch
) -> tuple[list[Asked], str | None]:
    """The maps in question, each once, and why they may not be all, if so."""
    parts = frozenset(part for part in PARTS if getattr(args, part, False))
    query = Query(parts, args.bound, args.horizon)
    found: dict[At, str] = {}
    fault = None
    for name in args.among or ["optimal"]:
        if name not in KINDS:
            for at in _of_file(name, whole, experience, watch):
                found.setdefault(at, name)
        elif fault is None:
            watch.title(f"{name} maps")
            if name == "optimal":
                best, fault = scenes.best(whole, args.instance, query, watch)
                for scene in best:
                    found.setdefault(tuple(scene.at), scene.kind)
                continue
            with Attempt() as attempt:
                for one in solving.hypotheses(whole, query.having(*KINDS[name]), watch):
                    if one is not None:
                        found.setdefault(one.at, name)
            fault = attempt.fault
    return [Asked(at, of) for at, of in sorted(found.items())], fault


def _of_file(path: str, whole: Experience, experience: Experience, watch: Watch) -> Iterator[At]:
    """The maps of a file, cut to the experience. Raises InputError if one is none of its
    hypotheses."""
    documents = maps.read(path)
    if not any(document.maps for document in documents):
        raise InputError(f"{path}: no maps in it")
    for document in documents:
        for number, entry in enumerate(document.maps, 1):
            watch.found += 1
            where = f"{document.where}: map {number}"
            yield hypothesis(where, entry["at"], whole, experience)


def hypothesis(
    where: str, at: Any, whole: Experience, experience: Experience, demands: Sequence[str] = ()
) -> At:
    """The dstate after each step, if they make a hypothesis of the experience, or of the whole of
    which it is the beginning. Raises InputError, one line, where they do not."""
    if len(at) - 1 not in (whole.steps, experience.steps):
        raise InputError(f"{where}: {len(at) - 1} steps, the instance has {experience.steps}")
    return maps.hypothesis(where, at, whole, demands)[: experience.steps + 1]


def _facts(experience: Experience, among: Sequence[Asked]) -> str:
    """The maps as facts for ``encodings/explore.lp`` and its like."""
    lines = [experience.facts().rstrip()]
    for number, one in enumerate(among, 1):
        lines.append(f"% map {number}: {printable(one.of)}")
        dstates = enumerate(one.at)
        lines.append(" ".join(f"map({number},{t},{place},{slot})." for t, (place, slot) in dstates))
    return "\n".join(lines) + "\n"


def _json(
    args: argparse.Namespace,
    experience: Experience,
    among: Sequence[Asked],
    made: Plan,
    every: bool,
) -> dict[str, Any]:
    """The answer as JSON; maps are numbered from 1. ``every``: there are no others of the kinds
    that are asked about."""
    return {
        "instance": args.instance,
        "slots": experience.slots,
        "maps": [{"at": steps_json(one.at), "of": one.of} for one in among],
        "marker": args.marker,
        "kind": _kind(made, every),
        "turns": made.turns,
        "drop": made.drop,
        "left": made.left,
        "proved": made.proved,
        "predictions": [[_seen(one) for one in row] for row in made.predictions],
        "classes": [[number + 1 for number in same] for same in made.classes],
        "untold": [
            {
                "map_numbers": [pair.one + 1, pair.other + 1],
                "why": pair.why,
                "open": pair.open,
                "related": pair.related,
            }
            for pair in made.untold
        ],
    }


def _kind(made: Plan, every: bool) -> str | None:
    """What the walk is for, or why there is none; None where that is open."""
    if made.kind == "settled":
        return made.kind if every else None
    return made.kind if made.turns or made.kind == "bisimilar" else None


def _seen(one: Prediction | None) -> dict[str, Any] | None:
    if one is None:
        return None
    return {"view": sorted(one.view), "landmarks": sorted(one.landmarks), "marker": one.marker}


def _write(
    out: IO[str],
    args: argparse.Namespace,
    experience: Experience,
    among: Sequence[Asked],
    made: Plan,
    every: bool,
    fault: str | None,
) -> None:
    """The answer in words; ``every`` as above."""
    if made.turns:
        _write_walk(out, experience, made)
    out.write(f"{_verdict(among, made, every)}\n")
    for pair in made.untold[:MOST_PAIRS]:
        out.write(f"maps {pair.one + 1} and {pair.other + 1}: {_why(pair)}\n")
    if len(made.untold) > MOST_PAIRS:
        out.write(f"and {words.number(len(made.untold) - MOST_PAIRS, 'more pair')}: see --json\n")
    if fault:
        why = FAULTS.get(fault, "").format(steps=args.steps)
        out.write(f"partial: {fault}{f'; {why}' * bool(why)}\n")


def _kinds(among: Sequence[Asked]) -> str:
    """How many maps there are of each kind."""
    kinds: dict[str, int] = {}
    for one in among:
        kinds[one.of] = kinds.get(one.of, 0) + 1
    return ", ".join(f"{number:,} {printable(kind)}" for kind, number in kinds.items())


def _write_walk(out: IO[str], experience: Experience, made: Plan) -> None:
    """The walk, and what the maps predict of it."""
    groups: dict[tuple[Prediction | None, ...], list[int]] = {}
    for number, row in enumerate(made.predictions, 1):
        groups.setdefault(row, []).append(number)
    shown = list(groups.items())[:MOST_GROUPS]
    names = [f"map{'s' * (len(same) > 1)} {words.listed(same, 4)}" for _, same in shown]
    table = [["step", "turn", *names]]
    for step, turn in enumerate(made.turns):
        if made.drop == step:
            table.append(["", "put the marker down", *[""] * len(names)])
        table.append(
            [str(step + 1), _turn(experience, step, turn), *(_cell(r[step]) for r, _ in shown)]
        )
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for line in table:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        out.write("  ".join(cells).rstrip() + "\n")
    if len(groups) > MOST_GROUPS:
        more = words.number(len(groups) - MOST_GROUPS, "more group")
        out.write(f"and {more} of maps that predict something else: see --json\n")


def _turn(experience: Experience, step: int, turn: int) -> str:
    """A turn, by its number and in words."""
    slots = experience.slots
    if step == 0 and experience.steps == 0:
        return f"{turn} leave{' by the gateway stood at' * (turn == 0)}"
    return f"{turn} {words.direction(turn, slots).partition(' (')[0]}"


def _cell(one: Prediction | None) -> str:
    """What is seen: gateways clockwise of the one arrived at, landmarks, the marker."""
    if one is None:
        return "-"
    seen = " ".join(map(str, sorted(one.view)))
    signs = [words.signs(one.landmarks)] if one.landmarks else []
    return ", ".join([words.short(seen, LONGEST), *signs, *["marker"] * one.marker])


def _verdict(among: Sequence[Asked], made: Plan, every: bool) -> str:
    """What the walk is good for."""
    many = len(among)
    if made.kind == "settled":
        if every:
            return "settled: the map is closed, and the only one"
        return "the map is closed; whether it is the real one is open: others were not looked at"
    if made.kind == "bisimilar":
        which = "the maps" if every else "these maps"
        return f"no walk tells {which} apart, for ever, and no gateway is pending"
    if made.kind == "apart":
        if not made.turns:
            return "a walk that tells the maps apart is not found yet"
        best = "; no walk leaves fewer, none as few sooner" if made.proved else ""
        return f"left in the worst case: {made.left:,} of {many:,} maps{best}"
    if not made.turns:
        return "a walk to a pending gateway is not found yet"
    off = sum(row[-1] is None for row in made.predictions)
    why = f"in {off:,} of {many:,} maps" if many > 1 else "in the map"
    told = many > 1 and made.proved
    apart = "no walk leaves fewer maps in the worst case; " if told else ""
    return f"{apart}it leads to what is not known: through a pending gateway {why}"


def _why(pair: Untold) -> str:
    """Why the walk does not tell two maps apart."""
    if pair.why == "walk":
        return "another walk tells them apart"
    proof = f"{words.number(len(pair.related), 'pair')} of dstates, checked"
    if pair.why == "bisimilar":
        return f"no walk tells them apart, for ever: a bisimulation of {proof}"
    of = []
    for number, gateways in zip((pair.one, pair.other), pair.open, strict=True):
        if gateways:
            more = " and more" * (len(gateways) > 4)
            of.append(f"{', '.join(map(gid, gateways[:4]))}{more} of map {number + 1}")
    told = "no walk tells them apart by what both predict"
    return f"{told} ({proof}); pending: {'; '.join(of)}"


def _proof(
    args: argparse.Namespace,
    experience: Experience,
    among: Sequence[Asked],
    made: Plan,
) -> dict[str, Any]:
    """The proofs, to be checked by ``--check``."""
    return {
        "instance": args.instance,
        "horizon": experience.steps,
        "marker": args.marker,
        "maps": [{"at": steps_json(one.at)} for one in among],
        "proofs": [
            {
                "map_numbers": [pair.one + 1, pair.other + 1],
                "why": pair.why,
                "related": pair.related,
            }
            for pair in made.untold
            if pair.related
        ],
    }


def _check(args: argparse.Namespace, experience: Experience) -> int:
    """Check what ``--proof`` wrote."""
    path = args.check
    try:
        data = json.loads(files.text(path, maps.MOST_BYTES))
        formats.demand(path, data)
        marker, proofs, steps = data["marker"], data["proofs"], data["horizon"]
        kinds = isinstance(marker, bool), isinstance(proofs, list), type(steps) is int
        if not all(kinds) or not 0 <= steps <= experience.steps:
            raise ValueError
    except (ValueError, LookupError, TypeError, RecursionError):
        raise InputError(f"{path}: not what topomap explore --proof writes") from None
    of = f", of the first {steps} of {experience.steps} steps" * (steps < experience.steps)
    experience = experience.cut(steps)
    document = maps.document(path, {"maps": data.get("maps")})
    charts = []
    put = max(experience.drops, default=-1)
    lying = put >= max([0, *experience.picks])  # taking the marker up comes before putting it down
    for number, entry in enumerate(document.maps, 1):
        at = hypothesis(f"{path}: map {number}", entry["at"], experience, experience)
        grown = check.Grown(experience, dict(enumerate(at)), experience.steps)
        landmarks = {place: experience.landmarks[place] for place in grown.stars}
        rest = landmarks, at[put][0] if lying else None
        charts.append(Chart(experience.slots, grown.stars, grown.links, at[-1], *rest))
    wrong = []
    for number, proof in enumerate(proofs, 1):
        one, other, why, related = _read(f"{path}: proof {number}", proof, charts)
        found = list(bisimulation.faults(one, other, related, marker))
        if not found and why == "bisimilar" and any(bisimulation.pending(one, other, related)):
            found.append("it comes to a pending gateway, so it is not for ever")
        wrong += [f"{path}: proof {number}: {fault}" for fault in found[:1]]
    with files.output(args.output) as out:
        if args.json:
            answer = {"instance": args.instance, "proofs": len(proofs), "wrong": wrong}
            out.write(formats.line(answer))
        else:
            out.writelines(f"{line}\n" for line in wrong)
            out.write(f"{words.number(len(proofs), 'proof')}, {len(wrong) or 'none'} wrong{of}\n")
    return NO if wrong else 0


def _read(where: str, proof: Any, charts: Sequence[Chart]) -> tuple[Chart, Chart, str, list[Pair]]:
    """A proof of a file. Raises InputError where it is none."""

    def number(value: Any) -> int:
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError
        return value

    def dstate(value: Any) -> DState:
        place, slot = value
        return number(place), number(slot)

    try:
        first, second = (number(which) for which in proof["map_numbers"])
        if not 1 <= first < second <= len(charts):
            raise ValueError
        if proof["why"] not in ("bisimilar", "pending"):
            raise ValueError
        related: list[Pair] = []
        for one, other, (a, b) in proof["related"]:
            lies = None if a is None else number(a), None if b is None else number(b)
            related.append((dstate(one), dstate(other), lies))
    except (ValueError, LookupError, TypeError):
        raise InputError(f"{where}: not what topomap explore --proof writes") from None
    return charts[first - 1], charts[second - 1], proof["why"], related
