"""The atlas of aliasing as a page, made of its JSON; and read back."""

import json
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from topomap.runtime import formats
from topomap.runtime.errors import InputError
from topomap.runtime.files import read_text

KNOWLEDGE = "all", "planar", "compass"
KINDS = (*KNOWLEDGE, "closed")
WALKS = {"tour": "tour", "random": "random walk"}
WIDTH = 116
HEAD = """\
# An atlas of aliasing

How many maps explain what an explorer saw? This page gives their number after each step of two
walks in each of {worlds} worlds. `topomap atlas` wrote it from [atlas.json](atlas.json), which
has all figures, and each walk as a list of turns; `make atlas` counts again.

The *tour* goes along every way, comes back to where it began, and is as short as such a walk can
be. The *random walk* goes on until it has gone along every way, but it ends after {steps} steps
at most (seed {seed}). The maps are counted four times:

- **all**: the maps that explain what the agent saw, with directions given as *turns*, that is,
  counted from the gateway where it arrived;
- **planar**: those of these maps that are planar;
- **compass**: the maps that explain the same walk if the agent also has an exact compass;
- **closed**: those of the first kind that have no pending gateway.

Each count is exact. A count stops at the first step after which there are more than {most} maps,
or when the {seconds} seconds that each part of the work may take are over; the page then names
the step. Where the count of all maps stopped, the closed maps at the end are looked for
separately.
"""
LEFT = """\
## How many maps remain at the end of the walk

{table}
"""
SETTLING = """\
## Which further walk leaves only the real map

*One since* is the step from which on there is exactly one map, until the end of the walk.
*Further walk* is the length of the shortest walk in the real world, from the end of the first
walk on, that refutes every remaining map except the real one. A map is refuted if no map that
extends it explains the longer walk. So after the further walk there is one map, if the real map
is closed. (Of the closed maps, the further walk refutes those that are closed before it begins;
others may become closed during it.)

- `none (3 of 4)` is a proof: 3 of the 4 other maps cannot be refuted by any walk, whatever its
  length.
- If there are more than {living} other maps, {living} of them are tried. If one of these cannot
  be refuted by any walk, that is a proof, too: `none (1 of 100 tried)`. Otherwise the cell has a
  lower bound, and then the length of a walk that refutes the maps that were tried.
- Where the maps were not all counted, only the tree that is described below is tried, and those
  closed maps that were found: `none (1 of 1 tried)`.
- `real map open` says that the real map still has pending gateways, so it is not one of the
  closed maps; `real map not one of them`, that it is not a map of this kind at all; and `no map`,
  that there is no map of this kind.
- A dash says that there is not exactly one map at the end.

In a world with a cycle, once a walk has gone along all ways of the cycle, no further walk leaves
exactly one map of any of the first three kinds. The reason is that there is a map in which each
step along a new way came to a new place. This map is a tree, so it is planar and keeps the path
axiom. Wherever the walk goes on, the next new way can lead to one more new place in this map,
with the view that the agent sees there.

{table}
"""
PREFERRED = """\
## Does minimality prefer the real map?

The best maps are the closed ones that have the fewest exceptions to consistent boundaries, then
the fewest paths, then the fewest places. If no map is closed, they are the best so far, in which
gateways may be pending. `one of 2` says that the real map and one other map are best. If the real
map is not among the best, the cell has these three numbers of the best maps, and then those of
the real map.

{table}

{sums}
"""
PEERS = """\
## Compared with learning an automaton without reset

[AALpy](https://github.com/DES-Lab/AALpy) {aalpy} learns automata. Its algorithm hW needs no
reset, so it can explore a world as a robot does. Here it explores the same worlds. An input is a
turn. If there is a gateway in this direction, the agent travels through it, and the output is
what the agent sees beyond; if not, the agent stays where it is. With a compass, the output also
has the direction of the gateway where the agent stands.

A state of the world is a dstate: a place, and the gateway where the agent stands. Dstates that no
walk tells apart form a class. *Smallest* is the number of these classes: an automaton that
predicts each walk rightly has no fewer states. *Learned* is the number of states of the automaton
with which the algorithm ended, and *moves* is the number of times that the agent travelled until
then. The algorithm ends when {tested} random inputs do not refute its automaton (AALpy's
`RandomhWOracle`; seed {seed}), or when {longest:g} seconds are over. The automaton was then
compared with the world; it is marked if it predicts something wrongly.

{table}

{sums}

With turns alone, a symmetric world looks the same from several sides. The smallest automaton has
one state for all dstates that a symmetry exchanges. It predicts everything rightly, but it is not
the map, as it takes several places for one. Section V of the paper says that the minimal automata
of earlier methods do not fit environments such as grids; this table measures that. Such a learner
gives one automaton, and does not say how many maps explain its walk.
"""
NO_PEERS = """\
## Compared with learning an automaton without reset

These columns are missing, as AALpy was not installed when the atlas was made, or was not asked
for. It comes with the extra `peers`, which `make atlas` installs.
"""
STEPS = """\
## Step by step

These are the numbers of maps after each step, from step 0. `1 x12` stands for the number 1, twelve
times in a row.

{blocks}
"""
CUT = """\
## What was cut

{lines}
"""


