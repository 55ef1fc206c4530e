"""All that is wrong with instances, and what looks like a mistake.

Nothing is solved. Faults are those for which every command refuses an instance. Warnings are about
what may be meant as it is, but seldom is.
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import islice, pairwise
from typing import Any

from topomap.model import words
from topomap.model.experience import Experience
from topomap.model.facts import Facts, Fault
from topomap.runtime import files
from topomap.runtime.errors import InputError
from topomap.runtime.limits import DRIFT, STRETCH

MOST = 1000  # the largest number of faults of a file in JSON
SHOWN = 50  # the largest number of faults in lines
# So many turns back, each at a place with other gateways, are strange if no turn is another one:
ALWAYS = 3  # in the whole exploration
OFTEN = 4  # at places that look alike
START = (
    "after a travel, slot 0 is the gateway by which you arrived (behind you); at the start you "
    "choose it, and turn(1) counts from it"
)


def judged(path: str, drift: int = DRIFT, stretch: int = STRETCH) -> dict[str, Any]:
    """Judge a file; shifts and lengths may be wrong by these percents."""
    facts = Facts(drift=drift, stretch=stretch)
    told: dict[str, Any] = {"file": path, "valid": False}
    told |= dict.fromkeys(("steps", "slots", "views", "landmarks"))
    try:
        faults = [*islice(facts.faults(files.read_text(path)), MOST + 1)]
    except InputError as error:
        faults = [Fault(str(error).removeprefix(f"{path}: "))]
    warnings: list[Fault] = []
    if not faults:
        seen = facts.experience()
        warnings = [*strange(seen, facts)]
        told |= {"valid": True, "steps": seen.steps, "slots": seen.slots}
        told["views"] = len({*zip(seen.views, seen.landmarks, strict=True)})
        told["landmarks"] = len(frozenset().union(*seen.landmarks))
    more = None
    if len(faults) > MOST:
        more = f"only the first {MOST:,} are listed"
    elif facts.unread:
        more = "what is missing can be said only when every statement is a fact"
    return told | {
        "faults": [_json(fault, "fault") for fault in faults[:MOST]],
        "more_faults": more,
        "warnings": [_json(warning, "warning") for warning in warnings],
    }


def _json(fault: Fault, kind: str) -> dict[str, Any]:
    return {"line": fault.line, "step": fault.step, kind: fault.said}


def lines(file: dict[str, Any]) -> Iterator[str]:
    """Write the judgement as lines to read."""
    name = file["file"]
    if file["valid"]:
        counts = [words.number(file["steps"], "step"), words.number(file["slots"], "slot")]
        counts += [words.number(file["views"], "kind of view", "kinds of views")]
        counts += [words.number(file["landmarks"], "landmark")]
        yield f"{name}: valid: {', '.join(counts)}"
    for fault in file["faults"][:SHOWN]:
        yield Fault(fault["fault"], fault["line"], fault["step"]).of(name)
    if (left := len(file["faults"]) - SHOWN) > 0:
        yield f"{name}: and {words.number(left, 'more fault')}: see --json"
    if more := file["more_faults"]:
        yield f"{name}: there may be more faults: {more}"
    for warning in file["warnings"]:
        said = f"warning: {warning['warning']}"
        yield Fault(said, warning["line"], warning["step"]).of(name)


def strange(seen: Experience, facts: Facts) -> Iterator[Fault]:
    """Find what looks like a mistake in an experience; ``facts`` has the lines."""
    if not seen.steps:
        said = "there is no turn(1), so the place where the agent starts is never left"
        yield Fault(said, facts.steps[0], 0)
        return
    for step in sorted(seen.starts):
        if seen.shifts and seen.shifts[step - 1] is not None:
            said = "there is a shift, which is not used: where a log begins, nothing is measured"
            yield Fault(said, min(facts.known["shift"][step].values()), step)
    travels = [step for step, turn in enumerate(seen.turns, 1) if turn is not None]
    if turn := seen.turns[0]:
        said = (
            f"turn(1) is {turn}, so the start looks like an arrival: {START}. If no way is behind "
            "you there, list none; count from the gateway that you leave by, and turn(1) is 0"
        )
        yield Fault(said, facts.turns[1][turn], 1)
    straight = f"0 is the way back, straight on is {seen.slots // 2}"
    choice = [step for step in travels if step > 1 and len(seen.views[step - 1]) > 1]
    if len(choice) >= ALWAYS and not any(seen.turns[1:]):
        said = f"every turn from step 2 is 0: the agent turns back at once everywhere; {straight}"
        yield Fault(said, facts.turns[2][0], 2)
        return
    kinds: dict[Any, list[int]] = defaultdict(list)
    for step in choice:
        kinds[_kind(seen, step - 1)].append(step)
    for steps in kinds.values():
        if len(steps) >= OFTEN and not any(seen.turns[step - 1] for step in steps):
            first = steps[0] - 1
            said = (
                "places that look like the one after this step are always left by the way back, "
                f"in {len(steps)} visits, though they have other gateways; {straight}"
            )
            yield Fault(said, facts.steps[first], first)


def _kind(seen: Experience, step: int) -> Any:
    """What a place looks like, whichever gateway the agent arrives by.

    It consists of its landmarks, and how far apart its gateways lie. The order of the gaps is left
    out, which can suppress warnings, but makes none of them wrong.
    """
    view = sorted(seen.views[step])
    apart = [after - before for before, after in pairwise(view)]
    return tuple(sorted([*apart, seen.slots - sum(apart)])), seen.landmarks[step]
