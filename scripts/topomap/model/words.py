"""An exploration in words."""

import re
import textwrap
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from topomap.model.topology import Gateway, gid
from topomap.runtime.errors import printable

if TYPE_CHECKING:  # parsing a call must not load the solver
    from topomap.model.experience import Experience, Misread

MOST = 24  # up to so many gateways of a view are listed one by one
LONGEST = 16  # letters in a line of the landmarks of a place in a picture
MOST_LINES = 24  # lines of the landmarks of a place
RULES = {
    "view": "another view is seen there",
    "landmark": "other landmarks are seen there",
    "marker": "the marker is seen elsewhere, or lies there and is not seen",
    "compass": "the compass points elsewhere there",
    "odometry": "it is too far away by odometry",
    "apart": "it is known to be another place",
    "same": "it is known to be the place of an earlier step",
    "length": "the way had another length",
    "twice": "a place would be on a path twice",
    "circular": "a path would be circular",
    "planarity": "the gateways are not on one face",
    "perpendicular": "it would not be perpendicular",
    "bound": "there would be too many places",
}


def plural(count: int, noun: str, nouns: str | None = None) -> str:
    """The noun in its form for such a number."""
    return noun if count == 1 else nouns or f"{noun}s"


def number(count: int, noun: str, nouns: str | None = None) -> str:
    """A number with its noun."""
    return f"{count:,} {plural(count, noun, nouns)}"


def direction(slot: int, slots: int) -> str:
    """A slot in words, counted clockwise from the gateway by which the agent arrived."""
    if slot == 0:
        return "back"
    if slot == slots // 2:
        return "straight on"
    side = "left" if slot < slots // 2 else "right"
    return side if slots == 4 else f"{side} ({_clockwise(slot)})"


def _clockwise(slot: int) -> str:
    return f"{number(slot, 'slot')} clockwise"


def turn(experience: "Experience", step: int) -> str:
    """What is done at a step."""
    if step == 0:
        return "start"
    slot = experience.turns[step - 1]
    if slot is None:
        return "a new log" if step in experience.starts else "a second look"
    if step == 1 or experience.turns[step - 2] is None:
        return f"leave {'by the gateway where it stands' if slot == 0 else _clockwise(slot)}"
    return direction(slot, experience.slots)


def view(experience: "Experience", step: int) -> str:
    """The gateways that are seen after a step."""
    seen = sorted(experience.views[step])
    told = seen[:MOST]
    if step == 0:
        words = ["where it stands" if slot == 0 else _clockwise(slot) for slot in told]
    else:
        words = [direction(slot, experience.slots) for slot in told]
    if len(seen) > MOST:
        words.append(f"{len(seen) - MOST:,} more")
    return f"{number(len(seen), 'way')}: {', '.join(words)}"


def marker(experience: "Experience", step: int) -> str:
    """What is seen of the marker after a step, and what is done with it."""
    told = []
    for name in experience.names():
        drops, picks, markers = experience.marks_of(name)
        words = {"seen": markers - picks - drops, "taken up": picks, "put down": drops}
        of = "" if name is None else f"{printable(name)} "
        told += [of + word for word, steps in words.items() if step in steps]
    return ", ".join(told)


def known(experience: "Experience", step: int) -> str:
    """What is known of a step besides its view."""
    measured = experience.measured(step)
    told = [f"{name} {', '.join(map(str, numbers))}" for name, numbers in measured]
    for name, pairs in (
        ("same place as", experience.same),
        ("not the same place as", experience.apart),
    ):
        steps = sorted(earlier for earlier, later in pairs if later == step)
        told += (
            [f"{name} after {plural(len(steps), 'step')} {listed(steps, MOST)}"] if steps else []
        )
    return "; ".join(told)


def markers(experience: "Experience", at: Sequence[Gateway]) -> str:
    """What is known of markers after the steps of a map, with the places."""
    told = ((step, marker(experience, step), place) for step, (place, _) in enumerate(at))
    return "; ".join(
        f"{what} at place {place} after step {step}" for step, what, place in told if what
    )


def contradicted(experience: "Experience", misread: "Sequence[Misread]") -> str:
    """What was misread, step by step; ``experience`` is the corrected one."""
    told: dict[int, list[str]] = {}
    for step, what in misread:
        gateway = isinstance(what, int)
        there = what in (experience.views if gateway else experience.landmarks)[step]
        kind = "missed" if there else "imagined"
        told.setdefault(step, []).append(f"{'gateway' if gateway else 'landmark'} {what} {kind}")
    steps = [f"step {step} ({', '.join(what)})" for step, what in told.items()]
    return f"contradicts {', '.join(steps)}; " if steps else ""


def refused(arrivals: Mapping[str, Sequence[Gateway]], new: int, most: int = 6) -> str:
    """The arrivals that are refused at a step, by rule; only the first ones if there are many.

    ``new`` is the place that the step makes.
    """
    parts = []
    for rule, gateways in arrivals.items():
        names = ["a new place" if place == new else gid((place, slot)) for place, slot in gateways]
        more = f" and {len(names) - most:,} more" if len(names) > most else ""
        parts.append(f"{', '.join(names[:most])}{more}: {RULES[rule]}")
    return "; ".join(parts)


def listed(numbers: Collection[int], most: int = 8) -> str:
    """Numbers in a row; only the first ones if there are many."""
    first = ", ".join(map(str, sorted(numbers)[:most]))
    return first + (f" and {len(numbers) - most:,} more" if len(numbers) > most else "")


def short(text: str, most: int) -> str:
    """The text, or its beginning if it is too long."""
    return text if len(text) <= most else text[: most - 1] + "…"


def signs(landmarks: Collection[str]) -> str:
    """The landmarks of a place in a few words, without the quotes of strings, in one line."""
    return short(_signs(landmarks), LONGEST)


def sign_lines(landmarks: Collection[str]) -> list[str]:
    """The landmarks of a place in a picture, whole, over several lines if they are long."""
    return wrapped(_signs(landmarks), LONGEST)


def _signs(landmarks: Collection[str]) -> str:
    return ", ".join(printable(_unquoted(sign)) for sign in sorted(landmarks))


def wrapped(text: str, wide: int) -> list[str]:
    """A name in lines of at most so many letters, broken between words if possible.

    Only a name that needs many lines is cut.
    """
    lines = textwrap.wrap(text, wide) or [text]
    return lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], "…"]


def _unquoted(sign: str) -> str:
    string = re.fullmatch(r'"(.*)"', sign, re.DOTALL)
    return re.sub(r'\\(["\\])', r"\1", string[1]) if string else sign