def read_atlas(path: str | Path) -> dict[str, Any]:
    """The JSON of an atlas. Raises InputError, one line, if a file is not an atlas."""
    try:
        data = json.loads(read_text(path))
    except (ValueError, RecursionError):
        raise InputError(f"{path}: not JSON") from None
    formats.demand(path, data)
    try:
        list(page(data))
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):
        raise InputError(f"{path}: not an atlas as topomap atlas --json writes it") from None
    return dict(data)


def page(data: dict[str, Any]) -> Iterator[str]:
    """The page of an atlas, in lines."""
    rows, most, seconds = data["rows"], data["most"], data["seconds"]
    parts = [
        HEAD.format(
            worlds=len(rows),
            steps=f"{data['steps']:,}",
            seed=data["seed"],
            most=f"{most:,}",
            seconds=f"{seconds:g}",
        )
    ]
    if data["fault"]:
        parts.append(f"**partial: {data['fault']}; {len(rows)} of {data['worlds']} worlds**\n")
    parts.append(LEFT.format(table=_table(_left_head(), _left(rows))))
    parts.append(
        SETTLING.format(living=data["living"], table=_table(_settling_head(), _settling(rows)))
    )
    parts.append(
        PREFERRED.format(
            table=_table(["world", "walk", *KNOWLEDGE], _preferred(rows)),
            sums=_preferred_sums(rows),
        )
    )
    if data["peers"]:
        parts.append(
            PEERS.format(
                aalpy=data["peers"]["aalpy"],
                tested=data["peers"]["tested"],
                longest=data["peers"]["seconds"],
                seed=data["seed"],
                table=_table(_peers_head(), _peers(rows)),
                sums=_peers_sums(rows),
            )
        )
    else:
        parts.append(NO_PEERS)
    parts.append(STEPS.format(blocks="\n\n".join(_steps(rows))))
    parts.append(CUT.format(lines="\n".join(_cuts(rows)) or "Nothing was cut."))
    yield from "\n".join(parts).rstrip("\n").split("\n")


