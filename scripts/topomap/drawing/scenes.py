"""Maps to be shown: those that were found in an instance, or those in a file of maps."""

from collections import Counter, defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePath
from typing import Any

from topomap.documents import maps
from topomap.documents.check import STEP_RULES
from topomap.model.experience import MOST_SLOTS, Experience
from topomap.model.found import Found
from topomap.model.topology import Gateway, Place, TopologicalMap
from topomap.model.words import markers, plural, short
from topomap.runtime.errors import InputError, printable
from topomap.runtime.limits import LARGEST

MOST_DRAWN = 1000  # the largest number of places in a picture
Where = Mapping[Place, tuple[float, float]]  # positions to the right and up, in any unit


@dataclass(frozen=True)
class Scene:
    """A map, and the dstate after each step of the route in it, from step 0 (or none).

    ``name`` tells where it is from. It is map ``number`` of ``many`` (0: the number is not known),
    which are all if ``whole``. ``kind`` tells what these maps are; if it is empty, that is not
    known, and they are the given maps. ``caption`` is a title in the place of these. ``marker``
    tells where the marker was put down, seen and taken up, if it was. ``rests`` has the steps that
    are not a travel. ``seen`` is the experience, if it is known. ``like`` tells where places are,
    if they are to be as in some world.
    """

    world: TopologicalMap
    at: Sequence[Gateway]
    name: str
    number: int = 1
    many: int = 1
    kind: str = ""
    caption: str = ""
    whole: bool = False
    marker: str = ""
    rests: Collection[int] = ()
    seen: Experience | None = None
    like: Where | None = None

    def where(self) -> Where:
        """Where places are, as far as that is known: as in ``like``, or by what was measured."""
        if self.like is not None:
            return self.like
        if self.seen is None or not (self.seen.compass or self.seen.shifts):
            return {}
        from topomap.drawing.where import measured  # loading it takes time

        return measured(self.seen, [(place, slot) for place, slot in self.at])

    @property
    def title(self) -> str:
        """What the map is, in two lines; an instance is named by the stem of its file."""
        world = self.world
        kind = short(printable(self.kind), 60)
        which = f"map {self.number}" + f" of {self.many}" * bool(self.many)
        if not self.whole:
            which += " found"
        elif self.many == 1:
            which = "the only map"
        if self.whole and not kind:
            which += " given"
        elif self.whole and self.many == 1:
            which = _only(kind)
        elif kind:
            which += f", {kind}"
        genus = world.genus()
        counts = {
            "place": len(world.stars),
            "link": len(world.links) // 2,
            "path": len(world.paths()),
        }
        sizes = [f"{count} {plural(count, noun)}" for noun, count in counts.items()]
        sizes.append("planar" if genus == 0 else f"genus {genus}")
        name = short(PurePath(printable(self.name)).stem, 100)
        title = self.caption or f"{f'{name}: ' * bool(name)}{which}"
        return f"{title}\n{', '.join(sizes)}"

    @property
    def ahead(self) -> Gateway | None:
        """The gateway by which the agent leaves first, which leads to the right of a picture."""
        travels = (arrival for step, arrival in enumerate(self.at[1:], 1) if step not in self.rests)
        first = next(travels, None)
        return None if first is None else self.world.links[first]

    def steps(self) -> dict[Gateway, list[int]]:
        """The steps that leave by each gateway."""
        found: dict[Gateway, list[int]] = defaultdict(list)
        for step, arrival in enumerate(self.at[1:], 1):
            if step in self.rests:
                continue
            found[self.world.links[arrival]].append(step)
        return found


def _only(kind: str) -> str:
    """The only map of a kind, in words."""
    return f"the only map that is {kind}" if kind.startswith("best") else f"the only {kind} map"


def of_instance(seen: Experience, name: str, document: maps.Document) -> list[Scene]:
    """The maps of a document about an instance, which may tell nothing but ``at``, as clingo does.

    Raises:
        InputError: One is not a map of this experience. One line.
    """
    scenes = []
    many = len(document.best)
    for number, (place, entry) in enumerate(document.best, 1):
        where = f"{document.where}: map {place}"
        last = len(entry["at"]) - 1
        if not 0 <= last <= seen.steps:
            raise InputError(f"{where}: {last} steps, but the instance has {seen.steps}")
        try:
            corrected = seen.corrected(maps.misread_of(seen, entry)).cut(last)
        except (LookupError, TypeError, ValueError):
            raise InputError(f"{where}: misread: not what topomap solve --json writes") from None
        if left := corrected.misled():
            fault = "the agent stands at no gateway or leaves by none"
            raise InputError(f"{where}: step {left[0]}: {fault}")
        at = maps.hypothesis(where, entry["at"], corrected, rules=STEP_RULES)
        scenes.append(
            Scene(
                *(corrected.map_of(at), at, name, number, many, document.kind),
                whole=document.whole,
                marker=markers(corrected, at),
                rests=corrected.starts | corrected.looks,
                seen=corrected,
            )
        )
    return scenes


def of_found(experience: Experience, name: str, found: Sequence[Found], whole: bool) -> list[Scene]:
    """The maps that were found in an experience, which are all that there are if ``whole``."""
    numbered = enumerate(found, 1)
    return [one_found(experience, name, one, n, len(found), whole) for n, one in numbered]


def one_found(
    experience: Experience, name: str, one: Found, number: int, many: int, whole: bool
) -> Scene:
    """The ``number``-th of ``many`` maps that were found (0: the number is not known)."""
    return Scene(
        *(experience.map_of(one.at), one.at, name, number, many, one.kind),
        whole=whole,
        marker=markers(experience, one.at),
        rests=experience.starts | experience.looks,
        seen=experience,
    )


def of_document(document: maps.Document) -> list[Scene]:
    """The maps of a document.

    Raises:
        InputError: One is not a map.
    """
    name = str(document.claims.get("instance") or document.where)
    slots = document.claims.get("slots")
    if document.by_clingo and document.maps:
        raise InputError(
            f"{document.where}: maps from clingo: the instance is wanted before them, "
            f"as in topomap show INSTANCE {document.where}"
        )
    scenes = []
    for number, entry in enumerate(document.maps, 1):
        where = f"{document.where}: map {number}"
        if slots is None or not {"places", "links"} <= set(entry):
            raise InputError(f"{where}: slots, places and links are wanted, as in solve --json")
        world = world_of(slots, entry, where)
        if sorted(step for step, _, _ in entry["at"]) != list(range(len(entry["at"]))):
            raise InputError(f"{where}: the steps of at are not 0, 1, 2, ..., each once")
        at = [(place, slot) for _, place, slot in sorted(entry["at"])]
        rests = _rests(document)
        steps = (pair for step, pair in enumerate(pairwise(at), 1) if step not in rests)
        if any(world.links.get(b, (None,))[0] != a[0] for a, b in steps):
            raise InputError(f"{where}: at goes by links that are not there")
        if at and at[0] not in world.gateways():
            raise InputError(f"{where}: at begins at a gateway that is not there")
        many = len(document.maps)
        rest = name, number, many, document.kind
        scenes.append(Scene(world, at, *rest, whole=document.whole, rests=rests))
    return scenes


def _rests(document: maps.Document) -> set[int]:
    """The steps of a document that are not a travel."""
    return {*document.claims.get("rests", [])}


def world_of(slots: int, entry: dict[str, Any], where: str) -> TopologicalMap:
    """The map that ``places`` and ``links`` describe.

    Raises:
        InputError: It is not a map: a gateway has two links, or does not exist.
    """
    try:
        stars = {
            int(place["place"]): frozenset(int(slot) for slot in place["gateways"])
            for place in entry["places"]
        }
        landmarks = {
            int(place["place"]): frozenset(map(str, place["landmarks"]))
            for place in entry["places"]
        }
        if len(stars) != len(entry["places"]):
            raise ValueError
        pairs = [tuple((int(p), int(s)) for p, s in link) for link in entry["links"]]
        ends = [end for link in pairs for end in link]
        links = {a: b for one, other in pairs for a, b in ((one, other), (other, one))}
        if any(abs(place) > LARGEST for place in stars):
            raise ValueError
    except (LookupError, TypeError, ValueError, OverflowError):
        raise InputError(f"{where}: places or links are not as solve --json writes them") from None
    if not stars or len(stars) > MOST_DRAWN:
        raise InputError(f"{where}: {len(stars)} places; a picture has 1 to {MOST_DRAWN}")
    if not 2 <= slots <= MOST_SLOTS or slots % 2:
        raise InputError(f"{where}: slots is not an even number from 2 to {MOST_SLOTS}")
    times = Counter(ends)
    for place, slot in ends:
        if slot not in stars.get(place, ()) or times[place, slot] > 1:
            raise InputError(
                f"{where}: place {place}: gateway {slot} has two links, or does not exist"
            )
    if any(not 0 <= slot < slots for star in stars.values() for slot in star):
        raise InputError(f"{where}: a gateway is not from 0 to {slots - 1}")
    return TopologicalMap(slots, stars, links, landmarks)