def _table(head: Sequence[str], rows: Iterator[Sequence[Any]]) -> str:
    """A table, as pages have it."""
    body = [[str(cell) for cell in row] for row in rows]
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _walks(rows: Sequence[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    for row in rows:
        for walk in row["walks"]:
            yield row, walk


def _left_head() -> list[str]:
    return ["world", "places", "ways", "walk", "steps", *KINDS]


def _left(rows: Sequence[dict[str, Any]]) -> Iterator[Sequence[Any]]:
    for row, walk in _walks(rows):
        counts = [_last(walk["maps"][kind]) for kind in KNOWLEDGE]
        counts.append(_closed(walk["settling"]["closed"]))
        yield row["name"], row["places"], row["ways"], WALKS[walk["walk"]], walk["steps"], *counts


def _last(counted: dict[str, Any]) -> str:
    """The number at the end, or how far it was counted."""
    if counted["stopped"] is None:
        return f"{counted['maps'][-1]:,}"
    if counted["more_than"] is not None:
        return f"more than {counted['more_than']:,} (step {counted['stopped']})"
    return f"open ({counted['maps'][-1]:,} after step {counted['stopped'] - 1})"


def _closed(told: dict[str, Any]) -> str:
    """The number of closed maps at the end, or how many of them were found."""
    if told["living"] is None:
        return f"{told['met']:,} or more" if told["met"] else f"open ({told['why']})"
    return f"{told['living']:,}"


def _settling_head() -> list[str]:
    return [
        "world",
        "walk",
        *(f"{kind}: one since" for kind in KINDS),
        *(f"{kind}: further walk" for kind in KINDS),
    ]


def _settling(rows: Sequence[dict[str, Any]]) -> Iterator[Sequence[Any]]:
    for row, walk in _walks(rows):
        left = walk["settling"]
        since = [_since(walk["maps"][kind], "one_since", left[kind]) for kind in KNOWLEDGE]
        since.append(_since(walk["maps"]["all"], "closed_one_since", left["closed"]))
        further = [_further(left[kind], kind == "closed" and not walk["whole"]) for kind in KINDS]
        yield row["name"], WALKS[walk["walk"]], *since, *further


def _since(counted: dict[str, Any], what: str, left: dict[str, Any]) -> str:
    """The step from which on there is one map; ``left`` is what is known of those at the end."""
    if counted["stopped"] is not None:
        other_than_one = left["kind"] in ("never", "walk", "no map") or left["met"] > 1
        return "-" if other_than_one else "open"
    return "-" if counted[what] is None else f"step {counted[what]}"


def _further(told: dict[str, Any], pending: bool) -> str:
    """The further walk that leaves only the real map, in a few words.

    ``pending`` says that closed maps are meant, and that the real map still has pending gateways.
    """
    kind, others = told["kind"], told["others"]
    if kind == "others":
        return "real map open" if pending else "real map not one of them"
    if kind == "one":
        return "0 steps"
    if kind == "never":
        tried = told["tried"]
        of = f"{tried:,}" if tried == others else f"{tried:,} tried"
        return f"none ({told['never']:,} of {of})"
    if kind == "walk":
        many = len(told["walk"])
        if told["shortest"]:
            return f"{many} steps"
        tried = "" if told["tried"] == others else f" for {told['tried']:,} tried"
        return f"{told['at_least']} or more; {many}{tried}"
    return "no map" if kind == "no map" else f"open ({told['why']})"


def _preferred(rows: Sequence[dict[str, Any]]) -> Iterator[Sequence[Any]]:
    for row, walk in _walks(rows):
        yield (
            row["name"],
            WALKS[walk["walk"]],
            *(_best(walk["preferred"][kind]) for kind in KNOWLEDGE),
        )


def _best(told: dict[str, Any]) -> str:
    """What is preferred, in a few words."""
    if told["kind"] is None:
        return f"open ({told['why']})"
    if not told["maps"]:
        return "no map"
    so_far = ", so far" * (told["kind"] == "best so far")
    many = f"{told['maps']}{' or more' * told['more']}"
    if told["truth"] is None:
        return f"open: {many} best maps{so_far}"
    if told["truth"]:
        return f"yes{so_far}" if told["maps"] == 1 else f"one of {many}{so_far}"
    other, real = told["cost"], told["true_cost"]
    costs = " ".join(map(str, other)), "none" if real is None else " ".join(map(str, real))
    return f"no: {costs[0]}, real {costs[1]}{so_far}"


def _preferred_sums(rows: Sequence[dict[str, Any]]) -> str:
    """In how many worlds the real map is preferred after the tour."""
    lines = []
    for kind in KNOWLEDGE:
        told = [walk["preferred"][kind] for _, walk in _walks(rows) if walk["walk"] == "tour"]
        known = [one for one in told if one["truth"] is not None]
        alone = sum(one["truth"] and one["maps"] == 1 for one in known)
        among = sum(one["truth"] and one["maps"] > 1 for one in known)
        lines.append(
            f"{kind}: after the tour, the real map alone is best in {alone} worlds, it is one of "
            f"several best maps in {among}, and it is not among the best maps in "
            f"{len(known) - alone - among}. In {len(told) - len(known)} worlds this is open."
        )
    return _items(lines)


def _items(texts: Iterable[str]) -> str:
    """A list, in lines that are not too long."""
    return "\n".join(
        textwrap.fill(f"- {text}", WIDTH, subsequent_indent="  ", break_on_hyphens=False)
        for text in texts
    )


def _peers_head() -> list[str]:
    head = ["world", "dstates"]
    for how in "turns", "compass":
        head += [f"{how}: smallest", f"{how}: learned", f"{how}: moves"]
    return head


def _peers(rows: Sequence[dict[str, Any]]) -> Iterator[Sequence[Any]]:
    for row in rows:
        cells = [row["name"], row["dstates"]]
        for how in "turns", "compass":
            told = row["peer"][how]
            if told["states"] is None:
                learned = WHY_LEARNED.get(told["why"], f"did not end ({told['why']})")
            else:
                learned = f"{told['states']}{'' if told['right'] else ' (wrong)'}"
            cells += [told["least"], learned, f"{told['moves']:,}"]
        yield cells


WHY_LEARNED = {"all alike": "not begun: all looked alike"}


def _peers_sums(rows: Sequence[dict[str, Any]]) -> str:
    """What the learner reached in all worlds."""
    lines = []
    for how in "turns", "compass":
        told = [(row["name"], row["peer"][how]) for row in rows]
        ended = [(name, one) for name, one in told if one["states"] is not None]
        right = sum(one["right"] for _, one in ended)
        least = sum(one["states"] == one["least"] for _, one in ended)
        whole = sum(one["states"] == one["dstates"] for _, one in ended)
        few = [
            f"{name} ({one['states']} of {one['dstates']} states, {one['moves']:,} moves)"
            for name, one in ended
            if 4 * one["states"] == one["dstates"]
        ]
        quarter = f" In {len(few)} it has a quarter as many states as dstates: {', '.join(few)}."
        lines.append(
            f"{how}: the algorithm ended in {len(ended)} of {len(told)} worlds; in {right} its "
            f"automaton predicts everything rightly. In {least} worlds the automaton "
            f"has as many states as the smallest one, and in {whole} a state for each dstate."
            f"{quarter * bool(few)}"
        )
    return _items(lines)


def _steps(rows: Sequence[dict[str, Any]]) -> Iterator[str]:
    """The numbers after each step, a block for each world."""
    for row in rows:
        lines = []
        for walk in row["walks"]:
            lines.append(f"{WALKS[walk['walk']]}, {walk['steps']} steps")
            for kind in KINDS:
                counted = walk["maps"]["all" if kind == "closed" else kind]
                numbers = _runs(counted["closed" if kind == "closed" else "maps"])
                end = ""
                if counted["stopped"] is not None:
                    end = f"; stopped at step {counted['stopped']}"
                lines += textwrap.wrap(f"  {kind}: {numbers}{end}", WIDTH, subsequent_indent="    ")
        yield f"### {row['name']}\n\n```text\n" + "\n".join(lines) + "\n```"


def _runs(numbers: Sequence[int]) -> str:
    """Numbers in a row; equal neighbours are written once, with their number."""
    runs = ((number, len([*same])) for number, same in groupby(numbers))
    return ", ".join(f"{number:,}" + (f" x{many}" if many > 1 else "") for number, many in runs)


def _cuts(rows: Sequence[dict[str, Any]]) -> Iterator[str]:
    """What was not counted in full, and why."""
    for row, walk in _walks(rows):
        where = f"{row['name']}, {WALKS[walk['walk']]}"
        for kind in KNOWLEDGE:
            counted = walk["maps"][kind]
            if counted["why"] == "maps":
                more = f"more than {counted['more_than']:,} maps after step {counted['stopped']}"
                yield f"- {where}: {kind}: {more}"
            elif counted["why"]:
                last = f"counted to step {counted['stopped'] - 1} ({counted['why']})"
                yield f"- {where}: {kind}: {last}"
        if not walk["whole"]:
            ended = f"it ended after {walk['steps']} steps"
            yield f"- {where}: {ended}, before it had gone along every way"
        for kind in KINDS:
            told = walk["settling"][kind]
            if told["kind"] is None:
                yield f"- {where}: {kind}: the further walk is open ({told['why']})"
            elif told["living"] is None and kind == "closed":
                yield f"- {where}: closed: the number of maps at the end is open ({told['why']})"
        for kind in KNOWLEDGE:
            if told := walk["preferred"][kind]["why"]:
                yield f"- {where}: {kind}: what is preferred is open ({told})"
    for row in rows:
        for how, told in (row["peer"] or {}).items():
            if told["why"]:
                yield f"- {row['name']}: AALpy, {how}: it did not end ({told['why']})"
